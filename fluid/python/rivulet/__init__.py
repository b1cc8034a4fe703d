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
import ctypes
import ctypes.util
import glob
import json
import os
from collections import namedtuple
from ctypes import POINTER, Structure, c_char_p, c_double, c_float, c_int, c_int32, c_size_t, c_uint32, c_uint64, c_void_p

import numpy as np

__all__ = ["BadInput", "Body", "Box", "Context", "Error", "Mesh", "Particles", "Skin", "Sphere", "World", "version"]


class Error(RuntimeError):
    """A call failed, for example for lack of memory."""


class BadInput(Error, ValueError):
    """An argument or the order of calls is wrong."""


# ---- rivulet.h, struct by struct

_LOG = ctypes.CFUNCTYPE(None, c_void_p, c_int, c_char_p)


class _Why(Structure):
    _fields_ = [("message", ctypes.c_char * 1024)]


class _ContextOptions(Structure):
    _fields_ = [("size", c_size_t), ("find", c_void_p), ("backend", c_char_p), ("device", c_char_p), ("log", _LOG), ("log_user", c_void_p),
                ("memory_limit", c_size_t), ("sky_horizon", c_float * 3), ("sky_zenith", c_float * 3), ("sky_sun", c_float * 3),
                ("clouds", c_float), ("threads", c_int32), ("jobs", c_void_p), ("memory", c_void_p)]


class _Mesh(Structure):
    _fields_ = [("size", c_size_t), ("positions", c_void_p), ("vertices", c_size_t), ("indices", c_void_p), ("indices_count", c_size_t),
                ("uvs", c_void_p), ("friction", c_float), ("restitution", c_float), ("moves", c_uint32), ("resolution", c_int32),
                ("position", c_float * 3), ("rotation", c_float * 4), ("reach_low", c_float * 3), ("reach_high", c_float * 3),
                ("layers", c_uint32), ("meets", c_uint32)]


class _Body(Structure):
    _fields_ = [("size", c_size_t), ("samples", c_void_p), ("samples_count", c_size_t), ("mass", c_float), ("inertia", c_float * 3),
                ("volume", c_float), ("position", c_float * 3), ("rotation", c_float * 4), ("mesh", POINTER(_Mesh)), ("density", c_float),
                ("velocity", c_float * 3), ("spin", c_float * 3), ("layers", c_uint32), ("meets", c_uint32)]


_POSE = np.dtype([("position", np.float32, 3), ("rotation", np.float32, 4)])
_STATE = np.dtype(_POSE.descr + [("velocity", np.float32, 3), ("spin", np.float32, 3)])
_LOAD = np.dtype([("force", np.float64, 3), ("torque", np.float64, 3)])
_ADVANCE = ctypes.CFUNCTYPE(None, c_void_p, c_void_p, POINTER(c_float * 3), c_double, c_void_p, c_size_t)
_RESET = ctypes.CFUNCTYPE(None, c_void_p, c_void_p, c_size_t)


_SAMPLE = np.dtype([("density", np.float32), ("velocity", np.float32, 3), ("gradient", np.float32, 3)])
_RAY = np.dtype([("origin", np.float32, 3), ("direction", np.float32, 3), ("reach", np.float32)])
_HIT = np.dtype([("hit", np.uint32), ("inside", np.uint32), ("distance", np.float32), ("place", np.float32, 3), ("normal", np.float32, 3),
                 ("velocity", np.float32, 3)])
_HIT_RESULT = np.dtype([("hit", bool), ("inside", bool)] + _HIT.descr[2:])
_VOLUME = np.dtype([("id", np.uint32), ("shape", np.int32), ("position", np.float32, 3), ("size", np.float32, 3), ("radius", np.float32)])
_COUNT = np.dtype([("id", np.uint32), ("entered", np.uint64), ("left", np.uint64), ("inside", np.uint64), ("time", np.float64),
                   ("volume_inside", np.float64)], align=True)
_MOST_VOLUMES = 32
_LOADS = np.dtype([("name", "S64"), ("time", np.float64), ("seconds", np.float64), ("force", np.float64, 3), ("torque", np.float64, 3),
                   ("pressure", np.float64), ("impulse", np.float64, 3), ("angular_impulse", np.float64, 3)])


