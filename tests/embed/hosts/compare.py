"""compare.py NAME FOLDER: FOLDER has NAME_wet.ppm and NAME_dry.ppm, a host's picture with water and without. What water may change, what it
must leave alone, what is seen through it; and how far the picture is from NAME.png beside this file, which RIVULET_UPDATE_GOLDEN=1 writes.
All hosts have the same scene, so its numbers stand here once more: those that a picture is judged by."""
import os
import sys

import matplotlib.image
import numpy as np

EYE, TARGET, HEIGHT_ANGLE = np.array([0.6, 1.05, 2.75]), np.array([0.6, 0.154, 0.6]), np.radians(42.08)
WIDTH, HEIGHT = 640, 480
TOLERANCE = 0.004  # mean over the picture, of 1


def projected(points):
    """Pixels (x, y), y downwards, of points (m)."""
    ahead = (TARGET - EYE) / np.linalg.norm(TARGET - EYE)
    right = np.cross(ahead, [0, 1, 0])
    right /= np.linalg.norm(right)
    up = np.cross(right, ahead)
    away = np.asarray(points, float) - EYE
    scale = 0.5 * HEIGHT / np.tan(0.5 * HEIGHT_ANGLE) / (away @ ahead)
    return np.stack([0.5 * WIDTH + (away @ right) * scale, 0.5 * HEIGHT - (away @ up) * scale], axis=1)


def inside(points, margin):
    """Mask of the pixels in the convex hull of projected points, `margin` pixels wider."""
    p = projected(points)
    y, x = np.mgrid[0:HEIGHT, 0:WIDTH] + 0.5
    mask = np.ones((HEIGHT, WIDTH), bool)
    for a in p:
        for b in p:
            edge = b - a
            length = np.hypot(*edge)
            if length < 1e-9:
                continue
            side = (edge[0] * (p[:, 1] - a[1]) - edge[1] * (p[:, 0] - a[0])) / length
            if side.min() >= -1e-9:  # all lie on one side of it: an edge of the hull
                mask &= (edge[0] * (y - a[1]) - edge[1] * (x - a[0])) / length >= -margin
    return mask


def box(low, high):
    return [[(low, high)[k >> axis & 1][axis] for axis in range(3)] for k in range(8)]


def read(path):
    with open(path, "rb") as stream:
        assert stream.readline() == b"P6 %d %d 255\n" % (WIDTH, HEIGHT), path
        return np.frombuffer(stream.read(), np.uint8).reshape(HEIGHT, WIDTH, 3) / 255.0


name, folder = sys.argv[1:]
wet, dry = (read(os.path.join(folder, f"{name}_{which}.ppm")) for which in ("wet", "dry"))
changed = np.abs(wet - dry).max(axis=2) > 0.5 / 255
failures = []


def check(holds, sentence):
    if not holds:
        failures.append(sentence)


# The water's box, 1.2 m each way; it fills what is under 0.25 m even where the splash has dug.
outside = ~inside(box((0, 0, 0), (1.2, 1.2, 1.2)), 2)
check(not changed[outside].any(), f"{changed[outside].sum()} pixels changed outside the water's box")
red = (dry[..., 0] > 0.25) & (dry[..., 0] > 2 * dry[..., 1]) & (dry[..., 0] > 2 * dry[..., 2])
check(red.sum() > 2000, f"the post before the water is {red.sum()} pixels")
check(not changed[red].any(), f"{changed[red].sum()} pixels of the post before the water changed")
pool = inside(box((0.03, 0.02, 0.03), (1.17, 0.15, 1.17)), -2) & ~red
check(changed[pool].mean() > 0.99, f"only {changed[pool].mean():.3f} of the pool shows water")
beside = np.zeros_like(red)
for shift in range(3, 8):
    beside |= np.roll(red, shift, axis=1)
beside &= pool
check(beside.sum() > 100 and changed[beside].mean() > 0.95, "the water does not go on beside the post")

# What lies under it: water that is clear and no thicker than this lets the mosaic be seen, and moves it, which a tint would not.
mosaic = inside([(x, 0, z) for x in (0.3, 0.9) for z in (0.3, 0.9)], -2)
light = [picture.mean(axis=2)[mosaic] for picture in (wet, dry)]
share = light[0].std() / light[1].std()
check(share > 0.3, f"the mosaic under water has only {share:.2f} of its contrast")
alike = np.corrcoef(light[0], light[1])[0, 1]
check(alike < 0.6, f"the mosaic is where it was without water (correlation {alike:.2f}): nothing is refracted")
# The pole above the water, seen before the far wall, is as it was.
pole = inside(box((0.71, 0.62, 0.39), (0.73, 0.78, 0.41)), -1)
check(np.abs(wet - dry).mean(axis=2)[pole].mean() < 0.02, "the pole above the water changed")

small = wet.reshape(HEIGHT // 2, 2, WIDTH // 2, 2, 3).mean(axis=(1, 3))
reference = os.path.join(os.path.dirname(os.path.abspath(__file__)), name + ".png")
if os.environ.get("RIVULET_UPDATE_GOLDEN") == "1":
    matplotlib.image.imsave(reference, np.round(small * 255).astype(np.uint8))
golden = matplotlib.image.imread(reference)[..., :3]
off = np.abs(small - golden).mean()
check(off < TOLERANCE, f"the picture is {off:.4f} from {name}.png, allowed are {TOLERANCE}")
without = np.abs(dry.reshape(HEIGHT // 2, 2, WIDTH // 2, 2, 3).mean(axis=(1, 3)) - golden).mean()
check(without > 6 * TOLERANCE, f"{name}.png shows no water: it is {without:.4f} from the host alone")
print(f"{name}: {changed.mean():.3f} changed, contrast {share:.2f}, correlation {alike:.2f}, {off:.5f} from the reference, dry {without:.4f}")
for sentence in failures:
    print(f"{name}: {sentence}")
sys.exit(1 if failures else 0)
