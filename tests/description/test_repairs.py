from pathlib import Path

import numpy as np
import pytest
import scipy.optimize
from lxml import etree
from pydrake.multibody.tree import SpatialInertia, UnitInertia

from drake_twin.description.repairs import RULES, check_rule_names, possible_inertia, repair_urdf
from drake_twin.description.xml_reader import XmlReader
from drake_twin.errors import InputError

INERTIAL = '<inertial><mass value="{mass}"/>{inertia}</inertial>'
INERTIA = '<inertia ixx="{}" ixy="{}" ixz="{}" iyy="{}" iyz="{}" izz="{}"/>'
SOLID = INERTIAL.format(mass=1, inertia=INERTIA.format(1, 0, 0, 1, 0, 1))
BOX = '<geometry><box size="1 1 1"/></geometry>'


def mend(body: str, name: str = 'name="r"', **options) -> tuple[etree._Element, list[str]]:
    """The robot's tree after the repairs, and what they say; the body begins in line 2."""
    reader = XmlReader(f"<robot {name}>\n{body}\n</robot>", Path("arm.xacro"))
    repairs = repair_urdf(reader, **options)
    return reader.root, [str(repair) for repair in repairs]


def link(name: str = "base", inside: str = SOLID) -> str:
    return f'<link name="{name}">{inside}</link>'


def joint(name="elbow", kind="continuous", parent="base", child="arm", inside="") -> str:
    return f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>{inside}</joint>'


def arm(*joints: str) -> str:
    """A base, an arm and a hand in lines 2 to 4, and the joints after them, one a line."""
    return "\n".join([link(), link("arm"), link("hand"), *joints])


LIMIT = '<limit lower="-1" upper="1" effort="5" velocity="1"/>'
HEALTHY = arm(
    joint(kind="revolute", inside=LIMIT),
    joint("wrist", "prismatic", "arm", "hand", LIMIT + '<mimic joint="elbow"/>'),
    '<link name="tool"/>',
    joint("mount", "fixed", "hand", "tool"),
    '<ros2_control name="s" type="system"><joint name="elbow"><command_interface name="velocity"/></joint>'
    "</ros2_control>",
    link("camera", f"<visual>{BOX}</visual><collision>{BOX}</collision>"),
    joint("camera_mount", "fixed", "hand", "camera"),
)

# One broken robot for each rule.
BROKEN = {
    "robot_without_name": ("", link()),
    "robot_without_links": ('name="r"', ""),
    "joint_without_limits": ('name="r"', arm(joint(kind="revolute"))),
    "continuous_joint_with_limits": ('name="r"', arm(joint(inside=LIMIT), joint("wrist", "fixed", "arm", "hand"))),
    "floating_joint": ('name="r"', arm(joint(kind="floating"), joint("wrist", "fixed", "arm", "hand"))),
    "effort_limit": (
        'name="r"',
        arm(
            joint(kind="revolute", inside=LIMIT.replace("5", "0")),
            '<ros2_control name="s" type="system"><joint name="elbow"><command_interface name="velocity"/></joint>'
            "</ros2_control>",
        ),
    ),
    "mimic": ('name="r"', arm(joint(inside='<mimic joint="gone"/>'))),
    "shape_without_size": ('name="r"', link(inside=SOLID + f"<visual>{BOX.replace('1 1 1', '0 0 0')}</visual>")),
    "shape_without_geometry": ('name="r"', link(inside=SOLID + "<visual/>")),
    "color": (
        'name="r"',
        link(inside=SOLID + f'<visual>{BOX}<material name="m"><color rgba="9 0 0 1"/></material></visual>'),
    ),
    "inertia": ('name="r"', link(inside=SOLID.replace('ixx="1"', 'ixx="9"'))),
    "massless_link": ('name="r"', '<link name="base"/>'),
}


def test_each_rule_has_a_broken_robot_here():
    assert set(BROKEN) == set(RULES)


@pytest.mark.parametrize("rule", BROKEN)
def test_a_rule_says_what_it_did_and_where(rule):
    name, body = BROKEN[rule]
    _, repairs = mend(body, name)
    (said,) = (text for text in repairs if text.endswith(f"[{rule}]"))
    assert said.startswith("arm.xacro:")


@pytest.mark.parametrize("rule", BROKEN)
def test_a_rule_that_is_left_out_changes_nothing(rule):
    name, body = BROKEN[rule]
    root, repairs = mend(body, name, without=[rule])
    assert not [text for text in repairs if text.endswith(f"[{rule}]")]
    if not repairs:
        assert etree.tostring(root).decode() == f"<robot {name}>\n{body}\n</robot>".replace("<robot >", "<robot>")


