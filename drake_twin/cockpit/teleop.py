"""Driving a base by keyboard or gamepad: a command holds only while the browser repeats it."""

from typing import Any

from drake_twin.dataclass import dataclass
from drake_twin.errors import InputError
from drake_twin.twin.twin import Twin

Velocities = tuple[float, float, float, float]  # forward, to the left (m/s), turning left (rad/s), upwards (m/s)

_TWIST, _STAMPED = "geometry_msgs/msg/Twist", "geometry_msgs/msg/TwistStamped"
_MOST_SILENT_FRAMES = 15  # half a second without a request from the browser, after which the base is stopped


@dataclass
class _Driver:
    client: int
    velocities: Velocities
    silent_frames: int = 0


class Teleop:
    """Publishes the requested velocities once a frame, and zero when the driver has gone.

    Args:
        twin: The twin.

    Attributes:
        topics: Velocity topic → its robot and controller.
    """

    def __init__(self, twin: Twin):
        self._twin = twin
        self.topics = {
            topic: (item.robot, item.controller)
            for topic, item in twin.built.commanded.items()
            if item.type in (_TWIST, _STAMPED)
        }
        self._drivers: dict[str, _Driver] = {}

    def flies(self, topic: str) -> bool:
        """Return whether what a topic drives can go upwards."""
        robot, controller = self.topics[topic]
        return self._twin.built.parts[robot].controllers[controller].flies

    def drive(self, client: int, topic: str, velocities: Velocities) -> None:
        """Set the velocities of a base.

        Raises:
            InputError: If the topic does not drive a base.
        """
        if topic not in self.topics:
            raise InputError(f"{topic!r} does not drive a base", value=topic, valid=self.topics)
        self._twin.graph.silence(topic)
        self._drivers[topic] = _Driver(client, velocities)

    def leave(self, client: int) -> None:
        """Stop the bases that a client drives."""
        for driver in self._drivers.values():
            if driver.client == client:
                driver.silent_frames = _MOST_SILENT_FRAMES

    def forget(self) -> None:
        """Forget all drivers without a command, after a reset."""
        self._drivers.clear()

    def publish(self) -> None:
        """Publish this frame's commands, unless the twin is paused; drop those for controllers that are not active.

        Raises:
            InputError: If the twin refuses a command; its driver is forgotten.
        """
        if not self._drivers or self._twin.clock.paused:
            return
        for topic, driver in list(self._drivers.items()):
            robot, controller = self.topics[topic]
            if not self._twin.control.manager(robot).is_active(controller):
                del self._drivers[topic]
                continue
            gone = driver.silent_frames >= _MOST_SILENT_FRAMES
            velocities = (0.0, 0.0, 0.0, 0.0) if gone else driver.velocities
            if gone or not any(velocities):
                del self._drivers[topic]
            driver.silent_frames += 1
            try:
                self._twin.publish(topic, self._message(topic, velocities))
            except InputError:
                self._drivers.pop(topic, None)
                raise

    def _message(self, topic: str, velocities: Velocities) -> dict[str, Any]:
        x, y, turn, up = velocities
        twist = {"linear": {"x": x, "y": y, "z": up}, "angular": {"z": turn}}
        return {"twist": twist} if self._twin.built.commanded[topic].type == _STAMPED else twist
