"""The poses of a world's models, which may be relative to each other and to ``<frame>``s."""

from typing import TYPE_CHECKING

from lxml import etree

from drake_twin.description.sdf_pose import transform_of
from drake_twin.description.xml_reader import XmlReader

if TYPE_CHECKING:
    from pydrake.math import RigidTransform


class WorldFrames:
    """The frames of one world.

    Args:
        reader: The world's document.
        world: Its ``<world>``.
        models: Each model, with its ``<pose>`` and the document that it is in.
    """

    def __init__(
        self,
        reader: XmlReader,
        world: etree._Element,
        models: list[tuple[etree._Element, etree._Element | None, XmlReader]],
    ):
        self._reader = reader
        self._poses = {model.get("name", ""): pose for model, pose, _ in models}
        self._readers = {model.get("name", ""): own for model, _, own in models}
        self._attached: dict[str, str] = {}
        for frame in world.findall("frame"):
            self._poses[frame.get("name", "")] = frame.find("pose")
            self._attached[frame.get("name", "")] = frame.get("attached_to", "")

    def pose(self, model: etree._Element, pose: etree._Element | None, seen: tuple[str, ...] = ()) -> "RigidTransform":
        """Compute a model's pose in the world.

        Args:
            model: The model, or a frame of the world.
            pose: Its ``<pose>``.
            seen: The frames whose poses depend on it.

        Raises:
            InputError: If the frame that it is relative to does not exist, or is relative to it.
        """
        from pydrake.math import RigidTransform

        name = model.get("name", "")
        X = RigidTransform() if pose is None else transform_of(pose, self._reader_of(pose, name))
        to = "" if pose is None else pose.get("relative_to", "")
        to = to or self._attached.get(name, "")
        to = to.partition("::")[0]  # a frame inside a model: the model stands for it
        if to in ("", "world", "__root__"):
            return X
        if to in (*seen, name):
            raise self._reader.error(model, f"its pose is relative to {to!r}, which is relative to it")
        if to not in self._poses:
            what = f"its pose is relative to {to!r}, which does not exist"
            raise self._reader.error(model, what, valid=sorted({*self._poses} - {name}), value=to)
        above = etree.Element("frame", name=to)
        return self.pose(above, self._poses[to], (*seen, name)) @ X

    def _reader_of(self, pose: etree._Element, name: str) -> XmlReader:
        """Return the document of a model's pose: the world's, or that of the file that it includes."""
        in_world = pose.getroottree().getroot() is self._reader.root
        return self._reader if in_world else self._readers.get(name, self._reader)
