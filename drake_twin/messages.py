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
        "geometry_msgs/msg/TwistStamped",
        "geometry_msgs/msg/TwistWithCovariance",
        "geometry_msgs/msg/Vector3",
        "nav_msgs/msg/Odometry",
        "rosgraph_msgs/msg/Clock",
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
    "ackermann_msgs/msg/AckermannDrive": (
        "float32 steering_angle\nfloat32 steering_angle_velocity\nfloat32 speed\nfloat32 acceleration\nfloat32 jerk\n"
    ),
    "control_msgs/msg/InterfaceValue": "string[] interface_names\nfloat64[] values\n",
    "control_msgs/msg/DynamicJointState": (
        "std_msgs/Header header\nstring[] joint_names\ncontrol_msgs/InterfaceValue[] interface_values\n"
    ),
    "control_msgs/msg/MecanumDriveControllerState": (
        "std_msgs/Header header\nfloat64 front_left_wheel_velocity\nfloat64 back_left_wheel_velocity\n"
        "float64 back_right_wheel_velocity\nfloat64 front_right_wheel_velocity\n"
        "geometry_msgs/Twist reference_velocity\n"
    ),
    "control_msgs/msg/SteeringControllerStatus": (
        "std_msgs/Header header\nfloat64[] traction_wheels_position\nfloat64[] traction_wheels_velocity\n"
        "float64[] steer_positions\nfloat64[] linear_velocity_command\nfloat64[] steering_angle_command\n"
    ),
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
