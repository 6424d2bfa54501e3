"""The programs that convert what sensors publish, in a twin: depth images, clouds, pictures, joysticks."""

import sys

import pytest
from conftest import rovers
from node_runs import lines, script

from drake_twin.nodes.nodes import Nodes
from drake_twin.scenario import NodeProgram

HEAD = """
import numpy as np
import rclpy
from geometry_msgs.msg import Twist, TwistStamped, TransformStamped
from rclpy.node import Node
from sensor_msgs.msg import CameraInfo, Image, Joy, LaserScan, PointCloud2
from std_msgs.msg import Header
from tf2_ros import StaticTransformBroadcaster

rclpy.init()
node = rclpy.create_node("user")
stamp = lambda: node.get_clock().now().to_msg()
"""
TAIL = "\nrclpy.spin(node)\n"


def run(folder, text, *programs, until=1.0):
    user = NodeProgram(str(script(folder, "user.py", HEAD + text + TAIL)))
    with rovers(1, time_step=0.01).build() as twin:
        nodes = Nodes(twin, [*programs, user])
        twin.advance_to(until)
        nodes.close()
        return [item.what for item in twin.more_findings]


def test_a_depth_image_becomes_a_scan(tmp_path, capsys):
    """A wall 2 m ahead; of the two columns at an edge of 90° that have one angle, the nearer one counts."""
    text = """
info = CameraInfo(width=101, height=5, k=[50.0, 0.0, 50.0, 0.0, 50.0, 2.0, 0.0, 0.0, 1.0],
                  p=[50.0, 0.0, 50.0, 0.0, 0.0, 50.0, 2.0, 0.0, 0.0, 0.0, 1.0, 0.0])
infos, images = node.create_publisher(CameraInfo, "/info", 10), node.create_publisher(Image, "/image", 10)

def tick():
    infos.publish(info)
    data = np.full((5, 101), 2000, dtype=np.uint16).tobytes()
    header = Header(stamp=stamp(), frame_id="optical")
    images.publish(Image(header=header, height=5, width=101, encoding="16UC1", step=202, data=data))

def hear(scan):
    seen = np.isfinite(scan.ranges)
    print(scan.header.frame_id, len(scan.ranges), round(scan.angle_min, 4), round(scan.angle_max, 4),
          round(min(np.array(scan.ranges)[seen]), 4), round(max(np.array(scan.ranges)[seen]), 4),
          round(scan.scan_time, 3))

node.create_subscription(LaserScan, "/scan", hear, 10)
node.create_timer(0.2, tick)
"""
    words = ("--ros-args", "-r", "depth:=/image", "-r", "depth_camera_info:=/info", "-p", "output_frame:=base")
    program = NodeProgram("depthimage_to_laserscan_node", "depthimage_to_laserscan", words)
    assert run(tmp_path, text, program) == []
    heard = lines(capsys)
    assert heard[-1] == "base 101 -0.7854 0.7854 2.0 2.8003 0.033"
    assert len(heard) >= 3


def test_an_image_of_another_encoding_is_an_error_in_the_log(tmp_path, capfd):
    text = """
infos, images = node.create_publisher(CameraInfo, "/depth_camera_info", 10), node.create_publisher(Image, "/depth", 10)

def tick():
    infos.publish(CameraInfo(width=2, height=2, k=[1.0] * 9, p=[1.0] * 12))
    images.publish(Image(height=2, width=2, encoding="rgb8", step=6, data=bytes(12)))

node.create_timer(0.2, tick)
"""
    program = NodeProgram("depthimage_to_laserscan_node", "depthimage_to_laserscan")
    assert run(tmp_path, text, program) == []
    assert (
        "Could not convert depth image to laserscan: Depth image has unsupported encoding: rgb8"
        in capfd.readouterr().err
    )


