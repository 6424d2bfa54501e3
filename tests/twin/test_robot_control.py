"""What a robot's joints do when controllers come, go, stop and fail."""

import pytest
from two_hinges import EFFORT_LIMIT, INERTIA, hinges, trajectories, velocities

from drake_twin import TwinBuilder
from drake_twin.errors import InputError, RunError
from drake_twin.scenario import World
from drake_twin.twin.snapshot import Snapshot
from drake_twin.twin.stepper import Stepper

WHEELS = {"wheels": velocities("left", "right")}


def positions(twin):
    return twin.robot_state("r").positions


def test_a_joint_that_is_pushed_away_with_more_than_its_effort_is_held_where_it_is_left(tmp_path):
    twin = hinges(tmp_path, WHEELS).build()
    twin.publish("/r/wheels/commands", [0.0, 0.0])
    twin.advance_to(0.1)
    torque, seconds = EFFORT_LIMIT + 10.0, 0.5
    twin.entities.apply_wrench("r::right_link", torque=(0.0, 0.0, torque), duration=seconds)
    twin.advance_to(3.0)
    moved = 0.5 * (torque - EFFORT_LIMIT) / INERTIA * seconds**2  # against all of its effort
    assert positions(twin)[1] > 0.9 * moved
    assert positions(twin)[0] == pytest.approx(0.0, abs=1e-6)
    assert twin.robot_state("r").velocities == pytest.approx((0.0, 0.0), abs=1e-6)


def test_a_joint_that_is_pushed_away_with_less_comes_back(tmp_path):
    twin = hinges(tmp_path, WHEELS).build()
    twin.publish("/r/wheels/commands", [0.0, 0.0])
    twin.entities.apply_wrench("r::right_link", torque=(0.0, 0.0, 0.9 * EFFORT_LIMIT), duration=0.5)
    twin.advance_to(3.0)
    assert positions(twin) == pytest.approx((0.0, 0.0), abs=1e-4)


def test_a_joint_that_is_put_elsewhere_stays_there_and_the_others_where_they_are(tmp_path):
    twin = hinges(tmp_path, WHEELS).build()
    twin.publish("/r/wheels/commands", [0.0, 0.0])
    twin.advance_to(0.1)
    twin.entities.set_joint_positions("r", {"right": 2.0})
    twin.entities.apply_wrench("r::left_link", torque=(0.0, 0.0, 0.5 * EFFORT_LIMIT), duration=0.2)
    twin.advance_to(2.0)
    assert positions(twin) == pytest.approx((0.0, 2.0), abs=1e-3)


@pytest.mark.parametrize("way", [1e-5, 1e-4, 1e-3, 1e-2])
def test_a_joint_that_is_put_a_little_aside_is_not_pulled_back(tmp_path, way):
    twin = hinges(tmp_path, WHEELS).build()
    twin.publish("/r/wheels/commands", [0.0, 0.0])
    twin.advance_to(0.1)
    twin.entities.set_joint_positions("r", {"right": way})
    twin.advance_to(1.0)
    assert positions(twin) == pytest.approx((0.0, way), abs=0.01 * way)


def test_a_step_that_fails_leaves_the_joints_driven_as_before_whatever_was_commanded(tmp_path, monkeypatch):
    """Of two messages each one changes how a joint is driven; both are taken back."""
    twin = hinges(tmp_path, {"one": velocities("left"), "two": velocities("right")}).build()
    twin.advance_to(0.1)
    twin.publish("/r/one/commands", [1.0])
    twin.publish("/r/two/commands", [2.0])
    before, advance = twin.state_sha256(), Stepper._advance_simulator

    def raise_error(self, step):
        raise RuntimeError("the solver did not converge")

    monkeypatch.setattr(Stepper, "_advance_simulator", raise_error)
    with pytest.raises(RunError, match="did not converge"):
        twin.advance_to(1.0)
    assert twin.state_sha256() == before
    monkeypatch.setattr(Stepper, "_advance_simulator", advance)
    twin.advance_to(1.0)
    assert twin.robot_state("r").velocities == pytest.approx((1.0, 2.0), rel=1e-3)


