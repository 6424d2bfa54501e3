"""Cameras: color, depth, and both (gz-sensors' src/CameraSensor.cc, src/DepthCameraSensor.cc, src/RgbdCameraSensor.cc).

Nothing here draws: `drake_twin.sensors.cameras.renderer` is asked for pictures, and imported for the first one.
"""

from collections.abc import Callable, Iterable
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from pydrake.common.value import AbstractValue
from pydrake.math import RigidTransform, RotationMatrix
from pydrake.systems.framework import Context

from drake_twin.description.robot_description import Sensor
from drake_twin.description.sensor_element import SensorElement
from drake_twin.sensors.cameras.lens import Lens
from drake_twin.sensors.cameras.picture import COLOR, DEPTH, LABEL, View
from drake_twin.sensors.cameras.picture_messages import camera_info, cloud, color_image, depth_image, image
from drake_twin.sensors.cameras.settings import ROS_1, CameraSettings, read_camera
from drake_twin.sensors.classic import classic_frame, classic_topic
from drake_twin.sensors.noise import NoiseChannel
from drake_twin.sensors.registry import sensor
from drake_twin.sensors.sensor_setup import SensorSetup
from drake_twin.sensors.sensor_system import SensorSystem, SensorTopic
from drake_twin.systems.no_message import set_value

if TYPE_CHECKING:
    from drake_twin.sensors.cameras.scene import SeenScene

_IMAGE, _INFO, _CLOUD = "sensor_msgs/msg/Image", "sensor_msgs/msg/CameraInfo", "sensor_msgs/msg/PointCloud2"
# A sensor looks along its x axis, with z up.
R_SO = RotationMatrix(np.array([[0.0, 0.0, 1.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]]))
_SCENE = "scene"  # of `SensorHost.shared`
_UNLIMITED = 1e4  # m: the far end of what is drawn for a depth camera without one


