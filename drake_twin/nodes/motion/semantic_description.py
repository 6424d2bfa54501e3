"""An SRDF: the groups of joints of a robot, their named states, and the links that may touch.

Source: moveit/srdfdom (ros2), src/model.cpp; moveit_core's robot_model.cpp for the joints of a group.
"""

from collections.abc import Mapping
from dataclasses import field
from xml.etree import ElementTree

from drake_twin.dataclass import dataclass
from drake_twin.description.robot_description import RobotDescription


@dataclass(frozen=True)
class JointGroup:
    """A group of joints that is planned for.

    Attributes:
        name: Its name.
        joints: Its movable joints without those that follow others, in the order of the robot's tree.
        links: The links that its joints move, and those of its chain.
        tip: The last link of its chain; of a group without one, the last link of its joints.
    """

    name: str
    joints: tuple[str, ...]
    links: tuple[str, ...]
    tip: str


@dataclass(frozen=True)
class SemanticDescription:
    """What an SRDF says of a robot.

    Attributes:
        groups: Name → group.
        states: Group and name of a state → joint → position (rad or m).
        touching: Pairs of links that may touch.
        world: The frame in which the robot stands, by a fixed virtual joint; empty without one.
    """

    groups: Mapping[str, JointGroup] = field(default_factory=dict)
    states: Mapping[tuple[str, str], Mapping[str, float]] = field(default_factory=dict)
    touching: frozenset[frozenset[str]] = frozenset()
    world: str = ""


def read_semantic_description(text: str, robot: RobotDescription) -> SemanticDescription:
    """Return what an SRDF says of a robot.

    Raises:
        ValueError: If the text is not XML, or names a joint, a link or a group that does not exist.
    """
    try:
        root = ElementTree.fromstring(text)
    except ElementTree.ParseError as error:
        raise ValueError(f"robot_description_semantic is not valid XML: {error}") from None
    elements = {_name(group): group for group in root.findall("group")}
    reader = _GroupReader(robot, elements, {_name(joint) for joint in root.findall("passive_joint")})
    virtual = [joint for joint in root.findall("virtual_joint") if joint.get("type") == "fixed"]
    return SemanticDescription(
        {name: reader.group(name) for name in elements},
        {
            (state.get("group", ""), _name(state)): {
                _name(joint): float(joint.get("value", "0").split()[0]) for joint in state.findall("joint")
            }
            for state in root.findall("group_state")
        },
        frozenset(
            frozenset((pair.get("link1", ""), pair.get("link2", ""))) for pair in root.findall("disable_collisions")
        ),
        virtual[0].get("parent_frame", "") if virtual else "",
    )


class _GroupReader:
    def __init__(self, robot: RobotDescription, elements: Mapping[str, ElementTree.Element], passive: set[str]):
        self._robot, self._elements, self._passive = robot, elements, passive
        self._above = {joint.child: joint for joint in robot.joints}

    def group(self, name: str) -> JointGroup:
        joints, tips = self._members(name, ())
        order = [joint.name for joint in self._robot.joints]
        named = sorted(joints, key=order.index)
        moving = [
            joint
            for joint in (self._robot.joints_by_name[item] for item in named)
            if joint.is_movable and joint.mimic is None and joint.name not in self._passive
        ]
        links = tuple(self._robot.joints_by_name[item].child for item in named)
        tip = tips[-1] if tips else links[-1] if links else ""
        return JointGroup(name, tuple(joint.name for joint in moving), links, tip)

    def _members(self, name: str, within: tuple[str, ...]) -> tuple[set[str], list[str]]:
        element = self._elements.get(name)
        if element is None or name in within:
            raise ValueError(f"robot_description_semantic: group {name!r} does not exist, or contains itself")
        joints: set[str] = set()
        tips: list[str] = []
        for chain in element.findall("chain"):
            joints |= self._chain(name, chain.get("base_link", ""), chain.get("tip_link", ""))
            tips.append(chain.get("tip_link", ""))
        for joint in element.findall("joint"):
            if _name(joint) in self._robot.joints_by_name:  # a virtual joint is not the robot's
                joints.add(_name(joint))
        for link in element.findall("link"):
            if _name(link) in self._above:
                joints.add(self._above[_name(link)].name)
        for group in element.findall("group"):
            own, more = self._members(_name(group), (*within, name))
            joints |= own
            tips += more
        return joints, tips

    def _chain(self, name: str, base: str, tip: str) -> set[str]:
        joints: set[str] = set()
        link = tip
        while link != base:
            if link not in self._above:
                raise ValueError(f"robot_description_semantic: group {name!r}: no chain from {base!r} to {tip!r}")
            joints.add(self._above[link].name)
            link = self._above[link].parent
        return joints


def _name(element: ElementTree.Element) -> str:
    return element.get("name", "")
