"""What a camera reads of its element, for Gazebo and for Gazebo classic."""

from dataclasses import field
from math import inf, pi, tan
from typing import NamedTuple

from drake_twin.dataclass import dataclass
from drake_twin.description.sensor_element import SensorElement
from drake_twin.sensors.cameras.picture import COLOR, DEPTH
from drake_twin.sensors.noise import Noise, read_noise

CLASSIC = "gazebo_ros_camera"
# Of ROS 1, which still stand in files: a depth camera whose topics have elements of their own.
ROS_1 = ("gazebo_ros_depth_camera", "gazebo_ros_openni_kinect")
_OF_ROS_1 = (
    *("frameName", "imageTopicName", "cameraInfoTopicName", "depthImageTopicName"),
    *("depthImageCameraInfoTopicName", "pointCloudTopicName"),
)

# Format of SDF → ROS encoding; other formats that SDF knows become the first, as in Gazebo.
_ENCODINGS = {
    "R8G8B8": "rgb8",
    "RGB_INT8": "rgb8",
    "B8G8R8": "bgr8",
    "BGR_INT8": "bgr8",
    "L8": "mono8",
    "L_INT8": "mono8",
    "L16": "mono16",
    "L_INT16": "mono16",
    "BAYER_RGGB8": "bayer_rggb8",
    "BAYER_BGGR8": "bayer_bggr8",
    "BAYER_GBRG8": "bayer_gbrg8",
    "BAYER_GRBG8": "bayer_grbg8",
}
_OTHERS = (
    *("UNKNOWN_PIXEL_FORMAT", "RGBA_INT8", "BGRA_INT8", "RGB_INT16", "BGR_INT16", "RGB_INT32", "BGR_INT32"),
    *("R_FLOAT16", "RGB_FLOAT16", "R_FLOAT32", "RGB_FLOAT32", "R16G16B16", "B16G16R16", "R32G32B32", "B32G32R32"),
)
_SMALLEST, _LARGEST = 4, 16384  # pixels: the latter is Mesa's limit
_NARROWEST = 0.001  # rad, as in SDF's specification
_MANY_PIXELS = 100e6  # a simulated second


class Intrinsics(NamedTuple):
    """Focal lengths and center of a picture (pixels); the center of its first pixel is 0, 0."""

    fx: float
    fy: float
    cx: float
    cy: float


@dataclass(frozen=True)
class CameraSettings:
    """A camera.

    Attributes:
        name: Its name below a plugin's topics.
        width: Of the picture (pixels).
        height: Of the picture (pixels).
        drawn: The intrinsics of the picture.
        published: Those of its ``camera_info``; a plugin of Gazebo classic may say others.
        projection: Its ``P``, row by row.
        rectification: Its ``R``, row by row.
        distortion: k1, k2, p1, p2, k3.
        near: What is nearer is not seen (m).
        far: What is farther is not seen (m).
        depth_near: The least depth (m).
        depth_far: The largest depth (m).
        encoding: Of color pictures, as in ROS.
        noises: Of the color (0 to 1); of the depth (m) of a depth camera of Gazebo.
        delay: How long after its instant a picture is published (s); None for one period.
        info_topic: The topic of camera_info; empty for the default.
        plugin: The plugin of Gazebo classic that publishes it; empty without one.
        notes: What of it has no effect, as sentences.
    """

    name: str
    width: int
    height: int
    drawn: Intrinsics
    published: Intrinsics
    projection: tuple[float, ...]
    rectification: tuple[float, ...]
    distortion: tuple[float, ...]
    near: float
    far: float
    depth_near: float
    depth_far: float
    encoding: str = "rgb8"
    noises: dict[str, Noise] = field(default_factory=dict)
    delay: float | None = None
    info_topic: str = ""
    plugin: str = ""
    notes: tuple[str, ...] = field(default=())


