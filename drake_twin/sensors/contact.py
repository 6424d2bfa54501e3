"""A contact sensor (a bumper) on a link."""

from collections import defaultdict
from collections.abc import Iterable, Iterator
from math import fsum

import numpy as np
from pydrake.common.value import AbstractValue
from pydrake.geometry import ContactSurface, GeometryId
from pydrake.multibody.plant import ContactResults
from pydrake.systems.framework import Context

from drake_twin import messages
from drake_twin.dataclass import dataclass
from drake_twin.description.fixed_joint_lumping import LUMP
from drake_twin.description.robot_description import Sensor
from drake_twin.description.sensor_element import SensorElement
from drake_twin.sensors.classic import classic_plugin, classic_topic
from drake_twin.sensors.collision_names import (
    collision_geometries,
    collision_names,
    static_geometries,
    static_shape_name,
)
from drake_twin.sensors.registry import sensor
from drake_twin.sensors.sensor_setup import SensorSetup
from drake_twin.sensors.sensor_system import SensorSystem, SensorTopic
from drake_twin.systems.no_message import set_value
from drake_twin.systems.plant_reading import contact_value

_STATIC = ("world", "static_world::static_world")  # frames of the shapes of static models
_COLLISION = 5  # ros_gz_interfaces/msg/Entity


@dataclass(frozen=True)
class ContactSettings:
    """What a contact sensor reads of its element.

    Attributes:
        collisions: The names of the collision shapes that it watches.
        topic: Its topic in Gazebo; empty for the default.
        is_classic: Whether Gazebo classic's plugin publishes it.
    """

    collisions: tuple[str, ...]
    topic: str
    is_classic: bool


@dataclass(frozen=True)
class Touch:
    """Where one of the sensor's shapes touches another, in the world.

    Attributes:
        own: The sensor's shape.
        other: The other shape.
        position: Where (m).
        normal: The direction of the force on the sensor's shape.
        depth: How deep the shapes are in each other (m).
        force: On the sensor's shape (N).
        torque: On the sensor's shape, about the position (N·m).
    """

    own: GeometryId
    other: GeometryId
    position: np.ndarray
    normal: np.ndarray
    depth: float
    force: np.ndarray
    torque: np.ndarray


