"""Controllers of which only names, claims and references matter, in a controller manager of their own."""

from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory

from drake_twin.controllers.interface import Interface
from drake_twin.description.package_index import PackageIndex
from drake_twin.planning.controller_plan import ControllerPlan
from drake_twin.planning.plan_robot import plan_robot
from drake_twin.planning.robot_plan import RobotPlan
from drake_twin.scenario import Robot
from drake_twin.twin.controller_manager import ControllerManager

# Joints with command interfaces in <ros2_control>; a claim of another name is a reference of a controller.
_ROBOT = """<robot name="robot"><link name="base"/><link name="a"/><link name="b"/>
<joint name="a" type="continuous"><parent link="base"/><child link="a"/></joint>
<joint name="b" type="continuous"><parent link="base"/><child link="b"/></joint>
<ros2_control name="s" type="system">
<joint name="a"><command_interface name="effort"/></joint><joint name="b"><command_interface name="effort"/></joint>
</ros2_control></robot>"""


def interface(text: str) -> Interface:
    """Return an interface from its name in ROS: joint/interface or controller/joint/interface."""
    joint, _, name = text.rpartition("/")
    return Interface(joint, name)


def controller(
    name: str, *claims: str, references: tuple[str, ...] = (), state: str = "unloaded", problem: str | None = None
) -> ControllerPlan:
    """Return a controller that claims some interfaces and has some references."""
    return ControllerPlan(
        name,
        "a/Type",
        None,
        tuple(map(interface, claims)),
        tuple(map(interface, references)),
        state,
        problem=problem,
    )


def robot_plan(*controllers: ControllerPlan) -> RobotPlan:
    """Return the plan of a robot with these controllers."""
    with TemporaryDirectory() as folder:
        file = Path(folder) / "robot.urdf"
        file.write_text(_ROBOT)
        return replace(plan_robot(Robot("robot", str(file)), PackageIndex()), controllers=controllers)


class Manager(ControllerManager):
    """A controller manager that keeps its switches.

    Attributes:
        switches: The controllers that each switch has started, and those that it has stopped.
    """

    def __init__(self, *controllers: ControllerPlan):
        self.switches: list[tuple[tuple[str, ...], tuple[str, ...]]] = []
        super().__init__(robot_plan(*controllers), lambda *switch: self.switches.append(switch))
