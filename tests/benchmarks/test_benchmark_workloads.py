"""What the robots of the benchmarks are commanded."""

import xml.etree.ElementTree as ElementTree

import numpy as np
import pytest

from drake_twin.benchmarks.workloads import WORKLOADS


@pytest.mark.parametrize("name", WORKLOADS)
def test_commands_are_finite_gentle_and_the_same_for_each_count(name):
    workload = WORKLOADS[name]
    for time in (0.0, 0.05, 0.7, 10.0):
        commands = np.array(workload.commands(3, time))
        assert commands.shape == (3, 4)
        assert np.isfinite(commands).all()
        assert np.abs(commands).max() < 10.0
        assert np.array_equal(workload.commands(2, time), commands[:2])


def test_waving_arms_swing_about_zero_at_their_rates():
    """A sine of 0.5 rad/s at 3 rad/s, whose phase is the robot's number; a whole period later it is the same."""
    workload = WORKLOADS["arms whose commands change"]
    period, times = 2 * np.pi / 3.0, np.linspace(0, 2 * np.pi / 3.0, 400, endpoint=False)
    first = np.array([[workload.commands(3, time)[robot][0] for time in times] for robot in range(3)])
    assert first.max(axis=1) == pytest.approx(0.5, abs=1e-3)
    assert first.mean(axis=1) == pytest.approx(0.0, abs=1e-12)
    assert [workload.commands(3, period)[robot][0] for robot in range(3)] == pytest.approx(first[:, 0])
    assert first[:, 0] == pytest.approx(0.5 * np.sin([0, 1, 2]))


@pytest.mark.parametrize(("joint", "rate", "most"), [(0, 3.0, 0.5), (1, 2.3, 0.4), (2, 4.1, 0.4), (3, 5.0, 0.2)])
def test_each_joint_of_a_waving_arm_has_a_rate_of_its_own(joint, rate, most):
    """The spectrum over seven periods has one line."""
    workload, period = WORKLOADS["arms whose commands change"], 2 * np.pi / rate
    times = np.arange(700) / 100 * period
    spectrum = np.abs(np.fft.rfft([workload.commands(1, time)[0][joint] for time in times])) / 350
    assert spectrum[7] == pytest.approx(most)
    assert np.delete(spectrum, 7).max() < 1e-9


@pytest.mark.parametrize("name", WORKLOADS)
def test_boxes_stand_beside_each_robot_in_the_world_of_its_scenario(name, tmp_path):
    """Read back from the SDF: two robots have twice the boxes, at the same distances."""
    workload = WORKLOADS[name]
    scenario = workload.scenario(2, tmp_path, time_step=0.001)
    if not workload.boxes:
        assert scenario.world.file is None
        assert [*tmp_path.iterdir()] == []
        return
    models = ElementTree.parse(scenario.world.file).findall("world/model")
    boxes = [model for model in models if model.find(".//box") is not None]
    places = [[float(value) for value in model.findtext("pose").split()[:3]] for model in boxes]
    first, second = (robot.xyz for robot in scenario.robots)
    apart = [second[0] - first[0], second[1] - first[1], 0.0]
    assert len(places) == 2 * len(workload.boxes)
    np.testing.assert_allclose(
        np.subtract(places[len(places) // 2 :], places[: len(places) // 2]), [apart] * len(workload.boxes)
    )