CLOUD = """
from sensor_msgs_py.point_cloud2 import create_cloud_xyz32, read_points

frames = StaticTransformBroadcaster(node)
clouds = node.create_publisher(PointCloud2, "/cloud_in", 10)

def tick():
    clouds.publish(create_cloud_xyz32(Header(stamp=stamp(), frame_id="sensor"), [[1.0, 0.0, 0.5], [0.0, 2.0, 0.5]]))

def hear(scan):
    found = [(round(scan.angle_min + index * scan.angle_increment, 3) + 0.0, round(r, 3))
             for index, r in enumerate(scan.ranges) if np.isfinite(r)]
    print(scan.header.frame_id, len(scan.ranges), found)

def place():
    transform = TransformStamped(header=Header(frame_id="base"), child_frame_id="sensor")
    transform.transform.translation.x, transform.transform.rotation.w = 3.0, 1.0
    frames.sendTransform(transform)
    timer.cancel()

node.create_subscription(LaserScan, "/scan", hear, 10)
node.create_timer(0.2, tick)
timer = node.create_timer(0.5, place)
"""


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        ((), "sensor 360 [(0.0, 1.0), (1.571, 2.0)]"),
        (("-p", "target_frame:=base", "-p", "angle_increment:=0.1"), "base 63 [(-0.042, 4.0), (0.558, 3.606)]"),
        (("-p", "max_height:=0.4"), "sensor 360 []"),
    ],
)
def test_a_cloud_becomes_a_scan(tmp_path, capsys, words, expected):
    """Also in a frame that is placed only later."""
    program = NodeProgram(
        "pointcloud_to_laserscan_node", "pointcloud_to_laserscan", ("--ros-args", *words) if words else ()
    )
    assert run(tmp_path, CLOUD, program) == []
    heard = lines(capsys)
    assert heard[-1] == expected
    assert len(heard) >= 3


def test_a_scan_becomes_a_cloud(tmp_path, capsys):
    text = """
from sensor_msgs_py.point_cloud2 import read_points
scans = node.create_publisher(LaserScan, "/scan_in", 10)
node.create_timer(0.2, lambda: scans.publish(LaserScan(header=Header(stamp=stamp(), frame_id="laser"), angle_min=0.0,
    angle_max=1.5707964, angle_increment=1.5707964, range_max=9.0, ranges=[1.0, 2.0])))
node.create_subscription(PointCloud2, "/cloud", lambda cloud: print(cloud.header.frame_id,
    [[round(float(p[name]), 3) for name in "xyz"] for p in read_points(cloud)]), 10)
"""
    program = NodeProgram("laserscan_to_pointcloud_node", "pointcloud_to_laserscan")
    assert run(tmp_path, text, program) == []
    assert lines(capsys)[-1].replace("-0.0", "0.0") == "laser [[1.0, 0.0, 0.0], [0.0, 2.0, 0.0]]"


def test_a_cloud_is_heard_only_while_somebody_hears_the_scan(tmp_path, capsys):
    text = """
publisher = node.create_publisher(PointCloud2, "/cloud_in", 10)
ears = []

def tick():
    print(publisher.get_subscription_count())
    if ears:
        node.destroy_subscription(ears.pop())
    else:
        ears.append(node.create_subscription(LaserScan, "/scan", print, 10))

node.create_timer(0.4, tick)
"""
    assert run(tmp_path, text, NodeProgram("pointcloud_to_laserscan_node", "pointcloud_to_laserscan"), until=1.3) == []
    assert lines(capsys) == ["0", "1", "0"]


