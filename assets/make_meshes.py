#!/usr/bin/env python3
"""Makes meshes of the scenes glass, fountain, splash_crown, koi and cove and of validation cases, by formulas: python3 assets/make_meshes.py assets/meshes"""
import math
import os
import sys


def write(folder, name, says, positions, faces):
    with open(os.path.join(folder, name), "w") as out:
        out.write(f"# {says} CC0 1.0.\n")
        for p in positions:
            out.write("v " + " ".join(f"{c:.5g}" for c in p) + "\n")
        for f in faces:
            out.write("f " + " ".join(str(k + 1) for k in f) + "\n")


def rounded(corners, steps=5):
    """A line through `corners` (r, y, radius of the rounding), m; a radius of 0 leaves a corner sharp."""
    line = []
    for k, (r, y, radius) in enumerate(corners):
        if radius == 0 or k in (0, len(corners) - 1):
            line.append((r, y))
            continue
        before, after = corners[k - 1], corners[k + 1]
        a, b = math.hypot(before[0] - r, before[1] - y), math.hypot(after[0] - r, after[1] - y)
        u, v = ((before[0] - r) / a, (before[1] - y) / a), ((after[0] - r) / b, (after[1] - y) / b)
        half = 0.5 * math.acos(max(-1.0, min(1.0, u[0] * v[0] + u[1] * v[1])))
        reach = min(radius / math.tan(half), 0.49 * a, 0.49 * b)
        for s in range(steps + 1):  # a parabola in place of the arc
            t = s / steps
            p, q = reach * (1 - t) ** 2, reach * t**2
            line.append((r + p * u[0] + q * v[0], y + p * u[1] + q * v[1]))
    return line


def revolved(line, around):
    """The closed surface that `line` (r, y), from axis to axis with the solid on its left, sweeps about y."""
    positions, faces, rings = [], [], []
    for r, y in line:
        if r < 1e-9:
            rings.append([len(positions)] * around)
            positions.append((0.0, y, 0.0))
        else:
            rings.append([len(positions) + k for k in range(around)])
            turns = [2 * math.pi * k / around for k in range(around)]
            positions += [(r * math.cos(a), y, r * math.sin(a)) for a in turns]
    for low, high in zip(rings, rings[1:]):
        for k in range(around):
            m = (k + 1) % around
            if low[k] != low[m]:
                faces.append((low[k], high[k], low[m]))
            if high[k] != high[m]:
                faces.append((low[m], high[k], high[m]))
    return positions, faces


def tumbler():
    line = [(0, 0, 0), (0.0255, 0, 0), (0.0285, 0, 0.003), (0.0365, 0.12, 0.0011), (0.0342, 0.12, 0.0011), (0.0263, 0.0115, 0.006), (0, 0.0095, 0)]
    return revolved(rounded(line, 6), 72)


def spout():
    """A round rod that ends in a hollow, from which a jet comes."""
    line = [(0, 0.012, 0), (0.0062, 0.012, 0.002), (0.0066, 0, 0.001), (0.0085, 0, 0.001), (0.0085, 0.02, 0.002), (0.0105, 0.022, 0.001)]
    line += [(0.0105, 0.03, 0.001), (0.0085, 0.032, 0.001), (0.0085, 0.12, 0), (0, 0.12, 0)]
    return revolved(rounded(line, 4), 48)


def dish():
    line = [(0, -0.004, 0), (0.030, -0.004, 0), (0.037, 0.0036, 0.0015), (0.0222, 0.0032, 0.001), (0.0200, 0, 0.002), (0, 0, 0)]
    return revolved(rounded(line), 96)


def pond():
    line = [(0, -0.03, 0), (0.55, -0.03, 0.02), (0.56, 0.135, 0.02), (0.465, 0.135, 0.02), (0.455, 0, 0.05), (0, 0, 0)]
    return revolved(rounded(line), 96)


