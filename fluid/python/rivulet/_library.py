"""Finds librivulet.so, gives its functions their types, and turns arrays, texts and errors into those of C and back."""
import ctypes
import ctypes.util
import glob
import json
import os
from ctypes import POINTER, c_char_p, c_double, c_int32, c_size_t, c_uint32, c_void_p

import numpy as np

from . import _structs as c


class Error(RuntimeError):
    """A call failed, for example for lack of memory."""


class BadInput(Error, ValueError):
    """An argument or the order of calls is wrong."""


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


lib = _load()
_handle, _why = POINTER(c_void_p), POINTER(c.Why)
for _name, _arguments in {
        "context_create": [POINTER(c.ContextOptions), _handle],
        "context_times": [c_void_p, POINTER(c.PassTime), c_size_t, POINTER(c_size_t)], "world_create": [c_void_p, POINTER(c.WorldOptions), _handle],
        "world_step": [c_void_p, POINTER(c.Inputs), c_double], "world_reset": [c_void_p], "world_set": [c_void_p, c_char_p],
        "world_stats": [c_void_p, POINTER(c.Stats)], "world_particles": [c_void_p, POINTER(c.Particles)],
        "world_bodies": [c_void_p, c_void_p, c_size_t], "world_add_body": [c_void_p, POINTER(c.Body), POINTER(c_uint32)],
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
        "skin_create": [c_void_p, POINTER(c.SkinOptions), _handle], "skin_add": [c_void_p, c_void_p, c_double],
        "skin_step": [c_void_p, POINTER(c.SkinInputs), c_double], "skin_stats_of": [c_void_p, POINTER(c.SkinStats)]}.items():
    getattr(lib, "rivulet_" + _name).argtypes = _arguments + [_why]
for _name in ("context", "world", "skin"):
    getattr(lib, f"rivulet_{_name}_destroy").argtypes = [c_void_p]
    getattr(lib, f"rivulet_{_name}_destroy").restype = None
lib.rivulet_version.restype = lib.rivulet_context_device.restype = c_char_p
lib.rivulet_context_device.argtypes = lib.rivulet_context_memory.argtypes = [c_void_p]
lib.rivulet_context_memory.restype = c_size_t
lib.rivulet_context_stop.argtypes = [c_void_p, ctypes.c_uint32]
lib.rivulet_context_stop.restype = None


def version():
    """The version of the library, "0.1.0"."""
    return lib.rivulet_version().decode()


def call(name, *arguments):
    why = c.Why()
    status = getattr(lib, "rivulet_" + name)(*arguments, ctypes.byref(why))
    if status != 0:
        raise (BadInput if status == 2 else Error)(why.message.decode(errors="replace"))


def struct(kind, **fields):
    return kind(size=ctypes.sizeof(kind), **fields)


def array_of(values, shape, what, dtype=np.float32):
    """A contiguous array of that type and shape, where -1 is any length. None stays None."""
    if values is None:
        return None
    array = np.ascontiguousarray(values, dtype)
    if array.ndim != len(shape) or any(n not in (-1, m) for n, m in zip(shape, array.shape)):
        raise BadInput(f"{what} has the shape {array.shape}: give {shape}, where -1 is any length")
    return array


def address_of(array):
    return None if array is None else array.ctypes.data


def text_of(scene):
    if scene is None:
        return None
    text = scene if isinstance(scene, str) else json.dumps(scene, default=lambda value: value.tolist())  # of NumPy's
    if "\0" in text:
        raise BadInput("a text contains a character of value 0: remove it")
    return text.encode()


def whole(value, low, high, what):
    """`value` as an int, checked against its range in C."""
    if int(value) != value or not low <= value <= high:
        raise BadInput(f"{what} is {value}: give a whole number from {low} to {high}")
    return int(value)


class Handle:
    """Destroyed at the end of its `with`, by close(), or with the last reference."""

    _kind = ""
    _pointer = None

    def close(self):
        if self._pointer and lib is not None:  # None: Python is shutting down
            getattr(lib, f"rivulet_{self._kind}_destroy")(self._pointer)
        self._pointer = None

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    def __reduce__(self):
        raise TypeError(f"a {type(self).__name__} cannot be copied: create another")

    def __del__(self):
        self.close()


def view_of(address, dtype, count):
    return np.frombuffer((ctypes.c_char * (dtype.itemsize * count)).from_address(address), dtype)
