"""Delays of a robot's commands and measurements: whole physics steps, kept by all that keeps a twin's state."""

from dataclasses import replace

import numpy as np
import pytest
from conftest import ROVER, rovers
from two_hinges import INERTIA, efforts, hinges, trajectories, velocities

from drake_twin import InputError, RunError, Twin, replay
from drake_twin.scenario import Robot, ScenarioError
from drake_twin.scenario.scenario_file import ScenarioFile, scenario_to_yaml
from drake_twin.sweeps.variation import with_value
from drake_twin.twin.recording import Recording
from drake_twin.twin.snapshot import Snapshot

STATES = ("joint_state_broadcaster/JointStateBroadcaster", {})
SPEED = "/r/speed/commands"


def delayed(scenario, **delays):
    robots = (replace(scenario.robots[0], **delays), *scenario.robots[1:])
    return replace(scenario, robots=robots)


@pytest.fixture
def turning(tmp_path):
    """A scenario whose left hinge is told to turn at 0.1 s, at rest before that."""
    builder = hinges(tmp_path, {"speed": velocities("left", "right"), "states": STATES}, rate=1000)
    return builder.command(SPEED, [2.0, -1.0], time=0.1).scenario()


def response(scenario, seconds=0.4):
    """The state after each physics step."""
    twin, found = Twin(scenario), []
    for step in range(1, round(seconds / scenario.time_step) + 1):
        twin.advance_to(step * scenario.time_step)
        state = twin.robot_state("r")
        found.append((*state.positions, *state.velocities))
    return np.array(found)


@pytest.mark.parametrize(("delay", "steps"), [(0.001, 1), (0.05, 50), (0.0203, 21), (0.0, 0)])
def test_a_step_response_is_shifted_by_exactly_the_delay_of_commands(turning, delay, steps):
    plain, late = response(turning), response(delayed(turning, command_delay=delay))
    assert np.array_equal(late[steps:], plain[: len(plain) - steps])
    assert np.abs(plain[-1]).max() > 1.0
    assert not steps or not np.array_equal(late, plain)


@pytest.mark.parametrize(("delay", "steps"), [(0.001, 1), (0.05, 50), (0.0203, 21)])
def test_what_is_measured_is_the_state_of_that_many_steps_ago(turning, delay, steps):
    scenario = delayed(turning, measurement_delay=delay)
    truth = response(scenario)
    assert np.array_equal(truth, response(turning)), "a robot without feedback moves as before"
    twin = Twin(scenario)
    estimated = twin.diagram.GetOutputPort("r/state_estimated")
    start = estimated.Eval(twin.context)
    for step in range(1, 400):
        twin.advance_to(step * 0.001)
        expected = start if step <= steps else truth[step - 1 - steps]
        assert np.array_equal(estimated.Eval(twin.context), expected)
        message = twin.latest("/r/joint_states")
        assert [*message.position, *message.velocity] == [*expected]


def test_each_message_arrives_once_in_its_order_and_not_at_the_other_robots(tmp_path):
    builder = hinges(tmp_path, {"speed": velocities("left", "right")}, ("r", "s"), rate=1000)
    twin = Twin(delayed(builder.scenario(), command_delay=0.03))
    for step, speed in enumerate((1.0, 3.0, 2.0)):
        twin.advance_to(step * 0.01)
        for robot in "rs":
            twin.publish(f"/{robot}/speed/commands", [speed, 0.0])
    heard = {}
    for step in range(21, 60):
        twin.advance_to(step * 0.001)
        heard[step] = [twin.graph.command(f"/{robot}/speed/commands") for robot in "rs"]
    data = {step: [None if item is None else item.data[0] for item in both] for step, both in heard.items()}
    assert {step: both[1] for step, both in data.items()} == dict.fromkeys(range(21, 60), 2.0)
    expected = {step: None if step <= 30 else 1.0 if step <= 40 else 3.0 if step <= 50 else 2.0 for step in data}
    assert {step: both[0] for step, both in data.items()} == expected


def test_two_trajectories_that_are_under_way_together_are_both_followed(tmp_path):
    scenario = hinges(tmp_path, {"arm": trajectories("left", "right")}).scenario()

    def trajectory(position):
        point = {"positions": [position, 0.0], "time_from_start": {"sec": 0, "nanosec": 500_000_000}}
        return {"joint_names": ["left", "right"], "points": [point]}

    ends = {}
    for delay in (0.0, 0.2):
        twin = Twin(delayed(scenario, command_delay=delay))
        twin.publish("/r/arm/joint_trajectory", trajectory(0.8))
        twin.advance_to(0.1)
        twin.publish("/r/arm/joint_trajectory", trajectory(-0.4))
        twin.advance_to(0.1 + delay)
        first = twin.robot_state("r").positions[0]
        twin.advance_to(2.0)
        ends[delay] = first, twin.robot_state("r").positions[0]
    assert ends[0.0][0] > 0.1
    assert ends[0.2][0] == pytest.approx(ends[0.0][0], abs=1e-9)
    assert ends[0.2][1] == pytest.approx(-0.4, abs=1e-3)


