"""Rows of hostile inputs: mutated files, and files that once crashed, hung or lost something, each made here."""
import ctypes
import json
import os
import random
import re
import resource
import struct

import cases
import runs
import watch

RUN = "run s.json --no-render --backend cpu --frames 2 --stats n.json"


def mutated(data, chosen):
    """Flipped, cut, moved, and extreme numbers."""
    data = bytearray(data)
    for _ in range(chosen.choice((1, 1, 2, 8))):
        if not data:
            break
        at = chosen.randrange(len(data))
        kind = chosen.randrange(6)
        if kind == 0:
            data[at] ^= 1 << chosen.randrange(8)
        elif kind == 1:
            data[at] = chosen.choice((0, 1, 0x7F, 0x80, 0xFF, 0x2D, 0x39))
        elif kind == 2:
            del data[at:]
        elif kind == 3:
            del data[at:at + chosen.randrange(1, 64)]
        elif kind == 4:
            data[at:at] = data[chosen.randrange(len(data)):][:chosen.randrange(1, 64)]
        else:
            word = chosen.choice((b"\xff\xff\xff\xff", b"\x00\x00\xc0\x7f", b"\x00\x00\x80\x7f", b"\x00\x00\x00\x80", b"\xff\xff\xff\x7f"))
            data[at:at + 4] = word
    return bytes(data)


def checksum(data, seed=0):
    """As fluid/voxel/packed_array.h."""
    call = ctypes.CDLL("libxxhash.so.0").XXH3_64bits_withSeed
    call.restype, call.argtypes = ctypes.c_uint64, (ctypes.c_char_p, ctypes.c_size_t, ctypes.c_uint64)
    return call(bytes(data), len(data), seed)


def sealed_state(data):
    """With the checksums of what it now holds, as a stranger would write it: only the checks of its numbers remain."""
    header, entry, offset = 40, 64, 32
    data = bytearray(data)
    if len(data) < header:
        return bytes(data)
    sections = struct.unpack_from("<I", data, 16)[0]
    if sections > (len(data) - header) // entry:
        return bytes(data)
    for k in range(sections):
        at = header + k * entry
        begin, size = struct.unpack_from("<QQ", data, at + offset)
        struct.pack_into("<Q", data, at + entry - 8, checksum(data[begin:begin + size]))
    struct.pack_into("<Q", data, header - 8, checksum(data[:header - 8] + data[header:header + sections * entry]))
    return bytes(data)


def sealed_recording(data):
    """The same of a recording's frames."""
    data = bytearray(data)
    if len(data) < 32:
        return bytes(data)
    at = 32 + struct.unpack_from("<I", data, 16)[0]
    struct.pack_into("<Q", data, 24, checksum(data[32:at], checksum(data[:24])))
    while at + 48 <= len(data) and data[at:at + 4] == b"FRAM":
        size = struct.unpack_from("<Q", data, at + 16)[0]
        struct.pack_into("<Q", data, at + 32, checksum(data[at + 48:at + 48 + size]))
        struct.pack_into("<Q", data, at + 40, checksum(data[at:at + 40]))
        at += 48 + size
    return bytes(data)


def changed(data, chosen, begin):
    """Some bytes behind `begin`; its length stays."""
    data = bytearray(data)
    for _ in range(chosen.choice((1, 1, 4, 30))):
        data[chosen.randrange(begin, len(data))] = chosen.choice((0, 0x7F, 0x80, 0xFF, chosen.randrange(256)))
    return bytes(data)


NUMBER = re.compile(rb"-?\d+(\.\d+)?([eE][-+]?\d+)?")
EXTREME = (b"0", b"-1", b"1e30", b"-1e30", b"3e38", b"1e-30", b"1e999", b"4294967296", b"-2147483649", b"1e6", b"null", b"\"x\"", b"[]")


def mutated_text(data, chosen):
    """Of files that have numbers in them: some replaced by extreme ones."""
    if chosen.random() < 0.4:
        return mutated(data, chosen)
    places = list(NUMBER.finditer(data))
    for _ in range(chosen.choice((1, 1, 2, 4))):
        place = chosen.choice(places)
        data = data[:place.start()] + chosen.choice(EXTREME) + data[place.end():]
        places = list(NUMBER.finditer(data))
    return data


