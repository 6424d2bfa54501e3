"""The ``<sensor>`` tags of ``<gazebo>`` and ``<ros2_control>`` in a URDF, and of an SDF's links and joints.

Name, place, pose, rate, topic and frame are read here; the rest of the element is left to its kind, in
`drake_twin.sensors`.
"""

from collections.abc import Callable, Iterator, Mapping
from copy import deepcopy
from dataclasses import replace
from math import nan
from typing import Any

from lxml import etree

from drake_twin.description.fixed_joint_lumping import lumped_links
from drake_twin.description.gazebo_plugins import plugin_kind, read_plugin
from drake_twin.description.robot_description import HardwareSensor, Pose, Sensor
from drake_twin.description.xml_reader import XmlReader, parameters_of

# Plugins of Gazebo classic that are sensors by themselves, outside of a <sensor>: the element that names their link
# or joint, and the one of their rate (Hz).
SENSOR_PLUGINS = {
    "gazebo_ros_p3d": ("link", "body_name", "update_rate"),
    "gazebo_ros_ft_sensor": ("joint", "joint_name", "update_rate"),
    "gazebo_ros_imu": ("link", "bodyName", "updateRate"),  # ROS 1's, which still stands in files
}

_FRAMES = ("camera/optical_frame_id", "frame_id", "gz_frame_id", "ignition_frame_id", "plugin/frame_name")


def sensors_in_urdf(reader: XmlReader) -> Iterator[Sensor]:
    """Read the sensors of a URDF's ``<gazebo>`` tags.

    A sensor at a link or joint that the robot lacks is left out, as in Gazebo.

    Raises:
        InputError: If a value is invalid.
    """
    root = reader.root
    links, joints = ({item.get("name", "").strip() for item in root.iterfind(tag)} for tag in ("link", "joint"))
    lumped, children = lumped_links(root), _children(root)
    for place in root.iterfind("gazebo"):
        reference = (place.get("reference") or "").strip()
        if reference and reference not in links | joints:
            continue
        on = "link" if reference in links else "joint"
        for sensor in (found for element in place.iterfind("sensor") for found in _sensors(reader, element)):
            yield _placed(sensor, on, reference, lumped, children)
        for element in place.iterfind("plugin"):
            yield from _of_plugin(reader, element, lumped, children)


def sensors_in_sdf(reader: XmlReader) -> Iterator[Sensor]:
    """Read the sensors of the links and joints of an SDF document's models.

    Raises:
        InputError: If a value is invalid.
    """
    for model in reader.root.iterfind("model"):
        yield from sensors_in_model(model, lambda _: reader)


def sensors_in_model(model: etree._Element, reader_of: Callable[[etree._Element], XmlReader]) -> Iterator[Sensor]:
    """Read the sensors of the links and joints of a ``<model>``, without those of models inside it.

    Args:
        model: The element.
        reader_of: Returns the document that an element of it stands in.

    Raises:
        InputError: If a value is invalid.
    """
    children = _children(model)
    for tag in ("link", "joint"):
        for element in model.iterfind(f"{tag}/sensor"):
            place, reader = element.getparent(), reader_of(element)
            assert place is not None
            name = reader.text(place, "name")
            yield from (_placed(sensor, tag, name, {}, children) for sensor in _sensors(reader, element))
    for element in model.iterfind("plugin"):
        yield from _of_plugin(reader_of(element), element, {}, children)


def _placed(sensor: Sensor, on: str, name: str, lumped: Mapping[str, str], children: Mapping[str, str]) -> Sensor:
    """Return a sensor on a link or a joint of a name, with the link that Gazebo attaches it to."""
    if on == "link":
        return replace(sensor, link=name, gazebo_link=lumped.get(name, name))
    return replace(sensor, joint=name, gazebo_link=children.get(name, ""))


def _children(root: etree._Element) -> dict[str, str]:
    """Return joint → child link."""
    found = {}
    for joint in root.iterfind("joint"):
        child = joint.find("child")
        if child is not None:
            found[(joint.get("name") or "").strip()] = (child.get("link") or child.text or "").strip()
    return found


def sensor_text(name: str, kind: str, place: str, topic: str) -> str:
    """Describe a sensor by name, type, place and topic."""
    return f"sensor {name!r} of type {kind or '?'} on {place!r}" + (f", topic {topic}" if topic else "")


