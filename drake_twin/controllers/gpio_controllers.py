"""Commands to and states of GPIOs, as ros2_controllers' gpio_controllers write and publish them."""

from collections.abc import Iterator, Mapping
from dataclasses import field
from math import isinf, nan
from typing import Any, ClassVar

from pydrake.common.value import AbstractValue
from pydrake.systems.framework import BasicVector, Context, InputPort, OutputPort

from drake_twin import messages
from drake_twin.controllers.base_controller import Controller, ControllerSetup
from drake_twin.controllers.interface import Interface
from drake_twin.controllers.registry import controller
from drake_twin.dataclass import dataclass
from drake_twin.description.parameters import ParameterError
from drake_twin.description.robot_description import RobotDescription
from drake_twin.errors import CommandError


@dataclass(frozen=True)
class GpioInterfaces:
    """The interfaces of one GPIO.

    Attributes:
        interfaces: Their names.
    """

    interfaces: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        _check_unique(self.interfaces, "interfaces")


@dataclass(frozen=True)
class GpioCommandParameters:
    """Parameters of ``gpio_controllers/GpioCommandController``.

    Attributes:
        gpios: The GPIOs, in the order of the published states.
        command_interfaces: The command interfaces of each of ``gpios``; by default none.
        state_interfaces: The state interfaces of each of ``gpios``; if no GPIO has any here, all that
            ``<ros2_control>`` has for ``gpios`` are published.
    """

    read_only: ClassVar[tuple[str, ...]] = ("*",)

    gpios: tuple[str, ...]
    command_interfaces: Mapping[str, GpioInterfaces] = field(default_factory=dict, metadata={"keys": "gpios"})
    state_interfaces: Mapping[str, GpioInterfaces] = field(default_factory=dict, metadata={"keys": "gpios"})

    def __post_init__(self) -> None:
        _check_unique(self.gpios, "gpios")

    def commands(self) -> Iterator[Interface]:
        """Yield the command interfaces."""
        return self._listed(self.command_interfaces)

    def states(self, description: RobotDescription) -> Iterator[Interface]:
        """Yield the state interfaces, GPIO by GPIO."""
        listed = [*self._listed(self.state_interfaces)]
        if listed:
            yield from listed
            return
        for gpio in self.gpios:
            if gpio in description.gpios:
                yield from (Interface(gpio, name) for name in description.gpios[gpio].states)

    def _listed(self, interfaces: Mapping[str, GpioInterfaces]) -> Iterator[Interface]:
        for gpio in self.gpios:
            yield from (Interface(gpio, name) for name in interfaces.get(gpio, GpioInterfaces()).interfaces)