@sensor("contact")
class ContactSensor(SensorSystem):
    """Report where some collision shapes of a link touch others, and with what force.

    Like gz-sim's Contact system (src/systems/contact/Contact.cc): at every step, and only while something touches. A
    plugin gazebo_ros_bumper publishes at the sensor's rate, also while nothing does (conversions/gazebo_msgs.hpp).
    Everything is in the world's axes; forces, torques and normals are those on ``collision1``, the sensor's own shape.
    A flat contact has one position, the centroid of the area that touches, with the whole force there.

    .. pydrake_system::

        name: ContactSensor
        input_ports:
        - contact_results
        output_ports:
        - message

    - ``contact_results``: the plant's port of this name.
    - ``message``: ``ros_gz_interfaces/msg/Contacts``, None without a contact; with Gazebo classic's plugin
      ``gazebo_msgs/msg/ContactsState``. Of the present time.
    """

    message_type = "ros_gz_interfaces/msg/Contacts"
    gz_topic = "contact"

    @classmethod
    def read(cls, element: SensorElement) -> ContactSettings:
        """Read the names of collision shapes, and the topic."""
        names = tuple(name for part in element.parts("contact/collision") if (name := part.text(".")))
        topic = element.text("contact/topic")
        is_classic = element.plugin_kind == "gazebo_ros_bumper"
        return ContactSettings(names, "" if topic == "__default_topic__" else topic, is_classic)

    @classmethod
    def problem(cls, settings: ContactSettings) -> str | None:
        """Return that it watches nothing."""
        return None if settings.collisions else "its <contact> names no <collision> of the link"

    @classmethod
    def topics(cls, sensor: Sensor, settings: ContactSettings, base: str) -> Iterable[SensorTopic]:
        """Return its topic: ``bumper_states`` of Gazebo classic's plugin."""
        plugin = classic_plugin(sensor, "gazebo_ros_bumper")
        if plugin is not None:
            name = classic_topic(plugin, "bumper_states")
            return (SensorTopic("message", "gazebo_msgs/msg/ContactsState", name, is_ros=True),)
        name = f"/{settings.topic.strip('/')}" if settings.topic else base
        return (SensorTopic("message", cls.message_type, name),)

    @classmethod
    def default_frame(cls, sensor: Sensor, settings: ContactSettings, scoped: str) -> str:
        """Return ``world`` for Gazebo classic's plugin; Gazebo's messages have no frame."""
        return "world" if settings.is_classic else ""

    @classmethod
    def rate(cls, sensor: Sensor, settings: ContactSettings) -> float:
        """Return the rate of Gazebo classic's sensor; Gazebo's publishes at every step."""
        return sensor.update_rate if settings.is_classic else 0.0

    def __init__(self, setup: SensorSetup):
        super().__init__(setup)
        assert setup.description is not None, "collision shapes have their names there"
        assert setup.scene_graph is not None, "shapes are there"
        self._inspector = setup.scene_graph.model_inspector()
        description, sensor, settings = setup.description, setup.sensor, setup.settings
        link = sensor.gazebo_link if sensor.gazebo_link in description.links else sensor.link
        names = collision_names(description, link)
        links = list(dict.fromkeys((sensor.link, *(own for own, _ in names))))
        if setup.anchors:
            shapes = static_geometries(description, links, self._inspector)
        else:
            shapes = collision_geometries(description, links, setup.plant, setup.instance, self._inspector)
        self._names, self._watched = {}, set()
        unknown = set(settings.collisions)
        for geometry, shape in shapes:
            name = names.get(shape, "")
            self._names[geometry] = f"{setup.owner}::{link}::{name}"
            found = {asked for asked in settings.collisions if asked in _spellings(name, shape[0])}
            unknown -= found
            if found:
                self._watched.add(geometry)
        if unknown:
            known = ", ".join(names.values()) or "none"
            texts = ", ".join(map(repr, sorted(unknown)))
            self.warnings = (f"the link has no collision shape {texts} in Gazebo (it has {known})",)
        self._contacts = self.declare_plant_input("contact_results", contact_value(setup.plant))
        self.declare_message_output(self._calc_state if settings.is_classic else self._calc_contacts)

    def touches(self, context: Context) -> dict[tuple[str, str], list[Touch]]:
        """Return where the shapes that it watches touch others: the names of its shape and of the other → where."""
        found = defaultdict(list)
        for touch in self._touches(self._contacts.Eval(context)):
            found[self._name(touch.own), self._name(touch.other)].append(touch)
        return dict(sorted(found.items()))

    def pairs(self, context: Context) -> set[tuple[str, str]]:
        """Return the names of the shapes that it watches and of those that they touch."""
        results: ContactResults = self._contacts.Eval(context)
        points = map(results.point_pair_contact_info, range(results.num_point_pair_contacts()))
        surfaces = map(results.hydroelastic_contact_info, range(results.num_hydroelastic_contacts()))
        touching = [(pair.id_A, pair.id_B) for pair in (point.point_pair() for point in points)]
        touching += [(each.id_M(), each.id_N()) for each in (surface.contact_surface() for surface in surfaces)]
        touching += [(other, own) for own, other in touching]
        return {(self._name(own), self._name(other)) for own, other in touching if own in self._watched}

    def _name(self, geometry: GeometryId) -> str:
        if geometry in self._names:
            return self._names[geometry]
        frame = self._inspector.GetName(self._inspector.GetFrameId(geometry))
        if frame in _STATIC:
            return static_shape_name(self._inspector, geometry).replace("/", "::")
        own = self._inspector.GetName(geometry).rpartition("::")[2].partition("|")[0]
        return f"{frame}::{own}"

    def _touches(self, results: ContactResults) -> Iterator[Touch]:
        for index in range(results.num_point_pair_contacts()):
            info = results.point_pair_contact_info(index)
            pair = info.point_pair()
            for own, other, sign in ((pair.id_A, pair.id_B, -1.0), (pair.id_B, pair.id_A, 1.0)):
                if own in self._watched:
                    normal = sign * -np.array(pair.nhat_BA_W)
                    force = sign * np.array(info.contact_force())
                    yield Touch(own, other, np.array(info.contact_point()), normal, pair.depth, force, np.zeros(3))
        for index in range(results.num_hydroelastic_contacts()):
            info = results.hydroelastic_contact_info(index)
            surface = info.contact_surface()
            for own, other, sign in ((surface.id_M(), surface.id_N(), 1.0), (surface.id_N(), surface.id_M(), -1.0)):
                if own in self._watched:
                    force = sign * np.array(info.F_Ac_W().translational())
                    torque = sign * np.array(info.F_Ac_W().rotational())
                    normal = sign * _normal(surface)
                    depth = _depth(surface, normal)
                    yield Touch(own, other, np.array(surface.centroid()), normal, depth, force, torque)

    def _calc_contacts(self, context: Context, output: AbstractValue) -> None:
        header = self.header(context)
        contacts = [
            {
                "collision1": {"name": own, "type": _COLLISION},
                "collision2": {"name": other, "type": _COLLISION},
                "positions": [_vector(touch.position) for touch in touches],
                "normals": [_vector(touch.normal) for touch in touches],
                "depths": [touch.depth for touch in touches],
                "wrenches": [
                    {
                        "header": header,
                        "body_1_wrench": _wrench(touch.force, touch.torque),
                        "body_2_wrench": _wrench(-touch.force, -touch.torque),
                    }
                    for touch in touches
                ],
            }
            for (own, other), touches in self.touches(context).items()
        ]
        message = messages.message(self.message_type, {"header": header, "contacts": contacts})
        set_value(output, message if contacts else None)

    def _calc_state(self, context: Context, output: AbstractValue) -> None:
        plain = [
            {
                "info": f"{own} touches {other}",
                "collision1_name": own,
                "collision2_name": other,
                "wrenches": [_wrench(touch.force, touch.torque) for touch in touches],
                "total_wrench": _wrench(
                    np.sum([touch.force for touch in touches], axis=0),
                    np.sum([touch.torque for touch in touches], axis=0),
                ),
                "contact_positions": [_vector(touch.position) for touch in touches],
                "contact_normals": [_vector(touch.normal) for touch in touches],
                "depths": [touch.depth for touch in touches],
            }
            for (own, other), touches in self.touches(context).items()
        ]
        kind = "gazebo_msgs/msg/ContactsState"
        output.set_value(messages.message(kind, {"header": self.header(context), "states": plain}))


