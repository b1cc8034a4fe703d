"""Handles of the library as objects of Python: who owns them, and which OpenGL context their calls need."""
from __future__ import annotations

import os
import threading
from ctypes import c_void_p
from types import TracebackType
from typing import Any, NoReturn, TypeVar

from ._library import BadInput, Error, call, lib
from ._off_screen import OffScreen

_counting = threading.RLock()  # which a destructor may take while its own thread has it
# With backends cpu and cl these functions alone need OpenGL. While one of them runs on a thread, others may run on another.
_DRAWING = {"world_create", "skin_create", "snapshot_create", "skin_texture", "world_draw", "world_buffers", "snapshot_draw", "snapshot_buffers",
            "context_set_surroundings"}


def _after_fork() -> None:
    """In the new process, where no other thread runs that could hold the lock."""
    global _counting
    _counting = threading.RLock()


os.register_at_fork(after_in_child=_after_fork)


class Owned:
    """A handle of the library. It is destroyed when its object, all arrays in its memory and all that was made from it are gone, in the process
    that made it: one that was forked from it destroys nothing."""

    def __init__(self, kind: str, pointer: c_void_p, parent: Owned | None, gl: OffScreen | None, keeps: list[Any]) -> None:
        self.kind, self.pointer, self.parent, self.gl, self.users = kind, pointer, parent, gl, 1
        self.keeps = keeps  # functions of the caller, as long as the library may call them
        self.process = os.getpid()
        if parent is not None:
            parent.use()

    def use(self) -> None:
        with _counting:
            self.users += 1

    def inherited(self) -> bool:
        """Whether another process made it, from which this one was forked."""
        return self.process != os.getpid()

    def release(self) -> None:
        """Error: it would be destroyed, and its OpenGL context is in use on another thread; it then has its user still."""
        with _counting:
            self.users -= 1
            last = self.users == 0
        if not last or lib is None or self.inherited():  # None: Python is shutting down
            return
        destroy = getattr(lib, f"rivulet_{self.kind}_destroy")
        if self.gl is None:
            destroy(self.pointer)
        else:
            try:
                with self.gl:
                    destroy(self.pointer)
            except Error:
                self.use()
                raise
        if self.parent is not None:
            self.parent.release()


    def let_go(self) -> None:
        """As release(), for destructors: if the OpenGL context is in use on another thread, it is released later."""
        try:
            self.release()
        except Error:
            if self.gl is None:
                raise
            self.gl.later(self.release)


class Lease:
    """Keeps a handle while arrays refer to its memory."""

    def __init__(self, owned: Owned) -> None:
        self.owned = owned
        owned.use()

    def __del__(self) -> None:
        self.owned.let_go()


Self = TypeVar("Self", bound="Handle")


class Handle:
    """Closed at the end of its `with`, by close(), or with the last reference."""

    _owned: Owned | None = None
    _instead = _anew = "create another"  # than to copy it; than one that is closed

    def _own(self, kind: str, pointer: c_void_p, parent: Owned | None, gl: OffScreen | None, *keeps: Any) -> None:
        self._owned = Owned(kind, pointer, parent, gl, list(keeps))

    @property
    def _pointer(self) -> c_void_p:
        return self._open().pointer

    def _open(self) -> Owned:
        if self._owned is None:
            raise BadInput(f"the {type(self).__name__} is closed: {self._anew}")
        return self._owned

    def _call(self, name: str, *arguments: Any) -> None:
        """Calls rivulet_`name` of this handle, with its OpenGL context where that is needed."""
        owned = self._open()
        if owned.gl is None or (not owned.gl.simulates and name not in _DRAWING):
            call(name, owned.pointer, *arguments)
            return
        with owned.gl:
            call(name, owned.pointer, *arguments)

    def close(self) -> None:
        """Releases it. What was made from it stays valid until it is closed itself. Error: its OpenGL context is in use on another thread; close
        it again afterwards."""
        if self._owned is not None:
            self._owned.release()
            self._owned = None

    def __enter__(self: Self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, value: BaseException | None, trace: TracebackType | None) -> None:
        self.close()

    def __reduce__(self) -> NoReturn:
        raise TypeError(f"a {type(self).__name__} cannot be copied or pickled: {self._instead}")

    def __del__(self) -> None:
        if self._owned is not None:
            self._owned.let_go()
            self._owned = None
