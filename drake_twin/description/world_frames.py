"""The poses of a world's models, which may be relative to each other and to ``<frame>``s."""

from collections.abc import Iterator
from typing import TYPE_CHECKING

from lxml import etree

from drake_twin.description.frame_in_model import frame_in_model
from drake_twin.description.sdf_pose import transform_of
from drake_twin.description.xml_reader import XmlReader
from drake_twin.errors import InputError

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
        self._models = {model.get("name", ""): model for model, _, _ in models}
        self._poses = {model.get("name", ""): pose for model, pose, _ in models}
        self._readers = {model.get("name", ""): own for model, _, own in models}
        self._attached: dict[str, str] = {}
        self._frames = {frame.get("name", ""): frame for frame in world.findall("frame")}
        for name, frame in self._frames.items():
            self._poses[name] = frame.find("pose")
            self._attached[name] = frame.get("attached_to", "")

    def pose(self, model: etree._Element, pose: etree._Element | None) -> "RigidTransform":
        """Compute the pose of a model's frame in the world.

        Args:
            model: The model.
            pose: Its ``<pose>``: that of its placement frame, if it has one.

        Raises:
            InputError: If a frame that it depends on does not exist, or is relative to it.
        """
        X_WP = self._pose(model, pose)
        placed = model.get("placement_frame", "")
        return X_WP @ self._frame_in(model, placed, model).inverse() if placed else X_WP

    def unplaced(self) -> Iterator[InputError]:
        """Yield why frames of the world have no pose; of those that are relative to each other the first one."""
        told: set[str] = set()
        for name, frame in self._frames.items():
            try:
                self._pose(frame, frame.find("pose"))
            except InputError as error:
                if not told & {name, self._relative_to(name)}:
                    yield error
                told.add(name)

    def _relative_to(self, name: str) -> str:
        pose = self._poses.get(name)
        own = "" if pose is None else pose.get("relative_to", "")
        return own or self._attached.get(name, "")

    def _pose(self, model: etree._Element, pose: etree._Element | None, seen: tuple[str, ...] = ()) -> "RigidTransform":
        """Compute what a ``<pose>`` says of a model or a frame of the world.

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
        to, _, inside = (to or self._attached.get(name, "")).partition("::")
        if to in ("", "world", "__root__"):
            return X
        if to in (*seen, name):
            raise self._reader.error(model, f"its pose is relative to {to!r}, which is relative to it")
        if to not in self._poses:
            what = f"its pose is relative to {to!r}, which does not exist"
            raise self._reader.error(model, what, valid=sorted({*self._poses} - {name}), value=to)
        above = self._frames[to] if to in self._frames else self._models[to]
        X_WF = self._pose(above, self._poses[to], (*seen, name))
        placed = above.get("placement_frame", "")
        if placed:
            X_WF = X_WF @ self._frame_in(above, placed, model).inverse()
        return X_WF @ (self._frame_in(above, inside, model) if inside else RigidTransform()) @ X

    def _frame_in(self, model: etree._Element, frame: str, asking: etree._Element) -> "RigidTransform":
        """Return the pose of a frame in the model that has it; ``INNER::FRAME`` for one of a model inside that."""
        X_MF = frame_in_model(model, frame)
        if X_MF is None:
            what = f"its pose depends on the frame {frame!r} of {model.get('name', '')!r}, which does not exist"
            raise self._reader.error(asking, what, value=frame)
        return X_MF

    def _reader_of(self, pose: etree._Element, name: str) -> XmlReader:
        """Return the document of a model's pose: the world's, or that of the file that it includes."""
        in_world = pose.getroottree().getroot() is self._reader.root
        return self._reader if in_world else self._readers.get(name, self._reader)
