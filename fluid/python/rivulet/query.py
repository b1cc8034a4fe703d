"""Questions to a world: samples, rays, heights, buoyancy, counted volumes, loads, lines; and its particles and surface as files."""
from __future__ import annotations

import ctypes
import os
from ctypes import c_size_t
from typing import Any, Callable, Sequence, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _structs as c
from ._library import BadInput, address_of, array_of, array_or_none, each_of, path_of, seconds_of, view_of
from .draw import Drawn
from .parts import Float, Volume, rows_of

Array = NDArray[Any]
Path = Union[str, "os.PathLike[str]"]
_PARTS = ("box", "emitter", "sink", "probe", "wall", "body")


class Queries(Drawn):
    """What a World answers about its water as it is now. Arrays are copies: later steps do not change them."""

    _kind = "world"
    _raised: Any
    _later: dict[object, Any]
    _arrived: list[object]

    def sample(self, places: ArrayLike) -> Array:
        """The water at places (n, 3), m: (n,) with the fields density (over the rest density; 0 in air), velocity (m/s; 0 in air) and gradient
        (1/m, of the density: points into the water). Waits for the device."""
        places = array_of(places, (-1, 3), "places")
        samples = np.zeros(len(places), c.SAMPLE)
        self._call("world_sample", address_of(places), len(places), address_of(samples))
        return samples

    def sample_later(self, places: ArrayLike, then: Callable[[Array], None]) -> None:
        """The same without waiting: then(samples) is called once, at the end of a later call of this world, on backend cpu at the end of this
        one. What it raises comes out of that call. If the world is closed before, it is not called."""
        places = array_of(places, (-1, 3), "places")
        if not callable(then):
            raise BadInput(f"then is {then!r}: give a function of the samples")
        raised, done, key = self._raised, self._arrived, object()

        def arrived(_: Any, samples: int, count: int) -> None:
            raised.guard(lambda: then(view_of(samples, c.SAMPLE, count).copy()))
            done.append(key)

        self._later[key] = c.SAMPLES(arrived)
        if self._owned is not None and not any(each is self._later for each in self._owned.keeps):
            self._owned.keeps.append(self._later)
        self._call("world_sample_later", address_of(places), len(places), self._later[key], None)

    def buoyancy(self, floats: Sequence[Float], seconds: float, gravity: ArrayLike | None = None) -> Array:
        """Loads on objects that the caller moves, to be applied for `seconds`: lift by Archimedes, drag by Morison et al. 1950. (n,) with the
        fields force (N) and torque (N m, about the centre of mass). gravity: (3,) m/s^2, None: fluid.gravity. Waits for the device."""
        gravity = array_or_none(gravity, (3,), "gravity")
        floats = each_of(floats, Float, "floats")
        loads = np.zeros(len(floats), c.LOAD)
        given = (c.Float * len(floats))(*(each._c for each in floats))
        self._call("world_buoyancy", given, len(floats), address_of(gravity), seconds_of(seconds), address_of(loads))
        return loads

    def cast(self, origins: ArrayLike, directions: ArrayLike, reach: ArrayLike = 0.0) -> Array:
        """Where rays from origins (n, 3) along directions, (n, 3) or one for all, first cross the water's surface within reach (m; 0: no limit):
        (n,) with the fields hit, inside (the ray begins in water and this is where it leaves it), distance (m), place (m), normal (out of
        the water) and velocity (m/s). Waits for the device."""
        origins = array_of(origins, (-1, 3), "origins")
        rays = np.zeros(len(origins), c.RAY)
        rays["origin"] = origins
        for field, values in (("direction", directions), ("reach", reach)):
            try:
                rays[field] = values
            except ValueError:
                raise BadInput(f"{field} has the shape {np.shape(values)}: give one for each of {len(origins)} rays, or one for all") from None
        hits = np.zeros(len(rays), c.HIT)
        self._call("world_cast", address_of(rays), len(rays), address_of(hits))
        return hits.astype(c.HIT_RESULT)

    def heights(self, places: ArrayLike) -> Array:
        """(n,) m: y of the highest surface at each x, z of places (n, 2); NaN where there is no water. Waits for the device."""
        places = array_of(places, (-1, 2), "places")
        heights = np.zeros(len(places), np.float32)
        self._call("world_heights", address_of(places), len(places), address_of(heights))
        return heights

    def wetness(self, places: ArrayLike) -> Array:
        """(n,) How wet solids are at places (n, 3), m, on their surface: 0 dry .. 1 wet. Waits for the device."""
        places = array_of(places, (-1, 3), "places")
        wet = np.zeros(len(places), np.float32)
        self._call("world_wetness", address_of(places), len(places), address_of(wet))
        return wet

    def set_volumes(self, volumes: Sequence[Volume]) -> None:
        """Counts particles in these volumes, Box or Sphere, at most 32; they replace those set before."""
        rows = rows_of(volumes)
        self._call("world_set_volumes", address_of(rows), len(rows))

    def _counts(self, name: str) -> Array:
        counts, n = np.zeros(c.MOST_VOLUMES, c.COUNT), c_size_t()
        self._call(name, address_of(counts), len(counts), n)
        return counts[:n.value].copy()

    def volumes(self) -> Array:
        """(n,) with the fields id; entered, left and inside (particles, since the volume was set); time (s simulated, to which the counts belong)
        and volume_inside (m^3)."""
        return self._counts("world_volumes")

    def volume_events(self) -> Array:
        """The volumes that particles entered or left since the last call, as volumes(), with entered and left since then."""
        return self._counts("world_volume_events")

    def loads(self) -> dict[str, Any]:
        """{name: load} of the scene's fluid.probes in the last frame (on a GPU two or three frames ago). A load has the fields force (N) on the
        wall and torque (N m) about the probe's point, means over the last `seconds` before `time`; pressure (Pa, NaN without an area); impulse
        (N s) and angular_impulse (N m s), sums since the start, a reset or a restored state."""
        n = c_size_t()
        self._call("world_loads", None, 0, n)
        loads = np.zeros(n.value, c.LOADS)
        self._call("world_loads", address_of(loads), len(loads), n)
        return {load["name"].decode(): load for load in loads}

    def lines(self) -> Array:
        """The parts of the world as lines, for debug drawing: (n,) with the fields part (box, emitter, sink, probe, wall or body), index (of the
        emitter, sink or probe; the body's id; of the wall among those that move), start and end (m)."""
        found: list[Any] = []

        def line(_: int, part: int, index: int, start: Any, end: Any) -> None:
            found.append((_PARTS[part], index, tuple(start.contents), tuple(end.contents)))

        self._call("world_lines", c.LINE(line), None)
        return np.array(found, c.LINE_RESULT)

    def export(self, path: Path) -> None:
        """Writes the particles as .ply, .vtp (ParaView) or .csv. BadInput: another ending. Error: the file cannot be written."""
        self._call("world_export", path_of(path))

    def export_surface(self, path: Path) -> None:
        """Writes the water's surface as .obj or .ply. BadInput: another ending. Error: the file cannot be written."""
        self._call("world_export_surface", path_of(path))
