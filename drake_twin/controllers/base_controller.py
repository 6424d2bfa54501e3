"""The base of all controllers: what they are built from, their claims and their ports."""

from abc import abstractmethod
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import field
from typing import Any, ClassVar

from pydrake.common.value import AbstractValue
from pydrake.systems.framework import Context, InputPort, OutputPort

from drake_twin.controllers.goal_state import GoalState
from drake_twin.controllers.interface import Interface
from drake_twin.controllers.older_accessors import with_older_accessors
from drake_twin.dataclass import dataclass
from drake_twin.description.robot_description import RobotDescription, Vector3
from drake_twin.kinematics.state_layout import StateLayout
from drake_twin.messages.draft import Drafter
from drake_twin.systems.no_message import empty_value, or_none
from drake_twin.systems.weak_callback import weakly
from drake_twin.systems.witnessless_system import WitnesslessSystem


@dataclass(frozen=True)
class Upstream:
    """A controller that may write another controller's references.

    Attributes:
        size: The size of its port ``command_interfaces``.
        indices: The index of each reference in that port; -1 if this controller does not write it.
    """

    size: int
    indices: tuple[int, ...]


@dataclass(frozen=True)
class ControllerSetup:
    """What a controller is built from.

    Attributes:
        name: The controller's name, the prefix of its topics.
        parameters: An instance of its class's ``Parameters``.
        claims: The command interfaces that it writes while active, in order.
        description: The robot: its joints, limits and links.
        layout: The indices of the robot's joints in the plant's state ``[q; v]``.
        update_period: The time between two updates (s), a multiple of the physics step.
        update_offset: The time of the first update (s); chained controllers update one physics step after each other.
        namespace: The robot's namespace, ``/robot_1`` or empty.
        frame_prefix: The text before the robot's link names in tf messages.
        upstream: The controllers that may write this controller's references.
        true_odometry: Whether a drive publishes the true pose as its odometry instead of integrating its wheels.
        physics_step: The time between two physics steps (s); 0 for one much shorter than ``update_period``.
        position_time_constant: A joint approaches its commanded position at error / this (s).
        tells_of_motion: Whether to stop the advance when a commanded velocity becomes zero or nonzero.
        active_at_start: Whether a new Context of the diagram has it active.
        measures_late: Whether what it reads of the robot is delayed.
        robot: The robot's name, which is its model's in Gazebo.
        publication_period: The time between two publications of a drive's odometry (s), for a plugin of Gazebo; 0 for
            what its parameters say.
    """

    name: str
    parameters: Any
    claims: tuple[Interface, ...]
    description: RobotDescription
    layout: StateLayout
    update_period: float = 0.01
    update_offset: float = 0.0
    namespace: str = ""
    frame_prefix: str = ""
    upstream: Mapping[str, Upstream] = field(default_factory=dict)
    true_odometry: bool = False
    physics_step: float = 0.0
    position_time_constant: float = 0.2
    tells_of_motion: bool = False
    active_at_start: bool = False
    measures_late: bool = False
    robot: str = ""
    publication_period: float = 0.0

    def frame(self, frame_id: str) -> str:
        """Return a frame's name on ``/tf``: links of this robot get the robot's frame prefix."""
        return f"{self.frame_prefix}{frame_id}" if frame_id in self.description.links else frame_id


