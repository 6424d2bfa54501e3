from math import inf, pi
from pathlib import Path

import pytest
from urdf_text import parse_urdf

from drake_twin.description.robot_description import (
    CommandInterface,
    Joint,
    JointLimits,
    Mimic,
    Pose,
    RobotDescription,
    StateInterface,
)
from drake_twin.errors import InputError

LINKS = '<link name="base"/><link name="arm"/>'
LEADER = '<link name="a"/><joint name="a" type="continuous"><parent link="base"/><child link="a"/></joint>'
CONTINUOUS = '<joint name="elbow" type="continuous"><parent link="base"/><child link="arm"/>{}</joint>'


def robot(body: str, **options) -> RobotDescription:
    return parse_urdf(f'<robot name="r">\n{body}\n</robot>', Path("arm.urdf"), **options)


def joint_of(kind: str = "continuous", inside: str = "", after: str = "") -> Joint:
    text = f'<joint name="elbow" type="{kind}">\n<parent link="base"/><child link="arm"/>\n{inside}</joint>'
    return robot(f"{LINKS}\n{text}\n{after}").joints[0]


def refusal(call, *arguments) -> str:
    with pytest.raises(InputError) as raised:
        call(*arguments)
    return str(raised.value)


def tree(*edges: tuple[str, str], links: str) -> str:
    joints = "".join(
        f'\n<joint name="j{index}" type="fixed"><parent link="{parent}"/><child link="{child}"/></joint>'
        for index, (parent, child) in enumerate(edges)
    )
    return "".join(f'<link name="{link}"/>' for link in links) + joints


def test_a_joint_is_read_with_its_frames_and_dynamics():
    inside = '<origin xyz="1 2 3" rpy="0 0 1.5"/><axis xyz="0 0 2"/><dynamics damping="0.1" friction="0.2"/>'
    assert joint_of(inside=inside) == Joint(
        name="elbow",
        type="continuous",
        parent="base",
        child="arm",
        origin=Pose((1.0, 2.0, 3.0), (0.0, 0.0, 1.5)),
        axis=(0.0, 0.0, 1.0),
        damping=0.1,
        friction=0.2,
    )


@pytest.mark.parametrize(
    ("inside", "origin"),
    [
        ("", Pose()),
        ("<origin/>", Pose()),
        ('<origin xyz="1 2 3"/>', Pose((1.0, 2.0, 3.0), (0.0, 0.0, 0.0))),
        ('<origin rpy="1 2 3"/>', Pose((0.0, 0.0, 0.0), (1.0, 2.0, 3.0))),
    ],
)
def test_what_an_origin_leaves_out_is_zero(inside, origin):
    assert joint_of(inside=inside).origin == origin


def test_names_links_and_text_are_those_of_the_file():
    description = robot(LINKS + CONTINUOUS)
    assert (description.name, description.links, description.root_link) == ("r", ("base", "arm"), "base")
    assert description.file == Path("arm.urdf")
    assert description.text.startswith('<robot name="r">')


def test_limits_of_a_revolute_joint_are_read():
    limits = joint_of("revolute", '<limit lower="-1" upper="2" velocity="3" effort="4"/>').limits
    assert limits == JointLimits(-1.0, 2.0, 3.0, 4.0)


def test_a_continuous_joint_has_no_position_limits_even_when_the_file_gives_some():
    limits = joint_of("continuous", '<limit lower="-1" upper="2" velocity="3" effort="4"/>').limits
    assert limits == JointLimits(-inf, inf, 3.0, 4.0)


@pytest.mark.parametrize("zero", ["0", "-1"])
def test_an_effort_or_velocity_of_zero_or_less_means_unbounded(zero):
    limits = joint_of("revolute", f'<limit lower="-1" upper="1" velocity="{zero}" effort="{zero}"/>').limits
    assert (limits.velocity, limits.effort) == (inf, inf)


@pytest.mark.parametrize("kind", ["revolute", "prismatic"])
def test_a_bounded_joint_without_limits_is_refused(kind):
    text = refusal(joint_of, kind)
    assert text == f'arm.urdf:3: <joint name="elbow">: a {kind} joint needs <limit lower upper effort velocity>.'


def test_limits_in_the_wrong_order_are_refused():
    text = refusal(joint_of, "revolute", '<limit lower="2" upper="1"/>')
    assert text == 'arm.urdf:5: <limit> of <joint name="elbow">: lower (2) is above upper (1).'


@pytest.mark.parametrize(
    ("value", "reason"), [("big", "is not a number"), ("nan", "is not finite"), ("inf", "is not finite")]
)
@pytest.mark.parametrize(
    ("inside", "attribute"),
    [
        ('<limit lower="-1" upper="1" effort="{}"/>', "effort"),
        ('<limit lower="{}" upper="1"/>', "lower"),
        ('<limit lower="-1" upper="1"/>\n<dynamics damping="{}"/>', "damping"),
        ('<limit lower="-1" upper="1"/>\n<origin xyz="0 0 {}"/>', "xyz"),
        ('<limit lower="-1" upper="1"/>\n<mimic joint="a" multiplier="{}"/>', "multiplier"),
    ],
)
def test_a_wrong_number_gives_file_line_and_value(inside, attribute, value, reason):
    text = refusal(joint_of, "revolute", inside.format(value))
    assert text.startswith(f"arm.urdf:{5 + inside.count(chr(10))}: ")
    assert f"{attribute} is {value!r}, which {reason}." in text


