"""A user's changes of a plant's context besides its state: masses, dampings, motors, frames, friction."""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from copy import copy
from typing import Any, NamedTuple

import numpy as np
from pydrake.geometry import (
    GeometryId,
    GeometryVersion,
    ProximityProperties,
    Role,
    RoleAssign,
    SceneGraph,
    SceneGraphInspector,
)
from pydrake.math import RigidTransform
from pydrake.multibody.plant import CoulombFriction, MultibodyPlant
from pydrake.multibody.tree import (
    FixedOffsetFrame,
    Joint,
    JointActuator,
    ModelInstanceIndex,
    RigidBody,
    SpatialInertia,
    UnitInertia,
)
from pydrake.systems.framework import Context

from drake_twin.twin.plain_data import from_plain, to_plain

# The numeric properties of a shape, with Drake's names.
_MATERIAL = (
    ("material", "coulomb_friction"),
    ("material", "hunt_crossley_dissipation"),
    ("material", "point_contact_stiffness"),
    ("material", "relaxation_time"),
    ("hydroelastic", "hydroelastic_modulus"),
    ("hydroelastic", "resolution_hint"),
    ("hydroelastic", "slab_thickness"),
    ("hydroelastic", "margin"),
)

_Read = Callable[[Context], Sequence[float]]
_Write = Callable[[Context, Sequence[float]], None]


class _Parameter(NamedTuple):
    """One parameter, with a name that is the same in any diagram with the robot."""

    name: str
    read: _Read
    write: _Write


class PlantParameters:
    """The parameters of one plant and its shapes.

    Args:
        plant: The plant.
        scene_graph: The scene graph with its shapes.
        root: The diagram's context as built, because the model's own properties lack the scene graph's defaults.
    """

    def __init__(self, plant: MultibodyPlant, scene_graph: SceneGraph, root: Context):
        self._plant, self._scene_graph = plant, scene_graph
        self._default: Context | None = None
        moving = (plant.get_joint(index) for index in plant.GetJointIndices())
        self._joints = [joint for joint in moving if joint.num_velocities() > 0]
        self._numbers = _numbers(plant.GetMyContextFromRoot(root), self._joints)
        inspector = self._inspector(root)
        self._shapes = list(self._named_shapes(inspector))
        self._materials = {geometry: _materials(inspector, geometry) for _, geometry in self._shapes}
        # Which properties have changed, as of a version of the geometry: to read them all takes longer than the rest.
        self._changed_materials: tuple[GeometryVersion, dict[str, list[Any]]] = copy(inspector.geometry_version()), {}

    def changed(self, root: Context) -> dict[str, list[Any]]:
        """Return the name and value of each parameter that has changed since the build, as plain data.

        Args:
            root: The diagram's context.
        """
        now = self._plant.GetMyContextFromRoot(root)
        found: dict[str, list[Any]] = {}
        if _numbers(now, self._joints) != self._numbers:
            before = self._as_built()
            for parameter in self._parameters():
                values = list(map(float, parameter.read(now)))
                if not np.array_equal(values, parameter.read(before), equal_nan=True):
                    found[parameter.name] = [to_plain(value) for value in values]
        return found | self._materials_changed(self._inspector(root))

    def _materials_changed(self, inspector: SceneGraphInspector) -> dict[str, list[Any]]:
        version = copy(inspector.geometry_version())  # its own changes with the shapes
        if version.IsSameAs(self._changed_materials[0], Role.kProximity):
            return self._changed_materials[1]
        found: dict[str, list[Any]] = {}
        for name, geometry in self._shapes:
            now_there, built = _materials(inspector, geometry), self._materials[geometry]
            for key, values in () if now_there == built else now_there.items():
                if values != built.get(key):
                    found[f"{name} {key}"] = [to_plain(value) for value in values]
        self._changed_materials = version, found
        return found

    def put(self, root: Context, given: Mapping[str, Sequence[Any]], *, leave_out_unknown: bool = False) -> bool:
        """Set parameters, and all others to their values as built.

        Args:
            root: The diagram's context.
            given: The result of `changed`, for this diagram or another one.
            leave_out_unknown: Whether to skip the parameters of unknown robots.

        Returns:
            Whether a parameter was set.

        Raises:
            ValueError: If a parameter is unknown, or a value is invalid.
        """
        wanted = {name: [float(from_plain(value)) for value in values] for name, values in given.items()}
        if not np.isfinite([value for values in wanted.values() for value in values]).all():
            raise ValueError("parameters of the plant are not finite")
        present = self.changed(root)
        if not wanted and not present:
            return False
        now, before = self._plant.GetMyMutableContextFromRoot(root), self._as_built()
        for parameter in self._parameters():
            if parameter.name in wanted:
                parameter.write(now, wanted.pop(parameter.name))
            elif parameter.name in present:
                parameter.write(now, parameter.read(before))
        for name, geometry in self._shapes:
            keys = list(self._materials[geometry])
            own = {key: wanted.pop(f"{name} {key}") for key in keys if f"{name} {key}" in wanted}
            if own or any(f"{name} {key}" in present for key in keys):
                self._assign(root, geometry, own)
        if wanted and not leave_out_unknown:
            raise ValueError(f"the plant does not have the parameters {', '.join(wanted)}")
        return True

    def _assign(self, root: Context, geometry: GeometryId, values: dict[str, list[float]]) -> None:
        properties = ProximityProperties(self._scene_graph.model_inspector().GetProximityProperties(geometry))
        for key, numbers in (self._materials[geometry] | values).items():
            properties.UpdateProperty(*key.split("/"), CoulombFriction(*numbers) if len(numbers) == 2 else numbers[0])
        self._scene_graph.AssignRole(
            self._scene_graph.GetMyMutableContextFromRoot(root),
            self._plant.get_source_id(),
            geometry,
            properties,
            RoleAssign.kReplace,
        )

    def _inspector(self, root: Context) -> SceneGraphInspector:
        context = self._scene_graph.GetMyContextFromRoot(root)
        return self._scene_graph.get_query_output_port().Eval(context).inspector()

    def _as_built(self) -> Context:
        """Return the plant's context as built; it is made on the first call."""
        if self._default is None:
            self._default = self._plant.CreateDefaultContext()
        return self._default

    def _named_shapes(self, inspector: SceneGraphInspector) -> Iterator[tuple[str, GeometryId]]:
        for geometry in inspector.GetAllGeometryIds(Role.kProximity):
            body = self._plant.GetBodyFromFrameId(inspector.GetFrameId(geometry))
            if body is not None:
                model = self._plant.GetModelInstanceName(body.model_instance())
                yield f"shape {model}::{body.name()} {inspector.GetName(geometry)}", geometry

    def _parameters(self) -> Iterator[_Parameter]:
        plant = self._plant
        for instance in map(ModelInstanceIndex, range(1, plant.num_model_instances())):  # the world has none
            model = plant.GetModelInstanceName(instance)
            for body in map(plant.get_body, plant.GetBodyIndices(instance)):
                yield _Parameter(f"inertia of {model}::{body.name()}", *_inertia(body))
            for joint in map(plant.get_joint, plant.GetJointIndices(instance)):
                if joint.num_velocities() > 0:
                    name = f"{model}::{joint.name()}"
                    yield _Parameter(f"damping of {name}", joint.GetDampingVector, joint.SetDampingVector)
                    yield _Parameter(f"lock of {name}", *_lock(joint))
            for motor in map(plant.get_joint_actuator, plant.GetJointActuatorIndices(instance)):
                yield _Parameter(f"motor {model}::{motor.name()}", *_motor(motor))
            for frame in map(plant.get_frame, plant.GetFrameIndices(instance)):
                if isinstance(frame, FixedOffsetFrame):
                    yield _Parameter(f"frame {model}::{frame.name()}", *_pose(frame))


