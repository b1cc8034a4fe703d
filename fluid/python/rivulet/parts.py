"""What a world is made of and asked with: meshes, bodies, floats, volumes; and the records that it gives."""
from __future__ import annotations

import ctypes
from typing import Any, NamedTuple, Sequence, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _structs as c
from ._library import BadInput, address_of, array_of, array_or_none, number_of, of_kind, struct, vector, whole

Array = NDArray[Any]
_NONE = (0, 0, 0)


class Stats(NamedTuple):
    """Numbers of a world; on a GPU two or three frames old."""

    time: float  #: s simulated
    dropped: float  #: s that were not simulated: frames longer than allowed
    particles: int  #: in the world now
    lost: int  #: particles that left the grid or became not finite
    average_compression: float  #: a fraction
    kinetic: float  #: J
    potential: float  #: J
    maximum_speed: float  #: m/s
    centre_of_mass: Array  #: (3,) m
    substeps: int  #: of the last frame
    asleep: int  #: of the particles


class Particles(NamedTuple):
    """All particles. Their order changes from step to step; ids do not."""

    positions: Array  #: (n, 3) float32, m
    velocities: Array  #: (n, 3) float32, m/s
    densities: Array  #: (n,) float32, over the rest density; negative in World.rows(): the row holds no particle
    ids: Array  #: (n,) uint32


class SkinStats(NamedTuple):
    """Numbers of a skin: drops on it now; volumes (m^3) since the start, but on_skin: now, in drops and film."""

    drops: int
    added: float
    on_skin: float
    left: float
    evaporated: float
    refused: float  #: no drop slot was free


class Air(NamedTuple):
    """Drops in the air: their number and volume (m^3) now; volumes (m^3) since the start: lost below the floor, into and out of the water."""

    drops: int
    in_air: float
    lost: float
    into_water: float
    from_water: float


class Box(NamedTuple):
    """A volume that counts or paints particles."""

    id: int  #: chosen by the caller
    position: ArrayLike  #: (3,) m, of its centre
    size: ArrayLike  #: (3,) m


class Sphere(NamedTuple):
    """A volume that counts or paints particles."""

    id: int  #: chosen by the caller
    position: ArrayLike  #: (3,) m, of its centre
    radius: float  #: m


Volume = Union[Box, Sphere]


class _Given:
    """Pickles as the arguments that made it."""

    _arguments: dict[str, Any]

    def __getstate__(self) -> dict[str, Any]:
        return self._arguments

    def __setstate__(self, arguments: dict[str, Any]) -> None:
        self.__init__(**arguments)  # type: ignore[misc]

    def _keep(self, arguments: dict[str, Any]) -> None:
        self._arguments = {name: value for name, value in arguments.items() if name not in ("self", "__class__")}


class Mesh(_Given):
    """A triangle mesh: a wall, the surface of a body, or a skin.

    positions: (n, 3) m; indices: (k, 3), of triangles; uvs: (n, 2), for skins.
    Of a wall: friction (Coulomb's coefficient) and restitution (0 to 1), negative: those of fluid.collision; moves: it moves rigidly with
    World.step's poses; deforms: its vertices move with World.step's shapes; resolution: voxels along its longest side, 0: a quarter of the
    spacing each; position (m) and rotation (x y z w) at t = 0 of one that moves; reach: low and high corner (m) of a box in which one that
    deforms always is, None: the box of its positions, longer by half its longest side in each direction; layers, meets: collision layers as
    bits, 0: the first, and all.
    BadInput: shapes that do not fit, indices that are no whole numbers. Arrays of float32 and uint32 are not copied. It can be pickled."""

    def __init__(self, positions: ArrayLike, indices: ArrayLike, uvs: ArrayLike | None = None, friction: float = -1.0,
                 restitution: float = -1.0, moves: bool = False, resolution: int = 0, position: ArrayLike = _NONE,
                 rotation: ArrayLike = (0, 0, 0, 1), deforms: bool = False, reach: ArrayLike | None = None, layers: int = 0,
                 meets: int = 0) -> None:
        self._keep(locals())
        self.positions, self.uvs = array_of(positions, (-1, 3), "positions"), array_or_none(uvs, (-1, 2), "uvs")
        integers = isinstance(indices, np.ndarray) and indices.dtype.kind in "iu"
        whole_numbers = np.asarray(indices) if integers else array_of(indices, (-1, 3), "indices", np.float64)
        if not (np.mod(whole_numbers, 1) == 0).all() or np.min(whole_numbers, initial=0) < 0 or np.max(whole_numbers, initial=0) >= 2**32:
            raise BadInput("indices must be whole numbers from 0 to 2**32 - 1")
        self.indices = array_of(indices, (-1, 3), "indices", np.uint32)
        if self.uvs is not None and len(self.uvs) != len(self.positions):
            raise BadInput(f"{len(self.uvs)} uvs were given for {len(self.positions)} positions: give one for each")
        if moves and deforms:
            raise BadInput("a wall either moves rigidly or deforms: set one of moves and deforms")
        corners = np.zeros((2, 3)) if reach is None else array_of(reach, (2, 3), "reach")
        self._c = struct(c.Mesh, positions=address_of(self.positions), vertices=len(self.positions), indices=address_of(self.indices),
                         indices_count=self.indices.size, uvs=address_of(self.uvs), friction=friction, restitution=restitution,
                         moves=2 if deforms else int(moves), resolution=whole(resolution, 0, 2**31 - 1, "resolution"),
                         pose=pose_of(position, rotation), reach_low=tuple(corners[0]), reach_high=tuple(corners[1]),
                         layers=whole(layers, 0, 65535, "layers"), meets=whole(meets, 0, 65535, "meets"))


