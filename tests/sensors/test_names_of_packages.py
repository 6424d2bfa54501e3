"""Topics, frames and rates of robots with the shapes of real packages, against tables written by hand.

The tables follow from the packages' own bridges; the files here are made up.
"""

from hinge import node
from launch_files import write
from names_rig import INERTIAL, gazebo, spawned, table

from drake_twin import Twin
from drake_twin.findings import Kind, texts

CREATE_3 = f"""<robot name="t"><link name="base_link">{INERTIAL}</link>{{}}</robot>"""
IMAGE, INFO, SCAN = (f"sensor_msgs/msg/{name}" for name in ("Image", "CameraInfo", "LaserScan"))
CLOUD, FIX = "sensor_msgs/msg/PointCloud2", "sensor_msgs/msg/NavSatFix"


def mounted(link, sensors, preserve=False):
    """A link on a fixed joint, with sensors."""
    kept = (
        f'<gazebo reference="{link}_joint"><preserveFixedJoint>true</preserveFixedJoint></gazebo>' if preserve else ""
    )
    joint = f'<joint name="{link}_joint" type="fixed"><parent link="base_link"/><child link="{link}"/></joint>'
    return f'<link name="{link}"/>{joint}{kept}{sensors}'


def test_turtlebot4s_lidars_camera_and_cliff_sensors(tmp_path):
    """turtlebot4_ignition_bringup's ros_ign_bridge.launch.py with create3_ros_ignition_bridge.launch.py, branch humble.

    The launch file's own static transforms say the frames of /scan and of the camera.
    """
    text = CREATE_3.format(
        mounted(
            "cliff_side_left",
            gazebo("<update_rate>62</update_rate>", "cliff_side_left", "cliff_side_left", "gpu_lidar"),
        )
        + mounted("ir_left", gazebo("<update_rate>62</update_rate>", "ir_left", "ir_left", "gpu_lidar"), preserve=True)
        + mounted(
            "rplidar_link",
            gazebo("<update_rate>62</update_rate>", "rplidar_link", "rplidar", "gpu_lidar"),
            preserve=True,
        )
        + mounted(
            "oakd_rgb_camera_frame",
            gazebo("<update_rate>30</update_rate>", "oakd_rgb_camera_frame", "rgbd_camera", "rgbd_camera"),
            preserve=True,
        )
    )
    default = "/world/warehouse/model/turtlebot4/link/{}/sensor/{}"
    camera = default.format("oakd_rgb_camera_frame", "rgbd_camera")
    carried = [
        ("lidar_bridge", {default.format("rplidar_link", "rplidar") + "/scan": (SCAN, "scan")}),
        ("cliff", {default.format("base_link", "cliff_side_left") + "/scan": (SCAN, "_internal/cliff_side_left/scan")}),
        ("ir", {default.format("ir_left", "ir_left") + "/scan": (SCAN, "_internal/ir_left/scan")}),
        (
            "camera_bridge",
            {
                f"{camera}/image": (IMAGE, "oakd/rgb/preview/image_raw"),
                f"{camera}/depth_image": (IMAGE, "oakd/rgb/preview/depth"),
                f"{camera}/points": (CLOUD, "oakd/rgb/preview/depth/points"),
                f"{camera}/camera_info": (INFO, "oakd/rgb/preview/camera_info"),
            },
        ),
    ]
    bridges = [
        node(
            "ros_gz_bridge",
            "parameter_bridge",
            *(f"{gz}@{kind}[ignition.msgs.X" for gz, (kind, _) in topics.items()),
            remappings=[(gz, ros) for gz, (_, ros) in topics.items()],
            name=name,
        )
        for name, topics in carried
    ]
    scenario = spawned(tmp_path, text, "turtlebot4", *bridges)
    lens = "turtlebot4/oakd_rgb_camera_frame/rgbd_camera"
    assert table(Twin(scenario)) == {
        "/scan": (SCAN, "turtlebot4/rplidar_link/rplidar", 62.0),
        "/_internal/cliff_side_left/scan": (SCAN, "turtlebot4/base_link/cliff_side_left", 62.0),
        "/_internal/ir_left/scan": (SCAN, "turtlebot4/ir_left/ir_left", 62.0),
        "/oakd/rgb/preview/image_raw": (IMAGE, lens, 30.0),
        "/oakd/rgb/preview/depth": (IMAGE, lens, 30.0),
        "/oakd/rgb/preview/depth/points": (CLOUD, lens, 30.0),
        "/oakd/rgb/preview/camera_info": (INFO, lens, 30.0),
    }
    assert not [text for text in texts(scenario.findings, Kind.WARNING) if "bridge" in text]


