"""PID control of each degree of freedom, as in ros2_controllers' pid_controller."""

from collections.abc import Mapping
from dataclasses import field
from math import isfinite, nan, pi
from typing import Any, ClassVar

import numpy as np
from pydrake.systems.framework import Context, InputPort

from drake_twin import messages
from drake_twin.control.pid import Pid, PidGains, PidMemory
from drake_twin.controllers.base_controller import ControllerSetup
from drake_twin.controllers.interface import Interface
from drake_twin.controllers.periodic_controller import PeriodicController, Update
from drake_twin.controllers.registry import controller
from drake_twin.dataclass import dataclass
from drake_twin.description.robot_description import RobotDescription
from drake_twin.errors import CommandError, InputError
from drake_twin.saved import saved


@dataclass(frozen=True)
class PidControllerGains(PidGains):
    """The gains of one degree of freedom.

    Attributes:
        p: Proportional gain.
        i: Integral gain (per second).
        d: Derivative gain (times second).
        u_clamp_max: The highest command of the PID without the feedforward.
        u_clamp_min: The lowest command of the PID.
        antiwindup: Deprecated; without effect, as upstream: the integral term is always clamped.
        i_clamp_max: The highest integral term.
        i_clamp_min: The lowest integral term.
        antiwindup_strategy: The strategy against windup of the integral term.
        tracking_time_constant: The time constant of ``back_calculation`` (s); 0 to derive it from the gains.
        error_deadband: An error of at most this is not integrated.
        feedforward_gain: The factor with which the reference (its derivative if there are two interfaces) is added to
            the command; with ``enable_feedforward``.
        angle_wraparound: Whether the error of an angle is the shortest one.
        save_i_term: Whether the integral term is kept over a deactivation.
        activate_state_publisher: Whether each PID publishes its own state.
    """

    antiwindup: bool = False
    error_deadband: float = 1e-16
    feedforward_gain: float = 0.0
    angle_wraparound: bool = False
    save_i_term: bool = True
    activate_state_publisher: bool = field(
        default=False, metadata={"unsupported": "~/controller_state has the state of every degree of freedom"}
    )


@dataclass(frozen=True)
class PidControllerParameters:
    """Parameters of ``pid_controller/PidController``.

    Attributes:
        dof_names: The joints that are commanded.
        command_interface: The command interface of all joints.
        reference_and_state_interfaces: The state interfaces of measurements and references: one, or one and its
            derivative.
        reference_and_state_dof_names: The joints that are measured, if they are not ``dof_names``.
        set_current_state_as_first_setpoint: Whether the state at activation is the first reference.
        use_external_measured_states: Whether the state comes from a topic.
        enable_feedforward: Whether ``feedforward_gain`` is used.
        gains: The gains of each of ``dof_names``.
    """

    read_only: ClassVar[tuple[str, ...]] = (
        *("dof_names", "reference_and_state_dof_names", "command_interface", "reference_and_state_interfaces"),
        "set_current_state_as_first_setpoint",
    )
    live: ClassVar[tuple[str, ...]] = ("gains.*", "enable_feedforward")

    dof_names: tuple[str, ...]
    command_interface: str
    reference_and_state_interfaces: tuple[str, ...] = field(metadata={"choices": ("position", "velocity")})
    reference_and_state_dof_names: tuple[str, ...] = ()
    set_current_state_as_first_setpoint: bool = True
    use_external_measured_states: bool = field(
        default=False, metadata={"unsupported": "the state comes from the simulated joints"}
    )
    enable_feedforward: bool = False
    gains: Mapping[str, PidControllerGains] = field(default_factory=dict, metadata={"keys": "dof_names"})

    @property
    def state_dof_names(self) -> tuple[str, ...]:
        """The joints that are measured."""
        return self.reference_and_state_dof_names or self.dof_names


@saved("PidReference")
@dataclass(frozen=True)
class PidReference:
    """A reference message with its elements in the controller's order; NaN for elements that stay as they are."""

    id: int
    values: tuple[float, ...]
    values_dot: tuple[float, ...]


@saved("PidControllerMemory")
@dataclass(frozen=True)
class PidControllerMemory:
    """The memory of the controller; tuples have an element for each degree of freedom.

    Attributes:
        reference_id: The id of the last reference message that was used.
        references: The references of each interface; NaN without one.
        measured: The measurements of each interface at the last update.
        commands: The commands; NaN before the first finite reference.
        pids: The memory of each PID.
        time_step: The time between the last two updates (s).
    """

    reference_id: int
    references: tuple[tuple[float, ...], ...]
    measured: tuple[tuple[float, ...], ...]
    commands: tuple[float, ...]
    pids: tuple[PidMemory, ...]
    time_step: float = 0.0


