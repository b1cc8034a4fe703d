"""Skins: drops and films on a mesh."""
import ctypes
from ctypes import c_void_p

import numpy as np

from . import _structs as c
from ._library import Handle, address_of, array_of, call, struct, text_of
from .parts import SkinStats


class Skin(Handle):
    """Drops and films on a mesh; see Context.skin."""

    _kind = "skin"

    def __init__(self, context, mesh, liquid, map_size):
        self._context, self._vertices = context, len(mesh.positions)
        options = struct(c.SkinOptions, mesh=ctypes.pointer(mesh._c), json=text_of(liquid), map_size=map_size)
        pointer = c_void_p()
        call("skin_create", context._pointer, options, pointer)
        self._pointer = pointer

    def add(self, place, microlitres):
        """Adds a drop, which appears with the next step, at the point of the skin nearest to `place` (m, in the mesh's frame)."""
        call("skin_add", self._pointer, address_of(array_of(place, (3,), "place")), microlitres)

    def step(self, seconds, gravity=None, wind=None, to_world=None, positions=None):
        """gravity (m/s^2) and wind (m/s) in the world; to_world: the mesh's frame -> the world, 4 x 4, without scale; positions (m): the
        vertices of a mesh that deforms."""
        matrix = array_of(to_world, (4, 4), "to_world")
        given = [array_of(gravity, (3,), "gravity"), array_of(wind, (3,), "wind"), None if matrix is None else np.ascontiguousarray(matrix.T),
                 array_of(positions, (self._vertices, 3), "positions")]
        inputs = struct(c.SkinInputs, **dict(zip(("gravity", "wind", "to_world", "positions"), map(address_of, given))))
        call("skin_step", self._pointer, inputs, seconds)

    def stats(self):
        stats = struct(c.SkinStats)
        call("skin_stats_of", self._pointer, stats)
        return SkinStats(**{name: getattr(stats, name) for name in SkinStats._fields})