RECTIFY = """
infos = node.create_publisher(CameraInfo, "/camera/camera_info", 10)
images = node.create_publisher(Image, "/camera/image", 10)
picture = np.zeros((40, 60), dtype=np.uint8)
picture[10, 12] = 200

def tick():
    header = Header(stamp=stamp(), frame_id="optical")
    k = [40.0, 0.0, 30.0, 0.0, 40.0, 20.0, 0.0, 0.0, 1.0]
    infos.publish(CameraInfo(header=header, width=60, height=40, distortion_model="plumb_bob", d=DISTORTION, k=k,
                             r=[1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0],
                             p=[40.0, 0.0, 30.0, 0.0, 0.0, 40.0, 20.0, 0.0, 0.0, 0.0, 1.0, 0.0]))
    images.publish(Image(header=header, height=40, width=60, encoding="mono8", step=60, data=picture.tobytes()))

def hear(image):
    found = np.frombuffer(bytes(image.data), dtype=np.uint8).reshape(40, 60)
    v, u = np.unravel_index(found.argmax(), found.shape)
    print(image.header.frame_id, image.encoding, u, v)

node.create_subscription(Image, "/camera/image_rect", hear, 10)
node.create_timer(0.2, tick)
"""
RECTIFIER = NodeProgram(
    "rectify_node", "image_proc", ("--ros-args", "-r", "image:=/camera/image", "-r", "image_rect:=/camera/image_rect")
)


def test_a_picture_without_distortion_passes(tmp_path, capsys):
    assert run(tmp_path, RECTIFY.replace("DISTORTION", "[0.0] * 5"), RECTIFIER) == []
    assert lines(capsys)[-1] == "optical mono8 12 10"


def test_a_picture_is_rectified(tmp_path, capsys):
    """The point is where its ray x = (u - cx)/fx of the straight picture goes by Brown's model."""
    pytest.importorskip("cv2", reason="OpenCV is not installed")
    k1 = -0.25
    assert run(tmp_path, RECTIFY.replace("DISTORTION", f"[{k1}, 0.0, 0.0, 0.0, 0.0]"), RECTIFIER) == []
    *_, u, v = lines(capsys)[-1].split()
    x, y = (int(u) - 30) / 40, (int(v) - 20) / 40
    factor = 1 + k1 * (x * x + y * y)
    assert (30 + 40 * x * factor, 20 + 40 * y * factor) == pytest.approx((12, 10), abs=0.75)


def test_a_distorted_picture_needs_opencv(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "cv2", None)
    (what,) = run(tmp_path, RECTIFY.replace("DISTORTION", "[-0.25, 0.0, 0.0, 0.0, 0.0]"), RECTIFIER)
    assert (
        "image_proc/rectify_node: ImportError: rectification needs OpenCV: pip install opencv-python-headless" in what
    )


JOY = """
ticks = []
joys = node.create_publisher(Joy, "/joy", 10)

def tick():
    ticks.append(1)
    buttons = [0] * 8
    if len(ticks) in (2, 3):
        buttons[5] = 1
    if len(ticks) == 3:
        buttons[7] = 1
    joys.publish(Joy(axes=[0.0, 0.25, 1.0, 0.0, 0.0, -0.5], buttons=buttons))

def hear(message):
    twist = getattr(message, "twist", message)
    frame = message.header.frame_id if hasattr(message, "header") else ""
    print(frame, twist.linear.x, twist.linear.y, twist.angular.z)

node.create_subscription(TYPE, "/cmd_vel", hear, 10)
node.create_timer(0.2, tick)
"""


@pytest.mark.parametrize(
    ("kind", "words", "expected"),
    [
        ("Twist", (), [" 0.0 0.0 0.0", " -0.25 0.0 0.5", " -0.25 0.0 0.5", " 0.0 0.0 0.0"]),
        (
            "TwistStamped",
            ("-p", "publish_stamped_twist:=true", "-p", "frame:=f", "-p", "enable_turbo_button:=7", "-p",
             "axis_linear.y:=1", "-p", "scale_linear.y:=2.0", "-p", "inverted_reverse:=true"),
            ["f 0.0 0.0 0.0", "f -0.25 0.5 -0.5", "f -0.5 0.0 -1.0", "f 0.0 0.0 0.0"],
        ),
    ],
)  # fmt: skip
def test_a_joysticks_messages_become_velocities(tmp_path, capsys, kind, words, expected):
    program = NodeProgram("teleop_node", "teleop_twist_joy", ("--ros-args", *words) if words else ())
    assert run(tmp_path, JOY.replace("TYPE", kind), program, until=1.1) == []
    assert lines(capsys) == expected
