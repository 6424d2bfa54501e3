import pytest
from urdf_to_repair import BROKEN, LIMIT, arm, joint, link, mend

from drake_twin.description.repairs import repair_urdf
from drake_twin.description.xml_reader import XmlReader


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
        'arm.xacro:5: <joint name="elbow"> is continuous and turns without end: its lower -1, upper 1 has no effect'
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
    assert "lower 2 is above upper -1: they are swapped" in repair


def test_a_limit_that_is_no_number_is_left_for_the_reader_to_refuse():
    inside = '<limit lower="pi" upper="-1" effort="1" velocity="1"/>'
    root, repairs = mend(arm(joint(kind="revolute", inside=inside)))
    assert repairs == []
    assert root.find("joint/limit").get("lower") == "pi"


def test_a_floating_joint_to_the_world_is_left_out_with_the_world():
    root, (repair,) = mend(f'{link()}\n<link name="world"/>\n{joint("free", "floating", "world", "base")}')
    assert [element.get("name") for element in root] == ["base"]
    assert repair == (
        'arm.xacro:3: <joint name="free"> to the world is left out: a robot that is not fixed is free without it'
        " [floating_joint]"
    )


def test_a_floating_joint_inside_a_robot_becomes_fixed():
    root, (repair,) = mend(arm(joint(kind="floating"), joint("wrist", "fixed", "arm", "hand")))
    assert root.find("joint").get("type") == "fixed"
    assert repair.startswith('arm.xacro:5: <joint name="elbow">: floating joints between two links')


@pytest.mark.parametrize("effort", ["0", "0.0", "-1"])
def test_an_effort_limit_of_zero_or_less_on_a_commanded_joint_is_none(effort):
    name, body = BROKEN["effort_limit"]
    root, (repair,) = mend(body.replace('effort="0"', f'effort="{effort}"'), name)
    assert root.find("joint/limit").get("effort") is None
    assert f"is commanded, but its effort limit is {float(effort):g}: it has no limit" in repair


def test_an_effort_limit_of_zero_on_a_joint_that_nobody_commands_is_left_alone():
    root, repairs = mend(arm(joint(kind="revolute", inside=LIMIT.replace("5", "0"))))
    assert repairs == []
    assert root.find("joint/limit").get("effort") == "0"


def test_a_joint_that_a_plugin_drives_is_commanded():
    plugin = '<gazebo><plugin filename="{}" name="d"><left_joint>elbow</left_joint></plugin></gazebo>'
    body = arm(joint(inside='<limit effort="0" velocity="1"/>'), joint("wrist", "fixed", "arm", "hand"))
    (text,) = mend(body + plugin.format("gz-sim-diff-drive-system"))[1]
    assert "is commanded, but its effort limit is 0: it has no limit" in text
    assert mend(body + plugin.format("gz-sim-joint-state-publisher-system"))[1] == []


def test_joints_with_a_velocity_limit_of_zero_share_a_sentence():
    """Gazebo's physics (DART 6.12) holds such a joint still, also against its weight; without it the joint turns."""
    still = '<limit lower="-1" upper="1" effort="1" velocity="0.0"/>'
    joints = [joint(f"j{index}", "revolute", inside=still) for index in range(8)]
    fixed = joint("mount", "fixed", inside=still)
    root, (repair,) = mend(arm(*joints, fixed, joint("wrist", inside='<limit effort="1" velocity="-1"/>')))
    assert [limit.get("velocity") for limit in root.iter("limit")] == [None] * 8 + ["0.0", "-1"]
    assert repair == (
        "arm.xacro:5: joint j0, j1, j2, j3, j4, j5 and 2 more: the velocity limit is 0, at which Gazebo holds a joint"
        " still: it has no limit [velocity_limit]"
    )


def test_a_velocity_limit_below_zero_is_none_and_said():
    below = '<limit lower="-1" upper="1" effort="1" velocity="-3"/>'
    root, (repair,) = mend(arm(joint("a", "revolute", inside=below), joint("b", "prismatic", inside=below)))
    assert [limit.get("velocity") for limit in root.iter("limit")] == [None, None]
    assert repair.endswith("joint a, b: the velocity limit is -3, below zero: it has no limit [velocity_limit]")


@pytest.mark.parametrize(
    ("joints", "reason"),
    [
        ([joint(inside='<mimic joint="gone"/>')], "mimics 'gone', but the robot has no such joint"),
        ([joint(inside="<mimic/>")], "mimics '', but the robot has no such joint"),
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
    assert f"{reason}: its mimic is removed [mimic]" in repair


@pytest.mark.parametrize(
    ("leader", "reason"), [("gone", "the robot has no such joint"), ("elbow", "it follows itself")]
)
def test_a_follower_of_ros2_control_that_cannot_follow_mimics_nothing(leader, reason):
    parameter = f'<param name="mimic">{leader}</param>'
    follower = f'<ros2_control name="s" type="system">\n<joint name="elbow">{parameter}</joint></ros2_control>'
    root, (repair,) = mend(arm(joint(), joint("wrist", "fixed", "arm", "hand"), follower))
    assert root.find("ros2_control/joint/param") is None
    assert repair == f'arm.xacro:8: <joint name="elbow"> mimics {leader!r}, but {reason}: its mimic is removed [mimic]'


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
