"""Each row of ros2_control's behaviour that the twin imitates, on robots small enough to calculate by hand."""

import logging
from dataclasses import dataclass, replace

import numpy as np
import pytest

from drake_twin import TwinBuilder
from drake_twin.controllers.interface import Interface
from drake_twin.controllers.periodic_controller import PeriodicController, Update
from drake_twin.controllers.registry import controller
from drake_twin.errors import CommandError, InputError
from drake_twin.twin.controller_manager import BEST_EFFORT, FORCE_AUTO, STRICT

ROBOT = """<robot name="robot">
  <link name="base"/>
  <link name="one"><inertial><origin xyz="0.5 0 0"/><mass value="2"/>
    <inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <link name="two"><inertial><mass value="1"/>
    <inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <link name="three"><inertial><mass value="1"/>
    <inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="fixed" type="fixed"><parent link="world"/><child link="base"/></joint>
  <joint name="arm" type="revolute"><parent link="base"/><child link="one"/><axis xyz="0 1 0"/>
    <limit lower="-2" upper="2" velocity="3" effort="100"/></joint>
  <joint name="wheel" type="continuous"><parent link="base"/><child link="two"/><axis xyz="0 0 1"/>
    <limit velocity="20" effort="50"/></joint>
  <joint name="finger" type="revolute"><parent link="base"/><child link="three"/><axis xyz="0 0 1"/>
    <limit lower="-3" upper="3" velocity="20" effort="50"/>
    {mimic}</joint>
  <link name="world"/>
  <ros2_control name="system" type="system">
    <hardware><plugin>gz_ros2_control/GazeboSimSystem</plugin></hardware>
    <joint name="arm">
      <command_interface name="position"><param name="min">-1</param><param name="max">1</param></command_interface>
      <command_interface name="velocity"/><command_interface name="effort"/>
      <state_interface name="position"><param name="initial_value">0.5</param></state_interface>
      <state_interface name="velocity"/></joint>
    <joint name="wheel">
      <command_interface name="velocity"/><command_interface name="position"/>
      <state_interface name="velocity"/></joint>
    <joint name="finger"><command_interface name="effort"/>
      <state_interface name="position"/><state_interface name="effort"/></joint>
  </ros2_control>
</robot>"""

CONTROLLERS = """controller_manager:
  ros__parameters:
    broadcaster: {{type: joint_state_broadcaster/JointStateBroadcaster}}
    positions: {{type: position_controllers/JointGroupPositionController}}
    velocities: {{type: velocity_controllers/JointGroupVelocityController}}
    efforts: {{type: effort_controllers/JointGroupEffortController}}
    both: {{type: forward_command_controller/MultiInterfaceForwardCommandController}}
    {more_types}
positions: {{ros__parameters: {{joints: [arm]}}}}
velocities: {{ros__parameters: {{joints: [arm, wheel]{velocity_parameters}}}}}
efforts: {{ros__parameters: {{joints: [finger]}}}}
both: {{ros__parameters: {{joint: arm, interface_names: [position, velocity]}}}}
{more}
"""


@pytest.fixture
def make(tmp_path):
    def make(*active, inactive=(), mimic="", more_types="", more="", velocity_parameters="", **options):
        robot, controllers = tmp_path / "robot.urdf", tmp_path / "controllers.yaml"
        robot.write_text(ROBOT.format(mimic=mimic))
        controllers.write_text(
            CONTROLLERS.format(more_types=more_types, more=more, velocity_parameters=velocity_parameters)
        )
        builder = TwinBuilder(**options)
        return builder.robot(
            "r",
            robot,
            controllers=controllers,
            active_controllers=("broadcaster", *active),
            inactive_controllers=inactive,
        ).build()

    return make


def position(twin, joint):
    state = twin.robot_state("r")
    return state.positions[state.joints.index(joint)]


def velocity(twin, joint):
    state = twin.robot_state("r")
    return state.velocities[state.joints.index(joint)]


def states(twin):
    return {item.name: item.state for item in twin.control.manager("r").list_controllers()}


# Forward command controllers


