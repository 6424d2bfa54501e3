"""A robot's joint states as messages, as ros2_controllers' joint_state_broadcaster publishes them."""

from collections.abc import Mapping, Sequence

import numpy as np
from pydrake.common.value import AbstractValue
from pydrake.systems.framework import Context, InputPort, LeafSystem, OutputPort

from drake_twin import messages
from drake_twin.systems.state_layout import StateLayout
from drake_twin.systems.weak_callback import weakly

_INTERFACES = ("position", "velocity", "effort")


class JointStatePublisher(LeafSystem):
    """Puts a robot's state into ``JointState`` and ``DynamicJointState`` messages stamped with simulation time.

    Behaves as ``joint_state_broadcaster/JointStateBroadcaster`` in ROS 2 Jazzy: joints in the order of
    ``<ros2_control>``, NaN for what a joint has no state interface for. A robot without ``<ros2_control>`` has all
    interfaces at all its movable joints.

    .. pydrake_system::

        name: JointStatePublisher
        input_ports:
        - state
        - net_actuation
        output_ports:
        - joint_states
        - dynamic_joint_states

    - ``state``: vector ``[q; v]`` of the model instance (rad, rad/s, or m, m/s).
    - ``net_actuation``: vector of the efforts that its actuators applied in the last step (N·m or N).
    - ``joint_states``: ``sensor_msgs/msg/JointState``; topic ``joint_states``.
    - ``dynamic_joint_states``: ``control_msgs/msg/DynamicJointState``; topic ``dynamic_joint_states``.

    Args:
        interfaces: joint name → its state interfaces (``position``, ``velocity``, ``effort``).
        layout: where the joints stand in the input ports.
    """

    def __init__(self, interfaces: Mapping[str, Sequence[str]], layout: StateLayout):
        super().__init__()
        self.joints = tuple(interfaces)
        self._interface_names = [[name for name in names if name in _INTERFACES] for names in interfaces.values()]
        # Rows of gathered values: position, velocity, effort. A missing one points at the NaN behind the last value.
        missing = layout.size + layout.num_actuators
        self._gather = np.full((3, len(self.joints)), missing, dtype=int)
        for column, (joint, names) in enumerate(interfaces.items()):
            if "position" in names:
                self._gather[0, column] = layout.positions[joint]
            if "velocity" in names:
                self._gather[1, column] = layout.velocities[joint]
            if "effort" in names and joint in layout.efforts:
                self._gather[2, column] = layout.size + layout.efforts[joint]
        self._state = self.DeclareVectorInputPort("state", layout.size)
        self._net_actuation = self.DeclareVectorInputPort("net_actuation", layout.num_actuators)
        prerequisites = {
            self.time_ticket(),
            self.input_port_ticket(self._state.get_index()),
            self.input_port_ticket(self._net_actuation.get_index()),
        }
        self._joint_states = self.DeclareAbstractOutputPort(
            "joint_states", lambda: AbstractValue.Make(None), weakly(self._calc_joint_states), prerequisites
        )
        self._dynamic_joint_states = self.DeclareAbstractOutputPort(
            "dynamic_joint_states",
            lambda: AbstractValue.Make(None),
            weakly(self._calc_dynamic_joint_states),
            prerequisites,
        )

    def get_state_input_port(self) -> InputPort:
        """The port ``state``."""
        return self._state

    def get_net_actuation_input_port(self) -> InputPort:
        """The port ``net_actuation``."""
        return self._net_actuation

    def get_joint_states_output_port(self) -> OutputPort:
        """The port ``joint_states``."""
        return self._joint_states

    def get_dynamic_joint_states_output_port(self) -> OutputPort:
        """The port ``dynamic_joint_states``."""
        return self._dynamic_joint_states

    def _values(self, context: Context) -> np.ndarray:
        """Three rows (position, velocity, effort), a column for each joint."""
        values = np.concatenate([self._state.Eval(context), self._net_actuation.Eval(context), [np.nan]])
        return np.asarray(values[self._gather])

    def _calc_joint_states(self, context: Context, output: AbstractValue) -> None:
        values = self._values(context)
        values.setflags(write=False)  # the port hands the same message to everybody
        position, velocity, effort = values
        output.set_value(
            messages.JointState(
                header=messages.header(context.get_time()),
                name=list(self.joints),
                position=position,
                velocity=velocity,
                effort=effort,
            )
        )

    def _calc_dynamic_joint_states(self, context: Context, output: AbstractValue) -> None:
        columns = self._values(context).T
        interface_values = [
            messages.InterfaceValue(
                interface_names=list(names), values=np.array([column[_INTERFACES.index(name)] for name in names])
            )
            for names, column in zip(self._interface_names, columns, strict=True)
        ]
        output.set_value(
            messages.DynamicJointState(
                header=messages.header(context.get_time()),
                joint_names=list(self.joints),
                interface_values=interface_values,
            )
        )
