"""What is read of a plant: its step, its ports of the step to come, and the numbers that messages are made of.

A plant may only hold the state of robots that are stepped elsewhere. Drake's Simulator steps each discrete plant of its
diagram: one whose period is so long that its second step never comes is left alone.
"""

from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from pydrake.common.value import AbstractValue, Value
from pydrake.multibody.plant import ContactResults, MultibodyPlant
from pydrake.multibody.tree import ModelInstanceIndex
from pydrake.systems.framework import Context, Diagram, DiagramBuilder, OutputPort

from drake_twin.errors import InputError

if TYPE_CHECKING:
    from drake_twin.systems.steps_elsewhere import StepsElsewhere

_CONSTANTS = np.array([np.nan, 0.0])

# Outputs of a plant that follow from its next step.
_OF_THE_STEP = {
    "net_actuation",
    "body_spatial_accelerations",
    "reaction_forces",
    "contact_results",
    "generalized_acceleration",
}
_OF_MODELS = ("_net_actuation", "_generalized_acceleration", "_generalized_contact_forces")  # after a model's name

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


class PlantPorts:
    """The output ports that follow from the step to come: the plant's own, or those of the islands that step.

    Args:
        plant: The finalized plant.
        elsewhere: The system that has them, if the plant only holds the state.

    Attributes:
        plant: The plant.
        elsewhere: The system that has them; None for the plant.
    """

    def __init__(self, plant: MultibodyPlant, elsewhere: "StepsElsewhere | None" = None):
        self.plant, self.elsewhere = plant, elsewhere

    def refuse_own(self, builder: DiagramBuilder) -> None:
        """Refuse connections to ports of a plant that only holds the state, for which islands have the values.

        Raises:
            InputError: If there is one.
        """
        if self.elsewhere is None:
            return
        for (system, _), (source, index) in builder.connection_map().items():
            port = source.get_output_port(index)
            name = port.get_name() if source is self.plant else ""
            if name in _OF_THE_STEP or (name.endswith(_OF_MODELS) and port.size()):
                what = f"system {system.get_name()!r} reads the plant's port {name!r}, which has no value with islands"
                raise InputError(f"{what}: use DiagramParts.ports and DiagramParts.output, or islands=0")

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


class Reading:
    """The numbers of a plant at the time of a context, read when asked for, which must be before the context changes.

    Args:
        ports: The plant's ports.
        root_context: The root diagram's context.
        plant_context: The plant's context in it.

    Attributes:
        root_context: The root diagram's context.
        time: Its time (s).
    """

    def __init__(self, ports: PlantPorts, root_context: Context, plant_context: Context):
        self._ports, self._plant = ports, ports.plant
        self._plant_context = plant_context
        self.root_context = root_context
        self.time: float = root_context.get_time()

    @cached_property
    def state(self) -> np.ndarray:
        """The plant's ``[q; v]``, shape (n,)."""
        state: np.ndarray = self._plant.GetPositionsAndVelocities(self._plant_context)
        return state

    @cached_property
    def with_efforts(self) -> np.ndarray:
        """``[q; v]``, the efforts of all actuators (N·m or N), NaN and 0; shape (n + m + 2,)."""
        if self._ports.elsewhere is None:  # a call less for each message
            efforts = self._plant.get_net_actuation_output_port().Eval(self._plant_context)
        else:
            efforts = self._ports.efforts(self.root_context, self._plant_context)
        return np.concatenate((self.state, efforts, _CONSTANTS))

    @cached_property
    def without_efforts(self) -> np.ndarray:
        """The same with NaN for all efforts: after a command they take as long as a step."""
        return np.concatenate((self.state, np.full(self._plant.num_actuators(), np.nan), _CONSTANTS))
