"""Ghosts of robots: at the start, and where their controllers bring them."""

import numpy as np
import pytest
from conftest import ARM, rovers
from pydrake.math import RigidTransform, RollPitchYaw
from test_overlays import Drawn

from drake_twin import TwinBuilder
from drake_twin.cockpit.overlay import OVERLAY_KINDS
from drake_twin.cockpit.scene import OVERLAYS

TRAJECTORY = "/arm/joint_trajectory_controller/joint_trajectory"


class Ghosts(Drawn):
    """What is a copy of what, and what is visible."""

    def __init__(self):
        super().__init__()
        self.copies, self.visible, self.scene = {}, {}, None

    def shared(self, twin):
        self.scene = self.scene or super().shared(twin)
        return self.scene

    def set_ghost(self, path, body, color):
        self.copies[path] = body

    def set_property(self, path, name, value):
        assert name == "visible"
        self.visible[path] = value


def pose(twin, link):
    return twin.plant.EvalBodyPoseInWorld(twin.plant.GetMyContextFromRoot(twin.context), twin.plant.GetBodyByName(link))


def test_the_start_is_where_the_files_put_the_robot_though_it_has_left():
    twin, drawn = rovers(2).build(), Ghosts()
    start = {link: pose(twin, link) for link in ("robot_2_base_link", "robot_2_rear_left_wheel")}
    twin.publish("/robot_2/forward_velocity_controller/commands", [6, 6, 6, 6])
    twin.advance_to(1.0)
    assert twin.robot_state("robot_2").base_pose[0] > 0.2
    OVERLAY_KINDS["starts"].type(drawn, twin)
    for link, X_WL in start.items():
        path = f"{OVERLAYS}/starts/robot_2/{link}"
        assert drawn.copies[path] == f"robot_2/{link}"
        assert drawn.transforms[path].IsNearlyEqualTo(X_WL, 1e-9)


TRAJECTORIES = """joint_trajectory_controller:
  ros__parameters:
    type: joint_trajectory_controller/JointTrajectoryController
    joints: [joint_1, joint_2, joint_3]
    command_interfaces: [position]
    state_interfaces: [position, velocity]
"""


@pytest.fixture
def arm(tmp_path):
    """An arm with a trajectory controller, that stands turned and away from the origin."""
    file = tmp_path / "controllers.yaml"
    file.write_text(TRAJECTORIES)
    builder = TwinBuilder().robot("arm", ARM, xyz=(1, 2, 0), rpy=(0, 0, 0.5), controllers=str(file))
    with builder.build() as twin:
        yield twin


def test_a_goal_is_where_the_trajectory_will_have_brought_the_links(arm):
    twin, drawn = arm, Ghosts()
    goals = OVERLAY_KINDS["goals"].type(drawn, twin)
    goals.draw()
    assert drawn.copies == {}
    point = {"positions": [0.8, 0.4, -0.3], "time_from_start": 2.0}
    twin.publish(TRAJECTORY, {"joint_names": ["joint_1", "joint_2", "joint_3"], "points": [point]})
    twin.advance_to(0.2)
    goals.draw()
    X_WR = RigidTransform(RollPitchYaw(0, 0, 0.5), [1, 2, 0])
    assert drawn.copies
    ghosts = {body: X_WR @ drawn.transforms[path] for path, body in drawn.copies.items()}
    (folder,) = {path.partition("/ghost/")[0] + "/ghost" for path in drawn.copies}
    assert drawn.visible.get(folder, True)
    twin.advance_to(3.5)
    goals.draw()
    assert drawn.visible[folder] is False  # it is there
    for body, X_WB in ghosts.items():
        link = body.rpartition("/")[2]
        assert np.abs(pose(twin, link).GetAsMatrix34() - X_WB.GetAsMatrix34()).max() < 0.02
