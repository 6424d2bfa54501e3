"""What Nav2 does with a robot: localize it in a map, follow a path, and say whether the goal was reached.

Its nodes' parts that touch the robot, with their topics, frames and quality of service: the tf2 listener, AMCL with its
message filter and its transform that is dated ahead, controller_server with pure pursuit and the odometry's twist, and
the costmap's obstacles. Run with the wire, its domain and how many corners of the path to drive to; two more words are
the topic and the type of commands in place of those of the parameters. Prints what it found.
"""

import sys
from collections import deque
from itertools import pairwise
from math import atan2, cos, hypot, sin
from pathlib import Path

import numpy as np
import yaml
from program_runs import MODELS
from scipy.ndimage import distance_transform_edt
from scipy.optimize import least_squares
from wires.outside_node import OutsideNode, run, seconds, stamp_of

CONFIG = MODELS / "rover_navigation" / "config" / "nav2.yaml"
MAP = MODELS / "rover_navigation" / "maps" / "room.yaml"
PATH = [(0.0, 0.0), (1.0, -0.5), (2.4, -0.6), (3.4, 0.4), (4.2, 0.8)]  # around the pillar and the cupboard (m)
_LONGEST_DRIVE = 60.0  # s
_TOLERANCE = 1.0  # s, AMCL's transform_tolerance


def parameters(node, *names):
    """A node's parameter in the rover's file for Nav2."""
    value = yaml.safe_load(CONFIG.read_text("utf-8"))
    for name in (*node.split("/"), "ros__parameters", *names):
        value = value[name]
    return value


class Pose:
    """A transform in the plane."""

    def __init__(self, x, y, yaw):
        self.x, self.y, self.yaw = x, y, yaw

    @staticmethod
    def of(translation, rotation):
        return Pose(translation.x, translation.y, 2 * atan2(rotation.z, rotation.w))

    def __matmul__(self, other):
        x, y = self.apply(other.x, other.y)
        return Pose(x, y, self.yaw + other.yaw)

    def apply(self, x, y):
        return self.x + cos(self.yaw) * x - sin(self.yaw) * y, self.y + sin(self.yaw) * x + cos(self.yaw) * y

    def inverse(self):
        x, y = Pose(0, 0, -self.yaw).apply(-self.x, -self.y)
        return Pose(x, y, -self.yaw)


class Buffer:
    """What a tf2 buffer keeps: for each frame its parent, and where it was there in the last ten seconds."""

    def __init__(self, node):
        self.parents, self.twice, self.backwards, self._kept = {}, [], [], {}
        node.listen("/tf", "tf2_msgs/msg/TFMessage", self._hear, depth=100)
        node.listen("/tf_static", "tf2_msgs/msg/TFMessage", self._hear_static, depth=100, latched=True)

    def _hear(self, message, is_static=False):
        for each in message.transforms:
            parent, child, stamp = each.header.frame_id, each.child_frame_id, seconds(each.header.stamp)
            if self.parents.setdefault(child, parent) != parent:
                self.twice.append(child)
            kept = self._kept.setdefault(child, deque(maxlen=1000))
            if kept and stamp < kept[-1][0]:
                self.backwards.append(child)
            where = float("inf") if is_static else stamp
            kept.append((where, Pose.of(each.transform.translation, each.transform.rotation)))

    def _hear_static(self, message):
        self._hear(message, is_static=True)

    def at(self, child, time):
        """Where a frame is in its parent, between the transforms around a time; None if they are not there."""
        kept = self._kept.get(child, ())
        before = None
        for stamp, pose in kept:
            if stamp >= time:
                if stamp == float("inf") or before is None:
                    return pose if stamp in (time, float("inf")) else None
                share = (time - before[0]) / (stamp - before[0])
                turn = atan2(sin(pose.yaw - before[1].yaw), cos(pose.yaw - before[1].yaw))
                old = before[1]
                x, y = old.x + share * (pose.x - old.x), old.y + share * (pose.y - old.y)
                return Pose(x, y, old.yaw + share * turn)
            before = stamp, pose
        return None

    def newest(self, child):
        return self._kept[child][-1][1] if child in self._kept else None

    def chain(self, child):
        """The frames from one up to the root."""
        frames = [child]
        while frames[-1] in self.parents:
            frames.append(self.parents[frames[-1]])
        return frames