def test_a_loop_with_a_late_measurement_moves_as_the_method_of_steps_says(tmp_path):
    stiffness, delay, start = 50.0 * INERTIA, 0.1, 0.1
    pid = {
        "dof_names": ["left"],
        "command_interface": "effort",
        "reference_and_state_interfaces": ["position"],
        "gains": {"left": {"p": stiffness}},
    }
    controllers = {"hold": ("pid_controller/PidController", pid)}
    scenario = hinges(tmp_path, controllers, rate=10_000, time_step=1e-4).scenario()
    scenario = replace(scenario, robots=(replace(scenario.robots[0], initial_positions={"left": start}),))
    reached = {}
    for late in (0.0, delay):
        twin = Twin(delayed(scenario, measurement_delay=late))
        twin.publish("/r/hold/reference", {"dof_names": ["left"], "values": [0.0]})
        twin.advance_to(2 * delay)
        reached[late] = twin.robot_state("r").positions[0]
    square, acceleration = stiffness / INERTIA, stiffness / INERTIA * start
    expected = start - acceleration * (2 * delay) ** 2 / 2 + square * acceleration * delay**4 / 24
    assert reached[delay] == pytest.approx(expected, abs=2e-4)
    assert reached[0.0] == pytest.approx(start * np.cos(np.sqrt(square) * 2 * delay), abs=2e-4)


def test_the_velocity_limit_of_a_position_is_the_servos_and_not_late(tmp_path):
    controllers = {"to": ("position_controllers/JointGroupPositionController", {"joints": ["left", "right"]})}
    file = hinges(tmp_path, controllers, rate=1000).command("/r/to/commands", [30.0, 0.0]).scenario()
    assert np.array_equal(response(delayed(file, measurement_delay=0.05), 0.3), response(file, 0.3))


def driven(**delays):
    topic = "/robot_1/forward_velocity_controller/commands"
    builder = rovers(2)
    for step, speed in enumerate((9.0, 2.0, -4.0, 6.0, 1.0, 5.0, 0.0, 3.0)):
        builder.command(topic, [speed, 2.0, speed, 2.0], time=0.25 * step)
    return delayed(builder.scenario(), **delays)


BOTH = {"command_delay": 0.3, "measurement_delay": 0.012}


def after(twin, seconds):
    twin.advance_to(twin.time + seconds)
    return twin.state_sha256()


@pytest.mark.parametrize("delays", [{"command_delay": 0.02}, {"measurement_delay": 0.02}, BOTH])
def test_set_on_a_built_twin_is_the_same_to_the_bit_as_built_with_it(delays):
    plain, varied = driven(), driven()
    for name, value in delays.items():
        varied = with_value(varied, f"robot_1.{name}", value)
    assert varied == driven(**delays)
    twin = Twin(plain)
    before = after(twin, 2.0)
    twin.reset(varied)
    assert after(twin, 2.0) == after(Twin(varied), 2.0) != before
    twin.reset()
    assert after(twin, 2.0) == after(Twin(varied), 2.0)
    twin.reset(plain)
    assert after(twin, 2.0) == before


def test_yaml_snapshots_recordings_and_rebuilds_keep_what_is_under_way(tmp_path):
    scenario = driven(**BOTH)
    assert ScenarioFile(scenario_to_yaml(scenario), "x.yaml").scenario == scenario
    twin = Twin(driven())
    twin.recorder.begin()
    twin.reset(scenario)
    twin.advance_to(0.5)
    twin.publish("/robot_1/forward_velocity_controller/commands", [1, 8, 1, 8])
    twin.advance_to(0.6)
    snapshot = twin.snapshot()
    assert [round(time, 9) for time, _, _ in snapshot.delayed] == [0.8, 0.8]
    assert len(snapshot.robots["robot_1"]["measured"]["state"]) == 12 * len(snapshot.robots["robot_1"]["state"])
    assert "measured" not in snapshot.robots["robot_2"]
    end = after(twin, 1.0)
    twin.recorder.recording().save(tmp_path / "run.json")
    assert replay(Recording.load(tmp_path / "run.json")).state_sha256() == end
    snapshot.save(tmp_path / "state.json")
    for known in (snapshot, Snapshot.load(tmp_path / "state.json")):
        twin.restore(known)
        assert twin.state_sha256() == twin.state_sha256()
        assert after(twin, 1.0) == end
    other = Twin(driven())
    other.restore(snapshot)
    assert after(other, 1.0) == end
    twin.restore(snapshot)
    twin.entities.spawn(Robot("third", ROVER, xyz=(9, 9, 0.13)))
    again = twin.snapshot()
    assert again.delayed == snapshot.delayed
    assert again.robots["robot_1"]["measured"] == snapshot.robots["robot_1"]["measured"]
    twin.entities.delete("robot_1")
    assert twin.snapshot().delayed == []


