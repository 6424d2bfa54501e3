"""``joint_state_publisher``: a position for each joint of a description, from other topics where these have it.

Source: ros/joint_state_publisher (ros2), joint_state_publisher.py. It is Python there as well; here it runs where the
workspace does not have it. ``delta`` and descriptions in SDF or COLLADA are not there.
"""

import sys
from collections.abc import Iterator
from math import pi
from typing import Any
from xml.etree import ElementTree

import rclpy
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from rclpy.utilities import remove_ros_args
from sensor_msgs.msg import JointState
from std_msgs.msg import String

from drake_twin.description.source_file import file_text

# What the parameters publish_default_… speak of → the field of the message.
_DEFAULTS = {"positions": "position", "velocities": "velocity", "efforts": "effort"}


class JointStatePublisher(Node):
    """Publishes ``joint_states``."""

    def __init__(self) -> None:
        super().__init__("joint_state_publisher", automatically_declare_parameters_from_overrides=True)
        defaults = {name: self._parameter(f"publish_default_{name}", name == "positions") for name in _DEFAULTS}
        self._default_values = [value for name, value in _DEFAULTS.items() if defaults[name]]
        self._has_mimics = self._parameter("use_mimic_tags", True)
        self._has_soft_limits = self._parameter("use_smallest_joint_limits", True)
        if self._parameter("delta", 0.0):
            raise SystemExit("the parameter delta is not supported: use publishers of source_list to move joints")
        self._zeros = {name: item.value for name, item in self.get_parameters_by_prefix("zeros").items()}
        self._names: list[str] = []
        self._free: dict[str, dict[str, float]] = {}
        self._mimics: dict[str, tuple[str, float, float]] = {}
        files = remove_ros_args(sys.argv)[1:]
        if files:
            self._read(file_text(files[0]))
        qos = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        self.create_subscription(String, "robot_description", self._hear_description, qos)
        for source in self._parameter("source_list", []):
            self.create_subscription(JointState, source, self._hear, 10)
        self._publisher = self.create_publisher(JointState, "joint_states", 10)
        self.create_timer(1.0 / self._parameter("rate", 10), self._publish)

    def _parameter(self, name: str, default: Any) -> Any:
        return (self.get_parameter(name) if self.has_parameter(name) else self.declare_parameter(name, default)).value

    def _hear_description(self, message: String) -> None:
        try:
            self._read(message.data)
        except (ElementTree.ParseError, ValueError) as error:
            self.get_logger().warning(str(error))

    def _read(self, description: str) -> None:
        robot = ElementTree.fromstring(description)
        if robot.tag != "robot":
            raise ValueError(f"a description that begins with <{robot.tag}> is not supported: it must be a URDF")
        joints = [joint for joint in robot.findall("joint") if joint.get("type") not in ("fixed", "floating", "planar")]
        mimics = {joint.get("name", ""): joint.find("mimic") for joint in joints if self._has_mimics}
        self._names = [joint.get("name", "") for joint in joints]
        self._mimics = {name: _mimic(tag) for name, tag in mimics.items() if tag is not None}
        zeros = {joint.get("name", ""): self._zero(joint) for joint in joints}
        self._free = {
            name: {value: zero if value == "position" else 0.0 for value in self._default_values}
            for name, zero in zeros.items()
            if name not in self._mimics
        }
        for name in self._mimics:
            self._source_of(name)

    def _zero(self, joint: ElementTree.Element) -> float:
        name = joint.get("name", "")
        low, high = _limits(joint)
        if self._has_soft_limits and (soft := joint.find("safety_controller")) is not None:
            low = max(low, float(soft.get("soft_lower_limit", low)))
            high = min(high, float(soft.get("soft_upper_limit", high)))
        return float(self._zeros.get(name, (low + high) / 2 if low > 0 or high < 0 else 0.0))

    def _source_of(self, name: str) -> tuple[str, float, float]:
        """Return the free joint that a joint follows, with the factor and the offset (rad or m)."""
        factor, offset, seen = 1.0, 0.0, [name]
        while name in self._mimics:
            name, own_factor, own_offset = self._mimics[name]
            if name in seen:
                raise ValueError(f"Found an infinite recursive mimic chain: {[*seen, name]}")
            seen.append(name)
            offset += factor * own_offset
            factor *= own_factor
        if name not in self._free:
            raise ValueError(f"joint {seen[0]!r} follows {name!r}, which does not exist or does not move")
        return name, factor, offset

    def _hear(self, message: JointState) -> None:
        for place, name in enumerate(message.name):
            if name in self._free:
                values = zip(_DEFAULTS.values(), (message.position, message.velocity, message.effort), strict=True)
                self._free[name].update({value: items[place] for value, items in values if len(items) > place})

    def _publish(self) -> None:
        if not self._names:
            return
        message = JointState(name=self._names)
        message.header.stamp = self.get_clock().now().to_msg()
        for value in _DEFAULTS.values():
            if any(value in known for known in self._free.values()) or (value == "position" and self._mimics):
                setattr(message, value, [*self._values(value)])
        self._publisher.publish(message)

    def _values(self, value: str) -> Iterator[float]:
        """Yield the values of all joints; an effort is not multiplied for a joint that follows another."""
        for name in self._names:
            free, factor, offset = self._source_of(name)
            known = self._free[free].get(value)
            if known is None:
                yield 0.0
            else:
                yield known * (1.0 if value == "effort" else factor) + (offset if value == "position" else 0.0)


def _limits(joint: ElementTree.Element) -> tuple[float, float]:
    kind, limit = joint.get("type"), joint.find("limit")
    if kind == "continuous":
        return -pi, pi
    where = f'for joint "{joint.get("name")}" of type "{kind}"'
    if limit is None:
        raise ValueError(f"Limits must be specified {where}")
    low, high = limit.get("lower"), limit.get("upper")
    if low is None or high is None:
        raise ValueError(f'"{"lower" if low is None else "upper"}" limit must be specified {where}')
    return float(low), float(high)


def _mimic(tag: ElementTree.Element) -> tuple[str, float, float]:
    return tag.get("joint", ""), float(tag.get("multiplier", 1.0)), float(tag.get("offset", 0.0))


def main() -> None:
    """Run the node."""
    rclpy.init()
    rclpy.spin(JointStatePublisher())