class _BodyHost(Structure):
    _fields_ = [("size", c_size_t), ("user", c_void_p), ("advance", _ADVANCE), ("reset", _RESET), ("added", c_void_p), ("removed", c_void_p)]


class _WorldOptions(Structure):
    _fields_ = [("size", c_size_t), ("json", c_char_p), ("walls", POINTER(_Mesh)), ("walls_count", c_size_t), ("bodies", POINTER(_Body)),
                ("bodies_count", c_size_t), ("body_host", POINTER(_BodyHost)), ("particles", c_void_p), ("particle_velocities", c_void_p),
                ("particles_count", c_size_t)]


class _Inputs(Structure):
    _fields_ = [("size", c_size_t), ("gravity", c_void_p), ("poses", c_void_p), ("poses_count", c_size_t)]


class _Stats(Structure):
    _fields_ = [("size", c_size_t), ("time", c_double), ("dropped", c_double), ("particles", c_uint32), ("lost", c_uint32), ("average_compression", c_double),
                ("kinetic", c_double), ("potential", c_double), ("maximum_speed", c_double), ("centre_of_mass", c_double * 3),
                ("substeps", c_int32), ("asleep", c_uint32)]


class _PassTime(Structure):
    _fields_ = [("name", ctypes.c_char * 64), ("ms", c_double), ("calls", ctypes.c_int32)]


class _Particles(Structure):
    _fields_ = [("size", c_size_t), ("capacity", c_size_t), ("positions", c_void_p), ("velocities", c_void_p), ("densities", c_void_p),
                ("ids", c_void_p), ("count", c_size_t), ("attributes", c_void_p * 4)]


class _SkinOptions(Structure):
    _fields_ = [("size", c_size_t), ("mesh", POINTER(_Mesh)), ("json", c_char_p), ("map_size", c_int32)]


class _SkinInputs(Structure):
    _fields_ = [("size", c_size_t), ("gravity", c_void_p), ("wind", c_void_p), ("to_world", c_void_p), ("positions", c_void_p)]


class _SkinStats(Structure):
    _fields_ = [("size", c_size_t), ("drops", c_uint64), ("added", c_double), ("on_skin", c_double), ("left", c_double), ("evaporated", c_double),
                ("refused", c_double)]


Stats = namedtuple("Stats", [name for name, _ in _Stats._fields_[1:]])
Stats.__doc__ = "time, dropped (s); particles, lost; average_compression; kinetic, potential (J); maximum_speed (m/s); centre_of_mass (m); substeps; asleep, of the particles."
SkinStats = namedtuple("SkinStats", [name for name, _ in _SkinStats._fields_[1:]])
SkinStats.__doc__ = "drops; added, on_skin, left, evaporated, refused (m^3)."
Box = namedtuple("Box", ["id", "position", "size"])
Box.__doc__ = "A volume that counts particles: id, chosen by the caller; position (m) of its centre; size (m)."
Sphere = namedtuple("Sphere", ["id", "position", "radius"])
Sphere.__doc__ = "A volume that counts particles: id, chosen by the caller; position (m) of its centre; radius (m)."
Particles = namedtuple("Particles", ["positions", "velocities", "densities", "ids"])
Particles.__doc__ = "positions (n, 3) m, velocities (n, 3) m/s, densities (n,) over rest density: float32; ids (n,): uint32. Their order changes from step to step; ids do not."


def _load():
    here, prefix = os.path.dirname(os.path.abspath(__file__)), ("..",) * 4  # of share/rivulet/python/rivulet
    places = [os.environ.get("RIVULET_LIBRARY")]
    places += [os.path.join(here, *up, "librivulet.so") for up in ((), ("..", "..", "lib"), (*prefix, "lib"), (*prefix, "lib64"))]
    places += sorted(glob.glob(os.path.join(here, *prefix, "lib", "*", "librivulet.so")))  # lib/x86_64-linux-gnu
    for place in filter(None, places):
        if os.path.exists(place):
            return ctypes.CDLL(place)
    found = ctypes.util.find_library("rivulet")
    if found is None:
        raise ImportError("librivulet.so was not found: set the environment variable RIVULET_LIBRARY to its path")
    return ctypes.CDLL(found)


