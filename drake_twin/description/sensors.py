"""The ``<sensor>`` tags of ``<gazebo>`` and ``<ros2_control>`` in a URDF, and of an SDF's links and joints."""

from collections.abc import Iterator
from dataclasses import replace
from math import pi
from pathlib import Path

from lxml import etree

from drake_twin.description.robot_description import HardwareSensor, Pose, Sensor, Vector3
from drake_twin.description.xml_reader import XmlReader
from drake_twin.extensions import load_extensions

# Sensor type → the element that it is on; drake_twin.sensors.registry adds the types of others.
SENSOR_KINDS = {"imu": "link", "force_torque": "joint"}

# The frames that an IMU's orientation can be relative to, in a world whose x, y and z are east, north and up.
_LOCALIZATIONS: dict[str, Vector3] = {"ENU": (0.0, 0.0, 0.0), "NWU": (0.0, 0.0, pi / 2), "NED": (pi, 0.0, pi / 2)}


def sensors_in_urdf(reader: XmlReader) -> Iterator[Sensor]:
    """Read the IMUs and force/torque sensors of a URDF's ``<gazebo reference>`` tags.

    A sensor at a link or joint that the robot lacks is left out, as in Gazebo.

    Raises:
        InputError: If a value is invalid.
    """
    for element in reader.root.iterfind("gazebo[@reference]/sensor"):
        place = element.getparent()
        assert place is not None
        reference = reader.text(place, "reference")
        sensor = _sensor(reader, element)
        if sensor is None:
            continue
        tag = SENSOR_KINDS[sensor.kind]
        if reference in {item.get("name", "").strip() for item in reader.root.iterfind(tag)}:
            yield replace(sensor, link=reference) if tag == "link" else replace(sensor, joint=reference)


def sensors_in_sdf(text: str, file: Path) -> Iterator[Sensor]:
    """Read the IMUs and force/torque sensors of an SDF model's links and joints.

    Raises:
        InputError: If a value is invalid.
    """
    reader = XmlReader(text, file)
    for tag in ("link", "joint"):
        for element in reader.root.iterfind(f"model/{tag}/sensor"):
            place = element.getparent()
            assert place is not None
            sensor = _sensor(reader, element)
            if sensor is not None and SENSOR_KINDS[sensor.kind] == tag:
                name = reader.text(place, "name")
                yield replace(sensor, link=name) if tag == "link" else replace(sensor, joint=name)


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
            state_interfaces=tuple(reader.text(item, "name") for item in element.iterfind("state_interface")),
            parameters={item.get("name", ""): (item.text or "").strip() for item in element.iterfind("param")},
            initial_values={
                reader.text(parent, "name"): _initial_value(reader, item)
                for parent in element.iterfind("state_interface")
                for item in parent.iterfind("param[@name='initial_value']")
            },
        )


def _initial_value(reader: XmlReader, element: etree._Element) -> float:
    text = (element.text or "").strip()
    truth = {"true": 1.0, "false": 0.0}.get(text.lower())
    return reader.parse_number(element, text, "initial_value") if truth is None else truth


def _sensor(reader: XmlReader, element: etree._Element) -> Sensor | None:
    """Read a ``<sensor>`` tag, without its link or joint; return None for one of another kind."""
    kind = element.get("type", "").strip()
    load_extensions("drake_twin.sensors")
    if kind not in SENSOR_KINDS:
        return None
    frames = ("gz_frame_id", "ignition_frame_id", "frame_id", "plugin/frame_name", "plugin/frameName")
    rate = _text(element, "update_rate")
    sensor = Sensor(
        name=reader.text(element, "name"),
        kind=kind,
        pose=_pose(reader, element),
        frame=next((text for tag in frames if (text := _text(element, tag))), ""),
        topic=_text(element, "topic"),
        update_rate=reader.parse_number(element, rate, "update_rate") if rate else 0.0,
        place=reader.place(element),
        text=etree.tostring(element, encoding="unicode", with_tail=False),
    )
    if sensor.update_rate < 0.0:
        raise reader.error(element, f"update_rate is {rate!r}, but it cannot be negative")
    if kind == "imu":
        return replace(sensor, orientation_reference=_orientation_reference(reader, element))
    if kind != "force_torque":
        return sensor
    direction = _choice(reader, element, "measure_direction", ("child_to_parent", "parent_to_child"))
    axes = _choice(reader, element, "frame", ("child", "parent", "sensor"))
    return replace(sensor, measured_on=direction.rpartition("_")[2], axes=axes)


def _text(element: etree._Element, path: str) -> str:
    return (element.findtext(path) or "").strip()


def _choice(reader: XmlReader, element: etree._Element, tag: str, choices: tuple[str, ...]) -> str:
    """Read a child of ``<force_torque>`` that is one of a few words; the first where it is not given."""
    text = _text(element, f"force_torque/{tag}") or choices[0]
    if text not in choices:
        raise reader.error(element, f"unknown {tag} {text!r}", value=text, valid=choices)
    return text


def _pose(reader: XmlReader, element: etree._Element) -> Pose:
    text = _text(element, "pose") or _text(element, "origin")
    if not text:
        return Pose()
    x, y, z, roll, pitch, yaw = reader.parse_numbers(element, text, "pose", 6)
    return Pose((x, y, z), (roll, pitch, yaw))


def _orientation_reference(reader: XmlReader, element: etree._Element) -> Vector3 | None:
    """Read the reference as gz-sim does: a named frame, one of the file's own, or the orientation at the start."""
    for tag in ("initial_orientation_as_reference", "initialOrientationAsReference"):
        if _text(element, f"plugin/{tag}").lower() in ("0", "false"):  # Gazebo classic's plugin for ROS
            return _LOCALIZATIONS["ENU"]
    frame = element.find("imu/orientation_reference_frame")
    if frame is None:
        return None
    localization = _text(frame, "localization") or "CUSTOM"
    if localization in _LOCALIZATIONS:
        return _LOCALIZATIONS[localization]
    if localization not in ("CUSTOM", "GRAV_UP", "GRAV_DOWN"):
        valid = ("CUSTOM", *_LOCALIZATIONS)
        raise reader.error(frame, f"unknown localization {localization!r}", value=localization, valid=valid)
    text = _text(frame, "custom_rpy") or "0 0 0"
    roll, pitch, yaw = reader.parse_numbers(frame, text, "custom_rpy", 3)
    return roll, pitch, yaw