class Body(_Given):
    """A rigid body in the fluid, coupled both ways.

    samples: (n, 3) m, points half a spacing below its surface, about a spacing apart, relative to its centre of mass along its principal
    axes; mass (kg; 0: fixed), inertia (3,) kg m^2 about those axes, volume (m^3). Or mesh, a closed Mesh, and density (kg/m^3): these are
    then found from it, and the body's frame is that of the mesh.
    Its pose at t = 0 or when it is added: position (m), rotation (x y z w); velocity (m/s), spin (rad/s). layers, meets: collision layers as
    bits, whether the water meets it. BadInput: shapes that do not fit. It can be pickled."""

    def __init__(self, samples: ArrayLike | None = None, mass: float = 0.0, inertia: ArrayLike = _NONE, volume: float = 0.0,
                 position: ArrayLike = _NONE, rotation: ArrayLike = (0, 0, 0, 1), mesh: Mesh | None = None, density: float = 0.0,
                 velocity: ArrayLike = _NONE, spin: ArrayLike = _NONE, layers: int = 0, meets: int = 0) -> None:
        self._keep(locals())
        if mesh is not None:
            of_kind(mesh, Mesh, "mesh")
        self.samples, self.mesh = array_or_none(samples, (-1, 3), "samples"), mesh
        self._c = struct(c.Body, samples=address_of(self.samples), samples_count=0 if self.samples is None else len(self.samples), mass=mass,
                         volume=volume, inertia=vector(inertia, 3, "inertia"), pose=pose_of(position, rotation),
                         mesh=None if mesh is None else ctypes.pointer(mesh._c), density=density, velocity=vector(velocity, 3, "velocity"),
                         spin=vector(spin, 3, "spin"), layers=whole(layers, 0, 65535, "layers"), meets=whole(meets, 0, 65535, "meets"))


class Float(_Given):
    """An object that the caller moves and that has no effect on the water; see World.buoyancy.

    points: (n, 3) m, in its frame, whose origin is its centre of mass, at least a spacing apart; volumes: (n,) m^3, one a point; mass (kg);
    linear_drag, quadratic_drag (1/s). Its state now: position (m), rotation (x y z w), velocity (m/s), spin (rad/s)."""

    def __init__(self, points: ArrayLike, volumes: ArrayLike, mass: float, linear_drag: float = 0.0, quadratic_drag: float = 0.0,
                 position: ArrayLike = _NONE, rotation: ArrayLike = (0, 0, 0, 1), velocity: ArrayLike = _NONE, spin: ArrayLike = _NONE) -> None:
        self._keep(locals())
        self.points, self.volumes = array_of(points, (-1, 3), "points"), array_of(volumes, (-1,), "volumes")
        if len(self.points) != len(self.volumes):
            raise BadInput(f"{len(self.volumes)} volumes were given for {len(self.points)} points: give one for each")
        state = c.BodyState(pose_of(position, rotation), vector(velocity, 3, "velocity"), vector(spin, 3, "spin"))
        self._c = struct(c.Float, points=address_of(self.points), volumes=address_of(self.volumes), points_count=len(self.points), mass=mass,
                         linear_drag=linear_drag, quadratic_drag=quadratic_drag, state=state)


def pose_of(position: ArrayLike, rotation: ArrayLike) -> c.Pose:
    return c.Pose(vector(position, 3, "position"), vector(rotation, 4, "rotation"))


def rows_of(volumes: Sequence[Volume]) -> Array:
    if not isinstance(volumes, (list, tuple)) or isinstance(volumes, (Box, Sphere)):
        raise BadInput(f"the volumes are {volumes!r}: give a list of Box and Sphere")
    rows = np.zeros(len(volumes), c.VOLUME)
    for row, volume in zip(rows, volumes):
        if not isinstance(volume, (Box, Sphere)):
            raise BadInput(f"a volume is {volume!r}: give Box or Sphere")
        row["id"], row["position"] = whole(volume.id, 0, 2**32 - 1, "a volume's id"), vector(volume.position, 3, "a volume's position")
        if isinstance(volume, Box):
            row["size"] = vector(volume.size, 3, "a volume's size")
        else:
            row["shape"], row["radius"] = 1, number_of(volume.radius, "a volume's radius")
    return rows