@with_older_accessors
class Controller(WitnesslessSystem):
    """Read topics and write command interfaces, as a controller of ros2_control does.

    Use this base for controllers whose output depends on their inputs alone: Drake's cache computes it once a message.
    Derive a controller that depends on time or on the robot's state from `PeriodicController`. A subclass declares its
    ports with the ``declare_…`` methods.

    - ``command_interfaces``: vector with one element for each claim (rad, rad/s, N·m, or m, m/s, N), then one for each
      of ``feedforward``; NaN where nothing is written. A controller that claims nothing has no such port.

    Attributes:
        Parameters: A frozen dataclass, read by `drake_twin.description.parameters.read_parameters`.
        needs_command_interfaces: Whether ``<ros2_control>`` must have the interfaces that it claims, as in ROS.
        flies: Whether the velocities that it follows may be upwards.
        setup: What the controller was built from.
        claims: The command interfaces that it writes.
        feedforward: Unclaimed interfaces that the joint servo takes as feedforward: the velocity of a position.
        subscribed: Input topic below the controller's name → ROS message type; each is an abstract input port.
        published: Output topic below the controller's name → ROS message type; each is an abstract output port.
        actions: Action below the controller's name → ROS action type; each is an abstract input port.
        vector_inputs: Name below the controller's name → vector input port for a user's own systems.
        vector_outputs: Name below the controller's name → vector output port for a user's own systems.
        robot_inputs: Signal of the robot → its input port, see `declare_robot_input`.
        odometry_frames: Parent and child frame of the port ``tf_odometry``; None without that port.
        warnings: Parameters without effect, as sentences.
    """

    Parameters: ClassVar[type]
    needs_command_interfaces: ClassVar[bool] = True
    flies: ClassVar[bool] = False

    @classmethod
    def claimed_interfaces(cls, parameters: Any, description: RobotDescription) -> tuple[Interface, ...]:
        """Return the command interfaces that a controller with these parameters claims, in order."""
        return ()

    @classmethod
    def reference_interfaces(cls, parameters: Any, description: RobotDescription) -> tuple[Interface, ...]:
        """Return the references that other controllers may claim, without this controller's name as prefix."""
        return ()

    @classmethod
    def exported_interfaces(cls, parameters: Any) -> tuple[str, ...]:
        """Return the names of the state interfaces that the controller exports, without its own as prefix."""
        return ()

    @classmethod
    def problem(cls, parameters: Any, description: RobotDescription) -> str | None:
        """Return why a controller with these parameters cannot run on a robot; None if it can."""
        return None

    @classmethod
    def topic_name(cls, name: str, parameters: Any, topic: str) -> str:
        """Return the name of a topic of this controller below the robot's namespace.

        Args:
            name: The controller's name.
            parameters: Its parameters; None if they could not be read.
            topic: One of ``subscribed`` or ``published``.
        """
        return f"{name}/{topic}"

    def __init__(self, setup: ControllerSetup, feedforward: Sequence[Interface] = ()):
        super().__init__()
        self.setup = setup
        self.claims = setup.claims
        self.feedforward = tuple(feedforward)
        self.subscribed: dict[str, str] = {}
        self.published: dict[str, str] = {}
        self.actions: dict[str, str] = {}
        self.vector_inputs: dict[str, InputPort] = {}
        self.vector_outputs: dict[str, OutputPort] = {}
        self.robot_inputs: dict[str, InputPort] = {}
        self.odometry_frames: tuple[str, str] | None = None
        self.warnings: tuple[str, ...] = ()

    @property
    def interfaces(self) -> tuple[Interface, ...]:
        """The interfaces on the port ``command_interfaces``: the claims, then the feedforward."""
        return (*self.claims, *self.feedforward)

    def read(self, topic: str, message: Any, context: Context) -> Any:
        """Convert a message to the value that its input port takes.

        Args:
            topic: One of ``subscribed`` or ``actions``.
            message: The ROS message; for an action its goal.
            context: The controller's own context at the present time.

        Raises:
            CommandError: If the message is refused. With ``deactivates`` the controller is deactivated as well.
        """
        return message

    def timeout(self, topic: str) -> float | None:
        """Return the time for which a message on a topic is valid before its port is cleared (s); None for ever."""
        return None

    def starts_or_stops(self, before: Any, now: Any) -> bool:
        """Return whether replacing a topic's value may change how a joint is driven; None stands for no value."""
        return True

    def activate(self, context: Context) -> None:
        """Start from the initial state; the ports of its topics have been cleared."""

    def deactivate(self, context: Context) -> None:
        """Stop writing; the ports of its topics are cleared afterwards."""

    def fault(self, context: Context) -> str | None:
        """Return why the last update failed; None if it did not."""
        return None

    def goal_state(self, context: Context) -> GoalState | None:
        """Return the state of the newest goal of its action; None before the first."""
        return None

    def feedback(self, context: Context) -> Any:
        """Return the feedback message of its action."""
        return None

    def result(self, context: Context) -> Any:
        """Return the result message of the last goal; None if `goal_state` has all of it."""
        return None

    def cancel(self, context: Context) -> None:
        """Cancel the newest goal of its action."""

    def drafter(self, topic: str, places: Sequence[int]) -> Drafter | None:
        """Return what drafts a topic's messages, if they follow from the plant's state and efforts alone; else None.

        Args:
            topic: One of ``published``.
            places: The index in `Reading.with_efforts` of each element of the robot's ``state``, then of its
                ``net_actuation``, then of NaN and 0.
        """
        return None

    def received(self, port: InputPort, context: Context) -> Any:
        """Return the value on the port of a topic or action; None if it has no value, as in a bare Simulator."""
        return or_none(port.Eval(context)) if port.HasValue(context) else None

    def get_command_interfaces_output_port(self) -> OutputPort:
        """Return the port ``command_interfaces``."""
        return self.GetOutputPort("command_interfaces")

    def declare_topic_input(self, topic: str, kind: str) -> InputPort:
        """Declare an input port that holds what `read` made of a topic's last message; None before the first."""
        self.subscribed[topic] = kind
        return self.DeclareAbstractInputPort(topic, empty_value())

    def declare_action_input(self, action: str, kind: str) -> InputPort:
        """Declare an input port that holds what `read` made of an action's last goal; None before the first."""
        self.actions[action] = kind
        return self.DeclareAbstractInputPort(action, empty_value())

    def declare_topic_output(
        self, topic: str, kind: str, calc: Callable[[Context, AbstractValue], None], prerequisites: Collection[Any]
    ) -> OutputPort:
        """Declare an output port that holds a message or None, as set by ``calc(context, output)``."""
        self.published[topic] = kind
        return self.DeclareAbstractOutputPort(topic, empty_value, weakly(calc), set(prerequisites))

    def declare_vector_input(self, name: str, size: int) -> InputPort:
        """Declare a vector input port that the root diagram has as ``<robot>/<controller>/<name>``."""
        port: InputPort = self.DeclareVectorInputPort(name, size)
        self.vector_inputs[name] = port
        return port

    def declare_robot_input(self, name: str, size: int) -> InputPort:
        """Declare a vector input port that takes a signal of the robot.

        The signals are ``state``, ``true_state``, ``net_actuation``, ``commanded_motion`` and ``gpio_states``.

        ``commanded_motion`` is that of `drake_twin.systems.joint_servo.JointServo`; it is not connected without a
        servo.

        ``true_state`` is the state without the robot's measurement delay.

        ``gpio_states`` has each state interface of `RobotDescription.gpios`, in that order.
        """
        port: InputPort = self.DeclareVectorInputPort(name, size)
        self.robot_inputs[name] = port
        return port

    def declare_command_interfaces(self, calc: Callable[..., None], prerequisites: Collection[Any]) -> OutputPort:
        """Declare the port ``command_interfaces``; ``calc(context, output)`` fills a vector."""
        size = len(self.interfaces)
        return self.DeclareVectorOutputPort("command_interfaces", size, weakly(calc), set(prerequisites))


class MovesSurfaces:
    """What controllers have besides that move the surfaces of links.

    They have an output port ``surface_speeds``, a vector: the speed of the surface of each link, in their order (m/s).
    A surface moves at speed · (axis × normal), with the normal out of the link.
    """

    @classmethod
    @abstractmethod
    def surfaces(cls, parameters: Any) -> Mapping[str, Vector3]:
        """Return the links whose surfaces are moved with these parameters, and the axis of each in its frame."""