def basin():
    line = [(0, 0, 0), (0.42, 0, 0), (0.42, 0.112, 0.006), (0.435, 0.12, 0.005), (0.435, 0.14, 0.008)]
    line += [(0.385, 0.14, 0.008), (0.385, 0.03, 0.02), (0.10, 0.03, 0.01), (0.085, 0.06, 0.01), (0.045, 0.075, 0.02), (0.04, 0.17, 0.04)]
    line += [(0.065, 0.215, 0.02), (0.19, 0.265, 0.03), (0.195, 0.285, 0.005), (0.175, 0.283, 0.008), (0.11, 0.245, 0.06), (0.04, 0.235, 0.02)]
    line += [(0.026, 0.31, 0.006), (0.019, 0.31, 0.002), (0.017, 0.295, 0), (0, 0.295, 0)]
    return revolved(rounded(line, 4), 80)


def hashed(x, y, z, seed):
    k = (x * 374761393 + y * 668265263 + z * 2147483647 + seed * 1274126177) & 0xFFFFFFFF
    k = ((k ^ (k >> 13)) * 1274126177) & 0xFFFFFFFF
    return ((k ^ (k >> 16)) & 0xFFFF) / 65535.0


def noise(x, y, z, seed):
    """-1..1, a smooth hill or hollow every unit (value noise: Perlin 1985's lattice)."""
    i, j, k = math.floor(x), math.floor(y), math.floor(z)
    u, v, w = (t * t * (3 - 2 * t) for t in (x - i, y - j, z - k))
    sum_ = 0.0
    for c in range(8):
        a, b, d = c & 1, c >> 1 & 1, c >> 2
        weight = (u if a else 1 - u) * (v if b else 1 - v) * (w if d else 1 - w)
        sum_ += weight * hashed(i + a, j + b, k + d, seed)
    return 2 * sum_ - 1


def rough(x, y, z, seed, octaves, ridged=False):
    sum_, size, scale = 0.0, 1.0, 1.0
    for o in range(octaves):
        n = noise(x * scale, y * scale, z * scale, seed + o)
        sum_ += size * ((1 - 2 * abs(n)) if ridged else n)
        size, scale = 0.5 * size, 2.03 * scale
    return sum_


def icosphere(times):
    g = (1 + math.sqrt(5)) / 2
    points = [(-1, g, 0), (1, g, 0), (-1, -g, 0), (1, -g, 0), (0, -1, g), (0, 1, g), (0, -1, -g), (0, 1, -g), (g, 0, -1), (g, 0, 1), (-g, 0, -1), (-g, 0, 1)]
    faces = [(0, 11, 5), (0, 5, 1), (0, 1, 7), (0, 7, 10), (0, 10, 11), (1, 5, 9), (5, 11, 4), (11, 10, 2), (10, 7, 6), (7, 1, 8)]
    faces += [(3, 9, 4), (3, 4, 2), (3, 2, 6), (3, 6, 8), (3, 8, 9), (4, 9, 5), (2, 4, 11), (6, 2, 10), (8, 6, 7), (9, 8, 1)]
    unit = lambda p: tuple(c / math.sqrt(sum(d * d for d in p)) for c in p)
    points = [unit(p) for p in points]
    for _ in range(times):
        middle, split = {}, []

        def between(a, b):
            key = (min(a, b), max(a, b))
            if key not in middle:
                middle[key] = len(points)
                points.append(unit(tuple(p + q for p, q in zip(points[a], points[b]))))
            return middle[key]

        for a, b, c in faces:
            d, e, f = between(a, b), between(b, c), between(c, a)
            split += [(a, d, f), (b, e, d), (c, f, e), (d, e, f)]
        faces = split
    return points, faces


# Middle (x, z), foot (y), half sizes, m.
ROCKS = [((3.05, 1.35), 0.05, (0.50, 1.02, 0.42)), ((3.75, 2.35), 0.10, (0.40, 0.80, 0.48)), ((2.15, 0.95), 0.00, (0.55, 0.98, 0.42)),
         ((4.35, 1.35), 0.25, (0.34, 0.62, 0.30)), ((4.55, 3.15), 0.30, (0.46, 0.55, 0.40)), ((5.05, 2.25), 0.50, (0.22, 0.26, 0.20))]


