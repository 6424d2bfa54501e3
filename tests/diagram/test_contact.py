"""How shapes are chosen to touch, and what is said where they cannot."""

import pytest
from pydrake.geometry import Box, Convex, Cylinder, Ellipsoid, Role, Sphere

from drake_twin import TwinBuilder
from drake_twin.scenario import World

LINK = """<link name="{name}"><inertial><mass value="1"/>
<inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial>
<collision><geometry>{shape}</geometry></collision></link>"""
JOINT = """<joint name="{name}_joint" type="{type}"><parent link="base"/><child link="{name}"/>
<origin xyz="0 0.3 0" rpy="{roll} 0 0"/>
<axis xyz="0 0 1"/><limit lower="-1" upper="1" effort="5" velocity="5"/></joint>"""


def cart(shape='<cylinder radius="0.1" length="0.05"/>', kind="continuous", roll=1.5708):
    return (
        '<robot name="cart">'
        + LINK.format(name="base", shape='<box size="0.4 0.4 0.1"/>')
        + LINK.format(name="part", shape=shape)
        + JOINT.format(name="part", type=kind, roll=roll)
        + "</robot>"
    )


def twin_of(folder, urdf, world=None, **options):
    (folder / "cart.urdf").write_text(urdf)
    return TwinBuilder(world=world).robot("cart", folder / "cart.urdf", xyz=(0, 0, 0.5), **options).build()


def touching(twin, body):
    index = twin.plant.GetBodyByName(body).index()
    (found,) = [(type(item.shape), item.touches) for item in twin.built.shapes if item.body == index]
    return found


@pytest.mark.parametrize(
    ("shape", "kind", "roll", "expected"),
    [
        ('<cylinder radius="0.1" length="0.05"/>', "continuous", 1.5708, (Ellipsoid, "wheel")),
        ('<cylinder radius="0.1" length="0.05"/>', "continuous", -1.57, (Ellipsoid, "wheel")),
        ('<cylinder radius="0.1" length="0.05"/>', "continuous", 1.5, (Ellipsoid, "wheel")),  # both are rolled by it
        ('<cylinder radius="0.1" length="0.05"/>', "continuous", 0.0, (Cylinder, "faces")),  # a turntable
        ('<cylinder radius="0.1" length="0.05"/>', "revolute", 1.5708, (Cylinder, "faces")),
        ('<cylinder radius="0.1" length="0.9"/>', "continuous", 1.5708, (Cylinder, "faces")),  # a roller
        ('<sphere radius="0.1"/>', "continuous", 1.5708, (Sphere, "point")),
        ('<box size="0.1 0.1 0.1"/>', "continuous", 1.5708, (Box, "faces")),
    ],
)
def test_shape_and_joint_decide_how_a_part_touches(tmp_path, shape, kind, roll, expected):
    twin = twin_of(tmp_path, cart(shape, kind, roll))
    assert touching(twin, "part") == expected
    assert touching(twin, "base") == (Box, "faces")


def test_a_robot_can_touch_in_points(tmp_path):
    twin = twin_of(tmp_path, cart(), contact="point")
    assert touching(twin, "base") == (Box, "point")
    assert touching(twin, "part") == (Ellipsoid, "wheel")
    twin.advance_to(1.0)
    assert 0.04 < twin.entities.state("cart").position[2] < 0.2


def test_a_world_can_be_touched_in_points(tmp_path):
    world = tmp_path / "world.sdf"
    world.write_text(
        '<sdf version="1.9"><world name="w"><model name="table"><static>true</static>'
        '<link name="l"><collision name="c">'
        "<geometry><box><size>2 2 0.2</size></box></geometry></collision></link></model></world></sdf>"
    )
    for contact, touches in (("hydroelastic", "faces"), ("point", "point")):
        twin = twin_of(tmp_path, cart(), World(file=str(world), contact=contact))
        assert {item.touches for item in twin.built.shapes if not item.model} == {touches}
        assert touching(twin, "base") == (Box, "faces")


def mesh(folder, name, *corners):
    faces = [f"f 1 {k} {k + 1}" for k in range(2, len(corners))]
    (folder / name).write_text("\n".join([*(f"v {x} {y} {z}" for x, y, z in corners), *faces]))
    return f'<mesh filename="file://{folder}/{name}"/>'


def test_a_mesh_touches_with_its_hull(tmp_path):
    wedge = mesh(tmp_path, "wedge.obj", (0, 0, 0), (0.1, 0, 0), (0, 0.2, 0), (0, 0, 0.3))
    assert touching(twin_of(tmp_path, cart(wedge, "revolute")), "part") == (Convex, "faces")


@pytest.mark.parametrize(("size", "touches"), [(0.1, "faces"), (1e-4, "point")])
def test_a_mesh_that_cannot_yield_touches_in_a_point_and_says_so(tmp_path, size, touches):
    sheet = mesh(tmp_path, "sheet.obj", (0, 0, 0), (size, 0, 0), (size, size, 0), (0, 1.1 * size, 0))
    twin = twin_of(tmp_path, cart(sheet, "revolute"))
    twin.advance_to(1.0)
    assert touching(twin, "part") == (Convex, touches)
    said = "cart: a collision shape of part touches in a point: Drake cannot compute its pressure"
    assert (said in twin.findings.warnings) == (touches == "point")


@pytest.mark.parametrize("contact", ["hydroelastic", "point"])
def test_drake_adds_nothing_to_a_face_when_a_context_is_created(tmp_path, contact):
    """What it adds makes it compute the faces of the shape again."""
    twin = twin_of(tmp_path, cart(), World(contact=contact))
    graph = twin.plant.GetMyContextFromRoot(twin.context)
    of_context = twin.plant.get_geometry_query_input_port().Eval(graph).inspector()
    of_model = next(item for item in twin.diagram.GetSystems() if item.get_name() == "scene_graph").model_inspector()
    faces = 0
    for geometry in of_model.GetAllGeometryIds(Role.kProximity):
        own, used = (inspector.GetProximityProperties(geometry) for inspector in (of_model, of_context))
        if own.HasProperty("hydroelastic", "compliance_type"):
            faces += 1
            for group in used.GetGroupNames():
                assert set(used.GetPropertiesInGroup(group)) == set(own.GetPropertiesInGroup(group))
    assert faces >= 1


SHAPES_OF_ONE = """<robot name="cart"><link name="base"><inertial><mass value="1"/>
<inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial>
<collision><geometry><box size="0.2 0.2 0.2"/></geometry></collision>
<collision><geometry><cylinder radius="0.1" length="0.3"/></geometry></collision>
<collision><origin xyz="0.1 0 0"/><geometry><sphere radius="0.1"/></geometry></collision></link></robot>"""


def test_the_shapes_of_one_link_do_not_touch_where_links_of_one_robot_do(tmp_path):
    """Drake forgets that two shapes are on one body where one of them is changed."""
    twin = twin_of(tmp_path, SHAPES_OF_ONE, World(gravity=(0, 0, 0), ground=False), self_collision=True)
    twin.advance_to(0.01)
    results = twin.plant.get_contact_results_output_port().Eval(twin.plant.GetMyContextFromRoot(twin.context))
    assert (results.num_hydroelastic_contacts(), results.num_point_pair_contacts()) == (0, 0)
