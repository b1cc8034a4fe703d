"""par.py FOLDER: what the package has as rivulet.h has it: memory without copies, pickles, states, walls, sources, buoyancy, lines, recordings,
drops in the air; and that other threads of Python run during a step."""
import gc
import os
import pickle
import sys
import threading
import time

import numpy as np
import rivulet

from refusals import refused

DROP = {"fluid": {"spacing": 0.05, "box": {"max": [1, 1.5, 1]}, "blocks": [{"min": [0.3, 1, 0.3], "max": [0.7, 1.4, 0.7]}]}}
CALM = {"fluid": {"spacing": 0.05, "box": {"max": [1, 1, 1]}, "blocks": [{"max": [1, 0.5, 1]}]}}


def bits(world):
    particles = world.particles()
    order = np.argsort(particles.ids)
    return particles.positions[order].tobytes() + particles.velocities[order].tobytes()


heard = []
with rivulet.Context(backend="cpu", log=lambda level, sentence: heard.append((level, sentence))) as context:
    # Memory without copies: the same values in the same order, read-only; it stays after the world is closed. One particle's rows are a view.
    dyed = {"fluid": {**DROP["fluid"], "attributes": [{"name": "dye", "y": 0.5}]}}
    world = context.world(dyed)
    for _ in range(3):
        world.step(1 / 60)
        rows, copies = world.rows(), world.particles()
        there = rows.densities >= 0
        for name in rivulet.Particles._fields:
            assert (getattr(rows, name)[there] == getattr(copies, name)).all() and not getattr(rows, name).flags.writeable
    assert not rows.positions.flags.owndata and np.shares_memory(rows.positions, world.rows().positions)
    assert (world.attribute_rows()["dye"][there] == world.attributes()["dye"]).all() and world.attributes()["dye"][0, 1] == 0.5
    used = context.memory
    kept = copies.positions.copy()
    world.close()
    assert context.memory == used and (rows.positions[there] == kept).all(), "memory that an array refers to was released"
    part = rows.positions[5:7]
    del rows, world
    gc.collect()
    assert context.memory == used and np.isfinite(part).all()
    del part
    gc.collect()
    assert context.memory < used, "memory was kept for no array"

    # Into arrays of the caller.
    with context.world(DROP) as world:
        room = rivulet.Particles(np.empty((600, 3), np.float32), np.empty((600, 3), np.float32), np.empty(600, np.float32), np.empty(600, np.uint32))
        filled = world.particles(out=room)
        assert len(filled.ids) == 512 and np.shares_memory(filled.positions, room.positions)
        assert all((a == b).all() for a, b in zip(filled, world.particles()))
        refused(lambda: world.particles(out=rivulet.Particles(*(array[:500] for array in room))), "room for 500", "512")
        refused(lambda: world.particles(out=room._replace(positions=np.empty((600, 3)))), "out.positions", "float64")

    # Pickles: scenes, meshes, bodies; a state as bytes, restored elsewhere to the bit. A world says what to pickle instead.
    plate = rivulet.Mesh([[0.2, 0.5, 0.2], [0.8, 0.5, 0.2], [0.8, 0.5, 0.8], [0.2, 0.5, 0.8]], [[0, 2, 1], [0, 3, 2]], friction=0.5)
    copied = pickle.loads(pickle.dumps(plate))
    assert (copied.positions == plate.positions).all() and copied._c.friction == 0.5 and (copied.indices == plate.indices).all()
    corners = np.array([(x, y, z) for x in (-0.1, 0.1) for y in (-0.06, 0.06) for z in (-0.1, 0.1)])
    faces = [(0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5), (0, 4, 5), (0, 5, 1), (2, 3, 7), (2, 7, 6), (0, 2, 6), (0, 6, 4), (1, 5, 7), (1, 7, 3)]
    crate = pickle.loads(pickle.dumps(rivulet.Body(mesh=rivulet.Mesh(corners, faces), density=500, position=(0.5, 0.9, 0.5))))
    assert abs(crate.mesh.positions - corners).max() < 1e-7 and crate._c.density == 500
    with context.world(DROP) as world, context.world(pickle.loads(pickle.dumps(DROP))) as other:
        for _ in range(5):
            world.step(1 / 60)
        other.set_state(pickle.loads(pickle.dumps(world.state())))
        for _ in range(5):
            world.step(1 / 60)
            other.step(1 / 60)
        assert bits(world) == bits(other)
        refused(lambda: pickle.dumps(world), "World.state()", kind=TypeError)
        refused(lambda: other.set_state(b"no state"), "state.rstate")

    # Another thread of Python looks at the clock while one step runs: the lock of the interpreter is not held.
    with context.world({"fluid": {"spacing": 0.02, "blocks": [{"max": [0.4, 0.6, 1]}]}}) as world:
        looks, stop = [], threading.Event()

        def look():
            while not stop.wait(0.001):
                looks.append(time.perf_counter())

        thread = threading.Thread(target=look)
        thread.start()
        start = time.perf_counter()
        world.step(0.05)
        took = time.perf_counter() - start
        stop.set()
        thread.join()
        within = [each for each in looks if start + 0.25 * took < each < start + 0.75 * took]
        assert within, f"in the middle of a step of {took:.2f} s another thread of Python did not run"

    # Walls that come and go: water falls through a plate once it is removed.
    with context.world(CALM, walls=[plate]) as world:
        assert world.wall(0) == "acts"
        added = world.add_wall(copied)
        assert added == 1
        while world.wall(added) == "bakes":
            world.step(1e-4)
        world.remove_wall(0)
        assert world.wall(added) == "acts"
        refused(lambda: world.wall(7), "7")
    # One that deforms: a floor of which each point rises by 0.2 m.
    floor = np.array([[-0.2, 0, -0.2], [1.2, 0, -0.2], [1.2, 0, 1.2], [-0.2, 0, 1.2]], np.float32)
    sheet = rivulet.Mesh(floor, [[0, 2, 1], [0, 3, 2]], deforms=True, reach=([-0.3, -0.1, -0.3], [1.3, 0.5, 1.3]))
    with context.world(DROP, walls=[sheet]) as world:
        for height in np.linspace(0.1, 0.3, 90):
            world.step(1 / 60, shapes=[floor + [0, height, 0]])
        low = world.particles().positions[:, 1].min()
        assert abs(low - (0.3 + 0.5 * 0.05)) < 0.1 * 0.05, low  # half a spacing above the floor; it may be pressed in by a tenth of one
        refused(lambda: world.step(1 / 60, shapes=[floor[:2], floor]), "shapes")

    # Sources: an emitter of 1 l/s fills, a second later 1 l are there.
    empty = {"fluid": {"spacing": 0.03, "box": {"max": [1, 1, 1]}, "maxParticles": 5000}}
    with context.world(empty) as world:
        world.set_sources(emitters=[{"position": [0.5, 0.5, 0.5], "direction": [0, -1, 0], "litresPerSecond": 1}])
        for _ in range(60):
            world.step(1 / 60)
        assert abs(world.stats().particles - 1e-3 / 0.03**3) < 1, world.stats().particles  # of 37: whole particles
        assert len(world.particles().ids) == len(np.unique(world.particles().ids)) == world.stats().particles
        before = len(world.particles().ids)
        for _ in range(10):  # more than there was room for, in the call before
            world.step(1 / 60)
        assert len(world.particles().ids) == world.stats().particles > before
        refused(lambda: world.set_sources(emitters=[{"litres": 1}]), "litres")
        parts = world.lines()
        assert set(parts["part"]) == {"box", "emitter"} and len(parts[parts["part"] == "box"]) == 12
        assert parts["start"].min() == 0 and parts["end"].max() == 1

    # Buoyancy: the lift of an object wholly under water is its weight of water; samples that arrive later are those of now.
    with context.world(CALM) as world:
        for _ in range(60):
            world.step(1 / 60)
        grid = np.array([(x, y, z) for x in (-0.05, 0.05) for y in (-0.05, 0.05) for z in (-0.05, 0.05)])
        ball = rivulet.Float(grid, np.full(8, 1e-3), mass=1, position=(0.5, 0.25, 0.5))
        loads = world.buoyancy([ball, pickle.loads(pickle.dumps(ball))], 0.01)
        # The lift takes the water's density about the points, a sum over particles, which is up to 3 % below that at rest. No drag, for it has none.
        assert np.allclose(loads["force"], [0, 8e-3 * 1000 * 9.81, 0], rtol=0.03, atol=0) and loads.shape == (2,), loads
        arrived = []
        world.sample_later([[0.5, 0.25, 0.5], [0.5, 0.9, 0.5]], arrived.append)
        assert len(arrived) == 1 and (arrived[0] == world.sample([[0.5, 0.25, 0.5], [0.5, 0.9, 0.5]])).all()

        def fails(samples):
            raise KeyError("sample")
        refused(lambda: world.sample_later([[0.5, 0.25, 0.5]], fails), "sample", kind=KeyError)
        assert not world._later

    # Wrong arguments are refused by a sentence that names them.
    three = np.zeros((3, 3))
    for indices, *words in (("abc", "indices"), (None, "indices"), ([[0], [0, 1]], "indices"), ([[0, 1, 0.5]], "whole numbers")):
        refused(lambda indices=indices: rivulet.Mesh(three, indices), *words)
    with context.world(DROP) as world:
        for work, *words in ((lambda: world.set("fluid.viscosity", object()), "JSON"), (lambda: world.set_state(5), "bytes"),
                             (lambda: world.set_state("abc"), "bytes"), (lambda: world.particles(5), "out is 5"),
                             (lambda: world.set_sources(5), "emitters is 5"), (lambda: world.set_sources(dry=[5]), "dry[0]"),
                             (lambda: world.set_volumes(5), "list of Box"), (lambda: world.set_volumes([rivulet.Box(1, "abc", (1, 1, 1))]), "position"),
                             (lambda: world.set_volumes([rivulet.Sphere(1, (0, 0, 0), "r")]), "radius"),
                             (lambda: world.sample_later(three, None), "then is None"), (lambda: context.snapshot().take(None), "world is None"),
                             (lambda: context.stop("x"), "stop is 'x'"), (lambda: rivulet.Context(backend="cpu", device="3"), "device", "set backend to cl")):
            refused(work, *words)
            try:
                work()
            except rivulet.BadInput as error:
                assert "--" not in str(error), error

    # Recordings: as many frames as steps, each with its time; a snapshot outlives its world.
    path = os.path.join(sys.argv[1], "fall.rrec")
    with context.world(DROP) as world, context.snapshot() as snapshot:
        with world.record(path):
            for _ in range(4):
                world.step(1 / 60)
        world.step(1 / 60)
        first, last = snapshot.replay(world, path, 0), snapshot.replay(world, path, 3)
        assert (first.frames, last.frames) == (4, 4) and abs(last.time - first.time - 3 / 60) < 1e-9
        refused(lambda: snapshot.replay(world, path, 4), "4")
        # The same path recorded again is read again; the file names the world's parameters.
        world.reset()
        with world.record(path):
            for _ in range(6):
                world.step(1 / 60)
        again = snapshot.replay(world, path, 5)
        assert again.frames == 6 and abs(again.time - 6 / 60) < 1e-9, again
        about = open(path, "rb").read(4096)
        assert b'run.version = %s\n' % rivulet.version().encode() in about and b"run.device = cpu: " in about and b'"spacing"' in about, about
        snapshot.take(world)
        refused(lambda: world.picture(rivulet.Camera((2, 2, 2), (0, 0, 0))), "off_screen=True")

    # Drops in the air above a pool: what a skin let go of is in the air, in the water or lost; nothing is missing.
    wall = rivulet.Mesh([[0.4, 0.7, 0.4], [0.6, 0.7, 0.4], [0.6, 0.9, 0.4], [0.4, 0.9, 0.4]], [[0, 1, 2], [0, 2, 3]],
                        uvs=[[0, 0], [1, 0], [1, 1], [0, 1]])
    pool = {"fluid": {"spacing": 0.05, "box": {"max": [1, 1, 1]}, "blocks": [{"max": [1, 0.3, 1]}]}}
    with context.world(pool, skins_bring=1e-4) as world, context.skin(wall, {"viscosity": 0.001}, map_size=64) as skin:
        skin.add((0.5, 0.72, 0.4), 60)
        most = 0
        for _ in range(90):
            world.step(1 / 60)
            air = world.step_skins([skin], 1 / 60, floor=-1, inputs=[{"wind": (0, 0, 0)}])
            most = max(most, len(world.air_drops()))
            assert len(world.air_drops()) == air.drops
        stats = skin.stats()
        assert most > 0 and stats.left > 0 and abs(stats.left - air.in_air - air.lost - air.into_water) < 1e-13, (stats, air)
        refused(lambda: world.step_skins([skin], 1 / 60, inputs=[{}, {}]), "2 inputs", "1 skins")

    # A host of bodies is called for those that come and go.
    class Host:
        said = []

        def advance(self, loads, gravity, seconds, states):
            pass

        def reset(self, states):
            self.said.append(("reset", len(states)))

        def added(self, id, state):
            self.said.append(("added", id, float(state["position"][1])))

        def removed(self, id):
            self.said.append(("removed", id))

    host = Host()
    ball = rivulet.Body([[0, 0, 0]], mass=1, inertia=(1, 1, 1), volume=1e-3, position=(0.5, 0.75, 0.5))
    with context.world({"fluid": {**CALM["fluid"], "bodies": {"maxSamples": 100}}}, body_host=host) as world:
        id = world.add_body(ball)
        world.step(1 / 60)
        world.remove_body(id)
        world.step(1 / 60)
    assert ("added", id, 0.75) in host.said and ("removed", id) in host.said, host.said

# A context that is closed before its world: both are released with the world.
context = rivulet.Context(backend="cpu", log=lambda level, sentence: heard.append((level, sentence)))
world = context.world(DROP)
context.close()
world.step(1 / 60)
world.close()
refused(lambda: rivulet.Context(backend="cpu", off_screen=False).picture(10, 10), "off_screen=True")
assert not [sentence for level, sentence in heard if level == 3], heard
print("all holds")
