"""Metrics and conditions against closed forms."""

from math import pi, sqrt

import numpy as np
import pytest
from conftest import ARM, ROVER, rovers
from scipy.spatial.transform import Rotation
from sweep_files import write_sweep

from drake_twin import Twin, TwinBuilder
from drake_twin.cli.history import HistoryRecorder, RobotHistory, RunHistory
from drake_twin.errors import InputError
from drake_twin.scenario import Robot, Scenario
from drake_twin.sweeps.metrics import Condition, Metric, has_fallen, is_settled


def history(times, positions=None, velocities=None, efforts=None, places=None):
    times = np.asarray(times, dtype=float)
    zeros = np.zeros((len(times), 1))
    poses = np.zeros((len(times), 7))
    if places is not None:
        poses[:, :2] = places
    columns = [
        zeros if item is None else np.asarray(item, dtype=float).reshape(-1, 1)
        for item in (positions, velocities, efforts)
    ]
    robot = RobotHistory(("j",), ("rad",), times, *columns, base_poses=poses)
    return RunHistory({"r": robot}, np.zeros(0), np.zeros(0))


def value(name, run, messages=None):
    return Metric.parse(name).columns(run, messages or {})[name]


def test_the_distance_is_the_length_of_the_way_on_the_ground():
    angle = np.linspace(0, pi, 500)
    half_circle = history(angle, places=np.stack([2 * np.cos(angle), 2 * np.sin(angle)], axis=1))
    assert value("distance", half_circle) == pytest.approx(2 * pi, rel=1e-5)


def test_the_energy_is_the_work_that_actuators_do_to_and_fro():
    times = np.linspace(0, 2 * pi, 2001)
    swinging = history(times, velocities=np.cos(times), efforts=np.full(2001, 3.0))
    assert value("energy", swinging) == pytest.approx(3 * 4, rel=1e-5)
    assert value("max_effort", history([0, 1, 2], efforts=[1, -5, 2])) == 5


def test_it_is_settled_at_the_first_sample_after_the_last_motion():
    assert value("settled", history([0, 1, 2, 3], velocities=[1, -0.5, 0.001, 0.0])) == 2
    assert value("settled", history([0, 1], velocities=[0, 1])) is None
    assert value("settled", history([0, 1])) == 0


def test_slip_is_what_the_wheels_have_rolled_more_than_the_robot_has_gone(tmp_path):
    """A rover on ice: its odometry counts the wheels' turns."""
    robot = Robot(
        "robot_1",
        ROVER,
        xyz=(0, 0, 0.13),
        controllers=(
            "package://rover_description/config/rover_controllers.yaml",
            "package://rover_description/config/rover_drive.yaml",
        ),
        active_controllers=("joint_state_broadcaster", "drive_controller"),
    )
    scenario = Scenario((robot,), values={"friction": 0.02})
    slips = {}
    for friction in (0.02, 1.0):
        twin = Twin(scenario)
        twin.reset(type(scenario)((robot,), values={"friction": friction}))
        metric = Metric.parse("slip")
        (topic,) = metric.topics(twin)
        recorder, received = HistoryRecorder(), []
        recorder.record(twin)
        twin.subscribe(topic, received.append)
        command = "/robot_1/drive_controller/cmd_vel"
        twin.publish(command, {"twist": {"linear": {"x": 0.5}}})
        twin.advance_to(0.5)
        twin.publish(command, {"twist": {"linear": {"x": 0.5}}})
        twin.advance_to(1.0)
        slips[friction] = metric.columns(recorder.history(), {topic: received})["slip"]
    assert slips[0.02] > 0.2
    assert abs(slips[1.0]) < 0.1


def test_the_tracking_error_is_the_root_mean_square_of_the_controllers_errors(tmp_path):
    (tmp_path / "c.yaml").write_text(
        "controller_manager: {ros__parameters: {arm: {type: joint_trajectory_controller/JointTrajectoryController}}}\n"
        "arm: {ros__parameters: {joints: [joint_1, joint_2], command_interfaces: [position],"
        " state_interfaces: [position, velocity]}}\n"
    )
    twin = TwinBuilder().robot("arm", ARM, controllers=tmp_path / "c.yaml").build()
    metric = Metric.parse("tracking_error")
    (topic,) = metric.topics(twin)
    received = []
    twin.subscribe(topic, received.append)
    point = {"positions": [0.5, 0.2], "time_from_start": 0.5}
    twin.publish("/arm/arm/joint_trajectory", {"joint_names": ["joint_1", "joint_2"], "points": [point]})
    twin.advance_to(1.0)
    squares = [error**2 for message in received for error in message.error.positions]
    found = metric.columns(history([0.0]), {topic: received})["tracking_error"]
    assert found == pytest.approx(sqrt(sum(squares) / len(squares)), rel=1e-12)
    assert 0 < found < 0.2


