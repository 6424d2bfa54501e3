"""``/diagnostics``: names, levels and texts are those of ros2_control's controller_manager.cpp."""

import pytest
from conftest import rovers

from drake_twin.twin import diagnostics
from drake_twin.twin.diagnostics import ERROR, OK, WARN, Status

_NODE = "/robot_1/controller_manager"
CONTROLLERS, HARDWARE = f"{_NODE}: Controllers Activity", f"{_NODE}: Hardware Components Activity"
MANAGER = f"{_NODE}: Controller Manager Activity"
SIMULATION = "drake_twin: Simulation"


@pytest.fixture
def twin():
    with rovers(1).build() as twin:
        yield twin


def told(message):
    values = [{each.key: each.value for each in item.values} for item in message.status]
    return {item.name: (item.level, item.message, own) for item, own in zip(message.status, values, strict=True)}


def test_it_comes_once_a_second_of_simulation_time(twin):
    stamps = []
    twin.subscribe("/diagnostics", lambda message: stamps.append(message.header.stamp.sec))
    twin.advance_to(3.5)
    assert stamps == [0, 1, 2, 3]


def test_nothing_is_made_while_nobody_listens(twin, monkeypatch):
    def fail(self):
        raise AssertionError

    monkeypatch.setattr(diagnostics.Status, "fields", fail)
    twin.advance_to(2.0)


def test_active_controllers_and_hardware_are_told(twin):
    found = told(twin.latest("/diagnostics"))
    assert list(found) == [SIMULATION, CONTROLLERS, HARDWARE, MANAGER]
    states = {"joint_state_broadcaster.state": "active", "forward_velocity_controller.state": "active"}
    assert found[CONTROLLERS] == (OK, "All controllers are active", states)
    assert found[HARDWARE] == (OK, "All hardware components are active", {"robot_1_system.state": "active"})
    level, message, values = found[MANAGER]
    assert (level, message) == (OK, "Controller Manager is running")
    period = {"average": "100.000000", "standard_deviation": "0.000000", "min": "100.000000", "max": "100.000000"}
    assert values == {
        "update_rate": "100",
        **{f"periodicity.{key}": value for key, value in period.items()},
        "missed_periods": "0",
    }


def test_a_controller_that_is_not_active_is_told(twin):
    manager = twin.control.manager("robot_1")
    manager.switch_controller(deactivate=["forward_velocity_controller"])
    level, message, values = told(twin.latest("/diagnostics"))[CONTROLLERS]
    assert (level, message) == (OK, "Not all controllers are active")
    assert values["forward_velocity_controller.state"] == "inactive"
    manager.switch_controller(deactivate=["joint_state_broadcaster"])
    for name in ("forward_velocity_controller", "joint_state_broadcaster"):
        manager.unload_controller(name)
    level, message, values = told(twin.latest("/diagnostics"))[CONTROLLERS]
    assert (level, message, values) == (WARN, "No controllers are currently loaded", {})


def test_a_manager_that_the_step_slows_down_is_told(twin):
    """With steps of 15 ms it works at 1 / 15 ms = 66.7 Hz: 33 Hz less than it should, and the error is beyond 10 Hz."""
    twin.clock.set_time_step(0.015)
    level, message, values = told(twin.latest("/diagnostics"))[MANAGER]
    assert level == ERROR
    assert message == "Controller Manager has bad periodicity : 66.6667 Hz. Expected consistent 100 Hz"
    assert values["periodicity.average"] == "66.666667"


def test_time_that_was_granted_and_not_simulated_is_missed(twin):
    """Of a frame of 1/30 s at a rate of 1e6, 10,000 steps of 1 ms at most are done, and the rest is not."""
    twin.clock.real_time_rate = 1e6
    twin.run(until=0.5)
    level, message, values = told(twin.latest("/diagnostics"))[SIMULATION]
    assert (level, message) == (WARN, "Simulation is slower than its real-time rate")
    assert float(values["missed_time"]) > 33_323.0
    assert values["real_time_rate"] == "1000000.000000"
    level, message, values = told(twin.latest("/diagnostics"))[SIMULATION]
    assert level == WARN, "another reader is told the same"
    twin.advance_to(twin.time + 1.5)
    level, message, values = told(twin.latest("/diagnostics"))[SIMULATION]
    assert (level, message) == (OK, "Simulation is running")


def test_the_real_time_factor_is_simulated_time_by_wall_time(twin, monkeypatch):
    now = [1e9]  # behind each reading of the real clock
    monkeypatch.setattr(diagnostics, "perf_counter", lambda: now[0])
    told(twin.latest("/diagnostics"))
    twin.advance_to(0.5)
    now[0] += 1.0
    assert told(twin.latest("/diagnostics"))[SIMULATION][2]["real_time_factor"] == "0.500000"
    twin.reset()
    assert "real_time_factor" not in told(twin.latest("/diagnostics"))[SIMULATION][2]


def test_readers_do_not_shorten_the_span_of_others(twin, monkeypatch):
    """0.5 s are simulated in the first half of a second and nothing in the second one; readers are a quarter apart."""
    now, factors = [1e9], []
    monkeypatch.setattr(diagnostics, "perf_counter", lambda: now[0])
    for step in range(9):
        if step == 2:
            twin.advance_to(0.5)
        factors.append(told(twin.latest("/diagnostics"))[SIMULATION][2]["real_time_factor"])
        now[0] += 0.25
    assert factors[4:] == ["0.500000", "0.500000", "0.000000", "0.000000", "0.000000"]


def test_summaries_are_merged_as_by_diagnostic_updater():
    """DiagnosticStatusWrapper::mergeSummary: two bad ones are joined, and of others the worse one counts."""
    status = Status("n", "h", "fine")
    status.merge(OK, "also fine")
    assert status.fields()["message"] == "fine"
    status.merge(WARN, "so so")
    assert (status.fields()["level"], status.fields()["message"]) == (WARN, "so so")
    status.merge(ERROR, "bad")
    assert (status.fields()["level"], status.fields()["message"]) == (ERROR, "so so; bad")