class AnyCamera(SensorSystem):
    """Take pictures of what is seen: the visual shapes of robots and world, in the world's lights.

    A picture shows the instant at which it is asked for, and is published a delay later: meanwhile another process
    draws it, and the simulation only waits where it is late.

    .. pydrake_system::

        name: AnyCamera
        input_ports:
        - body_poses
        output_ports:
        - image
        - depth
        - points
        - info
        - depth_info
        - label

    - ``body_poses``: the plant's port of this name.
    - ``image``: ``sensor_msgs/msg/Image``, color. These ports wait for their pictures, and are None without them.
    - ``depth``: ``sensor_msgs/msg/Image``, 32FC1 (m; -inf below the least depth, inf beyond the largest).
    - ``points``: ``sensor_msgs/msg/PointCloud2``.
    - ``info``, ``depth_info``: ``sensor_msgs/msg/CameraInfo``.
    - ``label``: ``sensor_msgs/msg/Image``, mono16: the index in the plant of the body that each pixel shows, and one;
      0 for the background. Not a topic.
    """

    measures_depth = False
    gz_pictures: tuple[tuple[str, str, str], ...] = ()  # output, message and what its topic in Gazebo ends with

    @classmethod
    def read(cls, element: SensorElement) -> CameraSettings:
        """Read picture, lens, clips and noise.

        Raises:
            InputError: If a value is invalid.
        """
        return read_camera(element, is_depth=cls.measures_depth)

    @classmethod
    def topics(cls, sensor: Sensor, settings: CameraSettings, base: str) -> Iterable[SensorTopic]:
        """Return the topics of Gazebo, or of a plugin of Gazebo classic."""
        if settings.plugin:
            return _classic_topics(sensor, settings, is_depth=cls.measures_depth)
        return cls.gazebo_topics(sensor, settings, base)

    @classmethod
    def gazebo_topics(cls, sensor: Sensor, settings: CameraSettings, base: str) -> Iterable[SensorTopic]:
        """Return the topics in Gazebo: of the pictures, and camera_info."""
        info = settings.info_topic
        info = f"/{info.strip('/')}" if info and info != "__default__" else f"{base.rpartition('/')[0]}/camera_info"
        pictures = (SensorTopic(own, kind, f"{base}{end}") for own, kind, end in cls.gz_pictures)
        return (*pictures, SensorTopic("info", _INFO, info))

    @classmethod
    def default_frame(cls, sensor: Sensor, settings: CameraSettings, scoped: str) -> str:
        """Return the link with Gazebo classic's plugin; else Gazebo's scoped name."""
        own = ""
        if settings.plugin in ROS_1:
            plugin = SensorElement(sensor).part("plugin")
            own = "" if plugin is None else plugin.text("frameName")
        return own or classic_frame(sensor, scoped)

    def __init__(self, setup: SensorSetup):
        super().__init__(setup)
        settings: CameraSettings = setup.settings
        self._settings, self._lens = settings, Lens(settings)
        self._body, self._pose = int(setup.body.index()), setup.pose @ RigidTransform(R_SO, np.zeros(3))
        self._poses = self.declare_plant_input("body_poses")
        period = 1.0 / setup.sensor.update_rate if setup.sensor.update_rate else setup.noise.time_step
        self.delay = period if settings.delay is None else settings.delay
        self.warnings = settings.notes
        pictures = (COLOR, DEPTH, LABEL) if self.measures_depth else (COLOR, LABEL)
        # An entry has the picture that is asked for, until what it shows moves: topics of one instant share it.
        self._pictures = {kind: self.declare_cache_entry(f"{kind} picture", self._ask_for, kind) for kind in pictures}
        for own in ("image", "info", "label", *(("depth", "depth_info", "points") if self.measures_depth else ())):
            self.declare_message_output(self._calc, own, own)

    def ask(self, own: str, context: Context) -> Callable[[], Any]:
        """Ask for what a topic shows at the present time; see `SensorSystem.ask`."""
        settings, lens, header, time = self._settings, self._lens, self.header(context), context.get_time()
        if own in ("info", "depth_info"):
            return lambda: camera_info(header, settings)
        kinds = {"image": (COLOR,), "depth": (DEPTH,), "label": (LABEL,), "points": (DEPTH, COLOR)}[own]
        asked = {kind: self._pictures[kind].Eval(context) for kind in kinds}
        noises = {kind: channel for kind, channel in self._channels.items() if kind in kinds}

        def message() -> Any:
            found = {}
            for kind, picture in asked.items():
                data = picture.wait()
                if data is None:
                    return None
                found[kind] = lens.distort(data, blend=kind == COLOR)
            if COLOR in noises:
                white = noises[COLOR].apply(np.zeros(found[COLOR].shape[:2]), time)[:, :, np.newaxis]
                found[COLOR] = np.clip(np.rint(found[COLOR] + 255.0 * white), 0, 255).astype(np.uint8)
            if DEPTH in noises:
                found[DEPTH] = _noisy_depth(found[DEPTH], settings, noises[DEPTH], time)
            if own == "image":
                return color_image(header, settings.encoding, found[COLOR])
            if own == "depth":
                return depth_image(header, found[DEPTH])
            if own == "label":
                return image(header, "mono16", found[LABEL])
            return cloud(header, lens.slopes, found[DEPTH], found[COLOR], is_optical=bool(settings.plugin))

        return message

    def _ask_for(self, kind: str, context: Context, output: AbstractValue) -> None:
        poses = self._poses.Eval(context)
        settings, pinhole = self._settings, self._lens.pinhole
        near, far = (settings.depth_near, settings.depth_far) if kind == DEPTH else (settings.near, settings.far)
        view = View(kind, pinhole.width, pinhole.height, pinhole.intrinsics, near, min(far, _UNLIMITED))
        shared, setup = self.host.shared, self.setup
        if _SCENE not in shared:
            from drake_twin.sensors.cameras.scene import seen_scene

            assert setup.scene_graph is not None, "a camera needs the scene graph"
            shared[_SCENE] = seen_scene(setup.plant, setup.scene_graph.model_inspector(), setup.surroundings)
        scene: SeenScene = shared[_SCENE]
        X_WC = (poses[self._body] @ self._pose).GetAsMatrix34()[np.newaxis]
        name = f"{setup.owner}/{setup.sensor.link}/{setup.sensor.name}"
        output.set_value(setup.renderer.get().ask(name, scene, view, np.concatenate([scene.poses(poses), X_WC])))

    def _calc(self, own: str, context: Context, output: AbstractValue) -> None:
        set_value(output, self.ask(own, context)())


