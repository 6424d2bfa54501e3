"""A ``<sensor>`` element as a kind of sensor reads it: values with checks, and what nobody has read."""

from collections.abc import Iterator
from math import inf

from lxml import etree

from drake_twin.description.gazebo_plugins import plugin_kind, read_plugin
from drake_twin.description.robot_description import GazeboPlugin, Sensor
from drake_twin.description.xml_reader import XmlReader
from drake_twin.errors import InputError
from drake_twin.findings import Cause, Finding, Kind, merged
from drake_twin.values import is_true

# What `drake_twin.description.sensors` reads, and what has no meaning here: sensors are always on and not drawn.
_OF_ALL_SENSORS = (
    *("pose", "origin", "update_rate", "topic", "frame_id", "gz_frame_id", "ignition_frame_id"),
    "camera/optical_frame_id",
    *("always_on", "visualize", "enable_metrics", "plugin/ros", "plugin/frame_name"),
)
_ATTRIBUTES = ("name", "type", "filename", "relative_to", "rotation_format", "degrees", "frame")


class SensorElement:
    """Read the values of an element of a sensor, and note which elements were read.

    Paths are those of elements below this one: ``imu/angular_velocity/x/noise``. Of several elements of one path the
    first is read.

    Args:
        sensor: The sensor, for its element's text and places.
        element: The element; the whole ``<sensor>`` by default.
    """

    def __init__(self, sensor: Sensor, element: "tuple[XmlReader, etree._Element, set[etree._Element]] | None" = None):
        self.sensor = sensor
        if element is None:
            reader = XmlReader(sensor.text, places=sensor.places or None)
            element = reader, reader.root, set()
        self._reader, self._element, self._taken = element
        if self._element is self._reader.root:
            for plugin in self._element.findall("plugin"):
                kind = plugin_kind(read_plugin(self._reader, plugin))
                if kind.startswith("gazebo_ros_") or kind.endswith("-system"):  # the latter is the simulation of a kind
                    self._taken.add(plugin)
            for path in _OF_ALL_SENSORS:
                for found in self._element.findall(path):
                    self._take(found)
                    if path == "plugin/ros":
                        self._taken.update(found.iter(etree.Element))

    @property
    def plugin(self) -> GazeboPlugin | None:
        """The sensor's first plugin; None without one."""
        found = self._element if self._element.tag == "plugin" else self._element.find("plugin")
        return None if found is None else read_plugin(self._reader, found)

    @property
    def plugin_kind(self) -> str:
        """The kind of its first plugin, as `plugin_kind` returns it; empty without one."""
        return "" if self.plugin is None else plugin_kind(self.plugin)

    def error(self, message: str, path: str = "", **more: object) -> InputError:
        """Return an error that points at an element, or at this one."""
        found = self._element.find(path) if path else self._element
        return self._reader.error(self._element if found is None else found, message, **more)

    def has(self, path: str) -> bool:
        """Tell whether there is an element."""
        return self._find(path) is not None

    def part(self, path: str) -> "SensorElement | None":
        """Return an element; None without one."""
        found = self._find(path)
        return None if found is None else SensorElement(self.sensor, (self._reader, found, self._taken))

    def parts(self, path: str) -> "tuple[SensorElement, ...]":
        """Return all elements of a path."""
        found = self._element.findall(path)
        for element in found:
            self._take(element)
        return tuple(SensorElement(self.sensor, (self._reader, element, self._taken)) for element in found)

    def attribute(self, name: str, default: str = "") -> str:
        """Return an attribute of this element."""
        return (self._element.get(name) or default).strip()

    def text(self, *paths: str, default: str = "") -> str:
        """Return the text of the first of some elements that has one."""
        texts = [(found.text or "").strip() for path in paths if (found := self._find(path)) is not None]
        return next(filter(None, texts), default)

    def flag(self, path: str, default: bool) -> bool:
        """Read a flag.

        Raises:
            InputError: If it is neither true nor false.
        """
        text = self.text(path, default=str(default)).lower()
        if text not in ("true", "false", "1", "0"):
            raise self.error(f"{_name(path)} is {text!r}, which is neither true nor false", path)
        return is_true(text)

    def choice(self, path: str, choices: tuple[str, ...]) -> str:
        """Read a text that is one of a few; the first by default.

        Raises:
            InputError: If it is another one.
        """
        text = self.text(path, default=choices[0])
        if text not in choices:
            raise self.error(f"unknown {_name(path)} {text!r}", path, value=text, valid=choices)
        return text

    def number(self, path: str, default: float, least: float = -inf, most: float = inf) -> float:
        """Read a finite number; an element without text is not read.

        Raises:
            InputError: If it is not a number, or is out of bounds.
        """
        found = self._element.find(path)
        if found is None or not (text := (found.text or "").strip()):
            return default
        self._take(found)
        value = self._reader.parse_number(found, text, _name(path))
        if not least <= value <= most:
            bounds = f"at least {least:g}" if most == inf else f"at most {most:g}"
            bounds = f"{least:g} to {most:g}" if -inf < least and most < inf else bounds
            raise self.error(f"{_name(path)} is {text!r}, but it must be {bounds}", path)
        return value

    def numbers(self, path: str, count: int, default: tuple[float, ...]) -> tuple[float, ...]:
        """Read so many finite numbers; an element without text is not read.

        Raises:
            InputError: If they are not.
        """
        found = self._element.find(path)
        if found is None or not (text := (found.text or "").strip()):
            return default
        self._take(found)
        return self._reader.parse_numbers(found, text, _name(path), count)

    def unread(self) -> Iterator[Finding]:
        """Yield a finding of each element that was not read, and of each attribute that nothing reads."""
        yield from merged((*self._unread_attributes(self._element), *self._unread_in(self._element)))

    def take_all(self) -> None:
        """Note every element as read."""
        self._taken.update(self._element.iter(etree.Element))

    def _find(self, path: str) -> etree._Element | None:
        found = self._element.find(path)
        if found is not None:
            self._take(found)
        return found

    def _take(self, element: etree._Element) -> None:
        while element is not self._reader.root:
            self._taken.add(element)
            above = element.getparent()
            assert above is not None
            element = above

    def _unread_in(self, element: etree._Element) -> Iterator[Finding]:
        common = f" in <{element.tag}> of sensor {self.sensor.name!r}"
        for child in element.iterchildren(etree.Element):
            if child in self._taken:
                yield from self._unread_attributes(child)
                yield from self._unread_in(child)
            elif not (child.tag in self.sensor.kind and _is_empty(child)):  # <imu/> of an IMU has all the defaults
                place = self._reader.place(child)
                yield Finding.at(Kind.IGNORED, f"<{child.tag}>{common}", place, common=common, cause=Cause.UNREAD)

    def _unread_attributes(self, element: etree._Element) -> Iterator[Finding]:
        common = f" of <{element.tag}> of sensor {self.sensor.name!r}"
        for name in map(str, element.attrib):
            if name not in _ATTRIBUTES and not name.startswith("{"):
                place = self._reader.place(element)
                what = f"the attribute {name}{common}"
                yield Finding.at(Kind.IGNORED, what, place, common=common, cause=Cause.UNREAD)


def _is_empty(element: etree._Element) -> bool:
    return not (len(element) or element.attrib or (element.text or "").strip())


def _name(path: str) -> str:
    return path.rpartition("/")[2]
