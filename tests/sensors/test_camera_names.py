"""Topics, frames, rates and camera_info of cameras against tables that were written by hand from Gazebo's sources.

gz-sim's src/rendering/RenderUtil.cc has the last parts of default topics; gz-sensors' src/CameraSensor.cc,
DepthCameraSensor.cc and RgbdCameraSensor.cc the topics beside; gazebo_ros_pkgs' gazebo_ros_camera.cpp, branch ros2,
those of Gazebo classic. Nothing here is drawn.
"""

import pytest
from camera_rig import camera
from hinge import node
from rig import on_box, twin_with
from test_names import BASE, gazebo, robot_with, spawned, table

from drake_twin import Twin
from drake_twin.errors import InputError
from drake_twin.findings import Kind, texts

IMAGE, INFO, CLOUD = "sensor_msgs/msg/Image", "sensor_msgs/msg/CameraInfo", "sensor_msgs/msg/PointCloud2"
FRAME = "r/base_footprint/s"


@pytest.mark.parametrize(
    ("sensor", "expected"),
    [
        (gazebo(kind="camera"), {"/r/s/image": IMAGE, "/r/s/camera_info": INFO}),
        (gazebo("<topic>cam</topic>", kind="camera"), {"/r/cam": IMAGE, "/r/camera_info": INFO}),
        (
            gazebo("<topic>/front/color/image_raw</topic>", kind="camera"),
            {"/r/front/color/image_raw": IMAGE, "/r/front/color/camera_info": INFO},
        ),
        (
            gazebo("<topic>a/b</topic><camera><camera_info_topic>c/info</camera_info_topic></camera>", kind="camera"),
            {"/r/a/b": IMAGE, "/r/c/info": INFO},
        ),
        (
            gazebo(kind="depth_camera"),
            {"/r/s/depth_image": IMAGE, "/r/s/depth_image/points": CLOUD, "/r/s/camera_info": INFO},
        ),
        (
            gazebo("<topic>d/depth</topic>", kind="depth"),
            {"/r/d/depth": IMAGE, "/r/d/depth/points": CLOUD, "/r/d/camera_info": INFO},
        ),
        (
            gazebo(kind="rgbd_camera"),
            {"/r/s/image": IMAGE, "/r/s/depth_image": IMAGE, "/r/s/points": CLOUD, "/r/s/camera_info": INFO},
        ),
        (
            gazebo("<topic>rgbd/image</topic>", kind="rgbd"),
            {
                "/r/rgbd/image/image": IMAGE,
                "/r/rgbd/image/depth_image": IMAGE,
                "/r/rgbd/image/points": CLOUD,
                "/r/rgbd/image/camera_info": INFO,
            },
        ),
    ],
)
def test_topics_of_gazebo(tmp_path, sensor, expected):
    twin = robot_with(tmp_path, sensor)
    assert table(twin) == {topic: (kind, FRAME, 0.0) for topic, kind in expected.items()}


def plugin(inside="", library="libgazebo_ros_camera.so", name="p"):
    return f'<update_rate>30</update_rate><plugin name="{name}" filename="{library}">{inside}</plugin>'


@pytest.mark.parametrize(
    ("kind", "inside", "expected"),
    [
        ("camera", "", {"/r/s/image_raw": IMAGE, "/r/s/camera_info": INFO}),
        ("camera", "<camera_name>cam</camera_name>", {"/r/cam/image_raw": IMAGE, "/r/cam/camera_info": INFO}),
        (
            "camera",
            "<ros><namespace>/demo</namespace><remapping>s/image_raw:=color</remapping></ros>",
            {"/r/color": IMAGE, "/r/s/camera_info": INFO},
        ),
        (
            "depth",
            "<camera_name>cam</camera_name><ros><remapping>cam/points:=/cloud</remapping></ros>",
            {
                "/r/cam/image_raw": IMAGE,
                "/r/cam/camera_info": INFO,
                "/r/cam/depth/image_raw": IMAGE,
                "/r/cam/depth/camera_info": INFO,
                "/cloud": CLOUD,
            },
        ),
    ],
)
def test_topics_of_gazebo_classic(tmp_path, kind, inside, expected):
    twin = robot_with(tmp_path, gazebo(plugin(f"{inside}<frame_name>imu_link</frame_name>"), kind=kind))
    assert table(twin) == {topic: (type_, "r/imu_link", 30.0) for topic, type_ in expected.items()}


