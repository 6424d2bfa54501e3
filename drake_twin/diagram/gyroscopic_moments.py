"""Moments that correct Drake's discrete steps for bodies that tumble freely.

A discrete step takes a body's gyroscopic moment ω × I ω from its start. That is Euler's explicit method, in which what
tumbles gains energy: a body of moments 1, 2 and 3 that turns about the middle axis at 20 rad/s a third of it in 10 s at
1 ms, and at 10 ms it ends the run. The moments here are what a step lacks of the series of Euler's equations up to its
third order: energy is kept within 1e-5 at 1 ms, and not gained at 10 ms. They vanish for a body at rest.

Drake's pose follows from the velocity at a step's end as if it were that of its middle. So the angular momentum that is
kept is that of a velocity half a step before the pose.

All systems are Drake's own: gyroscopes, an expression, and propellers without thrust. CENIC chooses its own steps, and
has no such correction.
"""

from collections.abc import Sequence

import numpy as np
from pydrake.math import RigidTransform, RotationMatrix
from pydrake.multibody.plant import MultibodyPlant, Propeller, PropellerInfo
from pydrake.multibody.tree import BodyIndex
from pydrake.symbolic import Expression, Variable
from pydrake.systems.framework import Context, Diagram, DiagramBuilder, OutputPort, System
from pydrake.systems.primitives import ConstantVectorSource, Multiplexer, SymbolicVectorSystem

from drake_twin.dataclass import dataclass
from drake_twin.errors import InputError
from drake_twin.systems.plant_reading import physics_step

# Moments of inertia are equal if they differ by less than this part.
_EQUAL = 1e-3

_NAME = "tumbling/moments"  # no robot has such a name


@dataclass(frozen=True)
class _LooseBody:
    """A body with unequal moments of inertia that nothing is jointed to.

    Attributes:
        name: The body's name, with its model's.
        index: The body.
        R_BP: The directions of its principal axes.
        moments: The principal moments of inertia about its center of mass (kg·m²).
    """

    name: str
    index: BodyIndex
    R_BP: RotationMatrix
    moments: np.ndarray


def add_gyroscopic_moments(builder: DiagramBuilder, plant: MultibodyPlant) -> OutputPort | None:
    """Add the moments of all loose bodies with unequal moments of inertia in a discrete plant.

    Args:
        builder: The root diagram's builder.
        plant: The finalized plant.

    Returns:
        The port with the moments as spatial forces; None if nothing needs them.
    """
    bodies = _loose_bodies(plant) if plant.time_step() > 0 else []
    if not bodies:
        return None
    system = builder.AddNamedSystem(_NAME, _moments_of(plant, bodies))
    for output in (plant.get_body_poses_output_port(), plant.get_body_spatial_velocities_output_port()):
        builder.Connect(output, system.GetInputPort(output.get_name()))
    moments: OutputPort = system.get_output_port()
    return moments


def bodies_that_gain_energy(plant: MultibodyPlant) -> list[str]:
    """Return the names of the bodies that gain energy where they tumble without these moments."""
    return [body.name for body in _loose_bodies(plant)] if plant.time_step() > 0 else []


def _moments_of(plant: MultibodyPlant, bodies: Sequence[_LooseBody]) -> Diagram:
    """Return a system that takes the plant's poses and velocities, and outputs the moments as spatial forces."""
    from pydrake.systems.sensors import Gyroscope

    builder, count = DiagramBuilder(), len(bodies)
    velocities = builder.AddNamedSystem("velocities", Multiplexer([3] * count + [count]))
    inertias = builder.AddNamedSystem("inertias", ConstantVectorSource(np.ones(count)))
    builder.Connect(inertias.get_output_port(), velocities.get_input_port(count))
    propellers = builder.AddNamedSystem("propellers", Propeller(_propellers(bodies)))
    poses = builder.ExportInput(propellers.get_body_poses_input_port(), plant.get_body_poses_output_port().get_name())
    speeds = None
    for number, body in enumerate(bodies):
        X_BP = RigidTransform(body.R_BP, np.zeros(3))
        gyroscope = builder.AddNamedSystem(f"gyroscope_{number}", Gyroscope(plant.get_body(body.index), X_BP))
        builder.ConnectInput(poses, gyroscope.get_body_poses_input_port())
        if speeds is None:
            name = plant.get_body_spatial_velocities_output_port().get_name()
            speeds = builder.ExportInput(gyroscope.get_body_velocities_input_port(), name)
        else:
            builder.ConnectInput(speeds, gyroscope.get_body_velocities_input_port())
        builder.Connect(gyroscope.get_measurement_output_port(), velocities.get_input_port(number))
    w = np.array([Variable(f"w{index}") for index in range(3 * count)])
    scales = np.array([Variable(f"inertia{index}") for index in range(count)])
    expressions = [
        scale * moment
        for body, own, scale in zip(bodies, np.split(w, count), scales, strict=True)
        for moment in _missing_moments(own, body.moments, physics_step(plant))
    ]
    moments = builder.AddNamedSystem("moments", SymbolicVectorSystem(input=[*w, *scales], output=expressions))
    builder.Connect(velocities.get_output_port(), moments.get_input_port())
    builder.Connect(moments.get_output_port(), propellers.get_command_input_port())
    builder.ExportOutput(propellers.get_spatial_forces_output_port(), "spatial_forces")
    return builder.Build()


