"""OpenGL without a window, by libEGL: for pictures of a program that has no OpenGL context of its own."""
from __future__ import annotations

import ctypes
import os
import threading
from ctypes import c_char_p, c_int, c_ssize_t, c_uint, c_void_p
from types import TracebackType
from typing import Any, Callable, Iterator

from ._library import Error

_OPENGL_API, _EXTENSIONS = 0x30A2, 0x3055
_SURFACELESS, _DEVICE = 0x31DD, 0x313F  # platforms
_DRAW, _READ = 0x3059, 0x305A
# Of a context: version 4.5, core.
_ATTRIBUTES = (c_int * 7)(0x3098, 4, 0x30FB, 5, 0x30FD, 1, 0x3038)
_SOFTWARE = (b"llvmpipe", b"softpipe", b"swrast")
_REMEDY = "install a driver (on Debian: apt-get install libegl-mesa0 libgl1-mesa-dri)"
_users: set[int] = set()  # processes that have used OpenGL: this one, or those that it was forked from


def _forked() -> Error:
    return Error("a process that was forked cannot use OpenGL after its parent did: use the start method spawn "
                 '(multiprocessing.get_context("spawn"))')


def _library() -> ctypes.CDLL:
    try:
        egl = ctypes.CDLL("libEGL.so.1")
    except OSError:
        raise Error(f"libEGL.so.1 was not found, and without it there is no picture: {_REMEDY}") from None
    for name in ("GetDisplay", "GetPlatformDisplay", "CreateContext", "GetCurrentContext", "GetCurrentDisplay", "GetCurrentSurface",
                 "GetProcAddress"):
        getattr(egl, "egl" + name).restype = c_void_p
    egl.eglQueryString.restype = c_char_p
    egl.eglGetDisplay.argtypes = [c_void_p]
    egl.eglGetPlatformDisplay.argtypes = [c_uint, c_void_p, c_void_p]
    egl.eglInitialize.argtypes = [c_void_p] * 3
    egl.eglQueryString.argtypes = [c_void_p, c_int]
    egl.eglCreateContext.argtypes = [c_void_p] * 4
    egl.eglMakeCurrent.argtypes = [c_void_p] * 4
    egl.eglDestroyContext.argtypes = [c_void_p] * 2
    egl.eglGetProcAddress.argtypes = [c_char_p]
    return egl


def _after_fork() -> None:
    """In the new process. At its exit a driver would wait for threads that only its parent has, and would crash: the functions that drivers
    have registered for the exit of a process are not called. Those of Python are, and files are flushed."""
    process = ctypes.CDLL(None)
    if _users and hasattr(process, "on_exit"):
        process.on_exit(process._exit, None)  # called in reverse order: before those of the drivers, with the exit status
        process["__cxa_atexit"](process.fflush, None, None)


os.register_at_fork(after_in_child=_after_fork)