def _numbers(context: Context, joints: Iterable[Joint]) -> list[bytes | bool]:
    """Return all numeric parameters of a plant, and which joints are locked, for comparison."""
    groups = range(context.num_numeric_parameter_groups())
    numbers = [context.get_numeric_parameter(index).value().tobytes() for index in groups]
    return [*numbers, *(joint.is_locked(context) for joint in joints)]


def _lock(joint: Joint) -> tuple[_Read, _Write]:
    """Read and write 1 for a locked joint, 0 for another one."""

    def write(context: Context, values: Sequence[float]) -> None:
        joint.Lock(context) if values[0] else joint.Unlock(context)

    return lambda context: [float(joint.is_locked(context))], write


def _inertia(body: RigidBody) -> tuple[_Read, _Write]:
    """Read and write mass, center of mass (m), and the unit inertia's moments and products (m²) about the body's
    origin.
    """

    def read(context: Context) -> list[float]:
        inertia = body.CalcSpatialInertiaInBodyFrame(context)
        unit = inertia.get_unit_inertia()
        return [inertia.get_mass(), *inertia.get_com(), *unit.get_moments(), *unit.get_products()]

    def write(context: Context, values: Sequence[float]) -> None:
        mass, x, y, z, *unit = values
        inertia = SpatialInertia(mass, np.array([x, y, z]), UnitInertia(*unit))
        body.SetSpatialInertiaInBodyFrame(context, inertia)

    return read, write


def _motor(motor: JointActuator) -> tuple[_Read, _Write]:
    """Read and write rotor inertia (kg m²) and gear ratio."""

    def write(context: Context, values: Sequence[float]) -> None:
        rotor_inertia, gear_ratio = values
        motor.SetRotorInertia(context, rotor_inertia)
        motor.SetGearRatio(context, gear_ratio)

    return lambda context: [motor.rotor_inertia(context), motor.gear_ratio(context)], write


def _pose(frame: FixedOffsetFrame) -> tuple[_Read, _Write]:
    """Read and write the pose in the parent frame: a 3×4 matrix, row by row."""

    def write(context: Context, values: Sequence[float]) -> None:
        frame.SetPoseInParentFrame(context, RigidTransform(np.array(values).reshape(3, 4)))

    return lambda context: frame.GetPoseInParentFrame(context).GetAsMatrix34().ravel().tolist(), write


def _materials(inspector: SceneGraphInspector, geometry: GeometryId) -> dict[str, list[float]]:
    """Return the numeric properties of a shape: ``material/coulomb_friction`` → static, dynamic."""
    properties, found = inspector.GetProximityProperties(geometry), {}
    for group, name in _MATERIAL:
        if properties.HasProperty(group, name):
            value = properties.GetProperty(group, name)
            is_friction = isinstance(value, CoulombFriction)
            found[f"{group}/{name}"] = [value.static_friction(), value.dynamic_friction()] if is_friction else [value]
    return found
