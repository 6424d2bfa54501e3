"""An arrow for each contact force."""

from collections.abc import Iterator

import numpy as np
from pydrake.geometry import Cylinder, MeshcatCone, Rgba

from drake_twin.cockpit.overlay import overlay
from drake_twin.cockpit.overlays.arrows import arrow_poses
from drake_twin.cockpit.scene import OVERLAYS, Scene
from drake_twin.diagram.joint_friction import is_brake
from drake_twin.shared_viewer.meshcat_protocol import TransformWriter
from drake_twin.twin.twin import Twin

_PATH = f"{OVERLAYS}/contacts"
_NEWTONS_PER_METER = 100.0  # the arrow of a rover's wheel that carries 20 N is 0.2 m long
_LEAST = 0.05  # N; smaller forces are not drawn
_RADIUS = 0.006  # m
_HEAD = 0.02  # m
_COLOR = Rgba(0.80, 0.20, 0.20)


@overlay("contacts", "Contact forces", "The force on what moves, 1 m for 100 N", "C")
class ContactForces:
    """The contact force on the body that moves, or on the second body when both move.

    Contacts that model the friction of a joint are left out.
    """

    def __init__(self, scene: Scene, twin: Twin):
        self._scene = scene
        self._twin = twin
        self._made = 0
        self._shown = 0
        self._paths = TransformWriter(())

    def draw(self) -> None:
        """Draw the present forces; unused arrows are hidden and reused later."""
        found = list(_forces(self._twin))
        count = len(found)
        for number in range(self._made + 1, count + 1):
            self._scene.set_object(f"{_PATH}/{number}/shaft", Cylinder(_RADIUS, 1.0), _COLOR)
            self._scene.set_object(f"{_PATH}/{number}/head", MeshcatCone(_HEAD, 2 * _RADIUS, 2 * _RADIUS), _COLOR)
        for number in range(min(count, self._shown) + 1, max(count, self._shown) + 1):
            self._scene.set_property(f"{_PATH}/{number}", "visible", number <= count)
        if count != self._shown:
            arrows = [f"{_PATH}/{number}" for number in range(1, count + 1)]
            self._paths = TransformWriter([f"{arrow}{part}" for part in ("", "/shaft", "/head") for arrow in arrows])
        self._made, self._shown = max(count, self._made), count
        if found:
            points, forces = (np.array(each) for each in zip(*found, strict=True))
            self._scene.move(self._paths, arrow_poses(points, forces / _NEWTONS_PER_METER, _HEAD))

    def remove(self) -> None:
        """Remove the arrows."""
        self._scene.delete(_PATH)
        self._made = self._shown = 0


def _forces(twin: Twin) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """Yield each contact's point (m, in the world) and force (N)."""
    results = twin.graph.evaluate(twin.built.ports.contact_results())
    inspector = twin.diagram.GetSubsystemByName("scene_graph").model_inspector()
    world = twin.plant.world_body().index()
    for index in range(results.num_point_pair_contacts()):
        point = results.point_pair_contact_info(index)
        force = -point.contact_force() if point.bodyB_index() == world else point.contact_force()
        if not is_brake(inspector, point.point_pair().id_A) and np.linalg.norm(force) > _LEAST:
            yield point.contact_point(), force
    for index in range(results.num_hydroelastic_contacts()):
        face = results.hydroelastic_contact_info(index)
        surface, force_on_M = face.contact_surface(), face.F_Ac_W().translational()
        is_on_world = inspector.GetFrameId(surface.id_M()) == inspector.world_frame_id()
        if np.linalg.norm(force_on_M) > _LEAST:
            yield surface.centroid(), -force_on_M if is_on_world else force_on_M
