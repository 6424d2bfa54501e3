"""The ``<state>`` of a world, in which Gazebo classic saves where its models have come to stand."""

from collections.abc import Iterator
from typing import TYPE_CHECKING

from lxml import etree

from drake_twin.description.gazebo_plugins import is_of_gazebo_sim
from drake_twin.description.sdf_pose import transform_of
from drake_twin.description.xml_reader import XmlReader
from drake_twin.findings import Cause, Finding, Kind, first_of

if TYPE_CHECKING:
    from pydrake.math import RigidTransform

_ELSEWHERE = 0.01  # m and rad: what has come to rest is some millimetres below
_MOST_NAMED = 6


class SavedState:
    """The poses of a world's state: Gazebo classic starts with them, Gazebo Sim does not read them.

    Args:
        reader: The world's document.
        world: Its ``<world>``; with a plugin of Gazebo Sim it is a world of Gazebo Sim.

    Raises:
        InputError: If a pose is invalid.
    """

    def __init__(self, reader: XmlReader, world: etree._Element):
        self._reader = reader
        self._element = world.find("state")
        self._is_used = not any(map(is_of_gazebo_sim, world.findall("plugin")))
        self._moved: list[str] = []
        self._again: list[Finding] = []
        self._poses: dict[str, RigidTransform] = {}
        for model in world.iterfind("state/model[pose]") if self._is_used else ():
            name = model.get("name", "")
            if name in self._poses:
                what = f"a second state of the model {name}: it replaces the first"
                self._again.append(Finding.at(Kind.WARNING, what, reader.place(model)))
            self._poses[name] = transform_of(model.findall("pose")[0], reader)

    def pose(self, name: str, own: "RigidTransform") -> "RigidTransform":
        """Return a model's pose in the world at the start, given its own."""
        if name not in self._poses:
            return own
        difference = own.inverse() @ self._poses[name]
        if max(*abs(difference.translation()), difference.rotation().ToAngleAxis().angle()) > _ELSEWHERE:
            self._moved.append(name)
        return self._poses[name]

    def findings(self) -> Iterator[Finding]:
        """Yield that the state is not used, who stands elsewhere by it, and who is in it twice."""
        if self._element is None:
            return
        yield from self._again
        place = self._reader.place(self._element)
        if not self._is_used:
            what = "<state> of the world, which Gazebo Sim does not read"
            yield Finding.at(Kind.IGNORED, what, place, cause=Cause.UNREAD)
            return
        for model in self._element.iterfind("model[link]"):
            if self._is_only_of_links(model):
                what = f"the poses of the links of {model.get('name', '')} in <state>: it starts where its own pose is"
                yield Finding.at(Kind.IGNORED, what, self._reader.place(model))
        if self._moved:
            who = first_of(self._moved, _MOST_NAMED)
            what = f"{who}: the start pose is that of <state>, as in Gazebo classic; Gazebo Sim does not read it"
            yield Finding.at(Kind.WARNING, what, place)

    @staticmethod
    def _is_only_of_links(model: etree._Element) -> bool:
        return model.find("pose") is None and model.find("link/pose") is not None
