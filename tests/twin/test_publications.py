"""What is published when: each stamp once, at the rates of ros2_control, robot_state_publisher and Gazebo.

The stamps follow by hand from upstream's sources: of Jazzy ``diff_drive_controller.cpp`` (a publication when the last
due time plus the period is before now) and ``controller_manager.cpp`` (the cycle that is closest to a controller's
rate), of Gazebo's plugins (the first step a period or more after the last one) and ``robot_state_publisher.cpp`` (the
first joint states whole milliseconds after the last ones).
"""

from collections import Counter
from dataclasses import replace

import pytest

from drake_twin import Twin, TwinBuilder
from drake_twin.errors import InputError
from drake_twin.scenario import Robot, StaticTransform

WHEEL = """<link name="{name}_wheel"><inertial><mass value="1"/>
    <inertia ixx="1e-2" iyy="1e-2" izz="1e-2" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="{name}" type="continuous"><parent link="base_link"/><child link="{name}_wheel"/>
    <origin xyz="0 {y} 0"/><axis xyz="0 1 0"/></joint>"""
RIG = f"""<robot name="rig"><link name="world"/><link name="base_link"/>
  <joint name="weld" type="fixed"><parent link="world"/><child link="base_link"/><origin xyz="0 0 1"/></joint>
  {WHEEL.format(name="left", y=0.2)}{WHEEL.format(name="right", y=-0.2)}
  {{more}}</robot>"""
HARDWARE = """<ros2_control name="rig" type="system">
    <hardware><plugin>gz_ros2_control/GazeboSimSystem</plugin></hardware>""" + "".join(
    f"""<joint name="{name}"><command_interface name="velocity"/><state_interface name="position"/>
    <state_interface name="velocity"/></joint>"""
    for name in ("left", "right")
)
DRIVE = {
    "left_wheel_names": ["left"],
    "right_wheel_names": ["right"],
    "wheel_separation": 0.4,
    "wheel_radius": 0.1,
    "base_frame_id": "other_base",
}
GZ_DRIVE = """<gazebo><plugin name="drive" filename="gz-sim-diff-drive-system"><left_joint>left</left_joint>
  <right_joint>right</right_joint><child_frame_id>other_base</child_frame_id>{more}</plugin></gazebo>"""
GZ_JOINT_STATES = """<gazebo><plugin name="states" filename="gz-sim-joint-state-publisher-system">{more}
  </plugin></gazebo>"""
BROADCASTER = "joint_state_broadcaster/JointStateBroadcaster"
ODOM = "/rig/drive/odom"


@pytest.fixture
def file(tmp_path):
    def file(more=""):
        (tmp_path / "rig.urdf").write_text(RIG.format(more=more))
        return tmp_path / "rig.urdf"

    return file


@pytest.fixture
def driven(file, tmp_path):
    def driven(cycles=100, **parameters):
        (tmp_path / "rig.yaml").write_text(f"controller_manager:\n  ros__parameters:\n    update_rate: {cycles}\n")
        builder = TwinBuilder().robot(
            "rig", file(f"{HARDWARE}</ros2_control>"), controllers=tmp_path / "rig.yaml", frame_prefix=""
        )
        builder.controller("rig", "drive", "diff_drive_controller/DiffDriveController", DRIVE | parameters)
        return builder.controller("rig", "states", BROADCASTER).build()

    return driven


def stamp(message):
    header = message.transforms[0].header if hasattr(message, "transforms") else message.header
    return header.stamp.sec * 1000 + round(header.stamp.nanosec * 1e-6)  # ms


def stamps(twin, topic, until, rate=None, child=None):
    """The stamps (ms) of a topic's messages in their order; of transforms only those with a child frame."""
    found = []

    def note(message):
        if child is None or child in {item.child_frame_id for item in message.transforms}:
            found.append(stamp(message))

    end = twin.subscribe(topic, note, rate)
    twin.advance_to(until)
    end()
    return found


@pytest.mark.parametrize(
    ("update_rate", "publish_rate", "expected"),
    [
        (100, 50.0, [0, 30, 50, 70, 90, 110]),
        (100, 100.0, [0, 20, 30, 40, 50, 60, 70, 80, 90, 100, 110]),
        (1000, 62.0, [0, 17, 33, 49, 65, 81, 97, 113]),
        (50, 200.0, [0, 20, 40, 60, 80, 100]),
    ],
)
def test_odometry_and_its_transform_are_published_once_a_stamp(driven, update_rate, publish_rate, expected):
    twin = driven(update_rate, publish_rate=publish_rate)
    transforms = []
    twin.subscribe("/tf", transforms.append)
    assert stamps(twin, ODOM, 0.118) == expected
    assert [stamp(item) for item in transforms if item.transforms[0].child_frame_id == "rig/other_base"] == expected


@pytest.mark.parametrize("rate", [None, 1000.0, 333.0])
def test_nobody_gets_a_stamp_twice_whenever_he_comes_and_however_often_he_looks(driven, rate):
    twin = driven(publish_rate=50.0)
    twin.advance_to(0.0573)
    assert stamps(twin, ODOM, 0.118, rate) == [50, 70, 90, 110]
    twin.reset()
    assert stamps(twin, ODOM, 0.06, rate) == [0, 30, 50]


def test_a_listener_who_looks_seldom_gets_what_is_new(driven):
    assert stamps(driven(publish_rate=50.0), ODOM, 1.0, 5.0) == [0, 190, 390, 590, 790]


def test_a_subscription_lasts_over_a_reset(driven):
    twin, found = driven(publish_rate=50.0), []
    twin.subscribe(ODOM, lambda message: found.append(stamp(message)))
    twin.advance_to(0.04)
    twin.reset()
    twin.advance_to(0.04)
    assert found == [0, 30, 0, 30]


