"""The controllers of a twin's robots: their managers, goals and emergency stops."""

from collections.abc import Mapping
from typing import Any

from drake_twin.description.declared_parameters import DeclaredParameter
from drake_twin.twin.controller_manager import ControllerManager
from drake_twin.twin.group import Group
from drake_twin.twin.recording import recorded


class Control(Group, path="twin.control"):
    """The controllers of all robots; `Twin.control`."""

    def manager(self, robot: str) -> ControllerManager:
        """Return the controller manager of a robot; its methods are named like the services of ROS 2.

        Raises:
            InputError: If the robot is unknown.
        """
        return self._session.control(robot).manager

    def parameters(self, robot: str, controller: str) -> Mapping[str, DeclaredParameter]:
        """Return a controller's parameters by their names, as its node declares them in ROS.

        Raises:
            InputError: If the robot or the controller is unknown.
        """
        return self._session.parameters.declared(robot, controller)

    @recorded("set_parameters", outside_callbacks="change")
    def set_parameters(self, robot: str, controller: str, values: Mapping[str, Any]) -> None:
        """Set parameters of a controller, all or none, as ``ros2 param set`` does.

        As upstream, an active controller follows its gains, tolerances and limits at once, and others when it is
        configured next. The diagram is built again, and all state is transferred.

        Args:
            robot: The robot.
            controller: The controller.
            values: Name → value of the parameter's own type; lists for arrays.

        Raises:
            InputError: If one cannot be set, in the words of ROS; or if the robot or the controller is unknown.
        """
        self._session.parameters.set(robot, controller, values)

    def cancel(self, robot: str, controller: str) -> None:
        """Cancel the present goal of a controller's action; the joints hold where they are.

        Raises:
            InputError: If the robot or the controller is unknown.
        """
        self._session.control(robot).cancel(controller)

    @recorded("emergency_stop")
    def emergency_stop(self, robot: str) -> None:
        """Brake a robot's joints with all of their effort until they are at rest, and hold them there.

        Goals are cancelled; commands are refused until `clear_emergency_stop`.

        Raises:
            InputError: If the robot is unknown.
        """
        self._session.control(robot).emergency_stop()

    def is_stopped(self, robot: str) -> bool:
        """Return whether a robot's emergency stop holds.

        Raises:
            InputError: If the robot is unknown.
        """
        return self._session.control(robot).stopped

    @recorded("clear_emergency_stop")
    def clear_emergency_stop(self, robot: str) -> None:
        """Let a robot's controllers command again; each starts without a command.

        Raises:
            InputError: If the robot is unknown.
        """
        self._session.control(robot).clear_emergency_stop()