_lib = _load()
_handle, _why = POINTER(c_void_p), POINTER(_Why)
for _name, _arguments in {
        "context_create": [POINTER(_ContextOptions), _handle],
        "context_times": [c_void_p, POINTER(_PassTime), c_size_t, POINTER(c_size_t)], "world_create": [c_void_p, POINTER(_WorldOptions), _handle],
        "world_step": [c_void_p, POINTER(_Inputs), c_double], "world_reset": [c_void_p], "world_set": [c_void_p, c_char_p],
        "world_stats": [c_void_p, POINTER(_Stats)], "world_particles": [c_void_p, POINTER(_Particles)],
        "world_bodies": [c_void_p, c_void_p, c_size_t], "world_add_body": [c_void_p, POINTER(_Body), POINTER(c_uint32)],
        "world_remove_body": [c_void_p, c_uint32], "world_body": [c_void_p, c_uint32, POINTER(c_int32), c_void_p, c_void_p],
        "world_body_ids": [c_void_p, c_void_p, c_size_t, POINTER(c_size_t)],
        "world_sample": [c_void_p, c_void_p, c_size_t, c_void_p],
        "world_cast": [c_void_p, c_void_p, c_size_t, c_void_p], "world_heights": [c_void_p, c_void_p, c_size_t, c_void_p],
        "world_wetness": [c_void_p, c_void_p, c_size_t, c_void_p],
        "world_set_attribute": [c_void_p, ctypes.c_uint32, c_void_p, c_void_p, c_size_t],
        "world_paint": [c_void_p, ctypes.c_uint32, c_void_p, c_void_p],
        "world_set_volumes": [c_void_p, c_void_p, c_size_t], "world_volumes": [c_void_p, c_void_p, c_size_t, POINTER(c_size_t)],
        "world_volume_events": [c_void_p, c_void_p, c_size_t, POINTER(c_size_t)],
        "world_loads": [c_void_p, c_void_p, c_size_t, POINTER(c_size_t)], "world_export": [c_void_p, c_char_p],
        "world_export_surface": [c_void_p, c_char_p], "world_save": [c_void_p, c_char_p], "world_restore": [c_void_p, c_char_p],
        "skin_create": [c_void_p, POINTER(_SkinOptions), _handle], "skin_add": [c_void_p, c_void_p, c_double],
        "skin_step": [c_void_p, POINTER(_SkinInputs), c_double], "skin_stats_of": [c_void_p, POINTER(_SkinStats)]}.items():
    getattr(_lib, "rivulet_" + _name).argtypes = _arguments + [_why]
for _name in ("context", "world", "skin"):
    getattr(_lib, f"rivulet_{_name}_destroy").argtypes = [c_void_p]
    getattr(_lib, f"rivulet_{_name}_destroy").restype = None
_lib.rivulet_version.restype = _lib.rivulet_context_device.restype = c_char_p
_lib.rivulet_context_device.argtypes = _lib.rivulet_context_memory.argtypes = [c_void_p]
_lib.rivulet_context_memory.restype = c_size_t
_lib.rivulet_context_stop.argtypes = [c_void_p, ctypes.c_uint32]
_lib.rivulet_context_stop.restype = None


def version():
    """The version of the library, "0.1.0"."""
    return _lib.rivulet_version().decode()


def _call(name, *arguments):
    why = _Why()
    status = getattr(_lib, "rivulet_" + name)(*arguments, ctypes.byref(why))
    if status != 0:
        raise (BadInput if status == 2 else Error)(why.message.decode(errors="replace"))


def _struct(kind, **fields):
    return kind(size=ctypes.sizeof(kind), **fields)


def _array(values, shape, what, dtype=np.float32):
    """A contiguous array of that type and shape, where -1 is any length. None stays None."""
    if values is None:
        return None
    array = np.ascontiguousarray(values, dtype)
    if array.ndim != len(shape) or any(n not in (-1, m) for n, m in zip(shape, array.shape)):
        raise BadInput(f"{what} has the shape {array.shape}: give {shape}, where -1 is any length")
    return array


def _at(array):
    return None if array is None else array.ctypes.data


def _text(scene):
    if scene is None:
        return None
    text = scene if isinstance(scene, str) else json.dumps(scene, default=lambda value: value.tolist())  # of NumPy's
    if "\0" in text:
        raise BadInput("a text contains a character of value 0: remove it")
    return text.encode()


def _whole(value, low, high, what):
    """`value` as an int, checked against its range in C."""
    if int(value) != value or not low <= value <= high:
        raise BadInput(f"{what} is {value}: give a whole number from {low} to {high}")
    return int(value)


