"""The frames of a bag: a tree for each namespace that has its own ``tf`` topics."""

from typing import Any

from drake_twin.dataclass import dataclass
from drake_twin.messages.transform_tree import Transform, TransformTree
from drake_twin.playback.bag import TRANSFORMS, BagMessage


@dataclass(frozen=True)
class RecordedRobot:
    """A robot of a bag.

    Attributes:
        name: Its name on the page.
        namespace: The namespace of its description's topic, ``/robot_1``; empty for none.
        root_link: The link that no joint moves.
    """

    name: str
    namespace: str
    root_link: str


def is_frames(topic: str, kind: str) -> bool:
    """Tell whether a topic is one of transforms."""
    return kind == TRANSFORMS and topic.rpartition("/")[2] in ("tf", "tf_static")


class RecordedFrames:
    """The newest transforms of a bag."""

    def __init__(self) -> None:
        self._trees: dict[str, TransformTree] = {}

    def add(self, message: BagMessage) -> None:
        """Take a message of transforms.

        Raises:
            InputError: If it is damaged.
        """
        namespace, _, own = message.topic.rpartition("/")
        self._trees.setdefault(namespace, TransformTree()).add(message.read(), is_static=own == "tf_static")

    def copy(self) -> "RecordedFrames":
        """Return a copy."""
        copied = RecordedFrames()
        copied._trees = {namespace: tree.copy() for namespace, tree in self._trees.items()}
        return copied

    def in_root(self, robot: RecordedRobot) -> tuple[str, Transform] | None:
        """Return the frame at the root above a robot's root link, and the link's pose in it; None if it is not known.

        Raises:
            InputError: If the frames are a loop.
        """
        tree = self._trees.get(robot.namespace) or self._trees.get("")
        if tree is None:
            return None
        prefixes = ("", f"{robot.namespace.strip('/')}/", f"{robot.name}/")
        frame = next(
            (f"{prefix}{robot.root_link}" for prefix in prefixes if f"{prefix}{robot.root_link}" in tree.parents), None
        )
        return None if frame is None else tree.in_root(frame)

    def as_plain(self) -> list[dict[str, Any]]:
        """Return each frame with the one above it, its translation (m) and roll, pitch, yaw (rad) in that."""
        return [row for tree in self._trees.values() for row in tree.as_plain()]

    def in_top(self, frame: str) -> Transform | None:
        """Return the pose of a frame in the frame at the root above it; None if it is not known.

        Raises:
            InputError: If the frames are a loop.
        """
        tree = next((tree for tree in self._trees.values() if frame in tree.parents), None)
        found = None if tree is None else tree.in_root(frame)
        return None if found is None else found[1]