MESHES = {
    "m.obj": lambda paddle: paddle,
    "m.ply": lambda paddle: b"ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement face 4\n"
             b"property list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n",
    "m.stl": lambda paddle: b"solid t\n" + b"".join(b"facet normal 0 0 1\nouter loop\n" + b"".join(b"vertex %d %d %d\n" % v for v in face)
             + b"endloop\nendfacet\n" for face in (((0, 0, 0), (0, 1, 0), (1, 0, 0)), ((0, 0, 0), (1, 0, 0), (0, 0, 1)),
                                                   ((0, 0, 0), (0, 0, 1), (0, 1, 0)), ((1, 0, 0), (0, 1, 0), (0, 0, 1)))) + b"endsolid t\n",
    "m.off": lambda paddle: b"OFF\n4 4 6\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n",
    "m.gltf": lambda paddle: gltf(),
}


def gltf(children=0, uri=None):
    """A tetrahedron; `children`: below so many nested nodes; `uri`: of its buffer."""
    import base64
    numbers = struct.pack("<12f12H", 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3)
    nodes = [{"children": [k + 1]} for k in range(children)] + [{"mesh": 0}]
    return json.dumps({
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": nodes,
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "buffers": [{"byteLength": len(numbers), "uri": uri or "data:application/octet-stream;base64," + base64.b64encode(numbers).decode()}],
        "bufferViews": [{"buffer": 0, "byteLength": 48}, {"buffer": 0, "byteOffset": 48, "byteLength": 24}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 1]},
                      {"bufferView": 1, "componentType": 5123, "count": 12, "type": "SCALAR"}]}).encode()


def offer(faults, row, words, name, data, outputs=(), limits=(), closed=(), check=None, cpu=watch.CPU_SECONDS):
    """The program is given a file of this content."""
    room = faults.room(cases.Case("input", words, outputs))
    if name is not None:
        room.inputs[name] = data
    room.fill()
    outcome = watch.run([faults.program, *room.case.words], room.root, room.environment, faults.core(), limits=limits, closed=closed, cpu=cpu)
    row.statuses.add(outcome.status)
    kept = os.path.join(faults.options.keep, f"{row.fault.replace(' ', '_')}-{row.inputs}-{name}") if faults.options.keep else name
    again = f"rivulet {words}  # with {kept}"
    if outcome.hung or outcome.crashed:
        lost = None
    else:
        lost = cases.bad_message(outcome, set()) if outcome.status != 0 and 2 not in closed else None
        lost = lost or room.verdict(outcome, check_new=False) or (check(room) if check else None)
    if faults.options.keep and name is not None and (outcome.hung or outcome.crashed or lost):
        with open(kept, "wb") as file:
            file.write(data)
    if outcome.hung or outcome.crashed:
        row.count("hung" if outcome.hung else "crashed", again, f"{outcome.status} {outcome.err[-300:]}")
    else:
        row.count("lost" if lost else "", again, f"{lost} [{outcome.status}: {outcome.err[-300:]}]")


