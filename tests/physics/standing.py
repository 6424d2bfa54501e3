"""Bodies that stand on a face: prisms, truncated pyramids and cylinders, the same each time."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import trimesh

_LEAST_MARGIN = 5e-3  # m
GROUNDS = ("plane", "box", "mesh", "slab")


@dataclass(frozen=True)
class Standing:
    """A body that stands on a face.

    Attributes:
        name: What it is.
        shape: Its shape as URDF, in which FILE is its mesh.
        mesh: The same, its centre of mass at the origin.
        mass: kg.
        turn: The rotation (3×3) with which the face is below.
        height: Of the centre of mass above that face (m).
        margin: Of the centre of mass to the nearest edge of the face (m).
        edge: The direction about which it would fall over that edge, in the world.
        ground: One of `GROUNDS`.
    """

    name: str
    shape: str
    mesh: trimesh.Trimesh
    mass: float
    turn: np.ndarray
    height: float
    margin: float
    edge: np.ndarray
    ground: str

    @property
    def reach(self) -> float:
        """How far its corners are from its centre of mass at most (m)."""
        return float(np.linalg.norm(self.mesh.vertices, axis=1).max())

    def urdf(self, folder: Path) -> str:
        """The body as URDF; its mesh is written to the folder."""
        self.mesh.export(folder / "standing.stl")
        (xx, xy, xz), (_, yy, yz), (_, _, zz) = (self.mesh.moment_inertia / self.mesh.volume * self.mass).tolist()
        return f"""<robot name="thing"><link name="body"><inertial><mass value="{self.mass}"/>
<inertia ixx="{xx}" iyy="{yy}" izz="{zz}" ixy="{xy}" ixz="{xz}" iyz="{yz}"/></inertial><collision><geometry>
{self.shape.replace("FILE", str(folder / "standing.stl"))}</geometry></collision></link></robot>"""


def _polygon(sides: int, x: float, y: float, z: float) -> np.ndarray:
    angles = 2 * np.pi * (np.arange(sides) + 0.5) / sides
    return np.column_stack([x / 2 * np.cos(angles), y / 2 * np.sin(angles), np.full(sides, z)])


def _faces(mesh: trimesh.Trimesh) -> list[tuple[np.ndarray, float, float, np.ndarray]]:
    """Normal, height, margin and edge of each face on which a convex mesh about its centre of mass stands."""
    found: list[tuple[np.ndarray, float, float, np.ndarray]] = []
    for normal in mesh.face_normals:
        if any(normal @ known[0] > 1 - 1e-9 for known in found):
            continue
        heights = mesh.vertices @ normal
        face = mesh.vertices[heights > heights.max() - 1e-9 * mesh.scale]
        one = face[0] - face[1]
        one /= np.linalg.norm(one)
        other = np.cross(normal, one)
        flat = trimesh.convex.convex_hull(np.vstack([face, face + normal * mesh.scale]))
        margin, edge = np.inf, one
        for side, point in zip(flat.face_normals, flat.triangles[:, 0], strict=True):
            if abs(side @ normal) < 1e-6 and side @ point < margin:
                margin, edge = float(side @ point), np.cross(normal, side)
        assert abs(other @ normal) < 1e-9
        if margin > 0:
            found.append((normal, float(heights.max()), margin, edge))
    return found


def standing(count: int, seed: int = 41) -> list[Standing]:
    """Bodies of 2 cm to 2 m, aspects of 1 to 50 and 5 g to 500 kg, each on one of the faces that it stands on."""
    random = np.random.default_rng(seed)
    kinds = ("prism", "pyramid", "cylinder", "cylinder.stl")
    found: list[Standing] = []
    while len(found) < count:
        kind = kinds[len(found) % len(kinds)]
        x, y, z = np.exp(random.uniform(np.log(0.02), np.log(2.0), 3)).tolist()
        sides, taper = int(random.integers(3, 13)), float(random.uniform(0.2, 0.9)) if kind == "pyramid" else 1.0
        density, pick = float(np.exp(random.uniform(np.log(50), np.log(8000)))), float(random.uniform())
        ground = str(random.choice(GROUNDS))
        if kind.startswith("cylinder"):
            y = x
            mesh = trimesh.creation.cylinder(x / 2, z, sections=64)
        else:
            mesh = trimesh.convex.convex_hull(
                np.vstack([_polygon(sides, x, y, 0), _polygon(sides, taper * x, taper * y, z)])
            )
        mass = density * float(mesh.volume)
        if max(x, y, z) / min(x, y, z) > 50 or not 0.005 <= mass <= 500:
            continue
        mesh.apply_translation(-mesh.center_mass)
        faces = _faces(mesh)
        if kind.startswith("cylinder"):
            faces = [face for face in faces if abs(face[0][2]) > 0.99]
        # As slim as the bodies are, and no narrower than half of the smallest.
        faces = [face for face in faces if face[2] >= max(_LEAST_MARGIN, face[1] / 50)]
        if not faces:
            continue
        normal, height, margin, edge = faces[int(pick * len(faces))]
        turn = trimesh.geometry.align_vectors(normal, (0, 0, -1))[:3, :3]
        shape = '<mesh filename="file://FILE"/>'
        if kind == "cylinder":
            shape = f'<cylinder radius="{x / 2}" length="{z}"/>'
        what = f"{kind} of {sides}" if "cylinder" not in kind else kind
        name = f"{what}, {x:.3g} by {y:.3g} by {z:.3g} m, {mass:.3g} kg, on {ground}"
        found.append(Standing(name, shape, mesh, mass, turn, height, margin, turn @ edge, ground))
    return found