def test_the_topics_of_linorobot2(tmp_path):
    """linorobot2_description/urdf/sensors/depth_sensor.urdf.xacro of its branch humble."""
    inside = (
        "<ros><remapping>/camera/camera_info:=/camera/color/camera_info</remapping>"
        "<remapping>/camera/image_raw:=/camera/color/image_raw</remapping>"
        "<remapping>/camera/points:=/camera/depth/color/points</remapping>"
        "<remapping>/camera/depth/image_raw:=/camera/depth/image_rect_raw</remapping></ros>"
        "<min_depth>0.015</min_depth><max_depth>3.0</max_depth><hack_baseline>0.07</hack_baseline>"
        "<frame_name>imu_link</frame_name>"
    )
    lens = "<camera name='camera'><horizontal_fov>1.50098</horizontal_fov></camera>"
    twin = robot_with(tmp_path, gazebo(lens + plugin(inside), kind="depth", name="camera"), namespace="")
    frame = next(iter(table(twin).values()))[1]
    assert table(twin) == {
        "/camera/color/image_raw": (IMAGE, frame, 30.0),
        "/camera/color/camera_info": (INFO, frame, 30.0),
        "/camera/depth/image_rect_raw": (IMAGE, frame, 30.0),
        "/camera/depth/camera_info": (INFO, frame, 30.0),
        "/camera/depth/color/points": (CLOUD, frame, 30.0),
    }
    assert frame.endswith("imu_link")


def test_a_multicamera_is_its_cameras(tmp_path):
    eyes = "".join(
        f"<camera name='{name}'><pose>0 {y} 0 0 0 0</pose><horizontal_fov>1</horizontal_fov><odd/></camera>"
        for name, y in (("left", 0.1), ("right", -0.1))
    )
    turned = f"<pose>0 0 1 0 0 1.5707963267948966</pose>{eyes}"
    twin = robot_with(tmp_path, gazebo(turned + plugin("<camera_name>stereo</camera_name>"), kind="multicamera"))
    expected = {}
    for name in ("left", "right"):
        expected |= {f"/r/stereo/{name}/image_raw": IMAGE, f"/r/stereo/{name}/camera_info": INFO}
    assert table(twin) == {topic: (kind, "r/base_footprint", 30.0) for topic, kind in expected.items()}
    poses = {item.sensor.name: item.sensor.pose.xyz for item in twin.built.plans[0].sensors}
    assert poses == {"s/left": pytest.approx((-0.1, 0, 1)), "s/right": pytest.approx((0.1, 0, 1))}
    odd = [item for item in twin.findings if "<odd> in <camera>" in item.what]
    assert [item.what for item in odd] == [
        "<odd> in <camera> of sensor 's/left'",
        "<odd> in <camera> of sensor 's/right'",
    ]
    gazebos = robot_with(tmp_path, gazebo(turned, kind="multicamera"))
    assert [text for text in gazebos.findings.not_started if "libgazebo_ros_camera" in text]


@pytest.mark.parametrize("library", ["libgazebo_ros_openni_kinect.so", "libgazebo_ros_depth_camera.so"])
def test_topics_of_ros_1(tmp_path, library):
    inside = (
        "<cameraName>kinect</cameraName><imageTopicName>rgb/image_raw</imageTopicName><frameName>imu_link</frameName>"
        "<cameraInfoTopicName>rgb/camera_info</cameraInfoTopicName><depthImageTopicName>d/image</depthImageTopicName>"
    )
    twin = robot_with(tmp_path, gazebo(plugin(inside, library), kind="depth"))
    assert {topic: value[:2] for topic, value in table(twin).items()} == {
        "/r/kinect/rgb/image_raw": (IMAGE, "r/imu_link"),
        "/r/kinect/rgb/camera_info": (INFO, "r/imu_link"),
        "/r/kinect/d/image": (IMAGE, "r/imu_link"),
        "/r/kinect/depth/camera_info": (INFO, "r/imu_link"),
        "/r/kinect/points": (CLOUD, "r/imu_link"),
    }
    assert not [item for item in twin.findings if "in <plugin> of sensor" in item.what]


