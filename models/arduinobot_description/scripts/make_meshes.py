#!/usr/bin/env python3
"""Makes the arm's meshes: STL files in millimetres, which the URDF scales to metres.

Run it from anywhere after changing a shape: python3 make_meshes.py (needs trimesh).
"""

from pathlib import Path

import numpy as np
import trimesh
from trimesh.creation import box, cylinder
from trimesh.transformations import rotation_matrix, translation_matrix

MESHES = Path(__file__).resolve().parent.parent / "meshes"


def placed(mesh: trimesh.Trimesh, xyz: tuple[float, float, float], axis: str = "z") -> trimesh.Trimesh:
    """A primitive moved to xyz (mm) with its own z axis along a coordinate axis."""
    turns = {"x": (np.pi / 2, (0, 1, 0)), "y": (np.pi / 2, (1, 0, 0)), "z": (0.0, (0, 0, 1))}
    mesh.apply_transform(translation_matrix(xyz) @ rotation_matrix(*turns[axis]))
    return mesh


def rod(radius: float, height: float, xyz: tuple[float, float, float], axis: str = "z") -> trimesh.Trimesh:
    return placed(cylinder(radius=radius, height=height, sections=48), xyz, axis)


def beam(size: tuple[float, float, float], xyz: tuple[float, float, float]) -> trimesh.Trimesh:
    return placed(box(extents=size), xyz)


PARTS = {
    "pedestal": [rod(100, 20, (0, 0, 10)), rod(70, 40, (0, 0, 40))],
    "turret": [rod(62, 20, (0, 0, 10)), beam((60, 24, 90), (0, -42, 65)), beam((60, 24, 90), (0, 42, 65))],
    "upper_arm": [rod(32, 58, (0, 0, 0), "y"), beam((40, 36, 260), (0, 0, 150)), rod(30, 58, (0, 0, 300), "y")],
    "forearm": [rod(24, 44, (0, 0, 0), "y"), beam((220, 32, 32), (120, 0, 0)), rod(26, 16, (238, 0, 0), "x")],
    "claw": [beam((24, 110, 36), (12, 0, 0))],
    "finger": [beam((90, 10, 26), (45, 0, 0)), beam((24, 16, 26), (86, -6, 0))],
}

if __name__ == "__main__":
    for name, parts in PARTS.items():
        trimesh.util.concatenate(parts).export(MESHES / f"{name}.stl")
        print(f"{name}.stl")
