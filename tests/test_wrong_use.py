"""What people do to a twin that nobody meant: each mistake is told in a sentence, and changes nothing else."""

import numpy as np
import pytest
from conftest import rovers

from drake_twin import TwinBuilder, messages
from drake_twin.errors import CommandError, InputError
from drake_twin.twin.controller_manager import STRICT

INERTIAL = '<inertial><mass value="1"/><inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial>'
JOINTS = "".join(
    f'<link name="link_{name}">{INERTIAL}</link><joint name="{name}" type="revolute"><parent link="base"/>'
    f'<child link="link_{name}"/><axis xyz="0 0 1"/><limit lower="-3" upper="3" velocity="5" effort="50"/></joint>'
    for name in "ab"
)
INTERFACES = "".join(
    f'<joint name="{name}"><command_interface name="position"/><command_interface name="velocity"/>'
    '<command_interface name="effort"/><state_interface name="position"/><state_interface name="velocity"/></joint>'
    for name in "ab"
)
ROBOT = (
    '<robot name="robot"><link name="world"/><link name="base"/>'
    '<joint name="fixed" type="fixed"><parent link="world"/>'
    f'<child link="base"/></joint>{JOINTS}<ros2_control name="system" type="system"><hardware>'
    f"<plugin>gz_ros2_control/GazeboSimSystem</plugin></hardware>{INTERFACES}</ros2_control></robot>"
)
CONTROLLERS = """controller_manager:
  ros__parameters:
    trajectories: {type: joint_trajectory_controller/JointTrajectoryController}
    velocities: {type: velocity_controllers/JointGroupVelocityController}
    gripper: {type: position_controllers/GripperActionController}
    base: {type: diff_drive_controller/DiffDriveController}
trajectories:
  ros__parameters: {joints: [a, b], command_interfaces: [position], state_interfaces: [position, velocity]}
velocities:
  ros__parameters: {joints: [a, b]}
gripper:
  ros__parameters: {joint: a}
base:
  ros__parameters: {left_wheel_names: [a], right_wheel_names: [b], wheel_separation: 0.4, wheel_radius: 0.1}
"""
VELOCITIES, TRAJECTORY = "/r/velocities/commands", "/r/trajectories/joint_trajectory"
ACTION, GRIPPER = "/r/trajectories/follow_joint_trajectory", "/r/gripper/gripper_cmd"


@pytest.fixture
def make(tmp_path):
    def make(*active, controllers=CONTROLLERS, **options):
        (tmp_path / "robot.urdf").write_text(ROBOT)
        (tmp_path / "controllers.yaml").write_text(controllers)
        names = ("trajectories", "velocities", "gripper", "base")
        return (
            TwinBuilder()
            .robot(
                "r",
                tmp_path / "robot.urdf",
                controllers=tmp_path / "controllers.yaml",
                active_controllers=active or None,
                inactive_controllers=[name for name in names if active and name not in active],
                **options,
            )
            .build()
        )

    return make


def trajectory(a=0.5, b=0.2, duration=1.0, **header):
    return {"joint_names": ["a", "b"], "points": [{"positions": [a, b], "time_from_start": duration}], **header}


def positions(twin):
    return np.array(twin.robot_state("r").positions)


@pytest.mark.parametrize(
    "data",
    [None, 1.0, True, "ab", [[1, 2]], np.ones((1, 2)), [True, False], [1j, 2], {1.0, 2.0}, [10**400, 0], object()],
)
def test_what_is_no_list_of_numbers_is_refused_and_the_controller_stays_active(make, data):
    twin = make("velocities")
    with pytest.raises(CommandError, match=r"/r/velocities/commands: .* is not a list of numbers"):
        twin.publish(VELOCITIES, data)
    assert twin.control.manager("r").active == ("velocities",)
    twin.step(5)


@pytest.mark.parametrize(
    ("data", "message"),
    [
        ({"Data": [1, 2]}, "has no field Data; it has layout, data"),
        ({"data": [1, "x"]}, r"data\[1\]: 'x' is not a float64"),
        ({"data": {"a": 1}}, "data: {'a': 1} is not a list"),
        ({"data": 1}, "data: 1 is not a list"),
    ],
)
def test_a_wrong_field_is_named(make, data, message):
    with pytest.raises(CommandError, match=message):
        make("velocities").publish(VELOCITIES, data)