@sensor("camera")
class Camera(AnyCamera):
    """Take color pictures."""

    gz_topic = "image"
    gz_pictures = (("image", _IMAGE, ""),)


@sensor("multicamera")
class OneOfMany(Camera):
    """Take color pictures as one camera of a multicamera, which only Gazebo classic has (gazebo_ros_camera.cpp)."""

    @classmethod
    def read(cls, element: SensorElement) -> CameraSettings:
        """Read the camera; its pose has been added to the sensor's.

        Raises:
            InputError: If a value is invalid.
        """
        element.has("camera/pose")
        settings = super().read(element)
        many, _, own = element.sensor.name.rpartition("/")
        named = many if settings.name == element.sensor.name else settings.name
        return replace(settings, name=f"{named}/{own}")

    @classmethod
    def problem(cls, settings: CameraSettings) -> str | None:
        """Return that only Gazebo classic's plugin publishes its pictures, without that plugin."""
        return None if settings.plugin else "nothing but Gazebo classic's libgazebo_ros_camera publishes its pictures"


@sensor("depth_camera", "depth")
class DepthCamera(AnyCamera):
    """Measure depths; with a plugin of Gazebo classic take color pictures, too."""

    gz_topic = "depth_image"
    measures_depth = True
    gz_pictures = (("depth", _IMAGE, ""), ("points", _CLOUD, "/points"))


@sensor("rgbd_camera", "rgbd")
class RgbdCamera(AnyCamera):
    """Take color pictures and measure depths at the same instants."""

    gz_topic = "image"
    measures_depth = True

    @classmethod
    def gazebo_topics(cls, sensor: Sensor, settings: CameraSettings, base: str) -> Iterable[SensorTopic]:
        """Return image, depths, points and camera_info below one topic."""
        if sensor.topic in ("", "__default_topic__"):
            base = base.rpartition("/")[0]
        return (
            SensorTopic("image", _IMAGE, f"{base}/image"),
            SensorTopic("depth", _IMAGE, f"{base}/depth_image"),
            SensorTopic("points", _CLOUD, f"{base}/points"),
            SensorTopic("info", _INFO, f"{base}/camera_info"),
        )


def _classic_topics(sensor: Sensor, settings: CameraSettings, *, is_depth: bool) -> Iterable[SensorTopic]:
    """Return the topics of a plugin of Gazebo classic (gazebo_ros_camera.cpp; ROS 1's have elements for them)."""
    plugin = SensorElement(sensor).plugin
    assert plugin is not None, "a plugin without an element"
    names = [("image", _IMAGE, "image_raw", "imageTopicName"), ("info", _INFO, "camera_info", "cameraInfoTopicName")]
    if is_depth:
        names += [
            ("depth", _IMAGE, "depth/image_raw", "depthImageTopicName"),
            ("depth_info", _INFO, "depth/camera_info", "depthImageCameraInfoTopicName"),
            ("points", _CLOUD, "points", "pointCloudTopicName"),
        ]
    for own, kind, name, tag in names:
        if settings.plugin in ROS_1:
            name = next(iter(plugin.elements.get(tag, ())), "") or name
        topic = name if name.startswith("/") else f"{settings.name}/{name}"
        yield SensorTopic(own, kind, classic_topic(plugin, topic), is_ros=True)


def _noisy_depth(depth: np.ndarray, settings: CameraSettings, noise: NoiseChannel, time: float) -> np.ndarray:
    """Return depths with noise; infinite ones stay."""
    met = np.isfinite(depth)
    noisy = np.where(met, depth, 0.0) + noise.apply(np.zeros(depth.shape), time)
    return np.where(met, np.clip(noisy, settings.depth_near, settings.depth_far), depth).astype(np.float32)