class _Handle:
    """Destroyed at the end of its `with`, by close(), or with the last reference."""

    _kind = ""
    _pointer = None

    def close(self):
        if self._pointer and _lib is not None:  # None: Python is shutting down
            getattr(_lib, f"rivulet_{self._kind}_destroy")(self._pointer)
        self._pointer = None

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    def __reduce__(self):
        raise TypeError(f"a {type(self).__name__} cannot be copied: create another")

    def __del__(self):
        self.close()


class Context(_Handle):
    """A device that simulates. backend: auto, cpu or cl; device: for cl, its number or a part of its name; log: called with (level, sentence),
    levels 0 info to 3 error; memory_limit: bytes, as in rivulet.h, 0 for no limit; threads: at most, 0 for all cores. Close it after its
    worlds and skins."""

    _kind = "context"

    def __init__(self, backend="auto", device=None, log=None, memory_limit=0, threads=0):
        self._log = _LOG(0) if log is None else _LOG(lambda _, level, sentence: log(level, sentence.decode(errors="replace")))
        options = _struct(_ContextOptions, backend=_text(backend), device=_text(device), log=self._log,
                        memory_limit=_whole(memory_limit, 0, 2**63, "memory_limit"), threads=_whole(threads, 0, 2**31, "threads"))
        pointer = c_void_p()
        _call("context_create", options, pointer)
        self._pointer = pointer

    @property
    def device(self):
        """The device that simulates, "cpu: AMD EPYC, 2 threads"."""
        return _lib.rivulet_context_device(self._pointer).decode()

    @property
    def memory(self):
        """Bytes in use now."""
        return _lib.rivulet_context_memory(self._pointer)

    def stop(self, stop=True):
        """Interrupts steps, now and from now on, from any thread. World.step then raises an Error; after an interrupted step the world must
        be reset or restored. stop=False: steps run again."""
        _lib.rivulet_context_stop(self._pointer, int(stop))

    def times(self):
        """{pass: (ms, calls)} of the simulation since the last call. A GPU's times arrive two or three frames late."""
        count = c_size_t()
        _call("context_times", self._pointer, None, 0, ctypes.byref(count))
        room = count.value + 16
        all = (_PassTime * room)()
        _call("context_times", self._pointer, all, room, ctypes.byref(count))
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


class Mesh:
    """positions (m, n x 3), indices (of triangles, k x 3), uvs (n x 2; for skins). Of a wall: friction and restitution (negative: those of
    fluid.collision), moves (it moves rigidly with World.step's poses), resolution (voxels along its longest side; 0: from the spacing), and if it
    moves its pose at t = 0: position (m), rotation (x y z w)."""

    def __init__(self, positions, indices, uvs=None, friction=-1.0, restitution=-1.0, moves=False, resolution=0, position=(0, 0, 0),
                 rotation=(0, 0, 0, 1)):
        self.positions, self.uvs = _array(positions, (-1, 3), "positions"), _array(uvs, (-1, 2), "uvs")
        if not (np.mod(indices, 1) == 0).all() or np.min(indices, initial=0) < 0 or np.max(indices, initial=0) >= 2**32:
            raise BadInput("indices must be whole numbers from 0 to 2**32 - 1")
        self.indices = _array(indices, (-1, 3), "indices", np.uint32)
        if uvs is not None and len(self.uvs) != len(self.positions):
            raise BadInput(f"{len(self.uvs)} uvs were given for {len(self.positions)} positions: give one for each")
        self._c = _struct(_Mesh, positions=_at(self.positions), vertices=len(self.positions), indices=_at(self.indices),
                        indices_count=self.indices.size, uvs=_at(self.uvs), friction=friction, restitution=restitution, moves=int(moves),
                        resolution=_whole(resolution, 0, 2**31 - 1, "resolution"), position=tuple(_array(position, (3,), "position")),
                        rotation=tuple(_array(rotation, (4,), "rotation")))


