"""Driving a base by keyboard or gamepad: a command holds only as long as the browser repeats it."""

from dataclasses import dataclass
from typing import Any

from drake_twin.errors import InputError
from drake_twin.twin.twin import Twin

_TWIST, _STAMPED = "geometry_msgs/msg/Twist", "geometry_msgs/msg/TwistStamped"
_FRAMES_WITHOUT_WORD = 15  # after half a second without a word from the browser the base is stopped


@dataclass
class _Driver:
    client: int
    velocities: tuple[float, float, float]
    silent_frames: int = 0


class Teleop:
    """Publishes what drivers ask for, once a frame, and a standstill when they are gone.

    Args:
        twin: the twin.
    """

    def __init__(self, twin: Twin):
        self._twin = twin
        self.topics = {
            topic: (item.robot, item.controller)
            for topic, item in twin.commanded.items()
            if item.type in (_TWIST, _STAMPED)
        }
        self._drivers: dict[str, _Driver] = {}

    def drive(self, client: int, topic: str, velocities: tuple[float, float, float]) -> None:
        """Takes a driver's word: forwards (m/s), to the left (m/s), turning left (rad/s).

        Raises:
            InputError: the topic drives no base.
        """
        if topic not in self.topics:
            raise InputError(f"{topic!r} drives no base", value=topic, valid=self.topics)
        self._twin.silence(topic)
        self._drivers[topic] = _Driver(client, velocities)

    def leave(self, client: int) -> None:
        """Stops what a client drove."""
        for driver in self._drivers.values():
            if driver.client == client:
                driver.silent_frames = _FRAMES_WITHOUT_WORD

    def forget(self) -> None:
        """Lets go of everything without a command, after a reset."""
        self._drivers.clear()

    def publish(self) -> None:
        """Publishes this frame's commands; nothing while time stands still.

        Raises:
            InputError: the twin refuses a command; its driver is let go.
        """
        if self._twin.paused:
            return
        for topic, driver in list(self._drivers.items()):
            gone = driver.silent_frames >= _FRAMES_WITHOUT_WORD
            velocities = (0.0, 0.0, 0.0) if gone else driver.velocities
            if gone or not any(velocities):
                del self._drivers[topic]
            driver.silent_frames += 1
            try:
                self._twin.publish(topic, self._message(topic, velocities))
            except InputError:
                self._drivers.pop(topic, None)
                raise

    def _message(self, topic: str, velocities: tuple[float, float, float]) -> dict[str, Any]:
        x, y, turn = velocities
        twist = {"linear": {"x": x, "y": y}, "angular": {"z": turn}}
        return {"twist": twist} if self._twin.commanded[topic].type == _STAMPED else twist
