"""Rivulet: water for programs in Python, over librivulet.so and its rivulet.h. Needs NumPy. SI units; +Y is up.

    import rivulet
    scene = {"fluid": {"spacing": 0.03, "blocks": [{"max": [0.3, 0.6, 0.3]}]}}
    with rivulet.Context() as context, context.world(scene) as world:
        for frame in range(60):
            world.step(1 / 60)
        print(world.stats().centre_of_mass, world.particles().positions.max(axis=0))

A scene is a dict or a JSON text: the fluid, emitters, sinks and look of a scene file; docs/parameters.md lists all keys. A call that fails
raises Error; a wrong argument raises BadInput, which is also a ValueError. Both say what is wrong, where, and the remedy. One thread at a time
uses a context and what is made from it. Drawing needs a host with an OpenGL context: it calls rivulet.h.

librivulet.so is searched in the environment variable RIVULET_LIBRARY, beside this file, in the prefix where this file is installed, and where
the linker searches.
"""

from ._library import BadInput, Error, version
from .context import Context
from .parts import Body, Box, Mesh, Particles, Sphere
from .skin import Skin
from .world import World

__all__ = ["BadInput", "Body", "Box", "Context", "Error", "Mesh", "Particles", "Skin", "Sphere", "World", "version"]
