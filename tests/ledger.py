"""Robot files changed in one place, whose own XML says what has become of it: the reference for the twin's findings."""

import copy
import re
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from random import Random

from lxml import etree

from drake_twin.description.package_index import PackageIndex
from drake_twin.description.robot_model import RobotModel, load_robot_model
from drake_twin.errors import InputError
from drake_twin.findings import Finding, Kind
from drake_twin.planning.sensor_plan import plan_sensors
from drake_twin.scenario import Robot as InScenario

# What may have another value without changing anything, and why.
WITHOUT_EFFECT = {
    "/robot/@version": "there is one version",
    "//ros2_control/@name": "a label",
    "//gazebo/@reference": "what it holds may mean nothing for a link without shapes",
    "//gazebo/material/text()": "shapes may have colours of their own, and not each name is a colour's",
    "//material[color]/@name": "a label, where the colour is beside it",
    "//sensor/always_on/text()": "sensors are always on",
    "//sensor/visualize/text()": "sensors are not drawn",
    "//sensor/plugin//@name": "a label, where the topics are remapped",
    "//self_collide/text()": "1 and 1.11 are both true",
    "//static/text()": "every word but true and 1 is false",
    "//inertial[mass/@value = 0]//@*": "a link without mass has no inertia",
}


class Robot:
    """A robot's XML without comments, which is written to a file and loaded.

    Attributes:
        root: the XML.
    """

    def __init__(self, text: bytes, file: Path, packages: PackageIndex):
        self.root = etree.fromstring(text, etree.XMLParser(remove_comments=True))
        self._file, self._packages = file, packages

    def items(self, *, texts: bool) -> list[tuple[str, str | None]]:
        """Path of each element, and the name of each attribute; None for the element's name, or its text."""
        return [
            (_path(element), name)
            for element in self.root.iter(etree.Element)
            if element is not self.root and ":" not in _path(element)  # prefixes are not the twin's
            for name in [*element.attrib, *([None] if not texts or (element.text or "").strip() else [])]
        ]

    def load(self, root: etree._Element) -> RobotModel | InputError:
        """The robot of other XML, or why it is refused."""
        self._file.write_bytes(etree.tostring(root))
        try:
            model = load_robot_model(str(self._file), self._packages)
            sensors, findings = plan_sensors(InScenario("r", "r.urdf"), model.description, "")
            plans = Finding(Kind.WINDOW, repr(sensors))  # for `_outcome`
            return replace(model, findings=(*model.findings, *findings, plans))
        except InputError as error:
            return error
        finally:
            self._file.unlink()

    def changed(self, path: str) -> tuple[etree._Element, etree._Element]:
        """A copy to be changed, and the element in it."""
        root = copy.deepcopy(self.root)
        (element,) = root.getroottree().xpath(path)
        return root, element


def lines_of(element: etree._Element) -> set[int]:
    """The lines at which a finding may say what has become of an element: its own, or those of what it is part of."""
    elements = [element, *element.iterancestors()][:-1]
    again = etree.fromstring(etree.tostring(element.getroottree()))
    numbers = {path: again.getroottree().xpath(path)[0].sourceline for path in map(_path, elements)}
    return set(numbers.values())


def _path(element: etree._Element) -> str:
    return element.getroottree().getpath(element)


def misspelt_in_silence(robot: Robot, random: Random, count: int) -> Iterator[str]:
    """Gives names of elements and attributes that mean nothing; those that no finding's line tells of."""
    items = robot.items(texts=False)
    for path, name in random.sample(items, min(count, len(items))):
        root, element = robot.changed(path)
        what = f"{element.getparent().tag}/{element.tag} {name or ''} of line {element.sourceline}"
        if name is None:
            element.tag += "q"
        else:
            element.set(name + "q", element.attrib.pop(name))
        lines = lines_of(element)
        model = robot.load(root)
        if isinstance(model, RobotModel) and lines.isdisjoint(
            line for finding in model.findings for line in finding.lines
        ):
            yield what


def used_for_nothing(robot: Robot, random: Random, count: int) -> Iterator[str]:
    """Gives other values to attributes and texts; those that change nothing, without a finding or a reason."""
    before = robot.load(robot.root)
    assert isinstance(before, RobotModel)
    said = {line for finding in before.findings for line in finding.lines}
    found = (each for path in WITHOUT_EFFECT for each in robot.root.xpath(path))
    excused = {(_path(each.getparent()), each.attrname) for each in found}
    items = [item for item in robot.items(texts=True) if item not in excused]
    for path, name in random.sample(items, min(count, len(items))):
        root, element = robot.changed(path)
        if name is None:
            element.text = _other(element.text.strip())
        else:
            element.set(name, _other(element.get(name)))
        is_said = not lines_of(robot.changed(path)[1]).isdisjoint(said)
        if _outcome(robot.load(root)) == _outcome(before) and not is_said:
            yield f"{path} {name}"


def _outcome(model: RobotModel | InputError) -> str:
    if isinstance(model, InputError):
        return str(model)
    said = [(item.kind, item.what) for item in model.findings if item.kind is not Kind.IGNORED]
    return repr((model.description, said)) + re.sub(r"\s+", " ", model.drake_text)


def _other(value: str) -> str:
    """Another value of the same kind."""
    first, *rest = value.split() or [""]
    try:
        return " ".join([repr(float(first) * 1.1 + 0.01), *rest])
    except ValueError:
        return value + "x"
