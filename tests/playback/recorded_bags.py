"""Bags to play: of a twin, and written by rosbags as another program's."""

import numpy as np
from rosbags.rosbag2 import StoragePlugin, Writer

from drake_twin.messages import TFMessage, time_message, type_store
from drake_twin.messages.interface_types import make, serialize
from drake_twin.wires.bag_wire import BagWire
from drake_twin.wires.seam import Seam

TEXT, TRANSFORMS, STATES = "std_msgs/msg/String", "tf2_msgs/msg/TFMessage", "sensor_msgs/msg/JointState"
HALF = 0.5**0.5  # a quarter turn's quaternion components

CART = """<robot name="cart">
  <link name="base"><visual><geometry><box size="1 1 1"/></geometry></visual></link>
  <link name="mast"><visual><geometry><box size="0.1 0.1 1"/></geometry></visual></link>
  <joint name="lift" type="prismatic">
    <parent link="base"/><child link="mast"/><axis xyz="0 0 1"/><limit lower="0" upper="1" effort="1" velocity="1"/>
  </joint>
  <ros2_control name="c" type="system"><hardware><plugin>somebody/Hardware</plugin></hardware>
    <joint name="lift"><command_interface name="position"/></joint></ros2_control>
  <gazebo><plugin filename="x" name="x"><parameters>/home/somebody/controllers.yaml</parameters></plugin></gazebo>
</robot>"""


def record(twin, folder, until, each=None):
    """Writes a bag of a twin's run; calls `each` with the twin at every message of /tf."""
    seam = Seam(twin, [BagWire(folder)])
    if each is not None:
        twin.subscribe("/tf", lambda message: each(message))
    twin.advance_to(until)
    seam.close()


def transforms(*items):
    """A TFMessage of (parent, child, xyz, quaternion, seconds)."""
    types = type_store().types
    found = []
    for parent, child, xyz, quaternion, seconds in items:
        header = types["std_msgs/msg/Header"](time_message(seconds), parent)
        pose = types["geometry_msgs/msg/Transform"](
            types["geometry_msgs/msg/Vector3"](*xyz), types["geometry_msgs/msg/Quaternion"](*quaternion)
        )
        found.append(types["geometry_msgs/msg/TransformStamped"](header, child, pose))
    return TFMessage(found)


def joint_state(**positions):
    numbers = np.array([*positions.values()])
    return make(STATES, {"name": [*positions], "position": numbers, "velocity": numbers * 2, "effort": numbers * 3})


def write(folder, messages, plugin=StoragePlugin.SQLITE3, store=None):
    """Writes (topic, type, seconds, message) as another program would; the time is one of the wall clock."""
    with Writer(folder, version=9, storage_plugin=plugin) as writer:
        connections = {}
        for topic, kind, seconds, message in messages:
            if topic not in connections:
                connections[topic] = writer.add_connection(topic, kind, typestore=store or type_store())
            time = 1_700_000_000_000_000_000 + round(seconds * 1e9)
            writer.write(connections[topic], time, message if isinstance(message, bytes) else serialize(message))
    return folder


def cart_messages(namespace="", text=CART):
    """A cart that drives along y of a turned odom frame and lifts its mast, for 2 s."""
    yield f"{namespace}/robot_description", TEXT, 0.0, make(TEXT, {"data": text})
    turned = ("map", "odom", (1.0, 0.0, 0.0), (0.0, 0.0, HALF, HALF), 0.0)
    yield f"{namespace}/tf_static", TRANSFORMS, 0.0, transforms(turned)
    for index in range(21):
        seconds = index / 10
        moved = ("odom", "base", (seconds, 0.0, 0.5), (0.0, 0.0, 0.0, 1.0), seconds)
        yield f"{namespace}/tf", TRANSFORMS, seconds, transforms(moved)
        yield f"{namespace}/joint_states", STATES, seconds, joint_state(lift=seconds / 4)
    yield "/chatter", TEXT, 2.0, make(TEXT, {"data": "hello"})