class OffScreen:
    """An OpenGL 4.5 core context without a surface; a GPU wins over a software renderer. Within `with` it is current on the calling thread,
    where any other context is current again afterwards. Error: there is none, or the process was forked from one that has used OpenGL."""

    simulates = False  # whether all functions of the library need it: with backend gl

    def __init__(self) -> None:
        self._process = os.getpid()
        if _users - {self._process}:
            raise _forked()
        _users.add(self._process)
        self._egl, self._context, self._before = _library(), None, threading.local()
        self._functions: dict[str, Any] = {}
        self._left: list[Callable[[], None]] = []  # work of later()
        for display in self._displays():
            context = self._made(display)
            if context is None:
                continue
            first, self._display, self._context = (self._context and (self._display, self._context)), display, context
            with self:
                software = any(name in (self.call("glGetString", "i", 0x1F01, result=c_char_p) or b"") for name in _SOFTWARE)
            if first and software:  # no better than the one before
                self._egl.eglDestroyContext(display, context)
                self._display, self._context = first
            elif first:
                self._egl.eglDestroyContext(*first)
            if not software:
                break
        if self._context is None:
            raise Error(f"this machine offers no OpenGL 4.5 without a window: {_REMEDY}")
        self.find = self._egl.eglGetProcAddress

    def _displays(self) -> Iterator[int]:
        """Those of Mesa without a surface, of each device, and the default one."""
        offered = (self._egl.eglQueryString(None, _EXTENSIONS) or b"").split()
        if b"EGL_MESA_platform_surfaceless" in offered:
            yield self._egl.eglGetPlatformDisplay(_SURFACELESS, None, None)
        query = self._egl.eglGetProcAddress(b"eglQueryDevicesEXT") if b"EGL_EXT_platform_device" in offered else None
        devices, count = (c_void_p * 16)(), c_int()
        if query and ctypes.CFUNCTYPE(c_uint, c_int, c_void_p, c_void_p)(query)(16, devices, ctypes.addressof(count)):
            for device in devices[:count.value]:
                yield self._egl.eglGetPlatformDisplay(_DEVICE, device, None)
        yield self._egl.eglGetDisplay(None)

    def _made(self, display: int | None) -> int | None:
        if not display or not self._egl.eglInitialize(display, None, None):
            return None
        offered = (self._egl.eglQueryString(display, _EXTENSIONS) or b"").split()
        if b"EGL_KHR_surfaceless_context" not in offered or b"EGL_KHR_no_config_context" not in offered or not self._egl.eglBindAPI(_OPENGL_API):
            return None
        made: int | None = self._egl.eglCreateContext(display, None, None, ctypes.addressof(_ATTRIBUTES))
        return made

    def call(self, name: str, kinds: str, *arguments: Any, result: Any = None) -> Any:
        """Calls a function of OpenGL; kinds: one letter an argument: i int, p pointer, z size."""
        if name not in self._functions:
            types = {"i": c_uint, "p": c_void_p, "z": c_ssize_t}
            address = self._egl.eglGetProcAddress(name.encode())
            self._functions[name] = ctypes.CFUNCTYPE(result, *(types[kind] for kind in kinds))(address)
        return self._functions[name](*arguments)

    def inherited(self) -> bool:
        """Whether another process made it, from which this one was forked."""
        return self._process != os.getpid()

    def later(self, work: Callable[[], None]) -> None:
        """Calls work() with the context current: now, or, if that is in use on another thread, as soon as it is not."""
        try:
            with self:
                work()
        except Error:
            self._left.append(work)

    def _do_left(self) -> None:
        while self._left:
            self._left.pop()()

    def __enter__(self) -> OffScreen:
        if self.inherited():  # a driver's threads and locks do not survive a fork: a call could wait for ever
            raise _forked()
        egl, here = self._egl, self._before
        api = egl.eglQueryAPI()
        egl.eglBindAPI(_OPENGL_API)  # of this thread
        before = (egl.eglGetCurrentDisplay(), egl.eglGetCurrentSurface(_DRAW), egl.eglGetCurrentSurface(_READ), egl.eglGetCurrentContext())
        if before[3] != self._context and not egl.eglMakeCurrent(self._display, None, None, self._context):
            egl.eglBindAPI(api)
            raise Error("the OpenGL context of this Context cannot be used here: it is in use on another thread")
        stack = here.__dict__.setdefault("stack", [])
        stack.append((api, before))
        if len(stack) == 1:
            self._do_left()
        return self

    def __exit__(self, kind: type[BaseException] | None, value: BaseException | None, trace: TracebackType | None) -> None:
        if len(self._before.stack) == 1:
            self._do_left()
        api, before = self._before.stack.pop()
        if before[3] != self._context:
            self._egl.eglMakeCurrent(*(before if before[3] else (self._display, None, None, None)))
        self._egl.eglBindAPI(api)

    def __del__(self) -> None:
        if self.__dict__.get("_context") and not self.inherited():
            self._egl.eglDestroyContext(self._display, self._context)
