"""The controllers of a twin's robots: their managers, goals and emergency stops."""

from drake_twin.twin.controller_manager import ControllerManager
from drake_twin.twin.group import Group
from drake_twin.twin.recording import recorded


class Control(Group):
    """The controllers of all robots; `Twin.control`."""

    def manager(self, robot: str) -> ControllerManager:
        """Return the controller manager of a robot; its methods are named like the services of ROS 2.

        Raises:
            InputError: If the robot is unknown.
        """
        return self._session.control(robot).manager

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
