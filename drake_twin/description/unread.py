"""What a URDF or SDF file says that the twin makes no use of: everything that is not written down here as used."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field

from lxml import etree

from drake_twin.description.gazebo_drives import is_drive
from drake_twin.description.robot_description import GazeboPlugin
from drake_twin.description.sensors import KINDS, sensor_text
from drake_twin.description.unused_contact import is_unused
from drake_twin.description.xml_reader import XmlReader
from drake_twin.findings import Finding, Kind, at_places

_DRAKE = "{http://drake.mit.edu}"  # Drake's parser reads what is its own


@dataclass(frozen=True)
class Part:
    """What of an element is used.

    Attributes:
        attributes: its attributes.
        children: the elements in it.
        names: of ``<param>``, the names that mean something; None where all do.
    """

    attributes: frozenset[str] = frozenset()
    children: Mapping[str, "Part"] = field(default_factory=dict)
    names: frozenset[str] | None = None


def _part(attributes: str = "", names: str | None = None, **children: Part) -> Part:
    return Part(frozenset(attributes.split()), children, None if names is None else frozenset(names.split()))


_TEXT = _part()
_ORIGIN = _part("xyz rpy")
_GEOMETRY = _part(
    box=_part("size"),
    cylinder=_part("radius length"),
    sphere=_part("radius"),
    capsule=_part("radius length"),
    ellipsoid=_part("a b c"),
    mesh=_part("filename scale"),
)
_MATERIAL = _part("name", color=_part("rgba"))
_URDF = _part(
    "name version",
    material=_MATERIAL,
    link=_part(
        "name",
        inertial=_part(origin=_ORIGIN, mass=_part("value"), inertia=_part("ixx ixy ixz iyy iyz izz")),
        visual=_part("name", origin=_ORIGIN, geometry=_GEOMETRY, material=_MATERIAL),
        collision=_part("name", origin=_ORIGIN, geometry=_GEOMETRY),
    ),
    joint=_part(
        "name type",
        origin=_ORIGIN,
        parent=_part("link"),
        child=_part("link"),
        axis=_part("xyz"),
        limit=_part("lower upper effort velocity"),
        dynamics=_part("damping friction"),
        mimic=_part("joint multiplier offset"),
    ),
    ros2_control=_part(
        "name type",
        hardware=_part(plugin=_TEXT, param=_part("name", "hold_joints position_proportional_gain")),
        joint=_part(
            "name mimic",
            command_interface=_part("name", param=_part("name", "min max")),
            state_interface=_part("name", param=_part("name", "initial_value")),
            param=_part("name", "mimic multiplier offset"),
        ),
        sensor=_part("name", state_interface=_part("name"), param=_part("name")),
    ),
    # Fixed joints are never lumped together here, which is what two of these ask for.
    gazebo=_part(
        "reference",
        mu1=_TEXT,
        mu2=_TEXT,
        selfCollide=_TEXT,
        self_collide=_TEXT,
        material=_TEXT,
        preserveFixedJoint=_TEXT,
        disableFixedJointLumping=_TEXT,
    ),
)

_XYZ = _part("expressed_in", x=_TEXT, y=_TEXT, z=_TEXT)
_POSE = _part("relative_to rotation_format degrees frame")
_SDF_GEOMETRY = _part(
    box=_part(size=_TEXT),
    cylinder=_part(radius=_TEXT, length=_TEXT),
    sphere=_part(radius=_TEXT),
    capsule=_part(radius=_TEXT, length=_TEXT),
    ellipsoid=_part(radii=_TEXT),
    mesh=_part(uri=_TEXT, scale=_TEXT),
    plane=_part(normal=_TEXT, size=_TEXT),
    empty=_TEXT,
)
_AXIS = _part(
    xyz=_part("expressed_in"),
    limit=_part(lower=_TEXT, upper=_TEXT, effort=_TEXT, velocity=_TEXT),
    dynamics=_part(damping=_TEXT, spring_reference=_TEXT, spring_stiffness=_TEXT),
    use_parent_model_frame=_TEXT,
)
_SDF_MODEL = _part(
    "name canonical_link placement_frame",
    pose=_POSE,
    static=_TEXT,
    frame=_part("name attached_to", pose=_POSE),
    link=_part(
        "name",
        pose=_POSE,
        inertial=_part(
            pose=_POSE,
            mass=_TEXT,
            inertia=_part(ixx=_TEXT, ixy=_TEXT, ixz=_TEXT, iyy=_TEXT, iyz=_TEXT, izz=_TEXT),
        ),
        gravity=_TEXT,
        visual=_part(
            "name",
            pose=_POSE,
            geometry=_SDF_GEOMETRY,
            material=_part(diffuse=_TEXT, ambient=_TEXT),
        ),
        collision=_part("name", pose=_POSE, geometry=_SDF_GEOMETRY, surface=_part(friction=_part(ode=_part(mu=_TEXT)))),
    ),
    joint=_part(
        "name type",
        pose=_POSE,
        parent=_TEXT,
        child=_TEXT,
        axis=_AXIS,
        axis2=_AXIS,
        thread_pitch=_TEXT,
        screw_thread_pitch=_TEXT,
    ),
)

_SAID = _part()  # in words of its own
# Where gz_ros2_control finds the robot is no question here: it is in the same file.
_ROS2_CONTROL = _part(
    "filename name",
    parameters=_TEXT,
    ros=_part(namespace=_TEXT),
    hold_joints=_TEXT,
    position_proportional_gain=_TEXT,
    robot_param=_TEXT,
    robot_param_node=_TEXT,
)
_NOISE = _part(noise=_SAID)
_NOISES = _part(x=_NOISE, y=_NOISE, z=_NOISE)
# It is always on here, and has no window.
_SENSOR = _part(
    "name type",
    pose=_POSE,
    origin=_TEXT,
    update_rate=_TEXT,
    topic=_TEXT,
    gz_frame_id=_TEXT,
    ignition_frame_id=_TEXT,
    frame_id=_TEXT,
    always_on=_TEXT,
    visualize=_TEXT,
    enable_metrics=_TEXT,
    noise=_SAID,
    imu=_part(
        orientation_reference_frame=_part(localization=_TEXT, custom_rpy=_part("parent_frame")),
        angular_velocity=_NOISES,
        linear_acceleration=_NOISES,
        noise=_SAID,
    ),
    force_torque=_part(frame=_TEXT, measure_direction=_TEXT, force=_NOISES, torque=_NOISES, noise=_SAID),
)

# Of what is not here, the first one counts.
_SEVERAL = {
    *(("robot", tag) for tag in ("link", "joint", "material", "gazebo", "ros2_control")),
    *(("model", tag) for tag in ("link", "joint", "frame")),
    *(("link", tag) for tag in ("visual", "collision")),
    *(("ros2_control", tag) for tag in ("joint", "sensor")),
    *(("joint", tag) for tag in ("command_interface", "state_interface", "param")),
    *(("sensor", tag) for tag in ("state_interface", "param")),
    *((tag, "param") for tag in ("hardware", "command_interface", "state_interface")),
    ("plugin", "parameters"),
}

_SENSORS = {
    "camera": "the twin has no cameras",
    "depth": "the twin has no cameras",
    "rgbd": "the twin has no cameras",
    "ray": "the twin has no lidar",
    "lidar": "the twin has no lidar",
    "contact": "the twin has no contact sensors",
    "bumper": "the twin has no contact sensors",
    "gps": "the twin has no satellite navigation",
    "navsat": "the twin has no satellite navigation",
    "magnetometer": "the twin has no magnetic field",
    "sonar": "the twin has no range sensors",
    "altimeter": "the twin has no altimeter",
    "pressure": "the twin has no air",
}
_PLUGINS = {
    **_SENSORS,
    "p3d": "true poses are on the topic ground_truth/odom of each robot",
    "laser": "the twin has no lidar",
    "imu": "an imu_sensor_broadcaster in the controllers' file publishes an IMU",
    "ft_sensor": "a force_torque_sensor_broadcaster in the controllers' file publishes it",
    "buoyancy": "the twin has no water and no air",
    "lift": "the twin has no water and no air",
    "hydrodynamics": "the twin has no water and no air",
    "wind": "the twin has no water and no air",
    "thruster": "the twin has no water and no air",
    "sensors-system": "sensors are read without it",
    "battery": "the twin has no batteries",
}


def is_known(parent: etree._Element, child: etree._Element) -> bool:
    """Whether an element of ``<robot>``, ``<link>`` or ``<joint>`` is one that the twin or Drake reads."""
    above = _URDF if parent.tag == "robot" else _URDF.children.get(str(parent.tag), _TEXT)
    return child.tag in above.children or str(child.tag).startswith(_DRAKE)


def unread_in_urdf(reader: XmlReader) -> list[Finding]:
    """Each element and attribute of which no use is made, the same one at several places once, with its lines."""
    return list(_findings(reader, (*_unread(reader.root, _URDF), *_about_nothing(reader.root))))


def _about_nothing(root: etree._Element) -> Iterator[tuple[etree._Element, str]]:
    """``<gazebo reference>`` of what the robot does not have."""
    known = {item.get("name", "").strip() for tag in ("link", "joint") for item in root.iterfind(tag)}
    for element in root.iterfind("gazebo[@reference]"):
        reference = element.get("reference", "").strip()
        if reference and reference not in known and len(element):
            yield element, f"<gazebo reference={reference!r}>: the robot has no such link or joint"


def unread_in_sdf(reader: XmlReader) -> tuple[Finding, ...]:
    """The same of an SDF file with one model."""
    model = reader.root.find("model")
    return () if model is None else tuple(_findings(reader, _unread(model, _SDF_MODEL)))


def _findings(reader: XmlReader, unread: Iterable[tuple[etree._Element, str]]) -> Iterator[Finding]:
    return at_places(Kind.IGNORED, ((what, reader.place(element)) for element, what in unread))


def _unread(element: etree._Element, part: Part) -> Iterator[tuple[etree._Element, str]]:
    tag = etree.QName(element).localname
    seen: set[str] = set()
    for name in map(str, element.attrib):
        if name not in part.attributes and not name.startswith("{"):
            yield element, f"the attribute {name} of <{tag}>"
    for child in element:
        if not isinstance(child.tag, str) or child.tag.startswith(_DRAKE):
            continue
        name = etree.QName(child).localname
        known = part.children.get(child.tag)
        if known is not None and child.tag in seen and (tag, name) not in _SEVERAL:
            yield child, f"a second <{name}> in <{tag}>"
            continue
        seen.add(child.tag)
        if known is not None and known.names is not None and child.get("name", "") not in known.names:
            yield child, f'<{name} name="{child.get("name", "")}"> in <{tag}>'
        elif known is not None and known is not _SAID:
            yield from _unread(child, known)
        elif tag in ("gazebo", "model", "sensor") and name == "plugin":
            yield from _unread_plugin(child)
        elif tag in ("gazebo", "link", "joint") and name == "sensor":
            yield from _unread_sensor(child, element.get("reference") or element.get("name") or "?")
        elif known is not _SAID and not is_unused(child):  # which is said in words of its own
            yield child, f"<{name}>" + (f" in <{tag}>" if tag != "robot" else "")


def _unread_plugin(plugin: etree._Element) -> Iterator[tuple[etree._Element, str]]:
    filename, name = plugin.get("filename", ""), plugin.get("name", "")
    if "ros2_control" in filename + name:
        yield from _unread(plugin, _ROS2_CONTROL)
        return
    if is_drive(GazeboPlugin(filename, name)):
        for attribute in map(str, plugin.attrib):
            if attribute not in _ROS2_CONTROL.attributes:
                yield plugin, f"the attribute {attribute} of <plugin>"
        return
    called = f"{name} ({filename})" if name and filename else name or filename or "?"
    yield plugin, f"Gazebo plugin {called}: {_reason(_PLUGINS, filename + name, 'the twin has no such plugin')}"


def _unread_sensor(sensor: etree._Element, place: str) -> Iterator[tuple[etree._Element, str]]:
    kind = sensor.get("type", "").strip()
    if kind in KINDS:
        for noise in sensor.iter("noise"):
            yield noise, f"<noise> of sensor {sensor.get('name', '')}: the twin's sensors are exact"
        yield from _unread(sensor, _SENSOR)
        return
    what = sensor_text(sensor.get("name", ""), kind, place, (sensor.findtext("topic") or "").strip())
    yield sensor, f"{what}: {_reason(_SENSORS, kind, 'the twin has no such sensor')}"


def _reason(reasons: Mapping[str, str], name: str, otherwise: str) -> str:
    return next((reason for part, reason in reasons.items() if part in name.lower()), otherwise)