def test_husarions_components_are_bridged_by_their_files(tmp_path):
    """husarion_components_description, branch ros2: urdf/*.urdf.xacro with config/gz_*_remappings.yaml."""

    def part(kind, link, name, topic, rate, frame=""):
        own = f"<topic>{topic}</topic><gz_frame_id>{frame or link}</gz_frame_id><update_rate>{rate}</update_rate>"
        return gazebo(own, link, name, kind)

    text = CREATE_3.format(
        mounted("lidar_laser", part("gpu_lidar", "lidar_laser", "a", "lidar/scan", 10))
        + mounted("puck", part("gpu_lidar", "puck", "b", "puck/velodyne_points", 10))
        + mounted(
            "rs_link",
            part("camera", "rs_link", "c", "rs/color/image_raw", 30, "rs_color_optical_frame")
            + part("depth_camera", "rs_link", "d", "rs/depth/image_rect_raw", 30, "rs_depth_optical_frame"),
        )
        + mounted("zed", part("depth_camera", "zed", "e", "zed/zed_node/depth", 30))
        + mounted("gps", part("navsat", "gps", "navsat", "gps/fix", 1))
    )
    entries = (
        ("/lidar/scan", "/lidar/scan", SCAN),
        ("/puck/velodyne_points/points", "/puck/velodyne_points", CLOUD),
        ("/rs/color/camera_info", "/rs/color/camera_info", INFO),
        ("/rs/color/image_raw", "/rs/color/image_raw", IMAGE),
        ("/rs/depth/camera_info", "/rs/depth/camera_info", INFO),
        ("/rs/depth/image_rect_raw", "/rs/depth/image_rect_raw", IMAGE),
        ("/rs/depth/image_rect_raw/points", "/rs/depth/color/points", CLOUD),
        ("/zed/zed_node/camera_info", "/zed/zed_node/camera_info", INFO),
        ("/zed/zed_node/depth", "/zed/zed_node/depth", IMAGE),
        ("/gps/fix", "/gps/fix", FIX),
    )
    lines = [
        f"- {{gz_topic_name: {gz}, ros_topic_name: {ros}, ros_type_name: {kind}, direction: GZ_TO_ROS}}"
        for gz, ros, kind in entries
    ]
    file = write(tmp_path / "bridge.yaml", "\n".join(lines))
    bridge = node("ros_gz_bridge", "parameter_bridge", parameters=[{"config_file": str(file)}])
    scenario = spawned(tmp_path, text, "rosbot_xl", bridge)
    color, depth = ("rs_color_optical_frame", 30.0), ("rs_depth_optical_frame", 30.0)
    assert table(Twin(scenario)) == {
        "/lidar/scan": (SCAN, "lidar_laser", 10.0),
        "/puck/velodyne_points": (CLOUD, "puck", 10.0),
        "/rs/color/image_raw": (IMAGE, *color),
        "/rs/color/camera_info": (INFO, *color),
        "/rs/depth/image_rect_raw": (IMAGE, *depth),
        "/rs/depth/camera_info": (INFO, *depth),
        "/rs/depth/color/points": (CLOUD, *depth),
        "/zed/zed_node/depth": (IMAGE, "zed", 30.0),
        "/zed/zed_node/camera_info": (INFO, "zed", 30.0),
        "/gps/fix": (FIX, "gps", 1.0),
    }
    assert not [text for text in texts(scenario.findings, Kind.WARNING) if "bridge" in text]
