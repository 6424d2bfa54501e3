"""Message types as in ROS 2 Jazzy: ``messages.JointState``, ``messages.TFMessage``, …

They are the dataclasses of rosbags' type store (NumPy arrays for numeric sequences), so a message goes to a bag or to
a wire as it is. The store is loaded at the first use of a type, because a twin that nobody listens to needs none.
Types that the store lacks are defined here by the text of their ``.msg`` file.
"""

from functools import cache
from typing import Any

_STORE_TYPES = {
    name.rpartition("/")[2]: name
    for name in (
        "builtin_interfaces/msg/Time",
        "geometry_msgs/msg/Point",
        "geometry_msgs/msg/Pose",
        "geometry_msgs/msg/PoseWithCovariance",
        "geometry_msgs/msg/Quaternion",
        "geometry_msgs/msg/Transform",
        "geometry_msgs/msg/TransformStamped",
        "geometry_msgs/msg/Twist",
        "geometry_msgs/msg/TwistWithCovariance",
        "geometry_msgs/msg/Vector3",
        "geometry_msgs/msg/Wrench",
        "geometry_msgs/msg/WrenchStamped",
        "nav_msgs/msg/Odometry",
        "rosgraph_msgs/msg/Clock",
        "sensor_msgs/msg/Imu",
        "sensor_msgs/msg/JointState",
        "std_msgs/msg/Float64MultiArray",
        "std_msgs/msg/Header",
        "std_msgs/msg/MultiArrayDimension",
        "std_msgs/msg/MultiArrayLayout",
        "std_msgs/msg/String",
        "tf2_msgs/msg/TFMessage",
    )
}

_OWN_TYPES = {
    "control_msgs/msg/InterfaceValue": "string[] interface_names\nfloat64[] values\n",
    "control_msgs/msg/DynamicJointState": (
        "std_msgs/Header header\nstring[] joint_names\ncontrol_msgs/InterfaceValue[] interface_values\n"
    ),
    "control_msgs/msg/MultiDOFCommand": "string[] dof_names\nfloat64[] values\nfloat64[] values_dot\n",
    "control_msgs/msg/SingleDOFState": (
        "string name\nfloat64 reference\nfloat64 feedback\nfloat64 feedback_dot\nfloat64 error\nfloat64 error_dot\n"
        "float64 time_step\nfloat64 output\n"
    ),
    "control_msgs/msg/MultiDOFStateStamped": "std_msgs/Header header\ncontrol_msgs/SingleDOFState[] dof_states\n",
    "control_msgs/msg/GripperCommand": "float64 position\nfloat64 max_effort\n",
    "control_msgs/action/GripperCommand_Goal": "control_msgs/GripperCommand command\n",
    "control_msgs/action/GripperCommand_Result": "float64 position\nfloat64 effort\nbool stalled\nbool reached_goal\n",
    "control_msgs/action/GripperCommand_Feedback": (
        "float64 position\nfloat64 effort\nbool stalled\nbool reached_goal\n"
    ),
    "control_msgs/action/ParallelGripperCommand_Goal": "sensor_msgs/JointState command\n",
    "control_msgs/action/ParallelGripperCommand_Result": (
        "sensor_msgs/JointState state\nbool stalled\nbool reached_goal\n"
    ),
    "control_msgs/action/ParallelGripperCommand_Feedback": "sensor_msgs/JointState state\n",
}

_TYPES = _STORE_TYPES | {name.rpartition("/")[2]: name for name in _OWN_TYPES}


@cache
def type_store() -> Any:
    """The rosbags ``Typestore`` of ROS 2 Jazzy with the types defined here added."""
    from rosbags.typesys import Stores, get_types_from_msg, get_typestore

    store = get_typestore(Stores.ROS2_JAZZY)
    for name, text in _OWN_TYPES.items():
        store.register(get_types_from_msg(text, name))
    return store


def __getattr__(name: str) -> Any:
    if name not in _TYPES:
        raise AttributeError(f"drake_twin.messages has no message type {name!r}; it has {', '.join(sorted(_TYPES))}")
    message_type = type_store().types[_TYPES[name]]
    globals()[name] = message_type
    return message_type


def time_message(seconds: float) -> Any:
    """Simulation time (s) as a ``builtin_interfaces/msg/Time``, rounded to the nearest nanosecond."""
    nanoseconds = round(seconds * 1e9)
    return _message("Time")(sec=nanoseconds // 1_000_000_000, nanosec=nanoseconds % 1_000_000_000)


def header(seconds: float, frame_id: str = "") -> Any:
    """A ``std_msgs/msg/Header`` stamped with a simulation time (s)."""
    return _message("Header")(stamp=time_message(seconds), frame_id=frame_id)


def float64_multi_array(values: Any) -> Any:
    """Numbers as a ``std_msgs/msg/Float64MultiArray`` without layout, as controllers are commanded."""
    import numpy as np

    layout = _message("MultiArrayLayout")(dim=[], data_offset=0)
    return _message("Float64MultiArray")(layout=layout, data=np.array(values, dtype=float))


def _message(name: str) -> Any:
    return globals().get(name) or __getattr__(name)