def test_several_robots_have_a_column_each():
    one = history([0, 1], places=[[0, 0], [1, 0]]).robots["r"]
    two = history([0, 1], places=[[0, 0], [0, 3]]).robots["r"]
    both = RunHistory({"a": one, "b": two}, np.zeros(0), np.zeros(0))
    assert Metric.parse("distance").columns(both, {}) == {"distance.a": 1.0, "distance.b": 3.0}


BOX = """<robot name="box"><link name="box"><inertial><mass value="3"/>
<inertia ixx="0.05" iyy="0.05" izz="0.05" ixy="0" ixz="0" iyz="0"/></inertial>
<collision><geometry><box size="0.2 0.2 0.2"/></geometry></collision></link></robot>"""


@pytest.mark.parametrize(("rpy", "fell"), [((0, 0, 2.0), False), ((0.5, 0, 0), False), ((1.6, 0, 0.3), True)])
def test_a_robot_has_fallen_when_it_lies_on_its_side(tmp_path, rpy, fell):
    (tmp_path / "box.urdf").write_text(BOX)
    twin = TwinBuilder().robot("box", tmp_path / "box.urdf", xyz=(0, 0, 0.5)).build()
    x, y, z, w = Rotation.from_euler("xyz", rpy).as_quat()
    twin.entities.set_state("box", orientation=(w, x, y, z))
    assert has_fallen(twin) is fell


def test_a_robot_that_starts_on_its_side_has_not_fallen(tmp_path):
    (tmp_path / "box.urdf").write_text(BOX)
    twin = TwinBuilder().robot("box", tmp_path / "box.urdf", xyz=(0, 0, 0.5), rpy=(1.2, -0.7, 2.0)).build()
    assert not has_fallen(twin)
    twin.entities.set_state("box", orientation=(1, 0, 0, 0))
    assert has_fallen(twin)


def test_settled_ends_nothing_before_half_a_second():
    twin = rovers(1).build()
    assert not is_settled(twin)
    twin.advance_to(0.6)
    assert is_settled(twin)


def test_a_metric_of_a_file_is_given_the_messages_that_it_names(tmp_path):
    folder = write_sweep(tmp_path)
    metric = Metric.parse(f"{folder}/metrics.py:heard")
    assert metric.name == "heard"
    assert metric.columns(history([0]), {"/hinge/joint_states": [1, 2, 3]}) == {"heard": 3.0}
    assert Metric.parse(f"mine={folder}/metrics.py:heard").name == "mine"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("distanc", "unknown metric. Did you mean 'distance'"),
        ("FOLDER/nothing.py:f", "the file does not exist"),
        ("FOLDER/metrics.py:strat", "has no function 'strat'. Did you mean 'start'"),
        ("FOLDER/broken.py:f", "cannot be imported (SyntaxError"),
        ("x=FOLDER/metrics.py", "it must read FILE.py:FUNCTION"),
    ],
)
def test_a_metric_that_cannot_be_used_is_refused(tmp_path, text, message):
    write_sweep(tmp_path)
    (tmp_path / "broken.py").write_text("def f(:\n")
    with pytest.raises(InputError) as refused:
        Metric.parse(text.replace("FOLDER", str(tmp_path)))
    assert message in str(refused.value)


def test_a_condition_that_is_unknown_is_refused():
    with pytest.raises(InputError, match="Did you mean 'settled'"):
        Condition("setled").call  # noqa: B018


def test_a_metric_that_returns_text_is_refused(tmp_path):
    metric = Metric.parse(f"{write_sweep(tmp_path)}/metrics.py:text")
    with pytest.raises(InputError, match="returns 'fast', which is not a number"):
        metric.columns(history([0]), {})
