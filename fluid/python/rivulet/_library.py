"""Finds librivulet.so, gives its functions their types, and turns arrays, texts and errors into those of C and back."""
from __future__ import annotations

import ctypes
import ctypes.util
import glob
import json
import os
from ctypes import POINTER, c_char_p, c_double, c_int32, c_size_t, c_uint32, c_void_p
from typing import Any, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _structs as c


class Error(RuntimeError):
    """A call failed, for example for lack of memory."""


class BadInput(Error, ValueError):
    """An argument or the order of calls is wrong."""


def _load() -> ctypes.CDLL:
    here, prefix = os.path.dirname(os.path.abspath(__file__)), "../../../.."  # of share/rivulet/python/rivulet
    named = os.environ.get("RIVULET_LIBRARY")
    if named:
        try:
            return ctypes.CDLL(named)
        except OSError as error:
            raise ImportError(f"the environment variable RIVULET_LIBRARY names {named}, which cannot be loaded: {error}; correct or unset it") from None
    places = [os.path.join(here, folder, "librivulet.so") for folder in ("", "../../lib", prefix + "/lib", prefix + "/lib64")]
    places += sorted(glob.glob(os.path.join(here, prefix, "lib", "*", "librivulet.so")))  # lib/x86_64-linux-gnu
    for place in places:
        if os.path.exists(place):
            try:
                return ctypes.CDLL(place)  # which lets other threads of Python run during a call
            except OSError as error:
                raise ImportError(f"{place} cannot be loaded: {error}; install the package again") from None
    found = ctypes.util.find_library("rivulet")
    if found is None:
        raise ImportError("librivulet.so was not found: set the environment variable RIVULET_LIBRARY to its path")
    return ctypes.CDLL(found)


lib = _load()
_handle, _why, _count = POINTER(c_void_p), POINTER(c.Why), POINTER(c_size_t)
_FUNCTIONS: dict[str, list[Any]] = {
    "context_create": [POINTER(c.ContextOptions), _handle], "context_lost": [c_void_p],
    "context_times": [c_void_p, POINTER(c.PassTime), c_size_t, _count],
    "context_set_surroundings": [c_void_p, POINTER(c.Surroundings)],
    "world_create": [c_void_p, POINTER(c.WorldOptions), _handle],
    "world_step": [c_void_p, POINTER(c.Inputs), c_double], "world_reset": [c_void_p], "world_set": [c_void_p, c_char_p],
    "world_stats": [c_void_p, POINTER(c.Stats)],
    "world_add_wall": [c_void_p, POINTER(c.Mesh), POINTER(c_uint32)], "world_remove_wall": [c_void_p, c_uint32],
    "world_wall": [c_void_p, c_uint32, POINTER(c_int32)], "world_set_sources": [c_void_p, c_char_p],
    "world_particles": [c_void_p, POINTER(c.Particles)], "world_rows": [c_void_p, POINTER(c.Rows)],
    "world_bodies": [c_void_p, c_void_p, c_size_t], "world_expected_bodies": [c_void_p, c_void_p, c_size_t],
    "world_add_body": [c_void_p, POINTER(c.Body), POINTER(c_uint32)],
    "world_remove_body": [c_void_p, c_uint32], "world_body": [c_void_p, c_uint32, POINTER(c_int32), c_void_p, c_void_p],
    "world_body_ids": [c_void_p, c_void_p, c_size_t, _count],
    "world_save": [c_void_p, c_char_p], "world_restore": [c_void_p, c_char_p],
    "world_sample": [c_void_p, c_void_p, c_size_t, c_void_p],
    "world_sample_later": [c_void_p, c_void_p, c_size_t, c.SAMPLES, c_void_p],
    "world_buoyancy": [c_void_p, POINTER(c.Float), c_size_t, c_void_p, c_double, c_void_p],
    "world_cast": [c_void_p, c_void_p, c_size_t, c_void_p], "world_heights": [c_void_p, c_void_p, c_size_t, c_void_p],
    "world_wetness": [c_void_p, c_void_p, c_size_t, c_void_p],
    "world_set_volumes": [c_void_p, c_void_p, c_size_t], "world_volumes": [c_void_p, c_void_p, c_size_t, _count],
    "world_volume_events": [c_void_p, c_void_p, c_size_t, _count],
    "world_set_attribute": [c_void_p, c_uint32, c_void_p, c_void_p, c_size_t],
    "world_paint": [c_void_p, c_uint32, c_void_p, c_void_p], "world_loads": [c_void_p, c_void_p, c_size_t, _count],
    "world_lines": [c_void_p, c.LINE, c_void_p], "world_export": [c_void_p, c_char_p], "world_export_surface": [c_void_p, c_char_p],
    "world_draw": [c_void_p, POINTER(c.View), POINTER(c.Target)], "world_buffers": [c_void_p, POINTER(c.Buffers)],
    "world_wet_solid": [c_void_p, c_int32, c_size_t, POINTER(c.WetSolid)],
    "skin_create": [c_void_p, POINTER(c.SkinOptions), _handle], "skin_add": [c_void_p, c_void_p, c_double],
    "skin_step": [c_void_p, POINTER(c.SkinInputs), c_double], "skin_texture": [c_void_p, POINTER(c_uint32)],
    "skin_stats_of": [c_void_p, POINTER(c.SkinStats)],
    "world_step_skins": [c_void_p, POINTER(c_void_p), POINTER(c.SkinInputs), c_size_t, c_double, POINTER(c.Air)],
    "world_air_drops": [c_void_p, c_void_p, c_size_t, _count],
    "snapshot_create": [c_void_p, _handle], "world_snapshot": [c_void_p, c_void_p], "world_record": [c_void_p, c_char_p],
    "snapshot_replay": [c_void_p, c_void_p, c_char_p, c_size_t, POINTER(c.Recorded)],
    "snapshot_draw": [c_void_p, POINTER(c.View), POINTER(c.Target)], "snapshot_buffers": [c_void_p, POINTER(c.Buffers)]}