def test_a_message_with_a_million_numbers_too_many_is_not_printed_whole(make):
    twin = make("velocities", "trajectories")
    with pytest.raises(CommandError) as caught:
        twin.publish(TRAJECTORY, [0.0] * 1_000_000)
    assert len(str(caught.value)) < 300
    with pytest.raises(CommandError, match="has 1000000 elements") as caught:
        twin.publish(VELOCITIES, [0.0] * 1_000_000)
    assert len(str(caught.value)) < 300


def twist(linear, angular=None):
    return messages.Twist(linear=linear, angular=angular or messages.Vector3(x=0.0, y=0.0, z=0.0))


@pytest.mark.parametrize(
    ("field", "message"),
    [
        ({"twist": 5}, "twist: 5 is not a mapping of the fields of a geometry_msgs/msg/Twist"),
        ({"twist": "header"}, "twist: this is a std_msgs/msg/Header, but a geometry_msgs/msg/Twist is needed"),
        ({"linear": "x"}, "twist.linear.x: 'x' is not a float64"),
        ({"stamp": float("nan")}, "header.stamp: nan is not a time"),
        ({"stamp": float("inf")}, "header.stamp: inf is not a time"),
        ({"stamp": {"sec": 2**40}}, "header.stamp.sec: 1099511627776 is not a int32"),
        ({"stamp": {"sec": 0.5}}, "header.stamp.sec: 0.5 is not a int32"),
        ({"stamp": "now"}, "header.stamp: 'now' is not a mapping"),
    ],
)
def test_a_ros_message_with_something_wrong_inside_is_refused_with_the_place(make, field, message):
    twin = make("base")
    header = messages.header(0.0)
    value = twist(messages.Vector3(x=field.get("linear", 0.1), y=0.0, z=0.0))
    if "twist" in field:
        value = header if field["twist"] == "header" else field["twist"]
    if "stamp" in field:
        header = messages.Header(stamp=field["stamp"], frame_id="")
    with pytest.raises(CommandError, match=message):
        twin.publish("/r/base/cmd_vel", messages.TwistStamped(header=header, twist=value))
    twin.step(30)
    assert twin.control.manager("r").active == ("base",)


def test_a_published_message_is_a_copy(make):
    twin = make("velocities")
    message = messages.float64_multi_array([1.0, 2.0])
    twin.publish(VELOCITIES, message)
    message.data[:] = np.nan
    twin.advance_to(0.5)
    assert twin.robot_state("r").velocities == pytest.approx([1.0, 2.0], rel=1e-3)


@pytest.mark.parametrize("name", [None, 1, [], {}, "/nope"])
def test_a_topic_or_robot_of_any_type_that_does_not_exist_is_told_with_those_that_do(make, name):
    twin = make("velocities")
    for call in (
        twin.graph.command,
        twin.graph.silence,
        twin.graph.command_limits,
        lambda topic: twin.publish(topic, [0, 0]),
    ):
        with pytest.raises(InputError, match=r"nothing listens to .*Valid: .*/r/velocities/commands"):
            call(name)
    for call in (twin.latest, lambda topic: twin.subscribe(topic, print)):
        with pytest.raises(InputError, match=r"nothing is published on .*Valid: /r/joint_states"):
            call(name)
    with pytest.raises(InputError, match=r"unknown action .*Valid: /r/trajectories/follow_joint_trajectory"):
        twin.graph.send_goal(name, {})
    for call in (twin.control.manager, twin.control.emergency_stop, twin.robot_state):
        with pytest.raises(InputError, match=r"unknown robot .*Valid: r"):
            call(name)


@pytest.mark.parametrize("value", [None, "1", [], float("nan"), 10**400, 1j])
def test_what_is_no_number_is_refused_wherever_one_is_needed(make, value):
    twin = make("velocities")
    with pytest.raises(InputError, match="is not a finite number"):
        twin.entities.set_joint_positions("r", {"a": value})
    with pytest.raises(InputError, match="is not a mapping of joints"):
        twin.entities.set_joint_positions("r", value)
    with pytest.raises(InputError, match="is not a simulation time"):
        twin.advance_to(value)
    with pytest.raises(InputError, match="is not a real-time rate"):
        twin.clock.real_time_rate = value
    if value is not None:
        with pytest.raises(InputError, match="invalid rate"):
            twin.subscribe("/clock", print, rate=value)
    with pytest.raises(InputError, match="cannot be called"):
        twin.subscribe("/clock", value)
    assert twin.advance_to(0.1) == pytest.approx(0.1)


