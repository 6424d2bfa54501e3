"""What a plant outputs of the step to come, where it only holds the state of robots that are stepped elsewhere."""

from collections.abc import Mapping
from typing import Any, Protocol
from weakref import ref

import numpy as np
from pydrake.common.value import AbstractValue, Value
from pydrake.multibody.math import SpatialAcceleration, SpatialForce
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import ModelInstanceIndex
from pydrake.systems.framework import BasicVector, Context, OutputPort

from drake_twin.systems.weak_callback import weakly
from drake_twin.systems.witnessless_system import WitnesslessSystem


class Solutions(Protocol):
    """What solves the steps of robots that are stepped elsewhere; all is in the order of the plant that holds them."""

    def net_actuation(self) -> np.ndarray:
        """Return the efforts of all actuators (N·m or N)."""

    def body_spatial_accelerations(self) -> list[SpatialAcceleration]:
        """Return the accelerations of all bodies in the world."""

    def reaction_forces(self) -> list[SpatialForce]:
        """Return the reactions in all joints."""

    def contact_results(self) -> Any:
        """Return the contacts, with the methods of Drake's ContactResults that sensors use."""


class StepsElsewhere(WitnesslessSystem):
    """Output what a plant outputs of the step to come, for a plant that only holds the state of its robots.

    .. pydrake_system::

        name: StepsElsewhere
        input_ports:
        - state
        - <robot>/desired_state
        - <robot>/actuation
        output_ports:
        - net_actuation
        - <robot>/net_actuation
        - body_spatial_accelerations
        - reaction_forces
        - contact_results

    All ports are as those of the plant; the inputs tell when an output is out of date.
    """

    def __init__(self, plant: MultibodyPlant, robots: Mapping[str, ModelInstanceIndex]):
        super().__init__()
        self._solutions: ref[Solutions] | None = None
        self._plant = plant
        self.DeclareVectorInputPort("state", plant.num_multibody_states())
        self._of_robots = {}
        for name, instance in robots.items():
            if count := plant.num_actuators(instance):
                self.DeclareVectorInputPort(f"{name}/desired_state", 2 * count)
                self.DeclareVectorInputPort(f"{name}/actuation", count)
                calc = weakly(self._calc_own)
                port = self.DeclareVectorOutputPort(
                    f"{name}/net_actuation", count, lambda context, output, own=instance, calc=calc: calc(output, own)
                )
                self._of_robots[int(instance)] = port
        self._efforts = self.DeclareVectorOutputPort("net_actuation", plant.num_actuators(), weakly(self._calc_efforts))
        self._others = {
            "body_spatial_accelerations": self._declare(
                "body_spatial_accelerations", Value[list[SpatialAcceleration]], self._calc_accelerations
            ),
            "reaction_forces": self._declare("reaction_forces", Value[list[SpatialForce]], self._calc_reactions),
            "contact_results": self._declare("contact_results", Value[object], self._calc_contacts),
        }

    def _declare(self, name: str, kind: Any, calc: Any) -> OutputPort:
        return self.DeclareAbstractOutputPort(name, kind, weakly(calc))

    def port(self, name: str) -> OutputPort:
        """Return an output port of all robots by its name."""
        return self._efforts if name == "net_actuation" else self._others[name]

    def net_actuation(self, instance: ModelInstanceIndex) -> OutputPort:
        """Return a robot's port ``net_actuation``; an empty one of the plant's if it has no actuator."""
        port: OutputPort = self._of_robots.get(int(instance)) or self._plant.get_net_actuation_output_port(instance)
        return port

    def ask(self, solutions: Solutions) -> None:
        """Ask these from now on, as long as others keep them: a system that is not released is never freed."""
        self._solutions = ref(solutions)

    def _asked(self) -> Solutions:
        solutions = None if self._solutions is None else self._solutions()
        if solutions is None:
            raise RuntimeError("the twin's islands are not there yet: build a Twin, and use its context")
        return solutions

    def _calc_own(self, output: BasicVector, instance: ModelInstanceIndex) -> None:
        output.SetFromVector(self._plant.GetActuationFromArray(instance, self._asked().net_actuation()))

    def _calc_efforts(self, _: Context, output: BasicVector) -> None:
        output.SetFromVector(self._asked().net_actuation())

    def _calc_accelerations(self, _: Context, output: AbstractValue) -> None:
        output.set_value(self._asked().body_spatial_accelerations())

    def _calc_reactions(self, _: Context, output: AbstractValue) -> None:
        output.set_value(self._asked().reaction_forces())

    def _calc_contacts(self, _: Context, output: AbstractValue) -> None:
        output.set_value(self._asked().contact_results())
