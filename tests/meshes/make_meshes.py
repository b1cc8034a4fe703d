#!/usr/bin/env python3
"""Writes generated/*.obj: meshes with known defects. `--check` compares the files with what would be written and fails on a difference."""
import pathlib
import sys
from math import cos, pi, sin, sqrt

FOLDER = pathlib.Path(__file__).resolve().parent / "generated"

# A mesh is a list of points and a list of triangles of indices from 0.


def sphere(radius=1.0, rings=24, sides=48, centre=(0.0, 0.0, 0.0)):
    points = [(0.0, radius, 0.0)]
    for i in range(1, rings):
        polar = pi * i / rings
        for j in range(sides):
            turn = 2 * pi * j / sides
            points.append((radius * sin(polar) * cos(turn), radius * cos(polar), radius * sin(polar) * sin(turn)))
    points.append((0.0, -radius, 0.0))
    points = [tuple(p + c for p, c in zip(point, centre)) for point in points]

    def at(ring, side):
        return 1 + ring * sides + side % sides

    faces = []
    for j in range(sides):
        faces += [(0, at(0, j + 1), at(0, j)), (len(points) - 1, at(rings - 2, j), at(rings - 2, j + 1))]
    for i in range(rings - 2):
        for j in range(sides):
            faces += [(at(i, j), at(i, j + 1), at(i + 1, j + 1)), (at(i, j), at(i + 1, j + 1), at(i + 1, j))]
    return points, faces


def inverted(mesh):
    return mesh[0], [face[::-1] for face in mesh[1]]


def together(*meshes):
    points, faces = [], []
    for more, triangles in meshes:
        faces += [tuple(i + len(points) for i in face) for face in triangles]
        points += more
    return points, faces


def welded(mesh):
    """Equal points made one, sorted by coordinates."""
    def key(point):
        return tuple(round(c, 9) + 0.0 for c in point)

    order = sorted({key(point) for point in mesh[0]})
    index = {point: k for k, point in enumerate(order)}
    return order, [tuple(index[key(mesh[0][i])] for i in face) for face in mesh[1]]


def soup(*triangles):
    return [point for triangle in triangles for point in triangle], [(i, i + 1, i + 2) for i in range(0, 3 * len(triangles), 3)]


CUBE_FACES = [(0, 2, 1), (1, 2, 3), (4, 5, 6), (5, 7, 6), (0, 1, 4), (1, 5, 4), (2, 6, 3), (3, 6, 7), (0, 4, 2), (2, 4, 6), (1, 3, 5), (3, 7, 5)]


def box(low=(0.0, 0.0, 0.0), high=(1.0, 1.0, 1.0)):
    points = [tuple((high if k >> axis & 1 else low)[axis] for axis in range(3)) for k in range(8)]
    return points, list(CUBE_FACES)


def torus(place=lambda x, y, z: (x, y, z), radius=1.0, tube=0.3, rings=64, sides=24):
    """About the y axis; `place` turns it."""
    points, upper, lower = [], [], []
    for i in range(rings):
        for j in range(sides):
            turn, side = 2 * pi * i / rings, 2 * pi * j / sides
            out = radius + tube * cos(side)
            points.append(place(out * cos(turn), tube * sin(side), out * sin(turn)))
            a, b = i * sides + j, i * sides + (j + 1) % sides
            c, d = (i + 1) % rings * sides + j, (i + 1) % rings * sides + (j + 1) % sides
            upper.append((a, b, d))
            lower.append((a, d, c))
    return points, upper + lower


def mobius(steps=120, across=8, half=0.3):
    points, faces = [], []
    for i in range(steps):
        turn = 2 * pi * i / steps
        for j in range(across + 1):
            s = -half + 2 * half * j / across
            out = 1 + s * cos(turn / 2)
            points.append((out * cos(turn), s * sin(turn / 2), out * sin(turn)))
    row = across + 1
    for i in range(steps):
        for j in range(across):
            a, b = i * row + j, i * row + j + 1
            c, d = (a + row, b + row) if i + 1 < steps else (across - j, across - j - 1)  # the last row meets the first turned over
            faces += [(a, c, d), (a, d, b)]
    return points, faces