def files(faults):
    chosen = random.Random(faults.options.seed + 4)
    count = 6 if faults.quick else 300
    fixture = faults.fixture
    koi = None
    path = os.path.join(faults.environment["RIVULET_ASSETS"], "meshes", "koi.glb")
    if os.path.exists(path):
        with open(path, "rb") as file:
            koi = file.read()
    tasks = []
    row = faults.row("mutated scenes", "flipped and cut bytes, extreme numbers")
    tasks += [lambda r=row, d=mutated_text(fixture["s.json"], chosen): offer(faults, r, RUN, "s.json", d, limits=[(resource.RLIMIT_AS, 4 << 30)])
              for _ in range(count)]
    row = faults.row("forged states and recordings", "changed bytes, with the checksums that belong to them")
    tasks += [lambda r=row, d=sealed_state(changed(fixture["s.rstate"], chosen, 40)): offer(faults, r, RUN + " --resume s.rstate", "s.rstate", d)
              for _ in range(count)]
    tasks += [lambda r=row, d=sealed_recording(changed(fixture["r.rrec"], chosen, 80)):
              offer(faults, r, "run s.json --headless --size 64x48 --still 0 --out out --replay r.rrec", "r.rrec", d) for _ in range(count)]
    row = faults.row("mutated states", "flipped and cut bytes")
    tasks += [lambda r=row, d=mutated(fixture["s.rstate"], chosen): offer(faults, r, RUN + " --resume s.rstate", "s.rstate", d) for _ in range(count)]
    row = faults.row("mutated recordings", "flipped and cut bytes")
    tasks += [lambda r=row, d=mutated(fixture["r.rrec"], chosen): offer(faults, r, "run s.json --headless --size 64x48 --still 0 --out out --replay r.rrec", "r.rrec", d)
              for _ in range(count)]
    row = faults.row("mutated meshes", "OBJ, PLY, STL, OFF, glTF: flipped and cut bytes, extreme numbers")
    for name, make in MESHES.items():
        good = make(fixture["paddle.obj"])
        tasks += [lambda r=row, n=name, d=mutated_text(good, chosen): offer(faults, r, f"voxelize {n} --resolution 8 --backend cpu --out p.rvox", n, d, ("p.rvox",))
                  for _ in range(count // 3)]
    if koi:
        tasks += [lambda r=row, d=mutated(koi, chosen): offer(faults, r, "voxelize k.glb --resolution 8 --backend cpu --out p.rvox", "k.glb", d, ("p.rvox",))
                  for _ in range(count // 3)]
    faults.all(tasks)


def dense(count):
    """Blocks in one place: each particle has `count` times the usual number of neighbours, so that the neighbour lists must grow."""
    block = {"min": [0, 0, 0], "max": [0.2, 0.2, 0.24]}
    return json.dumps({"name": "dense", "fluid": {"spacing": 0.015, "maxSubsteps": 4, "pbf": {"iterations": 1}, "box": {"min": [0, 0, 0],
                       "max": [0.4, 0.4, 0.24]}, "blocks": [block] * count}}).encode()


def ply_of_list_count(count):
    """A face of so many corners, in 190 bytes."""
    return (b"ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\n"
            b"property list uint uint vertex_indices\nend_header\n" + struct.pack("<9fI3I", 0, 0, 0, 1, 0, 0, 0, 1, 0, count, 0, 1, 2))


# Settings that s.json gets, and whether they are refused. Those that are not must end in time.
ABSURD = (
    ("fluid.gravity=0,-3e38,0", True), ("fluid.gravity=0,nan,0", True), ("fluid.box.max=-1,-1,-1", True), ("fluid.blocks[0].max=100000,0.2,0.15", True),
    ("fluid.box.max=100000,0.4,0.4 fluid.blocks[0].max=100000,0.2,0.15", True), ("fluid.blocks[0].min=1e30,0,0", True),
    ("fluid.spacing=1e-9", True), ("fluid.spacing=0", True), ("fluid.spacing=nan", True), ("fluid.density=1e30", True), ("fluid.viscosity=1e9", True),
    ("emitters[0].litresPerSecond=1e30", True), ("emitters[0].radius=-1", True), ("bodies[0].density=1e30", True),
    ("colliders[0].motion.spin=1e30", True), ("colliders[0].position=1e30,0,0", True), ("fluid.maxSubsteps=2000000000", True),
    ("fluid.maxParticles=2000000000", True), ("fluid.forces.tension=1e20", True), ("fluid.viscosity=2", False), ("fluid.fixedStep=1e-9", False),
    ("fluid.spacing=0.004", False),
)


def absurd(faults):
    row = faults.row("absurd scenes", "infinite, inverted and gigantic values; steps that would take hours: refused, or ended in time")

    def one(settings, refused):
        words = "run s.json --no-render --backend cpu --frames 1 --stats n.json " + " ".join(f"--set {word}" for word in settings.split())
        room = faults.room(cases.Case("absurd", words, ("n.json",)))
        outcome = watch.run([faults.program, *room.case.words], room.root, room.environment, faults.core(), cpu=60 if not refused else 5)
        lost = None
        if not outcome.hung and not outcome.crashed:
            lost = cases.bad_message(outcome, set()) if outcome.status != 0 else "it was not refused" if refused else None
            lost = lost or room.verdict(outcome)
        row.count("hung" if outcome.hung else "crashed" if outcome.crashed else "lost" if lost else "", f"rivulet {words}",
                  f"{lost} [{outcome.status}: {outcome.err[-300:]}]")
    faults.all([lambda a=entry: one(*a) for entry in ABSURD])


def repros(faults):
    tasks = []
    row = faults.row("little memory", "a limit of memory (ulimit -v), and 8 overlapping blocks, which need long neighbour lists")
    for megabytes in range(56, 113, 16 if faults.quick else 2):
        tasks.append(lambda m=megabytes: offer(faults, row, "run dense.json --no-render --backend cpu --frames 1 --stats n.json", "dense.json", dense(8), ("n.json",),
                                               limits=[(resource.RLIMIT_AS, m << 20)]))
    faults.all(tasks)
    tasks = []
    if not {0, 1} <= row.statuses:
        row.count("lost", "dense.json", f"the limits are not on both sides of what the run needs: exit status {row.statuses}")
    models = faults.row("strangers' models", "60,000 nested nodes, a face of 4 billion corners, a fan of 200,000, files of others")
    voxelize = "--resolution 8 --backend cpu --out p.rvox"
    fan = b"".join(b"v %d 0 1\n" % k for k in range(200000)) + b"f " + b" ".join(b"%d" % (k + 1) for k in range(200000)) + b"\n"
    for name, data in (("deep.gltf", gltf(60000)), ("face.ply", ply_of_list_count(0xFFFFFFF0)), ("face.ply", ply_of_list_count(100_000_000)),
                       ("passwd.gltf", gltf(uri="../../../../../../etc/passwd")), ("zero.gltf", gltf(uri="/dev/zero")),
                       ("fan.obj", fan), ("empty.obj", b""), ("nothing.gltf", b"{}")):
        tasks.append(lambda n=name, d=data: offer(faults, models, f"voxelize {n} {voxelize}", n, d, ("p.rvox",), cpu=300))
    closed = faults.row("closed descriptors", "stdin, stdout or stderr is closed: none of them becomes a data file")
    recorded = "run s.json --no-render --backend cpu --frames 2 --record n.rrec --save n.rstate --stats n.json"

    def same(room):
        now = cases.files_in(room.root)
        return next((f"{name} is not the same" for name, other in (("n.rrec", "r.rrec"), ("n.rstate", "s.rstate"))
                     if now.get(name) != faults.fixture[other]), None)
    for streams in ((0,), (1,), (2,), (0, 1), (0, 2), (1, 2), (0, 1, 2)):
        tasks.append(lambda s=streams: offer(faults, closed, recorded, None, None, ("n.rrec", "n.rstate", "n.json"), closed=s, check=same))
    inputs = faults.row("inputs that are no files", "a FIFO, a device, a folder, /proc, as each input")
    for path in ("/dev/zero", "/dev/stdin", "/proc/kmsg", "/proc/self/mem", ".", "fifo"):
        for words in (f"run {path}", f"run s.json --no-render --backend cpu --resume {path}", f"run s.json --headless --size 64x48 --still 0 --out out --replay {path}", f"voxelize {path} --out p.rvox"):
            tasks.append(lambda w=words: special(faults, inputs, w))
    faults.all(tasks)


def special(faults, row, words):
    room = faults.room(cases.Case("input", words, ("p.rvox",)))
    os.mkfifo(os.path.join(room.root, "fifo"))
    outcome = watch.run([faults.program, *room.case.words], room.root, room.environment, faults.core())
    os.remove(os.path.join(room.root, "fifo"))
    lost = None
    if not outcome.hung and not outcome.crashed:
        lost = cases.bad_message(outcome, set()) or room.verdict(outcome)
    row.count("hung" if outcome.hung else "crashed" if outcome.crashed else "lost" if lost else "", f"rivulet {words}", f"{lost} [{outcome.status}: {outcome.err[-300:]}]")


ROWS = {"files of others": files, "repros": repros, "absurd": absurd}
