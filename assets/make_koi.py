#!/usr/bin/env python3
"""Makes a koi that swims, as a glTF with a spine of joints and a clip: python3 assets/make_koi.py assets/meshes/koi.glb

It is 0.34 m long, looks along +x and has its middle in the origin. Its clip "swim" is a circle of 0.3 m radius in 7 s, with two beats of the
tail a second: a wave runs down the spine and grows towards the tail (Videler & Hess 1984 measured it of bream and pike)."""
import json
import math
import random
import struct
import sys
import zlib

LENGTH, AROUND = 0.34, 20
JOINTS = 7
SECONDS, RADIUS, BEATS, RATE = 7.0, 0.3, 14, 24
TEXTURE = 256

# x from the nose (shares of the length), half height above and below the spine, half width: of a carp.
SECTIONS = [(0.0, 0.012, 0.012, 0.012), (0.03, 0.03, 0.03, 0.028), (0.08, 0.055, 0.05, 0.045), (0.15, 0.083, 0.075, 0.062),
            (0.24, 0.104, 0.096, 0.074), (0.34, 0.114, 0.107, 0.076), (0.45, 0.106, 0.1, 0.067), (0.56, 0.084, 0.08, 0.052),
            (0.66, 0.06, 0.058, 0.036), (0.74, 0.043, 0.042, 0.024), (0.8, 0.036, 0.036, 0.016), (0.84, 0.034, 0.034, 0.011)]


def smooth(t):
    """The half height above, below and half width at share t of the length: Catmull-Rom through SECTIONS."""
    k = max(j for j in range(len(SECTIONS) - 1) if SECTIONS[j][0] <= t or j == 0)
    p = [SECTIONS[max(0, min(len(SECTIONS) - 1, k + d))] for d in (-1, 0, 1, 2)]
    u = (t - p[1][0]) / (p[2][0] - p[1][0])
    out = []
    for c in (1, 2, 3):
        a, b, d, e = (q[c] for q in p)
        out.append(0.5 * (2 * b + (d - a) * u + (2 * a - 5 * b + 4 * d - e) * u * u + (3 * b - a - 3 * d + e) * u**3))
    return out


class Part:
    """One closed surface with its own material: positions (m), texture places, triangles."""

    def __init__(self):
        self.positions, self.places, self.faces = [], [], []

    def add(self, p, place=(0.5, 0.5)):
        self.positions.append(tuple(LENGTH * c for c in p))
        self.places.append(place)
        return len(self.positions) - 1

    def lofted(self, rings, caps=(True, True)):
        """Rings of corners, joined one to the next and closed at both ends."""
        for low, high in zip(rings, rings[1:]):
            for k in range(len(low)):
                m = (k + 1) % len(low)
                self.faces += [(low[k], high[m], high[k]), (low[k], low[m], high[m])]
        for ring, first in ((rings[0], True), (rings[-1], False)):
            if not caps[0 if first else 1]:
                continue
            middle = self.add([sum(self.positions[k][c] for k in ring) / len(ring) / LENGTH for c in range(3)], self.places[ring[0]])
            for k in range(len(ring)):
                m = (k + 1) % len(ring)
                self.faces.append((middle, ring[m], ring[k]) if first else (middle, ring[k], ring[m]))


def outside(part):
    """Its triangles seen from outside go anticlockwise, whichever way they were wound."""
    volume = sum(
        a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0])
        for a, b, c in ([part.positions[i] for i in f] for f in part.faces))
    if volume < 0:
        part.faces = [(a, c, b) for a, b, c in part.faces]
    return part


def body():
    part, rings = Part(), []
    for k in range(37):
        t = 0.84 * (k / 36) ** 1.15
        above, below, wide = smooth(t)
        ring = []
        for j in range(AROUND):
            a = 2 * math.pi * j / AROUND
            y = math.cos(a) * (above if math.cos(a) > 0 else below)
            ring.append(part.add((0.5 - t, y, math.sin(a) * wide), (t, 0.5 + 0.5 * math.cos(a))))
        rings.append(ring)
    part.lofted(rings)
    return outside(part)


