"""The forces of all controllers that exert some, as one system."""

from collections.abc import Sequence

import numpy as np
from pydrake.common.value import Value
from pydrake.multibody.plant import ExternallyAppliedSpatialForce, MultibodyPlant
from pydrake.multibody.tree import BodyIndex
from pydrake.systems.framework import BasicVector, Context

from drake_twin.controllers.body_forces import BodyForces, Motion
from drake_twin.controllers.free_bodies import FreeBodies
from drake_twin.systems.plant_reading import physics_step
from drake_twin.systems.weak_callback import weakly
from drake_twin.systems.witnessless_system import WitnesslessSystem


class AppliedForces(WitnesslessSystem):
    """Sum up the wrenches of all kinds of forces on each body.

    It reads the motion of free bodies from the plant's state, and that of others from a context of its own, in which it
    sets that state: the plant's ports would carry the motion of all bodies, at a quarter of a microsecond each.

    .. pydrake_system::

        name: AppliedForces
        input_ports:
        - state
        - signals
        - pushes
        - wind
        output_ports:
        - wrenches
        - generalized_forces

    - ``state``: the plant's ``[q; v]``.
    - ``signals``: the controllers' ports ``signals``, one after the other, kind by kind.
    - ``pushes``: the other forces on bodies, a list of ``ExternallyAppliedSpatialForce``, from which those kinds follow
      that are last; the port is there if one is.
    - ``wind``: the velocity of the air in the world (m/s), where that changes.
    - ``wrenches``: for each of the `bodies` the wrench about its origin, in its own axes: N·m, then N.
    - ``generalized_forces``: in place of it, where all of them are free bodies and there are no ``pushes``: a force for
      each of the plant's velocities.

    Args:
        plant: The finalized plant.
        kinds: The forces, in the order in which they are computed, and how many signals each takes.
        may_be_generalized: Whether the plant can take generalized forces.
        wind: The velocity of the air in the world (m/s); None for one that changes.

    Attributes:
        bodies: The bodies on which forces act.
        are_generalized: Whether the port ``generalized_forces`` is there.
    """

    def __init__(
        self,
        plant: MultibodyPlant,
        kinds: Sequence[tuple[BodyForces, int]],
        *,
        may_be_generalized: bool,
        wind: Sequence[float] | None = (0.0, 0.0, 0.0),
    ):
        super().__init__()
        self._plant, self._context = plant, plant.CreateDefaultContext()
        indices = sorted({int(body.index()) for forces, _ in kinds for body in forces.bodies})
        free = [index for index in indices if FreeBodies.has(plant.get_body(BodyIndex(index)))]
        indices = [*free, *(index for index in indices if index not in free)]
        self.bodies = [plant.get_body(BodyIndex(index)) for index in indices]
        self._free = FreeBodies(self.bodies[: len(free)], plant.num_positions())
        self._others = list(enumerate(self.bodies))[len(free) :]
        place = {index: number for number, index in enumerate(indices)}
        self._kinds: list[tuple[BodyForces, np.ndarray | slice, np.ndarray | None, slice]] = []
        end = 0
        for forces, size in kinds:
            places = np.array([place[int(body.index())] for body in forces.bodies])
            part = slice(end, end + size)
            if np.array_equal(places, np.arange(len(indices))):
                self._kinds.append((forces, slice(None), None, part))
            else:
                sums = np.zeros((len(indices), len(places)))
                sums[places, np.arange(len(places))] = 1.0
                self._kinds.append((forces, places, sums, part))
            end += size
        self._half_step = physics_step(plant) / 2
        self._state = self.DeclareVectorInputPort("state", plant.num_multibody_states())
        self._signals = self.DeclareVectorInputPort("signals", end) if end else None
        self._place, self._pushes = place, None
        if any(forces.is_last for forces, _ in kinds):
            model = Value[list[ExternallyAppliedSpatialForce]]()
            self._pushes = self.DeclareAbstractInputPort("pushes", model)
        self._wind = self.DeclareVectorInputPort("wind", 3) if wind is None else None
        self._steady_wind = np.array(wind) if wind is not None and any(wind) else None
        self._masses = self.DeclareNumericParameter(BasicVector(1))  # stands for those of the plant
        self.are_generalized = may_be_generalized and not self._others and self._pushes is None
        if self.are_generalized:
            self.DeclareVectorOutputPort("generalized_forces", plant.num_velocities(), weakly(self._calc))
        else:
            self.DeclareVectorOutputPort("wrenches", 6 * len(indices), weakly(self._calc))

    def follow(self, plant_context: Context, context: Context) -> None:
        """Let forces that depend on masses follow those in a context of the plant.

        Args:
            plant_context: The plant's context.
            context: The context of this system; its outputs are computed again.
        """
        for forces, *_ in self._kinds:
            forces.follow(plant_context)
        context.get_mutable_numeric_parameter(int(self._masses))

    def _calc(self, context: Context, output: BasicVector) -> None:
        state = self._state.Eval(context)
        signals = _NO_SIGNALS if self._signals is None else self._signals.Eval(context)
        R_WB, origins, velocities = self._motion(state)
        # Rows times a rotation are the columns of its inverse: the velocities in the bodies' own axes.
        V_B = (velocities.reshape(-1, 2, 3) @ R_WB).reshape(-1, 6)
        wind = self._steady_wind if self._wind is None else self._wind.Eval(context)
        time, total = context.get_time() + self._half_step, None
        for forces, places, sums, part in self._kinds:
            known = total
            if forces.is_last and self._pushes is not None and (pushes := self._pushes.Eval(context)):
                of_pushes = self._of_pushes(pushes, R_WB)
                known = of_pushes if total is None else total + of_pushes
            motion = Motion(time, state, R_WB, origins, V_B, places, known, wind)
            wrenches = forces.wrenches(motion, signals[part])
            if sums is not None:
                wrenches = sums @ wrenches
            total = wrenches if total is None else total + wrenches
        assert total is not None
        if not self.are_generalized:
            output.SetFromVector(total.ravel())
            return
        generalized = np.zeros(output.size())
        generalized[self._free.velocities] = (total.reshape(-1, 2, 3) @ R_WB.transpose(0, 2, 1)).reshape(-1, 6)
        output.SetFromVector(generalized)

    def _motion(self, state: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return the orientation, the origin and the velocity of each of the bodies, in the world frame."""
        if not self._others:
            return self._free.read(state)
        count = len(self.bodies)
        R_WB, origins, velocities = np.empty((count, 3, 3)), np.empty((count, 3)), np.empty((count, 6))
        free = slice(count - len(self._others))
        R_WB[free], origins[free], velocities[free] = self._free.read(state)
        self._plant.SetPositionsAndVelocities(self._context, state)
        for number, body in self._others:
            X_WB = body.EvalPoseInWorld(self._context)
            R_WB[number], origins[number] = X_WB.rotation().matrix(), X_WB.translation()
            velocities[number] = body.EvalSpatialVelocityInWorld(self._context).get_coeffs()
        return R_WB, origins, velocities

    def _of_pushes(self, pushes: Sequence[ExternallyAppliedSpatialForce], R_WB: np.ndarray) -> np.ndarray:
        """Return the wrenches of pushes on the bodies, as those of the output."""
        found = np.zeros((len(self.bodies), 6))
        for push in pushes:
            number = self._place.get(int(push.body_index))
            if number is not None:
                torque, force = push.F_Bq_W.rotational() @ R_WB[number], push.F_Bq_W.translational() @ R_WB[number]
                found[number, :3] += torque + np.cross(push.p_BoBq_B, force)
                found[number, 3:] += force
        return found


_NO_SIGNALS = np.zeros(0)
