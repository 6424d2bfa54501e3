"""Names in ``<ros2_control>`` that simulated hardware does not have: types of hardware, interfaces of joints."""

from collections.abc import Iterator

from lxml import etree

from drake_twin.description.xml_reader import XmlReader
from drake_twin.errors import did_you_mean
from drake_twin.findings import Finding, Kind, at_places

_TYPES = ("system", "actuator", "sensor")
_INTERFACES = ("position", "velocity", "effort")
_OF_PID = "_pid"  # gazebo_ros2_control's suffix of an interface that its own PID follows


def unknown_hardware_names(reader: XmlReader) -> Iterator[Finding]:
    """Report types of hardware and interfaces of joints that nothing simulates, each once with its lines."""
    return at_places(Kind.WARNING, ((what, reader.place(element)) for element, what in _unknown(reader.root)))


def _unknown(root: etree._Element) -> Iterator[tuple[etree._Element, str]]:
    for system in root.iterfind("ros2_control"):
        kind = system.get("type", _TYPES[0]).strip()
        if kind not in _TYPES:
            yield system, f"unknown type {kind!r} of <ros2_control>{_valid(kind, _TYPES)}"
        for tag in ("command_interface", "state_interface"):
            for interface in system.iterfind(f"joint/{tag}"):
                name = interface.get("name", "").strip()
                if name.removesuffix(_OF_PID) not in _INTERFACES:
                    yield interface, f"a simulated joint has no <{tag} name={name!r}>{_valid(name, _INTERFACES)}"


def _valid(name: str, known: tuple[str, ...]) -> str:
    return did_you_mean(name, known) or f"; it has {', '.join(known)}"
