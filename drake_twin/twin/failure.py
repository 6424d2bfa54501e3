"""The report of a failed step of the physics: the last good time, and the joint and robot that caused it."""

import contextlib
import re
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import Joint, ModelInstanceIndex, PrismaticJoint
from pydrake.systems.framework import Context

from drake_twin.controllers.stateful_controller import Sample
from drake_twin.dataclass import dataclass
from drake_twin.description.planar_joints import ANGULAR_Z, LINEAR_X, LINEAR_Y, LINEAR_Z
from drake_twin.diagram.twin_diagram import TwinDiagram
from drake_twin.errors import RunError, described
from drake_twin.findings import first_of
from drake_twin.twin.late_measurements import Past

if TYPE_CHECKING:
    from drake_twin.islands.archipelago import Memory

ABSURD = 1e12  # rad, m, rad/s or m/s
_MOST_NAMED = 3  # joints named in a message
_NOTABLE = 100.0  # rad/s² or m/s²: smaller accelerations do not make a step fail
_OF_THE_BASE = (LINEAR_X, LINEAR_Y, LINEAR_Z, ANGULAR_Z)


class Moment(NamedTuple):  # made before each advance, in a third of the time that a dataclass takes
    """The content of a diagram's context between two steps, to return to after a failed step.

    Attributes:
        time: The time (s).
        state: The plant's ``[q; v]``.
        samples: The sample of each stateful controller, in the order of their contexts; None if no step changes it.
        past: The past of each measurement delay.
        islands: What the islands remember; None without islands.
    """

    time: float
    state: np.ndarray
    samples: list[Sample | None]
    past: Past
    islands: "Memory | None" = None


@dataclass(frozen=True)
class _Mover:
    """A joint that moves, or a free body.

    Attributes:
        owner: ``robot 'arm'``, or ``model 'crate' of the world``.
        label: ``joint elbow``, or ``the base``; empty for a free body of the world.
        speed: Its speed in the last good state (rad/s or m/s).
        acceleration: Its acceleration (rad/s² or m/s²).
        unit: The unit of the speed.
        is_possible: Whether its present position and velocity are possible.
    """

    owner: str
    label: str
    speed: float
    acceleration: float
    unit: str
    is_possible: bool


def failure(
    built: TwinDiagram,
    plant_context: Context,
    time: float,
    error: BaseException,
    good: Moment | None = None,
    before: Moment | None = None,
) -> RunError:
    """Convert what Drake raises in a step, or in the solution for a sensor's output, to an error for the user.

    Args:
        built: The diagram.
        plant_context: Its plant's context, as the failure has left it.
        time: The last good time (s).
        error: The exception: a RuntimeError or a SystemExit of Drake's checks, or any other one of a user's system.
        good: The moment of the last good time; by default the content of the context.
        before: An earlier moment.
    """
    now = built.plant.GetPositionsAndVelocities(plant_context)
    last = now if good is None else good.state
    accelerations = _accelerations(built.plant, plant_context, good, before)
    movers = list(_movers(built, now if is_possible(last) else last, last, accelerations))
    movers.sort(key=lambda mover: -mover.acceleration)
    text = f"the simulation failed after {time:.9g} s: "
    lost = [mover for mover in movers if not mover.is_possible]
    if lost:
        return RunError(text + _lost(lost, is_possible(last)))
    said = str(error) if isinstance(error, RuntimeError | SystemExit) else described(error)
    reason = " ".join(said.split()).rstrip(".")
    return RunError(text + reason + _suspect(movers, _named_in(reason, built)))


def is_possible(state: np.ndarray) -> bool:
    """Return whether a state has only finite numbers that are not absurdly large."""
    return bool(np.logical_and.reduce(np.abs(state) < ABSURD))  # false for NaN