def read_camera(element: SensorElement, *, is_depth: bool) -> CameraSettings:
    """Read a camera's element, and a plugin of Gazebo classic in it.

    Args:
        element: The ``<sensor>``.
        is_depth: Whether the camera measures depths.

    Raises:
        InputError: If a value is invalid.
    """
    kind = element.plugin_kind
    plugin = element.part("plugin") if kind in (CLASSIC, *ROS_1) else None
    part = element.part("camera") or element
    notes: list[str] = []
    width, height = (
        int(part.number(f"image/{name}", size, least=_SMALLEST, most=_LARGEST))
        for name, size in (("width", 320), ("height", 240))
    )
    fov = part.number("horizontal_fov", 1.047)
    if not _NARROWEST <= fov < pi:
        what = f"horizontal_fov is {fov:g}, but it must be {_NARROWEST:g} at least and below pi"
        raise part.error(what, "horizontal_fov")
    near, far = _clip(part, "clip", (0.1, 100.0))
    depth_near, depth_far = _clip(part, "depth_camera/clip", (near, far)) if is_depth else (near, far)
    if plugin is not None and is_depth:
        depth_near = max(near, plugin.number("min_depth", 0.4, least=0.0))
        depth_far = plugin.number("max_depth", inf, least=0.0)
        if depth_far <= depth_near:
            raise plugin.error(f"max_depth {depth_far:g} is not above min_depth {depth_near:g}", "max_depth")
    text = part.choice("image/format", ("R8G8B8", *_ENCODINGS, *_OTHERS))
    if text not in _ENCODINGS and not is_depth:
        notes.append(f"format {text} is not supported, in Gazebo either: pictures are rgb8")
    distortion = tuple(part.number(f"distortion/{name}", 0.0) for name in ("k1", "k2", "p1", "p2", "k3"))
    if part.numbers("distortion/center", 2, (0.5, 0.5)) != (0.5, 0.5):
        notes.append("the center of its distortion has no effect: it is that of the picture")
    noise = read_noise(part)
    offset = 0.0 if plugin is None else 0.5  # gazebo_ros_camera.cpp says (width + 1) / 2, gz-rendering width / 2
    center = (width / 2.0 + offset, height / 2.0 + offset)
    focal_length = width / (2.0 * tan(fov / 2.0))
    drawn = Intrinsics(focal_length, focal_length, *center)
    drawn, published, projection = _lens(part, drawn, notes)
    if not (0.0 <= drawn.cx < width - 1.0 and 0.0 <= drawn.cy < height - 1.0):
        what = f"the center {drawn.cx:g} {drawn.cy:g} of its lens is not in a picture of {width} × {height} pixels"
        raise part.error(what, "lens")
    rectification: tuple[float, ...] = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)
    name = element.sensor.name
    if plugin is not None:
        name = plugin.text(*(("cameraName",) if kind in ROS_1 else ()), "camera_name", default=name)
        published, projection = _of_plugin(plugin, drawn, notes)
        for tag in _OF_ROS_1 if kind in ROS_1 else ():
            plugin.has(tag)  # read for the topics
        rectification = plugin.numbers("rectification_matrix", 9, rectification)
    rate = element.sensor.update_rate
    if rate == 0.0 or width * height * rate > _MANY_PIXELS:
        many = f"{rate:g} pictures of {width} × {height} pixels a second" if rate else "a picture at every step"
        notes.append(f"{many}: drawing them takes much longer than the simulation does")
    delay = part.number("delay", -1.0, least=0.0, most=10.0)
    return CameraSettings(
        name=name,
        width=width,
        height=height,
        drawn=drawn,
        published=published,
        projection=projection,
        rectification=rectification,
        distortion=distortion,
        near=near,
        far=far,
        depth_near=depth_near,
        depth_far=depth_far,
        encoding=_ENCODINGS.get(text, "rgb8"),
        # gz-sensors' ImageGaussianNoiseModel has no bias
        noises={DEPTH if is_depth and plugin is None else COLOR: Noise(noise.mean, noise.stddev)},
        delay=None if delay < 0.0 else delay,
        info_topic=part.text("camera_info_topic"),
        plugin=kind if plugin is not None else "",
        notes=tuple(notes),
    )


def _clip(part: SensorElement, path: str, default: tuple[float, float]) -> tuple[float, float]:
    near, far = part.number(f"{path}/near", default[0], least=0.0), part.number(f"{path}/far", default[1], least=0.0)
    if near >= far:
        raise part.error(f"the far clip {far:g} is not above the near one {near:g}", path)
    return near, far


def _lens(part: SensorElement, drawn: Intrinsics, notes: list[str]) -> tuple[Intrinsics, Intrinsics, tuple[float, ...]]:
    """Read ``<lens>``; return the picture's intrinsics, ``K`` and ``P`` (gz-sensors, src/CameraSensor.cc)."""
    published = drawn
    if part.has("lens/intrinsics"):
        published = Intrinsics(
            part.number("lens/intrinsics/fx", 277.0, least=1e-3),
            part.number("lens/intrinsics/fy", 277.0, least=1e-3),
            part.number("lens/intrinsics/cx", 160.0),
            part.number("lens/intrinsics/cy", 120.0),
        )
        if part.number("lens/intrinsics/s", 0.0):
            notes.append("the skew of its lens has no effect")
        drawn = published
    if part.has("lens/projection"):  # Gazebo draws with these, and publishes the intrinsics as K all the same
        fx, fy = (part.number(f"lens/projection/p_{name}", 277.0, least=1e-3) for name in ("fx", "fy"))
        cx, cy = part.number("lens/projection/p_cx", 160.0), part.number("lens/projection/p_cy", 120.0)
        tx, ty = part.number("lens/projection/tx", 0.0), part.number("lens/projection/ty", 0.0)
        return Intrinsics(fx, fy, cx, cy), published, (fx, 0.0, cx, tx, 0.0, fy, cy, ty, 0.0, 0.0, 1.0, 0.0)
    fx, fy, cx, cy = drawn
    return drawn, published, (fx, 0.0, cx, 0.0, 0.0, fy, cy, 0.0, 0.0, 0.0, 1.0, 0.0)


def _of_plugin(plugin: SensorElement, drawn: Intrinsics, notes: list[str]) -> tuple[Intrinsics, tuple[float, ...]]:
    """Read what a plugin of Gazebo classic publishes as ``K`` and ``P`` (gazebo_ros_camera.cpp)."""
    focal_length = plugin.number("focal_length", 0.0, least=0.0) or drawn.fx
    cx, cy = plugin.number("cx", drawn.cx), plugin.number("cy", drawn.cy)
    if (focal_length, cx, cy) != (drawn.fx, drawn.cx, drawn.cy):
        notes.append("its camera_info has the focal_length, cx and cy of the plugin, which its pictures do not have")
    baseline = plugin.number("hack_baseline", 0.0)
    fx, fy = plugin.number("P_fx", focal_length), plugin.number("P_fy", focal_length)
    tx, ty = plugin.number("Tx", -focal_length * baseline), plugin.number("Ty", 0.0)
    px, py = plugin.number("P_cx", cx), plugin.number("P_cy", cy)
    projection = (fx, 0.0, px, tx, 0.0, fy, py, ty, 0.0, 0.0, 1.0, 0.0)
    return Intrinsics(focal_length, focal_length, cx, cy), projection