def test_a_joint_that_a_trajectory_does_not_have_is_told_with_those_that_it_has(make):
    wrong = trajectory() | {"joint_names": ["a", "bb"]}
    twin = make("trajectories")
    for call in (lambda: twin.publish(TRAJECTORY, wrong), lambda: twin.graph.send_goal(ACTION, {"trajectory": wrong})):
        with pytest.raises(CommandError, match=r"an unknown joint 'bb'\. Did you mean 'b'. Valid: a, b"):
            call()


@pytest.mark.parametrize("name", [None, 5, [], {}, b"velocities", ["velocities"], object()])
def test_the_controller_manager_answers_whatever_it_is_asked(make, name):
    manager = make("velocities").control.manager("r")
    for call in (manager.load_controller, manager.configure_controller, manager.unload_controller):
        assert not call(name)
        assert call(name).message
    assert not manager.switch_controller([name], strictness=STRICT)
    assert not manager.switch_controller(["gripper"], strictness=name)
    manager.switch_controller(name, name, start=name, stop=name)
    assert manager.active == ("velocities",)


# Goals


def test_of_several_goals_sent_at_once_the_last_one_is_done_and_the_others_are_told_so(make):
    twin, told = make("trajectories"), []
    goals = [twin.graph.send_goal(ACTION, {"trajectory": trajectory(0.1 * i)}, told.append) for i in range(4)]
    assert [goal.status for goal in goals] == ["aborted", "aborted", "aborted", "accepted"]
    twin.advance_to(1.5)
    assert [goal.status for goal in goals] == ["aborted", "aborted", "aborted", "succeeded"]
    assert told == goals
    assert positions(twin)[0] == pytest.approx(0.3, abs=1e-3)


@pytest.mark.parametrize(
    ("controller", "action", "goal"),
    [
        ("trajectories", ACTION, {"trajectory": trajectory()}),
        ("gripper", GRIPPER, {"command": {"position": 0.5, "max_effort": 1.0}}),
    ],
)
def test_a_goal_that_is_cancelled_before_the_next_step_never_moves_the_robot(make, controller, action, goal):
    twin, told = make(controller), []
    sent = twin.graph.send_goal(action, goal, told.append)
    sent.cancel()
    assert sent.status == "canceled"
    twin.advance_to(1.5)
    assert sent.status == "canceled"
    assert told == [sent]
    assert positions(twin) == pytest.approx([0, 0], abs=1e-3)


@pytest.mark.parametrize(
    ("controller", "action", "goal"),
    [
        ("trajectories", ACTION, {"trajectory": trajectory()}),
        ("gripper", GRIPPER, {"command": {"position": 0.5, "max_effort": 1.0}}),
    ],
)
def test_a_goal_whose_controller_is_deactivated_before_the_next_step_comes_to_its_end(make, controller, action, goal):
    twin, told = make(controller), []
    sent = twin.graph.send_goal(action, goal, told.append)
    assert twin.control.manager("r").switch_controller(deactivate=[controller])
    assert sent.is_done
    twin.step(30)
    assert told == [sent]
    assert twin.control.manager("r").switch_controller(activate=[controller])
    twin.advance_to(1.0)
    assert positions(twin) == pytest.approx([0, 0], abs=1e-3)


def test_a_goal_after_a_trajectory_on_the_topic_takes_its_place(make):
    twin = make("trajectories")
    twin.publish(TRAJECTORY, trajectory(-0.5, -0.5))
    goal = twin.graph.send_goal(ACTION, {"trajectory": trajectory(0.3, 0.1)})
    twin.advance_to(1.5)
    assert goal.status == "succeeded"
    assert positions(twin) == pytest.approx([0.3, 0.1], abs=1e-3)


def test_an_emergency_stop_cancels_the_goal_instead_of_letting_it_succeed_without_moving(make):
    twin = make("trajectories")
    goal = twin.graph.send_goal(ACTION, {"trajectory": trajectory()})
    twin.step(300)
    twin.control.emergency_stop("r")
    twin.advance_to(2.0)
    assert goal.status == "canceled"
    assert positions(twin)[0] < 0.3
    there = positions(twin)
    twin.control.clear_emergency_stop("r")
    twin.advance_to(3.0)
    assert positions(twin) == pytest.approx(there, abs=1e-3)


