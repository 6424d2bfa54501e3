"""Bad shapes end in a finding or in one paragraph: no traceback, and nothing is changed in silence."""

from pathlib import Path

import numpy as np
import pytest
from bad_shapes import (
    FORMATS,
    MESHES,
    SDF_PRIMITIVES,
    URDF_PRIMITIVES,
    USES,
    mesh_geometry,
    urdf,
    write_mesh,
    write_use,
)

from drake_twin import TwinBuilder, World
from drake_twin.errors import InputError, RunError
from drake_twin.run import main

# What is said of each mesh: where it collides and moves, where it is drawn, where it collides and does not move.
NOTHING = ""
SAID = {
    "sound": (NOTHING, NOTHING, NOTHING),
    "wedge": (NOTHING, NOTHING, NOTHING),
    "inside out": ("face inwards", "face inwards", "face inwards"),
    "half inside out": ("8 edges between triangles that face opposite ways", NOTHING, "8 edges"),
    "two-sided": ("each triangle twice, facing opposite ways", NOTHING, "each triangle twice, facing opposite ways"),
    "doubled": ("12 triangles twice", NOTHING, "12 triangles twice"),
    "open": (NOTHING, NOTHING, NOTHING),
    "not manifold": ("1 edge of more than two triangles", NOTHING, "1 edge of more than two triangles"),
    "degenerate": ("3 triangles without area", NOTHING, "3 triangles without area"),
    "slivers": ("1 triangle without area", NOTHING, "1 triangle without area"),
    "flat": ("all corners in one plane", NOTHING, "all corners in one plane"),
    "flat, two-sided": ("all corners in one plane, each triangle twice", NOTHING, "in one plane, each triangle twice"),
    "one triangle": ("all corners in one plane", NOTHING, "all corners in one plane"),
    "line": ("all corners on one line", NOTHING, "left out"),
    "point": ("all corners of the mesh are in one point", NOTHING, "left out"),
    "empty": ("left out", "left out", "left out"),
    "not a number": ("not finite", "not finite", "not finite"),
    "infinite": ("not finite", "not finite", "not finite"),
    "one corner far away": ("1e+08 m large", NOTHING, "left out"),
    "far beyond": ("not finite points in space", "not finite points in space", "not finite points in space"),
    "thin": ("less thickness than 0.001 of its size", NOTHING, "less thickness than 0.001 of its size"),
    "1e-9 m": ("in one point", NOTHING, "left out"),  # corners within 1e-8 m are one
    "1e-6 m": ("m thin", NOTHING, NOTHING),
    "1e-4 m": (NOTHING, NOTHING, NOTHING),
    "1e3 m": ("2e+03 m large", NOTHING, NOTHING),
    "1e6 m": ("2e+06 m large", NOTHING, NOTHING),
}


def said_of(use: str, geometry: str, folder: Path, height: float = 0.3) -> str:
    """Build a twin of a use, run it for two steps, and return its findings or the paragraph that ends it."""
    file = write_use(use, geometry, folder, height)
    robot, world = file, World()
    if not use.startswith("urdf"):
        robot, world = folder / "robot.urdf", World(file=str(file))
        robot.write_text(urdf())
    lines = []
    try:
        twin = TwinBuilder(time_step=0.01, world=world).robot("robot", robot, xyz=(0, 3e6, height)).build()
        lines += map(str, twin.findings)
        twin.advance_to(0.02)
        assert np.isfinite(twin.entities.state("robot").position).all()
    except (InputError, RunError) as error:
        lines.append(str(error))
    return "\n".join(lines)


def check_mesh(name: str, suffix: str, use: str, folder: Path) -> None:
    file = write_mesh(MESHES[name], folder / f"mesh.{suffix}")
    moving, drawn, static = SAID[name]
    expected = static if use.startswith("static") else moving if use.endswith("collision") else drawn
    said = said_of(use, mesh_geometry(use, file), folder)
    assert expected in said
    assert expected or said == ""


@pytest.mark.parametrize("name", MESHES)
def test_a_bad_mesh_of_a_robot_is_a_finding(tmp_path, name):
    check_mesh(name, "binary.stl", "urdf collision", tmp_path)


