"""Worlds: particles in a box, with walls and bodies."""
from __future__ import annotations

import ctypes
import json
import os
import tempfile
from ctypes import c_int32, c_size_t, c_uint32, c_void_p
from typing import Any, Callable, Mapping, Sequence

import numpy as np
from numpy.typing import ArrayLike

from . import _structs as c
from ._handle import Handle, Lease
from ._library import (BadInput, Error, address_of, array_at, array_of, array_or_none, call, each_of, number_of, of_kind, path_of, room_of, seconds_of,
                       struct, text_of, view_of, whole)
from .parts import Air, Array, Body, Box, Mesh, Particles, Sphere, Stats, rows_of
from .query import Path, Queries
from .skin import Skin
from .snapshot import Recording

_WALL_STATES = ("bakes", "acts", "leaves")


class Raised:
    """What functions of the caller have raised within a call: it is raised again after the library has returned, because an exception must not
    pass through C."""

    def __init__(self) -> None:
        self.errors: list[BaseException] = []

    def guard(self, work: Callable[[], None]) -> None:
        try:
            if not self.errors:
                work()
        except BaseException as what:
            self.errors.append(what)

    def checked(self, work: Callable[..., None], *arguments: Any) -> None:
        self.errors.clear()
        try:
            work(*arguments)
        except Error as error:
            raise error from (self.errors[0] if self.errors else None)
        if self.errors:
            raise self.errors.pop()


def _host_of(host: Any, raised: Raised) -> c.BodyHost:
    """rivulet_body_host of an object with its functions. It refers to no World, which must be destroyed before its context."""
    for name in ("advance", "reset"):
        if not callable(getattr(host, name, None)):
            raise BadInput(f"body_host has no function {name}: give an object with advance(loads, gravity, seconds, states) and reset(states)")

    def advance(_: Any, loads: int, gravity: Any, seconds: float, states: int, count: int) -> None:
        def work() -> None:  # copies: the library's memory is valid during the call only
            theirs = view_of(states, c.STATE, count)
            given = theirs.copy()
            host.advance(view_of(loads, c.LOAD, count).copy(), np.array(gravity.contents), seconds, given)
            theirs[:] = given
        raised.guard(work)

    def reset(_: Any, states: int, count: int) -> None:
        def work() -> None:
            host.reset(view_of(states, c.STATE, count).copy())
        raised.guard(work)

    def added(_: Any, id: int, state: int) -> None:
        def work() -> None:
            host.added(id, view_of(state, c.STATE, 1)[0].copy())
        raised.guard(work)

    def removed(_: Any, id: int) -> None:
        def work() -> None:
            host.removed(id)
        raised.guard(work)

    def contacts(_: Any, states: int, balls: int, count: int, seconds: float, add: Any, to: int) -> int:
        known = False

        def work() -> None:
            nonlocal known
            found = host.contacts(view_of(states, c.STATE, count).copy(), view_of(balls, np.float32, 4 * count).reshape(-1, 4).copy(), seconds)
            if found is None:
                return
            if isinstance(found, np.ndarray) and found.dtype.names not in (None, c.CONTACT.names):
                raise BadInput(f"contacts returned an array with the fields {found.dtype.names}: it must be of type CONTACT")
            theirs = np.asarray(found, c.CONTACT).reshape(-1)
            rows = np.empty(len(theirs), c.CONTACT_ROW)
            rows["size"] = c.CONTACT_ROW.itemsize
            for name in theirs.dtype.names or ():
                rows[name] = theirs[name]
            for k in range(len(rows)):
                add(to, rows.ctypes.data + k * rows.itemsize)
            known = True
        raised.guard(work)
        return int(known)

    def passed(_: Any, seconds: float) -> None:
        def work() -> None:
            host.passed(seconds)
        raised.guard(work)

    def predict(_: Any, loads: int, gravity: Any, start: float, seconds: float, states: int, count: int) -> None:
        def work() -> None:
            theirs = view_of(states, c.STATE, count)
            there = theirs.copy()
            host.predict(view_of(loads, c.LOAD, count).copy(), np.array(gravity.contents), start, seconds, there)
            theirs[:] = there
        raised.guard(work)

    def given(name: str, kind: Any, function: Any) -> Any:
        theirs = getattr(host, name, None)
        if theirs is not None and not callable(theirs):
            raise BadInput(f"body_host.{name} is {theirs!r}: give a function, or leave it out")
        return kind(0) if theirs is None else kind(function)

    return struct(c.BodyHost, advance=c.ADVANCE(advance), reset=c.RESET(reset), added=given("added", c.ADDED, added),
                  removed=given("removed", c.REMOVED, removed), contacts=given("contacts", c.CONTACTS, contacts),
                  passed=given("passed", c.PASSED, passed), predict=given("predict", c.PREDICT, predict))