def test_an_axis_without_direction_is_refused():
    text = refusal(joint_of, "continuous", '<axis xyz="0 0 0"/>')
    assert text == 'arm.urdf:5: <axis> of <joint name="elbow">: the axis has no direction (its length is zero).'


def test_a_fixed_joints_axis_does_not_matter():
    assert joint_of("fixed", '<axis xyz="0 0 0"/>').type == "fixed"


def test_an_unknown_joint_type_is_refused_with_those_there_are():
    assert "unknown joint type 'hinge'. Valid: fixed, revolute, continuous" in refusal(joint_of, "hinge")


@pytest.mark.parametrize("tag", ["parent", "child"])
def test_a_joint_without_parent_or_child_is_refused(tag):
    body = LINKS + CONTINUOUS.replace(f"<{tag}", "<other")
    assert refusal(robot, body) == f'arm.urdf:2: <joint name="elbow">: <{tag}> is missing.'


def test_a_follower_is_read_from_mimic():
    inside = '<mimic joint="a" multiplier="-2" offset="0.5"/>'
    assert joint_of(inside=inside, after=LEADER).mimic == Mimic("a", -2.0, 0.5)


@pytest.mark.parametrize("inside", ["", '<mimic joint="{}"/>'])
@pytest.mark.parametrize(
    ("leader", "reason"),
    [
        ("gone", "it mimics the unknown joint 'gone'"),
        ("elbow", "it mimics 'elbow', but it follows itself"),
        ("mount", "it mimics 'mount', but one of the two does not move"),
    ],
)
def test_a_joint_that_cannot_follow_is_refused(inside, leader, reason):
    mount = '<link name="b"/><joint name="mount" type="fixed"><parent link="base"/><child link="b"/></joint>'
    after = mount if inside else mount + mimic_in_ros2_control().replace(">a<", f">{leader}<")
    text = refusal(joint_of, "continuous", inside.format(leader), after)
    assert text == f'arm.urdf:3: <joint name="elbow">: {reason}.'


def test_joints_that_follow_each_other_are_refused():
    after = LEADER.replace("/></joint>", '/><mimic joint="elbow"/></joint>')
    assert "but it follows itself" in refusal(joint_of, "continuous", '<mimic joint="a"/>', after)


def mimic_in_ros2_control(multiplier: str = "-1") -> str:
    return (
        '<ros2_control name="s" type="system">\n<joint name="elbow"><param name="mimic">a</param>'
        f'<param name="multiplier">{multiplier}</param></joint></ros2_control>'
    )


def test_a_follower_is_read_from_the_parameters_of_ros2_control():
    assert joint_of(after=LEADER + mimic_in_ros2_control()).mimic == Mimic("a", -1.0, 0.0)
    plain = mimic_in_ros2_control().replace('<param name="multiplier">-1</param>', "{}")
    assert joint_of(after=LEADER + plain.format("")).mimic == Mimic("a", 1.0, 0.0)
    offset = plain.format('<param name="offset">0.5</param>')
    assert joint_of(after=LEADER + offset).mimic == Mimic("a", 1.0, 0.5)


def test_mimic_counts_more_than_the_parameters_of_ros2_control():
    after = LEADER + LEADER.replace('"a"', '"b"') + mimic_in_ros2_control()
    assert joint_of(inside='<mimic joint="b"/>', after=after).mimic == Mimic("b")


@pytest.mark.parametrize(
    ("value", "reason"), [("twice", "is not a number"), ("nan", "is not finite"), ("inf", "is not finite")]
)
def test_a_wrong_multiplier_in_ros2_control_gives_file_and_line(value, reason):
    text = refusal(joint_of, "continuous", "", mimic_in_ros2_control(value))
    assert text == f'arm.urdf:7: <joint name="elbow">: multiplier is {value!r}, which {reason}.'


ROS2_CONTROL = """
<ros2_control name="arm_system" type="system">
  <hardware><plugin> gz_ros2_control/GazeboSimSystem </plugin></hardware>
  <joint name="elbow">
    <command_interface name="position">
      <param name="min">{min}</param>
      <param name="max">{max}</param>
    </command_interface>
    <command_interface name="velocity"/>
    <state_interface name="position"><param name="initial_value">{initial}</param></state_interface>
    <state_interface name="velocity"/>
  </joint>
</ros2_control>"""


def controlled(lower: str = "-1.5", upper: str = "0.5", initial: str = "0.25") -> RobotDescription:
    return robot(LINKS + CONTINUOUS.format("") + ROS2_CONTROL.format(min=lower, max=upper, initial=initial))


