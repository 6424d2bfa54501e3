"""What is said of meshes that are not used as they are written."""

from collections.abc import Iterable, Iterator
from pathlib import Path

from drake_twin.description.meshes import MOST_DRAWN, mesh_faults, mesh_for_mjcf, visual_mesh
from drake_twin.findings import first_of

_MOST_NAMED = 3


def said_of_visual(file: Path) -> Iterator[str]:
    """Yield what is drawn otherwise than a visual mesh says.

    Raises:
        InputError: As `visual_mesh`.
    """
    drawn = visual_mesh(file)
    if drawn == file:  # Drake reads it itself
        return
    faults = mesh_faults(file)
    if faults.unplaced:
        yield f"visual mesh {file.name}: {faults.unplaced_text} are not drawn"
    if faults.is_inside_out:
        both = "the twin draws both sides of them, Gazebo the outer one"
        yield f"visual mesh {file.name} has triangles that face inwards: {both}"
    if faults.triangles > MOST_DRAWN and drawn.suffix == ".obj":
        yield f"visual mesh {file.name}: {faults.triangles:,} triangles are drawn as at most {MOST_DRAWN:,}"


def said_of_hull(file: Path) -> Iterator[str]:
    """Yield what makes the convex hull of a collision mesh another thing than its file means.

    Raises:
        InputError: If the file cannot be read.
    """
    yield from _said_of_solid(file, "collision mesh", "its convex hull collides")


def said_of_mjcf_mesh(file: Path) -> Iterator[str]:
    """Yield what makes a mesh of MJCF, drawn or as a convex hull, another thing than its file means.

    Raises:
        InputError: As `mesh_for_mjcf`.
    """
    if mesh_for_mjcf(file) != file:  # Drake does not read it itself
        yield from _said_of_solid(file, "mesh", "where it collides, its convex hull does")


def _said_of_solid(file: Path, what: str, instead: str) -> Iterator[str]:
    faults = mesh_faults(file)
    if found := ", ".join(faults.of_solid()):
        thick = ", a thousandth of its size thick" if faults.is_thin else ""
        yield f"{what} {file.name} has {found}: {instead}{thick}"


def said_of_hulls(files: Iterable[Path]) -> Iterator[str]:
    """Yield one sentence on all collision meshes with many faults that do not change their convex hulls.

    Raises:
        InputError: If a file cannot be read.
    """
    found = {file.name: mesh_faults(file) for file in files}
    faulty = [f"{name} ({', '.join(each.of_surface())})" for name, each in found.items() if each.is_poor_surface]
    if faulty:
        named = first_of(faulty, _MOST_NAMED, "; ")
        yield f"convex hulls collide in place of faulty meshes, as of sound ones: {named}"


def said_of_solids(file: Path) -> Iterator[str]:
    """Yield what may make a static mesh of solids another thing than its file means.

    Raises:
        InputError: If the file cannot be read.
    """
    faults = mesh_faults(file)
    if found := ", ".join((*faults.of_solid(), *faults.of_surface())):
        yield f"collision mesh {file.name} has {found}: convex parts of it collide as solids, other faces as slabs"
