"""What the sensors of a bag measured: pictures as tiles, points in the scene, at the bag's moment."""

import json
from collections.abc import Callable
from typing import Any

import numpy as np

from drake_twin.cockpit.scene import OVERLAYS, Scene
from drake_twin.cockpit.sensor_view import height_colors, points_of, small_picture
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
        return {key: {"time": now, "groups": []} for key in self._shown}

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
            picture = small_picture(pixels(message))
            head = {
                "key": recorded.topic,
                "topic": recorded.topic,
                "width": picture.shape[1],
                "height": picture.shape[0],
            }
            self._send(recorded.topic, json.dumps(head).encode() + b"\n" + picture.tobytes())
            return
        pose = self._place(message.header.frame_id)
        points = points_of(message)
        if pose is not None:
            points = pose.rotation.apply(points) + pose.translation if len(points) else np.zeros((0, 3))
        colors = height_colors(points) if hasattr(message, "point_step") else _COLOR
        self._scene.set_points(_path(recorded.topic), points, colors, _SIZE)


def _path(topic: str) -> str:
    return f"{OVERLAYS}/measured/{topic.strip('/')}"
