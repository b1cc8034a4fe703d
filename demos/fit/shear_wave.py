"""A wave of shear in a periodic box, u = U sin(k y), decays as exp(-nu k^2 t): the viscosity nu is found from the decay.

    python3 shear_wave.py [FOLDER]          finds nu from the theory's own curve, and prints both
"""
import sys

import numpy as np

NU, U, EDGE, SPACING = 0.01, 0.1, 0.48, 0.02  # m^2/s, m/s, m, m
K = 2 * np.pi / EDGE
SCENE = {"fluid": {"method": "dfsph", "spacing": SPACING, "gravity": [0, 0, 0], "artificialViscosity": 0,
                   "box": {"max": [0.16, EDGE, 0.16], "periodicX": True, "periodicY": True, "periodicZ": True}}}


def start(context, scene):
    """A lattice of particles with the wave's velocities."""
    sides = [np.arange(0.5 * SPACING, side, SPACING) for side in scene["fluid"]["box"]["max"]]
    places = np.stack(np.meshgrid(*sides, indexing="ij"), axis=-1).reshape(-1, 3)
    velocities = np.zeros_like(places)
    velocities[:, 0] = U * np.sin(K * places[:, 1])
    return context.world(scene, particles=places, velocities=velocities)


def amplitude(world, spacing):
    """Of the wave, m/s."""
    particles = world.particles()
    return float(2 * np.mean(particles.velocities[:, 0] * np.sin(K * particles.positions[:, 1])))


def decay(nu=NU, seconds=0.5):
    t = np.linspace(0, seconds, 26)
    return np.column_stack([t, U * np.exp(-nu * K**2 * t)])


if __name__ == "__main__":
    from rivulet.fit import fit
    found = fit(SCENE, {"fluid.viscosity": (1e-3, 1e-1, "log")}, decay(), amplitude, start=start, folder=sys.argv[1] if sys.argv[1:] else "fit", frame=1 / 120)
    print(found)
    print(f"the theory's viscosity is {NU:g} m^2/s")
