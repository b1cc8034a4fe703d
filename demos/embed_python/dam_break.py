"""A column of water, twice as high as wide, collapses. Plots its front over time beside the measurements of Martin and Moyce 1952.

    python3 dam_break.py [PICTURE.png]          prints the differences
"""
import pathlib
import sys

import matplotlib
matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
import rivulet
from rivulet.fit import front

A, SPACING, GRAVITY = 0.25, 0.25 / 16, 9.81  # m, m, m/s^2: the column's width, the particle spacing, gravity
SCENE = {"fluid": {"method": "dfsph", "spacing": SPACING, "box": {"max": [5 * A, 3 * A, A]}, "blocks": [{"max": [A, 2 * A, A]}]}}
TO_T = np.sqrt(2 * GRAVITY / A)  # T = t sqrt(2 g / a), the dimensionless time of Martin and Moyce
DATA = pathlib.Path(__file__).resolve().parents[2] / "assets/reference"


def relative_error(reference):
    """Mean absolute error divided by the mean, at the reference's points from T = 0.4 on."""
    r = reference[(reference[:, 0] >= 0.4) & (reference[:, 0] <= T[-1])]
    return np.abs(np.interp(r[:, 0], T, Z) - r[:, 1]).mean() / r[:, 1].mean()


def speed(times, fronts):
    """Slope of the front from T = 1.43 on, in sqrt(2 g a)."""
    return np.polyfit(times[times >= 1.43], fronts[times >= 1.43], 1)[0]


times, fronts, moments = [], [], {}
with rivulet.Context() as context, context.world(SCENE) as world:
    print(f"{world.stats().particles} particles on {context.device}")
    while not times or times[-1] * TO_T < 3.4:
        particles = world.particles()
        times.append(world.stats().time)
        fronts.append(front(particles.positions, SPACING))
        for wanted in (0, 1.7, 3.3):
            if wanted not in moments and times[-1] * TO_T >= wanted:
                moments[wanted] = particles
        world.step(1 / 240)

T, Z = TO_T * np.array(times), np.array(fronts) / A
measured = np.loadtxt(DATA / "martin_moyce_1952_front.csv", delimiter=",", skiprows=3)
inviscid = np.loadtxt(DATA / "inviscid_dam_break_front.csv", delimiter=",", skiprows=4)
print(f"front against inviscid flow: {100 * relative_error(inviscid):.1f} %")
print(f"front against Martin and Moyce 1952, whose water was released late: {100 * relative_error(measured):.1f} %")
print(f"speed of the front against theirs: {100 * (speed(T, Z) / speed(*measured.T) - 1):+.1f} %")

figure = plt.figure(figsize=(9, 6.4), dpi=110, layout="constrained")
rows = figure.add_gridspec(2, 3, height_ratios=(3, 1))
chart = figure.add_subplot(rows[0, :])
chart.plot(inviscid[:, 0], inviscid[:, 1], color="0.6", linestyle="--", label="inviscid flow, released at once")
chart.plot(T, Z, color="#1769aa", linewidth=2.2, label=f"Rivulet, {len(moments[0].ids)} particles")
chart.plot(measured[:, 0], measured[:, 1], "o", color="#c0392b", markersize=6, label="Martin and Moyce 1952")
chart.set(xlabel=r"$T = t\,\sqrt{2g/a}$", ylabel="front / a", xlim=(0, 3.4), ylim=(0.9, 4.6), title="A column of water collapses")
chart.legend(frameon=False, loc="upper left")
chart.grid(color="0.92")
for column, (when, p) in enumerate(moments.items()):
    side = figure.add_subplot(rows[1, column])
    dots = side.scatter(p.positions[:, 0] / A, p.positions[:, 1] / A, c=np.linalg.norm(p.velocities, axis=1), s=2.5, cmap="viridis", vmin=0, vmax=3, linewidths=0)
    side.set(xlim=(0, 5), ylim=(0, 2.2), aspect="equal", title=f"T = {when:g}", xlabel="x / a")
figure.colorbar(dots, ax=figure.axes[1:], label="speed (m/s)", shrink=0.7)
figure.savefig(sys.argv[1] if len(sys.argv) > 1 else "dam_break.png")
