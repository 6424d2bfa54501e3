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
    """Sets robots' joints to where the page's sliders are.

    Args:
        meshcat: the page.
        twin: the robots to show; their time stands still.
    """

    def __init__(self, meshcat: Meshcat, twin: Twin):
        self._meshcat = meshcat
        self._twin = twin
        self._sliders: dict[str, dict[str, str]] = {}
        for plan in twin.plans:
            self._sliders[plan.name] = {}
            for joint in plan.description.movable_joints:
                if joint.mimic is not None:
                    continue
                name = joint.name if len(twin.plans) == 1 else f"{plan.name}/{joint.name}"
                self._sliders[plan.name][joint.name] = name
                reach = _REACH_OF_SLIDE if joint.type == "prismatic" else pi
                lower = joint.limits.lower if isfinite(joint.limits.lower) else -reach
                upper = joint.limits.upper if isfinite(joint.limits.upper) else reach
                start = min(max(plan.start_positions[joint.name], lower), upper)
                meshcat.AddSlider(name, lower, max(upper, lower + 1e-6), 0.001, start)
        self._shown: dict[str, dict[str, float]] = {}

    def obey(self) -> None:
        """Puts the joints where the sliders are, and draws the robots when one has moved."""
        positions = {
            robot: {joint: float(self._meshcat.GetSliderValue(name)) for joint, name in sliders.items()}
            for robot, sliders in self._sliders.items()
        }
        if positions == self._shown:
            return
        for plan in self._twin.plans:
            self._twin.set_joint_positions(plan.name, plan.description.with_followers(positions[plan.name]))
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
