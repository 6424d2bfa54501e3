"""A robot in the page with a slider for each joint, without physics: what ``drake_twin.check --view`` shows."""

import time
from collections.abc import Mapping, Sequence
from math import isfinite, pi
from pathlib import Path

from pydrake.geometry import Meshcat

from drake_twin.cockpit.page import open_meshcat, set_scene
from drake_twin.launch.robot_file import robot_file_scenario
from drake_twin.program import announce_page
from drake_twin.twin import Twin

_FRAME = 1 / 30  # s
_REACH_OF_SLIDE = 1.0  # m, for sliding joints without limits


class JointViewer:
    """Sets a robot's joints to where the page's sliders are.

    Args:
        meshcat: the page.
        twin: the one robot to show; its time stands still.
    """

    def __init__(self, meshcat: Meshcat, twin: Twin):
        self._meshcat = meshcat
        self._twin = twin
        (self._plan,) = twin.plans
        self._joints = [joint for joint in self._plan.description.movable_joints if joint.mimic is None]
        for joint in self._joints:
            reach = _REACH_OF_SLIDE if joint.type == "prismatic" else pi
            lower = joint.limits.lower if isfinite(joint.limits.lower) else -reach
            upper = joint.limits.upper if isfinite(joint.limits.upper) else reach
            start = self._plan.start_positions[joint.name]
            meshcat.AddSlider(joint.name, lower, max(upper, lower + 1e-6), 0.001, min(max(start, lower), upper))
        self._shown: dict[str, float] = {}

    def obey(self) -> None:
        """Puts the joints where the sliders are, and draws the robot when one has moved."""
        positions = {joint.name: float(self._meshcat.GetSliderValue(joint.name)) for joint in self._joints}
        if positions != self._shown:
            self._twin.set_joint_positions(self._plan.name, self._plan.description.with_followers(positions))
            self._twin.draw()
            self._shown = positions


def view_joints(
    file: Path,
    xacro_args: Mapping[str, str],
    package_paths: Sequence[str],
    stopped: Sequence[int],
    *,
    open_browser: bool,
) -> None:
    """Shows a robot file until a signal arrives.

    Args:
        file: the robot file.
        xacro_args: values for its ``<xacro:arg>``s.
        package_paths: folders of ROS packages to look in first.
        stopped: not empty once the program is to end.
        open_browser: whether to open the page.
    """
    meshcat = open_meshcat()
    twin = Twin(robot_file_scenario(file, xacro_args=xacro_args, package_paths=package_paths), meshcat)
    set_scene(meshcat, twin)
    viewer = JointViewer(meshcat, twin)
    viewer.obey()
    announce_page(meshcat.web_url(), open_browser=open_browser)
    while not stopped:
        viewer.obey()
        time.sleep(_FRAME)