def follow_inertias(diagram: Diagram, plant: MultibodyPlant, root: Context) -> None:
    """Let the moments follow inertias that differ from those as built.

    A multiple of the inertia as built has a multiple of the moments; another inertia has none.

    Args:
        diagram: The root diagram.
        plant: Its plant.
        root: The diagram's context; it is changed.
    """
    source, now = _system(diagram, "inertias"), plant.GetMyContextFromRoot(root)
    if source is None:
        return
    as_built, scales = plant.CreateDefaultContext(), []
    for body in _loose_bodies(plant):
        present, built = (_central_inertia(plant, context, body.index) for context in (now, as_built))
        size, scale = np.trace(present), np.trace(present) / np.trace(built)
        scales.append(scale if np.allclose(present, scale * built, rtol=0.0, atol=_EQUAL * size) else 0.0)
    source.get_mutable_source_value(source.GetMyMutableContextFromRoot(root)).SetFromVector(scales)


def _system(diagram: Diagram, name: str) -> System | None:
    """Return one of the systems that make the moments; None if nothing needs them."""
    if not diagram.HasSubsystemNamed(_NAME):
        return None
    moments = diagram.GetSubsystemByName(_NAME)
    assert isinstance(moments, Diagram)
    return moments.GetSubsystemByName(name)


def _loose_bodies(plant: MultibodyPlant) -> list[_LooseBody]:
    found, context = [], plant.CreateDefaultContext()
    joints = {joint.child_body().index(): joint.index() for joint in map(plant.get_joint, plant.GetJointIndices())}
    for body in map(plant.get_body, plant.GetFloatingBaseBodies()):
        welded = plant.GetBodiesWeldedTo(body)
        moving = plant.GetBodiesKinematicallyAffectedBy([joints[body.index()]])
        if len(moving) > len(welded) or not any(item.default_mass() > 0 for item in welded):
            continue
        inertia = _central_inertia(plant, context, body.index())
        if not np.isfinite(inertia).all():
            name = body.scoped_name().get_full()
            raise InputError(f"the inertia of {name} is not finite: a pose or a mass of it is too large")
        moments, axes = np.linalg.eigh(inertia)
        if moments[0] <= 0.0 or moments[2] - moments[0] <= _EQUAL * moments[2]:
            continue
        axes[:, 2] = np.cross(axes[:, 0], axes[:, 1])
        found.append(_LooseBody(body.scoped_name().get_full(), body.index(), RotationMatrix(axes), moments))
    return found


def _central_inertia(plant: MultibodyPlant, context: Context, body: BodyIndex) -> np.ndarray:
    """Return the inertia of a body and what is welded to it, about their center of mass in the body's axes (kg·m²)."""
    welded = [item.index() for item in plant.GetBodiesWeldedTo(plant.get_body(body))]
    inertia = plant.CalcSpatialInertia(context, plant.get_body(body).body_frame(), welded)
    matrix: np.ndarray = inertia.Shift(inertia.get_com()).CalcRotationalInertia().CopyToFullMatrix3()
    return matrix


def _missing_moments(w: np.ndarray, moments: np.ndarray, h: float) -> list[Expression]:
    """Return the moments about the principal axes that a step of Euler's explicit method lacks (N·m).

    With a₁ = (I₂ − I₃) / I₁ and so on, Euler's equations are ω₁' = a₁ ω₂ ω₃, so that

        ω₁'' = ω₁ (a₁a₃ω₂² + a₁a₂ω₃²),  ω₁''' = a₁ ω₂ ω₃ (4 a₂a₃ω₁² + a₁a₃ω₂² + a₁a₂ω₃²).

    Args:
        w: The angular velocity in the principal axes (rad/s).
        moments: The principal moments of inertia (kg·m²).
        h: The step (s).
    """
    a = [(moments[(k + 1) % 3] - moments[(k + 2) % 3]) / moments[k] for k in range(3)]
    squares = [a[(k + 1) % 3] * a[(k + 2) % 3] * w[k] * w[k] for k in range(3)]
    found = []
    for k in range(3):
        i, j = (k + 1) % 3, (k + 2) % 3
        second = w[k] * (squares[i] + squares[j])
        third = a[k] * w[i] * w[j] * (4 * squares[k] + squares[i] + squares[j])
        # Expanded, it is evaluated in half of the time.
        found.append((float(moments[k]) * (h / 2 * second + h * h / 6 * third)).Expand())
    return found


def _propellers(bodies: Sequence[_LooseBody]) -> list[PropellerInfo]:
    """Return a propeller without thrust about each principal axis."""
    return [
        PropellerInfo(
            body_index=body.index,
            X_BP=RigidTransform(RotationMatrix.MakeFromOneVector(axis, 2), np.zeros(3)),
            thrust_ratio=0.0,
            moment_ratio=1.0,
        )
        for body in bodies
        for axis in body.R_BP.matrix().T
    ]