def fin(root, tip, thick, bow=(0.0, 0.0, 0.0), steps=10):
    """Between two lines of three points: a thin blade that ends in an edge."""
    part = Part()
    rows = []
    for i in range(steps + 1):
        u = i / steps
        line = [[r[c] + (t[c] - r[c]) * u + 4 * u * (1 - u) * bow[c] for c in range(3)] for r, t in zip(root, tip)]
        half = thick * (1 - 0.8 * u)
        rows.append((line, half))
    rings = []
    for line, half in rows:
        n = []
        along = [line[-1][c] - line[0][c] for c in range(3)]
        up = [tip[1][c] - root[1][c] for c in range(3)]
        n = [along[1] * up[2] - along[2] * up[1], along[2] * up[0] - along[0] * up[2], along[0] * up[1] - along[1] * up[0]]
        size = math.sqrt(sum(c * c for c in n)) or 1
        n = [c / size for c in n]
        ring = [[p[c] + side * half * n[c] for c in range(3)] for side, points in ((1, line), (-1, line[::-1])) for p in points]
        rings.append([part.add(p, (0.9, 0.96)) for p in ring])
    part.lofted(rings)
    return outside(part)


def fins():
    tail = fin([(-0.3, 0.03, 0), (-0.315, 0, 0), (-0.3, -0.03, 0)], [(-0.51, 0.135, 0), (-0.42, 0, 0), (-0.51, -0.12, 0)], 0.012)
    back = fin([(0.1, 0.1, 0), (0.0, 0.1, 0), (-0.13, 0.075, 0)], [(0.03, 0.17, 0), (-0.06, 0.155, 0), (-0.17, 0.11, 0)], 0.01)
    out = [tail, back]
    for side in (1, -1):
        out.append(fin([(0.27, -0.045, side * 0.05), (0.25, -0.055, side * 0.055), (0.225, -0.055, side * 0.055)],
                       [(0.2, -0.1, side * 0.17), (0.15, -0.11, side * 0.165), (0.12, -0.1, side * 0.13)], 0.008))
        out.append(fin([(0.02, -0.095, side * 0.03), (-0.0, -0.095, side * 0.03), (-0.025, -0.09, side * 0.03)],
                       [(-0.03, -0.145, side * 0.08), (-0.06, -0.145, side * 0.08), (-0.08, -0.13, side * 0.06)], 0.008))
    return out


def eyes():
    part = Part()
    for side in (1, -1):
        centre, radius, rings = (0.405, 0.022, side * 0.041), 0.0135, []
        for k in range(1, 8):
            v = math.pi * k / 8
            rings.append([part.add((centre[0] + radius * math.sin(v) * math.cos(a), centre[1] + radius * math.cos(v),
                                    centre[2] + radius * math.sin(v) * math.sin(a)))
                          for a in (-2 * math.pi * j / 12 for j in range(12))])
        part.lofted(rings)
    return outside(part)


def joined(parts):
    whole = Part()
    for part in parts:
        first = len(whole.positions)
        whole.positions += part.positions
        whole.places += part.places
        whole.faces += [tuple(first + k for k in f) for f in part.faces]
    return whole


def normals(part):
    sums = [[0.0] * 3 for _ in part.positions]
    for f in part.faces:
        a, b, c = (part.positions[k] for k in f)
        u, v = [b[k] - a[k] for k in range(3)], [c[k] - a[k] for k in range(3)]
        n = (u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0])
        for k in f:
            for c in range(3):
                sums[k][c] += n[c]
    out = []
    for n in sums:
        size = math.sqrt(sum(c * c for c in n)) or 1
        out.append(tuple(c / size for c in n))
    return out


def spine(k):
    """x of joint k, m: the first in the head, the last where the tail begins."""
    return LENGTH * (0.22 - 0.62 * k / (JOINTS - 1))


def weights(x):
    """The two joints that hold a corner at x, and how much each."""
    t = max(0.0, min(JOINTS - 1.0, (spine(0) - x) / (spine(0) - spine(1))))
    k = min(int(t), JOINTS - 2)
    u = t - k
    u = u * u * (3 - 2 * u)
    return (k, k + 1), (1 - u, u)


