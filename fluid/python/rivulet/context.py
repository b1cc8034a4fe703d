"""Contexts: a device that simulates and, with OpenGL, a renderer."""
from __future__ import annotations

import ctypes
from ctypes import c_size_t, c_void_p
from typing import Any, Callable, Sequence

import numpy as np
from numpy.typing import ArrayLike

from . import _structs as c
from ._handle import Handle
from ._library import address_of, array_of, array_or_none, call, lib, struct, text_of, vector, whole
from ._off_screen import OffScreen
from .draw import Picture, off_screen_of
from .parts import Body, Mesh
from .skin import Skin
from .snapshot import Snapshot
from .world import World


def _log_of(log: Callable[[int, str], None]) -> Any:
    return c.LOG(lambda _, level, sentence: log(level, sentence.decode(errors="replace")))


def _find_of(find: Callable[[str], int | None]) -> Any:
    return c.FIND(lambda name: find(name.decode()) or 0)


class Context(Handle):
    """A device that simulates and, with OpenGL, a renderer. One thread at a time uses a context and what is made from it.

    backend: auto, cpu, gl or cl; device: for cl, its number or a part of its name; log: called with (level, sentence), levels 0 info, 1
    notice, 2 warning, 3 error; memory_limit: bytes, as in rivulet.h, 0 for no limit; threads: at most, 0 for all cores.
    off_screen: with an OpenGL context of its own, without a window, for World.picture and all that draws; it is current during calls only.
    find: instead the caller's own OpenGL context, which must be current in calls that need it: a function that returns the address of one of
    OpenGL's functions, find(name); plain_state: OpenGL's state is not restored, as in rivulet.h.
    sky_horizon, sky_zenith (3,): what the water reflects, radiance, by default a bright sky; sky_sun: (3,), towards the sun; all 0: a darker,
    grey-blue sky; clouds: 0 to 1.
    BadInput: no such backend. Error: it is not there, or there is no OpenGL 4.5."""

    def __init__(self, backend: str = "auto", device: str | None = None, log: Callable[[int, str], None] | None = None, memory_limit: int = 0,
                 threads: int = 0, off_screen: bool = False, find: Callable[[str], int | None] | None = None, plain_state: bool = False,
                 sky_horizon: ArrayLike = (2.2, 2.4, 2.6), sky_zenith: ArrayLike = (0.8, 1.1, 1.6), sky_sun: ArrayLike = (0, 0, 0),
                 clouds: float = 0.0) -> None:
        said = c.LOG(0) if log is None else _log_of(log)
        gl = OffScreen() if off_screen else None
        finder = gl.find if gl is not None else None if find is None else _find_of(find)
        options = struct(c.ContextOptions, find=None if finder is None else ctypes.cast(finder, c_void_p), backend=text_of(backend),
                         device=text_of(device), log=said, memory_limit=whole(memory_limit, 0, 2**63 - 1, "memory_limit"),
                         threads=whole(threads, 0, 2**31 - 1, "threads"), plain_state=int(plain_state), clouds=clouds,
                         sky_horizon=vector(sky_horizon, 3, "sky_horizon"), sky_zenith=vector(sky_zenith, 3, "sky_zenith"),
                         sky_sun=vector(sky_sun, 3, "sky_sun"))
        pointer = c_void_p()
        if gl is None:
            call("context_create", options, pointer)
        else:
            with gl:
                call("context_create", options, pointer)
        self._own("context", pointer, None, gl, said, finder)
        if gl is not None:
            gl.simulates = self.device.startswith("gl:")

    @property
    def device(self) -> str:
        """The device that simulates, "cpu: AMD EPYC, 2 threads"."""
        return str(lib.rivulet_context_device(self._pointer).decode())

    @property
    def memory(self) -> int:
        """Bytes in use now, by the device's buffers and by images."""
        return int(lib.rivulet_context_memory(self._pointer))

    def stop(self, stop: bool = True) -> None:
        """Interrupts steps, now and from now on, from any thread. World.step then raises an Error; after an interrupted step the world must
        be reset or restored. stop=False: steps run again."""
        lib.rivulet_context_stop(self._pointer, whole(stop, 0, 1, "stop"))

    def lost(self) -> None:
        """The caller's OpenGL context has ended: from now on no function of OpenGL is called, and what was made from this can be closed."""
        self._call("context_lost")

    def times(self) -> dict[str, tuple[float, int]]:
        """{pass: (ms, calls)} of the simulation since the last call, and of the last drawing. A GPU's times arrive two or three frames late."""
        count = c_size_t()
        self._call("context_times", None, 0, ctypes.byref(count))
        room = count.value + 16
        all = (c.PassTime * room)()
        self._call("context_times", all, room, ctypes.byref(count))
        return {t.name.decode(): (t.ms, t.calls) for t in all[:min(count.value, room)]}

    def set_surroundings(self, image: ArrayLike | None = None, texture: int = 0, turn: ArrayLike | None = None) -> None:
        """What the water reflects besides the picture itself, instead of the sky. image: (h, w, 3), linear radiance, an equirectangular map, row
        0 at the top (+y), -z in the middle, +x right of it; or texture: the name of an OpenGL texture, as rivulet_surroundings of rivulet.h;
        turn: (3, 3), a direction in the world -> in the map. Copied."""
        pixels = None if image is None else np.ascontiguousarray(array_of(image, (-1, -1, 3), "image")[::-1])
        matrix = array_or_none(turn, (3, 3), "turn")
        matrix = None if matrix is None else np.ascontiguousarray(matrix.T)
        height, width = (0, 0) if pixels is None else pixels.shape[:2]
        self._call("context_set_surroundings", struct(c.Surroundings, pixels=address_of(pixels), width=width, height=height, texture=texture,
                                                      turn=address_of(matrix)))

    def world(self, scene: Any = None, walls: Sequence[Mesh] = (), bodies: Sequence[Body] = (), body_host: Any = None,
              particles: ArrayLike | None = None, velocities: ArrayLike | None = None, skins_bring: float = 0.0) -> World:
        """A World of `scene`, a dict or a JSON text (the module's docstring says of what), with `walls` (Mesh) and `bodies` (Body).
        particles (n, 3), m, are there at t = 0 in addition to those of fluid.blocks: inside fluid.box, about fluid.spacing apart, with
        velocities (n, 3), m/s, None: at rest.
        body_host moves the bodies: advance(loads, gravity, seconds, states) changes `states`, an array with the fields position (m), rotation
        (x y z w), velocity (m/s) and spin (rad/s), by loads["force"] (N) and loads["torque"] (N m); reset(states) gets the states
        of t = 0; added(id, state) and removed(id), if it has them, are called when bodies come and go. With contacts(states, balls, seconds)
        and passed(seconds) a GPU moves the bodies and does not wait for advance: contacts returns the contacts that may act in a frame,
        while each centre of mass stays in its ball (n, 4): xyz and the radius (m), as an array of type CONTACT (its fields are those of
        rivulet_body_contact in docs/api.md), whose b is SOLID for a wall; None: only the host can move them. predict(loads, gravity, start, seconds, states) is as advance, from `start` (s from now) on, without
        an effect on later calls. Its arrays are copies, and what it raises comes out of the call. None: bodies collide with nothing but fluid.
        skins_bring: m^3 of water that drops of skins bring in 10 s, see World.step_skins; 0: none.
        BadInput: an unknown key, or a value out of its range."""
        return World(self, scene, walls, bodies, body_host, particles, velocities, skins_bring)

    def skin(self, mesh: Mesh, liquid: Any = None, map_size: int = 0) -> Skin:
        """A Skin: drops and films on `mesh`, a Mesh with uvs. liquid: a dict with keys of flow.N.liquid in a scene file; None: tears. map_size:
        texels of the map's edge, a power of two; 0: 1024."""
        return Skin(self, mesh, liquid, map_size)

    def snapshot(self) -> Snapshot:
        """An empty Snapshot, for worlds of this context."""
        return Snapshot(self)

    def picture(self, width: int, height: int, linear: bool = False) -> Picture:
        """A Picture of that many pixels, 1 to 16384 each way, filled with the default background. linear: float32, linear radiance, else bytes,
        sRGB. BadInput: the context is not of off_screen."""
        picture = Picture(off_screen_of(self), width, height, linear)
        picture.fill()
        return picture
