"""Snapshots: what a draw needs of a world, copied, so that the world can be stepped while the copy is drawn; and recorded frames."""
from __future__ import annotations

import os
from ctypes import c_void_p
from typing import TYPE_CHECKING, NamedTuple, Union

from . import _structs as c
from ._handle import Handle
from ._library import of_kind, path_of, struct, whole
from .draw import Drawn

if TYPE_CHECKING:
    from .world import World

Path = Union[str, "os.PathLike[str]"]


class Recorded(NamedTuple):
    """Of a recorded file: the number of its frames, and the time (s simulated) of the frame that was read."""

    frames: int
    time: float


class Snapshot(Drawn):
    """The water of a world as it was; made by Context.snapshot, drawn as a World is. With backend cpu or cl, one thread may draw it while
    another steps the world."""

    _kind = "snapshot"
    _instead = "record the world, and replay the file"

    def __init__(self, context: Handle) -> None:
        pointer = c_void_p()
        context._call("snapshot_create", pointer)
        owned = context._owned
        self._own("snapshot", pointer, owned, owned.gl if owned else None)

    def take(self, world: World) -> Snapshot:
        """Copies what is drawn of the world now, in place of what the snapshot held; returns the snapshot."""
        _world(world)._call("world_snapshot", self._pointer)
        return self

    def replay(self, world: World, path: Path, frame: int) -> Recorded:
        """Puts frame `frame` (from 0) of a file that World.record wrote into the snapshot, with the look and liquid of `world`, which is not
        changed. BadInput: it is no recording, is damaged or has no such frame."""
        recorded = struct(c.Recorded)
        self._call("snapshot_replay", _world(world)._pointer, path_of(path), whole(frame, 0, 2**63 - 1, "frame"), recorded)
        return Recorded(recorded.frames, recorded.time)


def _world(value: World) -> World:
    from .world import World
    return of_kind(value, World, "world")


class Recording:
    """A file that the steps of a world add their frames to; ended at the end of its `with`, by close(), or with the world."""

    def __init__(self, world: World, path: Path) -> None:
        self._world: World | None = world
        world._call("world_record", path_of(path))

    def close(self) -> None:
        """Ends the recording: the file is complete. Error: it cannot be written."""
        world, self._world = self._world, None
        if world is not None and world._owned is not None and not world._owned.inherited():
            world._call("world_record", None)

    def __enter__(self) -> Recording:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()