def paint():
    """Red patches on white, the belly white, scales: places are x along the fish and y from belly to back."""
    noise = random.Random(4)
    spots = [(noise.uniform(0.08, 0.8), noise.uniform(0.72, 1.0), noise.uniform(0.05, 0.13)) for _ in range(7)] + [(0.1, 0.97, 0.1)]
    rows = bytearray()
    for j in range(TEXTURE):
        rows.append(0)
        for i in range(TEXTURE):
            x, y = (i + 0.5) / TEXTURE, 1 - (j + 0.5) / TEXTURE
            ripple = 0.018 * math.sin(37 * x + 11 * y) + 0.012 * math.sin(71 * x - 43 * y)
            deep = max(s[2] - math.hypot(1.3 * (x - s[0]), 0.6 * (y - s[1])) for s in spots) + ripple
            red = max(0.0, min(1.0, 0.5 + deep * 28))
            scale = 0.9 + 0.1 * abs(math.sin(62 * math.pi * x) * math.sin(26 * math.pi * y + (0.5 * math.pi if int(62 * x) % 2 else 0)))
            scale = 1 if x < 0.2 else scale
            white, orange = (0.93, 0.9, 0.84), (0.86, 0.2, 0.03)
            shade = 0.86 + 0.14 * min(1, 2 * (1 - y)) if red < 0.5 else 1
            rows += bytes(int(255 * max(0, min(1, (w + (o - w) * red) * scale * shade)) ** 0.9) for w, o in zip(white, orange))
    head = struct.pack(">IIBBBBB", TEXTURE, TEXTURE, 8, 2, 0, 0, 0)
    chunks = [(b"IHDR", head), (b"IDAT", zlib.compress(bytes(rows), 9)), (b"IEND", b"")]
    return b"\x89PNG\r\n\x1a\n" + b"".join(struct.pack(">I", len(d)) + n + d + struct.pack(">I", zlib.crc32(n + d)) for n, d in chunks)


def swim():
    """Times; the root's places and turns; each joint's turn about y (quaternions x, y, z, w)."""
    times = [k / RATE for k in range(int(SECONDS * RATE) + 1)]
    turn = lambda a: (0.0, math.sin(0.5 * a), 0.0, math.cos(0.5 * a))
    places, turns, joints = [], [], [[] for _ in range(JOINTS)]
    for t in times:
        way = 2 * math.pi * t / SECONDS
        places.append((RADIUS * math.sin(way), 0.006 * math.sin(3 * way), RADIUS * math.cos(way)))
        turns.append(turn(way))
        # The sideways place of the spine at x, as a wave; a joint turns by the change of its slope. It is bent into its circle, too.
        slope = lambda x: (0.02 + 0.1 * x * x) * math.sin(2 * math.pi * (BEATS * t / SECONDS - 0.95 * x)) * 2 * math.pi * 0.95
        before = 0.0
        for k in range(JOINTS):
            s = k / (JOINTS - 1)
            now = slope(s) + 0.5 * s * 0.62 * LENGTH / RADIUS
            joints[k].append(turn(now - before))
            before = now
    return times, places, turns, joints


class Glb:
    def __init__(self):
        self.data, self.views, self.accessors = bytearray(), [], []

    def view(self, raw):
        while len(self.data) % 4:
            self.data.append(0)
        self.views.append({"buffer": 0, "byteOffset": len(self.data), "byteLength": len(raw)})
        self.data += raw
        return len(self.views) - 1

    def array(self, rows, kind, form="f", bounds=False):
        rows = [r if isinstance(r, (tuple, list)) else (r,) for r in rows]
        raw = b"".join(struct.pack(f"<{len(r)}{form}", *r) for r in rows)
        accessor = {"bufferView": self.view(raw), "componentType": {"f": 5126, "H": 5123, "I": 5125}[form], "count": len(rows), "type": kind}
        if bounds:
            accessor["min"] = [struct.unpack("<f", struct.pack("<f", min(r[c] for r in rows)))[0] for c in range(len(rows[0]))]
            accessor["max"] = [struct.unpack("<f", struct.pack("<f", max(r[c] for r in rows)))[0] for c in range(len(rows[0]))]
        self.accessors.append(accessor)
        return len(self.accessors) - 1