def hardware_sensors(reader: XmlReader, system: etree._Element) -> Iterator[HardwareSensor]:
    """Read the sensors of a ``<ros2_control>`` tag.

    Raises:
        InputError: If an ``initial_value`` is neither a number nor, as of a ``bool``, true or false.
    """
    for element in system.iterfind("sensor"):
        yield HardwareSensor(
            name=reader.text(element, "name"),
            state_interfaces={
                reader.text(item, "name"): _initial_value(reader, item) for item in element.iterfind("state_interface")
            },
            parameters=parameters_of(element),
        )


def _initial_value(reader: XmlReader, interface: etree._Element) -> float:
    element = interface.find("param[@name='initial_value']")
    if element is None:
        return nan
    text = (element.text or "").strip()
    truth = {"true": 1.0, "false": 0.0}.get(text.lower())
    return reader.parse_number(element, text, "initial_value") if truth is None else truth


def _sensors(reader: XmlReader, element: etree._Element) -> Iterator[Sensor]:
    """Read a ``<sensor>`` tag: one sensor, or of a multicamera one for each ``<camera>``, called ``SENSOR/CAMERA``."""
    sensor = _sensor(reader, element)
    cameras = element.findall("camera") if sensor.kind == "multicamera" else []
    if not cameras:
        yield sensor
    for camera in cameras:
        others = {part for other in cameras if other is not camera for part in other.iter()}
        places = tuple(reader.place(part) for part in element.iter(etree.Element) if part not in others)
        alone = deepcopy(element)
        for index, copied in enumerate(alone.findall("camera")):
            if cameras[index] is not camera:
                alone.remove(copied)
        name = f"{sensor.name}/{camera.get('name', '').strip()}"
        text = etree.tostring(alone, encoding="unicode", with_tail=False)
        pose = sensor.pose.compose(_pose(reader, camera))
        yield replace(sensor, name=name, text=text, places=places, pose=pose, place=reader.place(camera))


def _sensor(reader: XmlReader, element: etree._Element) -> Sensor:
    """Read a ``<sensor>`` tag, without its link or joint."""
    pose = element.find("pose")
    return _made(
        reader,
        element,
        _text(element, "update_rate"),
        name=reader.text(element, "name"),
        kind=element.get("type", "").strip(),
        pose=_pose(reader, element),
        pose_frame="" if pose is None else (pose.get("relative_to") or "").strip(),
        frame=next((text for tag in _FRAMES if (text := _text(element, tag))), ""),
        topic=_text(element, "topic"),
    )


def _made(reader: XmlReader, element: etree._Element, rate: str, **more: Any) -> Sensor:
    """Return the sensor of an element with a rate (Hz) and more attributes."""
    sensor = Sensor(
        update_rate=reader.parse_number(element, rate, "update_rate") if rate else 0.0,
        place=reader.place(element),
        text=etree.tostring(element, encoding="unicode", with_tail=False),
        places=tuple(map(reader.place, element.iter(etree.Element))),
        **more,
    )
    if sensor.update_rate < 0.0:
        raise reader.error(element, f"update_rate is {rate!r}, but it cannot be negative")
    return sensor


def _of_plugin(
    reader: XmlReader, element: etree._Element, lumped: Mapping[str, str], children: Mapping[str, str]
) -> Iterator[Sensor]:
    """Yield the sensor that a plugin outside of a ``<sensor>`` is, if it is one."""
    kind = plugin_kind(read_plugin(reader, element))
    if kind not in SENSOR_PLUGINS:
        return
    on, *tags = SENSOR_PLUGINS[kind]
    where, rate = (_text(element, tag) for tag in tags)
    frame = _text(element, "frame_name") or _text(element, "frameName")
    sensor = _made(reader, element, rate, name=(element.get("name") or kind).strip(), kind=kind, frame=frame)
    yield _placed(sensor, on, where, lumped, children)


def _text(element: etree._Element, path: str) -> str:
    return (element.findtext(path) or "").strip()


def _pose(reader: XmlReader, element: etree._Element) -> Pose:
    found = element.find("pose")
    if found is not None and (found.get("rotation_format") or found.get("degrees")):
        from drake_twin.description.sdf_pose import transform_of

        return Pose.of(transform_of(found, reader))
    text = _text(element, "pose") or _text(element, "origin")
    if not text:
        return Pose()
    x, y, z, roll, pitch, yaw = reader.parse_numbers(element, text, "pose", 6)
    return Pose((x, y, z), (roll, pitch, yaw))
