import numpy as np
import pytest
from conftest import ARM, rovers

from drake_twin import TwinBuilder
from drake_twin.cli.history import HistoryRecorder

WHEELS = "/robot_1/forward_velocity_controller/commands"


def driving():
    return rovers(2).command(WHEELS, [3] * 4, time=0.1)


def recorded(twin, **options):
    recorder = HistoryRecorder(**options)
    recorder.record(twin)
    return recorder


def test_the_samples_are_the_joint_states_of_their_times():
    twin = driving().build()
    recorder, heard = recorded(twin), []
    twin.subscribe("/robot_1/joint_states", heard.append, rate=50)
    twin.advance_to(0.5)
    robot = recorder.history().robots["robot_1"]
    assert robot.times == pytest.approx(np.arange(25) / 50)
    assert list(robot.joints) == list(heard[0].name)
    assert robot.positions.tolist() == [message.position.tolist() for message in heard]
    assert robot.velocities.tolist() == [message.velocity.tolist() for message in heard]
    assert robot.efforts.tolist() == [message.effort.tolist() for message in heard]
    assert np.ptp(robot.velocities) > 2


def test_the_run_is_the_same_to_the_last_bit():
    alone, watched = driving().build(), driving().build()
    recorded(watched, rate=37)
    for twin in (alone, watched):
        twin.advance_to(0.5)
    assert watched.state_sha256() == alone.state_sha256()


def test_it_records_without_a_joint_state_broadcaster():
    twin = driving().build()
    recorder = recorded(twin)
    twin.control.manager("robot_1").switch_controller(deactivate=["joint_state_broadcaster"])
    twin.advance_to(0.2)
    assert len(recorder.history().robots["robot_1"].times) == 10


def test_a_reset_begins_anew():
    twin = driving().build()
    recorder = recorded(twin)
    twin.advance_to(0.5)
    twin.reset()
    twin.advance_to(0.1)
    assert recorder.history().robots["robot_1"].times == pytest.approx(np.arange(5) / 50)


def test_another_twin_takes_the_place_of_the_one_before():
    first, second = driving().build(), TwinBuilder().robot("arm", ARM).build()
    recorder = recorded(first)
    first.advance_to(0.1)
    recorder.record(second)
    second.advance_to(0.1)
    first.advance_to(0.2)
    assert list(recorder.history().robots) == ["arm"]


def test_a_long_run_is_thinned_and_still_reaches_from_start_to_end(monkeypatch):
    monkeypatch.setattr("drake_twin.cli.history.MOST_SAMPLES", 10)
    twin = driving().build()
    recorder = recorded(twin)
    twin.advance_to(0.5)
    assert recorder.history().robots["robot_1"].times == pytest.approx(np.arange(0, 0.5, 0.08))


def test_the_units_are_those_of_each_joint(tmp_path):
    inertial = '<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'
    limit = '<limit lower="0" upper="1" effort="1" velocity="1"/>'
    file = tmp_path / "lift.urdf"
    file.write_text(
        f'<robot name="lift"><link name="world"/><link name="a">{inertial}</link><link name="b">{inertial}</link>'
        f'<joint name="up" type="prismatic"><parent link="world"/><child link="a"/><axis xyz="0 0 1"/>{limit}</joint>'
        f'<joint name="turn" type="revolute"><parent link="a"/><child link="b"/>{limit}</joint></robot>'
    )
    twin = TwinBuilder().robot("lift", file).build()
    recorder = recorded(twin)
    twin.advance_to(0.1)
    robot = recorder.history().robots["lift"]
    assert dict(zip(robot.joints, robot.units, strict=True)) == {"up": "m", "turn": "rad"}


def test_the_real_time_factor_is_simulated_over_wall_time(monkeypatch):
    """A clock that runs twice as fast as the simulation, and four times from 0.5 s on."""
    twin = driving().build()
    wall = lambda: 1e5 + 2 * min(twin.time, 0.5) + 4 * max(twin.time - 0.5, 0.0)  # noqa: E731
    monkeypatch.setattr("drake_twin.cli.history.time.perf_counter", wall)
    recorder = recorded(twin)
    twin.advance_to(1.0)
    history = recorder.history()
    assert history.window_edges[[0, -1]] == pytest.approx([0, 0.98])
    assert history.real_time_factors[[0, -1]] == pytest.approx([0.5, 0.25])
    assert 8 <= len(history.real_time_factors) <= 12  # three seconds by a quarter of one, and a bit, each


def test_a_run_that_never_began_has_no_history():
    history = recorded(driving().build()).history()
    assert history.robots == {}
    assert len(history.real_time_factors) == 0