def main():
    glb = Glb()
    primitives = []
    for part, material in ((body(), 0), (joined(fins()), 1), (eyes(), 2)):
        held = [weights(p[0]) for p in part.positions]
        primitives.append({
            "attributes": {
                "POSITION": glb.array(part.positions, "VEC3", bounds=True),
                "NORMAL": glb.array(normals(part), "VEC3"),
                "TEXCOORD_0": glb.array([(u, 1 - v) for u, v in part.places], "VEC2"),
                "JOINTS_0": glb.array([(*h[0], 0, 0) for h in held], "VEC4", "H"),
                "WEIGHTS_0": glb.array([(*h[1], 0.0, 0.0) for h in held], "VEC4")},
            "indices": glb.array([k for f in part.faces for k in f], "SCALAR", "I"),
            "material": material})
    image = glb.view(paint())
    times, places, turns, joints = swim()
    inverse = glb.array([(1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -spine(k), 0, 0, 1) for k in range(JOINTS)], "MAT4")
    # 0 the root, that swims the circle; 1.. the spine; the last the mesh.
    nodes = [{"name": "koi", "children": [1, JOINTS + 1]}]
    for k in range(JOINTS):
        node = {"name": f"spine{k}", "translation": [spine(k) - (spine(k - 1) if k else 0), 0, 0]}
        if k + 1 < JOINTS:
            node["children"] = [k + 2]
        nodes.append(node)
    nodes.append({"name": "skin", "mesh": 0, "skin": 0})
    clock = glb.array(times, "SCALAR", bounds=True)
    samplers, channels = [], []
    for node, path, rows, kind in [(0, "translation", places, "VEC3"), (0, "rotation", turns, "VEC4")] + [
            (k + 1, "rotation", joints[k], "VEC4") for k in range(JOINTS)]:
        samplers.append({"input": clock, "output": glb.array(rows, kind), "interpolation": "LINEAR"})
        channels.append({"sampler": len(samplers) - 1, "target": {"node": node, "path": path}})
    plain = lambda colour, rough: {"baseColorFactor": [*colour, 1], "metallicFactor": 0, "roughnessFactor": rough}
    out = {
        "asset": {"version": "2.0", "generator": "make_koi.py"},
        "scene": 0, "scenes": [{"nodes": [0]}], "nodes": nodes,
        "meshes": [{"name": "koi", "primitives": primitives}],
        "skins": [{"joints": list(range(1, JOINTS + 1)), "inverseBindMatrices": inverse, "skeleton": 1}],
        "materials": [
            {"name": "scales", "pbrMetallicRoughness": {**plain((1, 1, 1), 0.32), "baseColorTexture": {"index": 0}}},
            {"name": "fins", "pbrMetallicRoughness": plain((0.85, 0.42, 0.24), 0.45)},
            {"name": "eyes", "pbrMetallicRoughness": plain((0.01, 0.01, 0.012), 0.1)}],
        "textures": [{"source": 0, "sampler": 0}], "samplers": [{"magFilter": 9729, "minFilter": 9987}],
        "images": [{"bufferView": image, "mimeType": "image/png"}],
        "animations": [{"name": "swim", "samplers": samplers, "channels": channels}],
        "accessors": glb.accessors, "bufferViews": glb.views, "buffers": [{"byteLength": len(glb.data)}]}
    text = json.dumps(out, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    data = bytes(glb.data) + b"\0" * (-len(glb.data) % 4)
    with open(sys.argv[1], "wb") as file:
        file.write(struct.pack("<III", 0x46546C67, 2, 28 + len(text) + len(data)))
        file.write(struct.pack("<II", len(text), 0x4E4F534A) + text + struct.pack("<II", len(data), 0x004E4942) + data)


main()
