"""Folders of the scene that move with bodies of the plant."""

from pydrake.math import RigidTransform
from pydrake.multibody.tree import BodyIndex

from drake_twin.cockpit.scene import Scene
from drake_twin.twin.twin import Twin


class BodyFolders:
    """Folders of the scene that move with bodies of the plant.

    A browser moves ``PATH/on/MODEL/BODY`` with what it draws of that body, so that no pose is sent for it. A body of
    which nothing is drawn has its place in the folder of one that is welded to it. Without such a body, poses are sent.

    Args:
        scene: The page's scene.
        twin: The twin whose plant has the bodies.
        path: The path in the scene below which the folders are.
    """

    def __init__(self, scene: Scene, twin: Twin, path: str):
        self._scene, self._twin, self._path = scene, twin, path
        self._drawn = scene.shared(twin).body_paths
        self._sent: dict[int, RigidTransform | None] = {}  # body → its last pose

    def of(self, body: BodyIndex) -> tuple[str, RigidTransform]:
        """Return the folder F that moves with a body B, and the pose X_FB of the body in it."""
        if (path := self._drawn.get(int(body))) is not None:
            return f"{self._path}/on/{path}", RigidTransform()
        plant = self._twin.plant
        for other in plant.GetBodiesWeldedTo(plant.get_body(body)):
            if (path := self._drawn.get(int(other.index()))) is not None:
                return f"{self._path}/on/{path}", self._pose(other.index()).inverse() @ self._pose(body)
        self._sent.setdefault(int(body), None)
        return f"{self._path}/{int(body)}", RigidTransform()

    def draw(self) -> None:
        """Send the poses of those bodies that no browser can know."""
        for body, last in self._sent.items():
            pose = self._pose(BodyIndex(body))
            if last is None or not pose.IsExactlyEqualTo(last):
                self._sent[body] = pose
                self._scene.set_transform(f"{self._path}/{body}", pose)

    def remove(self) -> None:
        """Remove the folders and what is in them."""
        self._scene.delete(self._path)

    def _pose(self, body: BodyIndex) -> RigidTransform:
        plant = self._twin.plant
        return plant.EvalBodyPoseInWorld(plant.GetMyContextFromRoot(self._twin.context), plant.get_body(body))