def _spellings(name: str, link: str) -> set[str]:
    """Return how files name a collision shape: as Gazebo does, or without prefix, number or ``_collision``."""
    short = name.rpartition(LUMP)[2]
    plain = {each.rstrip("0123456789").removesuffix("_") for each in (name, short) if name.rpartition("_")[2].isdigit()}
    plain |= {name, short}
    return {*plain, *(each.removesuffix("_collision") for each in plain), f"{link}_collision"}


def _normal(surface: ContactSurface) -> np.ndarray:
    """Return the mean normal of a surface, out of N into M."""
    total = sum(surface.area(face) * np.array(surface.face_normal(face)) for face in range(surface.num_faces()))
    length = float(np.linalg.norm(total))
    return np.array(total) / length if length > 0.0 else np.zeros(3)


def _depth(surface: ContactSurface, normal: np.ndarray) -> float:
    """Return how deep two shapes are in each other (m): the pressure over its gradient, on both sides.

    Faces whose pressure rises along the surface, as at a rim, do not count.
    """
    field = surface.tri_e_MN() if surface.is_triangle() else surface.poly_e_MN()
    mesh = surface.tri_mesh_W() if surface.is_triangle() else surface.poly_mesh_W()
    deepest = 0.0
    for face in range(surface.num_faces()):
        gradients = [surface.EvaluateGradE_M_W(face)] if surface.HasGradE_M() else []
        gradients += [surface.EvaluateGradE_N_W(face)] if surface.HasGradE_N() else []
        rises = [abs(float(normal @ gradient)) for gradient in gradients]
        if any(2.0 * rise < np.linalg.norm(gradient) for rise, gradient in zip(rises, gradients, strict=True)):
            continue
        element = mesh.element(face)
        corners = range(3 if surface.is_triangle() else element.num_vertices())
        highest = max(field.EvaluateAtVertex(element.vertex(corner)) for corner in corners)
        deepest = max(deepest, fsum(highest / rise for rise in rises if rise > 0.0))
    return deepest


def _vector(values: np.ndarray) -> dict[str, float]:
    return dict(zip("xyz", values.tolist(), strict=True))


def _wrench(force: np.ndarray, torque: np.ndarray) -> dict[str, dict[str, float]]:
    return {"force": _vector(force), "torque": _vector(torque)}
