import pytest
from urdf_to_repair import BOX, SOLID, link, mend


@pytest.mark.parametrize("kind", ["visual", "collision"])
@pytest.mark.parametrize(
    "shape",
    [
        '<box size="1 0 1"/>',
        '<box size="1 -1 1"/>',
        '<sphere radius="0"/>',
        '<cylinder radius="0" length="1"/>',
        '<cylinder radius="1" length="0"/>',
        '<capsule radius="0" length="1"/>',
        "<box/>",
        '<box size=""/>',
        '<cylinder radius="1"/>',
        '<mesh filename="a.stl" scale="1 0 1"/>',
        '<mesh filename="a.stl" scale="1 1e-9 1"/>',
    ],
)
def test_a_shape_without_size_is_left_out(kind, shape):
    inside = f"{SOLID}\n<{kind}><geometry>{shape}</geometry></{kind}><{kind}>{BOX}</{kind}>"
    root, (repair,) = mend(link(inside=inside))
    assert len(root.findall(f"link/{kind}")) == 1
    assert repair.startswith(f'arm.xacro:3: <link name="base">: a {kind} <{shape[1:4]}')
    assert repair.endswith("has no size: it is left out [shape_without_size]")


@pytest.mark.parametrize("scale", ["", 'scale="0.001 0.001 0.001"', 'scale="1 -1 1"'])
def test_a_mesh_of_any_other_scale_is_left_alone(scale):
    visual = f'<visual><geometry><mesh filename="a.stl" {scale}/></geometry></visual>'
    assert mend(link(inside=SOLID + visual))[1] == []


@pytest.mark.parametrize("place", ["<visual>{}</visual>", "</link>{}<link name='none'>"])
def test_a_colour_beyond_its_range_is_brought_into_it(place):
    color = '<material name="paint"><color rgba="255 0.5 -1 1"/></material>'
    geometry = BOX if "visual" in place else ""
    body = f"{link(inside=SOLID + place.format(color + geometry))}".replace("<link name='none'></link>", "")
    root, (repair,) = mend(body)
    assert next(root.iter("color")).get("rgba") == "1 0.5 0 1"
    assert repair == "arm.xacro:2: <material name=\"paint\">: '255 0.5 -1 1' is not between 0 and 1 [color]"


@pytest.mark.parametrize("kind", ["visual", "collision"])
@pytest.mark.parametrize("inside", ["", "<geometry/>", "<geometry><cone/></geometry>"])
def test_a_visual_or_collision_without_a_shape_is_left_out(kind, inside):
    root, (repair,) = mend(link(inside=f"{SOLID}<{kind}>{inside}</{kind}>"))
    assert root.find(f"link/{kind}") is None
    assert repair == f'arm.xacro:2: <link name="base">: a {kind} has no shape: it is left out [shape_without_geometry]'