def test_before_the_first_message_a_position_is_held_a_wheel_stands_and_an_effort_is_zero(make):
    twin = make("positions", "efforts")
    twin.advance_to(2.0)
    assert position(twin, "arm") == pytest.approx(0.5, abs=1e-3)
    assert velocity(twin, "wheel") == pytest.approx(0, abs=1e-9)
    efforts = dict(zip(twin.robot_state("r").joints, twin.robot_state("r").efforts, strict=True))
    assert efforts["finger"] == pytest.approx(0, abs=1e-6)


def test_each_command_interface_does_what_it_is_named_after(make):
    twin = make("positions", "velocities", "efforts")  # arm/position and arm/velocity are two interfaces
    assert states(twin) == dict.fromkeys(("broadcaster", "positions", "velocities", "efforts"), "active")
    twin.publish("/r/velocities/commands", [0.2, 3.0])
    twin.publish("/r/efforts/commands", [0.25])
    twin.advance_to(1.0)
    assert velocity(twin, "wheel") == pytest.approx(3.0, rel=1e-3)
    assert velocity(twin, "arm") == pytest.approx(0.2, rel=5e-3)
    # a constant torque on 0.1 kg·m²: 2.5 rad/s² (the discrete step adds half a millisecond's worth)
    assert velocity(twin, "finger") == pytest.approx(2.5, rel=2e-3)
    assert position(twin, "finger") == pytest.approx(1.25, rel=2e-3)


def test_a_message_of_the_wrong_size_is_an_error_writes_nothing_and_deactivates(make, caplog):
    twin = make("velocities")
    twin.publish("/r/velocities/commands", [0, 3])
    twin.advance_to(0.5)
    with pytest.raises(CommandError, match=r"/r/velocities/commands: the command has 1 elements.*arm/vel.*wheel/vel"):
        twin.publish("/r/velocities/commands", [5])
    assert states(twin)["velocities"] == "inactive"
    assert "controller velocities is deactivated: /r/velocities/commands: the command has 1 elements" in caplog.text
    twin.advance_to(3.0)
    assert velocity(twin, "wheel") == pytest.approx(0, abs=1e-3)


@pytest.mark.parametrize("bad", [float("nan"), float("inf")])
def test_a_message_with_an_element_that_is_not_finite_is_dropped_whole(make, bad):
    twin = make("velocities")
    twin.publish("/r/velocities/commands", [0, 3])
    with pytest.raises(CommandError, match="which is not a finite number"):
        twin.publish("/r/velocities/commands", [bad, 5])
    twin.advance_to(0.5)
    assert velocity(twin, "wheel") == pytest.approx(3, rel=1e-3)
    assert states(twin)["velocities"] == "active"


def test_a_message_while_inactive_is_ignored_also_after_the_activation(make):
    twin = make(inactive=("velocities",))
    twin.publish("/r/velocities/commands", [0, 3])
    assert twin.control.manager("r").switch_controller(activate=["velocities"])
    twin.advance_to(0.5)
    assert velocity(twin, "wheel") == pytest.approx(0, abs=1e-9)


def test_reactivation_begins_at_zero_velocity_until_a_new_command(make):
    twin = make("velocities")
    manager = twin.control.manager("r")
    twin.publish("/r/velocities/commands", [0, 3])
    twin.advance_to(0.5)
    manager.switch_controller(deactivate=["velocities"])
    twin.advance_to(1.5)
    manager.switch_controller(activate=["velocities"])
    twin.advance_to(2.0)
    assert velocity(twin, "wheel") == pytest.approx(0, abs=1e-3)
    twin.publish("/r/velocities/commands", [0, 2])
    twin.advance_to(2.5)
    assert velocity(twin, "wheel") == pytest.approx(2, rel=1e-3)


def test_a_command_timeout_brings_the_velocity_to_zero(make):
    twin = make("velocities", velocity_parameters=", command_timeout: 0.5")
    twin.publish("/r/velocities/commands", [0, 3])
    twin.advance_to(0.4)
    twin.publish("/r/velocities/commands", [0, 3])
    twin.advance_to(0.85)
    assert velocity(twin, "wheel") == pytest.approx(3, rel=1e-3)
    twin.advance_to(1.2)
    assert velocity(twin, "wheel") == pytest.approx(0, abs=1e-3)
    assert make("velocities").graph.command("/r/velocities/commands") is None


