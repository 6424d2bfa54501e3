"""Types of ROS 2 Jazzy's packages: those of the twin's services, and others that programs of users import.

They are kept by the text of their files, and read when one is first asked for.
"""

from drake_twin.messages.gazebo_definitions import GAZEBO
from drake_twin.messages.service_definitions import SERVICES

_ELEMENTS = ("byte", "float32", "float64", "int8", "int16", "int32", "int64", "uint8", "uint16", "uint32", "uint64")


def _example_messages() -> dict[str, str]:
    """Return the messages of ``example_interfaces``, which are those of ``std_msgs``."""
    names = {kind: kind.capitalize().replace("Uint", "UInt") for kind in (*_ELEMENTS, "bool", "char", "string")}
    found = {"Empty": "", **{name: f"{kind} data\n" for kind, name in names.items()}}
    for kind in _ELEMENTS:
        found[f"{names[kind]}MultiArray"] = f"example_interfaces/MultiArrayLayout layout\n{kind}[] data\n"
    return {f"example_interfaces/msg/{name}": text for name, text in found.items()}


# Message, service or action → the text of its file.
PACKAGES = {
    **SERVICES,
    **GAZEBO,
    **_example_messages(),
    "action_tutorials_interfaces/action/Fibonacci": (
        "int32 order\n---\nint32[] sequence\n---\nint32[] partial_sequence\n"
    ),
    "composition_interfaces/srv/ListNodes": "---\nstring[] full_node_names\nuint64[] unique_ids\n",
    "composition_interfaces/srv/LoadNode": (
        "string package_name\nstring plugin_name\nstring node_name\nstring node_namespace\nuint8 log_level\n"
        "string[] remap_rules\nrcl_interfaces/Parameter[] parameters\n"
        "rcl_interfaces/Parameter[] extra_arguments\n---\nbool success\nstring error_message\n"
        "string full_node_name\nuint64 unique_id\n"
    ),
    "composition_interfaces/srv/UnloadNode": "uint64 unique_id\n---\nbool success\nstring error_message\n",
    "control_msgs/action/ExecuteMotionPrimitiveSequence": (
        "control_msgs/MotionPrimitiveSequence trajectory\n---\nint32 SUCCESSFUL=0\nint32 INVALID_GOAL=-1\n"
        "int32 OLD_HEADER_TIMESTAMP=-3\nint32 error_code\nstring error_string\n---\n"
        "uint8 current_primitive_index\n"
    ),
    "control_msgs/action/JointTrajectory": "trajectory_msgs/JointTrajectory trajectory\n---\n---\n",
    "control_msgs/action/PointHead": (
        "geometry_msgs/PointStamped target\ngeometry_msgs/Vector3 pointing_axis\nstring pointing_frame\n"
        "builtin_interfaces/Duration min_duration\nfloat64 max_velocity\n---\n---\nfloat64 pointing_angle_error\n"
    ),
    "control_msgs/action/SingleJointPosition": (
        "float64 position\nbuiltin_interfaces/Duration min_duration\nfloat64 max_velocity\n---\n---\n"
        "std_msgs/Header header\nfloat64 position\nfloat64 velocity\nfloat64 error\n"
    ),
    "control_msgs/msg/DynamicInterfaceValues": (
        "std_msgs/Header header\ncontrol_msgs/InterfaceValue states\ncontrol_msgs/InterfaceValue commands\n"
    ),
    "control_msgs/msg/Float64Values": "std_msgs/Header header\nfloat64[] values\n",
    "control_msgs/msg/JointControllerState": (
        "std_msgs/Header header\nfloat64 set_point\nfloat64 process_value\nfloat64 process_value_dot\n"
        "float64 error\nfloat64 time_step\nfloat64 command\nfloat64 p\nfloat64 i\nfloat64 d\nfloat64 i_clamp\n"
        "bool antiwindup\n"
    ),
    "control_msgs/msg/JointJog": (
        "std_msgs/Header header\nstring[] joint_names\nfloat64[] displacements\nfloat64[] velocities\n"
        "float64 duration\n"
    ),
    "control_msgs/msg/MotionArgument": "string name\nfloat64 value\n",
    "control_msgs/msg/MotionPrimitive": (
        "int8 UNKNOWN=-1\nint8 LINEAR_JOINT=0\nint8 LINEAR_CARTESIAN=50\nint8 CIRCULAR_CARTESIAN=51\n"
        "int8 type -1\nfloat64 blend_radius\ncontrol_msgs/MotionArgument[] additional_arguments\n"
        "geometry_msgs/PoseStamped[] poses\nfloat64[] joint_positions\n"
    ),
    "control_msgs/msg/MotionPrimitiveSequence": "control_msgs/MotionPrimitive[] motions\n",
    "control_msgs/msg/PidState": (
        "std_msgs/Header header\nbuiltin_interfaces/Duration timestep\nfloat64 error\nfloat64 error_dot\n"
        "float64 p_error\nfloat64 i_error\nfloat64 d_error\nfloat64 p_term\nfloat64 i_term\nfloat64 d_term\n"
        "float64 i_max\nfloat64 i_min\nfloat64 output\n"
    ),
    "control_msgs/msg/SingleDOFStateStamped": "std_msgs/Header header\ncontrol_msgs/SingleDOFState dof_state\n",
    "control_msgs/srv/QueryCalibrationState": "---\nbool is_calibrated\n",
    "control_msgs/srv/QueryTrajectoryState": (
        "builtin_interfaces/Time time\n---\nbool success\nstring message\nstring[] name\nfloat64[] position\n"
        "float64[] velocity\nfloat64[] acceleration\n"
    ),
    "control_msgs/srv/SetOdometry": (
        "float64 x\nfloat64 y\nfloat64 z\nfloat64 roll\nfloat64 pitch\nfloat64 yaw\n---\nbool success\nstring message\n"
    ),
    "diagnostic_msgs/srv/AddDiagnostics": "string load_namespace\n---\nbool success\nstring message\n",
    "diagnostic_msgs/srv/SelfTest": "---\nstring id\nbyte passed\ndiagnostic_msgs/DiagnosticStatus[] status\n",
    "example_interfaces/action/Fibonacci": "int32 order\n---\nint32[] sequence\n---\nint32[] sequence\n",
    "example_interfaces/msg/MultiArrayDimension": "string label\nuint32 size\nuint32 stride\n",
    "example_interfaces/msg/MultiArrayLayout": ("example_interfaces/MultiArrayDimension[] dim\nuint32 data_offset\n"),
    "example_interfaces/srv/AddTwoInts": "int64 a\nint64 b\n---\nint64 sum\n",
    "example_interfaces/srv/SetBool": "bool data\n---\nbool success\nstring message\n",
    "example_interfaces/srv/Trigger": "---\nbool success\nstring message\n",
    "lifecycle_msgs/srv/ChangeState": "lifecycle_msgs/Transition transition\n---\nbool success\n",
    "lifecycle_msgs/srv/GetAvailableStates": "---\nlifecycle_msgs/State[] available_states\n",
    "lifecycle_msgs/srv/GetAvailableTransitions": (
        "---\nlifecycle_msgs/TransitionDescription[] available_transitions\n"
    ),
    "lifecycle_msgs/srv/GetState": "---\nlifecycle_msgs/State current_state\n",
    "nav_msgs/srv/GetMap": "---\nnav_msgs/OccupancyGrid map\n",
    "nav_msgs/srv/GetPlan": (
        "geometry_msgs/PoseStamped start\ngeometry_msgs/PoseStamped goal\nfloat32 tolerance\n---\nnav_msgs/Path plan\n"
    ),
    "nav_msgs/srv/LoadMap": (
        "string map_url\n---\nuint8 RESULT_SUCCESS=0\nuint8 RESULT_MAP_DOES_NOT_EXIST=1\n"
        "uint8 RESULT_INVALID_MAP_DATA=2\nuint8 RESULT_INVALID_MAP_METADATA=3\n"
        "uint8 RESULT_UNDEFINED_FAILURE=255\nnav_msgs/OccupancyGrid map\nuint8 result\n"
    ),
    "nav_msgs/srv/SetMap": (
        "nav_msgs/OccupancyGrid map\ngeometry_msgs/PoseWithCovarianceStamped initial_pose\n---\nbool success\n"
    ),
    "rcl_interfaces/srv/GetLoggerLevels": "string[] names\n---\nrcl_interfaces/LoggerLevel[] levels\n",
    "rcl_interfaces/srv/SetLoggerLevels": (
        "rcl_interfaces/LoggerLevel[] levels\n---\nrcl_interfaces/SetLoggerLevelsResult[] results\n"
    ),
    "sensor_msgs/srv/SetCameraInfo": ("sensor_msgs/CameraInfo camera_info\n---\nbool success\nstring status_message\n"),
    "tf2_msgs/action/LookupTransform": (
        "string target_frame\nstring source_frame\nbuiltin_interfaces/Time source_time\n"
        "builtin_interfaces/Duration timeout\nbuiltin_interfaces/Time target_time\nstring fixed_frame\n"
        "bool advanced\n---\ngeometry_msgs/TransformStamped transform\ntf2_msgs/TF2Error error\n---\n"
    ),
    "topic_tools_interfaces/srv/DemuxAdd": "string topic\n---\nbool success\n",
    "topic_tools_interfaces/srv/DemuxDelete": "string topic\n---\nbool success\n",
    "topic_tools_interfaces/srv/DemuxList": "---\nstring[] topics\n",
    "topic_tools_interfaces/srv/DemuxSelect": "string topic\n---\nstring prev_topic\nbool success\n",
    "topic_tools_interfaces/srv/MuxAdd": "string topic\n---\nbool success\n",
    "topic_tools_interfaces/srv/MuxDelete": "string topic\n---\nbool success\n",
    "topic_tools_interfaces/srv/MuxList": "---\nstring[] topics\n",
    "topic_tools_interfaces/srv/MuxSelect": "string topic\n---\nstring prev_topic\nbool success\n",
    "turtlesim/action/RotateAbsolute": "float32 theta\n---\nfloat32 delta\n---\nfloat32 remaining\n",
    "turtlesim/msg/Color": "uint8 r\nuint8 g\nuint8 b\n",
    "turtlesim/msg/Pose": ("float32 x\nfloat32 y\nfloat32 theta\nfloat32 linear_velocity\nfloat32 angular_velocity\n"),
    "turtlesim/srv/Kill": "string name\n---\n",
    "turtlesim/srv/SetPen": "uint8 r\nuint8 g\nuint8 b\nuint8 width\nuint8 off\n---\n",
    "turtlesim/srv/Spawn": "float32 x\nfloat32 y\nfloat32 theta\nstring name\n---\nstring name\n",
    "turtlesim/srv/TeleportAbsolute": "float32 x\nfloat32 y\nfloat32 theta\n---\n",
    "turtlesim/srv/TeleportRelative": "float32 linear\nfloat32 angular\n---\n",
    "visualization_msgs/srv/GetInteractiveMarkers": (
        "---\nuint64 sequence_number\nvisualization_msgs/InteractiveMarker[] markers\n"
    ),
}