def test_bridges_carry_pictures_and_infos(tmp_path):
    sensors = gazebo("<topic>camera/image</topic>", kind="camera") + gazebo(kind="rgbd_camera", name="d")
    below = "/world/default/model/r/link/base_footprint/sensor/d"
    lines = (
        "/camera/camera_info@sensor_msgs/msg/CameraInfo[gz.msgs.CameraInfo",
        f"{below}/depth_image@sensor_msgs/msg/Image[gz.msgs.Image",
        "/camera/other@sensor_msgs/msg/Image[gz.msgs.Image",
    )
    bridges = (
        node("ros_gz_image", "image_bridge", "/camera/image"),
        node("ros_gz_bridge", "parameter_bridge", *lines),
    )
    with Twin(spawned(tmp_path, BASE.format(sensors), "r", *bridges)) as twin:
        assert table(twin) == {
            "/camera/image": (IMAGE, FRAME, 0.0),
            "/camera/camera_info": (INFO, FRAME, 0.0),
            f"{below}/depth_image": (IMAGE, "r/base_footprint/d", 0.0),
        }
        assert any("/camera/other" in text for text in twin.findings.warnings)
        assert not [text for text in twin.findings.not_started if "sensor" in text]


def info_of(tmp_path, text):
    with twin_with(tmp_path, text) as twin:
        return twin.sensor("box", "s").message("info")


def test_camera_info_of_gazebo_has_its_center_at_half_the_picture(tmp_path):
    info = info_of(
        tmp_path, camera(size=(320, 240), fov=1.2, more="<distortion><k1>0.1</k1><p2>-0.02</p2></distortion>")
    )
    focal_length = 320 / 2 / 0.6841368083416923  # tan(0.6)
    assert (info.width, info.height, info.distortion_model) == (320, 240, "plumb_bob")
    assert list(info.d) == [0.1, 0, 0, -0.02, 0]
    assert list(info.k) == pytest.approx([focal_length, 0, 160, 0, focal_length, 120, 0, 0, 1])
    assert list(info.p) == pytest.approx([focal_length, 0, 160, 0, 0, focal_length, 120, 0, 0, 0, 1, 0])
    assert list(info.r) == [1, 0, 0, 0, 1, 0, 0, 0, 1]


def test_intrinsics_of_the_lens(tmp_path):
    lens = (
        "<lens><intrinsics><fx>300</fx><fy>310</fy><cx>20</cx><cy>30</cy><s>0</s></intrinsics>"
        "<projection><p_fx>301</p_fx><p_fy>311</p_fy><p_cx>21</p_cx><p_cy>31</p_cy><tx>-5</tx></projection></lens>"
    )
    info = info_of(tmp_path, camera(more=lens))
    assert list(info.k) == [300, 0, 20, 0, 310, 30, 0, 0, 1]
    assert list(info.p) == [301, 0, 21, -5, 0, 311, 31, 0, 0, 0, 1, 0]


def test_a_projection_without_values_has_those_of_sdf(tmp_path):  # sdformat's sdf/1.9/camera.sdf
    info = info_of(tmp_path, camera(size=(320, 240), more="<lens><projection><p_fy>300</p_fy></projection></lens>"))
    assert list(info.p) == [277, 0, 160, 0, 0, 300, 120, 0, 0, 0, 1, 0]


