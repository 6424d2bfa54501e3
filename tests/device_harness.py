"""A controller on its own: its ports are fixed by hand, time goes on, and what it writes is looked at."""

from typing import Any

import numpy as np
from pydrake.systems.analysis import Simulator
from pydrake.systems.framework import DiagramBuilder

from drake_twin.controllers.base_controller import ControllerSetup
from drake_twin.controllers.interface import Interface
from drake_twin.description.robot_description import Joint, RobotDescription
from drake_twin.kinematics.state_layout import StateLayout
from drake_twin.systems.no_message import make_value, or_none

JOINTS = ("finger", "thumb")
ROBOT = RobotDescription(
    name="hand",
    links=("palm", "finger_link", "thumb_link"),
    joints=(
        Joint("finger", "prismatic", "palm", "finger_link"),
        Joint("thumb", "continuous", "palm", "thumb_link"),
    ),
)
LAYOUT = StateLayout(size=4, positions={"finger": 0, "thumb": 1}, velocities={"finger": 2, "thumb": 3}, efforts={})


def setup_of(kind: type, parameters: Any, **more: Any) -> ControllerSetup:
    """What a controller of the robot above is built from; updated every 10 ms."""
    claims = kind.claimed_interfaces(parameters, ROBOT)
    return ControllerSetup("dut", parameters, claims, ROBOT, LAYOUT, update_period=0.01, **more)


class Running:
    """An active controller in a bare diagram."""

    def __init__(self, controller: Any, **ports: Any):
        builder = DiagramBuilder()
        self.controller = builder.AddNamedSystem("dut", controller)
        for index in range(controller.num_input_ports()):
            builder.ExportInput(controller.get_input_port(index), controller.get_input_port(index).get_name())
        self.diagram = builder.Build()
        self.simulator = Simulator(self.diagram)
        self.root = self.simulator.get_mutable_context()
        for name, value in ports.items():
            self.fix(name, value)
        self.context = controller.GetMyMutableContextFromRoot(self.root)
        self.simulator.Initialize()
        controller.activate(self.context)

    def fix(self, port: str, value: Any) -> None:
        """Puts a value onto an input port; a NumPy array goes onto a vector port."""
        if isinstance(value, np.ndarray | list):
            self.diagram.GetInputPort(port).FixValue(self.root, np.array(value, dtype=float))
        else:
            self.diagram.GetInputPort(port).FixValue(self.root, make_value(value))

    def send(self, topic: str, message: Any) -> Any:
        """Publishes a message, or sends a goal, and gives what went onto the port."""
        value = self.controller.read(topic, message, self.context)
        self.fix(topic, value)
        return value

    def advance(self, time: float) -> float:
        """Advances to a time, updates at that time included; gives the time at which it stopped."""
        self.simulator.AdvanceTo(time)
        if self.root.get_time() == time:
            self.simulator.AdvancePendingEvents()
        return self.root.get_time()

    def commands(self) -> list[float]:
        """What the controller writes."""
        return self.controller.get_command_interfaces_output_port().Eval(self.context).tolist()

    def output(self, port: str) -> Any:
        """What stands on one of its output ports."""
        return or_none(self.controller.GetOutputPort(port).Eval(self.context))


__all__ = ["JOINTS", "LAYOUT", "ROBOT", "Interface", "Running", "setup_of"]