class Map:
    """How far each cell of the map is from a wall, as AMCL's likelihood field."""

    def __init__(self):
        told = yaml.safe_load(MAP.read_text("utf-8"))
        kind, size, _, cells = (MAP.parent / told["image"]).read_bytes().split(b"\n", 3)
        assert kind == b"P5"
        width, height = map(int, size.split())
        picture = np.frombuffer(cells, np.uint8).reshape(height, width)[::-1]
        self._resolution, self._origin = told["resolution"], told["origin"][:2]
        self._far = distance_transform_edt(picture != 0) * self._resolution

    def distances(self, points):
        cells = (points - self._origin) / self._resolution - 0.5
        low = np.clip(np.floor(cells).astype(int), 0, np.array(self._far.shape[::-1]) - 2)
        fx, fy = np.clip(cells - low, 0, 1).T
        x, y = low.T
        bottom = self._far[y, x] * (1 - fx) + self._far[y, x + 1] * fx
        top = self._far[y + 1, x] * (1 - fx) + self._far[y + 1, x + 1] * fx
        return bottom * (1 - fy) + top * fy


class Nav2:
    def __init__(self, node: OutsideNode, topic=None, kind=None):
        self.node = node
        amcl, controller = "amcl", "controller_server"
        self.odom, self.base = parameters(amcl, "odom_frame_id"), parameters(amcl, "base_frame_id")
        self.tolerance = parameters(controller, "general_goal_checker", "xy_goal_tolerance")
        self.speed = parameters(controller, "FollowPath", "desired_linear_vel")
        self.ahead = parameters(controller, "FollowPath", "lookahead_dist")
        self.frequency = parameters(controller, "controller_frequency")
        self.map, self.buffer = Map(), Buffer(node)
        self.scans, self.waiting, self.used, self.fits, self.nearest = [], deque(maxlen=100), 0, [], float("inf")
        self.twists, self.bases, self.correction = [], set(), Pose(0, 0, 0)
        self.tell = node.publisher("/tf", "tf2_msgs/msg/TFMessage", is_heard=False)
        self.is_stamped = kind is None and parameters("collision_monitor", "enable_stamped_cmd_vel")
        topic = topic or parameters("collision_monitor", "cmd_vel_out_topic")
        self.drive = node.publisher(topic, kind or "geometry_msgs/msg/TwistStamped")
        scan = parameters(amcl, "scan_topic")
        node.listen(scan, "sensor_msgs/msg/LaserScan", self._hear_scan, is_best_effort=True, depth=5)
        odometry = parameters("bt_navigator", "odom_topic")
        node.listen(odometry, "nav_msgs/msg/Odometry", self._hear_odometry)

    def _hear_odometry(self, message):
        self.bases.add((message.header.frame_id, message.child_frame_id))
        self.twists.append(message.twist.twist.linear.x)

    def _hear_scan(self, message):
        self.scans.append(seconds(message.header.stamp))
        self.waiting.append(message)

    def filter(self):
        """Take the scans whose frame can be placed in the odometry's at their time, as a tf2 message filter does."""
        while self.waiting:
            scan = self.waiting[0]
            time, frame = seconds(scan.header.stamp), scan.header.frame_id
            pose, mount = self.buffer.at(self.base, time), self.buffer.at(frame, time)
            if pose is None or mount is None or self.buffer.parents[frame] != self.base:
                return
            self.waiting.popleft()
            self.localize(scan, pose @ mount, time)

    def localize(self, scan, lidar, time):
        ranges = np.asarray(scan.ranges)
        angles = scan.angle_min + np.arange(len(ranges)) * scan.angle_increment
        seen = (ranges >= scan.range_min) & (ranges <= scan.range_max)
        self.nearest = min(self.nearest, float(ranges[seen].min()))
        beams = np.stack([ranges * np.cos(angles), ranges * np.sin(angles)], 1)[seen]
        in_odom = np.array([lidar.apply(*beam) for beam in beams])

        def misses(values):
            pose = Pose(*values)
            return self.map.distances(np.stack(pose.apply(in_odom[:, 0], in_odom[:, 1]), 1))

        start = [self.correction.x, self.correction.y, self.correction.yaw]
        found = least_squares(misses, start, loss="soft_l1", f_scale=0.05, max_nfev=10)
        self.correction = Pose(*found.x)
        self.fits.append(float(np.mean(misses(found.x) < 0.1)))
        self.used += 1
        rotation = {"z": sin(self.correction.yaw / 2), "w": cos(self.correction.yaw / 2)}
        self.tell(
            {
                "transforms": [
                    {
                        "header": {"stamp": stamp_of(time + _TOLERANCE), "frame_id": "map"},
                        "child_frame_id": self.odom,
                        "transform": {
                            "translation": {"x": self.correction.x, "y": self.correction.y},
                            "rotation": rotation,
                        },
                    }
                ]
            }
        )

    def pose(self):
        """Where the robot is in the map, by the newest transforms."""
        base = self.buffer.newest(self.base)
        return None if base is None else self.correction @ base

    def send(self, forward, turn):
        twist = {"linear": {"x": forward}, "angular": {"z": turn}}
        header = {"stamp": stamp_of(self.node.time), "frame_id": self.base}
        self.drive({"header": header, "twist": twist} if self.is_stamped else twist)

    def follow(self, path):
        """Follow a path; return how often it was commanded and whether the goal was reached."""
        corners = np.array(path)
        steps = [np.linspace(a, b, int(hypot(*(b - a)) / 0.05), endpoint=False) for a, b in pairwise(corners)]
        points = np.concatenate([*steps, corners[-1:]])
        commanded, next_time, end, passed = 0, self.node.time, self.node.time + _LONGEST_DRIVE, 0
        while self.node.time < end:
            self.node.wait_until(next_time)
            next_time += 1 / self.frequency
            self.filter()
            pose = self.pose()
            if hypot(points[-1][0] - pose.x, points[-1][1] - pose.y) < self.tolerance:
                self.send(0.0, 0.0)
                return commanded, True
            far = np.hypot(*(points - [pose.x, pose.y]).T)
            passed += int(np.argmin(far[passed : passed + 40]))
            ahead = next((index for index in range(passed, len(points)) if far[index] >= self.ahead), len(points) - 1)
            x, y = pose.inverse().apply(*points[ahead])
            curvature = 2 * y / max(x * x + y * y, 1e-6)
            forward = self.speed / max(1.0, abs(curvature))
            self.send(forward, forward * curvature)
            commanded += 1
        return commanded, False


def nav2(node):
    double = Nav2(node, *sys.argv[4:])
    node.spin(lambda: node.time > 0 and double.scans and double.twists)

    def is_localized():
        double.filter()
        return double.used

    node.spin(is_localized)
    commanded, reached = double.follow(PATH[: int(sys.argv[3])])
    began = node.time
    node.wait_until(began + 1.0)
    double.filter()
    scan = double.buffer.chain(f"{double.base.removesuffix('base_link')}lidar")
    return {
        "reached": reached,
        "pose": vars(double.pose()),
        "commanded": commanded,
        "drove": began,
        "chain": scan,
        "twice": double.buffer.twice,
        "backwards": [frame for frame in double.buffer.backwards if frame != double.odom],
        "odometry": sorted(double.bases),
        "fastest": max(double.twists),
        "last": double.twists[-1],
        "scans": len(double.scans),
        "periods": sorted({round(b - a, 6) for a, b in pairwise(double.scans)}),
        "used": double.used,
        "fits": sorted(double.fits)[len(double.fits) // 10],
        "nearest": double.nearest,
    }


if __name__ == "__main__":
    sys.path.insert(0, str(Path(__file__).parents[1]))
    run(nav2)
