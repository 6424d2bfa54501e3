"""A plant's steps, and its output ports that follow from the step to come: efforts, accelerations, reactions, contacts.

A plant may only hold the state of robots that are stepped elsewhere. Drake's Simulator steps each discrete plant of its
diagram: one whose period is so long that its second step never comes is left alone.
"""

from collections.abc import Mapping
from typing import Any, Protocol

import numpy as np
from pydrake.common.value import AbstractValue, Value
from pydrake.multibody.math import SpatialAcceleration, SpatialForce
from pydrake.multibody.plant import ContactResults, MultibodyPlant
from pydrake.multibody.tree import ModelInstanceIndex
from pydrake.systems.framework import BasicVector, Context, Diagram, DiagramBuilder, OutputPort

from drake_twin.systems.weak_callback import weakly
from drake_twin.systems.witnessless_system import WitnesslessSystem

_NEVER = 2.0**40  # a step of 50 µs becomes 1.7 years


def held(time_step: float) -> float:
    """Return the period of a plant that holds the state of robots that are stepped elsewhere.

    Args:
        time_step: The length of their steps (s).
    """
    return time_step * _NEVER


def holds_state(plant: MultibodyPlant) -> bool:
    """Tell whether a plant only holds the state of robots that are stepped elsewhere."""
    return bool(plant.time_step() > 1e6)


def physics_step(plant: MultibodyPlant) -> float:
    """Return the length of the steps (s) with which a plant's robots are simulated; 0 for a continuous plant."""
    step = float(plant.time_step())
    return step / _NEVER if holds_state(plant) else step


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
        self.solutions: Solutions | None = None
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

    def _asked(self) -> Solutions:
        if self.solutions is None:
            raise RuntimeError("the twin's islands are not there yet: build a Twin, and use its context")
        return self.solutions

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


class PlantPorts:
    """The output ports that follow from the step to come: the plant's own, or those of the islands that step.

    Args:
        plant: The finalized plant.
        elsewhere: The system that has them, if the plant only holds the state.

    Attributes:
        plant: The plant.
        elsewhere: The system that has them; None for the plant.
    """

    def __init__(self, plant: MultibodyPlant, elsewhere: StepsElsewhere | None = None):
        self.plant, self.elsewhere = plant, elsewhere

    def valid(self, port: OutputPort) -> OutputPort:
        """Return the port that has the values which a port of the plant would have, if it stepped its robots itself."""
        if self.elsewhere is None or port.get_system() is not self.plant:
            return port
        name = port.get_name()
        known: OutputPort = self.elsewhere.GetOutputPort(name) if self.elsewhere.HasOutputPort(name) else port
        return known

    def connect_motors(self, builder: DiagramBuilder, robot: Diagram, instance: ModelInstanceIndex) -> None:
        """Connect a robot's ``desired_state``, and its ``actuation`` if it has one, to its motors.

        Args:
            builder: The builder of the root diagram.
            robot: The robot's diagram, named as the robot.
            instance: Its model instance, with at least one actuator.
        """
        ports = {
            "desired_state": self.plant.get_desired_state_input_port(instance),
            "actuation": self.plant.get_actuation_input_port(instance),
        }
        for name, port in ports.items():
            if robot.HasOutputPort(name):
                builder.Connect(robot.GetOutputPort(name), port)
                if self.elsewhere is not None:
                    own = self.elsewhere.GetInputPort(f"{robot.get_name()}/{name}")
                    builder.Connect(robot.GetOutputPort(name), own)

    def net_actuation(self, instance: ModelInstanceIndex | None = None) -> OutputPort:
        """Return the port with the efforts of all actuators, or of a model instance's (N·m or N)."""
        if self.elsewhere is None:
            one = () if instance is None else (instance,)
            return self.plant.get_net_actuation_output_port(*one)
        return self.elsewhere.port("net_actuation") if instance is None else self.elsewhere.net_actuation(instance)

    def efforts(self, root: Context, plant_context: Context, instance: ModelInstanceIndex | None = None) -> np.ndarray:
        """Return the efforts of all actuators, or of a model instance's (N·m or N).

        Args:
            root: The root diagram's context.
            plant_context: The plant's context in it.
            instance: The model instance.
        """
        port = self.net_actuation(instance)
        is_own = port.get_system() is self.plant
        efforts: np.ndarray = port.Eval(plant_context if is_own else port.get_system().GetMyContextFromRoot(root))
        return efforts

    def body_spatial_accelerations(self) -> OutputPort:
        """Return the port with the accelerations of all bodies in the world."""
        if self.elsewhere is None:
            return self.plant.get_body_spatial_accelerations_output_port()
        return self.elsewhere.port("body_spatial_accelerations")

    def reaction_forces(self) -> OutputPort:
        """Return the port with the reactions in all joints."""
        return (
            self.plant.get_reaction_forces_output_port()
            if self.elsewhere is None
            else self.elsewhere.port("reaction_forces")
        )

    def contact_results(self) -> OutputPort:
        """Return the port with the contacts."""
        return (
            self.plant.get_contact_results_output_port()
            if self.elsewhere is None
            else self.elsewhere.port("contact_results")
        )


def contact_value(plant: MultibodyPlant) -> AbstractValue:
    """Return what an input port for a plant's contacts is declared with."""
    return Value[object]() if holds_state(plant) else Value[ContactResults]()