@pytest.mark.parametrize("rule", BROKEN)
def test_what_was_mended_needs_no_second_repair(rule):
    name, body = BROKEN[rule]
    root, _ = mend(body, name)
    assert repair_urdf(XmlReader(etree.tostring(root, encoding="unicode"))) == []


def test_a_healthy_robot_is_left_alone():
    root, repairs = mend(HEALTHY)
    assert repairs == []
    assert etree.tostring(root).decode() == f'<robot name="r">\n{HEALTHY}\n</robot>'


def test_a_rule_that_does_not_exist_is_refused_with_those_there_are():
    check_rule_names(["inertia"], RULES)
    with pytest.raises(
        InputError,
        match=r"there is no repair 'inertias'\. Did you mean 'inertia'\? Valid: color, continuous_joint",
    ):
        check_rule_names(["inertias"], RULES)


# The robot


@pytest.mark.parametrize("name", ["", 'name=""', 'name=" "'])
def test_a_robot_without_a_name_is_called_after_its_file(name):
    root, repairs = mend(link(), name)
    assert root.get("name") == "arm"
    assert repairs == [
        "arm.xacro:1: the robot has no name: it is called 'arm' after its file [robot_without_name]",
    ]


def test_a_robot_of_text_alone_without_a_name_is_called_robot():
    reader = XmlReader(f"<robot>{link()}</robot>")
    repair_urdf(reader)
    assert reader.root.get("name") == "robot"


def test_a_robot_without_links_becomes_an_empty_frame():
    root, (repair,) = mend("")
    assert [element.get("name") for element in root] == ["world"]
    assert (
        repair == "arm.xacro:1: the robot has no link (a part for other files to include?): it is an empty frame"
        " [robot_without_links]"
    )


def test_a_robot_of_joints_alone_is_no_empty_frame():
    root, _ = mend(joint())
    assert root.find("link") is None


# Joints


def test_a_revolute_joint_without_limits_turns_without_end():
    root, (repair,) = mend(arm(joint(kind="revolute"), joint("wrist", "fixed", "arm", "hand")))
    assert root.find("joint").get("type") == "continuous"
    assert repair == (
        'arm.xacro:5: <joint name="elbow"> is revolute without <limit>: it turns without end [joint_without_limits]'
    )


def test_a_continuous_joint_turns_without_end_whatever_its_bounds_are():
    root, (repair,) = mend(arm(joint(inside='<limit lower="-1" upper="1" effort="5" velocity="2"/>')))
    assert dict(root.find("joint/limit").attrib) == {"effort": "5", "velocity": "2"}
    assert repair == (
        'arm.xacro:5: <joint name="elbow"> is continuous and turns without end: its lower -1, upper 1 bounds nothing'
        " [continuous_joint_with_limits]"
    )
    assert mend(arm(joint(inside='<limit lower="0" upper="0" effort="5" velocity="2"/>')))[1] == []


def test_a_prismatic_joint_without_limits_slides_a_kilometre():
    root, (repair,) = mend(arm(joint(kind="prismatic"), joint("wrist", "fixed", "arm", "hand")))
    limit = root.find("joint/limit")
    assert (float(limit.get("lower")), float(limit.get("upper"))) == (-1000.0, 1000.0)
    assert "is prismatic without <limit>" in repair


@pytest.mark.parametrize("kind", ["revolute", "prismatic"])
def test_limits_in_the_wrong_order_change_places(kind):
    inside = '<limit lower="2" upper="-1" effort="1" velocity="1"/>'
    root, (repair,) = mend(arm(joint(kind=kind, inside=inside), joint("wrist", "fixed", "arm", "hand")))
    limit = root.find("joint/limit")
    assert (float(limit.get("lower")), float(limit.get("upper"))) == (-1.0, 2.0)
    assert "lower 2 is above upper -1: they change places" in repair


def test_a_limit_that_is_no_number_is_left_for_the_reader_to_refuse():
    inside = '<limit lower="pi" upper="-1" effort="1" velocity="1"/>'
    root, repairs = mend(arm(joint(kind="revolute", inside=inside)))
    assert repairs == []
    assert root.find("joint/limit").get("lower") == "pi"


def test_a_floating_joint_to_the_world_is_left_out_with_the_world():
    root, (repair,) = mend(f'{link()}\n<link name="world"/>\n{joint("free", "floating", "world", "base")}')
    assert [element.get("name") for element in root] == ["base"]
    assert repair == (
        'arm.xacro:3: <joint name="free"> to the world is what a robot that is not fixed has anyway: it is left out'
        " [floating_joint]"
    )


def test_a_floating_joint_inside_a_robot_becomes_fixed():
    root, (repair,) = mend(arm(joint(kind="floating"), joint("wrist", "fixed", "arm", "hand")))
    assert root.find("joint").get("type") == "fixed"
    assert repair.startswith('arm.xacro:5: <joint name="elbow"> floats, ')