def normalized(v):
    length = sqrt(sum(c * c for c in v))
    return tuple(c / length for c in v)


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def trefoil(steps=400, sides=20, radius=0.25):
    centres = []
    for i in range(steps):
        t = 2 * pi * i / steps
        out = 2 + cos(3 * t)
        centres.append((out * cos(2 * t), sin(3 * t), out * sin(2 * t)))
    points, faces = [], []
    for i, centre in enumerate(centres):
        tangent = normalized(tuple(b - a for a, b in zip(centres[i - 1], centres[(i + 1) % steps])))
        along = sum(a * b for a, b in zip(centre, tangent))
        normal = normalized(tuple(c - along * t for c, t in zip(centre, tangent)))
        other = cross(tangent, normal)
        for j in range(sides):
            side = 2 * pi * j / sides
            points.append(tuple(c + radius * (cos(side) * n + sin(side) * o) for c, n, o in zip(centre, normal, other)))
            a, b = i * sides + j, i * sides + (j + 1) % sides
            c, d = (i + 1) % steps * sides + j, (i + 1) % steps * sides + (j + 1) % sides
            faces += [(d, c, a), (b, d, a)]
    return points, faces


def cup(profile, sides=64):
    """A profile of (radius, height), turned about y; a radius of 0 is a point on the axis."""
    triangles = []
    for j in range(sides):
        def at(k, side):
            turn = 2 * pi * (side % sides) / sides
            return (profile[k][0] * cos(turn), profile[k][1], profile[k][0] * sin(turn))

        for k in range(len(profile) - 1):
            a, b, c, d = at(k, j), at(k + 1, j), at(k + 1, j + 1), at(k, j + 1)
            if profile[k][0] > 0 and profile[k + 1][0] > 0:
                triangles += [(a, b, c), (a, c, d)]
            else:
                triangles.append((a, b, c) if profile[k][0] == 0 else (a, b, d))
    return welded(soup(*triangles))


CUP = [(0.0, 0.0), (0.5, 0.0), (0.6, 1.2)]

# The faces that sphere_holes lacks: one in eight, drawn at random once.
HOLES = {int(face) for face in """
    9 13 17 20 34 61 80 85 87 105 113 119 121 148 162 163 165 167 170 172 176 186 188 189 190 194 212 213 218 224 232 233 256 258 272 280 309
    323 331 339 343 345 357 358 362 363 369 370 380 381 391 395 435 438 451 469 473 478 516 519 524 532 533 540 548 561 573 585 588 592 599 601
    605 616 620 638 640 645 647 662 681 684 691 694 695 700 703 720 725 726 733 736 744 745 750 775 793 803 810 812 838 841 842 862 874 883 896
    904 917 920 924 925 934 947 951 957 968 973 981 983 986 995 1009 1011 1013 1021 1023 1063 1066 1069 1072 1073 1096 1108 1112 1124 1130 1138
    1153 1158 1159 1163 1164 1174 1175 1182 1185 1189 1193 1210 1253 1261 1290 1295 1303 1314 1316 1320 1321 1331 1340 1345 1347 1353 1359 1361
    1364 1366 1385 1391 1392 1413 1418 1420 1423 1431 1438 1446 1455 1459 1460 1462 1475 1486 1488 1502 1509 1515 1524 1529 1543 1550 1557 1564
    1577 1585 1601 1615 1656 1658 1664 1670 1706 1708 1716 1717 1731 1735 1738 1744 1748 1749 1754 1756 1758 1766 1776 1782 1784 1789 1795 1811
    1813 1816 1823 1829 1830 1832 1833 1834 1847 1848 1885 1893 1894 1899 1914 1923 1932 1934 1955 1963 1982 1986 1989 1993 1998 2001 2002 2003
    2004 2009 2013 2014 2018 2037 2055 2071 2081 2088 2095 2107 2120 2126 2136 2139 2155 2157 2159 2161 2169 2179 2187 2197 2198 2200
""".split()}


def with_holes(mesh):
    return mesh[0], [face for k, face in enumerate(mesh[1]) if k not in HOLES]


def degenerate(mesh):
    points, faces = mesh
    points = points + [(5.0, 5.0, 5.0), points[0]]
    return points, faces + [(0, 1, 1), (3, 3, 3)] + faces[:50] + [(0, len(points) - 1, 1)]


def split_edge():
    """A cube whose bottom has a vertex in the middle of an edge that the side beside it does not have."""
    points, faces = box()
    middle = len(points)
    bottom = [(0, middle, 4), (middle, 5, 4), (middle, 1, 5)]
    return welded((points + [(0.5, 0.0, 0.0)], [face for face in faces if face not in ((0, 1, 4), (1, 5, 4))] + bottom))


