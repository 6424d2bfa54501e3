"""Shapes that are wrong in one way each: meshes in four formats, and primitives, in URDF and SDF."""

import struct
from pathlib import Path

import numpy as np

Triangles = np.ndarray  # k × 3 × 3 (m)

# The corners of a cube of 0.2 m about its middle, and its triangles, counterclockwise seen from outside.
_CORNERS = 0.1 * np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], dtype=float)
_SIDES = ((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3))
_FACES = np.array([triangle for a, b, c, d in _SIDES for triangle in ((a, b, c), (a, c, d))])
CUBE: Triangles = _CORNERS[_FACES]
_LID = slice(10, 12)  # its upper side

# A wedge of which no face is along the axes: unlike a cube, it is not taken for a primitive.
WEDGE: Triangles = np.array([[-1, -1, -1], [1, -1, -1], [-1, 1, -1], [-0.7, -0.8, 1]])[
    np.array([(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)])
] * np.array([0.1, 0.1, 0.1])


def _reversed(triangles: Triangles) -> Triangles:
    return triangles[:, ::-1]


def _changed(triangles: Triangles, value: float) -> Triangles:
    """Replace one coordinate of one corner."""
    changed = triangles.copy()
    changed[3, 1, 0] = value
    return changed


def _with(*parts: Triangles) -> Triangles:
    return np.concatenate(parts)


_FIN: Triangles = np.array([[_CORNERS[1], _CORNERS[5], [0.0, 0.0, 0.3]]])  # on an edge that has two faces already

MESHES: dict[str, Triangles] = {
    "sound": CUBE,
    "wedge": WEDGE,
    "inside out": _reversed(CUBE),
    "half inside out": _with(CUBE[:6], _reversed(CUBE[6:])),
    "two-sided": _with(CUBE, _reversed(CUBE)),
    "doubled": _with(CUBE, CUBE),
    "open": np.delete(CUBE, _LID, axis=0),
    "not manifold": _with(CUBE, _FIN),
    "degenerate": _with(CUBE, np.repeat(CUBE[:3, :1], 3, axis=1)),
    "slivers": _with(CUBE, np.array([[_CORNERS[0], _CORNERS[1], (_CORNERS[0] + _CORNERS[1]) / 2]])),
    "flat": CUBE[_LID],
    "flat, two-sided": _with(CUBE[_LID], _reversed(CUBE[_LID])),
    "one triangle": CUBE[:1],
    "line": np.array([[[0, 0, 0], [1, 0, 0], [2, 0, 0]]]) * 0.1,
    "point": np.zeros((2, 3, 3)),
    "empty": np.zeros((0, 3, 3)),
    "not a number": _changed(CUBE, np.nan),
    "infinite": _changed(CUBE, np.inf),
    "one corner far away": _changed(CUBE, 1e8),
    "far beyond": CUBE * 1e14,
    "thin": CUBE * (1, 1, 1e-5),
    "1e-9 m": CUBE * 1e-8,
    "1e-6 m": CUBE * 1e-5,
    "1e-4 m": CUBE * 1e-3,
    "1e3 m": CUBE * 1e4,
    "1e6 m": CUBE * 1e7,
}

FORMATS = ("binary.stl", "ascii.stl", "obj", "dae")


def write_mesh(triangles: Triangles, file: Path) -> Path:
    """Write triangles in the format that a file's name ends with, one of `FORMATS`."""
    if file.name.endswith("binary.stl"):
        file.write_bytes(binary_stl(triangles))
    elif file.name.endswith("ascii.stl"):
        file.write_text(_ascii_stl(triangles))
    elif file.suffix == ".obj":
        lines = [f"v {x!r} {y!r} {z!r}" for x, y, z in triangles.reshape(-1, 3).tolist()]
        lines += [f"f {3 * index + 1} {3 * index + 2} {3 * index + 3}" for index in range(len(triangles))]
        file.write_text("\n".join(lines) + "\n")
    else:
        file.write_text(_dae(triangles))
    return file


def binary_stl(triangles: Triangles) -> bytes:
    """Return triangles as a binary STL file, with normals of zero, as many exporters write."""
    records = np.zeros(len(triangles), dtype=[("numbers", "<f4", (12,)), ("attribute", "<u2")])
    with np.errstate(over="ignore"):
        records["numbers"][:, 3:] = triangles.reshape(-1, 9)
    return b"bad shape".ljust(80) + struct.pack("<I", len(triangles)) + records.tobytes()


def _ascii_stl(triangles: Triangles) -> str:
    lines = ["solid bad"]
    for corners in triangles.tolist():
        lines += ["facet normal 0 0 0", "outer loop"]
        lines += [f"vertex {x!r} {y!r} {z!r}" for x, y, z in corners]
        lines += ["endloop", "endfacet"]
    return "\n".join([*lines, "endsolid bad"]) + "\n"


