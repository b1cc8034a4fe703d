"""What a world is made of and asked with: meshes, bodies, volumes; and the records that it gives."""
import ctypes
from collections import namedtuple

import numpy as np

from . import _structs as c
from ._library import BadInput, address_of, array_of, struct, whole

Stats = namedtuple("Stats", [name for name, _ in c.Stats._fields_[1:]])
Stats.__doc__ = "time, dropped (s); particles, lost; average_compression; kinetic, potential (J); maximum_speed (m/s); centre_of_mass (m); substeps; asleep, of the particles."
SkinStats = namedtuple("SkinStats", [name for name, _ in c.SkinStats._fields_[1:]])
SkinStats.__doc__ = "drops; added, on_skin, left, evaporated, refused (m^3)."
Box = namedtuple("Box", ["id", "position", "size"])
Box.__doc__ = "A volume that counts particles: id, chosen by the caller; position (m) of its centre; size (m)."
Sphere = namedtuple("Sphere", ["id", "position", "radius"])
Sphere.__doc__ = "A volume that counts particles: id, chosen by the caller; position (m) of its centre; radius (m)."
Particles = namedtuple("Particles", ["positions", "velocities", "densities", "ids"])
Particles.__doc__ = "positions (n, 3) m, velocities (n, 3) m/s, densities (n,) over rest density: float32; ids (n,): uint32. Their order changes from step to step; ids do not."


class Mesh:
    """positions (m, n x 3), indices (of triangles, k x 3), uvs (n x 2; for skins). Of a wall: friction and restitution (negative: those of
    fluid.collision), moves (it moves rigidly with World.step's poses), resolution (voxels along its longest side; 0: from the spacing), and if it
    moves its pose at t = 0: position (m), rotation (x y z w)."""

    def __init__(self, positions, indices, uvs=None, friction=-1.0, restitution=-1.0, moves=False, resolution=0, position=(0, 0, 0),
                 rotation=(0, 0, 0, 1)):
        self.positions, self.uvs = array_of(positions, (-1, 3), "positions"), array_of(uvs, (-1, 2), "uvs")
        if not (np.mod(indices, 1) == 0).all() or np.min(indices, initial=0) < 0 or np.max(indices, initial=0) >= 2**32:
            raise BadInput("indices must be whole numbers from 0 to 2**32 - 1")
        self.indices = array_of(indices, (-1, 3), "indices", np.uint32)
        if uvs is not None and len(self.uvs) != len(self.positions):
            raise BadInput(f"{len(self.uvs)} uvs were given for {len(self.positions)} positions: give one for each")
        self._c = struct(c.Mesh, positions=address_of(self.positions), vertices=len(self.positions), indices=address_of(self.indices),
                        indices_count=self.indices.size, uvs=address_of(self.uvs), friction=friction, restitution=restitution, moves=int(moves),
                        resolution=whole(resolution, 0, 2**31 - 1, "resolution"), position=tuple(array_of(position, (3,), "position")),
                        rotation=tuple(array_of(rotation, (4,), "rotation")))


class Body:
    """A rigid body in the fluid. samples (m, n x 3): points half a spacing below its surface, about a spacing apart, relative to its centre of
    mass along its principal axes; mass (kg; 0: fixed), inertia (kg m^2, about those axes), volume (m^3). Or mesh, a closed Mesh, and density
    (kg/m^3): these are then found from it, and the body's frame is that of the mesh. Its pose at t = 0 or when it is added: position (m),
    rotation (x y z w); velocity (m/s), spin (rad/s). layers, meets: as rivulet.h, whether the water meets it."""

    def __init__(self, samples=None, mass=0.0, inertia=(0, 0, 0), volume=0.0, position=(0, 0, 0), rotation=(0, 0, 0, 1), mesh=None, density=0.0,
                 velocity=(0, 0, 0), spin=(0, 0, 0), layers=0, meets=0):
        self.samples, self.mesh = array_of(samples, (-1, 3), "samples"), mesh
        self._c = struct(c.Body, samples=address_of(self.samples), samples_count=0 if samples is None else len(self.samples), mass=mass, volume=volume,
                        inertia=tuple(array_of(inertia, (3,), "inertia")), position=tuple(array_of(position, (3,), "position")),
                        rotation=tuple(array_of(rotation, (4,), "rotation")), mesh=None if mesh is None else ctypes.pointer(mesh._c),
                        density=density, velocity=tuple(array_of(velocity, (3,), "velocity")), spin=tuple(array_of(spin, (3,), "spin")),
                        layers=whole(layers, 0, 65535, "layers"), meets=whole(meets, 0, 65535, "meets"))


def rows_of(volumes):
    rows = np.zeros(len(volumes), c.VOLUME)
    for row, volume in zip(rows, volumes):
        row["id"], row["position"] = whole(volume.id, 0, 2**32 - 1, "a volume's id"), volume.position
        if isinstance(volume, Box):
            row["size"] = volume.size
        else:
            row["shape"], row["radius"] = 1, volume.radius
    return rows
