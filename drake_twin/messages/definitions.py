"""ROS 2 message types that rosbags' type store lacks, by the text of their ``.msg`` files."""

DEFINITIONS = {
    "actuator_msgs/msg/Actuators": (
        "std_msgs/Header header\nfloat64[] position\nfloat64[] velocity\nfloat64[] normalized\n"
    ),
    "gazebo_msgs/msg/ContactState": (
        "string info\nstring collision1_name\nstring collision2_name\n"
        "geometry_msgs/Wrench[] wrenches\ngeometry_msgs/Wrench total_wrench\n"
        "geometry_msgs/Vector3[] contact_positions\ngeometry_msgs/Vector3[] contact_normals\nfloat64[] depths\n"
    ),
    "gazebo_msgs/msg/ContactsState": "std_msgs/Header header\ngazebo_msgs/ContactState[] states\n",
    "ros_gz_interfaces/msg/Altimeter": (
        "std_msgs/Header header\nfloat64 vertical_position\nfloat64 vertical_velocity\nfloat64 vertical_reference\n"
    ),
    "ros_gz_interfaces/msg/Entity": (
        "uint8 NONE=0\nuint8 LIGHT=1\nuint8 MODEL=2\nuint8 LINK=3\nuint8 VISUAL=4\nuint8 COLLISION=5\n"
        "uint8 SENSOR=6\nuint8 JOINT=7\nuint64 id\nstring name\nuint8 type\n"
    ),
    "ros_gz_interfaces/msg/JointWrench": (
        "std_msgs/Header header\nstd_msgs/String body_1_name\nstd_msgs/UInt32 body_1_id\n"
        "std_msgs/String body_2_name\nstd_msgs/UInt32 body_2_id\n"
        "geometry_msgs/Wrench body_1_wrench\ngeometry_msgs/Wrench body_2_wrench\n"
    ),
    "ros_gz_interfaces/msg/Contact": (
        "ros_gz_interfaces/Entity collision1\nros_gz_interfaces/Entity collision2\n"
        "geometry_msgs/Vector3[] positions\ngeometry_msgs/Vector3[] normals\nfloat64[] depths\n"
        "ros_gz_interfaces/JointWrench[] wrenches\n"
    ),
    "ros_gz_interfaces/msg/Contacts": "std_msgs/Header header\nros_gz_interfaces/Contact[] contacts\n",
    "ros_gz_interfaces/msg/LogicalCameraImage": (
        "std_msgs/Header header\ngeometry_msgs/Pose pose\nros_gz_interfaces/LogicalCameraImageModel[] model\n"
    ),
    "ros_gz_interfaces/msg/LogicalCameraImageModel": "string name\ngeometry_msgs/Pose pose\n",
    "gazebo_msgs/msg/LinkStates": "string[] name\ngeometry_msgs/Pose[] pose\ngeometry_msgs/Twist[] twist\n",
    "gazebo_msgs/msg/ModelStates": "string[] name\ngeometry_msgs/Pose[] pose\ngeometry_msgs/Twist[] twist\n",
    "control_msgs/action/FollowJointTrajectory_Feedback": (
        "std_msgs/Header header\nstring[] joint_names\n"
        "trajectory_msgs/JointTrajectoryPoint desired\n"
        "trajectory_msgs/JointTrajectoryPoint actual\n"
        "trajectory_msgs/JointTrajectoryPoint error\n"
        "string[] multi_dof_joint_names\n"
        "trajectory_msgs/MultiDOFJointTrajectoryPoint multi_dof_desired\n"
        "trajectory_msgs/MultiDOFJointTrajectoryPoint multi_dof_actual\n"
        "trajectory_msgs/MultiDOFJointTrajectoryPoint multi_dof_error\n"
    ),
    "control_msgs/action/FollowJointTrajectory_Goal": (
        "trajectory_msgs/JointTrajectory trajectory\n"
        "trajectory_msgs/MultiDOFJointTrajectory multi_dof_trajectory\n"
        "control_msgs/JointTolerance[] path_tolerance\n"
        "control_msgs/JointComponentTolerance[] component_path_tolerance\n"
        "control_msgs/JointTolerance[] goal_tolerance\n"
        "control_msgs/JointComponentTolerance[] component_goal_tolerance\n"
        "builtin_interfaces/Duration goal_time_tolerance\n"
    ),
    "control_msgs/action/FollowJointTrajectory_Result": (
        "int32 error_code\n"
        "int32 SUCCESSFUL = 0\n"
        "int32 INVALID_GOAL = -1\n"
        "int32 INVALID_JOINTS = -2\n"
        "int32 OLD_HEADER_TIMESTAMP = -3\n"
        "int32 PATH_TOLERANCE_VIOLATED = -4\n"
        "int32 GOAL_TOLERANCE_VIOLATED = -5\n"
        "string error_string\n"
    ),
    "control_msgs/msg/AdmittanceControllerState": (
        "std_msgs/Float64MultiArray mass\nstd_msgs/Float64MultiArray damping\nstd_msgs/Float64MultiArray stiffness\n"
        "geometry_msgs/Quaternion rot_base_control\n"
        "geometry_msgs/TransformStamped ref_trans_base_ft\n"
        "std_msgs/Int8MultiArray selected_axes\nstd_msgs/String ft_sensor_frame\n"
        "geometry_msgs/TransformStamped admittance_position\n"
        "geometry_msgs/TwistStamped admittance_acceleration\n"
        "geometry_msgs/TwistStamped admittance_velocity\n"
        "geometry_msgs/WrenchStamped wrench_base\n"
        "sensor_msgs/JointState joint_state\n"
    ),
    "control_msgs/msg/BatteryStateArray": "sensor_msgs/BatteryState[] battery_states\n",
    "ackermann_msgs/msg/AckermannDrive": (
        "float32 steering_angle\nfloat32 steering_angle_velocity\nfloat32 speed\nfloat32 acceleration\nfloat32 jerk\n"
    ),
    "control_msgs/msg/InterfaceValue": "string[] interface_names\nfloat64[] values\n",
    "control_msgs/msg/DynamicJointState": (
        "std_msgs/Header header\nstring[] joint_names\ncontrol_msgs/InterfaceValue[] interface_values\n"
    ),
    "control_msgs/msg/DynamicInterfaceGroupValues": (
        "std_msgs/Header header\nstring[] interface_groups\ncontrol_msgs/InterfaceValue[] interface_values\n"
    ),
    "control_msgs/msg/JointComponentTolerance": (
        "uint16 X_AXIS=1\nuint16 Y_AXIS=2\nuint16 Z_AXIS=3\nuint16 TRANSLATION=4\nuint16 ROTATION=5\n"
        "string joint_name\nuint16 component\nfloat64 position\nfloat64 velocity\nfloat64 acceleration\n"
    ),
    "control_msgs/msg/JointTolerance": ("string name\nfloat64 position\nfloat64 velocity\nfloat64 acceleration\n"),
    "control_msgs/msg/JointTrajectoryControllerState": (
        "std_msgs/Header header\nstring[] joint_names\n"
        "trajectory_msgs/JointTrajectoryPoint reference\n"
        "trajectory_msgs/JointTrajectoryPoint feedback\n"
        "trajectory_msgs/JointTrajectoryPoint error\n"
        "trajectory_msgs/JointTrajectoryPoint output\n"
        "string[] multi_dof_joint_names\n"
        "trajectory_msgs/MultiDOFJointTrajectoryPoint multi_dof_reference\n"
        "trajectory_msgs/MultiDOFJointTrajectoryPoint multi_dof_feedback\n"
        "trajectory_msgs/MultiDOFJointTrajectoryPoint multi_dof_error\n"
        "trajectory_msgs/MultiDOFJointTrajectoryPoint multi_dof_output\n"
        "float64 speed_scaling_factor\n"
    ),
    "control_msgs/msg/SpeedScalingFactor": "float64 factor\n",
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