def rocks():
    """Balls pulled upright, bitten into by ridges, and cut off here and there along planes, as stone breaks."""
    positions, faces = [], []
    for seed, ((x, z), foot, size) in enumerate(ROCKS):
        points, sides = icosphere(3)
        first = len(positions)
        for p in points:
            q = [1.8 * c + 7.0 * seed for c in p]
            reach = 1 + 0.20 * rough(*q, 11 + 5 * seed, 3, True) + 0.10 * rough(q[0] * 2.2, q[1] * 2.2, q[2] * 2.2, 71 + seed, 2)
            for cut in range(7):
                away = [hashed(cut, k, seed, 5) * 2 - 1 for k in range(3)]
                length = math.sqrt(sum(c * c for c in away)) + 1e-9
                facing = sum(a * c for a, c in zip(away, p)) / length
                if facing > 0.3:
                    reach = min(reach, (0.74 + 0.14 * hashed(cut, 9, seed, 3)) / facing)
            positions.append((x + size[0] * reach * p[0], foot + size[1] * reach * p[1] * (1.0 if p[1] > 0 else 0.4), z + size[2] * reach * p[2]))
        faces += [tuple(first + k for k in f) for f in sides]
    return positions, faces


def shore(x, z):
    """Height of the ground, m: a bed that rises to a beach, and cliffs about the cove."""
    ground = 0.10 + 0.95 * max(0.0, (x - 2.2) / 3.8) ** 1.25 + 0.03 * rough(1.3 * x, 0.0, 1.3 * z, 3, 2)
    side = 0.62 + 0.30 * math.sin(1.1 * x + 0.4) - 0.13 * (x - 3.0) + 0.16 * rough(0.9 * x, 0.0, 2.0, 21, 3)
    wall = 1 / (1 + math.exp(-(side - z) / 0.10))
    back = 1 / (1 + math.exp(-(x - 5.62 - 0.25 * math.sin(1.7 * z + 1.0)) / 0.09))
    cliff = max(wall, 0.75 * back)
    crag = 1.22 + 0.24 * rough(0.8 * x, 0.0, 0.8 * z, 31, 2) + 0.10 * rough(2.6 * x, 0.0, 2.6 * z, 41, 3)
    steps = 3.0 * cliff + 0.35 * rough(1.9 * x, 0.0, 1.9 * z, 61, 2)  # ledges, as layers of stone break
    ledge = cliff + 0.10 * math.sin(2 * math.pi * steps) * 4 * cliff * (1 - cliff)
    return min(ground + ledge * max(crag - ground, 0.0) + 0.035 * cliff * rough(6 * x, 0.0, 6 * z, 51, 2, True), 1.95)


def cove():
    """A solid block with the shore on top."""
    nx, nz, x0, x1, z0, z1, low = 104, 72, -0.06, 6.06, -0.06, 4.06, -0.15
    at = lambda i, j: (x0 + (x1 - x0) * i / nx, z0 + (z1 - z0) * j / nz)
    positions = [(at(i, j)[0], shore(*at(i, j)), at(i, j)[1]) for j in range(nz + 1) for i in range(nx + 1)]
    top = lambda i, j: j * (nx + 1) + i
    faces = []
    for j in range(nz):
        for i in range(nx):
            a, b, c, d = top(i, j), top(i + 1, j), top(i + 1, j + 1), top(i, j + 1)
            faces += [(a, d, c), (a, c, b)]
    rim = [(i, 0) for i in range(nx)] + [(nx, j) for j in range(nz)] + [(i, nz) for i in range(nx, 0, -1)] + [(0, j) for j in range(nz, 0, -1)]
    edge = len(positions)  # the sides have points of their own, so that the upper edge is sharp
    for i, j in rim:
        x, z = at(i, j)
        positions += [(x, shore(x, z), z), (x, low, z)]
    for k in range(len(rim)):
        m = (k + 1) % len(rim)
        faces += [(edge + 2 * k, edge + 2 * m, edge + 2 * m + 1), (edge + 2 * k, edge + 2 * m + 1, edge + 2 * k + 1)]
    under = len(positions)
    for i, j in rim:
        x, z = at(i, j)
        positions.append((x, low, z))
    positions.append((0.5 * (x0 + x1), low, 0.5 * (z0 + z1)))
    for k in range(len(rim)):
        faces.append((under + k, under + (k + 1) % len(rim), len(positions) - 1))
    return positions, faces