def _lost(lost: Sequence[_Mover], was_good: bool) -> str:
    """Return the sentence on the joints without a possible state, of the owner with the largest acceleration."""
    worst = lost[0]
    labels = [mover.label for mover in lost if mover.owner == worst.owner]
    who = f"{first_of(labels, _MOST_NAMED)} of {worst.owner}" if worst.label else worst.owner
    speed = f" (before, {worst.label or 'it'} moved at {worst.speed:.2g} {worst.unit})" if was_good else ""
    return (
        f"{who} {'is' if len(labels) == 1 else 'are'} no longer at a finite position or speed{speed}."
        " Possible causes: masses, inertias, gains or forces that differ by many orders of magnitude, or a time step"
        " that is too long"
    )


def _suspect(movers: Sequence[_Mover], named: set[str]) -> str:
    """Return the sentence on the likely cause of what Drake raises; empty if unknown."""
    movers = [mover for mover in movers if not named or mover.owner in named]
    if movers and movers[0].acceleration > _NOTABLE:
        worst = movers[0]
        who = f"{worst.label} of {worst.owner}" if worst.label else worst.owner
        return f". Just before, {who} accelerated most, at {worst.acceleration:.2g} {worst.unit}²"
    return f". That is in {named.pop()}" if len(named) == 1 else ""


def _accelerations(
    plant: MultibodyPlant, plant_context: Context, good: Moment | None, before: Moment | None
) -> np.ndarray:
    """Return the accelerations before a failure: from the last moments, or those of a continuous plant."""
    moments = [moment for moment in (before, good) if moment is not None]
    times = [*(moment.time for moment in moments), plant_context.get_time()]
    states = [*(moment.state for moment in moments), plant.GetPositionsAndVelocities(plant_context)]
    for change, duration in reversed(list(zip(np.diff(states, axis=0), np.diff(times), strict=True))):
        if duration > 0 and np.isfinite(change).all():
            return np.asarray(change[plant.num_positions() :] / duration)
    found = np.zeros(plant.num_velocities())
    if plant.time_step() == 0:  # a discrete plant would solve the failing step
        with contextlib.suppress(RuntimeError, SystemExit):
            found = plant.get_generalized_acceleration_output_port().Eval(plant_context)
    return found if np.isfinite(found).all() else np.zeros(plant.num_velocities())


def _movers(built: TwinDiagram, now: np.ndarray, last: np.ndarray, accelerations: np.ndarray) -> Iterator[_Mover]:
    """Yield everything that moves.

    Args:
        built: The diagram.
        now: The plant's ``[q; v]``.
        last: The last good ``[q; v]``.
        accelerations: The accelerations (rad/s² or m/s²).
    """
    plant, owners = built.plant, _owners(built)
    for joint in map(plant.get_joint, plant.GetJointIndices()):
        owner = owners.get(joint.model_instance())
        if owner is None or joint.num_velocities() == 0:
            continue
        q = np.arange(joint.num_positions()) + joint.position_start()
        v = np.arange(joint.num_velocities()) + joint.velocity_start()
        fastest = int(np.argmax(np.abs(accelerations[v])))
        acceleration = float(np.abs(accelerations[v[fastest]]))
        v += plant.num_positions()
        is_free = joint.num_velocities() == 6
        yield _Mover(
            owner=owner,
            label=_label(joint, owner),
            speed=float(np.abs(last[v[fastest]])),
            acceleration=acceleration,
            unit="m/s" if joint.type_name() == PrismaticJoint.kTypeName or (is_free and fastest > 2) else "rad/s",
            is_possible=is_possible(now[[*q, *v]]),
        )


def _label(joint: Joint, owner: str) -> str:
    if joint.num_velocities() == 6:
        return "the base" if owner.startswith("robot") else ""
    return "the base" if joint.name() in _OF_THE_BASE else f"joint {joint.name()}"


def _owners(built: TwinDiagram) -> dict[ModelInstanceIndex, str]:
    """Return the robot, or the model of the world, of each model instance, as text."""
    return {
        instance: f"robot {name!r}" if name in built.robots else f"model {name!r} of the world"
        for instance, name in built.owners().items()
    }


def _named_in(text: str, built: TwinDiagram) -> set[str]:
    """Return the owners of the bodies in Drake's message."""
    names = re.findall(r"\bbody (\w+)", text)
    return {
        owner
        for instance, owner in _owners(built).items()
        if any(built.plant.HasBodyNamed(name, instance) for name in names)
    }