class World(Queries):
    """Particles in a box, with walls and bodies; made by Context.world. Close it before, with or after its context."""

    _anew = "create another with Context.world()"
    _instead = "pickle its scene, walls and bodies, and World.state(); set_state() restores it in another world of these"

    def __init__(self, context: Handle, scene: Any, walls: Sequence[Mesh], bodies: Sequence[Body], body_host: Any,
                 particles: ArrayLike | None, velocities: ArrayLike | None, skins_bring: float) -> None:
        placed, moving = array_or_none(particles, (-1, 3), "particles"), array_or_none(velocities, (-1, 3), "velocities")
        count = 0 if placed is None else len(placed)
        if moving is not None and len(moving) != count:
            raise BadInput(f"{len(moving)} velocities were given for {count} particles: give one for each")
        self._raised, self._later, self._arrived, self._room = Raised(), {}, [], 0
        walls, bodies = each_of(walls, Mesh, "walls"), each_of(bodies, Body, "bodies")
        host = None if body_host is None else _host_of(body_host, self._raised)
        text = text_of(scene)
        options = struct(c.WorldOptions, json=text, walls=(c.Mesh * len(walls))(*(w._c for w in walls)), walls_count=len(walls),
                         bodies=(c.Body * len(bodies))(*(b._c for b in bodies)), bodies_count=len(bodies),
                         body_host=None if host is None else ctypes.pointer(host), particles=address_of(placed),
                         particle_velocities=address_of(moving), particles_count=count, skins_bring=skins_bring)
        pointer, owned = c_void_p(), context._owned

        def create() -> None:
            context._call("world_create", options, pointer)
            self._own("world", pointer, owned, owned.gl if owned else None, *([host] if host else []))

        self._raised.checked(create)
        fluid = json.loads(text).get("fluid", {}) if text else {}
        self._attributes = [attribute["name"] for attribute in fluid.get("attributes", [])]

    def _call(self, name: str, *arguments: Any) -> None:
        owned = self._owned
        if owned is not None and not owned.keeps and owned.gl is None:  # no function of the caller can be called: the short way of a step
            call(name, owned.pointer, *arguments)
            return
        try:
            self._raised.checked(super()._call, name, *arguments)
        finally:
            while self._arrived:
                self._later.pop(self._arrived.pop(), None)

    def step(self, seconds: float, gravity: ArrayLike | None = None, poses: ArrayLike | None = None,
             shapes: Sequence[ArrayLike | None] | None = None) -> None:
        """Advances by a frame of `seconds`, in as many substeps as stability needs; other threads of Python run meanwhile.
        gravity: (3,) m/s^2, None: fluid.gravity; poses: (n, 7), position (m) and rotation (x y z w) of the walls that move, at the end of the
        frame; None: as given before, after a reset those of t = 0; shapes: of each wall that deforms the positions of its vertices (n, 3), m,
        at the end of the frame; None: as before. Both in the order of the walls' ids.
        BadInput: values that are not finite or absurd. Error: out of memory; stopped by Context.stop."""
        if gravity is None and poses is None and shapes is None:
            self._call("world_step", None, seconds_of(seconds))
            return
        down, posed = array_or_none(gravity, (3,), "gravity"), array_or_none(poses, (-1, 7), "poses")
        kept = [array_or_none(shape, (-1, 3), f"shapes[{k}]") for k, shape in enumerate(shapes or ())]
        inputs = struct(c.Inputs, gravity=address_of(down), poses=address_of(posed), poses_count=0 if posed is None else len(posed))
        if kept:
            inputs.shapes, inputs.shapes_count = (c_void_p * len(kept))(*map(address_of, kept)), len(kept)
        self._call("world_step", inputs, seconds_of(seconds))

    def reset(self) -> None:
        """Back to t = 0."""
        self._call("world_reset")

    def set(self, path: str, value: Any) -> None:
        """Sets a parameter: set("fluid.viscosity", 0.01). BadInput: docs/parameters.md calls it fixed, or does not know it."""
        text = (text_of(value) or b"null").decode()
        self._call("world_set", text_of(f"{path}={text}"))

    def stats(self) -> Stats:
        """Numbers of the world now; on a GPU two or three frames old."""
        stats = struct(c.Stats)
        self._call("world_stats", stats)
        values: dict[str, Any] = {name: getattr(stats, name) for name in Stats._fields}
        values["centre_of_mass"] = np.array(stats.centre_of_mass)
        return Stats(**values)

    def _copied(self, arrays: Callable[[int], dict[str, Array]]) -> dict[str, Array]:
        """Arrays with room for so many particles, filled: once, unless there are more than before, because each call copies all from the
        device."""
        while True:
            made = arrays(self._room)
            asked = struct(c.Particles, capacity=self._room, **{name: address_of(made[name]) for name in Particles._fields if name in made})
            for k, name in enumerate(self._attributes):
                asked.attributes[k] = address_of(made.get("." + name))
            self._call("world_particles", asked)
            enough, self._room = asked.count <= self._room, int(asked.count)
            if enough:
                return {name: array[:asked.count] for name, array in made.items()}

    def particles(self, out: Particles | None = None) -> Particles:
        """All particles now: copies, which later steps do not change. out: Particles with room for as many as there are or more, arrays of
        the shapes and types of Particles, into which they are copied; the result's arrays are the parts of these that are filled. Waits for
        the device. rows() does not copy."""
        def kinds(room: int) -> dict[str, tuple[tuple[int, ...], Any]]:
            return dict(zip(Particles._fields, [((room, 3), np.float32), ((room, 3), np.float32), ((room,), np.float32), ((room,), np.uint32)]))

        if out is None:
            return Particles(**self._copied(lambda room: {name: np.empty(shape, kind) for name, (shape, kind) in kinds(room).items()}))
        room = len(of_kind(out, Particles, "out").ids)
        for name, (shape, kind) in kinds(room).items():
            room_of(getattr(out, name), shape, "out." + name, kind)
        asked = struct(c.Particles, capacity=room, **{name: address_of(array) for name, array in zip(Particles._fields, out)})
        self._call("world_particles", asked)
        if asked.count > room:
            raise BadInput(f"out has room for {room} particles, and there are {asked.count}: give larger arrays")
        return Particles(*(array[:asked.count] for array in out))

    def rows(self) -> Particles:
        """The particles in the memory of backend cpu: read-only views, no copies. A row whose density is negative holds no particle.
        Valid until the next step, reset or restore; after it they show old or mixed values, and the memory stays while an array refers to it.
        BadInput: another backend; use particles()."""
        rows = self._rows()
        positions = self._view(rows.positions, (np.float32, 4), rows.count)
        return Particles(positions[:, :3], self._view(rows.velocities, (np.float32, 4), rows.count)[:, :3], positions[:, 3],
                         self._view(rows.ids, np.uint32, rows.count))

    def attribute_rows(self) -> dict[str, Array]:
        """The values of fluid.attributes as rows() gives particles: (n, 4) each, in their order; views, no copies."""
        rows = self._rows()
        return {name: self._view(rows.attributes[k], (np.float32, 4), rows.count) for k, name in enumerate(self._attributes)}

    def _rows(self) -> c.Rows:
        rows = struct(c.Rows)
        self._call("world_rows", rows)
        return rows

    def _view(self, address: int | None, kind: Any, count: int) -> Array:
        """Memory of the world, which stays while the array or a view of it does."""
        item = np.dtype(kind)
        if count == 0 or self._owned is None:
            return np.empty((0, *item.shape), item.base)
        memory = (ctypes.c_char * (item.itemsize * count)).from_address(address or 0)
        memory.lease = Lease(self._owned)  # type: ignore[attr-defined]
        array = array_at(memory, item.base).reshape(count, *item.shape)
        array.flags.writeable = False
        return array

    def attributes(self) -> dict[str, Array]:
        """The values of fluid.attributes now, by name, (n, 4) float32 each: copies, in the order of particles() until the next step."""
        filled = self._copied(lambda room: {"." + name: np.empty((room, 4), np.float32) for name in self._attributes})
        return {name[1:]: array for name, array in filled.items()}

    def set_attribute(self, name: str, ids: ArrayLike, values: ArrayLike) -> None:
        """Sets an attribute of the particles with these ids (n,): values (n, 4), finite."""
        ids, values = array_of(ids, (-1,), "ids", np.uint32), array_of(values, (-1, 4), "values")
        if len(ids) != len(values):
            raise BadInput(f"{len(values)} values were given for {len(ids)} particles: give one for each")
        self._call("world_set_attribute", self._attribute(name), address_of(ids), address_of(values), len(ids))

    def paint(self, name: str, volume: Box | Sphere, value: ArrayLike) -> None:
        """Sets an attribute of all particles that are in a volume now: value (4,)."""
        value = array_of(value, (4,), "value")
        row = rows_of([volume])
        self._call("world_paint", self._attribute(name), address_of(row), address_of(value))

    def _attribute(self, name: str) -> int:
        if name not in self._attributes:
            raise BadInput(f"'{name}' is no attribute: fluid.attributes has {', '.join(self._attributes) or 'none'}")
        return self._attributes.index(name)

    def set_sources(self, emitters: Sequence[Mapping[str, Any]] = (), sinks: Sequence[Mapping[str, Any]] = (),
                    dry: Sequence[Mapping[str, Any]] = ()) -> None:
        """Sets all emitters, sinks and dry volumes, each a dict as in the scene; fluid.maxParticles reserves memory for what emitters spawn.
        With another number of emitters or sinks than before, all emitters begin again."""
        self._call("world_set_sources", text_of({name: each_of(given, dict, name) for name, given in (("emitters", emitters), ("sinks", sinks), ("dry", dry))}))

    def add_wall(self, wall: Mesh) -> int:
        """Adds a wall while the world runs; returns its id. It is baked beside the frames, 0.1 to 5 s, and acts from a later step on. Walls
        given at the start have their index as id."""
        id = c_uint32()
        self._call("world_add_wall", of_kind(wall, Mesh, "wall")._c, id)
        return id.value

    def remove_wall(self, id: int) -> None:
        """Removes a wall; it acts until the others are baked without it."""
        self._call("world_remove_wall", whole(id, 0, 2**32 - 1, "id"))

    def wall(self, id: int) -> str:
        """bakes (it does not act yet), acts, or leaves (it was removed, and acts until the others are baked). Error: its bake failed, and why.
        BadInput: there is no such wall."""
        state = c_int32()
        self._call("world_wall", whole(id, 0, 2**32 - 1, "id"), state)
        return _WALL_STATES[state.value]

    def bodies(self) -> Array:
        """The states of the bodies now, (n,) in the order of body_ids: the fields position (m), rotation (x y z w), velocity (m/s) and spin
        (rad/s). A copy."""
        states = np.zeros(len(self.body_ids()), c.STATE)
        self._call("world_bodies", address_of(states), len(states))
        return states

    def expected_bodies(self) -> Array:
        """As bodies(), without waiting for a GPU that moves them: continued from their states two or three frames earlier."""
        states = np.zeros(len(self.body_ids()), c.STATE)
        self._call("world_expected_bodies", address_of(states), len(states))
        return states

    def body_ids(self) -> Array:
        """(n,) uint32: the ids of the bodies in the world; those given at the start have their index."""
        count = c_size_t()
        self._call("world_body_ids", None, 0, ctypes.byref(count))
        ids = np.zeros(count.value, np.uint32)
        self._call("world_body_ids", address_of(ids), len(ids), ctypes.byref(count))
        return ids

    def body(self, id: int) -> tuple[Array, Array] | None:
        """(state, load) of a body, with the fields of bodies() and force (N), torque (N m); None while it is made ready."""
        state, load, inside = np.zeros((), c.STATE), np.zeros((), c.LOAD), c_int32()
        self._call("world_body", whole(id, 0, 2**32 - 1, "id"), ctypes.byref(inside), address_of(state), address_of(load))
        return (state, load) if inside.value else None

    def add_body(self, body: Body) -> int:
        """Adds a Body while the world runs, within the memory of fluid.bodies.maxSamples; returns its id. One with a mesh is made ready beside the
        frames, and is in the world from a later step on."""
        id = c_uint32()
        self._call("world_add_body", of_kind(body, Body, "body")._c, id)
        return id.value

    def remove_body(self, id: int) -> None:
        """Removes a body. BadInput: a probe measures it, or a dry volume moves with it."""
        self._call("world_remove_body", whole(id, 0, 2**32 - 1, "id"))

    def step_skins(self, skins: Sequence[Skin], seconds: float, gravity: ArrayLike | None = None, floor: float = 0.0,
                   inputs: Sequence[Mapping[str, Any]] = ()) -> Air:
        """Steps skins, as Skin.step does each, and the drops in the air between them, which belong to the world: what leaves a skin falls, lands
        on a skin that it meets, goes into the water or is lost below `floor` (m). After the world's step of the same `seconds`. inputs: for
        each skin a dict of arguments of Skin.step. Water is exchanged in a world with skins_bring above 0."""
        skins = each_of(skins, Skin, "skins")
        if inputs and len(inputs) != len(skins):
            raise BadInput(f"{len(inputs)} inputs were given for {len(skins)} skins: give one for each")
        made = [skin._inputs(**given) for skin, given in zip(skins, inputs)]
        down = array_or_none(gravity, (3,), "gravity")
        air = struct(c.Air, gravity=address_of(down), floor=number_of(floor, "floor"))
        self._call("world_step_skins", (c_void_p * len(skins))(*(skin._pointer for skin in skins)),
                   (c.SkinInputs * len(made))(*(each for each, _ in made)) if made else None, len(skins), seconds_of(seconds), air)
        return Air(*(getattr(air, name) for name in Air._fields))

    def air_drops(self) -> Array:
        """The drops in the air, (n, 4): x y z and radius, m. A copy."""
        count = c_size_t()
        self._call("world_air_drops", None, 0, ctypes.byref(count))
        drops = np.empty((count.value, 4), np.float32)
        self._call("world_air_drops", address_of(drops), len(drops), ctypes.byref(count))
        return drops

    def wet_solid(self, solid: str, id: int) -> dict[str, Any]:
        """For a material of the caller's own: where the wetness of a wall or body (solid: wall, body) with that id is in buffers(): from_world
        (4, 4), cells (3,) and first_cell, as rivulet_wet_solid of rivulet.h. BadInput: it does not get wet."""
        wet = struct(c.WetSolid)
        if solid not in ("wall", "body"):
            raise BadInput(f"solid is '{solid}': use wall or body")
        self._call("world_wet_solid", int(solid == "body"), whole(id, 0, 2**32 - 1, "id"), wet)
        return {"from_world": np.array(wet.from_world).reshape(4, 4).T, "cells": tuple(wet.cells), "first_cell": wet.first_cell}

    def record(self, path: Path) -> Recording:
        """Records what is drawn of the world into a file, a frame each step, until the Recording is closed. Snapshot.replay reads it."""
        return Recording(self, path)

    def save(self, path: Path) -> None:
        """Saves all that the next step depends on to a file. Error: it cannot be written."""
        self._call("world_save", path_of(path))

    def restore(self, path: Path) -> None:
        """Restores a file that save() wrote, of a world of the same scene; on the cpu the restored run is bit-identical. BadInput: it is of
        another scene, or damaged."""
        self._call("world_restore", path_of(path))

    def state(self) -> bytes:
        """What save() writes, in memory: it can be pickled and sent to another process."""
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "state.rstate")
            self.save(path)
            with open(path, "rb") as file:
                return file.read()

    def set_state(self, state: bytes) -> None:
        """Restores what state() returned, as restore() does."""
        if not isinstance(state, (bytes, bytearray, memoryview)):
            raise BadInput(f"the state is {state!r}: give the bytes that state() returned")
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "state.rstate")
            with open(path, "wb") as file:
                file.write(state)
            self.restore(path)
