"""What sensors measure, for the page: points in the scene, pictures, numbers.

A sensor costs nothing until the page asks for it, and nothing again while no browser is connected.
"""

import json
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import fields, is_dataclass
from functools import partial
from itertools import pairwise
from math import ceil
from typing import Any

import numpy as np
from pydrake.math import RigidTransform

from drake_twin.cockpit.color_map import Legend
from drake_twin.cockpit.scene import OVERLAYS, Scene
from drake_twin.cockpit.sensor_points import HEIGHT, RANGE, Measured, measured
from drake_twin.errors import InputError
from drake_twin.planning.sensor_plan import SensorPlan
from drake_twin.sensors.camera import R_SO
from drake_twin.sensors.cameras.picture_messages import pixels
from drake_twin.sensors.cameras.settings import CameraSettings
from drake_twin.twin.twin import Twin

POINTS, PICTURE, NUMBERS = "points", "picture", "numbers"

_VIEWS = {
    "sensor_msgs/msg/LaserScan": POINTS,
    "sensor_msgs/msg/PointCloud": POINTS,
    "sensor_msgs/msg/PointCloud2": POINTS,
    "sensor_msgs/msg/Range": POINTS,
    "sensor_msgs/msg/Image": PICTURE,
    "sensor_msgs/msg/CameraInfo": "",
}
_MOST_A_SECOND = 15.0  # messages: as many as the page has snapshots
_CLOUDS_A_SECOND = 5.0  # of a depth camera, whose clouds are large
_WIDEST = 320  # pixels of a picture on the page
_MOST_POSES = 1000  # of a camera, whose message is awaited
_SIZE = 0.035  # m, of a point
_COLORS = ((0.91, 0.25, 0.20), (0.13, 0.47, 0.85), (0.95, 0.62, 0.10), (0.55, 0.25, 0.75), (0.10, 0.60, 0.45))
_UNITS = {
    "angular_velocity": "rad/s",
    "linear_acceleration": "m/s²",
    "force": "N",
    "torque": "N·m",
    "position": "m",
    "linear": "m/s",
    "angular": "rad/s",
    "magnetic_field": "T",
    "fluid_pressure": "Pa",
    "temperature": "°C",
    "latitude": "°",
    "longitude": "°",
    "altitude": "m",
    "vertical_position": "m",
    "vertical_velocity": "m/s",
    "vertical_reference": "m",
}


class SensorView:
    """The sensors that a page can show.

    Args:
        twin: The twin.
        scene: The page's scene.
        send: Sends a picture to all browsers: its key, and a JSON line with its bytes.
    """

    def __init__(self, twin: Twin, scene: Scene, send: Callable[[str, bytes], None]):
        self._twin, self._scene, self._send = twin, scene, send
        self._plans: dict[str, tuple[str, SensorPlan]] = {}
        self._shown: dict[str, _Shown] = {}
        self._is_watched = False
        self.read_robots()

    def read_robots(self) -> None:
        """Read the twin's present robots; what is gone is shown no more."""
        self._plans = {f"{owner}/{item.place}": (owner, item) for owner, item in self._twin.entities.sensors}
        for key in [key for key in self._shown if key not in self._plans]:
            self.show(key, False)

    def listing(self) -> list[dict[str, Any]]:
        """Return the sensors as plain data: key, robot, name, kind, topics, rate (Hz), and what is shown of each."""
        return [
            {
                "key": key,
                "robot": robot,
                "name": plan.sensor.name,
                "kind": plan.sensor.kind,
                "on": plan.sensor.link or plan.sensor.joint,
                "topics": [topic.topic for topic in plan.topics if topic.topic is not None],
                "rate": plan.rate,
                "views": [view for _, view in _shown_topics(plan)],
            }
            for key, (robot, plan) in self._plans.items()
        ]

    def show(self, key: str, on: bool) -> None:
        """Show a sensor, or show it no more.

        Raises:
            InputError: If it is unknown, or publishes nothing that can be shown.
        """
        if not on:
            if key in self._shown:
                self._shown.pop(key).end()
            return
        if key not in self._plans:
            raise InputError(f"unknown sensor {key!r}", value=key, valid=self._plans)
        robot, plan = self._plans[key]
        if not _shown_topics(plan):
            raise InputError(f"sensor {key!r} cannot be shown: no bridge carries it to ROS")
        if key not in self._shown:
            self._shown[key] = _Shown(self._twin, self._scene, self._send, key, robot, plan, len(self._shown))
            self._shown[key].listen(self._is_watched)

    def color(self, key: str, by: str) -> None:
        """Color the points of a sensor that is shown by something else.

        Raises:
            InputError: If the sensor is not shown, or its points cannot be colored so.
        """
        if key not in self._shown:
            raise InputError(f"sensor {key!r} is not shown", value=key, valid=self._shown)
        if by not in self._shown[key].choices:
            raise InputError(f"the points of {key!r} have no {by!r}", value=by, valid=self._shown[key].choices)
        self._shown[key].color(by)

    def show_all(self) -> None:
        """Show all sensors that can be shown."""
        for key, (_, plan) in self._plans.items():
            if _shown_topics(plan):
                self.show(key, True)

    def watch(self, is_watched: bool) -> None:
        """Begin or end to listen: a sensor measures nothing while no browser is connected."""
        if is_watched != self._is_watched:
            self._is_watched = is_watched
            for item in self._shown.values():
                item.listen(is_watched)

    def close(self) -> None:
        """Show nothing."""
        for key in tuple(self._shown):
            self.show(key, False)

    def state(self) -> dict[str, Any]:
        """Return key → of each sensor that is shown: its last numbers, and what its points are colored by."""
        return {key: item.state() for key, item in self._shown.items()}


