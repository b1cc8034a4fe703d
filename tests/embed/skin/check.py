"""check.py FOLDER: FOLDER has pictures of demos/embed_skin with drops and without, and what it printed. Drops lie where the host's compute
shader has moved the skin, the flow feels this motion, a wet pixel is darker or shinier than a dry one, and no liquid is lost."""
import math
import re
import sys

SIDE = 640
CO, SI, COT, AWAY = 0.9397, 0.3420, 3.732, 0.38  # the camera of demos/embed_skin/main.c
failures = []


def check(holds, sentence):
    if not holds:
        failures.append(sentence)


def picture(name):
    """Brightness of each pixel, 0 to 255, rows from the top."""
    with open(f"{sys.argv[1]}/{name}.ppm", "rb") as stream:
        assert stream.readline() == b"P6 %d %d 255\n" % (SIDE, SIDE), name
        data = stream.read()
    return [[sum(data[3 * (SIDE * y + x):3 * (SIDE * y + x) + 3]) / 3 for x in range(SIDE)] for y in range(SIDE)]


def report(name):
    with open(f"{sys.argv[1]}/{name}.txt") as stream:
        text = stream.read()
    return text, [float(n) for n in re.findall(r"-?\d+(?:\.\d+)?", text)]


def projected(p):
    x, y, z = p
    w = AWAY - SI * y - CO * z
    return SIDE / 2 * (1 + COT * x / w), SIDE / 2 * (1 - COT * (CO * y - SI * z) / w)


def moved(u, v, frame):
    """The host's deformation, once more: m, at uv, in that frame (the last drawn is one less than the number of frames)."""
    t = (frame - 1) / 60
    x, y = 0.12 * (u - 0.5), 0.12 * (v - 0.5)
    z = (0.02 - 0.04 * ((u - 0.5) ** 2 + (v - 0.5) ** 2)) * (1 + 0.08 * math.sin(4 * t))
    s = min(max((t - 0.2) / 0.8, 0), 1)
    lean = 1.1 * (1 - s * s * (3 - 2 * s))
    return x + 0.012 * math.sin(2 * t), math.cos(lean) * y + math.sin(lean) * z, math.cos(lean) * z - math.sin(lean) * y


seen, runs = {}, {}
for frame in (20, 60, 75):
    wet, dry = picture(f"wet_{frame}"), picture(f"dry_{frame}")
    text, numbers = report(f"wet_{frame}")
    texels, u, v, x, y, z, runs[frame], drops, added, on_skin, error = numbers
    print(f"frame {frame}: {' | '.join(text.splitlines())}")
    check(texels > 100 and drops == 2, f"frame {frame}: {texels:.0f} texels are wet, and there are {drops:.0f} drops: 2 were added")
    check(added == 16 and error == 0, f"frame {frame}: {added} ul were added, and the ledger has an error of {error} pl")
    check(report(f"dry_{frame}")[1][0] == 0, f"frame {frame}: texels are wet without drops")
    # A drop that is held stays in its place of the skin, which moves.
    check(math.hypot(u - 0.3, v - 0.6) < 0.01, f"frame {frame}: the held drop is at uv ({u}, {v}), not (0.3, 0.6)")
    where = moved(u, v, frame)
    check(math.dist(where, (x, y, z)) < 1.5e-3, f"frame {frame}: the held drop is at {(x, y, z)}, and the skin there is at {where}")
    changed = [(column, row) for row in range(SIDE) for column in range(SIDE) if abs(wet[row][column] - dry[row][column]) > 1.5]
    px, py = projected(where)
    near = [c for c in changed if math.hypot(c[0] + 0.5 - px, c[1] + 0.5 - py) < 14]
    check(len(near) > 15, f"frame {frame}: {len(near)} pixels show the held drop at ({px:.0f}, {py:.0f})")
    if near:
        seen[frame] = sum(c[0] for c in near) / len(near) + 0.5, sum(c[1] for c in near) / len(near) + 0.5
        check(math.dist(seen[frame], (px, py)) < 3, f"frame {frame}: the held drop is drawn at {seen[frame]}, not at ({px:.1f}, {py:.1f})")
    if frame != 60:
        continue
    # The trail of the other drop, compared with the skin 20 pixels beside it in the same picture.
    trail = [(c, r) for c, r in changed if c > SIDE / 2]
    ratios = [2 * wet[r][c] / (wet[r][c - 20] + wet[r][c + 20]) for c, r in trail]
    darker, shinier = sum(q < 0.92 for q in ratios), sum(q > 1.08 for q in ratios)
    print(f"of {len(trail)} pixels of the trail {darker} are darker than the skin beside it, {shinier} brighter")
    check(len(trail) > 800 and darker > 0.2 * len(trail), "the trail does not darken the skin")
    check(shinier > 0.1 * len(trail), "the trail does not shine")
    same = report("gl_60")[1]
    check(all(abs(a - b) < 0.02 * max(1, abs(a)) for a, b in zip(same, numbers)), f"backend gl has {same}, cpu {numbers}")
# While the skin leans back, the other drop is held; when the skin has straightened up, it runs. On the mesh at rest it would run at once.
check(runs[20] > 0.7, f"the running drop has left its place on a skin that leans back: its v is {runs[20]}")
check(runs[60] < 0.5 and runs[75] < runs[60] - 0.1, f"the running drop does not run on a skin that stands: v {runs[60]}, then {runs[75]}")
if len(seen) == 3:
    check(math.dist(seen[20], seen[60]) > 20 and math.dist(seen[60], seen[75]) > 5, f"the held drop is drawn at {seen}: it does not move")
for sentence in failures:
    print(f"embed_skin: {sentence}")
sys.exit(1 if failures else 0)