def test_camera_info_of_gazebo_classic(tmp_path):
    inside = "<hack_baseline>0.07</hack_baseline><P_cx>9</P_cx><CxPrime>0</CxPrime>"
    text = camera(size=(64, 48), fov=1.5707963267948966, plugin=plugin(inside).partition("</update_rate>")[2])
    with twin_with(tmp_path, text) as twin:
        info = twin.sensor("box", "s").message("info")
        ignored = [item.what for item in twin.findings if item.kind is Kind.IGNORED and "CxPrime" in item.what]
    assert list(info.k) == pytest.approx([32, 0, 32.5, 0, 32, 24.5, 0, 0, 1])
    assert list(info.p) == pytest.approx([32, 0, 9, -32 * 0.07, 0, 32, 24.5, 0, 0, 0, 1, 0])
    assert info.header.frame_id == "box/box"
    assert len(ignored) == 1


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (camera(fov=0), "horizontal_fov is 0, but it must be 0.001 at least and below pi"),
        (camera(fov=3.2), "horizontal_fov is 3.2, but"),
        (camera(fov="nan"), "horizontal_fov"),
        (camera(size=(0, 48)), "width is '0', but it must be 4 to 16384"),
        (camera(size=(64, 20000)), "height is '20000', but"),
        (camera(clip="<near>2</near><far>1</far>"), "the far clip 1 is not above the near one 2"),
        (camera(clip="<near>-1</near><far>1</far>"), "near is '-1'"),
        (camera(more="<delay>-0.1</delay>"), "delay is '-0.1', but it must be 0 to 10"),
        (camera(more="<noise><type>gaussian</type><stddev>-1</stddev></noise>"), "stddev"),
        (camera(rate=-5), "update_rate is '-5', but it cannot be negative"),
        (
            camera().replace("</height></image>", "</height><format>R9G9B9</format></image>"),
            "unknown format 'R9G9B9'",
        ),
        (
            camera("depth_camera", more="<depth_camera><clip><near>3</near><far>2</far></clip></depth_camera>"),
            "the far clip 2 is not above the near one 3",
        ),
        (camera(more="<lens><intrinsics><cx>70</cx></intrinsics></lens>"), "the center 70 120 of its lens is not in"),
    ],
)
def test_bad_input_is_one_paragraph_with_file_and_line(tmp_path, text, message):
    with pytest.raises(InputError) as error:
        twin_with(tmp_path, text)
    assert message in str(error.value)
    assert "box.urdf" in str(error.value)
    assert "\n" not in str(error.value).strip()
    assert error.value.line


def test_what_has_no_effect_is_said(tmp_path):
    more = "<visibility_mask>3</visibility_mask><save><path>x</path></save>"
    text = camera(more=more, rate=0).replace("</height></image>", "</height><format>RGB_FLOAT32</format></image>")
    with twin_with(tmp_path, text) as twin:
        ignored = {item.what for item in twin.findings if item.kind is Kind.IGNORED}
        warnings = texts(twin.findings, Kind.WARNING)
    assert {f"<{tag}> in <camera> of sensor 's'" for tag in ("visibility_mask", "save")} <= ignored
    assert any("format RGB_FLOAT32 is not supported" in item for item in warnings)
    assert any("a picture at every step" in item for item in warnings)


def test_other_cameras_are_not_started(tmp_path):
    with twin_with(tmp_path, on_box("thermal_camera"), on_box("wideanglecamera", name="w")) as twin:
        assert len([text for text in twin.findings.not_started if "the twin has no such sensor" in text]) == 2


def test_a_sensor_in_python_says_what_it_has(tmp_path):
    with twin_with(tmp_path, camera()) as twin:
        with pytest.raises(InputError, match=r"robot 'box' has no sensor 'x'"):
            twin.sensor("box", "x")
        with pytest.raises(InputError, match="unknown robot"):
            twin.sensor("bax", "s")
        with pytest.raises(InputError, match="has no 'depth'") as error:
            _ = twin.sensor("box", "box/s").depth
        assert error.value.valid
        ranges = on_box("gpu_lidar", "<lidar><scan><horizontal><samples>4</samples></horizontal></scan></lidar>")
    with twin_with(tmp_path, ranges) as twin:
        assert twin.sensor("box", "s").ranges.shape == (4,)
