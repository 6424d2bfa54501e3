"""``<inertial auto="true">`` beside Drake's own inertias of solids, and how such things roll."""

from math import pi, radians, sin

import numpy as np
import pytest
from pydrake.math import RigidTransform, RollPitchYaw
from pydrake.multibody.tree import SpatialInertia
from sdf_worlds import findings, world_of
from waters import POST

from drake_twin import TwinBuilder
from drake_twin.description.package_index import PackageIndex
from drake_twin.description.robot_model import load_robot_model
from drake_twin.scenario import World

X = RigidTransform(RollPitchYaw(0.3, -0.4, 0.5), [0.2, -0.1, 0.3])
POSE = "<pose>0.2 -0.1 0.3 0.3 -0.4 0.5</pose>"
LEAD = "<density>11340</density>"
SHAPES = {
    "<box><size>0.4 0.3 0.2</size></box>": SpatialInertia.SolidBoxWithDensity(1.0, 0.4, 0.3, 0.2),
    "<sphere><radius>0.3</radius></sphere>": SpatialInertia.SolidSphereWithDensity(1.0, 0.3),
    "<ellipsoid><radii>0.4 0.3 0.2</radii></ellipsoid>": SpatialInertia.SolidEllipsoidWithDensity(1.0, 0.4, 0.3, 0.2),
    "<cylinder><radius>0.3</radius><length>0.5</length></cylinder>": SpatialInertia.SolidCylinderWithDensity(
        1.0, 0.3, 0.5, [0, 0, 1]
    ),
    "<capsule><radius>0.3</radius><length>0.5</length></capsule>": SpatialInertia.SolidCapsuleWithDensity(
        1.0, 0.3, 0.5, [0, 0, 1]
    ),
}


def collision(shape, more="", name="c"):
    return f'<collision name="{name}">{more}<geometry>{shape}</geometry></collision>'


def link(*collisions, inside="", auto="true"):
    return f'<link name="l"><inertial auto="{auto}">{inside}</inertial>{"".join(collisions)}</link>'


def inertia_in(folder, *collisions, **more):
    """The spatial inertia of a link of a world's model about its origin, as the plant has it, in its axes (6×6)."""
    world = f'<world name="w"><model name="m">{link(*collisions, **more)}</model></world>'
    (folder / "w.sdf").write_text(f'<sdf version="1.11">{world}</sdf>')
    (folder / "post.urdf").write_text(POST)
    builder = TwinBuilder(world=World(file=str(folder / "w.sdf"), ground=False))
    twin = builder.robot("post", folder / "post.urdf", xyz=(50, 0, 0)).build()
    assert not [item for item in twin.findings if "inert" in item.what]
    body = twin.plant.GetBodyByName("l", twin.plant.GetModelInstanceByName("m"))
    return body.default_spatial_inertia().CopyToFullMatrix6()


def placed(inertia, density):
    """A solid of a density at the pose X of its link."""
    moved = inertia.ReExpress(X.rotation()).Shift(-X.translation())
    return density * moved.CopyToFullMatrix6()


@pytest.mark.parametrize("shape", [*SHAPES])
def test_a_shape_is_a_solid_of_water_where_it_is(tmp_path, shape):
    found = inertia_in(tmp_path, collision(shape, POSE))
    assert found == pytest.approx(placed(SHAPES[shape], 1000.0), rel=1e-9, abs=1e-9)


def test_a_cones_center_is_a_quarter_above_its_base(tmp_path):
    """m = ρ π r² h / 3; about it 3/80 m (4 r² + h²) across and 3/10 m r² along."""
    found = inertia_in(tmp_path, collision("<cone><radius>0.3</radius><length>0.8</length></cone>"))
    mass, low = 1000 * pi * 0.3**2 * 0.8 / 3, -0.2
    across, along = 3 / 80 * mass * (4 * 0.3**2 + 0.8**2), 0.3 * mass * 0.3**2
    assert np.diag(found) == pytest.approx([*[across + mass * low**2] * 2, along, mass, mass, mass])
    assert found[0, 4] == pytest.approx(-mass * low)