functions = {_name: getattr(lib, "rivulet_" + _name) for _name in _FUNCTIONS}
for _name, _arguments in _FUNCTIONS.items():
    functions[_name].argtypes = _arguments + [_why]
for _name in ("context", "world", "skin", "snapshot"):
    getattr(lib, f"rivulet_{_name}_destroy").argtypes = [c_void_p]
    getattr(lib, f"rivulet_{_name}_destroy").restype = None
lib.rivulet_version.restype = lib.rivulet_context_device.restype = c_char_p
lib.rivulet_context_device.argtypes = lib.rivulet_context_memory.argtypes = [c_void_p]
lib.rivulet_context_memory.restype = c_size_t
lib.rivulet_context_stop.argtypes = [c_void_p, c_uint32]
lib.rivulet_context_stop.restype = None


def version() -> str:
    """The version of the library, "0.1.0"."""
    return str(lib.rivulet_version().decode())


# Remedies of the library in C, and the same in Python.
WORDS = {"--device selects": "device selects", "but --backend is": "but backend is", "or use --backend cl": "or set backend to cl",
         "set rivulet_context_options.find": "make the Context with off_screen=True, or with find",
         "copy them with rivulet_world_particles": "copy them with World.particles()",
         "set rivulet_body.mesh": "give the Body a mesh",
         "a stop is asked with rivulet_context_stop": "a stop is asked with Context.stop()",
         "is set with rivulet_world_set_sources": "is set with World.set_sources()",
         "end that with path NULL first": "close its Recording first",
         "mesh.uvs is NULL": "the Mesh has no uvs",
         "RIVULET_SOLID": "SOLID"}


def call(name: str, *arguments: Any) -> None:
    """Calls rivulet_`name`. Error, BadInput: with the library's sentence."""
    why = c.Why()
    status = functions[name](*arguments, why)
    if status != 0:
        sentence = why.message.decode(errors="replace")
        for ours, theirs in WORDS.items():
            sentence = sentence.replace(ours, theirs)
        raise (BadInput if status == 2 else Error)(sentence)


Struct = TypeVar("Struct", bound=ctypes.Structure)


def struct(of: type[Struct], **fields: Any) -> Struct:
    """A struct that begins with its `size`. BadInput: a member that is no number, where one belongs."""
    try:
        return of(size=ctypes.sizeof(of), **fields)
    except (TypeError, ctypes.ArgumentError):
        for name, value in fields.items():
            try:
                of(**{name: value})
            except (TypeError, ctypes.ArgumentError):
                raise BadInput(f"{name} is {value!r}: give a number") from None
        raise


def array_of(values: ArrayLike, shape: tuple[int, ...], what: str, dtype: Any = np.float32) -> NDArray[Any]:
    """A contiguous array of that type and shape, where -1 is any length: `values` itself where it is one already."""
    try:
        array = np.asarray(values, dtype, order="C")
    except (TypeError, ValueError, OverflowError) as error:
        raise BadInput(f"{what} is no array of {np.dtype(dtype)}: {error}") from None
    if not _fits(array, shape):
        raise BadInput(f"{what} has the shape {array.shape}: give {_text_of_shape(shape)}")
    return array