def test_another_time_step_keeps_what_was_measured(turning):
    twin = Twin(delayed(turning, measurement_delay=0.04))
    twin.advance_to(0.2)
    estimated = twin.diagram.GetOutputPort("r/state_estimated").Eval(twin.context)
    for step in (0.002, 0.001):
        twin.clock.set_time_step(step)
        twin.advance_to(0.2)
        assert np.array_equal(twin.diagram.GetOutputPort("r/state_estimated").Eval(twin.context), estimated)
    twin.advance_to(0.3)
    assert twin.diagram.GetOutputPort("r/state_estimated").Eval(twin.context)[0] == pytest.approx(
        twin.robot_state("r").positions[0] - 2.0 * 0.04, abs=1e-3
    )


def test_a_step_that_fails_takes_the_delays_back(tmp_path):
    builder = hinges(tmp_path, {"push": efforts("left", "right")}, rate=1000)
    scenario = delayed(builder.scenario(), command_delay=0.01, measurement_delay=0.01)

    def fail(context):
        if 0.0355 < context.get_time() < 0.0365:
            raise ValueError("it fails")

    def extend(diagram_builder, parts):
        from pydrake.systems.framework import LeafSystem

        system = LeafSystem()
        system.DeclarePerStepPublishEvent(fail)
        diagram_builder.AddSystem(system)

    twin, clean = Twin(scenario, extensions=[extend]), Twin(scenario)
    for each in (twin, clean):
        each.publish("/r/push/commands", [3.0, 1.0])
        each.advance_to(0.025)
        each.publish("/r/push/commands", [9.0, 1.0])
    with pytest.raises(RunError):
        twin.advance_to(0.05)
    clean.advance_to(twin.time)
    assert twin.time == pytest.approx(0.035)
    assert len(twin.snapshot().delayed) == 1
    assert twin.state_sha256() == clean.state_sha256()


def test_without_a_delay_nothing_is_added_to_the_diagram_or_the_state(turning):
    def names(scenario):
        (robot,) = [item for item in Twin(scenario).diagram.GetSystems() if item.get_name() == "r"]
        return sorted(item.get_name() for item in robot.GetSystems())

    plain = names(turning)
    assert not any("delay" in name for name in plain)
    assert names(delayed(turning, command_delay=0.1)) == plain
    added = {*names(delayed(turning, measurement_delay=0.1))} - {*plain}
    assert sorted(added) == ["net_actuation_delay", "state_delay"]
    snapshot = Twin(turning).snapshot()
    assert "measured" not in snapshot.robots["r"]
    assert "delayed" not in snapshot.state()


def test_a_message_that_cannot_be_used_is_refused_when_it_is_published(turning):
    twin = Twin(delayed(turning, command_delay=0.05))
    with pytest.raises(InputError, match="has 3 elements"):
        twin.publish(SPEED, [1.0, 2.0, 3.0])  # ros2_control deactivates a controller that receives such a message
    twin.publish(SPEED, [1.0, 2.0])
    manager = twin.control.manager("r")
    twin.advance_to(0.05)
    assert manager.states["speed"] == "active"
    twin.advance_to(0.052)
    assert manager.states["speed"] == "inactive"
    assert twin.graph.command(SPEED) is None


def test_what_arrives_during_an_emergency_stop_is_dropped(turning):
    twin = Twin(delayed(turning, command_delay=0.05))
    twin.publish(SPEED, [1.0, 2.0])
    twin.control.emergency_stop("r")
    twin.advance_to(0.1)
    assert twin.graph.command(SPEED) is None


@pytest.mark.parametrize(
    ("path", "value", "message"),
    [
        ("r.command_delay", -0.1, "-0.1 s is not a delay from 0 to 1 s"),
        ("r.measurement_delay", 1.5, "1.5 s is not a delay from 0 to 1 s"),
        ("r.measurement_delay", float("nan"), "nan is not a finite number"),
    ],
)
def test_a_delay_that_cannot_be_is_refused(turning, path, value, message):
    with pytest.raises(ScenarioError) as refused:
        with_value(turning, path, value)
    assert message in str(refused.value)


def test_cenic_measures_without_delay(turning):
    with pytest.raises(ScenarioError, match="measures without delay: use discrete"):
        delayed(replace(turning, engine="cenic", time_step=0.01), measurement_delay=0.1)
    plain = replace(turning, engine="cenic", time_step=0.01)
    shifted = response(delayed(plain, command_delay=0.05))
    assert shifted[5:] == pytest.approx(response(plain)[:-5], abs=1e-3)


def test_a_flood_of_delayed_commands_keeps_the_newest_of_each_moment(turning):
    flooded, plain = (Twin(delayed(turning, command_delay=0.05)) for _ in range(2))
    for index in range(3000):
        flooded.publish(SPEED, [index * 1e-3, 0.0])
    plain.publish(SPEED, [2.999, 0.0])
    assert len(flooded._session.commands.delayed) < 1200
    for twin in (flooded, plain):
        twin.step(80)
    assert flooded.state_sha256() == plain.state_sha256()