@pytest.mark.parametrize("turned", [False, True])
def test_a_mesh_is_a_solid_as_its_triangles_enclose_it(tmp_path, turned):
    """A box from one corner on, twice as long as its file, also with its triangles seen from inside."""
    corners = [(x, y, z) for x in (0, 0.2) for y in (0, 0.3) for z in (0, 0.2)]
    sides = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    lines = ["v {} {} {}".format(*corner) for corner in corners]
    lines += [f"f {' '.join(str(place + 1) for place in (side[::-1] if turned else side))}" for side in sides]
    (tmp_path / "box.obj").write_text("\n".join([*lines, ""]))
    mesh = f"<mesh><uri>{tmp_path}/box.obj</uri><scale>2 1 1</scale></mesh>"
    solid = SpatialInertia.SolidBoxWithDensity(11340.0, 0.4, 0.3, 0.2).Shift([-0.2, -0.15, -0.1])
    assert inertia_in(tmp_path, collision(mesh, LEAD)) == pytest.approx(solid.CopyToFullMatrix6(), rel=1e-6)


def test_densities_are_those_of_the_shape_then_of_the_link_and_shapes_add_up(tmp_path):
    """What the file says beside replaces nothing."""
    box, ball, *_ = SHAPES
    inside = "<density>500</density><mass>3</mass><pose>1 2 3 0 0 0</pose><inertia><ixx>7</ixx></inertia>"
    found = inertia_in(tmp_path, collision(box, LEAD), collision(ball, POSE, "d"), inside=inside)
    own = 11340 * SHAPES[box].CopyToFullMatrix6()
    assert found == pytest.approx(own + placed(SHAPES[ball], 500.0), rel=1e-9, abs=1e-9)


def test_without_the_flag_the_file_counts(tmp_path):
    found = inertia_in(tmp_path, collision(next(iter(SHAPES))), inside="<mass>3</mass>", auto="false")
    assert np.diag(found) == pytest.approx([1, 1, 1, 3, 3, 3])


@pytest.mark.parametrize(
    ("shape", "why"),
    [
        ("<plane/>", "a <plane> has no volume here"),
        ("<box><size>1 1</size></box>", "<size> of its <box> is '1 1'"),
        ("<sphere><radius>-1</radius></sphere>", "<radius> of its <sphere> is '-1'"),
        ("<mesh><uri>nowhere.obj</uri></mesh>", "nowhere.obj"),
    ],
)
def test_shapes_without_a_volume_are_named(tmp_path, shape, why):
    found = findings(world_of(tmp_path, f'<model name="m">{link(collision(shape))}</model>', version="1.11"))
    (what,) = (item for item in found if "has no part in its inertia" in item)
    assert "collision c of link l has no part in its inertia" in what
    assert why in what


def test_a_robots_links_have_it_too(tmp_path):
    box = next(iter(SHAPES))
    (tmp_path / "r.sdf").write_text(f'<sdf version="1.11"><model name="r">{link(collision(box, LEAD))}</model></sdf>')
    assert load_robot_model(str(tmp_path / "r.sdf"), PackageIndex(())).findings == ()
    twin = TwinBuilder().robot("r", tmp_path / "r.sdf").build()
    body = twin.plant.GetBodyByName("l")
    assert body.default_mass() == pytest.approx(11340 * 0.024)


@pytest.mark.parametrize(("name", "part"), [("sphere", 2 / 5), ("cylinder", 1 / 2)])
def test_things_roll_down_a_slope_as_solids_do(tmp_path, name, part):
    """a = g sin φ / (1 + I / (m r²))."""
    length = "<length>0.6</length>" if name == "cylinder" else ""
    shape = collision(f"<{name}><radius>0.3</radius>{length}</{name}>")
    slope, turn = radians(10), f"{pi / 2} 0 0"
    up = 0.3 / np.cos(slope)
    ground = f'<link name="g">{collision("<plane/>")}</link>'
    text = f"""<sdf version="1.11"><world name="w"><model name="hill"><static>1</static><pose>0 0 0 0 {slope} 0</pose>
{ground}</model><model name="m"><pose>0 0 {up} {turn}</pose>{link(shape)}</model></world></sdf>"""
    (tmp_path / "w.sdf").write_text(text)
    twin = TwinBuilder(world=World(file=str(tmp_path / "w.sdf"))).build()
    twin.advance_to(0.2)
    before = twin.entities.state("m").linear
    twin.advance_to(1.2)
    gained = np.linalg.norm(np.subtract(twin.entities.state("m").linear, before))
    assert gained == pytest.approx(9.8 * sin(slope) / (1 + part), rel=0.01)