class Body:
    """A rigid body in the fluid. samples (m, n x 3): points half a spacing below its surface, about a spacing apart, relative to its centre of
    mass along its principal axes; mass (kg; 0: fixed), inertia (kg m^2, about those axes), volume (m^3). Or mesh, a closed Mesh, and density
    (kg/m^3): these are then found from it, and the body's frame is that of the mesh. Its pose at t = 0 or when it is added: position (m),
    rotation (x y z w); velocity (m/s), spin (rad/s). layers, meets: as rivulet.h, whether the water meets it."""

    def __init__(self, samples=None, mass=0.0, inertia=(0, 0, 0), volume=0.0, position=(0, 0, 0), rotation=(0, 0, 0, 1), mesh=None, density=0.0,
                 velocity=(0, 0, 0), spin=(0, 0, 0), layers=0, meets=0):
        self.samples, self.mesh = _array(samples, (-1, 3), "samples"), mesh
        self._c = _struct(_Body, samples=_at(self.samples), samples_count=0 if samples is None else len(self.samples), mass=mass, volume=volume,
                        inertia=tuple(_array(inertia, (3,), "inertia")), position=tuple(_array(position, (3,), "position")),
                        rotation=tuple(_array(rotation, (4,), "rotation")), mesh=None if mesh is None else ctypes.pointer(mesh._c),
                        density=density, velocity=tuple(_array(velocity, (3,), "velocity")), spin=tuple(_array(spin, (3,), "spin")),
                        layers=_whole(layers, 0, 65535, "layers"), meets=_whole(meets, 0, 65535, "meets"))


def _view(address, dtype, count):
    return np.frombuffer((ctypes.c_char * (dtype.itemsize * count)).from_address(address), dtype)


def _rows(volumes):
    rows = np.zeros(len(volumes), _VOLUME)
    for row, volume in zip(rows, volumes):
        row["id"], row["position"] = _whole(volume.id, 0, 2**32 - 1, "a volume's id"), volume.position
        if isinstance(volume, Box):
            row["size"] = volume.size
        else:
            row["shape"], row["radius"] = 1, volume.radius
    return rows