def _fits(array: NDArray[Any], shape: tuple[int, ...]) -> bool:
    return array.ndim == len(shape) and all(n in (-1, m) for n, m in zip(shape, array.shape))


def _text_of_shape(shape: tuple[int, ...]) -> str:
    return f"{shape}, where -1 is any length" if -1 in shape else str(shape)


def array_or_none(values: ArrayLike | None, shape: tuple[int, ...], what: str) -> NDArray[Any] | None:
    return None if values is None else array_of(values, shape, what)


def room_of(array: NDArray[Any], shape: tuple[int, ...], what: str, dtype: Any = np.float32) -> NDArray[Any]:
    """An array of the caller's own that the library writes into."""
    if not isinstance(array, np.ndarray):
        raise BadInput(f"{what} is {array!r}: give an array of {np.dtype(dtype)}, {_text_of_shape(shape)}")
    if not _fits(array, shape) or array.dtype != dtype or not array.flags.c_contiguous or not array.flags.writeable:
        raise BadInput(f"{what} is {array.dtype} of the shape {array.shape}: give a contiguous, writable array of {np.dtype(dtype)}, "
                       f"{_text_of_shape(shape)}")
    return array


def address_of(array: NDArray[Any] | None) -> int | None:
    return None if array is None else array.ctypes.data


def vector(values: ArrayLike, count: int, what: str) -> tuple[float, ...]:
    """A member of a struct that is an array of floats."""
    return tuple(array_of(values, (count,), what))


def view_of(address: int | None, dtype: Any, count: int) -> NDArray[Any]:
    """The memory at that address as an array, without a copy."""
    kind = np.dtype(dtype)
    return array_at((ctypes.c_char * (kind.itemsize * count)).from_address(address or 0), kind) if count else np.empty(0, kind)


def array_at(memory: Any, kind: np.dtype[Any]) -> NDArray[Any]:
    """Memory of ctypes as an array, which keeps it."""
    array: NDArray[Any] = np.frombuffer(memory, kind)
    return array


def _plain(value: Any) -> Any:
    if isinstance(value, (np.ndarray, np.generic)):
        return value.tolist()
    raise TypeError(f"JSON has no {type(value).__name__}")


def text_of(scene: Any) -> bytes | None:
    """A text as it is, and what else a JSON text can hold as that."""
    if scene is None:
        return None
    try:
        text = scene if isinstance(scene, str) else json.dumps(scene, default=_plain)
    except (TypeError, ValueError) as error:  # also: it holds itself
        raise BadInput(f"{error}: give a dict of numbers, texts, lists and dicts, or a JSON text") from None
    if "\0" in text:
        raise BadInput("a text contains a character of value 0: remove it")
    return text.encode()


def whole(value: float, low: int, high: int, what: str) -> int:
    """`value` as an int, checked against its range in C."""
    try:
        number = int(value)
        if number == value and low <= number <= high:
            return number
    except (TypeError, ValueError, OverflowError):
        pass
    raise BadInput(f"{what} is {value!r}: give a whole number from {low} to {high}")


def number_of(value: float, what: str) -> float:
    """For an argument of C that is a double."""
    try:
        if not isinstance(value, (str, bytes)):
            return float(value)
    except (TypeError, ValueError, OverflowError):
        pass
    raise BadInput(f"{what} is {value!r}: give a number")


def seconds_of(value: float) -> float:
    seconds = number_of(value, "seconds")
    if seconds < 0:
        raise BadInput(f"seconds is {value!r}: give 0 or more; time runs forwards")
    return seconds


def path_of(path: Any) -> bytes:
    try:
        return os.fsencode(path)
    except (TypeError, ValueError):
        raise BadInput(f"the path is {path!r}: give a text or a pathlib.Path") from None


Kind = TypeVar("Kind")


def of_kind(value: Any, kind: type[Kind], what: str) -> Kind:
    """An object of the package."""
    if not isinstance(value, kind):
        raise BadInput(f"{what} is {value!r}: give a {kind.__name__}")
    return value


def each_of(values: Any, kind: type[Kind], what: str) -> list[Kind]:
    """A sequence of objects of the package."""
    if not isinstance(values, (list, tuple)):
        raise BadInput(f"{what} is {values!r}: give a list of {kind.__name__}")
    return [of_kind(value, kind, f"{what}[{k}]") for k, value in enumerate(values)]
