"""What the sensors of a bag measured: pictures as tiles, points in the scene, at the bag's moment."""

from collections.abc import Callable
from typing import Any

import numpy as np

from drake_twin.cockpit.color_map import Legend
from drake_twin.cockpit.scene import OVERLAYS, Scene
from drake_twin.cockpit.sensor_points import HEIGHT, RANGE, Measured, measured
from drake_twin.cockpit.sensor_view import tile
from drake_twin.dataclass import dataclass
from drake_twin.errors import InputError
from drake_twin.messages.transform_tree import Transform
from drake_twin.playback.bag import Bag, BagMessage

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
        self._clouds: dict[str, _Cloud] = {}

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
            self._clouds.pop(key, None)
            self._scene.delete(_path(key))

    def color(self, key: str, by: str) -> None:
        """Color the points of a topic that is shown by something else.

        Raises:
            InputError: If it is not shown, or its points cannot be colored so.
        """
        cloud = self._clouds.get(key)
        if cloud is None:
            raise InputError(f"sensor {key!r} is not shown", value=key, valid=self._clouds)
        if by not in cloud.met.choices:
            raise InputError(f"the points of {key!r} have no {by!r}", value=by, valid=cloud.met.choices)
        cloud.by = by
        self._color(key, cloud)

    def state(self) -> dict[str, Any]:
        """Draw what is shown at the bag's moment, and return what is shown, with what its points are colored by."""
        now = self._now()
        if now != self._looked:
            self._looked = now
            for topic, drawn in self._shown.items():
                message = self._bag.last(topic, now)
                if message is not None and message.time != drawn:
                    self._shown[topic] = message.time
                    self._draw(message)
        return {
            key: {"time": now, "groups": [], **(self._clouds[key].as_plain() if key in self._clouds else {})}
            for key in self._shown
        }

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
            self._send(recorded.topic, tile(recorded.topic, recorded.topic, message))
            return
        pose = self._place(message.header.frame_id)
        met = measured(message)
        points = met.points
        if pose is not None:
            points = pose.rotation.apply(points) + pose.translation if len(points) else np.zeros((0, 3))
        known = self._clouds.get(recorded.topic)
        by = known.by if known is not None else HEIGHT if hasattr(message, "point_step") else RANGE
        self._clouds[recorded.topic] = cloud = _Cloud(met, points, by)
        self._color(recorded.topic, cloud)

    def _color(self, topic: str, cloud: "_Cloud") -> None:
        colors, cloud.legend = cloud.met.colors(cloud.by, cloud.points)
        self._scene.set_points(_path(topic), cloud.points, _COLOR if colors is None else colors, _SIZE)


@dataclass
class _Cloud:
    """Points that are drawn: what was measured, where they are in the world (m), and what colors them."""

    met: Measured
    points: np.ndarray
    by: str
    legend: Legend | None = None

    def as_plain(self) -> dict[str, Any]:
        legend = None if self.legend is None else self.legend.as_plain()
        return {"legend": legend, "choices": self.met.choices, "colored_by": self.by}


def _path(topic: str) -> str:
    return f"{OVERLAYS}/measured/{topic.strip('/')}"
