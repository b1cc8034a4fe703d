"""Skins: drops and films on a mesh."""
from __future__ import annotations

import ctypes
from ctypes import c_uint32, c_void_p
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _structs as c
from ._handle import Handle
from ._library import address_of, array_of, array_or_none, number_of, of_kind, seconds_of, struct, text_of, whole
from .draw import columns, download, off_screen_of
from .parts import Mesh, SkinStats


class Skin(Handle):
    """Drops and films on a mesh; made by Context.skin."""

    _instead = "create another"

    def __init__(self, context: Handle, mesh: Mesh, liquid: Any, map_size: int) -> None:
        self._vertices, size = len(of_kind(mesh, Mesh, "mesh").positions), whole(map_size, 0, 2**15, "map_size")
        self._map_size = size or 1024
        options = struct(c.SkinOptions, mesh=ctypes.pointer(mesh._c), json=text_of(liquid), map_size=size)
        pointer = c_void_p()
        context._call("skin_create", options, pointer)
        owned = context._owned
        self._own("skin", pointer, owned, owned.gl if owned else None)

    def add(self, place: ArrayLike, microlitres: float) -> None:
        """Adds a drop, which appears with the next step, at the point of the skin nearest to `place` ((3,) m, in the mesh's frame)."""
        self._call("skin_add", address_of(array_of(place, (3,), "place")), number_of(microlitres, "microlitres"))

    def step(self, seconds: float, gravity: ArrayLike | None = None, wind: ArrayLike | None = None, to_world: ArrayLike | None = None,
             positions: ArrayLike | None = None, positions_buffer: int = 0) -> None:
        """Advances by `seconds`. gravity (3,) m/s^2, None: (0, -9.81, 0), and wind (3,) m/s, in the world; to_world: (4, 4) without scale, the
        mesh's frame -> the world; positions: (vertices, 3) m, of a mesh that deforms, or positions_buffer: the name of an OpenGL buffer
        with a vec4 a vertex."""
        inputs, _kept = self._inputs(gravity, wind, to_world, positions, positions_buffer)
        self._call("skin_step", inputs, seconds_of(seconds))

    def _inputs(self, gravity: ArrayLike | None = None, wind: ArrayLike | None = None, to_world: ArrayLike | None = None,
                positions: ArrayLike | None = None, positions_buffer: int = 0) -> tuple[c.SkinInputs, list[Any]]:
        """The struct, and the arrays that it refers to."""
        kept = [array_or_none(gravity, (3,), "gravity"), array_or_none(wind, (3,), "wind"),
                None if to_world is None else columns(to_world, "to_world"), array_or_none(positions, (self._vertices, 3), "positions")]
        names = ("gravity", "wind", "to_world", "positions")
        return struct(c.SkinInputs, positions_buffer=positions_buffer, **dict(zip(names, map(address_of, kept)))), kept

    def stats(self) -> SkinStats:
        """Its numbers now. Waits for the device."""
        stats = struct(c.SkinStats)
        self._call("skin_stats_of", stats)
        return SkinStats(*(getattr(stats, name) for name in SkinStats._fields))

    def texture(self) -> int:
        """Updates the map and returns the name of its texture in the context's OpenGL context, as rivulet_skin_texture of rivulet.h."""
        name = c_uint32()
        self._call("skin_texture", name)
        return name.value

    def map(self) -> NDArray[Any]:
        """The map over the mesh's uvs, where the last step began: (size, size, 4) float32, row 0 at v = 1, the top: slope of the liquid's height
        (m a unit of u, of v), height (mm), wetness (0 to 1). A copy. BadInput: the context is not of off_screen."""
        with off_screen_of(self) as gl:
            return download(gl, self.texture(), (self._map_size, self._map_size, 4), np.float32, 0x1908)
