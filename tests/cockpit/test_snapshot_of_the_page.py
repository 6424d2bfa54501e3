"""What the page is told of a twin: each robot has its own sliders, drives and joints."""

import pytest
from conftest import ARM, rovers
from robots_to_steer import driven_rovers

from drake_twin.cockpit.joint_commands import JointCommands
from drake_twin.cockpit.snapshot import state, structure
from drake_twin.cockpit.teleop import Teleop


@pytest.fixture(scope="module")
def twin():
    with rovers(2).robot("arm", ARM, xyz=(0, -2, 0)).build() as twin:
        yield twin


def test_each_robot_has_its_own_drives(tmp_path):
    with driven_rovers(tmp_path, 2).build() as twin:
        shown, hidden = (
            structure(twin, JointCommands(twin), Teleop(twin), only_displayed=only) for only in (False, True)
        )
    for robot in shown["robots"]:
        topic = f"/{robot['name']}/drive/cmd_vel"
        assert robot["drives"] == [{"topic": topic, "controller": "drive", "flies": False}]
    assert [robot["drives"] for robot in hidden["robots"]] == [[], []]


def test_each_robot_has_its_own_groups_and_joints(twin):
    found = structure(twin, JointCommands(twin), Teleop(twin), only_displayed=False)
    assert found["display_only"] is False
    robots = {robot["name"]: robot for robot in found["robots"]}
    assert list(robots) == ["robot_1", "robot_2", "arm"]
    for name, robot in robots.items():
        assert robot["joint_states"] == f"/{name}/joint_states"
        assert robot["groups"], name
        assert all(group["topic"].startswith(f"/{name}/") for group in robot["groups"])
        assert all(drive["topic"].startswith(f"/{name}/") for drive in robot["drives"])
        for group in robot["groups"]:
            assert len(group["home"]) == len(group["sliders"])
            assert group["controller"] in {item["name"] for item in robot["controllers"]}
    assert len(robots["robot_1"]["joints"]) == 4
    assert not any(joint["slides"] or joint["follows"] for joint in robots["robot_1"]["joints"])
    assert len({overlay["name"] for overlay in found["overlays"]}) == len(found["overlays"]) > 0


def test_robots_that_are_only_displayed_have_joints_and_nothing_to_command(twin):
    found = structure(twin, JointCommands(twin), Teleop(twin), only_displayed=True)
    assert found["display_only"] is True
    for robot in found["robots"]:
        assert (robot["groups"], robot["drives"]) == ([], [])
        assert robot["joints"]


def test_the_state_has_more_entries_beside_its_own(twin):
    found = state(twin, JointCommands(twin), {"more": 7}, with_efforts=False)
    assert found["more"] == 7
    assert len(found) > 1