@pytest.mark.parametrize("name", ["inside out", "two-sided", "flat", "point", "empty", "infinite", "far beyond"])
@pytest.mark.parametrize("use", USES[1:])
def test_a_bad_mesh_is_a_finding_wherever_it_is_used(tmp_path, use, name):
    check_mesh(name, "obj", use, tmp_path)


@pytest.mark.slow
@pytest.mark.parametrize("use", USES)
@pytest.mark.parametrize("suffix", FORMATS)
@pytest.mark.parametrize("name", MESHES)
def test_a_bad_mesh_of_any_format_is_a_finding_wherever_it_is_used(tmp_path, name, suffix, use):
    if suffix == "dae" and name in ("not a number", "infinite"):
        file = write_mesh(MESHES[name], tmp_path / "mesh.dae")
        assert "left out" in said_of(use, mesh_geometry(use, file), tmp_path)
    else:
        check_mesh(name, suffix, use, tmp_path)


IMPOSSIBLE = ("1e13", "0", "-0.1", "nan", "inf", "")
EXTREME = ("1e-9", "1e-6", "1e6")
PRIMITIVES = [
    (use, kind)
    for use in USES
    for kind in (URDF_PRIMITIVES if use.startswith("urdf") else SDF_PRIMITIVES)
    if kind != "plane"
]


def check_primitive(kind: str, size: str, use: str, folder: Path) -> None:
    forms = URDF_PRIMITIVES if use.startswith("urdf") else SDF_PRIMITIVES
    said = said_of(use, forms[kind].format(size), folder, 2e6 if size == "1e6" else 0.3)
    is_wrong = size in IMPOSSIBLE or (size in EXTREME and not use.endswith("visual"))
    assert is_wrong == bool(said), said


@pytest.mark.parametrize("size", ["0", "nan", "", "1e13", "1e-6", "1e6", "1e-4"])
@pytest.mark.parametrize("use", ["urdf collision", "sdf collision"])
def test_a_bad_size_is_a_finding_or_a_paragraph(tmp_path, use, size):
    check_primitive("box", size, use, tmp_path)


@pytest.mark.slow
@pytest.mark.parametrize("size", [*IMPOSSIBLE, *EXTREME, "1e-4"])
@pytest.mark.parametrize(("use", "kind"), PRIMITIVES)
def test_a_bad_size_of_any_shape_is_a_finding_or_a_paragraph(tmp_path, use, kind, size):
    check_primitive(kind, size, use, tmp_path)


@pytest.mark.parametrize(
    ("plane", "what"),
    [
        ("<normal>0 0 1</normal><size>4 3</size>", ""),
        ("<size>4 3</size>", ""),
        ("<normal>0 0 1</normal>", ""),
        ("<size></size>", ""),
        ("<size>0 4</size>", "a visual <plane> has the size '0 4': it is drawn 100 by 4 m large"),
        ("<size>nan nan</size>", "a visual <plane> has the size 'nan nan': it is drawn 100 by 100 m large"),
        ("<size>2</size>", "a visual <plane> has the size '2': it is drawn 2 by 2 m large"),
        ("<normal>0 0 0</normal><size>1 1</size>", "a visual <plane> has the normal '0 0 0': it faces along z"),
    ],
)
def test_a_plane_that_is_drawn_otherwise_is_a_finding(tmp_path, plane, what):
    said = said_of("sdf visual", f"<plane>{plane}</plane>", tmp_path)
    assert (f"thing: {what} (thing.sdf:1)" if what else "") in said


def test_a_bad_mesh_never_ends_a_run_in_a_traceback(tmp_path, capsys):
    file = tmp_path / "scan.stl"
    with file.open("wb") as content:
        content.write(b"scan".ljust(80) + (10_000_000).to_bytes(4, "little"))
        content.truncate(84 + 50 * 10_000_000)
    robot = write_use("urdf collision", mesh_geometry("urdf collision", file), tmp_path)
    assert main([str(robot), "--headless", "--duration", "0.1", "--findings"]) == 0
    said = capsys.readouterr().err
    assert "the mesh has 10,000,000 triangles, and 2,000,000 are the most: decimate it" in said
    assert "thing.urdf:4" in said
    assert "Traceback" not in said