def test_ros2_control_gives_interfaces_with_bounds_and_start_values():
    (system,) = controlled().systems
    assert (system.name, system.type, system.plugin) == ("arm_system", "system", "gz_ros2_control/GazeboSimSystem")
    (joint,) = system.joints
    assert joint.command_interfaces == (CommandInterface("position", -1.5, 0.5), CommandInterface("velocity"))
    assert joint.state_interfaces == (StateInterface("position", 0.25), StateInterface("velocity"))


def test_bounds_of_a_command_in_the_wrong_order_are_refused():
    text = refusal(controlled, "1", "0")
    assert text == ('arm.urdf:6: <command_interface name="position">: min (1) is above max (0).')


@pytest.mark.parametrize(("argument", "what"), [(0, "min"), (1, "max"), (2, "initial_value")])
def test_a_wrong_number_of_an_interface_is_refused(argument, what):
    values = ["-1", "1", "0"]
    values[argument] = "${pi"
    text = refusal(controlled, *values)
    assert f"{what} is '${{pi', which is not a number" in text
    assert text.startswith("arm.urdf:")


def test_gazebo_plugins_give_parameters_files_and_namespace():
    body = """<link name="base"/><gazebo><plugin filename="gz_ros2_control-system" name="Control">
      <parameters> one.yaml </parameters><parameters>two.yaml</parameters>
      <ros><namespace> robot_1 </namespace></ros></plugin></gazebo>"""
    description = robot(body)
    (plugin,) = description.plugins
    assert (plugin.filename, plugin.name, plugin.namespace) == ("gz_ros2_control-system", "Control", "robot_1")
    assert description.controller_files == ("one.yaml", "two.yaml")


def test_friction_that_is_no_number_is_refused():
    text = refusal(robot, '<link name="base"/>\n<gazebo reference="base"><mu1>high</mu1></gazebo>')
    assert text == "arm.urdf:3: <gazebo name=\"base\">: mu1 is 'high', which is not a number."


def test_a_joint_to_an_unknown_link_is_refused():
    text = refusal(robot, tree(("a", "nowhere"), links="a"))
    assert text == "arm.urdf:3: <joint name=\"j0\">: unknown link 'nowhere'. Valid: a."


def test_a_link_with_two_parents_is_refused():
    text = refusal(robot, tree(("a", "c"), ("b", "c"), links="abc"))
    assert text == "arm.urdf:4: <joint name=\"j1\">: link 'c' has two parents."


def test_several_roots_are_refused_by_name():
    text = refusal(robot, tree(("a", "b"), links="abc"))
    assert "the links must form one tree, but several have no parent: a, c" in text


def test_a_loop_of_all_links_is_refused():
    assert "all have a parent: the joints form a loop" in refusal(robot, tree(("a", "b"), ("b", "a"), links="ab"))


def test_a_loop_beside_the_tree_is_refused():
    assert "the joints form a loop through link" in refusal(robot, tree(("b", "c"), ("c", "b"), links="abc"))


def test_a_joint_from_a_link_to_itself_is_refused():
    assert "loop" in refusal(robot, tree(("b", "b"), links="ab"))


@pytest.mark.parametrize("second", ["a", " a "])
def test_two_links_of_one_name_are_refused_at_the_second(second):
    text = refusal(robot, f'<link name="a"/>\n<link name="{second}"/>')
    assert text == f'arm.urdf:3: <link name="{second}">: two links have this name.'


def test_two_joints_of_one_name_are_refused_at_the_second():
    text = refusal(robot, tree(("a", "b"), ("b", "c"), links="abc").replace("j1", "j0"))
    assert text == 'arm.urdf:4: <joint name="j0">: two joints have this name.'


def test_a_robot_without_links_is_refused():
    assert refusal(robot, "") == 'arm.urdf:1: <robot name="r">: the robot has no <link>.'


def test_another_kind_of_xml_is_refused():
    assert "a URDF's outermost element is <robot>" in refusal(parse_urdf, "<sdf/>")


def test_an_entity_bomb_is_refused():
    entities = "".join(f"<!ENTITY e{i + 1} '{f'&e{i};' * 10}'>" for i in range(9))
    text = f"<!DOCTYPE robot [<!ENTITY e0 'aaaaaaaaaa'>{entities}]><robot name='&e9;'><link name='base'/></robot>"
    assert "this is not well-formed XML" in refusal(parse_urdf, text)


def test_an_axis_of_any_length_becomes_a_unit_vector():
    assert joint_of(inside='<axis xyz="3 0 4"/>').axis == pytest.approx((0.6, 0.0, 0.8))


def test_pi_is_not_read_as_a_number():  # xacro would have made it one
    assert "is not a number" in refusal(joint_of, "revolute", '<limit lower="-pi" upper="pi"/>')
    assert joint_of("revolute", f'<limit lower="{-pi}" upper="{pi}"/>').limits.upper == pi