def fin():
    return together(box(), ([(0.5, 1.0, 0.0), (0.5, 1.0, 1.0), (0.5, 1.7, 0.5)], [(0, 1, 2)]))


MESHES = {
    "nested_shells_alternating": ("solid shell r 0.8..1 (inner wall reversed) with a solid core r 0.4; inside by winding number AND parity agree",
                                  lambda: together(sphere(), inverted(sphere(0.8)), sphere(0.4))),
    "thin_wall_cup": ("watertight cup, wall 0.01 thick, radius 0.5-0.6, height 1.2: must hold water at voxel size >> wall",
                      lambda: cup(CUP + [(0.59, 1.2), (0.49, 0.01), (0.0, 0.01)])),
    "sheet_cup_open": ("zero-thickness open cup (one boundary loop), must hold water as a two-sided sheet", lambda: cup(CUP)),
    "nonmanifold_edge_two_cubes": ("two unit cubes sharing exactly one edge (4 faces on an edge)",
                                   lambda: welded(together(box(), box((1.0, 1.0, 0.0), (2.0, 2.0, 1.0))))),
    "cube_with_fin": ("closed cube with a dangling zero-thickness fin on its top", fin),
    "nonmanifold_vertex_two_cubes": ("two cubes touching in one vertex", lambda: welded(together(box(), box((1.0, 1.0, 1.0), (2.0, 2.0, 2.0))))),
    "self_intersecting_tori": ("three mutually intersecting closed tori",
                               lambda: together(torus(), torus(lambda x, y, z: (x, 0.0 - z, y)), torus(lambda x, y, z: (0.0 - y, x, z)))),
    "overlapping_spheres": ("three overlapping closed spheres; union volume < sum of signed volumes",
                            lambda: together(sphere(centre=(-0.5, 0.0, 0.0)), sphere(centre=(0.5, 0.0, 0.0)), sphere(0.6, centre=(0.0, 0.9, 0.0)))),
    "mobius": ("open non-orientable strip", mobius),
    "sphere_inverted": ("closed sphere with all faces inward (negative volume)", lambda: inverted(sphere())),
    "sphere_holes": ("sphere with 12% of faces missing", lambda: with_holes(sphere())),
    "sphere_degenerate": ("sphere + repeated-index faces + 50 duplicated faces + duplicate vertex + an unreferenced vertex at (5,5,5)",
                          lambda: degenerate(sphere())),
    "coplanar_boxes": ("touching and coplanar-overlapping closed boxes with faces exactly on a 0.25 grid",
                       lambda: together(box(), box((1.0, 0.0, 0.0), (2.0, 1.0, 1.0)), box((0.25, 1.0, 0.25), (0.75, 1.5, 0.75)),
                                        box((0.0, 0.0, 0.0), (1.0, 0.5, 1.0)))),
    "trefoil_tube": ("closed trefoil tube radius 0.25", trefoil),
    "huge_sphere": ("sphere r 1000", lambda: sphere(1000.0, 48, 96)),
    "cube_tjunction": ("unit cube whose bottom has an extra vertex on one edge (T-junction, geometrically closed, topologically open)", split_edge),
}


def obj(name):
    doc, make = MESHES[name]
    points, faces = make()
    lines = [f"# {name} - {doc}", "# Generated procedurally for this project; CC0 1.0 (public domain dedication)"]
    lines += ["v " + " ".join(f"{c:g}" for c in point) for point in points]
    lines += ["f " + " ".join(str(i + 1) for i in face) for face in faces]
    return "\n".join(lines) + "\n"


def same(a, b):
    """Equal words, and numbers that are equal but for the last place: sin and cos differ between processors."""
    a, b = a.split(), b.split()
    return len(a) == len(b) and all(x == y or number(x, y) for x, y in zip(a, b))


def number(a, b):
    try:
        return abs(float(a) - float(b)) <= 2e-6 * max(1e-6, abs(float(a)))
    except ValueError:
        return False


if __name__ == "__main__":
    check = sys.argv[1:] == ["--check"]
    wrong = sorted({path.stem for path in FOLDER.glob("*.obj")} - set(MESHES))
    for name in MESHES:
        path = FOLDER / (name + ".obj")
        if not check:
            path.write_text(obj(name))
        elif not path.exists() or not same(path.read_text(), obj(name)):
            wrong.append(name)
    if wrong:
        sys.exit("generated/ is not what make_meshes.py writes: " + ", ".join(wrong))
