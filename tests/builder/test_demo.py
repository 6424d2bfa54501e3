import numpy as np
import pytest

from drake_twin import Twin
from drake_twin.builder.demo import DEMOS, demo_scenario


@pytest.mark.parametrize("robot", DEMOS)
def test_the_demo_moves_every_robot(robot):
    twin = Twin(demo_scenario(robot, 3))
    twin.advance_to(1.0)
    for name in twin.robots:
        assert np.abs(twin.robot_state(name).velocities).max() > 0.1


@pytest.mark.parametrize("robot", DEMOS)
def test_without_its_drive_every_robot_stays(robot):
    twin = Twin(demo_scenario(robot, 2, drive=False))
    before = [twin.robot_state(name).positions for name in twin.robots]
    twin.advance_to(1.0)
    after = [twin.robot_state(name).positions for name in twin.robots]
    assert np.abs(np.array(after) - before).max() < 1e-3


def test_the_demos_rovers_drive_circles_that_never_meet():
    twin = Twin(demo_scenario("rover", 2, time_step=0.01))
    closest, tracks = np.inf, {name: [] for name in twin.robots}
    for second in range(1, 61):
        twin.advance_to(float(second))
        places = [np.array(twin.robot_state(name).base_pose[:2]) for name in twin.robots]
        closest = min(closest, float(np.linalg.norm(places[1] - places[0])))
        for name, place in zip(twin.robots, places, strict=True):
            tracks[name].append(place)
    assert closest > 2.0
    for track in tracks.values():
        assert np.ptp(track, axis=0).max() < 2.5  # they stay where they are
        assert np.ptp(track, axis=0).min() > 1.0  # and get about
