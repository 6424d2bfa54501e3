import numpy as np
import pytest
import trimesh
from lxml import etree
from sdf_worlds import findings, world_of


def geometry(text, tmp_path, *, static=True, kind="collision", more=""):
    link = f'<link name="l"><{kind} name="c">{more}<geometry>{text}</geometry></{kind}></link>'
    world = world_of(tmp_path, f'<model name="a"><static>{str(static).lower()}</static>{link}</model>')
    return etree.fromstring(world.models[0].text).find(f".//{kind}"), findings(world)


def test_friction_is_the_smaller_coefficient_and_one_by_default(tmp_path):
    surface = "<surface><friction><ode><mu>{}</mu><mu2>{}</mu2></ode></friction></surface>"
    texts = {surface.format(100, 50): 50.0, surface.format(0.8, 0.3): 0.3, "": 1.0}
    for more, expected in texts.items():
        shape, _ = geometry("<sphere><radius>1</radius></sphere>", tmp_path, more=more)
        assert [float(item.text) for item in shape.find("{*}proximity_properties")] == [expected, expected]


def test_a_plane_is_drawn_as_a_thin_box_of_its_size(tmp_path):
    shape, _ = geometry("<plane><normal>0 0 1</normal><size>3 4</size></plane>", tmp_path, kind="visual")
    assert shape.findtext("geometry/box/size") == "3 4 0.001"
    assert float(shape.findtext("pose").split()[2]) == -0.0005


@pytest.mark.parametrize(
    ("material", "transparency", "expected"),
    [
        ("<diffuse>0.1 0.2 0.3 1</diffuse>", "", "0.1 0.2 0.3 1"),
        ("<script><name>Gazebo/Red</name></script>", "", "1 0 0 1"),
        ("<ambient>0 0.5 0 1</ambient>", "", "0 0.5 0 1"),
        ("<diffuse>7 0 0</diffuse>", "<transparency>0.25</transparency>", "1 0 0 0.75"),
        ("<diffuse>0.1 0.2 0.3 1</diffuse><emissive>0.5 0 0.9 1</emissive>", "", "0.6 0.2 1 1"),
        ("<emissive>0 1 0 1</emissive>", "", "0 1 0 1"),
        ("<diffuse>0.1 0.2 0.3 1</diffuse><emissive>bright</emissive>", "", "0.1 0.2 0.3 1"),
    ],
)
def test_a_visual_has_the_colour_that_gazebo_gives_it(tmp_path, material, transparency, expected):
    more = f"<material>{material}</material>{transparency}"
    shape, _ = geometry("<sphere><radius>1</radius></sphere>", tmp_path, kind="visual", more=more)
    assert shape.findtext("material/diffuse") == expected


@pytest.mark.parametrize(
    ("text", "what"),
    [
        ("<box><size>1 0 1</size></box>", "a: a collision <box> has no size (<size>1 0 1): it is left out"),
        (
            "<heightmap><uri>x</uri></heightmap>",
            "a: a collision <heightmap> is left out: Drake does not support it",
        ),
        ("<plane/>", "a: a collision <plane> of a model that moves is left out: Drake does not support it"),
    ],
)
def test_a_shape_that_drake_has_not_is_left_out_with_a_warning(tmp_path, text, what):
    shape, warnings = geometry(text, tmp_path, static=False)
    assert shape is None
    assert warnings == (what,)


def test_a_moving_models_mesh_collides_as_its_hull_or_the_primitive_that_it_is(tmp_path):
    trimesh.creation.box((1, 2, 3)).export(tmp_path / "box.stl")
    trimesh.creation.cone(1.0, 2.0).export(tmp_path / "cone.stl")
    box, _ = geometry("<mesh><uri>box.stl</uri><scale>2 1 1</scale></mesh>", tmp_path, static=False)
    assert [float(side) for side in box.findtext("geometry/box/size").split()] == pytest.approx([2, 2, 3])
    cone, _ = geometry("<mesh><uri>cone.stl</uri></mesh>", tmp_path, static=False)
    assert cone.findtext("geometry/mesh/uri").endswith(".hull.obj")


@pytest.mark.parametrize("kind", ["visual", "collision"])
@pytest.mark.parametrize("static", [True, False])
def test_a_cone_is_a_mesh_with_its_tip_along_z_about_the_middle_of_its_length(tmp_path, kind, static):
    text = "<cone><radius>0.3</radius><length>0.8</length></cone>"
    shape, warnings = geometry(text, tmp_path, kind=kind, static=static)
    assert not warnings
    mesh = trimesh.load(shape.findtext("geometry/mesh/uri").removeprefix("file://"), force="mesh")
    # As libsdformat 14 has it: the base has this radius, at -length ÷ 2, and the tip is at length ÷ 2.
    assert mesh.bounds == pytest.approx(np.array([[-0.3, -0.3, -0.4], [0.3, 0.3, 0.4]]))
    assert mesh.convex_hull.volume == pytest.approx(np.pi * 0.3**2 * 0.8 / 3, rel=5e-3)
    assert mesh.vertices[mesh.vertices[:, 2] > 0] == pytest.approx(np.array([[0.0, 0.0, 0.4]]))