# joint_state_broadcaster


def test_joint_states_are_published_only_while_their_broadcaster_is_active(make):
    twin = make()
    seen = []
    twin.subscribe("/r/joint_states", lambda message: seen.append(message.header.stamp.nanosec), rate=10)
    twin.advance_to(0.25)
    twin.control.manager("r").switch_controller(deactivate=["broadcaster"])
    twin.advance_to(0.55)
    assert twin.joint_states("r") is None
    twin.control.manager("r").switch_controller(activate=["broadcaster"])
    twin.advance_to(0.75)
    assert [stamp // 1_000_000 for stamp in seen] == [0, 100, 200, 600, 700]


def test_joints_come_in_the_order_of_ros2_control_with_nan_for_what_is_not_measured(make):
    message = make().joint_states("r")
    assert message.name == ["arm", "wheel", "finger"]
    assert np.isnan(message.position[1])
    assert np.isnan(message.velocity[2])
    assert np.isnan(message.effort[:2]).all()
    assert not np.isnan([message.position[0], message.position[2], message.effort[2]]).any()


# The controller manager


def test_a_second_claim_of_an_interface_is_a_resource_conflict(make):
    twin = make("positions", inactive=("both",))
    manager = twin.control.manager("r")
    for strictness in (STRICT, BEST_EFFORT):  # controller_manager.cpp:4377
        response = manager.switch_controller(activate=["both"], strictness=strictness)
        assert not response
        assert "resource conflict for controller 'both': command interface arm/position is already" in response.message
        assert states(twin)["both"] == "inactive"
    assert manager.switch_controller(activate=["both"], deactivate=["positions"], strictness=STRICT)
    assert manager.switch_controller(activate=["positions"], strictness=FORCE_AUTO)
    assert (states(twin)["both"], states(twin)["positions"]) == ("inactive", "active")


def test_strict_switches_all_or_nothing_and_best_effort_what_it_can(make):
    twin = make(inactive=("positions", "efforts"))
    manager = twin.control.manager("r")
    response = manager.switch_controller(activate=["positions", "nobody"], strictness=STRICT)
    assert (response.ok, states(twin)["positions"]) == (False, "inactive")
    assert "controller 'nobody' is not loaded; loaded controllers: broadcaster, positions, efforts" in response.message
    response = manager.switch_controller(start=["positions", "nobody"], stop=["efforts"], strictness=BEST_EFFORT)
    assert (response.ok, states(twin)["positions"]) == (True, "active")
    assert "'nobody'" in response.message
    assert "controller 'efforts' is not active" in response.message


def test_a_controller_goes_through_its_life_cycle(make):
    manager = make().control.manager("r")
    assert not manager.configure_controller("positions")
    assert manager.load_controller("positions")
    assert "already loaded" in manager.load_controller("positions").message
    assert "unconfigured" in manager.switch_controller(activate=["positions"]).message
    assert manager.configure_controller("positions")
    assert manager.switch_controller(activate=["positions"])
    assert "is active" in manager.unload_controller("positions").message
    assert manager.switch_controller(deactivate=["positions"])
    assert manager.unload_controller("positions")
    assert "no controller 'x'; they have broadcaster, positions" in manager.load_controller("x").message


def test_an_interface_that_does_not_exist_refuses_the_activation(make):
    more = "wrong: {ros__parameters: {joints: [finger]}}"
    twin = make(more_types="wrong: {type: velocity_controllers/JointGroupVelocityController}", more=more)
    manager = twin.control.manager("r")
    manager.load_controller("wrong")
    message = manager.configure_controller("wrong").message
    assert "joint finger has no velocity command interface in <ros2_control> (it has effort)" in message


def test_hardware_interfaces_and_components_are_listed_as_ros2_control_does(make):
    manager = make("velocities").control.manager("r")
    commands, sensed = manager.list_hardware_interfaces()
    claimed = {item.name for item in commands if item.is_claimed}
    assert claimed == {"arm/velocity", "wheel/velocity"}
    assert [item.name for item in commands][:3] == ["arm/position", "arm/velocity", "arm/effort"]
    assert "finger/effort" in {item.name for item in sensed}
    (component,) = manager.list_hardware_components()
    assert (component.name, component.state) == ("system", "active")
    assert component.plugin == "gz_ros2_control/GazeboSimSystem"
    assert "velocity_controllers/JointGroupVelocityController" in manager.list_controller_types()


def test_a_switch_while_paused_acts_with_the_next_step_and_keeps_every_other_state(make):
    twin = make("velocities", inactive=("positions",))
    twin.publish("/r/velocities/commands", [0, 3])
    twin.advance_to(0.5)
    twin.pause()
    before = replace(twin.robot_state("r"), efforts=())
    assert twin.control.manager("r").switch_controller(activate=["positions"], deactivate=["velocities"])
    assert replace(twin.robot_state("r"), efforts=()) == before  # efforts are those of the step to come
    twin.step()
    assert velocity(twin, "wheel") < 3
    twin.play()
    twin.advance_to(3.0)
    assert velocity(twin, "wheel") == pytest.approx(0, abs=1e-4)


@dataclass(frozen=True)
class RampParameters:
    """No parameters."""


@controller("test/Ramp")
class Ramp(PeriodicController):
    """Writes a velocity that grows by one at each update, and fails at the eleventh."""

    Parameters = RampParameters

    @classmethod
    def claimed_interfaces(cls, parameters, description):
        return (Interface("wheel", "velocity"),)

    def start(self, context):
        return 0

    def update(self, context, time, memory):
        if memory == 10:
            raise ArithmeticError("eleven is too much")
        return Update(memory + 1, [memory + 1.0])


@pytest.fixture
def ramp():
    return {"more_types": "ramp: {type: test/Ramp}"}


def test_an_update_that_is_faster_than_physics_is_said_and_done_at_every_step(make, ramp):
    ramp["more_types"] += "\n    update_rate: 1000"
    twin = make("ramp", **ramp, time_step=0.002)
    (text,) = [text for text in twin.findings.warnings if "Hz" in text]
    assert text.startswith(
        "r: controller broadcaster, controller ramp, the controller manager: the update rate of 1000 Hz"
    )
    assert text.endswith("is higher than that of the physics, which steps every 0.002 s: reduced to 500 Hz")
    twin.step(8)
    assert velocity(twin, "wheel") > 3  # at the default 100 Hz it would be told 2 at most


def test_a_controller_that_raises_is_deactivated_and_the_others_go_on(make, ramp, caplog):
    twin = make("ramp", "positions", **ramp)
    twin.publish("/r/positions/commands", [0.8])
    twin.advance_to(0.095)
    assert velocity(twin, "wheel") == pytest.approx(10, rel=0.1)
    twin.advance_to(4.0)
    assert states(twin)["ramp"] == "inactive"
    assert "controller ramp is deactivated: ArithmeticError: eleven is too much" in caplog.text
    assert velocity(twin, "wheel") == pytest.approx(0, abs=1e-6)
    assert position(twin, "arm") == pytest.approx(0.8, abs=1e-3)


def test_a_failing_controller_ends_the_same_whoever_listens(make, ramp):
    hashes = []
    for rate in (None, 7.0, 100.0):
        twin = make("ramp", "positions", **ramp)
        if rate is not None:
            twin.subscribe("/clock", lambda message: None, rate=rate)
        twin.advance_to(0.5)
        hashes.append(twin.state_sha256())
    assert len(set(hashes)) == 1


def test_reset_starts_controllers_anew(make, ramp):
    twin = make("ramp", **ramp)
    twin.advance_to(0.055)
    first = twin.state_sha256()
    twin.advance_to(1.0)
    assert states(twin)["ramp"] == "inactive"
    twin.reset()
    assert states(twin)["ramp"] == "active"
    twin.advance_to(0.055)
    assert twin.state_sha256() == first


# The hardware layer


def test_of_two_claims_on_a_joint_velocity_goes_before_position(make):
    twin = make("positions", "velocities")
    twin.publish("/r/positions/commands", [-0.9])
    twin.publish("/r/velocities/commands", [0.1, 0.0])
    twin.advance_to(1.0)
    assert velocity(twin, "arm") == pytest.approx(0.1, rel=5e-3)


def test_position_and_velocity_of_one_controller_are_followed_together(make):
    twin = make("both")
    twin.publish("/r/both/commands", [0.7, 0.0])
    twin.advance_to(2.0)
    assert position(twin, "arm") == pytest.approx(0.7, abs=1e-3)


ENFORCED = "enforce_command_limits: true"


def test_enforced_limits_are_the_tightest_of_urdf_and_ros2_control_and_a_cut_is_said_once(make, caplog):
    twin = make("positions", more_types=ENFORCED)
    for command in (1.9, 1.5, -7.0):
        twin.publish("/r/positions/commands", [command])
        twin.advance_to(twin.time + 3.0)
    assert position(twin, "arm") == pytest.approx(-1.0, abs=1e-3)
    twin = make("velocities", more_types=ENFORCED)
    twin.publish("/r/velocities/commands", [0.0, 30.0])
    twin.advance_to(1.0)
    assert velocity(twin, "wheel") == pytest.approx(20.0, rel=1e-3)
    assert [record.getMessage() for record in caplog.records if "is cut" in record.getMessage()] == [
        "r: joint arm: the position command 1.9 is beyond the limit 1: it is cut to the limit",
        "r: joint wheel: the velocity command 30 is beyond the limit 20: it is cut to the limit",
    ]


@pytest.mark.parametrize("more_types", ["", "enforce_command_limits: false"])  # controller_manager_parameters.yaml:12
def test_position_limits_are_off_unless_the_manager_enforces_them(make, more_types, caplog):
    twin = make("positions", more_types=more_types)
    twin.publish("/r/positions/commands", [1.9])
    twin.advance_to(2.0)
    assert position(twin, "arm") == pytest.approx(1.9, abs=1e-3)
    assert "is cut" not in caplog.text


@pytest.mark.parametrize("more_types", ["", ENFORCED])
def test_a_velocity_is_clamped_to_the_joints_limit_whatever_the_manager_enforces(make, more_types, caplog):
    """As in Gazebo: DART holds 3 rad/s under a limit of 3 and a command of 50."""
    twin = make("velocities", more_types=more_types)
    twin.publish("/r/velocities/commands", [0.0, 30.0])
    twin.advance_to(2.0)
    assert velocity(twin, "wheel") == pytest.approx(20.0, rel=1e-3)
    assert caplog.text.count("r: joint wheel: the velocity command 30 is beyond the limit 20") == 1


@pytest.mark.parametrize("more_types", ["", ENFORCED])
def test_a_position_servo_never_exceeds_the_joints_velocity_limit(make, more_types):
    twin = make("positions", more_types=more_types)
    fastest = []
    twin.subscribe("/clock", lambda message: fastest.append(abs(velocity(twin, "arm"))), rate=100)
    twin.publish("/r/positions/commands", [-1.0])
    twin.advance_to(2.0)
    assert 2.5 < max(fastest) < 3.0 * 1.01
    assert position(twin, "arm") == pytest.approx(-1.0, abs=1e-3)


@pytest.mark.parametrize("more_types", ["", ENFORCED])
def test_an_effort_is_clamped_to_the_joints_limit_whatever_the_manager_enforces(make, more_types, caplog):
    twin = make("efforts", more_types=more_types)
    twin.publish("/r/efforts/commands", [1e6])
    twin.advance_to(0.01)
    assert velocity(twin, "finger") == pytest.approx(50 / 0.1 * 0.01, rel=1e-6)
    assert caplog.text.count("r: joint finger: the effort command 1e+06 is beyond the limit 50") == 1


def test_without_an_active_controller_joints_hold_where_they_are_left(make):
    twin = make("velocities")
    twin.publish("/r/velocities/commands", [0.5, 4.0])
    twin.advance_to(0.5)
    twin.control.manager("r").switch_controller(deactivate=["velocities"])
    twin.advance_to(3.0)
    left = position(twin, "arm"), position(twin, "wheel")
    twin.advance_to(10.0)
    assert (position(twin, "arm"), position(twin, "wheel")) == pytest.approx(left, abs=1e-4)


def test_a_joint_released_at_speed_comes_to_rest_without_turning_back(make):
    twin = make("velocities")
    twin.publish("/r/velocities/commands", [0.0, 8.0])
    twin.advance_to(0.5)
    twin.control.manager("r").switch_controller(deactivate=["velocities"])
    slowest = []
    twin.subscribe("/clock", lambda message: slowest.append(velocity(twin, "wheel")), rate=100)
    twin.advance_to(3.0)
    assert min(slowest) > -1e-6
    assert abs(slowest[-1]) < 1e-4


def test_an_initial_value_sets_the_start_and_a_text_is_refused(make, monkeypatch):
    assert position(make(), "arm") == pytest.approx(0.5)
    monkeypatch.setitem(globals(), "ROBOT", ROBOT.replace(">0.5</param>", ">half</param>"))
    with pytest.raises(InputError, match=r"robot\.urdf:\d+: .*'half'"):
        make()


def test_a_mimic_joint_starts_and_moves_with_its_leader_multiplier_and_offset(make):
    twin = make("positions", mimic='<mimic joint="arm" multiplier="-1.5" offset="0.25"/>')
    assert position(twin, "finger") == pytest.approx(0.25 - 1.5 * 0.5)
    twin.publish("/r/positions/commands", [0.9])
    twin.advance_to(2.0)
    assert position(twin, "finger") == pytest.approx(0.25 - 1.5 * position(twin, "arm"), abs=1e-3)
    message = twin.joint_states("r")
    assert message.position[message.name.index("finger")] == position(twin, "finger")


def test_no_order_of_switches_ends_the_process(make):
    names = ("positions", "velocities", "efforts", "both")
    twin = make(inactive=names)
    manager = twin.control.manager("r")
    rng = np.random.default_rng(7)
    for _ in range(150):
        start = [name for name in names if rng.random() < 0.4]
        stop = [name for name in names if rng.random() < 0.4]
        manager.switch_controller(start, stop, FORCE_AUTO if rng.random() < 0.2 else BEST_EFFORT)
        for name in manager.active:
            if name != "broadcaster" and rng.random() < 0.5:
                size = len(twin.graph.command_limits(f"/r/{name}/commands"))
                twin.publish(f"/r/{name}/commands", rng.uniform(-1, 1, size))
        twin.step(int(rng.integers(1, 20)))
    assert np.isfinite(twin.robot_state("r").positions).all()


# Emergency stop


def test_an_emergency_stop_brings_all_to_rest_within_effort_limits_and_refuses_commands(make):
    twin = make("velocities")
    twin.publish("/r/velocities/commands", [0.5, 15.0])
    twin.advance_to(0.5)
    twin.control.emergency_stop("r")
    efforts = []
    twin.subscribe("/clock", lambda message: efforts.append(twin.robot_state("r").efforts), rate=100)
    with pytest.raises(CommandError, match="the emergency stop of 'r' holds"):
        twin.publish("/r/velocities/commands", [1, 1])
    twin.advance_to(3.0)
    held = position(twin, "arm")
    assert (np.abs(efforts) <= np.array([100, 50, 50]) + 1e-9).all()
    twin.advance_to(8.0)
    assert velocity(twin, "wheel") == pytest.approx(0, abs=1e-6)
    assert position(twin, "arm") == pytest.approx(held, abs=1e-4)
    twin.control.clear_emergency_stop("r")
    twin.advance_to(8.5)
    assert velocity(twin, "wheel") == pytest.approx(0, abs=1e-3)
    twin.publish("/r/velocities/commands", [0, 2])
    twin.advance_to(9.0)
    assert velocity(twin, "wheel") == pytest.approx(2, rel=1e-3)


def test_the_scenarios_own_commands_are_refused_too_while_the_stop_holds(make, caplog):
    caplog.set_level(logging.WARNING)
    twin = make("velocities")
    scenario = twin.scenario
    from dataclasses import replace

    from drake_twin import Twin
    from drake_twin.scenario import Command

    twin = Twin(replace(scenario, commands=(Command("/r/velocities/commands", (0.0, 2.0), 0.5),)))
    twin.control.emergency_stop("r")
    twin.advance_to(1.0)
    assert velocity(twin, "wheel") == pytest.approx(0, abs=1e-9)
    assert "emergency stop" in caplog.text


# gz_ros2_control's own settings


def test_hold_joints_false_leaves_unclaimed_joints_limp(make, monkeypatch):
    limp = "<hardware><param name='hold_joints'>false</param>"
    monkeypatch.setitem(globals(), "ROBOT", ROBOT.replace("<hardware>", limp))
    twin = make("velocities", inactive=("positions",))
    twin.control.manager("r").switch_controller(deactivate=["velocities"])
    twin.advance_to(1.0)
    assert position(twin, "arm") > 0.8  # it falls: its weight hangs in front of it


def test_an_emergency_stop_holds_joints_that_are_limp_otherwise(make, monkeypatch):
    limp = "<hardware><param name='hold_joints'>false</param>"
    monkeypatch.setitem(globals(), "ROBOT", ROBOT.replace("<hardware>", limp))
    twin = make(inactive=("velocities",))
    twin.control.emergency_stop("r")
    twin.advance_to(1.0)
    assert position(twin, "arm") == pytest.approx(0.5, abs=1e-3)


def test_the_proportional_gain_of_the_position_is_honoured(make, monkeypatch):
    gain = "<hardware><param name='position_proportional_gain'>0.05</param>"
    monkeypatch.setitem(globals(), "ROBOT", ROBOT.replace("<hardware>", gain))
    twin = make("positions")
    twin.publish("/r/positions/commands", [0.9])
    # 0.05 at 100 Hz closes the gap with a time constant of 0.2 s, once the joint has picked up speed
    twin.advance_to(0.3)
    gaps = [0.9 - position(twin, "arm")]
    twin.advance_to(0.5)
    gaps.append(0.9 - position(twin, "arm"))
    assert gaps[1] / gaps[0] == pytest.approx(np.exp(-1), rel=0.08)


def test_a_gain_that_is_none_is_refused(make, monkeypatch):
    wrong = "<hardware><param name='position_proportional_gain'>fast</param>"
    monkeypatch.setitem(globals(), "ROBOT", ROBOT.replace("<hardware>", wrong))
    with pytest.raises(
        InputError, match=r"robot\.urdf:\d+: position_proportional_gain is 'fast', which is not a positive number"
    ):
        make("positions")


def test_hardware_that_is_not_active_is_not_driven(make):
    inactive = "hardware_components_initial_state: {inactive: [system, nobody]}"
    twin = make("positions", inactive=("efforts",), more_types=inactive)
    assert states(twin)["positions"] == "inactive"
    why = "hardware component 'system' is inactive"
    assert f"controller positions: {why}" in twin.built.plans[0].findings.not_started[0]
    assert any("hardware component 'nobody' is unknown" in warning for warning in twin.built.plans[0].findings.warnings)
    manager = twin.control.manager("r")
    (component,) = manager.list_hardware_components()
    assert component.state == "inactive"
    assert all(item.is_available for item in manager.list_hardware_interfaces()[0])
    for strictness in (BEST_EFFORT, STRICT):  # resource_manager.cpp:2126
        response = manager.switch_controller(["efforts"], strictness=strictness)
        assert not response
        assert why in response.message

    twin = make("positions", more_types=inactive.replace("inactive: [system, nobody]", "unconfigured: [system]"))
    manager = twin.control.manager("r")
    assert [item.state for item in manager.list_hardware_components()] == ["unconfigured"]
    assert not any(item.is_available for item in (*manager.list_hardware_interfaces()[0],))

    allowed = f"{inactive}\n    defaults.allow_controller_activation_with_inactive_hardware: true"
    assert states(make("positions", more_types=allowed))["positions"] == "active"


def test_a_controller_that_fails_is_replaced_while_the_twin_runs(make, caplog):
    more = "ramp: {ros__parameters: {fallback_controllers: [positions]}}"
    twin = make("ramp", inactive=("positions",), more_types="ramp: {type: test/Ramp}", more=more)
    twin.advance_to(0.5)
    assert states(twin) == {"broadcaster": "active", "ramp": "inactive", "positions": "active"}
    assert "fallback controllers positions are activated" in caplog.text
    twin.publish("/r/positions/commands", [0.2])
    twin.advance_to(2.5)
    assert position(twin, "arm") == pytest.approx(0.2, abs=1e-3)
    assert "controller ramp is deactivated" in str(twin.findings[-1])


def test_the_interfaces_of_a_sensor_are_listed_with_those_of_the_joints(make, monkeypatch):
    sensor = (
        '<sensor name="imu"><state_interface name="orientation.x"/><state_interface name="orientation.y"/></sensor>'
    )
    monkeypatch.setitem(globals(), "ROBOT", ROBOT.replace("</ros2_control>", f"{sensor}</ros2_control>"))
    manager = make().control.manager("r")
    own = ["imu/orientation.x", "imu/orientation.y"]
    _, listed = manager.list_hardware_interfaces()
    assert [item.name for item in listed if item.name.startswith("imu")] == own
    assert all(item.is_available for item in listed)
    (component,) = manager.list_hardware_components()
    assert component.state_interfaces[-2:] == (*own,)
    unconfigured = make(more_types="hardware_components_initial_state: {unconfigured: [system]}")
    assert not any(item.is_available for item in unconfigured.control.manager("r").list_hardware_interfaces()[1])


def test_an_initial_velocity_is_a_finding(make, monkeypatch):
    given = '<state_interface name="velocity"><param name="initial_value">2.5</param></state_interface></joint>'
    changed = ROBOT.replace('<state_interface name="velocity"/></joint>', given, 1)
    monkeypatch.setitem(globals(), "ROBOT", changed)
    twin = make()
    assert "joint arm: the initial_value 2.5 of its velocity is ignored: joints start at rest" in str(
        twin.findings.warnings
    )
    assert velocity(twin, "arm") == 0.0


MOCK = ("mock_sensor_commands", "calculate_dynamics", "position_state_following_offset", "disable_commands")


@pytest.mark.parametrize("name", MOCK)
def test_a_parameter_of_mock_hardware_is_a_finding(make, monkeypatch, name):
    plugin = f'<plugin>mock_components/GenericSystem</plugin><param name="{name}">true</param>'
    changed = ROBOT.replace("<plugin>gz_ros2_control/GazeboSimSystem</plugin>", plugin)
    monkeypatch.setitem(globals(), "ROBOT", changed)
    (finding,) = (item for item in make().findings if name in item.what)
    assert finding.lines
    assert "param" in finding.what


def test_joints_of_ros2_control_that_the_robot_lacks_are_one_finding(make, monkeypatch):
    more = "".join(f'<joint name="{name}"><command_interface name="position"/></joint>' for name in ("elbow", "wrist"))
    monkeypatch.setitem(globals(), "ROBOT", ROBOT.replace("</ros2_control>", f"{more}</ros2_control>"))
    assert [item.what for item in make().findings if "does not have" in item.what] == [
        "<ros2_control> names joints that the robot does not have: elbow, wrist"
    ]


def test_a_transmission_of_ros2_control_is_a_finding(make, monkeypatch):
    transmission = '<transmission name="t"><plugin>transmission_interface/SimpleTransmission</plugin></transmission>'
    monkeypatch.setitem(globals(), "ROBOT", ROBOT.replace("</ros2_control>", f"{transmission}</ros2_control>"))
    (finding,) = (item for item in make().findings if "transmission" in item.what)
    assert finding.lines