@pytest.mark.parametrize(
    ("update_rate", "own", "period"), [(100, 100, 10), (100, 50, 20), (100, 30, 30), (100, 40, 20), (100, 400, 10)]
)
def test_a_controller_is_updated_in_the_cycle_that_is_closest_to_its_rate(driven, update_rate, own, period):
    twin = driven(update_rate, update_rate=own, publish_rate=1000.0)
    assert stamps(twin, ODOM, 0.15) == list(range(0, 150, period))


@pytest.mark.parametrize(
    ("rate", "count", "first"),
    [
        ("", 50, [0, 20, 40, 60]),  # gz's default of 50 Hz
        ("<odom_publish_frequency>30</odom_publish_frequency>", 30, [0, 40, 70, 110]),  # each 34 ms, at updates
        ("<odom_publish_frequency>20</odom_publish_frequency>", 20, [0, 50, 100, 150]),
        ("<odom_publish_frequency>200</odom_publish_frequency>", 200, [0, 5, 10, 15]),
        ("<odom_publish_frequency>0</odom_publish_frequency>", 1000, [0, 1, 2, 3]),
    ],
)
def test_a_drive_of_gz_publishes_at_its_own_rate(file, rate, count, first):
    twin = TwinBuilder().robot("rig", file(GZ_DRIVE.format(more=rate)), frame_prefix="").build()
    found = stamps(twin, "/rig/odometry", 1.0)
    assert found[:4] == first
    assert len(found) == len({*found}) == pytest.approx(count, abs=1)


def test_a_drive_of_gazebo_classic_counts_whole_steps(file):
    plugin = """<gazebo><plugin name="drive" filename="libgazebo_ros_diff_drive.so"><left_joint>left</left_joint>
      <right_joint>right</right_joint><update_rate>30</update_rate><publish_odom>true</publish_odom></plugin></gazebo>"""
    twin = TwinBuilder().robot("rig", file(plugin)).build()
    assert stamps(twin, "/rig/odom", 0.15) == [0, 34, 68, 102, 136]


@pytest.mark.parametrize(
    ("more", "frequency", "period_of_states", "period_of_frames"),
    [
        ("", 20.0, 1, 50),  # gz publishes joint states in each step
        ("<update_rate>30</update_rate>", 20.0, 34, 68),
        ("<update_rate>100</update_rate>", 20.0, 10, 50),
        ("<update_rate>100</update_rate>", 15.0, 10, 70),  # 1000 / 15 is 66 whole milliseconds
        ("<update_rate>10</update_rate>", 20.0, 100, 100),
        ("<update_rate>100</update_rate>", 0.0, 10, 10),
    ],
)
def test_joints_are_on_tf_as_often_as_robot_state_publisher_would(
    file, more, frequency, period_of_states, period_of_frames
):
    model = file(GZ_JOINT_STATES.format(more=more))
    twin = TwinBuilder().robot("rig", model, frame_prefix="", publish_frequency=frequency).build()
    states = []
    twin.subscribe("/rig/joint_states", lambda message: states.append(stamp(message)))
    assert stamps(twin, "/tf", 0.211, child="left_wheel") == list(range(0, 211, period_of_frames))
    assert states == list(range(0, 211, period_of_states))


def test_an_impossible_rate_of_frames_is_refused(file):
    with pytest.raises(InputError, match=r"publish_frequency: 2000 Hz is not a rate from 0 to 1000 Hz"):
        TwinBuilder().robot("rig", file(), publish_frequency=2000.0).build()


def test_a_drive_that_is_spawned_is_heard_by_who_listened_before(file):
    twin = TwinBuilder().robot("other", file()).build()
    found = Counter()
    twin.subscribe("/tf", lambda message: found.update(item.child_frame_id for item in message.transforms))
    twin.advance_to(0.1)
    assert found["other_base"] == 0
    robot = Robot("rig", str(file(GZ_DRIVE.format(more=""))), xyz=(0, 5, 0), frame_prefix="rig/")
    twin.entities.spawn(robot)
    twin.advance_to(0.2)
    assert found["rig/other_base"] == 5
    twin.entities.delete("rig")
    twin.advance_to(0.3)
    assert found["rig/other_base"] == 5


def test_frames_have_no_leading_slash(file):
    """Upstream's robot_state_publisher puts the prefix "/" of turtlebot3 before each name, and tf2 strips it."""
    builder = TwinBuilder().robot("rig", file(GZ_DRIVE.format(more="")), frame_prefix="/")
    scenario = replace(builder.scenario(), static_transforms=(StaticTransform("/map", "/odom"),))
    twin = Twin(scenario)
    twin.advance_to(0.05)
    found = [item for topic in ("/tf", "/tf_static") for item in twin.latest(topic).transforms]
    names = {name for item in found for name in (item.header.frame_id, item.child_frame_id)}
    assert {"map", "odom", "world", "base_link", "left_wheel", "rig/other_base"} <= names
    assert not [name for name in names if name.startswith("/")]


def test_a_robot_without_moving_joints_has_no_joint_states_and_its_true_pose_has_one_publisher(file, tmp_path):
    (tmp_path / "dock.urdf").write_text('<robot name="dock"><link name="dock"/></robot>')
    builder = TwinBuilder().robot("rig", file(), namespace="", frame_prefix="")
    twin = builder.robot("dock", tmp_path / "dock.urdf", namespace="", frame_prefix="").build()
    assert [item.robot for item in twin.built.published.values() if item.topic == "/joint_states"] == ["rig"]
    found = Counter(stamps(twin, "/ground_truth/odom", 0.1))
    assert set(found.values()) == {1}
    assert twin.latest("/dock/ground_truth/odom").child_frame_id == "dock"