@pytest.mark.parametrize(
    ("text", "size", "what"),
    [
        ("<box>2 2 2</box>", {"size": "1 1 1"}, "a collision <box> has the size 1 1 1"),
        ("<sphere/>", {"radius": "1"}, "a collision <sphere> has the radius 1"),
        ("<cylinder/>", {"radius": "1", "length": "1"}, "a collision <cylinder> has the radius 1 and the length 1"),
        ("<cylinder><radius>0.2</radius></cylinder>", {"radius": "0.2", "length": "1"}, "has the length 1"),
        ("<capsule/>", {"radius": "0.5", "length": "1"}, "a collision <capsule> has the radius 0.5 and the length 1"),
        ("<ellipsoid/>", {"radii": "1 1 1"}, "a collision <ellipsoid> has the radii 1 1 1"),
    ],
)
def test_a_size_that_is_not_there_is_sdformats(tmp_path, text, size, what):
    """In Gazebo Fortress, with DART, their middles rest at 0.5, 1, 0.5, 0.5, 1 and 1 m above a plane."""
    shape, (said,) = geometry(text, tmp_path)
    assert {tag: shape.findtext(f"geometry//{tag}") for tag in size} == size
    assert what in said
    assert said.endswith("as in Gazebo: it gives none")


def test_a_cone_without_a_size_is_left_out(tmp_path):
    shape, (what,) = geometry("<cone><radius>0</radius><length>1</length></cone>", tmp_path)
    assert shape is None
    assert what.startswith("a: a collision <cone> has no size")


def test_moments_that_no_body_has_are_mended_as_in_a_robot(tmp_path):
    inertia = "<mass>1</mass><inertia><ixx>1</ixx><iyy>1</iyy><izz>9</izz></inertia>"
    world = world_of(tmp_path, f'<model name="a"><link name="l"><inertial>{inertia}</inertial></link></model>')
    what = "a: link l: no body has the principal moments 1, 1, 9 kg·m²: the nearest possible are used: "
    assert findings(world) == (f"{what}3.33 (+233 %), 3.33 (+233 %), 6.67 (-25.9 %)",)
    ixx, iyy, izz = (float(etree.fromstring(world.models[0].text).findtext(f".//{n}")) for n in ("ixx", "iyy", "izz"))
    assert ixx + iyy >= izz


JOINT = """<link name="a"/><link name="b"/><joint name="j" type="{}"><parent>a</parent><child>b</child><axis>
<xyz>0 0 1</xyz><limit><lower>2</lower><upper>1</upper></limit></axis></joint>"""


def test_a_joint_that_drake_has_not_is_fixed(tmp_path):
    world = world_of(tmp_path, f'<model name="m">{JOINT.format("gearbox")}</model>')
    assert "m: joint j is fixed: Drake does not support gearbox joints" in findings(world)
    assert etree.fromstring(world.models[0].text).find("model/joint").get("type") == "fixed"


def test_limits_in_the_wrong_order_change_places(tmp_path):
    world = world_of(tmp_path, f'<model name="m">{JOINT.format("revolute")}</model>')
    assert findings(world) == ("m: joint j: lower 2 is above upper 1: they are swapped",)
    limit = etree.fromstring(world.models[0].text).find("model/joint/axis/limit")
    assert (limit.findtext("lower"), limit.findtext("upper")) == ("1", "2")


def test_the_joints_of_a_static_model_say_nothing(tmp_path):
    (model,) = world_of(tmp_path, f'<model name="m"><static>1</static>{JOINT.format("revolute")}</model>').models
    assert etree.fromstring(model.text).find(".//joint") is None


def test_links_that_gazebo_classic_named_after_inner_models_are_links_of_the_model(tmp_path):
    links = '<link name="a::l"/><link name="b::l"><pose relative_to="a::l">1 0 0 0 0 0</pose></link><link name="b::l"/>'
    joint = '<joint name="b::j" type="fixed"><parent>a::l</parent><child>b::l</child></joint>'
    (model,) = world_of(tmp_path, f'<model name="m">{links}{joint}</model>').models
    root = etree.fromstring(model.text)
    assert [link.get("name") for link in root.iter("link")] == ["a_l", "b_l", "b_l_0"]
    assert root.find(".//link/pose").get("relative_to") == "a_l"
    assert [root.findtext(f".//joint/{tag}") for tag in ("parent", "child")] == ["a_l", "b_l"]


def test_what_no_axis_has_is_left_out(tmp_path):
    joint = JOINT.format("continuous").replace("<limit>", "<initial_position>1</initial_position><limit>")
    world = world_of(tmp_path, f'<model name="m">{joint}</model>')
    assert "m: <initial_position> is not used" in findings(world)


@pytest.mark.parametrize("kind", ["ball", "universal", "screw"])
def test_limits_that_drake_has_not_are_named(tmp_path, kind):
    world = world_of(tmp_path, f'<model name="m">{JOINT.format(kind)}</model>')
    assert f"m: joint j moves without limits: Drake does not support limits of {kind} joints" in findings(world)
    endless = JOINT.format(kind).replace(
        "<lower>2</lower><upper>1</upper>", "<lower>-1e16</lower><velocity>-1</velocity>"
    )
    assert findings(world_of(tmp_path, f'<model name="m">{endless}</model>')) == ()
