"""Contexts: a device that simulates."""
import ctypes
from ctypes import c_size_t, c_void_p

from . import _structs as c
from ._library import Handle, call, lib, struct, text_of, whole
from .skin import Skin
from .world import World


class Context(Handle):
    """A device that simulates. backend: auto, cpu or cl; device: for cl, its number or a part of its name; log: called with (level, sentence),
    levels 0 info to 3 error; memory_limit: bytes, as in rivulet.h, 0 for no limit; threads: at most, 0 for all cores. Close it after its
    worlds and skins."""

    _kind = "context"

    def __init__(self, backend="auto", device=None, log=None, memory_limit=0, threads=0):
        self._log = c.LOG(0) if log is None else c.LOG(lambda _, level, sentence: log(level, sentence.decode(errors="replace")))
        options = struct(c.ContextOptions, backend=text_of(backend), device=text_of(device), log=self._log,
                        memory_limit=whole(memory_limit, 0, 2**63, "memory_limit"), threads=whole(threads, 0, 2**31, "threads"))
        pointer = c_void_p()
        call("context_create", options, pointer)
        self._pointer = pointer

    @property
    def device(self):
        """The device that simulates, "cpu: AMD EPYC, 2 threads"."""
        return lib.rivulet_context_device(self._pointer).decode()

    @property
    def memory(self):
        """Bytes in use now."""
        return lib.rivulet_context_memory(self._pointer)

    def stop(self, stop=True):
        """Interrupts steps, now and from now on, from any thread. World.step then raises an Error; after an interrupted step the world must
        be reset or restored. stop=False: steps run again."""
        lib.rivulet_context_stop(self._pointer, int(stop))

    def times(self):
        """{pass: (ms, calls)} of the simulation since the last call. A GPU's times arrive two or three frames late."""
        count = c_size_t()
        call("context_times", self._pointer, None, 0, ctypes.byref(count))
        room = count.value + 16
        all = (c.PassTime * room)()
        call("context_times", self._pointer, all, room, ctypes.byref(count))
        return {t.name.decode(): (t.ms, t.calls) for t in all[:min(count.value, room)]}

    def world(self, scene=None, walls=(), bodies=(), body_host=None, particles=None, velocities=None):
        """A World of `scene`, with `walls` (Mesh) and `bodies` (Body).
        particles (m, n x 3) are there at t = 0 in addition to those of fluid.blocks: inside fluid.box, about fluid.spacing apart, with
        velocities (m/s, n x 3; None: at rest).
        body_host moves the bodies: advance(loads, gravity, seconds, states) changes `states`, an array with the fields position (m), rotation
        (x y z w), velocity (m/s) and spin (rad/s), by loads["force"] (N) and loads["torque"] (N m); reset(states) gets the states
        of t = 0. None: bodies collide with nothing but fluid."""
        return World(self, scene, walls, bodies, body_host, particles, velocities)

    def skin(self, mesh, liquid=None, map_size=0):
        """A Skin: drops and films on `mesh`, a Mesh with uvs. liquid: a dict with keys of flow.N.liquid in a scene file; None: tears."""
        return Skin(self, mesh, liquid, map_size)
