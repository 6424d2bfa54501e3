"""Lesson 2: several robots in one world, kept apart by their names, and a NumPy program that commands them.

Run it: python diagrams/several_robots.py

One xacro file serves all robots: its argument robot_name is the robot's name in the twin, so links, joints, frames,
topics and the entries of the controllers YAML differ from robot to robot.
"""

import numpy as np

from drake_twin import TwinBuilder, messages

ROVER = "package://rover_description/urdf/rover.urdf.xacro"
NAMES = ("robot_1", "robot_2", "robot_3")

builder = TwinBuilder()
for number, name in enumerate(NAMES):
    builder.robot(name, ROVER, xyz=(0, 2 * number, 0.13)).static_transform("world", f"{name}_odom")
twin = builder.build()

print("topics of robot_1:", *(topic for topic in twin.graph.topics() if topic.startswith("/robot_1/")), sep="\n  ")


class Commander:
    """Drives a rover straight ahead, faster and slower, as a node would: it hears messages and publishes one."""

    def __init__(self, name, speed):
        self.topic = f"/{name}/forward_velocity_controller/commands"
        self.speed = speed  # rad/s of each wheel
        twin.subscribe(f"/{name}/joint_states", self.on_joint_states, rate=20)

    def on_joint_states(self, message):
        time = message.header.stamp.sec + 1e-9 * message.header.stamp.nanosec
        wheels = self.speed * np.full(4, 1 - 0.5 * np.cos(np.pi * time))
        twin.publish(self.topic, messages.Float64MultiArray(layout=LAYOUT, data=wheels))


LAYOUT = messages.MultiArrayLayout(dim=[], data_offset=0)
commanders = [Commander(name, speed) for name, speed in zip(NAMES, (6.0, 3.0, 0.0), strict=True)]
frames = {transform.child_frame_id for transform in twin.latest("/tf").transforms}
twin.advance_to(4.0)

for name in NAMES:
    x, y, *_ = twin.robot_state(name).base_pose
    print(f"{name} is at x {x:.3f} m, y {y:.3f} m")
far, near, still = (twin.robot_state(name).base_pose[0] for name in NAMES)
assert far > 1.8 * near > 0.5
assert abs(still) < 1e-6  # the others do not move it
assert {f"{name}_front_left_wheel" for name in NAMES} <= frames