class _Shown:
    """A sensor that is shown."""

    def __init__(
        self,
        twin: Twin,
        scene: Scene,
        send: Callable[[str, bytes], None],
        key: str,
        robot: str,
        plan: SensorPlan,
        number: int,
    ):
        self._twin, self._scene, self._send = twin, scene, send
        self._key, self._robot, self._plan = key, robot, plan
        self.colored_by = _usual_color(plan)
        self.legend: Legend | None = None
        self.choices: tuple[str, ...] = ()
        self._met = (Measured(np.zeros((0, 3)), None), np.zeros((0, 3)))
        self._color = _COLORS[number % len(_COLORS)]
        self._path = f"{OVERLAYS}/measured/{key}"
        self._ends: list[Callable[[], None]] = []
        self._poses: deque[tuple[float, RigidTransform]] = deque(maxlen=_MOST_POSES)
        self.numbers: dict[str, Any] = {}

    def state(self) -> dict[str, Any]:
        """Return time (s) and groups of named values, if there are, and the legend of its points."""
        legend = None if self.legend is None else self.legend.as_plain()
        return {**self.numbers, "legend": legend, "choices": self.choices, "colored_by": self.colored_by}

    def listen(self, on: bool) -> None:
        for end in self._ends:
            end()
        self._ends = []
        self._poses.clear()
        if not on:
            return
        is_late = isinstance(self._plan.settings, CameraSettings)
        for topic, view in _shown_topics(self._plan):
            act: dict[str, Callable[[Any], None]] = {POINTS: self._draw, PICTURE: partial(self._picture, topic)}
            most = _CLOUDS_A_SECOND if is_late and view == POINTS else _MOST_A_SECOND
            rate = self._plan.rate / ceil(self._plan.rate / most - 1e-9) if self._plan.rate else most
            if is_late and view == POINTS:
                self._ends.append(self._twin.subscribe("/clock", self._note_pose, rate))
            self._ends.append(self._twin.subscribe(topic, act.get(view, self._note), rate))

    def end(self) -> None:
        self.listen(False)
        self._scene.delete(self._path)

    def _note_pose(self, _clock: Any) -> None:
        """Note the pose of a camera at a measurement, whose message comes later."""
        while self._poses and self._poses[-1][0] >= self._twin.time:  # after a jump back in time
            self._poses.pop()
        self._poses.append((self._twin.time, self._pose()))

    def _pose(self) -> RigidTransform:
        return self._twin.sensor(self._robot, self._plan.place).pose

    def _draw(self, message: Any) -> None:
        """Draw what was met, where the sensor was at the time of the measurement."""
        stamp = message.header.stamp.sec + 1e-9 * message.header.stamp.nanosec
        while len(self._poses) > 1 and self._poses[1][0] <= stamp + 1e-6:
            self._poses.popleft()
        X_WS = self._poses[0][1] if self._poses else self._pose()
        if isinstance(self._plan.settings, CameraSettings) and self._plan.settings.plugin:
            X_WS = X_WS @ RigidTransform(R_SO, np.zeros(3))  # its points are in the optical frame
        met = measured(message)
        points = X_WS.multiply(met.points.T).T
        if hasattr(message, "field_of_view"):
            eye = X_WS.translation()
            sides = [(eye, points[0]), *pairwise(points), (points[-1], eye)] if len(points) else []
            self._scene.set_lines(self._path, np.array(sides).reshape(-1, 3), self._color)
        else:
            self._met = (met, points)
            self.choices = met.choices
            self.color(self.colored_by)

    def color(self, by: str) -> None:
        """Color the points that were drawn last, and all further ones."""
        self.colored_by, (met, points) = by, self._met
        colors, self.legend = met.colors(by, points)
        self._scene.set_points(self._path, points, self._color if colors is None else colors, _SIZE)

    def _picture(self, topic: str, message: Any) -> None:
        self._send(topic, tile(self._key, topic, message))

    def _note(self, message: Any) -> None:
        self.numbers = {"time": round(self._twin.time, 6), "groups": list(groups_of(message))}