@pytest.mark.parametrize("effort", ["0", "0.0", "-1"])
def test_an_effort_limit_of_zero_or_less_on_a_commanded_joint_is_none(effort):
    name, body = BROKEN["effort_limit"]
    root, (repair,) = mend(body.replace('effort="0"', f'effort="{effort}"'), name)
    assert root.find("joint/limit").get("effort") is None
    assert f"is commanded, but its effort limit is {float(effort):g}: it has none" in repair


def test_an_effort_limit_of_zero_on_a_joint_that_nobody_commands_is_left_alone():
    root, repairs = mend(arm(joint(kind="revolute", inside=LIMIT.replace("5", "0"))))
    assert repairs == []
    assert root.find("joint/limit").get("effort") == "0"


@pytest.mark.parametrize(
    ("joints", "reason"),
    [
        ([joint(inside='<mimic joint="gone"/>')], "mimics 'gone', but there is no such joint"),
        ([joint(inside="<mimic/>")], "mimics '', but there is no such joint"),
        (
            [joint(inside='<mimic joint="wrist"/>'), joint("wrist", "fixed", "arm", "hand")],
            "mimics 'wrist', but that joint does not move",
        ),
        (
            [joint(), joint("wrist", "fixed", "arm", "hand", '<mimic joint="elbow"/>')],
            "mimics 'elbow', but it does not move itself",
        ),
        ([joint(inside='<mimic joint="elbow"/>')], "mimics 'elbow', but it follows itself"),
    ],
)
def test_a_joint_that_cannot_follow_mimics_nothing(joints, reason):
    root, (repair,) = mend(arm(*joints))
    assert root.find("joint/mimic") is None
    assert f"{reason}: it mimics nothing [mimic]" in repair


@pytest.mark.parametrize(("leader", "reason"), [("gone", "there is no such joint"), ("elbow", "it follows itself")])
def test_a_follower_of_ros2_control_that_cannot_follow_mimics_nothing(leader, reason):
    parameter = f'<param name="mimic">{leader}</param>'
    follower = f'<ros2_control name="s" type="system">\n<joint name="elbow">{parameter}</joint></ros2_control>'
    root, (repair,) = mend(arm(joint(), joint("wrist", "fixed", "arm", "hand"), follower))
    assert root.find("ros2_control/joint/param") is None
    assert repair == f'arm.xacro:8: <joint name="elbow"> mimics {leader!r}, but {reason}: it mimics nothing [mimic]'


def test_a_follower_of_ros2_control_that_can_follow_is_left_alone():
    parameter = '<param name="mimic">elbow</param>'
    follower = f'<ros2_control name="s" type="system"><joint name="wrist">{parameter}</joint></ros2_control>'
    assert mend(arm(joint(), joint("wrist", "continuous", "arm", "hand"), follower))[1] == []


def test_a_circle_of_followers_is_opened_at_one_of_them():
    root, (repair,) = mend(
        arm(
            joint(inside='<mimic joint="wrist"/>'),
            joint("wrist", "continuous", "arm", "hand", '<mimic joint="elbow"/>'),
        )
    )
    assert [element.get("joint") for element in root.iterfind("joint/mimic")] == ["elbow"]
    assert "it follows itself" in repair


# Shapes


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
    assert repair.startswith(f'arm.xacro:2: <link name="base">: a {kind} <{shape[1:4]}')
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


# Masses


def tensor(root: etree._Element) -> np.ndarray:
    inertia = root.find("link/inertial/inertia")
    ixx, ixy, ixz, iyy, iyz, izz = (float(inertia.get(name)) for name in ("ixx", "ixy", "ixz", "iyy", "iyz", "izz"))
    return np.array([[ixx, ixy, ixz], [ixy, iyy, iyz], [ixz, iyz, izz]])


@pytest.mark.parametrize("inertia", ["", "<inertia/>", INERTIA.format(0, 0, 0, 0, 0, 0)])
def test_a_mass_without_inertia_gets_that_of_a_small_sphere(inertia):
    root, (repair,) = mend(link(inside=INERTIAL.format(mass=2, inertia=inertia)))
    assert tensor(root) == pytest.approx(0.4 * 2 * 0.01**2 * np.eye(3))
    assert "has mass but no inertia: that of a sphere of 0.01 m is used [inertia]" in repair


