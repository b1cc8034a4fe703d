"""Rivulet: water for programs in Python, over librivulet.so and its rivulet.h. Needs NumPy. SI units; +Y is up.

    import rivulet
    scene = {"fluid": {"spacing": 0.03, "blocks": [{"max": [0.3, 0.6, 0.3]}]}}
    with rivulet.Context() as context, context.world(scene) as world:
        for frame in range(60):
            world.step(1 / 60)
        print(world.stats().centre_of_mass, world.particles().positions.max(axis=0))

A scene is a dict or a JSON text: the fluid, emitters, sinks and look of a scene file; docs/parameters.md lists all keys. A call that fails
raises Error; a wrong argument raises BadInput, which is also a ValueError. Both say what is wrong, where, and the remedy. One thread at a time
uses a context and what is made from it; other threads of Python run during its calls. A matrix is (4, 4) for columns, as mathematics writes
it. docs/python.md is a tutorial.

librivulet.so is searched in the environment variable RIVULET_LIBRARY, beside this file, in the prefix where this file is installed, and where
the linker searches.
"""

from ._library import BadInput, Error, version
from ._structs import CONTACT, SOLID
from .context import Context
from .draw import Camera, Fog, Light, Picture, Shadow, Target, View
from .parts import Air, Body, Box, Float, Mesh, Particles, SkinStats, Sphere, Stats
from .skin import Skin
from .snapshot import Recorded, Recording, Snapshot
from .world import World

__all__ = ["CONTACT", "SOLID", "Air", "BadInput", "Body", "Box", "Camera", "Context", "Error", "Float", "Fog", "Light", "Mesh", "Particles", "Picture",
           "Recorded", "Recording", "Shadow", "Skin", "SkinStats", "Snapshot", "Sphere", "Stats", "Target", "View", "World", "version"]