@controller("pid_controller/PidController")
class PidController(PeriodicController):
    """Command each degree of freedom by a PID on the difference between its reference and its state.

    Behaves as ``pid_controller/PidController`` in ROS 2 Jazzy. A reference that is not finite does not change the
    command. Elements of a message are matched by name. The service ``~/set_feedforward_control`` does not exist: use
    ``enable_feedforward``.

    .. pydrake_system::

        name: PidController
        input_ports:
        - state
        - <controller>
        - reference
        output_ports:
        - command_interfaces
        - controller_state

    - ``state``: vector ``[q; v]`` of the robot (rad, rad/s, or m, m/s).
    - ``<controller>``: the references that an upstream controller writes; while it does, messages are ignored.
    - ``reference``: a message as `PidReference`, None before the first; ``control_msgs/msg/MultiDOFCommand``, topic
      ``~/reference`` (rad, rad/s, or m, m/s).
    - ``command_interfaces``: a command for each of ``dof_names`` (rad, rad/s, N·m, or m, m/s, N).
    - ``controller_state``: ``control_msgs/msg/MultiDOFStateStamped``, of the last update; topic ``~/controller_state``.
    """

    Parameters: ClassVar[type] = PidControllerParameters

    @classmethod
    def claimed_interfaces(
        cls, parameters: PidControllerParameters, description: RobotDescription
    ) -> tuple[Interface, ...]:
        """Return the command interface of each degree of freedom."""
        return tuple(Interface(name, parameters.command_interface) for name in parameters.dof_names)

    @classmethod
    def reference_interfaces(
        cls, parameters: PidControllerParameters, description: RobotDescription
    ) -> tuple[Interface, ...]:
        """Return one reference for each interface of each measured degree of freedom."""
        return tuple(
            Interface(name, interface)
            for interface in parameters.reference_and_state_interfaces
            for name in parameters.state_dof_names
        )

    def __init__(self, setup: ControllerSetup):
        super().__init__(setup)
        parameters: PidControllerParameters = setup.parameters
        self._dofs = parameters.state_dof_names
        self._interfaces = parameters.reference_and_state_interfaces
        if len(self._dofs) != len(parameters.dof_names):
            raise InputError(
                f"controller {setup.name!r}: dof_names has {len(parameters.dof_names)} elements and"
                f" reference_and_state_dof_names has {len(self._dofs)}"
            )
        if len(self._interfaces) not in (1, 2):
            raise InputError(
                f"controller {setup.name!r}: reference_and_state_interfaces has {len(self._interfaces)} elements, where"
                " one or two are needed"
            )
        self._gains = [parameters.gains.get(name, PidControllerGains()) for name in parameters.dof_names]
        self._pids = [Pid(gains) for gains in self._gains]
        self._reference = self.declare_topic_input("reference", "control_msgs/msg/MultiDOFCommand")
        self.declare_message_output("controller_state", "control_msgs/msg/MultiDOFStateStamped", self._controller_state)

    def get_reference_input_port(self) -> InputPort:
        """Return the port ``reference``."""
        return self._reference

    def read(self, topic: str, message: Any, context: Context) -> PidReference:
        """Convert a message: its elements in the controller's order.

        Raises:
            CommandError: If the number of elements is not that of the degrees of freedom, or a name is missing.
        """
        names = tuple(message.dof_names) or self._dofs
        values, values_dot = np.asarray(message.values, dtype=float), np.asarray(message.values_dot, dtype=float)
        if values_dot.size == 0:
            values_dot = np.full(len(self._dofs), nan)
        if not len(names) == len(values) == len(values_dot) == len(self._dofs):
            raise CommandError(
                f"the reference has {len(message.dof_names)} names, {values.size} values and {values_dot.size}"
                f" derivatives, but there are {len(self._dofs)} degrees of freedom: {', '.join(self._dofs)}"
            )
        for name in self._dofs:
            if name not in names:
                raise CommandError(f"the reference lacks {name!r}; it has {', '.join(names)}")
        order = [names.index(name) for name in self._dofs]
        id = self.newest_id(context, self._reference) + 1
        return PidReference(id, tuple(values[order].tolist()), tuple(values_dot[order].tolist()))

    def used_id(self, memory: PidControllerMemory) -> int:
        """Return the id of the last reference message that was used."""
        return memory.reference_id

    def start(self, context: Context) -> PidControllerMemory:
        """Return a memory with the state as first reference, if so configured, and the saved integral terms."""
        last: PidControllerMemory | None = self.sample(context).memory
        measured = self._measured(context)
        nothing = (nan,) * len(self._dofs)
        is_first = self.setup.parameters.set_current_state_as_first_setpoint
        return PidControllerMemory(
            reference_id=0 if last is None else last.reference_id,
            references=measured if is_first else (nothing,) * len(self._interfaces),
            measured=measured,
            commands=nothing,
            pids=tuple(
                PidMemory(last.pids[i].integral) if last is not None and gains.save_i_term else PidMemory()
                for i, gains in enumerate(self._gains)
            ),
        )

    def update(self, context: Context, time: float, memory: PidControllerMemory) -> Update:
        """Update every PID."""
        reference_id, references = self._references(context, memory)
        measured = self._measured(context)
        dt = time - self.sample(context).time
        commands, pids = [], []
        for i, last in enumerate(memory.pids):
            command, pid = self._step(i, [row[i] for row in references], [row[i] for row in measured], dt, last)
            commands.append(memory.commands[i] if command is None else command)
            pids.append(pid)
        new = PidControllerMemory(reference_id, references, measured, tuple(commands), tuple(pids), dt)
        return Update(new, commands)

    def _references(self, context: Context, memory: PidControllerMemory) -> tuple[int, tuple[tuple[float, ...], ...]]:
        """Return the references; those without a new finite value stay."""
        message: PidReference | None = self.pending(context, self._reference)
        reference_id = memory.reference_id if message is None else message.id
        upstream = self.references(context)
        if upstream is not None:
            new = upstream.reshape(len(self._interfaces), len(self._dofs))
        elif message is not None:
            new = np.array([message.values, message.values_dot][: len(self._interfaces)])
            new[:, np.isnan(new[0])] = nan  # a derivative alone changes nothing
        else:
            return reference_id, memory.references
        merged = np.where(np.isnan(new), memory.references, new)
        return reference_id, tuple(map(tuple, merged.tolist()))

    def _measured(self, context: Context) -> tuple[tuple[float, ...], ...]:
        of_interface = {"position": self.positions, "velocity": self.velocities}
        return tuple(tuple(of_interface[name](context, self._dofs).tolist()) for name in self._interfaces)

    def _step(
        self, index: int, reference: list[float], measured: list[float], dt: float, memory: PidMemory
    ) -> tuple[float | None, PidMemory]:
        """Return a degree of freedom's command, None without a finite reference, and its PID's memory."""
        if not (isfinite(reference[0]) and isfinite(measured[0])):
            return None, memory
        gains = self._gains[index]
        forward = reference[-1] * gains.feedforward_gain if self.setup.parameters.enable_feedforward else 0.0
        error_dot = reference[1] - measured[1] if len(reference) == 2 and isfinite(reference[1]) else None
        error = _error(reference[0], measured[0], gains.angle_wraparound)
        command, memory = self._pids[index].compute(error, error_dot, dt, memory)
        return command + (forward if isfinite(forward) else 0.0), memory

    def _controller_state(self, context: Context) -> Any:
        sample = self.sample(context)
        memory: PidControllerMemory | None = sample.memory
        if memory is None:
            return None
        with_derivative = len(self._interfaces) == 2
        states = [
            messages.SingleDOFState(
                name=name,
                reference=memory.references[0][i],
                feedback=memory.measured[0][i],
                feedback_dot=memory.measured[1][i] if with_derivative else 0.0,
                error=_error(memory.references[0][i], memory.measured[0][i], self._gains[i].angle_wraparound),
                error_dot=memory.references[1][i] - memory.measured[1][i] if with_derivative else 0.0,
                time_step=memory.time_step,
                output=memory.commands[i],
            )
            for i, name in enumerate(self._dofs)
        ]
        return messages.MultiDOFStateStamped(header=messages.header(sample.time), dof_states=states)


def _error(reference: float, measured: float, wraps: bool) -> float:
    error = reference - measured
    return pi - (pi - error) % (2.0 * pi) if wraps else error
