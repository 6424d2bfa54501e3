"""The points beside the faces of loose shapes: where they are, and what they meet."""

import subprocess
import sys
from itertools import product

import numpy as np
import pytest
import trimesh
from pydrake.geometry import Ellipsoid, Role, Sphere

from drake_twin import TwinBuilder
from drake_twin.scenario import World

BODY = """<robot name="thing"><link name="body"><inertial><mass value="1"/>
<inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial>
<collision><geometry>{shape}</geometry></collision></link></robot>"""
WEDGE = trimesh.convex.convex_hull([(0, 0, 0), (0.2, 0, 0), (0, 0.1, 0), (0.2, 0.1, 0), (0, 0, 0.05), (0, 0.1, 0.05)])


def things(folder, *shapes, world=None, time_step=0.001):
    builder = TwinBuilder(world=World(file=world), time_step=time_step)
    for number, shape in enumerate(shapes):
        (folder / f"{number}.urdf").write_text(BODY.format(shape=shape))
        builder.robot(f"thing{number}", folder / f"{number}.urdf", xyz=(number, 0, 1.0))
    return builder.build()


def inspector_of(twin):
    return next(item for item in twin.diagram.GetSystems() if item.get_name() == "scene_graph").model_inspector()


def points(twin, kind):
    """The parts of a kind: name, shape, place on the body (m)."""
    inspector = inspector_of(twin)
    for geometry in inspector.GetAllGeometryIds(Role.kProximity):
        if f"|{kind}" in inspector.GetName(geometry):
            yield inspector.GetName(geometry), inspector.GetShape(geometry), inspector.GetPoseInFrame(geometry)


@pytest.mark.parametrize(("kind", "time_step"), [("foot", 0.001), ("corner", 0.01)])
def test_a_loose_box_has_balls_in_its_corners_that_touch_its_sides(tmp_path, kind, time_step):
    twin = things(tmp_path, '<box size="0.1 0.2 0.4"/>', time_step=time_step)
    found = [(shape.radius(), X.translation()) for _, shape, X in points(twin, kind)]
    assert [radius for radius, _ in found] == pytest.approx([0.005 * 0.1] * len(found))
    inside = (0.05, 0.1, 0.2) - np.array(5e-4)
    expected = {tuple(np.array(signs) * inside) for signs in product((-1, 1), repeat=3)}
    if kind == "foot":  # there are some in the middles of its sides, too
        expected |= {tuple(side * inside * axis) for side in (-1, 1) for axis in np.eye(3)}
    places = {tuple(np.round(place, 12).tolist()) for _, place in found}
    assert places == {tuple(np.round(place, 12).tolist()) for place in expected}


@pytest.mark.one_plant
@pytest.mark.parametrize(("size", "balls"), [("0.4 0.4 0.4", 1), ("0.35 0.3 0.2", 1), ("0.02 0.02 0.4", 2)])
def test_a_compact_box_stands_on_one_ball_a_corner_and_a_slim_one_on_two(tmp_path, size, balls):
    """Its facets and balls together are no more than the 64 facets of a box that had no balls."""
    urdf = BODY.format(shape=f'<box size="{size}"/>')
    (tmp_path / "box.urdf").write_text(urdf)
    builder = TwinBuilder(time_step=0.01)
    twin = builder.robot("box", tmp_path / "box.urdf", xyz=(0, 0, float(size.split()[2]) / 2)).build()
    twin.advance_to(0.3)
    contacts = twin.plant.get_contact_results_output_port().Eval(twin.plant.GetMyContextFromRoot(twin.context))
    facets = sum(
        contacts.hydroelastic_contact_info(index).contact_surface().num_faces()
        for index in range(contacts.num_hydroelastic_contacts())
    )
    assert contacts.num_point_pair_contacts() == 4 * balls
    assert facets + 4 * balls <= 64


def test_the_balls_of_a_hull_are_inside_and_near_its_corners(tmp_path):
    WEDGE.export(tmp_path / "wedge.stl")
    twin = things(tmp_path, f'<mesh filename="file://{tmp_path}/wedge.stl"/>', time_step=0.01)
    found = list(points(twin, "corner"))
    radius = found[0][1].radius()
    places = np.array([X.translation() for _, _, X in found])
    inside = -(places @ WEDGE.face_normals.T - (WEDGE.face_normals * WEDGE.triangles[:, 0]).sum(axis=1)).max(axis=1)
    np.testing.assert_allclose(inside, radius, rtol=1e-3)
    nearest = np.linalg.norm(places[:, None] - WEDGE.vertices[None], axis=2)
    assert nearest.min(axis=0).max() < 11 * radius
    assert nearest.min(axis=1).max() < 11 * radius


def test_a_loose_cylinder_has_two_rims(tmp_path):
    twin = things(tmp_path, '<cylinder radius="0.1" length="0.3"/>')
    (one, other) = points(twin, "rim")
    assert type(one[1]) is type(other[1]) is Ellipsoid
    assert one[1].a() == one[1].b() == 0.1
    assert one[2].translation()[2] == -other[2].translation()[2] < 0
    assert not [*points(twin, "corner")]