@controller("gpio_controllers/GpioCommandController")
class GpioCommandController(Controller):
    """Forward commands to GPIOs as they arrive, and publish the states of GPIOs.

    Behaves as ``gpio_controllers/GpioCommandController`` in ROS 2 Jazzy; `drake_twin.systems.gpio_hardware` has the
    simulated hardware. A command names GPIOs and interfaces in any order; others keep their values. A message with an
    unknown name or an infinite value is refused as a whole: upstream writes what else the message has, and an infinite
    value makes its hardware fail.

    .. pydrake_system::

        name: GpioCommandController
        input_ports:
        - gpio_states
        - commands
        output_ports:
        - command_interfaces
        - gpio_states

    - ``gpio_states``: vector of all state interfaces of the robot's GPIOs.
    - ``commands``: ``control_msgs/msg/DynamicInterfaceGroupValues``, None before the first; topic ``~/commands``. With
      command interfaces only, and so is the next port.
    - ``command_interfaces``: a value for each command interface; NaN where the last message has none.
    - ``gpio_states``: ``control_msgs/msg/DynamicInterfaceGroupValues``, one group for each of the parameter ``gpios``,
      NaN where the hardware has no value; topic ``~/gpio_states``.
    """

    Parameters: ClassVar[type] = GpioCommandParameters

    @classmethod
    def claimed_interfaces(
        cls, parameters: GpioCommandParameters, description: RobotDescription
    ) -> tuple[Interface, ...]:
        """Return the command interfaces of the GPIOs that the robot has."""
        return tuple(claim for claim in parameters.commands() if claim.joint in description.gpios)

    @classmethod
    def problem(cls, parameters: GpioCommandParameters, description: RobotDescription) -> str | None:
        """Return which interface is missing; None if there is one and all are there."""
        wanted = [("command", item) for item in parameters.commands()]
        wanted += [("state", item) for item in parameters.states(description)]
        for kind, (gpio, interface) in wanted:
            if gpio not in description.gpios:
                known = ", ".join(description.gpios) or "none"
                return f"the robot has no gpio {gpio!r} in <ros2_control> (it has {known})"
            problem = description.gpios[gpio].problem(kind, interface)
            if problem is not None:
                return problem
        if not wanted:
            gpios = ", ".join(parameters.gpios)
            return f"no command or state interface is configured, and <ros2_control> has no state interface of {gpios}"
        return None

    def __init__(self, setup: ControllerSetup):
        super().__init__(setup)
        parameters: GpioCommandParameters = setup.parameters
        known = [Interface(gpio.name, name) for gpio in setup.description.gpios.values() for name in gpio.states]
        states = [*parameters.states(setup.description)]
        self._groups = {
            gpio: [(item.name, known.index(item)) for item in states if item.joint == gpio] for gpio in parameters.gpios
        }
        listed = ("command_interfaces", "state_interfaces")
        self.warnings = tuple(
            f"{name}.{gpio} is ignored: {gpio!r} is not among the gpios"
            for name in listed
            for gpio in getattr(parameters, name)
            if gpio not in parameters.gpios
        )
        self._states = self.declare_robot_input("gpio_states", len(known))
        if self.claims:
            self._commands = self.declare_topic_input("commands", "control_msgs/msg/DynamicInterfaceGroupValues")
            self.declare_command_interfaces(
                self._calc_command_interfaces, {self.input_port_ticket(self._commands.get_index())}
            )
        self.declare_topic_output(
            "gpio_states",
            "control_msgs/msg/DynamicInterfaceGroupValues",
            self._calc_gpio_states,
            {self.time_ticket(), self.input_port_ticket(self._states.get_index())},
        )

    def get_commands_input_port(self) -> InputPort:
        """Return the port ``commands``."""
        return self._commands

    def get_gpio_states_output_port(self) -> OutputPort:
        """Return the output port ``gpio_states``."""
        return self.GetOutputPort("gpio_states")

    def read(self, topic: str, message: Any, context: Context) -> Any:
        """Check a message.

        Raises:
            CommandError: If a GPIO or an interface is not among the command interfaces, a value is infinite, or the
                numbers of names and values differ. A GPIO with more names than values or fewer makes ros2_control
                deactivate the controller.
        """
        groups, values = message.interface_groups, message.interface_values
        if len(groups) != len(values):
            raise CommandError(f"the command has {len(groups)} interface_groups, but {len(values)} interface_values")
        for gpio, group in zip(groups, values, strict=True):
            if len(group.interface_names) != len(group.values):
                raise CommandError(
                    f"for gpio {gpio} the command has {len(group.interface_names)} interface_names, but"
                    f" {len(group.values)} values",
                    deactivates=True,
                )
        for interface, value in _values(message):
            if interface not in self.claims:
                raise CommandError(
                    f"{interface} is not a command interface of this controller: {', '.join(map(str, self.claims))}"
                )
            if isinf(value):
                raise CommandError(f"the command for {interface} is {value}, which is not a finite number")
        return message

    def starts_or_stops(self, before: Any, now: Any) -> bool:
        """Return False: a GPIO moves no joint."""
        return False

    def _calc_command_interfaces(self, context: Context, output: BasicVector) -> None:
        message = self.received(self._commands, context)
        written = {} if message is None else dict(_values(message))
        output.SetFromVector([written.get(claim, nan) for claim in self.claims])

    def _calc_gpio_states(self, context: Context, output: AbstractValue) -> None:
        values = self._states.Eval(context)
        output.set_value(
            messages.DynamicInterfaceGroupValues(
                header=messages.header(context.get_time()),
                interface_groups=list(self._groups),
                interface_values=[
                    messages.InterfaceValue(
                        interface_names=[name for name, _ in states], values=values[[index for _, index in states]]
                    )
                    for states in self._groups.values()
                ],
            )
        )


def _values(message: Any) -> Iterator[tuple[Interface, float]]:
    """Yield each commanded interface and its value."""
    for gpio, group in zip(message.interface_groups, message.interface_values, strict=True):
        for name, value in zip(group.interface_names, group.values, strict=True):
            yield Interface(gpio, name), float(value)


def _check_unique(names: tuple[str, ...], parameter: str) -> None:
    for name in names:
        if names.count(name) > 1:
            raise ParameterError(f"duplicate {name!r}", parameter)
