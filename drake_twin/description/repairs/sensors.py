"""Repairs of the sensors in a URDF's ``<gazebo>`` tags."""

from drake_twin.description.repairs import Mended, repair
from drake_twin.description.xml_reader import XmlReader


@repair("sensor_frame")
def sensor_frame(reader: XmlReader) -> Mended:
    """Let a sensor's pose that is relative to a frame which the robot lacks be relative to its link, as in Gazebo."""
    known = {(item.get("name") or "").strip() for tag in ("link", "joint") for item in reader.root.iterfind(tag)}
    for pose in reader.root.iterfind("gazebo/sensor/pose"):
        frame = (pose.get("relative_to") or "").strip()
        if frame and frame not in known | {"__model__"}:
            del pose.attrib["relative_to"]
            yield pose, f"the sensor's pose is relative to the unknown frame {frame!r}: it is relative to its link"