def rod():
    """A rod of diameter 1 along y, 3 long."""
    return revolved([(0, -1.5), (0.5, -1.5), (0.5, 1.5), (0, 1.5)], 128)


def pipe():
    """A pipe along y, 4 long, of inner radius 1 and outer radius 1.5: its profile is a closed line, so the last ring meets the first."""
    positions, faces = revolved([(1, -2), (1.5, -2), (1.5, 2), (1, 2), (1, -2)], 128)
    first = len(positions) - 128
    return positions[:first], [tuple(k - first if k >= first else k for k in f) for f in faces]


def trough():
    """A channel along z, 1 long: 1 wide and 1 deep inside, walls 0.2 thick that rise 0.2 higher than that."""
    line = [(-0.7, -0.2), (0.7, -0.2), (0.7, 1.2), (0.5, 1.2), (0.5, 0), (-0.5, 0), (-0.5, 1.2), (-0.7, 1.2)]
    return extruded(line, ((0, 1, 4, 5), (1, 2, 3, 4), (0, 5, 6, 7)), -0.5, 0.5)


def extruded(line, quads, low, high):
    """A closed prism along z: `line` is its outline, counter-clockwise, which the quads (indices) cover."""
    n = len(line)
    positions = [(x, y, z) for z in (low, high) for x, y in line]
    faces = []
    for k in range(n):
        m = (k + 1) % n
        faces += [(k, m, n + m), (k, n + m, n + k)]
    for a, b, c, d in quads:
        faces += [(a, c, b), (a, d, c), (n + a, n + b, n + c), (n + a, n + c, n + d)]
    return positions, faces


def siphon():
    """A weir between two tanks, and a hood over it that reaches down into both: a channel 0.2 wide that is bent twice."""
    weir = [(0.75, -0.1), (0.85, -0.1), (0.85, 0.6), (0.75, 0.6)]
    hood = [(0.51, 0.2), (0.55, 0.2), (0.55, 0.8), (1.05, 0.8), (1.05, 0.2), (1.09, 0.2), (1.09, 0.9), (0.51, 0.9)]
    positions, faces = extruded(weir, [(0, 1, 2, 3)], -0.2, 0.4)
    more, others = extruded(hood, [(0, 1, 2, 7), (2, 3, 6, 7), (3, 4, 5, 6)], -0.2, 0.4)
    return positions + more, faces + [tuple(k + len(positions) for k in f) for f in others]


def main():
    if len(sys.argv) != 2 or not os.path.isdir(sys.argv[1]):
        print("make_meshes: name the folder that the meshes go to", file=sys.stderr)
        return 2
    folder = sys.argv[1]
    write(folder, "tumbler.obj", "A drinking glass with a thick foot, 0.12 m high: a closed surface of revolution.", *tumbler())
    write(folder, "spout.obj", "A spout that ends in a hollow, m: a closed surface of revolution.", *spout())
    write(folder, "dish.obj", "A shallow dish with a broad rim, m: a closed surface of revolution.", *dish())
    write(folder, "pond.obj", "A round pond with a broad rim, m: a closed surface of revolution.", *pond())
    write(folder, "basin.obj", "A fountain's basin with a bowl on a stem, m: a closed surface of revolution.", *basin())
    write(folder, "rocks.obj", "Rocks that stand in a cove, m.", *rocks())
    write(folder, "cove.obj", "A cove: sea bed, beach and cliffs on a block, m.", *cove())
    write(folder, "rod.obj", "A rod of diameter 1 along y, 3 long: a closed surface of revolution.", *rod())
    write(folder, "pipe.obj", "A pipe along y, 4 long, of inner radius 1 and outer radius 1.5: a closed surface of revolution.", *pipe())
    write(folder, "trough.obj", "A channel along z, 1 wide, 1 deep and 1 long inside, walls 0.2 thick that rise 0.2 higher.", *trough())
    write(folder, "siphon.obj", "A weir and a hood over it, which make a channel 0.2 wide between two tanks, m: two closed surfaces.", *siphon())
    return 0


if __name__ == "__main__":
    sys.exit(main())