@pytest.mark.parametrize(
    "values",
    [
        (9, 0, 0, 1, 0, 1),  # one moment larger than the others together
        (-1, 0, 0, 1, 0, 1),
        (1, 5, 0, 1, 0, 1),  # not positive definite
        (1e-9, 0, 0, 1, 0, 1),
        (1, 0, 0, 0, 0, 0),
        (-1, 0, 0, -1, 0, -1),
    ],
)
def test_an_inertia_that_no_body_can_have_becomes_one_that_drake_takes(values):
    root, (repair,) = mend(link(inside=INERTIAL.format(mass=2, inertia=INERTIA.format(*values))))
    moments = np.linalg.eigvalsh(tensor(root))
    assert moments[0] > 0
    assert moments[2] <= moments[0] + moments[1]
    assert "no body has the principal moments" in repair
    assert SpatialInertia(2.0, np.zeros(3), unit_inertia(tensor(root) / 2.0)).IsPhysicallyValid()


@pytest.mark.parametrize(
    "moments", [(1, 1, 9), (0.1, 0.2, 1), (-1, 1, 1), (-5, 1, 1), (0, 1, 1), (-3, -2, 4), (2, 3, 9)]
)
def test_no_possible_inertia_is_nearer(moments):
    """Against SciPy's search among rods along the axes, whatever the axes are."""
    axes = np.linalg.qr(np.random.default_rng(1).normal(size=(3, 3)))[0]
    given = axes @ np.diag(moments).astype(float) @ axes.T
    found, why = possible_inertia(2.0, given)
    rods = 1.0 - np.eye(3)
    _, distance = scipy.optimize.nnls(rods, np.array(moments, dtype=float))
    assert np.linalg.norm(found - given) == pytest.approx(distance, abs=3e-6 * np.abs(moments).max())
    assert np.allclose(axes.T @ found @ axes, np.diag(np.diag(axes.T @ found @ axes)), atol=1e-12)
    assert "kg·m²: the nearest possible are used: " in why


@pytest.mark.parametrize("moments", [(1, 1, 2), (1e-3, 1, 1), (1, 1, 1), (2e-6, 1, 1)])
def test_what_a_body_can_have_is_left_as_it_is(moments):
    found, why = possible_inertia(2.0, np.diag(moments).astype(float))
    assert (np.diag(found).tolist(), why) == (list(moments), None)


def unit_inertia(moments: np.ndarray) -> UnitInertia:
    return UnitInertia(*np.diag(moments), moments[0, 1], moments[0, 2], moments[1, 2])


@pytest.mark.parametrize("mass", ["", '<mass value="0"/>'])
def test_an_inertia_without_mass_is_left_out(mass):
    arm_link = link("arm", f"<inertial>{mass}{INERTIA.format(1, 0, 0, 1, 0, 1)}</inertial>")
    root, (repair,) = mend(f"{link()}\n{arm_link}\n{joint(kind='fixed')}")
    assert len(root.findall("link/inertial")) == 1
    assert repair == 'arm.xacro:3: <link name="arm"> has inertia but no mass: it has neither [inertia]'


def test_an_inertia_is_changed_no_further_than_needed():
    root, _ = mend(link(inside=INERTIAL.format(mass=2, inertia=INERTIA.format(1, 0, 0, 1, 0, 2.01))))
    assert tensor(root) == pytest.approx(np.diag([1.0, 1.0, 2.01]), rel=0.01)


def test_an_inertia_that_is_no_number_is_left_for_the_reader_to_refuse():
    body = link(inside=SOLID.replace('ixx="1"', 'ixx="heavy"'))
    root, repairs = mend(body)
    assert repairs == []
    assert root.find("link/inertial/inertia").get("ixx") == "heavy"


def test_a_floating_root_without_mass_gets_a_little():
    root, (repair,) = mend('<link name="base"/>')
    assert float(root.find("link/inertial/mass").get("value")) == 0.001
    assert repair == ('arm.xacro:2: <link name="base"> moves, but has no mass: it weighs 0.001 kg [massless_link]')


@pytest.mark.parametrize("inside", ["", INERTIAL.format(mass=0, inertia="")])
def test_a_moving_link_without_mass_gets_a_little(inside):
    body = f"{link()}\n{link('arm', inside)}\n{joint()}"
    root, (repair,) = mend(body)
    assert [float(mass.get("value")) for mass in root.iterfind("link/inertial/mass")] == [1.0, 0.001]
    assert repair.startswith('arm.xacro:3: <link name="arm"> moves')


def test_a_massless_link_that_carries_a_mass_is_left_alone():
    body = "\n".join(['<link name="base"/>', link("arm"), joint(kind="fixed")])
    assert mend(body)[1] == []


def test_a_link_that_is_welded_to_the_world_needs_no_mass():
    body = "\n".join(['<link name="world"/>', '<link name="base"/>', joint(kind="fixed", parent="world", child="base")])
    assert mend(body)[1] == []


def test_a_joint_without_child_is_left_for_the_reader_to_refuse():
    body = link() + '<link name="arm"/><joint name="elbow" type="continuous"><parent link="base"/></joint>'
    assert mend(body)[1] == []
