"""A robot's joint states as messages, as ros2_controllers' joint_state_broadcaster publishes them."""

from collections.abc import Mapping, Sequence
from dataclasses import field
from operator import attrgetter
from typing import Any, ClassVar

import numpy as np
from pydrake.common.value import AbstractValue
from pydrake.systems.framework import BasicVector, Context, InputPort, OutputPort

from drake_twin import messages
from drake_twin.controllers.base_controller import Controller, ControllerSetup
from drake_twin.controllers.registry import JOINT_STATE_BROADCASTER, controller
from drake_twin.dataclass import dataclass
from drake_twin.description.robot_description import RobotDescription
from drake_twin.messages.draft import Drafter
from drake_twin.systems.no_message import set_value
from drake_twin.systems.weak_callback import weakly

_INTERFACES = ("position", "velocity", "effort")
_CONSTANTS = np.array([np.nan, 0.0])  # for missing values and for extra joints


@dataclass(frozen=True)
class JointStateInterfaceMap:
    """The state interface that each field of ``JointState`` is taken from.

    Attributes:
        position: The interface for positions.
        velocity: The interface for velocities.
        effort: The interface for efforts.
    """

    position: str = "position"
    velocity: str = "velocity"
    effort: str = "effort"


@dataclass(frozen=True)
class JointStateBroadcasterParameters:
    """Parameters of ``joint_state_broadcaster/JointStateBroadcaster``.

    Attributes:
        use_local_topics: Whether the topics have the controller's name as prefix.
        joints: The joints, in order; all if this or ``interfaces`` is empty.
        extra_joints: Joints that the robot does not have, published as 0.
        interfaces: The state interfaces; all if this or ``joints`` is empty.
        map_interface_to_joint_state: The state interfaces with other names.
        use_urdf_to_filter: Whether only joints of the robot's description are published.
        frame_id: The frame in the messages' headers.
        publish_dynamic_joint_states: Whether ``dynamic_joint_states`` is published.
    """

    read_only: ClassVar[tuple[str, ...]] = ("*",)

    use_local_topics: bool = False
    joints: tuple[str, ...] = ()
    extra_joints: tuple[str, ...] = ()
    interfaces: tuple[str, ...] = ()
    map_interface_to_joint_state: JointStateInterfaceMap = JointStateInterfaceMap()
    use_urdf_to_filter: bool = field(
        default=True, metadata={"unsupported": "everything that has a state is a joint of the description"}
    )
    frame_id: str = "base_link"
    publish_dynamic_joint_states: bool = True

    def select(self, interfaces: Mapping[str, Sequence[str]]) -> dict[str, tuple[str, ...]]:
        """Return the joints to broadcast and the state interfaces of each, in order.

        Args:
            interfaces: Joint name → its state interfaces.
        """
        if not self.joints or not self.interfaces:
            return {joint: tuple(names) for joint, names in interfaces.items()}
        return dict.fromkeys(self.joints, self.interfaces)

    def field_of(self, interface: str) -> str:
        """Return the name of a state interface in the messages."""
        for name in _INTERFACES:
            if interface == getattr(self.map_interface_to_joint_state, name) and not (
                name in self.interfaces and self.joints
            ):
                return name
        return interface