def test_a_stop_is_saved(tmp_path):
    twin = hinges(tmp_path, WHEELS).build()
    twin.publish("/r/wheels/commands", [1.0, 1.0])
    twin.advance_to(0.5)
    twin.control.emergency_stop("r")
    other = hinges(tmp_path, WHEELS).build()
    other.restore(twin.snapshot())
    for each in (twin, other):
        each.advance_to(2.0)
        assert each.robot_state("r").velocities == pytest.approx((0.0, 0.0), abs=1e-6)
    assert twin.state_sha256() == other.state_sha256()
    other.control.clear_emergency_stop("r")
    other.publish("/r/wheels/commands", [1.0, 1.0])


def test_samples_of_other_controllers_are_refused(tmp_path):
    twin = hinges(tmp_path, {"arm": trajectories("left", "right")}).build()
    saved = vars(twin.snapshot())
    robot = saved["robots"]["r"]
    for samples in ({}, robot["samples"] | {"other": robot["samples"]["arm"]}):
        spoilt = saved | {"robots": {"r": robot | {"samples": samples}}}
        with pytest.raises(InputError, match="samples of arm are needed"):
            twin.restore(Snapshot(**spoilt))
    twin.restore(Snapshot(**saved))


def test_a_stop_ends_a_goal_and_its_controller_goes_on_to_nowhere_once_it_is_cleared(tmp_path):
    twin = hinges(tmp_path, {"arm": trajectories("left", "right")}).build()
    points = [{"positions": [3.0, 0.0], "time_from_start": 1.0}]
    goal = {"trajectory": {"joint_names": ["left", "right"], "points": points}}
    sent = twin.graph.send_goal("/r/arm/follow_joint_trajectory", goal)
    twin.advance_to(0.5)
    twin.control.emergency_stop("r")
    assert sent.status == "canceled"
    twin.advance_to(1.5)
    stopped = positions(twin)
    assert stopped[0] == pytest.approx(1.5, abs=0.1)  # where it was, and the way to rest
    twin.control.clear_emergency_stop("r")
    twin.advance_to(4.0)
    assert positions(twin) == pytest.approx(stopped, abs=0.1)
    assert twin.robot_state("r").velocities == pytest.approx((0.0, 0.0), abs=1e-6)
    assert twin.control.manager("r").active == ("arm",)


def test_an_arm_that_has_braked_is_held_against_gravity_where_it_came_to_rest(tmp_path):
    file = tmp_path / "pendulum.urdf"
    file.write_text(
        """<robot name="pendulum"><link name="world"/><link name="rod"><inertial><origin xyz="1 0 0"/><mass value="2"/>
        <inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial></link>
        <joint name="hinge" type="continuous"><parent link="world"/><child link="rod"/><axis xyz="0 1 0"/>
        <limit effort="60" velocity="20"/></joint>
        <ros2_control name="s" type="system"><hardware><plugin>gz_ros2_control/GazeboSimSystem</plugin></hardware>
        <joint name="hinge"><command_interface name="velocity"/><state_interface name="position"/></joint>
        </ros2_control></robot>"""
    )
    controllers = tmp_path / "controllers.yaml"
    controllers.write_text(
        "controller_manager: {ros__parameters: {v: {type: velocity_controllers/JointGroupVelocityController}}}\n"
        "v: {ros__parameters: {joints: [hinge]}}\n"
    )
    builder = TwinBuilder(world=World(ground=False))
    builder.robot("r", file, controllers=controllers)
    twin = builder.build()
    twin.publish("/r/v/commands", [-1.0])
    twin.advance_to(0.3)
    twin.control.emergency_stop("r")
    while abs(twin.robot_state("r").velocities[0]) > 0.01:
        twin.step()
    rest = positions(twin)
    twin.advance_to(20.0)
    assert positions(twin) == pytest.approx(rest, abs=1e-4)
