"""Bodies that are dropped onto corners, edges and three points: a hundred of them, the same each time.

A body is boxes and cylinders, or the hull of points, of one density. Each engine reads it from what this module writes.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np
import trimesh
from scipy.spatial.transform import Rotation

COUNT, SEED = 100, 4732
KINDS = ("box", "hull", "cylinder", "ell", "stool")
SECONDS = 4.0  # until all of them rest
APART = 4.0  # m, between bodies in one world
_SAME = np.sin(np.radians(10.0))


@dataclass(frozen=True)
class Part:
    """A box of sides, a cylinder of radius and length, or the hull of points (m), at a place on the body."""

    kind: str
    sizes: tuple[float, ...]
    xyz: tuple[float, float, float] = (0.0, 0.0, 0.0)
    points: tuple[tuple[float, ...], ...] = ()

    def mesh(self) -> trimesh.Trimesh:
        """The part, at its place; a cylinder has 256 sides."""
        if self.kind == "box":
            made = trimesh.creation.box(self.sizes)
        elif self.kind == "cylinder":
            made = trimesh.creation.cylinder(*self.sizes, sections=256)
        else:
            made = trimesh.convex.convex_hull(self.points)
        return made.apply_translation(self.xyz)


@dataclass(frozen=True)
class Drop:
    """A body that is let go.

    Attributes:
        kind: One of `KINDS`.
        parts: What it consists of.
        mass: kg.
        center: Its centre of mass (m).
        inertia: About that centre (3×3, kg m²).
        turn: Its orientation at the start.
        z: The height of its frame (m).
    """

    kind: str
    parts: tuple[Part, ...]
    mass: float
    center: np.ndarray
    inertia: np.ndarray
    turn: Rotation
    z: float

    def is_same(self, one: Sequence[float], other: Sequence[float]) -> bool:
        """Whether two directions that are up in the body's frame mean one side; a cylinder's are round."""
        if self.kind == "cylinder":
            return bool(abs(one[2] - other[2]) < _SAME)
        return bool(np.linalg.norm(np.cross(one, other)) < _SAME and np.dot(one, other) > 0)

    def urdf(self, file: Path) -> str:
        """The body as URDF; a hull is written to a file."""
        shapes = []
        for part in self.parts:
            if part.kind == "hull":
                part.mesh().export(file)
            shape = {
                "box": '<box size="{} {} {}"/>',
                "cylinder": '<cylinder radius="{}" length="{}"/>',
                "hull": f'<mesh filename="file://{file}"/>',
            }[part.kind].format(*part.sizes)
            origin = "{} {} {}".format(*part.xyz)
            shapes.append(f'<collision><origin xyz="{origin}"/><geometry>{shape}</geometry></collision>')
        (xx, xy, xz), (_, yy, yz), (_, _, zz) = self.inertia.tolist()
        return f"""<robot name="thing"><link name="body"><inertial><origin xyz="{" ".join(map(str, self.center))}"/>
<mass value="{self.mass}"/><inertia ixx="{xx}" iyy="{yy}" izz="{zz}" ixy="{xy}" ixz="{xz}" iyz="{yz}"/></inertial>
{"".join(shapes)}</link></robot>"""


def _parts(kind: str, random: np.random.Generator) -> tuple[Part, ...]:
    """Parts that touch and do not overlap."""
    a, b, c = np.exp(random.uniform(np.log(0.05), np.log(0.4), 3)).tolist()
    if kind == "box":
        return (Part("box", (a, b, c)),)
    if kind == "cylinder":
        return (Part("cylinder", (a / 2, b)),)
    if kind == "hull":
        points = random.normal(size=(random.integers(6, 14), 3))
        points *= np.array((a, b, c)) / 2 / np.linalg.norm(points, axis=1)[:, None]
        return (Part("hull", (), points=tuple(map(tuple, np.round(points, 6).tolist()))),)
    if kind == "ell":
        thick = min(a, b) * random.uniform(0.2, 0.5)
        return (
            Part("box", (a, c, thick), (a / 2, 0.0, thick / 2)),
            Part("box", (thick, c, b), (thick / 2, 0.0, thick + b / 2)),
        )
    radius, height, leg = max(a, b) / 2, max(a, c), 0.15 * max(a, b) / 2
    places = [(0.8 * radius * np.cos(angle), 0.8 * radius * np.sin(angle)) for angle in np.arange(3) * 2 * np.pi / 3]
    legs = [Part("box", (leg, leg, height), (float(x), float(y), -height / 2)) for x, y in places]
    return (Part("cylinder", (radius, 0.2 * radius), (0.0, 0.0, 0.1 * radius)), *legs)


@cache
def drops() -> tuple[Drop, ...]:
    """All bodies."""
    random = np.random.default_rng(SEED)
    found = []
    for number in range(COUNT):
        kind = KINDS[number % len(KINDS)]
        parts = _parts(kind, random)
        density = np.exp(random.uniform(np.log(100), np.log(3000)))
        meshes = [part.mesh() for part in parts]
        volume = sum(mesh.volume for mesh in meshes)
        center = sum(mesh.volume * mesh.center_mass for mesh in meshes) / volume
        inertia = np.zeros((3, 3))
        for mesh in meshes:
            away = mesh.center_mass - center
            inertia += mesh.moment_inertia + mesh.volume * (away @ away * np.eye(3) - np.outer(away, away))
        how = number // len(KINDS) % 3
        if how == 0:  # onto a corner
            turn = Rotation.from_quat(random.normal(size=4))
        elif how == 1:  # onto an edge
            axis = np.eye(3)[random.integers(3)]
            turn = Rotation.from_rotvec(axis * random.uniform(-np.pi, np.pi))
        else:  # upright or on its head, leaning by up to 12°: a stool onto one of three legs
            direction = random.uniform(-np.pi, np.pi)
            lean = np.radians(random.uniform(2, 12)) * np.array((np.cos(direction), np.sin(direction), 0))
            turn = Rotation.from_rotvec(lean) * Rotation.from_rotvec((np.pi * random.integers(2), 0, 0))
        lowest = min(float(turn.apply(mesh.vertices)[:, 2].min()) for mesh in meshes)
        z = float(random.uniform(0.005, 0.1)) - lowest
        found.append(Drop(kind, parts, float(density * volume), center, density * inertia, turn, z))
    return tuple(found)


def upwards(turn: Rotation) -> list[float]:
    """The world's vertical in the frame of a body with an orientation."""
    return [float(value) for value in turn.inv().apply((0.0, 0.0, 1.0))]