def _dae(triangles: Triangles) -> str:
    numbers = " ".join(map(repr, triangles.reshape(-1).tolist()))
    indices = " ".join(map(str, range(3 * len(triangles))))
    return f"""<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit name="meter" meter="1"/><up_axis>Z_UP</up_axis></asset>
<library_geometries><geometry id="g"><mesh>
<source id="p"><float_array id="pa" count="{9 * len(triangles)}">{numbers}</float_array><technique_common>
<accessor source="#pa" count="{3 * len(triangles)}" stride="3"><param name="X" type="float"/>
<param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="{len(triangles)}"><input semantic="VERTEX" source="#v" offset="0"/><p>{indices}</p></triangles>
</mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s"><node id="n"><instance_geometry url="#g"/></node></visual_scene>
</library_visual_scenes><scene><instance_visual_scene url="#s"/></scene></COLLADA>
"""


def binary_grid(count: int, height: float = 0.1) -> Triangles:
    """Return a bumpy open surface of 1 m² of some ``count`` triangles."""
    cells = int(np.sqrt(count / 2))
    edges = np.linspace(-0.5, 0.5, cells + 1)
    x, y = np.meshgrid(edges, edges, indexing="ij")
    points = np.stack([x, y, height * np.cos(9 * x) * np.cos(9 * y)], axis=-1)
    a, b, c, d = points[:-1, :-1], points[1:, :-1], points[1:, 1:], points[:-1, 1:]
    return np.stack([np.stack([a, b, c], axis=-2), np.stack([a, c, d], axis=-2)]).reshape(-1, 3, 3)


URDF_PRIMITIVES = {
    "box": '<box size="{0} {0} {0}"/>',
    "plate": '<box size="0.2 0.2 {0}"/>',
    "sphere": '<sphere radius="{0}"/>',
    "cylinder": '<cylinder radius="{0}" length="{0}"/>',
    "disc": '<cylinder radius="0.1" length="{0}"/>',
    "needle": '<cylinder radius="{0}" length="0.1"/>',
    "capsule": '<capsule radius="{0}" length="{0}"/>',
}
SDF_PRIMITIVES = {
    "box": "<box><size>{0} {0} {0}</size></box>",
    "plate": "<box><size>0.2 0.2 {0}</size></box>",
    "sphere": "<sphere><radius>{0}</radius></sphere>",
    "cylinder": "<cylinder><radius>{0}</radius><length>{0}</length></cylinder>",
    "disc": "<cylinder><radius>0.1</radius><length>{0}</length></cylinder>",
    "capsule": "<capsule><radius>{0}</radius><length>{0}</length></capsule>",
    "ellipsoid": "<ellipsoid><radii>{0} 0.1 0.1</radii></ellipsoid>",
    "plane": "<plane><normal>0 0 1</normal><size>{0} {0}</size></plane>",
}

USES = ("urdf collision", "urdf visual", "sdf collision", "sdf visual", "static collision")

_INERTIA = "".join(f'{name}="{value}" ' for name, value in (("ixx", 0.01), ("iyy", 0.01), ("izz", 0.01)))
_SOUND_URDF = '<box size="0.2 0.2 0.2"/>'
_SOUND_SDF = "<box><size>0.2 0.2 0.2</size></box>"


def urdf(collision: str = _SOUND_URDF, visual: str = _SOUND_URDF, mass: float = 1.0) -> str:
    """Return a free robot of one link."""
    return f"""<robot name="thing"><link name="body">
<inertial><mass value="{mass}"/><inertia {_INERTIA}ixy="0" ixz="0" iyz="0"/></inertial>
<visual><geometry>{visual}</geometry></visual>
<collision><geometry>{collision}</geometry></collision></link></robot>"""


def sdf_model(
    collision: str = _SOUND_SDF, visual: str = _SOUND_SDF, *, is_static: bool = False, height: float = 0.3
) -> str:
    """Return a free or static model of one link, at a height (m)."""
    return f"""<model name="thing"><static>{str(is_static).lower()}</static><pose>0 0 {height} 0 0 0</pose>
<link name="body"><inertial><mass>1</mass><inertia><ixx>0.01</ixx><iyy>0.01</iyy><izz>0.01</izz></inertia></inertial>
<visual name="v"><geometry>{visual}</geometry></visual>
<collision name="c"><geometry>{collision}</geometry></collision></link></model>"""


def write_use(use: str, geometry: str, folder: Path, height: float = 0.3) -> Path:
    """Write the file of a robot, or of a world with a model at a height (m), that uses a geometry in one of `USES`."""
    kind = use.split()[1]
    if use.startswith("urdf"):
        file = folder / "thing.urdf"
        file.write_text(urdf(**{kind: geometry}))
        return file
    file = folder / "thing.sdf"
    model = sdf_model(**{kind: geometry}, is_static=use.startswith("static"), height=height)
    ground = "<include><uri>model://ground_plane</uri></include>"
    file.write_text(f'<sdf version="1.9"><world name="w">{ground}{model}</world></sdf>')
    return file


def mesh_geometry(use: str, file: Path) -> str:
    """Return the ``<mesh>`` of a file for one of `USES`."""
    return f'<mesh filename="{file}"/>' if use.startswith("urdf") else f"<mesh><uri>{file}</uri></mesh>"
