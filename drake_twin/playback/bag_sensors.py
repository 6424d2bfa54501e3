"""What the sensors of a bag measured: pictures as tiles, points in the scene, at the bag's moment."""

import json
from collections.abc import Callable
from typing import Any

import numpy as np

from drake_twin.cockpit.color_map import Legend
from drake_twin.cockpit.scene import OVERLAYS, Scene
from drake_twin.cockpit.sensor_points import HEIGHT, INTENSITY, PLAIN, RANGE, UNITS, Measured, measured
from drake_twin.cockpit.sensor_view import small_picture
from drake_twin.errors import InputError
from drake_twin.messages.transform_tree import Transform
from drake_twin.playback.bag import Bag, BagMessage
from drake_twin.sensors.cameras.picture_messages import pixels

_IMAGE = "sensor_msgs/msg/Image"
_RAYS = tuple(f"sensor_msgs/msg/{name}" for name in ("LaserScan", "PointCloud", "PointCloud2", "Range"))
_COLOR = (0.91, 0.25, 0.20)
_SIZE = 0.035  # m, of a point


class BagSensors:
    """The pictures and rays of a bag, each read only while it is shown.

    Args:
        bag: The bag.
        now: Returns the bag's moment (s).
        place: Returns the pose of a frame in the world; None if it is not known.
        scene: The page's scene.
        send: Sends a picture to all browsers: its key, and a JSON line with its bytes.
    """

    def __init__(
        self,
        bag: Bag,
        now: Callable[[], float],
        place: Callable[[str], Transform | None],
        scene: Scene,
        send: Callable[[str, bytes], None],
    ):
        self._bag, self._now, self._place, self._scene, self._send = bag, now, place, scene, send
        self._topics = {topic: kind for topic, (kind, _) in sorted(bag.topics.items()) if kind in (_IMAGE, *_RAYS)}
        self._shown: dict[str, float | None] = {}  # → the time of the message that is drawn (s)
        self._colored: dict[str, _Colored] = {}
        self._looked: float | None = None

    def listing(self) -> list[dict[str, Any]]:
        """Return the topics as the page's sensors."""
        return [
            {
                "key": topic,
                "robot": "",
                "name": topic.strip("/"),
                "kind": kind.rpartition("/")[2],
                "on": "",
                "topics": [topic],
                "rate": None,
                "views": ["picture" if kind == _IMAGE else "points"],
            }
            for topic, kind in self._topics.items()
        ]

    def show(self, key: str, on: bool) -> None:
        """Show a topic, or show it no more.

        Raises:
            InputError: If it is unknown.
        """
        if key not in self._topics:
            raise InputError(f"unknown sensor {key!r}", value=key, valid=self._topics)
        self._looked = None
        if on:
            self._shown.setdefault(key, None)
        elif key in self._shown:
            del self._shown[key]
            self._colored.pop(key, None)
            self._scene.delete(_path(key))

    def state(self) -> dict[str, Any]:
        """Draw what is shown at the bag's moment, and return the keys of what is shown."""
        now = self._now()
        if now != self._looked:
            self._looked = now
            for topic, drawn in self._shown.items():
                message = self._bag.last(topic, now)
                if message is not None and message.time != drawn:
                    self._shown[topic] = message.time
                    self._draw(message)
        return {key: {"time": now, "groups": [], **self._colored.get(key, _UNCOLORED).state()} for key in self._shown}

    def color(self, key: str, by: str) -> None:
        """Color the points of a topic that is shown by something else.

        Raises:
            InputError: If the topic is not shown, or its points cannot be colored so.
        """
        if key not in self._colored:
            raise InputError(f"sensor {key!r} is not shown", value=key, valid=self._colored)
        if by not in self._colored[key].choices:
            raise InputError(f"the points of {key!r} have no {by!r}", value=by, valid=self._colored[key].choices)
        self._colored[key].draw(self._scene, by)

    def watch(self, is_watched: bool) -> None:
        """Send pictures again to those who come."""
        self._looked = None
        self._shown = dict.fromkeys(self._shown)

    def read_robots(self) -> None:
        """Do nothing: a bag's robots stay."""

    def close(self) -> None:
        """Show nothing any more."""
        for key in tuple(self._shown):
            self.show(key, False)

    def _draw(self, recorded: BagMessage) -> None:
        message = recorded.read()
        if recorded.type == _IMAGE:
            picture, legend = small_picture(pixels(message))
            height, width = picture.shape[:2]
            head = {"key": recorded.topic, "topic": recorded.topic, "width": width, "height": height}
            head |= {"size": [message.width, message.height], "encoding": message.encoding}
            head["legend"] = None if legend is None else legend.as_plain()
            self._send(recorded.topic, json.dumps(head).encode() + b"\n" + picture.tobytes())
            return
        pose, met = self._place(message.header.frame_id), measured(message)
        points = met.points
        if pose is not None and len(points):
            points = pose.rotation.apply(points) + pose.translation
        before = self._colored.get(recorded.topic)
        by = before.by if before is not None else HEIGHT if hasattr(message, "point_step") else RANGE
        self._colored[recorded.topic] = _Colored(recorded.topic, met, points)
        self._colored[recorded.topic].draw(self._scene, by)


class _Colored:
    """The points of a topic in the world (m), colored by something."""

    def __init__(self, topic: str, met: Measured, points: np.ndarray):
        self._topic, self._met, self._points = topic, met, points
        self.choices = (RANGE, HEIGHT, *((INTENSITY,) if met.intensities is not None else ()), PLAIN) if topic else ()
        self.by = RANGE
        self._legend: Legend | None = None

    def draw(self, scene: Scene, by: str) -> None:
        self.by = by
        values = self._met.values(by, self._points)
        self._legend = None if values is None else Legend.of(values, by, UNITS[by])
        colors = _COLOR if values is None or self._legend is None else self._legend.colors(values)
        scene.set_points(_path(self._topic), self._points, colors, _SIZE)

    def state(self) -> dict[str, Any]:
        legend = None if self._legend is None else self._legend.as_plain()
        return {"legend": legend, "choices": self.choices, "colored_by": self.by}


_UNCOLORED = _Colored("", Measured(np.zeros((0, 3)), None), np.zeros((0, 3)))


def _path(topic: str) -> str:
    return f"{OVERLAYS}/measured/{topic.strip('/')}"