def test_a_wedge_has_feet_in_its_corners_and_in_the_middle_of_each_side_that_it_stands_on(tmp_path):
    wedge = WEDGE.copy()
    wedge.apply_translation(-wedge.center_mass)
    wedge.export(tmp_path / "wedge.stl")
    twin = things(tmp_path, f'<mesh filename="file://{tmp_path}/wedge.stl"/>')
    places = np.array([X.translation() for _, _, X in points(twin, "foot")])
    nearest = np.linalg.norm(places[:, None] - wedge.vertices[None], axis=2).min(axis=1)
    assert (nearest < 0.02).sum() == len(wedge.vertices)
    middles = places[nearest >= 0.02]
    assert len(middles) == 5
    for place in middles:
        away = -(wedge.face_normals @ place - (wedge.face_normals * wedge.triangles[:, 0]).sum(axis=1))
        assert away.min() == pytest.approx(0.005 * 0.05, rel=1e-4)


@pytest.mark.one_plant
def test_on_a_plane_a_box_stands_on_five_points_and_on_a_block_on_its_faces(tmp_path):
    """The block is below the plane, so that only one of them is touched."""
    text = (
        '<model name="block"><static>1</static><pose>5 0 0 0 0 0</pose><link name="l"><collision name="c"><geometry>'
        "<box><size>1 1 1</size></box></geometry></collision></link></model>"
    )
    (tmp_path / "w.sdf").write_text(f'<sdf version="1.9"><world name="w">{text}</world></sdf>')
    (tmp_path / "box.urdf").write_text(BODY.format(shape='<box size="0.4 0.4 0.4"/>'))
    builder = TwinBuilder(world=World(file=str(tmp_path / "w.sdf"), ground=True))
    builder.robot("low", tmp_path / "box.urdf", xyz=(0, 0, 0.2)).robot("high", tmp_path / "box.urdf", xyz=(5, 0, 0.7))
    twin = builder.build()
    twin.advance_to(0.3)
    contacts = twin.plant.get_contact_results_output_port().Eval(twin.plant.GetMyContextFromRoot(twin.context))
    inspector = inspector_of(twin)
    pairs = [
        contacts.point_pair_contact_info(index).point_pair() for index in range(contacts.num_point_pair_contacts())
    ]
    names = [inspector.GetName(one) + inspector.GetName(other) for one, other in ((p.id_A, p.id_B) for p in pairs)]
    assert sum("low" in name and "|foot" in name for name in names) == 5
    assert sum("high" in name and "|corner" in name for name in names) == 4
    assert contacts.num_hydroelastic_contacts() == 1


@pytest.mark.parametrize("time_step", [0.002, 0.0021])
def test_feet_are_for_short_steps(tmp_path, time_step):
    twin = things(tmp_path, '<box size="0.1 0.1 0.1"/>', time_step=time_step)
    assert len([*points(twin, "foot")]) == (14 if time_step == 0.002 else 0)
    assert len([*points(twin, "corner")]) == (0 if time_step == 0.002 else 8)


def test_corners_meet_what_does_not_move_and_is_thick_and_nothing_else(tmp_path):
    text = (
        '<model name="{0}"><static>1</static><pose>0 9 0 0 0 0</pose><link name="l"><collision name="c"><geometry>'
        "<box><size>{1} 1 1</size></box></geometry></collision></link></model>"
    )
    walls = text.format("wall", 0.02) + text.format("block", 0.06)
    (tmp_path / "w.sdf").write_text(f'<sdf version="1.9"><world name="w">{walls}</world></sdf>')
    shapes = ('<box size="0.1 0.1 0.1"/>', '<box size="0.1 0.1 0.1"/>', '<sphere radius="0.1"/>')
    twin = things(tmp_path, *shapes, world=str(tmp_path / "w.sdf"))
    inspector = inspector_of(twin)
    names = [tuple(map(inspector.GetName, pair)) for pair in inspector.GetCollisionCandidates()]
    met = {other for pair in names for name, other in (pair, pair[::-1]) if "|corner" in name}
    assert len(met) == 1
    assert "block" in met.pop()
    assert not [item for item in twin.built.shapes if isinstance(item.shape, Sphere) and item.model != "thing2"]


def test_the_corners_of_boxes_need_no_scipy(tmp_path):
    (tmp_path / "box.urdf").write_text(BODY.format(shape='<box size="0.1 0.1 0.1"/>'))
    program = (
        "import sys; from drake_twin import TwinBuilder; TwinBuilder().robot('r', sys.argv[1]).build()\n"
        "assert 'scipy' not in sys.modules"
    )
    subprocess.run([sys.executable, "-c", program, str(tmp_path / "box.urdf")], check=True)


def test_hundreds_of_loose_boxes_have_no_corners_and_that_is_said(tmp_path):
    twin = things(tmp_path, *['<box size="0.1 0.1 0.1"/>'] * 41)
    assert not [*points(twin, "corner")]
    (said,) = [text for text in twin.findings.warnings if "loose" in text]
    assert said == (
        "the world has 41 loose boxes and meshes: above 40 they touch with their faces only, so that slim ones fall"
        " over too early"
    )