def _usual_color(plan: SensorPlan) -> str:
    """Return what points are colored by at first: the heights of several rows tell what they have met, ranges else."""
    is_flat = not isinstance(plan.settings, CameraSettings) and getattr(plan.settings, "grid", None) is not None
    return RANGE if is_flat and plan.settings.grid.rows == 1 else HEIGHT


def _shown_topics(plan: SensorPlan) -> list[tuple[str, str]]:
    """Return the topics of a sensor that are shown, each with how; of a lidar's scan and points one is enough."""
    views = {
        topic.topic: _VIEWS.get(topic.type, NUMBERS)
        for topic in plan.topics
        if topic.topic is not None and _VIEWS.get(topic.type, NUMBERS)
    }
    if PICTURE in views.values():
        return list(views.items())
    rays = [topic for topic, view in views.items() if view == POINTS]
    if len(rays) > 1:
        has_rows = plan.settings.grid.rows > 1
        rays = [topic.topic for topic in plan.topics if topic.topic in rays and ("Cloud" in topic.type) == has_rows]
        return [(rays[0], POINTS)]
    return list(views.items())


def tile(key: str, topic: str, message: Any) -> bytes:
    """Return the picture of a sensor's message as browsers are sent it: a JSON line with what it is, and its bytes."""
    picture, legend = small_picture(pixels(message))
    height, width = picture.shape[:2]
    head = {"key": key, "topic": topic, "width": width, "height": height}
    head |= {"size": [message.width, message.height], "encoding": message.encoding}
    head["legend"] = None if legend is None else legend.as_plain()
    return json.dumps(head).encode() + b"\n" + picture.tobytes()


def small_picture(picture: np.ndarray) -> tuple[np.ndarray, Legend | None]:
    """Return a picture as bytes, (height, width, 3), with fewer pixels, and the legend of depths.

    Depths (m) have the colors of the map, the nearest are yellow; what has no depth is black.
    """
    every = -(-picture.shape[1] // _WIDEST)
    small = picture[::every, ::every]
    if picture.ndim == 2 and picture.dtype.kind == "f":
        legend = Legend.of(picture, "depth", "m", is_reversed=True)
        if legend is None:
            return np.zeros((*small.shape, 3), dtype=np.uint8), None
        colors = np.where(np.isfinite(small)[..., np.newaxis], 255.0 * legend.colors(small), 0.0)
        return np.round(colors).astype(np.uint8), legend
    shades = (small >> 8 if picture.dtype == np.uint16 else small).astype(np.uint8)
    rgb = shades if shades.ndim == 3 else np.repeat(shades[:, :, np.newaxis], 3, axis=2)
    return np.ascontiguousarray(rgb), None


def groups_of(message: Any, name: str = "") -> Iterator[dict[str, Any]]:
    """Yield the numbers of a message in groups: name, unit, labels and values; covariances and headers are left out."""
    own: dict[str, float] = {}
    for item in fields(message):
        value = getattr(message, item.name)
        if item.name == "header" or "covariance" in item.name or item.name == "status":
            continue
        if item.name in ("contacts", "states") and isinstance(value, list):
            yield _group(item.name, {"number": float(len(value))})
            yield _group("force", {"sum": sum(map(_force, value))})
        elif is_dataclass(value):
            yield from groups_of(value, item.name)
        elif isinstance(value, int | float) and not isinstance(value, bool):
            own[item.name] = float(value)
    for unit in dict.fromkeys(_UNITS.get(field, "") for field in own):
        same = {field: value for field, value in own.items() if _UNITS.get(field, "") == unit}
        yield _group(name or next(iter(same)), same)


def _group(name: str, values: Mapping[str, float]) -> dict[str, Any]:
    rounded = [round(value, 6) if np.isfinite(value) else 0.0 for value in values.values()]
    return {"name": name, "unit": _UNITS.get(name, ""), "labels": list(values), "values": rounded}


def _force(contact: Any) -> float:
    """Return the size of the force of a contact (N): of Gazebo's ``Contact``, or of classic's ``ContactState``."""
    wrenches: Iterable[Any] = (
        [item.body_1_wrench for item in contact.wrenches]
        if hasattr(contact.wrenches[0] if contact.wrenches else None, "body_1_wrench")
        else contact.wrenches
    )
    forces = np.array([(wrench.force.x, wrench.force.y, wrench.force.z) for wrench in wrenches]).reshape(-1, 3)
    return float(np.linalg.norm(forces.sum(axis=0)))