def test_a_result_that_nobody_can_be_told_is_refused_at_once(make):
    with pytest.raises(InputError, match="5 cannot be called with the goal"):
        make("trajectories").graph.send_goal(ACTION, {"trajectory": trajectory()}, 5)


# Parameters files


def forward(parameters="{joints: [a], interface_name: velocity}", name="c", kind=None):
    kind = kind or "forward_command_controller/ForwardCommandController"
    manager = f"controller_manager:\n  ros__parameters:\n    {name}: {{type: {kind}}}\n"
    return manager + f"{name}:\n  ros__parameters: {parameters}\n"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (forward("{joints: [a], interface_name: velocity, update_rate: .nan}"), r"yaml:5: .*nan is not a rate \(Hz\)"),
        (forward("{joints: [a], interface_name: velocity, update_rate: .inf}"), r"yaml:5: .*inf is not a rate \(Hz\)"),
        (forward("{joints: [a], interface_name: velocity, command_timeout: .nan}"), "yaml:5: .*nan is not a number"),
        (forward(kind="5"), "yaml:3: .*5 is not a controller's type"),
        (forward(name="7"), "yaml:3: .*7 is not a controller's name"),
        (forward().rpartition("c:\n")[0], "yaml:3: .*the parameter 'joints' is missing"),
        (
            forward(
                "{joints: [a], command_interfaces: [velocity], state_interfaces: [position]}",
                kind="joint_trajectory_controller/JointTrajectoryController",
            ),
            "yaml:5: .*velocity need the state interface 'velocity'",
        ),
    ],
)
def test_a_mistake_in_a_parameters_file_is_told_with_its_line(make, text, message):
    with pytest.raises(InputError, match=message):
        make(controllers=text)


@pytest.mark.parametrize(
    "text", ["", "controller_manager:\n  c: {type: a/B}\n", "controller_manager: {ros_parameters: {}}"]
)
def test_a_parameters_file_without_controllers_is_told(make, text):
    (warning,) = make(controllers=text).findings.warnings
    assert "controllers.yaml: no controllers found for the namespace '/r'" in warning


@pytest.mark.parametrize("name", ["joint_servo", "joint_state_publisher", "robot_state_publisher"])
def test_a_controller_may_have_the_name_of_one_of_the_twins_own_systems(make, name):
    twin = make(controllers=forward(name=name))
    twin.publish(f"/r/{name}/commands", [1.0])
    twin.advance_to(0.3)
    assert twin.robot_state("r").velocities[0] == pytest.approx(1.0, rel=1e-3)


def test_a_timeout_without_end_is_none(make):
    drive = (
        "{left_wheel_names: [a], right_wheel_names: [b], wheel_separation: 1, wheel_radius: 1, cmd_vel_timeout: .inf}"
    )
    for kind, parameters, topic, command in (
        (None, "{joints: [a], interface_name: velocity, command_timeout: .inf}", "commands", [1.0]),
        ("diff_drive_controller/DiffDriveController", drive, "cmd_vel", {"twist": {"linear": {"x": 1.0}}}),
    ):
        twin = make(controllers=forward(parameters, kind=kind))
        twin.publish(f"/r/c/{topic}", command)
        twin.advance_to(1.5)
        assert twin.robot_state("r").velocities[0] == pytest.approx(1.0, rel=1e-3)


@pytest.mark.parametrize("rate", [0.0, -1.0, 1e7, 1e308, float("inf"), float("nan")])
def test_a_real_time_rate_that_no_clock_keeps_is_refused(rate):
    twin = rovers(1).build()
    with pytest.raises(InputError, match=r"is not a real-time rate: it must be above zero and at most 1e\+06"):
        twin.clock.real_time_rate = rate
    twin.clock.real_time_rate = 1e6
    twin.run(0.02, each_frame=lambda: True)
    assert twin.time == pytest.approx(0.02)


def test_a_push_can_last_as_long_as_time_itself():
    twin = rovers(1).build()
    twin.entities.apply_wrench("robot_1", force=(0, 0, 1.0), duration=1e308)
    twin.advance_to(0.05)
    twin.clock.set_time_step(0.01)
    twin.advance_to(0.1)
    assert twin.time == pytest.approx(0.1)