class World(_Handle):
    """Particles in a box, with walls and bodies; see Context.world."""

    _kind = "world"

    def __init__(self, context, scene, walls, bodies, body_host, particles, velocities):
        self._context, host = context, None
        placed, moving = _array(particles, (-1, 3), "particles"), _array(velocities, (-1, 3), "velocities")
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
                    theirs = _view(states, _STATE, count)
                    given = theirs.copy()
                    body_host.advance(_view(loads, _LOAD, count).copy(), np.array(gravity.contents), seconds, given)
                    theirs[:] = given
                guarded(work)

            def reset(_, states, count):
                guarded(lambda: body_host.reset(_view(states, _STATE, count).copy()))
            self._host = _struct(_BodyHost, advance=_ADVANCE(advance), reset=_RESET(reset))
            host = ctypes.pointer(self._host)
        options = _struct(_WorldOptions, json=_text(scene), walls=(_Mesh * len(walls))(*(w._c for w in walls)), walls_count=len(walls),
                        bodies=(_Body * len(bodies))(*(b._c for b in bodies)), bodies_count=len(bodies), body_host=host,
                        particles=_at(placed), particle_velocities=_at(moving), particles_count=count)
        pointer = c_void_p()
        self._checked("world_create", context._pointer, options, pointer)
        self._pointer = pointer
        fluid = json.loads(_text(scene)).get("fluid", {}) if scene else {}
        self._attributes = [attribute["name"] for attribute in fluid.get("attributes", [])]

    def _checked(self, *arguments):
        self._raised.clear()
        try:
            _call(*arguments)
        except Error as error:
            raise error from (self._raised[0] if self._raised else None)
        if self._raised:
            raise self._raised.pop()

    def step(self, seconds, gravity=None, poses=None):
        """Advances by a frame of `seconds`, in as many substeps as stability needs. gravity: m/s^2; poses: (n, 7), position (m) and rotation
        (x y z w) of the walls that move, at the end of the frame; None: as given before, after a reset those of t = 0."""
        gravity, poses = _array(gravity, (3,), "gravity"), _array(poses, (-1, 7), "poses")
        inputs = _struct(_Inputs, gravity=_at(gravity), poses=_at(poses), poses_count=0 if poses is None else len(poses))
        self._checked("world_step", self._pointer, inputs, seconds)

    def reset(self):
        """Back to t = 0."""
        self._checked("world_reset", self._pointer)

    def set(self, path, value):
        """Sets a parameter that docs/parameters.md does not call fixed: set("fluid.viscosity", 0.01)."""
        text = value if isinstance(value, str) else json.dumps(np.asarray(value).tolist())
        _call("world_set", self._pointer, _text(f"{path}={text}"))

    def stats(self):
        stats = _struct(_Stats)
        _call("world_stats", self._pointer, stats)
        values = {name: getattr(stats, name) for name in Stats._fields}
        return Stats(**{**values, "centre_of_mass": np.array(stats.centre_of_mass)})

    def particles(self):
        """All particles now, as Particles: arrays that later steps do not change."""
        asked = _struct(_Particles)
        _call("world_particles", self._pointer, asked)
        n = asked.count
        arrays = Particles(np.empty((n, 3), np.float32), np.empty((n, 3), np.float32), np.empty(n, np.float32), np.empty(n, np.uint32))
        asked = _struct(_Particles, capacity=n, **{name: _at(array) for name, array in zip(Particles._fields, arrays)})
        _call("world_particles", self._pointer, asked)
        return arrays

    def attributes(self):
        """The values of fluid.attributes now, by name, (n, 4) each: in the order of particles(), until the next step."""
        asked = _struct(_Particles)
        _call("world_particles", self._pointer, asked)
        arrays = {name: np.empty((asked.count, 4), np.float32) for name in self._attributes}
        asked = _struct(_Particles, capacity=asked.count)
        for k, values in enumerate(arrays.values()):
            asked.attributes[k] = _at(values)
        _call("world_particles", self._pointer, asked)
        return arrays

    def set_attribute(self, name, ids, values):
        """Sets an attribute of the particles with these ids: values (n, 4)."""
        ids, values = _array(ids, (-1,), "ids", np.uint32), _array(values, (-1, 4), "values")
        if len(ids) != len(values):
            raise BadInput(f"{len(values)} values were given for {len(ids)} particles: give one for each")
        _call("world_set_attribute", self._pointer, self._attribute(name), _at(ids), _at(values), len(ids))

    def paint(self, name, volume, value):
        """Sets an attribute of all particles that are in a volume now, a Box or Sphere: value (4,)."""
        _call("world_paint", self._pointer, self._attribute(name), _at(_rows([volume])), _at(_array(value, (4,), "value")))

    def _attribute(self, name):
        if name not in self._attributes:
            raise BadInput(f"'{name}' is no attribute: fluid.attributes has {', '.join(self._attributes) or 'none'}")
        return self._attributes.index(name)

    def bodies(self):
        """The states of the bodies now, in the order of body_ids: an array with the fields position (m), rotation (x y z w), velocity (m/s) and
        spin (rad/s)."""
        states = np.zeros(len(self.body_ids()), _STATE)
        _call("world_bodies", self._pointer, _at(states), len(states))
        return states

    def body_ids(self):
        """The ids of the bodies in the world: those given at the start have their index."""
        count = c_size_t()
        _call("world_body_ids", self._pointer, None, 0, ctypes.byref(count))
        ids = np.zeros(count.value, np.uint32)
        _call("world_body_ids", self._pointer, _at(ids), len(ids), ctypes.byref(count))
        return ids

    def body(self, id):
        """(state, load) of a body, with the fields of bodies() and force (N), torque (N m); None while it is made ready."""
        state, load, inside = np.zeros((), _STATE), np.zeros((), _LOAD), c_int32()
        _call("world_body", self._pointer, _whole(id, 0, 2**32 - 1, "id"), ctypes.byref(inside), _at(state), _at(load))
        return (state, load) if inside.value else None

    def add_body(self, body):
        """Adds a Body while the world runs, within the memory of fluid.bodies.maxSamples; returns its id. One with a mesh is made ready beside the
        frames, and is in the world from a later step on."""
        id = c_uint32()
        self._checked("world_add_body", self._pointer, body._c, id)
        return id.value

    def remove_body(self, id):
        self._checked("world_remove_body", self._pointer, _whole(id, 0, 2**32 - 1, "id"))

    def sample(self, places):
        """The water at places (n, 3), m: an array with the fields density (over the rest density; 0 in air), velocity (m/s) and gradient
        (1/m, of the density: points into the water)."""
        places = _array(places, (-1, 3), "places")
        samples = np.zeros(len(places), _SAMPLE)
        _call("world_sample", self._pointer, _at(places), len(places), _at(samples))
        return samples

    def cast(self, origins, directions, reach=0.0):
        """Where rays from origins (n, 3) along directions, (n, 3) or one for all, first cross the water's surface within reach (m; 0: no
        limit): an array with the fields hit, inside (the ray begins in water and this is where it leaves it), distance (m), place (m),
        normal (out of the water) and velocity (m/s)."""
        origins = _array(origins, (-1, 3), "origins")
        rays = np.zeros(len(origins), _RAY)
        rays["origin"] = origins
        for field, values in (("direction", directions), ("reach", reach)):
            try:
                rays[field] = values
            except ValueError:
                raise BadInput(f"{field} has the shape {np.shape(values)}: give one for each of {len(origins)} rays, or one for all") from None
        hits = np.zeros(len(rays), _HIT)
        _call("world_cast", self._pointer, _at(rays), len(rays), _at(hits))
        return hits.astype(_HIT_RESULT)

    def heights(self, places):
        """y (m) of the highest surface at each x, z of places (n, 2); NaN where there is no water."""
        places = _array(places, (-1, 2), "places")
        heights = np.zeros(len(places), np.float32)
        _call("world_heights", self._pointer, _at(places), len(places), _at(heights))
        return heights

    def wetness(self, places):
        """How wet solids are at places (n, 3), m, on their surface: 0 dry .. 1 wet."""
        places = _array(places, (-1, 3), "places")
        wet = np.zeros(len(places), np.float32)
        _call("world_wetness", self._pointer, _at(places), len(places), _at(wet))
        return wet

    def set_volumes(self, volumes):
        """Counts particles in these volumes, Box or Sphere, at most 32; they replace those set before."""
        rows = _rows(volumes)
        _call("world_set_volumes", self._pointer, _at(rows), len(rows))

    def _counts(self, name):
        counts, n = np.zeros(_MOST_VOLUMES, _COUNT), c_size_t()
        _call(name, self._pointer, _at(counts), len(counts), n)
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
        _call("world_loads", self._pointer, None, 0, n)
        loads = np.zeros(n.value, _LOADS)
        _call("world_loads", self._pointer, _at(loads), len(loads), n)
        return {load["name"].decode(): load for load in loads}

    def export(self, path):
        """Writes the particles as .ply, .vtp (ParaView) or .csv."""
        _call("world_export", self._pointer, os.fsencode(path))

    def export_surface(self, path):
        """Writes the water's surface as .obj or .ply."""
        _call("world_export_surface", self._pointer, os.fsencode(path))

    def save(self, path):
        """Saves all that the next step depends on to a file."""
        _call("world_save", self._pointer, os.fsencode(path))

    def restore(self, path):
        """Restores a file that save() wrote, of a world of the same scene; on the cpu the restored run is bit-identical."""
        self._checked("world_restore", self._pointer, os.fsencode(path))