@controller(JOINT_STATE_BROADCASTER)
class JointStateBroadcaster(Controller):
    """Publish a robot's state as ``JointState`` and ``DynamicJointState`` messages stamped with simulation time.

    Behaves as ``joint_state_broadcaster/JointStateBroadcaster`` in ROS 2 Jazzy: NaN where a joint has no state
    interface, 0 for extra joints. Joints are in the order of the parameter ``joints``, else of ``<ros2_control>``.
    Without ``<ros2_control>`` all movable joints have all interfaces.

    .. pydrake_system::

        name: JointStateBroadcaster
        input_ports:
        - state
        - net_actuation
        output_ports:
        - joint_states
        - dynamic_joint_states
        - state_estimated

    - ``state``: vector ``[q; v]`` of the model instance (rad, rad/s, or m, m/s).
    - ``net_actuation``: vector of the efforts that its actuators apply (N·m or N).
    - ``joint_states``: ``sensor_msgs/msg/JointState``; topic ``joint_states``.
    - ``dynamic_joint_states``: ``control_msgs/msg/DynamicJointState``, None if parameters turn it off; topic
      ``dynamic_joint_states``.
    - ``state_estimated``: vector of the positions, then the velocities, of all movable joints in file order (rad,
      rad/s, or m, m/s); it depends on ``state`` alone, and needs no activation.
    """

    Parameters: ClassVar[type] = JointStateBroadcasterParameters

    @classmethod
    def topic_name(cls, name: str, parameters: JointStateBroadcasterParameters | None, topic: str) -> str:
        """Return the topic's name, with the controller's name as prefix if ``use_local_topics`` is set."""
        return f"{name}/{topic}" if parameters is not None and parameters.use_local_topics else topic

    def __init__(self, setup: ControllerSetup):
        super().__init__(setup)
        parameters: JointStateBroadcasterParameters = setup.parameters
        layout, interfaces = setup.layout, _state_interfaces(setup.description)
        self._frame_id = setup.frame(parameters.frame_id)
        self._with_dynamic = parameters.publish_dynamic_joint_states
        # After the last value come NaN for missing values and 0 for extra joints.
        missing = layout.size + layout.num_actuators
        # Joint → name in the messages → index of the value.
        places: dict[str, dict[str, int]] = {}
        for joint, names in parameters.select(interfaces).items():
            places[joint] = {}
            existing = interfaces.get(joint, ())
            for name in [name for name in names if name in existing] or names:
                found = layout.place(joint, name) if name in existing else None
                place = missing if found is None else found
                if place != missing or parameters.field_of(name) not in places[joint]:
                    places[joint][parameters.field_of(name)] = place
        for joint in parameters.extra_joints:
            places.setdefault(joint, dict.fromkeys(_INTERFACES, missing + 1))
        of_joint_states = {joint: where for joint, where in places.items() if not where.keys().isdisjoint(_INTERFACES)}
        self.joints = tuple(of_joint_states)
        # Rows of gathered values: position, velocity, effort.
        self._gather = np.array(
            [[where.get(name, missing) for where in of_joint_states.values()] for name in _INTERFACES], dtype=int
        )
        self._places = {
            joint: (tuple(where), np.array([*where.values()], dtype=int)) for joint, where in places.items()
        }
        # Efforts are evaluated only if they are published: after a command they take as long as a step.
        self._no_efforts = np.full(layout.num_actuators, np.nan)
        self._has_efforts = any(layout.size <= place < missing for where in places.values() for place in where.values())
        self._state = self.declare_robot_input("state", layout.size)
        self._net_actuation = self.declare_robot_input("net_actuation", layout.num_actuators)
        movable = [joint.name for joint in setup.description.movable_joints]
        indices = [*(layout.positions[name] for name in movable), *(layout.velocities[name] for name in movable)]
        self._of_joints = np.array(indices, dtype=int)
        self.DeclareVectorOutputPort(
            "state_estimated",
            len(indices),
            weakly(self._calc_state_estimated),
            {self.input_port_ticket(self._state.get_index())},
        )
        prerequisites = {
            self.time_ticket(),
            self.input_port_ticket(self._state.get_index()),
            self.input_port_ticket(self._net_actuation.get_index()),
        }
        self.declare_topic_output("joint_states", "sensor_msgs/msg/JointState", self._calc_joint_states, prerequisites)
        self.declare_topic_output(
            "dynamic_joint_states",
            "control_msgs/msg/DynamicJointState",
            self._calc_dynamic_joint_states,
            prerequisites,
        )

    def get_state_estimated_output_port(self) -> OutputPort:
        """The port ``state_estimated``."""
        return self.GetOutputPort("state_estimated")

    def get_state_input_port(self) -> InputPort:
        """Return the port ``state``."""
        return self._state

    def get_net_actuation_input_port(self) -> InputPort:
        """Return the port ``net_actuation``."""
        return self._net_actuation

    def get_joint_states_output_port(self) -> OutputPort:
        """Return the port ``joint_states``."""
        return self.GetOutputPort("joint_states")

    def get_dynamic_joint_states_output_port(self) -> OutputPort:
        """Return the port ``dynamic_joint_states``."""
        return self.GetOutputPort("dynamic_joint_states")

    def _values(self, context: Context) -> np.ndarray:
        efforts = self._net_actuation.Eval(context) if self._has_efforts else self._no_efforts
        return np.concatenate((self._state.Eval(context), efforts, _CONSTANTS))

    def _calc_state_estimated(self, context: Context, output: BasicVector) -> None:
        output.SetFromVector(self._state.Eval(context)[self._of_joints])

    def drafter(self, topic: str, places: Sequence[int]) -> Drafter | None:
        """Return what drafts the messages of ``joint_states`` or ``dynamic_joint_states``."""
        make = {"joint_states": self._joint_states, "dynamic_joint_states": self._dynamic_joint_states}[topic]
        indices = np.array(places)
        read = attrgetter("with_efforts" if self._has_efforts else "without_efforts")
        return Drafter(read, lambda values: values[indices], make, len(indices))

    def _calc_joint_states(self, context: Context, output: AbstractValue) -> None:
        set_value(output, self._joint_states(context.get_time(), self._values(context)))

    def _calc_dynamic_joint_states(self, context: Context, output: AbstractValue) -> None:
        set_value(output, self._dynamic_joint_states(context.get_time(), self._values(context)))

    def _joint_states(self, time: float, values: np.ndarray) -> Any:
        of_joints = values[self._gather]
        of_joints.setflags(write=False)  # all subscribers get the same message
        return messages.JointState(messages.header(time, self._frame_id), list(self.joints), *of_joints)

    def _dynamic_joint_states(self, time: float, values: np.ndarray) -> Any:
        if not self._with_dynamic:
            return None
        return messages.DynamicJointState(
            header=messages.header(time, self._frame_id),
            joint_names=list(self._places),
            interface_values=[
                messages.InterfaceValue(interface_names=list(names), values=values[places])
                for names, places in self._places.values()
            ],
        )


def _state_interfaces(description: RobotDescription) -> dict[str, tuple[str, ...]]:
    """Return each joint's state interfaces: those of ``<ros2_control>``, or without it all of each movable joint."""
    movable = [joint.name for joint in description.movable_joints]
    if not description.systems:
        return dict.fromkeys(movable, ("position", "velocity"))
    interfaces = {
        name: tuple(item.name for item in joint.state_interfaces)
        for name, joint in description.controlled_joints.items()
        if name in movable
    }
    return {name: names for name, names in interfaces.items() if names}
