"""Worlds: particles in a box, with walls and bodies."""
import ctypes
import json
import os
from ctypes import c_int32, c_size_t, c_uint32, c_void_p

import numpy as np

from . import _structs as c
from ._library import BadInput, Error, address_of, array_of, call, struct, text_of, view_of, whole
from .parts import Particles, Stats, rows_of
from .query import Queries


class World(Queries):
    """Particles in a box, with walls and bodies; see Context.world."""

    def __init__(self, context, scene, walls, bodies, body_host, particles, velocities):
        self._context, host = context, None
        placed, moving = array_of(particles, (-1, 3), "particles"), array_of(velocities, (-1, 3), "velocities")
        count = 0 if placed is None else len(placed)
        if moving is not None and len(moving) != count:
            raise BadInput(f"{len(moving)} velocities were given for {count} particles: give one for each")
        raised = self._raised = []  # by body_host; its functions reference this list and not the world, which must be destroyed before its context
        if body_host is not None:
            def guarded(work):
                try:
                    if not raised:
                        work()
                except BaseException as what:  # raised again after the library has returned: an exception must not pass through C
                    raised.append(what)

            def advance(_, loads, gravity, seconds, states, count):
                def work():  # copies: the library's memory is valid during the call only
                    theirs = view_of(states, c.STATE, count)
                    given = theirs.copy()
                    body_host.advance(view_of(loads, c.LOAD, count).copy(), np.array(gravity.contents), seconds, given)
                    theirs[:] = given
                guarded(work)

            def reset(_, states, count):
                guarded(lambda: body_host.reset(view_of(states, c.STATE, count).copy()))
            self._host = struct(c.BodyHost, advance=c.ADVANCE(advance), reset=c.RESET(reset))
            host = ctypes.pointer(self._host)
        options = struct(c.WorldOptions, json=text_of(scene), walls=(c.Mesh * len(walls))(*(w._c for w in walls)), walls_count=len(walls),
                        bodies=(c.Body * len(bodies))(*(b._c for b in bodies)), bodies_count=len(bodies), body_host=host,
                        particles=address_of(placed), particle_velocities=address_of(moving), particles_count=count)
        pointer = c_void_p()
        self._checked("world_create", context._pointer, options, pointer)
        self._pointer = pointer
        fluid = json.loads(text_of(scene)).get("fluid", {}) if scene else {}
        self._attributes = [attribute["name"] for attribute in fluid.get("attributes", [])]

    def _checked(self, *arguments):
        self._raised.clear()
        try:
            call(*arguments)
        except Error as error:
            raise error from (self._raised[0] if self._raised else None)
        if self._raised:
            raise self._raised.pop()

    def step(self, seconds, gravity=None, poses=None):
        """Advances by a frame of `seconds`, in as many substeps as stability needs. gravity: m/s^2; poses: (n, 7), position (m) and rotation
        (x y z w) of the walls that move, at the end of the frame; None: as given before, after a reset those of t = 0."""
        gravity, poses = array_of(gravity, (3,), "gravity"), array_of(poses, (-1, 7), "poses")
        inputs = struct(c.Inputs, gravity=address_of(gravity), poses=address_of(poses), poses_count=0 if poses is None else len(poses))
        self._checked("world_step", self._pointer, inputs, seconds)

    def reset(self):
        """Back to t = 0."""
        self._checked("world_reset", self._pointer)

    def set(self, path, value):
        """Sets a parameter that docs/parameters.md does not call fixed: set("fluid.viscosity", 0.01)."""
        text = value if isinstance(value, str) else json.dumps(np.asarray(value).tolist())
        call("world_set", self._pointer, text_of(f"{path}={text}"))

    def stats(self):
        stats = struct(c.Stats)
        call("world_stats", self._pointer, stats)
        values = {name: getattr(stats, name) for name in Stats._fields}
        return Stats(**{**values, "centre_of_mass": np.array(stats.centre_of_mass)})

    def particles(self):
        """All particles now, as Particles: arrays that later steps do not change."""
        asked = struct(c.Particles)
        call("world_particles", self._pointer, asked)
        n = asked.count
        arrays = Particles(np.empty((n, 3), np.float32), np.empty((n, 3), np.float32), np.empty(n, np.float32), np.empty(n, np.uint32))
        asked = struct(c.Particles, capacity=n, **{name: address_of(array) for name, array in zip(Particles._fields, arrays)})
        call("world_particles", self._pointer, asked)
        return arrays

    def attributes(self):
        """The values of fluid.attributes now, by name, (n, 4) each: in the order of particles(), until the next step."""
        asked = struct(c.Particles)
        call("world_particles", self._pointer, asked)
        arrays = {name: np.empty((asked.count, 4), np.float32) for name in self._attributes}
        asked = struct(c.Particles, capacity=asked.count)
        for k, values in enumerate(arrays.values()):
            asked.attributes[k] = address_of(values)
        call("world_particles", self._pointer, asked)
        return arrays

    def set_attribute(self, name, ids, values):
        """Sets an attribute of the particles with these ids: values (n, 4)."""
        ids, values = array_of(ids, (-1,), "ids", np.uint32), array_of(values, (-1, 4), "values")
        if len(ids) != len(values):
            raise BadInput(f"{len(values)} values were given for {len(ids)} particles: give one for each")
        call("world_set_attribute", self._pointer, self._attribute(name), address_of(ids), address_of(values), len(ids))

    def paint(self, name, volume, value):
        """Sets an attribute of all particles that are in a volume now, a Box or Sphere: value (4,)."""
        call("world_paint", self._pointer, self._attribute(name), address_of(rows_of([volume])), address_of(array_of(value, (4,), "value")))

    def _attribute(self, name):
        if name not in self._attributes:
            raise BadInput(f"'{name}' is no attribute: fluid.attributes has {', '.join(self._attributes) or 'none'}")
        return self._attributes.index(name)

    def bodies(self):
        """The states of the bodies now, in the order of body_ids: an array with the fields position (m), rotation (x y z w), velocity (m/s) and
        spin (rad/s)."""
        states = np.zeros(len(self.body_ids()), c.STATE)
        call("world_bodies", self._pointer, address_of(states), len(states))
        return states

    def body_ids(self):
        """The ids of the bodies in the world: those given at the start have their index."""
        count = c_size_t()
        call("world_body_ids", self._pointer, None, 0, ctypes.byref(count))
        ids = np.zeros(count.value, np.uint32)
        call("world_body_ids", self._pointer, address_of(ids), len(ids), ctypes.byref(count))
        return ids

    def body(self, id):
        """(state, load) of a body, with the fields of bodies() and force (N), torque (N m); None while it is made ready."""
        state, load, inside = np.zeros((), c.STATE), np.zeros((), c.LOAD), c_int32()
        call("world_body", self._pointer, whole(id, 0, 2**32 - 1, "id"), ctypes.byref(inside), address_of(state), address_of(load))
        return (state, load) if inside.value else None

    def add_body(self, body):
        """Adds a Body while the world runs, within the memory of fluid.bodies.maxSamples; returns its id. One with a mesh is made ready beside the
        frames, and is in the world from a later step on."""
        id = c_uint32()
        self._checked("world_add_body", self._pointer, body._c, id)
        return id.value

    def remove_body(self, id):
        self._checked("world_remove_body", self._pointer, whole(id, 0, 2**32 - 1, "id"))

    def export(self, path):
        """Writes the particles as .ply, .vtp (ParaView) or .csv."""
        call("world_export", self._pointer, os.fsencode(path))

    def export_surface(self, path):
        """Writes the water's surface as .obj or .ply."""
        call("world_export_surface", self._pointer, os.fsencode(path))

    def save(self, path):
        """Saves all that the next step depends on to a file."""
        call("world_save", self._pointer, os.fsencode(path))

    def restore(self, path):
        """Restores a file that save() wrote, of a world of the same scene; on the cpu the restored run is bit-identical."""
        self._checked("world_restore", self._pointer, os.fsencode(path))