class Skin(_Handle):
    """Drops and films on a mesh; see Context.skin."""

    _kind = "skin"

    def __init__(self, context, mesh, liquid, map_size):
        self._context, self._vertices = context, len(mesh.positions)
        options = _struct(_SkinOptions, mesh=ctypes.pointer(mesh._c), json=_text(liquid), map_size=map_size)
        pointer = c_void_p()
        _call("skin_create", context._pointer, options, pointer)
        self._pointer = pointer

    def add(self, place, microlitres):
        """Adds a drop, which appears with the next step, at the point of the skin nearest to `place` (m, in the mesh's frame)."""
        _call("skin_add", self._pointer, _at(_array(place, (3,), "place")), microlitres)

    def step(self, seconds, gravity=None, wind=None, to_world=None, positions=None):
        """gravity (m/s^2) and wind (m/s) in the world; to_world: the mesh's frame -> the world, 4 x 4, without scale; positions (m): the
        vertices of a mesh that deforms."""
        matrix = _array(to_world, (4, 4), "to_world")
        given = [_array(gravity, (3,), "gravity"), _array(wind, (3,), "wind"), None if matrix is None else np.ascontiguousarray(matrix.T),
                 _array(positions, (self._vertices, 3), "positions")]
        inputs = _struct(_SkinInputs, **dict(zip(("gravity", "wind", "to_world", "positions"), map(_at, given))))
        _call("skin_step", self._pointer, inputs, seconds)

    def stats(self):
        stats = _struct(_SkinStats)
        _call("skin_stats_of", self._pointer, stats)
        return SkinStats(**{name: getattr(stats, name) for name in SkinStats._fields})
