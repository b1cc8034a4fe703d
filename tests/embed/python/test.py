"""test.py FOLDER: rivulet as an installed package: arrays, errors, callbacks, files; against what is known of falling water."""
import copy
import gc
import os
import pickle
import sys

import numpy as np
import rivulet

from refusals import refused

DROP = {"fluid": {"spacing": 0.05, "box": {"max": [1, 1.5, 1]}, "blocks": [{"min": [0.3, 1, 0.3], "max": [0.7, 1.4, 0.7]}]}}


def by_id(particles):
    return {name: array[np.argsort(particles.ids)] for name, array in particles._asdict().items()}


heard = []
assert issubclass(rivulet.BadInput, ValueError)
with rivulet.Context(backend="cpu", log=lambda level, sentence: heard.append((level, sentence))) as context:
    assert rivulet.version() == os.environ["RIVULET_EXPECTED"] and context.device.startswith("cpu: ")
    before = context.memory
    with context.world(DROP) as world:
        start = world.particles()
        assert context.memory > before
        assert start.positions.shape == start.velocities.shape == (512, 3) and start.densities.shape == start.ids.shape == (512,)
        assert start.positions.dtype == np.float32 and start.ids.dtype == np.uint32 and sorted(start.ids) == list(range(512))
        kept = start.positions.copy()
        for _ in range(15):
            world.step(1 / 60)
        assert (start.positions == kept).all(), "an array that was given does not change later"
        now = world.particles()
        assert abs(now.velocities[:, 1].mean() / (-9.81 * 0.25) - 1) < 0.02
        fallen = start.positions.mean(axis=0) - now.positions.mean(axis=0)
        assert np.allclose(fallen, [0, 0.5 * 9.81 * 0.25**2, 0], atol=0.015), fallen
        times = context.times()
        assert times["fluid/world/stats"][1] >= 15 and all(ms >= 0 and calls > 0 for ms, calls in times.values()), times
        assert not context.times(), "what was told is not told again"
        stats = world.stats()
        assert stats.particles == 512 and stats.lost == 0 and abs(stats.time - 0.25) < 1e-9
        assert np.allclose(stats.centre_of_mass, now.positions.mean(axis=0), atol=1e-4)
        path = os.path.join(sys.argv[1], "kept.rstate")
        world.save(path)
        with context.world(DROP) as other:
            other.restore(path)
            for one in (world, other):
                one.step(1 / 60)
            a, b = by_id(world.particles()), by_id(other.particles())
            assert all((a[name] == b[name]).all() for name in a)
        world.reset()
        assert (by_id(world.particles())["positions"] == by_id(start)["positions"]).all()
        for _ in range(6):
            world.step(1 / 60, gravity=(2, 0, 0))
        assert np.allclose(world.particles().velocities.mean(axis=0), [0.2, 0, 0], atol=0.01)
        world.set("fluid.viscosity", 0.01)
        world.set("fluid.gravity", (0, -1, 0))
        refused(lambda: world.set("fluid.spacing", 0.1), "fixed")
        refused(lambda: world.step(float("nan")), "finite")
        refused(lambda: world.step(0.01, gravity=(1, 2)), "shape")
        refused(lambda: world.step(0.01, gravity=(0, -3e38, 0)), "gravity")
        refused(lambda: world.step(1e300), "3600")
        refused(lambda: context.world({"fluid": {"blocks": [{"min": [2, 2, 2], "max": [3, 3, 3]}]}}), "fluid.blocks[0]", "outside fluid.box")
        refused(lambda: context.world({"emitters": [{"position": [0, 9, 0]}]}), "emitters[0].position", "outside fluid.box")
        refused(lambda: world.step(0.01, poses=[[0, 0, 0, 0, 0, 0, 1]]), "1 poses")
    assert context.memory == before
    refused(lambda: world.step(0.01), "the World is closed", "Context.world()")
    refused(world.stats, "the World is closed")

    # Particles of the caller's own: a lattice that turns about its centre, with the energy m w^2 r^2 / 2, again after a reset.
    places = np.stack(np.meshgrid(*[np.arange(0.325, 0.7, 0.05)] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
    turning = np.cross([0, 3, 0], places - 0.5)
    open_box = {"fluid": {"spacing": 0.05, "gravity": [0, 0, 0]}}
    with context.world(open_box, particles=places, velocities=turning) as world:
        energy = 0.5 * 1000 * 0.05**3 * (turning**2).sum()
        for _ in range(2):
            placed = by_id(world.particles())
            assert np.allclose(placed["positions"], places, atol=1e-6) and np.allclose(placed["velocities"], turning, atol=1e-6)
            world.step(0.001)
            assert abs(world.stats().kinetic / energy - 1) < 0.01, world.stats().kinetic / energy
            world.reset()
    with context.world(DROP, particles=places) as world:
        assert len(world.particles().ids) == 512 + len(places)
    refused(lambda: context.world(open_box, particles=places[:, :2]), "particles", "shape")
    refused(lambda: context.world(open_box, particles=places, velocities=turning[1:]), "511 velocities", "512 particles")
    refused(lambda: context.world(open_box, velocities=turning), "512 velocities", "0 particles")
    refused(lambda: context.world(open_box, particles=places + [0, np.nan, 0]), "particles[0]", "finite")
    refused(lambda: context.world(open_box, particles=places + [0, 0, 0.5]), "outside fluid.box", "enlarge")
    refused(lambda: context.world({"fluid": {**open_box["fluid"], "maxParticles": 100}}, particles=places), "fluid.maxParticles is 100", "512")

    # Attributes: set by id and in a volume, and carried along.
    tagged = {"fluid": {**open_box["fluid"], "attributes": [{"name": "dye", "w": 1}, {"name": "origin"}]}}
    with context.world(tagged, particles=places, velocities=turning) as world:
        first, start = world.particles(), world.attributes()
        assert (start["dye"] == [0, 0, 0, 1]).all() and (start["origin"] == 0).all() and len(start["dye"]) == 512
        world.set_attribute("origin", first.ids, np.hstack([first.positions, np.ones((512, 1))]))
        world.paint("dye", rivulet.Sphere(0, (0.5, 0.5, 0.5), 0.12), (1, 0, 0, 0))
        for _ in range(10):
            world.step(1 / 60)
        now, values = world.particles(), world.attributes()
        came = {i: place for i, place in zip(first.ids, first.positions)}
        assert all((came[i] == origin[:3]).all() for i, origin in zip(now.ids, values["origin"]))
        red = values["dye"][:, 0] == 1
        assert 20 < red.sum() < 200 and (red == (((values["origin"][:, :3] - 0.5) ** 2).sum(axis=1) <= 0.12**2)).all()
        refused(lambda: world.paint("team", rivulet.Sphere(0, (0, 0, 0), 1), (1, 0, 0, 0)), "'team' is no attribute", "dye, origin")
        refused(lambda: world.set_attribute("dye", [0, 1], [[0, 0, 0, 0]]), "1 values", "2 particles")
        refused(lambda: world.set_attribute("dye", [9999], [[0, 0, 0, 0]]), "ids[0] is 9999")

    # A pool at rest: what is asked of it is what is known of it.
    calm = {"fluid": {"spacing": 0.05, "box": {"max": [1, 1, 1]}, "blocks": [{"max": [1, 0.5, 1]}],
                      "probes": [{"name": "floor", "face": "-y"}, {"name": "wall", "face": "+x"}]}}
    with context.world(calm) as world:
        for _ in range(90):
            world.step(1 / 60)
        grid = np.array([(x, z) for x in (0.3, 0.5, 0.7) for z in (0.3, 0.7)])
        heights = world.heights(grid)
        assert heights.shape == (6,) and np.allclose(heights, 0.5, atol=0.025), heights
        assert np.isnan(world.heights([[3, 3]])).all()
        samples = world.sample([[0.5, 0.25, 0.5], [0.5, 0.9, 0.5], [0.4, 0.48, 0.4]])
        assert abs(samples["density"][0] - 1) < 0.1 and samples["density"][1] == 0 and (samples["velocity"][1] == 0).all()
        assert samples["gradient"][2, 1] < -1
        inside = world.sample([[x, y, z] for x in (0.25, 0.5, 0.75) for y in (0.1, 0.25, 0.4) for z in (0.25, 0.5, 0.75)])
        assert np.sqrt((inside["velocity"] ** 2).sum(axis=1).mean()) < 0.05
        hits = world.cast([[0.5, 0.9, 0.5], [0.5, 0.9, 0.5], [0.5, 0.25, 0.5]], [[0, -1, 0], [0, 1, 0], [0, 2, 0]])
        assert hits["hit"].tolist() == [True, False, True] and hits["inside"].tolist() == [False, False, True]
        assert np.allclose(hits["place"][[0, 2], 1], heights.mean(), atol=0.02) and abs(hits["distance"][0] + hits["place"][0, 1] - 0.9) < 1e-4
        assert hits["normal"][0, 1] > 0.95 and not world.cast([[0.5, 0.9, 0.5]], (0, -1, 0), reach=0.2)["hit"].any()
        refused(lambda: world.cast([[0, 0, 0]], [[1, 0, 0], [1, 0, 0]]), "direction", "each of 1")
        refused(lambda: world.heights([[0, 0, 0]]), "shape")
        world.set_volumes([rivulet.Box(7, (0.5, 0, 0.5), (2, 0.5, 2)), rivulet.Sphere(9, (0.5, 0.9, 0.5), 0.2)])
        world.step(1 / 60)
        here = world.volumes()
        below = (world.particles().positions[:, 1] < 0.25).sum()
        assert here["id"].tolist() == [7, 9] and abs(int(here["inside"][0]) - below) < 5 and here["inside"][1] == 0
        assert abs(here["volume_inside"][0] / (here["inside"][0] * 0.05**3) - 1) < 1e-6
        assert world.volume_events()["id"].tolist() == [7] and len(world.volume_events()) == 0
        loads = world.loads()
        weight = world.stats().particles * 1000 * 0.05**3 * 9.81
        assert set(loads) == {"floor", "wall"} and abs(loads["floor"]["force"][1] / -weight - 1) < 0.2, loads
        assert abs(loads["floor"]["time"] - world.stats().time) < 1e-9 and np.isnan(loads["wall"]["pressure"]) == (loads["wall"]["seconds"] == 0)
        assert abs(loads["floor"]["impulse"][1] / (-weight * world.stats().time) - 1) < 0.05, loads["floor"]["impulse"]
        assert abs(loads["wall"]["force"][0] - loads["wall"]["pressure"]) < 1e-6 * abs(loads["wall"]["force"][0]) + 1e-9  # on 1 m^2
        refused(lambda: context.world({"fluid": {"probes": [{"name": "a", "on": "collider", "index": 3}]}}), "fluid.probes[0]", "3")
        refused(lambda: world.set_volumes([rivulet.Sphere(1, (0, 0, 0), -1)]), "volume 1", "negative")
        for name in ("calm.ply", "calm.vtp", "calm.csv"):
            world.export(os.path.join(sys.argv[1], name))
        written = np.genfromtxt(os.path.join(sys.argv[1], "calm.csv"), delimiter=",", names=True, comments="#")
        assert len(written) == world.stats().particles, written.dtype
        world.export_surface(os.path.join(sys.argv[1], "calm.obj"))
        with open(os.path.join(sys.argv[1], "calm.obj")) as file:
            tops = [float(line.split()[2]) for line in file if line.startswith("v ")]
        assert abs(max(tops) - 0.5) < 0.05, max(tops)
        refused(lambda: world.export("calm.xyz"), "calm.xyz")

    refused(lambda: context.world({"fluid": {"spacng": 0.1}}), "spacing")
    refused(lambda: context.world('{"fluid": {\n "spacing": "wide"}}'), "json:2")
    try:
        context.world(DROP).save("/no/such/folder/file")
        raise AssertionError("saved into no folder")
    except rivulet.Error as error:
        assert "/no/such/folder/file" in str(error) and not isinstance(error, ValueError)

    # A plate that lies, then rises under the water.
    plate = rivulet.Mesh([[-0.2, 0, -0.2], [1.2, 0, -0.2], [1.2, 0, 1.2], [-0.2, 0, 1.2]], [[0, 2, 1], [0, 3, 2]], moves=True)
    with context.world(DROP, walls=[plate]) as world:
        for height in [0.3] * 90 + list(np.linspace(0.3, 0.6, 30)):
            world.step(1 / 60, poses=[[0, height, 0, 0, 0, 0, 1]])
        low = world.particles().positions[:, 1].min()
        assert 0.6 < low < 0.65, low
    plate = rivulet.Mesh([[-0.2, 0, -0.2], [1.2, 0, -0.2], [1.2, 0, 1.2], [-0.2, 0, 1.2]], [[0, 2, 1], [0, 3, 2]], moves=True, position=(0, 0.5, 0))
    with context.world(DROP, walls=[plate]) as world:
        for _ in range(90):
            world.step(1 / 60)
        low = world.particles().positions[:, 1].min()
        assert 0.5 < low < 0.55, low
    refused(lambda: rivulet.Mesh([[0, 0, 0]], [[0, 0]]), "shape")
    refused(lambda: context.world(DROP, walls=[rivulet.Mesh([[0, 0, 0]], [[0, 0, 5]])]), "walls[0]")

    # A body that a host in Python moves: it receives gravity and loads, and what it raises comes out of step().
    class Hand:
        calls = resets = 0
        lifted = 0.0
        broken = False

        def advance(self, loads, gravity, seconds, states):
            if self.broken:
                raise KeyError("broken")
            assert np.allclose(gravity, [0, -9.81, 0]) and seconds > 0 and len(loads) == len(states) == 1
            self.calls += 1
            self.lifted += loads["force"][0, 1] * seconds
            states["position"][0, 1] = max(0.3, states["position"][0, 1] - 0.3 * seconds)
            states["velocity"][0, 1] = -0.3 if states["position"][0, 1] > 0.3 else 0

        def reset(self, states):
            self.resets += 1
            assert np.allclose(states["position"], [0.3, 0.7, 0.3])

    hand = Hand()
    grid = (np.arange(6) - 2.5) * 0.03
    cube = np.array([(x, y, z) for x in grid for y in grid for z in grid if max(abs(x), abs(y), abs(z)) > 0.07])
    body = rivulet.Body(cube, mass=3, inertia=(0.016, 0.016, 0.016), volume=0.18**3, position=(0.3, 0.7, 0.3))
    pool = {"fluid": {"spacing": 0.03, "box": {"max": [0.6, 1, 0.6]}, "blocks": [{"max": [0.6, 0.51, 0.6]}]}}
    with context.world(pool, bodies=[body], body_host=hand) as world:
        for _ in range(90):
            world.step(1 / 60)
        assert np.allclose(world.bodies()["position"], [[0.3, 0.3, 0.3]]) and hand.calls > 90
        hand.lifted = 0
        for _ in range(60):
            world.step(1 / 60)
        weight = 1000 * 9.81 * 0.18**3
        assert abs(hand.lifted - weight) < 0.15 * weight, (hand.lifted, weight)  # N s of a second
        hand.broken = True
        try:
            world.step(1 / 60)
            raise AssertionError("what the host raised was lost")
        except KeyError:
            pass
        hand.broken = False
        calls = hand.calls
        world.step(1 / 60)  # nothing of it is left
        assert hand.calls > calls
        world.reset()
        assert hand.resets >= 1

    # A crate, a mesh with a density, is thrown in, floats with its weight as load, and is removed.
    corners = np.array([(x, y, z) for x in (-0.1, 0.1) for y in (-0.06, 0.06) for z in (-0.1, 0.1)])
    faces = [(0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5), (0, 4, 5), (0, 5, 1), (2, 3, 7), (2, 7, 6), (0, 2, 6), (0, 6, 4), (1, 5, 7), (1, 7, 3)]
    crate = rivulet.Body(mesh=rivulet.Mesh(corners, faces), density=500, position=(0.3, 0.6, 0.3), velocity=(0, -0.5, 0))
    roomy = {"fluid": {**pool["fluid"], "bodies": {"maxSamples": 1000}}}
    with context.world(roomy) as world:
        first, second = world.add_body(crate), world.add_body(rivulet.Body(cube, 3, (0.016,) * 3, 0.18**3, (0.15, 0.8, 0.15), layers=2, meets=2))
        assert (first, second) == (0, 1) and list(world.body_ids()) == [1]
        while world.body(first) is None:
            world.step(0)
        assert world.body(first)[0]["velocity"][1] == -0.5 and list(world.body_ids()) == [1, 0]
        world.remove_body(second)
        lifts = []
        for frame in range(120):
            world.step(1 / 60)
            lifts.append(world.body(first)[1]["force"][1])
        weight = 500 * 9.81 * 0.2 * 0.2 * 0.12
        assert abs(np.mean(lifts[60:]) - weight) < 0.1 * weight, (np.mean(lifts[60:]), weight)
        world.remove_body(first)
        assert len(world.bodies()) == 0
        refused(lambda: world.remove_body(first), "no body 0")

    # What a host keeps of what it was handed stays what it was.
    class Keeper:
        loads, states = [], []

        def advance(self, loads, gravity, seconds, states):
            self.loads.append(loads)
            self.states.append(states)
            self.told = getattr(self, "told", []) + [loads["force"].copy()]

        def reset(self, states):
            pass

    keeper = Keeper()
    with context.world(pool, bodies=[body], body_host=keeper) as world:
        for _ in range(10):
            world.step(1 / 60)
    gc.collect()
    assert all((kept["force"] == told).all() for kept, told in zip(keeper.loads, keeper.told)) and len(keeper.loads) >= 10
    for one in keeper.states:
        one["position"] = 0  # nobody else's memory

    with context.world(DROP) as world:
        for work in (lambda: copy.copy(world), lambda: copy.deepcopy(world), lambda: pickle.dumps(world)):
            try:
                work()
                raise AssertionError("a world was copied")
            except TypeError:
                pass
        world.step(1 / 60)
    mesh = [[0, 0, 0], [1, 0, 0], [0, 1, 0]]
    refused(lambda: rivulet.Mesh(mesh, [[0, 1, 2**33]]), "indices")
    refused(lambda: rivulet.Mesh(mesh, [[0, 1, 1.5]]), "indices")
    refused(lambda: rivulet.Mesh(mesh, [[0, 1, 2]], resolution=2**40), "resolution")
    refused(lambda: rivulet.Body(cube, 1, (1, 1), 1), "inertia")
    refused(lambda: rivulet.Context(backend="cpu", memory_limit=-1), "memory_limit")
    refused(lambda: context.world('{"fluid": {}}\0'), "value 0")
    # Whatever is of a wrong type is bad input, too.
    with context.world(DROP) as world:
        for seconds in ("a", None, [1, 2]):
            refused(lambda: world.step(seconds), "seconds is", "give a number")
        refused(lambda: world.step(-1), "seconds is -1", "0 or more")
        refused(lambda: world.step(-1, gravity=(0, 0, 0)), "seconds is -1")
        refused(lambda: world.step(0.01, gravity="down"), "gravity is no array")
        refused(lambda: world.step(0.01, gravity=(1, 2)), "give (3,)")
        try:
            world.step(0.01, gravity=(1, 2))
        except rivulet.BadInput as error:
            assert "-1" not in str(error), error
        refused(lambda: world.heights([[1, 2, 3]]), "(-1, 2), where -1 is any length")
        refused(lambda: world.save(3), "the path is 3")
        refused(lambda: world.set_volumes([3]), "a volume is 3")
        refused(lambda: world.add_wall(body), "give a Mesh")
        refused(lambda: world.buoyancy([3], 0.1), "floats[0] is 3", "Float")
        refused(lambda: world.wall(float("nan")), "id is nan")
        world.step(np.float32(0.001))
        with world.record(os.path.join(sys.argv[1], "twice.rrec")):
            refused(lambda: world.record(os.path.join(sys.argv[1], "again.rrec")), "being recorded", "close its Recording")
    for scene in (b"{}", {1, 2}, {"fluid": {"spacing": object()}}, {"fluid": {1j}}):
        refused(lambda: context.world(scene), "JSON has no", "give a dict")
    refused(lambda: context.world(DROP, walls=plate), "give a list of Mesh")
    refused(lambda: context.world(DROP, walls=[body]), "walls[0]", "give a Mesh")
    refused(lambda: context.world(DROP, bodies=[body], body_host=object()), "body_host has no function advance")
    refused(lambda: rivulet.Context(backend="cpu", threads=float("nan")), "threads is nan")
    refused(lambda: rivulet.Context(backend="cpu", threads=2**31), "threads", "2147483647")
    refused(lambda: rivulet.Context(backend="cpu", threads="2"), "threads is '2'")
    refused(lambda: rivulet.Context(backend="cpu", memory_limit=2**63), "memory_limit")
    refused(lambda: rivulet.Mesh(mesh, [[0, 1, 2]], friction="smooth"), "friction is 'smooth'", "number")
    refused(lambda: context.skin(rivulet.Mesh(mesh, [[0, 1, 2]])), "the Mesh has no uvs")
    closed = rivulet.Context(backend="cpu")
    snapshot = closed.snapshot
    closed.close()
    for work in (lambda: closed.world(DROP), lambda: closed.device, lambda: closed.memory, closed.times, snapshot):
        refused(work, "the Context is closed: create another")
    context.world({"fluid": {"spacing": np.float32(0.05), "blocks": [{"max": np.array([0.2, 0.2, 0.2])}]}}).close()

    square = rivulet.Mesh([[0, 0, 0], [0.1, 0, 0], [0.1, 0.1, 0], [0, 0.1, 0]], [[0, 1, 2], [0, 2, 3]], uvs=[[0, 0], [1, 0], [1, 1], [0, 1]])
    with context.skin(square, {"viscosity": 0.001}, map_size=64) as skin:
        skin.add((0.05, 0.05, 0.01), 20)
        for _ in range(120):
            skin.step(1 / 60, wind=(0, 0, 0), to_world=np.eye(4))
        stats = skin.stats()
        assert abs(stats.added - 20e-9) < 1e-14 and abs(stats.on_skin + stats.left + stats.evaporated - stats.added) < 1e-14
        assert stats.left > 10e-9
        refused(lambda: skin.add((0, 0, 0), -1), "microlitres")

# A context outlives, in Python, what was made of it, in whatever order they are let go.
def let_go():
    context = rivulet.Context(backend="cpu", log=lambda level, sentence: heard.append((level, sentence)))
    return context.world(DROP)


world = let_go()
world.step(1 / 60)
del world
gc.collect()
refused(lambda: rivulet.Context(backend="abacus"), "abacus")
assert not [sentence for level, sentence in heard if level == 3], heard
print("all holds")
