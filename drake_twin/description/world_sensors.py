"""The sensors of a world's own models."""

from collections.abc import Callable
from dataclasses import replace

from lxml import etree

from drake_twin.description.gazebo_plugins import plugin_kind, read_plugin
from drake_twin.description.robot_description import Joint, RobotDescription, Sensor
from drake_twin.description.sensors import SENSOR_PLUGINS, sensors_in_model
from drake_twin.description.xml_reader import XmlReader

_PARTS = ("link", "joint")


class SensorsOfModel:
    """Take the sensors out of a model of a world before it is mended for Drake's parser.

    Args:
        model: The element, with its includes replaced; its sensors are removed from it.
        reader_of: Returns the document that an element of it stands in.

    Raises:
        InputError: If a value is invalid.
    """

    def __init__(self, model: etree._Element, reader_of: Callable[[etree._Element], XmlReader]):
        self._found: list[tuple[etree._Element, list[tuple[Sensor, etree._Element | None]]]] = []
        for each in model.iter("model"):
            named = {(str(part.tag), part.get("name", "").strip()): part for part in each if part.tag in _PARTS}
            sensors = [
                (sensor, named.get(("link", sensor.link) if sensor.link else ("joint", sensor.joint)))
                for sensor in sensors_in_model(each, reader_of)
            ]
            if sensors:
                self._found.append((each, sensors))
            for element in (*each.findall("link/sensor"), *each.findall("joint/sensor"), *each.findall("plugin")):
                parent = element.getparent()
                assert parent is not None
                if element.tag == "sensor" or plugin_kind(read_plugin(reader_of(element), element)) in SENSOR_PLUGINS:
                    parent.remove(element)

    def described(self) -> tuple[RobotDescription, ...]:
        """Return the mended models that have sensors, as robots: one inside another is called ``OUTER::INNER``.

        Links and joints have the names that Drake's parser is given.
        """
        return tuple(_described(model, sensors) for model, sensors in self._found)


def _described(model: etree._Element, sensors: list[tuple[Sensor, etree._Element | None]]) -> RobotDescription:
    names = [model.get("name", ""), *(above.get("name", "") for above in model.iterancestors("model"))]
    root = etree.Element("sdf")
    root.append(etree.fromstring(etree.tostring(model, with_tail=False)))
    return RobotDescription(
        name="::".join(reversed(names)),
        links=tuple(link.get("name", "") for link in model.iterfind("link")),
        joints=tuple(
            Joint(
                joint.get("name", ""),
                joint.get("type", ""),
                (joint.findtext("parent") or "").strip(),
                (joint.findtext("child") or "").strip(),
            )
            for joint in model.iterfind("joint")
        ),
        sensors=tuple(_renamed(*item) for item in sensors),
        text=etree.tostring(root, encoding="unicode"),
    )


def _renamed(sensor: Sensor, part: etree._Element | None) -> Sensor:
    if part is None:
        return sensor
    name = part.get("name", "")
    return replace(sensor, link=name) if part.tag == "link" else replace(sensor, joint=name)
