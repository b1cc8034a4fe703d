"""Questions to a world: samples, rays, heights, counted volumes, loads."""
import ctypes
from ctypes import c_size_t

import numpy as np

from . import _structs as c
from ._library import BadInput, Handle, address_of, array_of, call
from .parts import rows_of


class Queries(Handle):
    """What a World answers about its water as it is now."""

    _kind = "world"

    def sample(self, places):
        """The water at places (n, 3), m: an array with the fields density (over the rest density; 0 in air), velocity (m/s) and gradient
        (1/m, of the density: points into the water)."""
        places = array_of(places, (-1, 3), "places")
        samples = np.zeros(len(places), c.SAMPLE)
        call("world_sample", self._pointer, address_of(places), len(places), address_of(samples))
        return samples

    def cast(self, origins, directions, reach=0.0):
        """Where rays from origins (n, 3) along directions, (n, 3) or one for all, first cross the water's surface within reach (m; 0: no
        limit): an array with the fields hit, inside (the ray begins in water and this is where it leaves it), distance (m), place (m),
        normal (out of the water) and velocity (m/s)."""
        origins = array_of(origins, (-1, 3), "origins")
        rays = np.zeros(len(origins), c.RAY)
        rays["origin"] = origins
        for field, values in (("direction", directions), ("reach", reach)):
            try:
                rays[field] = values
            except ValueError:
                raise BadInput(f"{field} has the shape {np.shape(values)}: give one for each of {len(origins)} rays, or one for all") from None
        hits = np.zeros(len(rays), c.HIT)
        call("world_cast", self._pointer, address_of(rays), len(rays), address_of(hits))
        return hits.astype(c.HIT_RESULT)

    def heights(self, places):
        """y (m) of the highest surface at each x, z of places (n, 2); NaN where there is no water."""
        places = array_of(places, (-1, 2), "places")
        heights = np.zeros(len(places), np.float32)
        call("world_heights", self._pointer, address_of(places), len(places), address_of(heights))
        return heights

    def wetness(self, places):
        """How wet solids are at places (n, 3), m, on their surface: 0 dry .. 1 wet."""
        places = array_of(places, (-1, 3), "places")
        wet = np.zeros(len(places), np.float32)
        call("world_wetness", self._pointer, address_of(places), len(places), address_of(wet))
        return wet

    def set_volumes(self, volumes):
        """Counts particles in these volumes, Box or Sphere, at most 32; they replace those set before."""
        rows = rows_of(volumes)
        call("world_set_volumes", self._pointer, address_of(rows), len(rows))

    def _counts(self, name):
        counts, n = np.zeros(c.MOST_VOLUMES, c.COUNT), c_size_t()
        call(name, self._pointer, address_of(counts), len(counts), n)
        return counts[:n.value].copy()

    def volumes(self):
        """An array with the fields id; entered, left and inside (particles, since the volume was set); time (s simulated, to which the counts
        belong) and volume_inside (m^3)."""
        return self._counts("world_volumes")

    def volume_events(self):
        """The volumes that particles entered or left since the last call, with entered and left since then."""
        return self._counts("world_volume_events")

    def loads(self):
        """{name: load} of the scene's fluid.probes in the last frame (on a GPU two or three frames ago). A load has the fields force (N) on the
        wall and torque (N m) about the probe's point, means over the last `seconds` before `time`; pressure (Pa, NaN without an area); impulse
        (N s) and angular_impulse (N m s), sums since the start, a reset or a restored state."""
        n = c_size_t()
        call("world_loads", self._pointer, None, 0, n)
        loads = np.zeros(n.value, c.LOADS)
        call("world_loads", self._pointer, address_of(loads), len(loads), n)
        return {load["name"].decode(): load for load in loads}
