"""Types of Gazebo's packages that the twin itself does not use, by the text of their files.

``gazebo_msgs`` is that of Gazebo classic, ``ros_gz_interfaces`` that of ROS 2 Jazzy.
"""

GAZEBO = {
    "gazebo_msgs/msg/LinkState": (
        "string link_name\ngeometry_msgs/Pose pose\ngeometry_msgs/Twist twist\nstring reference_frame\n"
    ),
    "gazebo_msgs/msg/ModelState": (
        "string model_name\ngeometry_msgs/Pose pose\ngeometry_msgs/Twist twist\nstring reference_frame\n"
    ),
    "gazebo_msgs/msg/ODEJointProperties": (
        "float64[] damping\nfloat64[] hi_stop\nfloat64[] lo_stop\nfloat64[] erp\nfloat64[] cfm\n"
        "float64[] stop_erp\nfloat64[] stop_cfm\nfloat64[] fudge_factor\nfloat64[] fmax\nfloat64[] vel\n"
    ),
    "gazebo_msgs/msg/ODEPhysics": (
        "bool auto_disable_bodies\nuint32 sor_pgs_precon_iters\nuint32 sor_pgs_iters\nfloat64 sor_pgs_w\n"
        "float64 sor_pgs_rms_error_tol\nfloat64 contact_surface_layer\nfloat64 contact_max_correcting_vel\n"
        "float64 cfm\nfloat64 erp\nuint32 max_contacts\n"
    ),
    "gazebo_msgs/msg/PerformanceMetrics": (
        "std_msgs/Header header\nfloat64 real_time_factor\ngazebo_msgs/SensorPerformanceMetric[] sensors\n"
    ),
    "gazebo_msgs/msg/SensorPerformanceMetric": (
        "string name\nfloat64 sim_update_rate\nfloat64 real_update_rate\nfloat64 fps\n"
    ),
    "gazebo_msgs/msg/WheelSlip": "string[] name\nfloat64[] lateral_slip\nfloat64[] longitudinal_slip\n",
    "gazebo_msgs/msg/WorldState": (
        "std_msgs/Header header\nstring[] name\ngeometry_msgs/Pose[] pose\ngeometry_msgs/Twist[] twist\n"
        "geometry_msgs/Wrench[] wrench\n"
    ),
    "gazebo_msgs/srv/ApplyBodyWrench": (
        "string body_name\nstring reference_frame\ngeometry_msgs/Point reference_point\n"
        "geometry_msgs/Wrench wrench\nbuiltin_interfaces/Time start_time\nbuiltin_interfaces/Duration duration\n"
        "---\nbool success\nstring status_message\n"
    ),
    "gazebo_msgs/srv/ApplyJointEffort": (
        "string joint_name\nfloat64 effort\nbuiltin_interfaces/Time start_time\n"
        "builtin_interfaces/Duration duration\n---\nbool success\nstring status_message\n"
    ),
    "gazebo_msgs/srv/ApplyLinkWrench": (
        "string link_name\nstring reference_frame\ngeometry_msgs/Point reference_point\n"
        "geometry_msgs/Wrench wrench\nbuiltin_interfaces/Time start_time\nbuiltin_interfaces/Duration duration\n"
        "---\nbool success\nstring status_message\n"
    ),
    "gazebo_msgs/srv/BodyRequest": "string body_name\n---\n",
    "gazebo_msgs/srv/DeleteLight": "string light_name\n---\nbool success\nstring status_message\n",
    "gazebo_msgs/srv/DeleteModel": "string model_name\n---\nbool success\nstring status_message\n",
    "gazebo_msgs/srv/GetJointProperties": (
        "string joint_name\n---\nuint8 type\nuint8 REVOLUTE=0\nuint8 CONTINUOUS=1\nuint8 PRISMATIC=2\n"
        "uint8 FIXED=3\nuint8 BALL=4\nuint8 UNIVERSAL=5\nfloat64[] damping\nfloat64[] position\nfloat64[] rate\n"
        "bool success\nstring status_message\n"
    ),
    "gazebo_msgs/srv/GetLightProperties": (
        "string light_name\n---\nstd_msgs/ColorRGBA diffuse\nfloat64 attenuation_constant\n"
        "float64 attenuation_linear\nfloat64 attenuation_quadratic\nbool success\nstring status_message\n"
    ),
    "gazebo_msgs/srv/GetLinkProperties": (
        "string link_name\n---\ngeometry_msgs/Pose com\nbool gravity_mode\nfloat64 mass\nfloat64 ixx\n"
        "float64 ixy\nfloat64 ixz\nfloat64 iyy\nfloat64 iyz\nfloat64 izz\nbool success\nstring status_message\n"
    ),
    "gazebo_msgs/srv/GetLinkState": (
        "string link_name\nstring reference_frame\n---\ngazebo_msgs/LinkState link_state\nbool success\n"
        "string status_message\n"
    ),
    "gazebo_msgs/srv/GetModelProperties": (
        "string model_name\n---\nstring parent_model_name\nstring canonical_body_name\nstring[] body_names\n"
        "string[] geom_names\nstring[] joint_names\nstring[] child_model_names\nbool is_static\nbool success\n"
        "string status_message\n"
    ),
    "gazebo_msgs/srv/GetModelState": (
        "string model_name\nstring relative_entity_name\n---\nstd_msgs/Header header\ngeometry_msgs/Pose pose\n"
        "geometry_msgs/Twist twist\nbool success\nstring status_message\n"
    ),
    "gazebo_msgs/srv/GetPhysicsProperties": (
        "---\nfloat64 time_step\nbool pause\nfloat64 max_update_rate\ngeometry_msgs/Vector3 gravity\n"
        "gazebo_msgs/ODEPhysics ode_config\nbool success\nstring status_message\n"
    ),
    "gazebo_msgs/srv/GetWorldProperties": (
        "---\nfloat64 sim_time\nstring[] model_names\nbool rendering_enabled\nbool success\nstring status_message\n"
    ),
    "gazebo_msgs/srv/JointRequest": "string joint_name\n---\n",
    "gazebo_msgs/srv/LinkRequest": "string link_name\n---\n",
    "gazebo_msgs/srv/SetJointProperties": (
        "string joint_name\ngazebo_msgs/ODEJointProperties ode_joint_config\n---\nbool success\nstring status_message\n"
    ),
    "gazebo_msgs/srv/SetJointTrajectory": (
        "string model_name\ntrajectory_msgs/JointTrajectory joint_trajectory\ngeometry_msgs/Pose model_pose\n"
        "bool set_model_pose\nbool disable_physics_updates\n---\nbool success\nstring status_message\n"
    ),
    "gazebo_msgs/srv/SetLightProperties": (
        "string light_name\nstd_msgs/ColorRGBA diffuse\nfloat64 attenuation_constant\n"
        "float64 attenuation_linear\nfloat64 attenuation_quadratic\n---\nbool success\nstring status_message\n"
    ),
    "gazebo_msgs/srv/SetLinkProperties": (
        "string link_name\ngeometry_msgs/Pose com\nbool gravity_mode\nfloat64 mass\nfloat64 ixx\nfloat64 ixy\n"
        "float64 ixz\nfloat64 iyy\nfloat64 iyz\nfloat64 izz\n---\nbool success\nstring status_message\n"
    ),
    "gazebo_msgs/srv/SetLinkState": "gazebo_msgs/LinkState link_state\n---\nbool success\nstring status_message\n",
    "gazebo_msgs/srv/SetModelConfiguration": (
        "string model_name\nstring urdf_param_name\nstring[] joint_names\nfloat64[] joint_positions\n---\n"
        "bool success\nstring status_message\n"
    ),
    "gazebo_msgs/srv/SetModelState": ("gazebo_msgs/ModelState model_state\n---\nbool success\nstring status_message\n"),
    "gazebo_msgs/srv/SetPhysicsProperties": (
        "float64 time_step\nfloat64 max_update_rate\ngeometry_msgs/Vector3 gravity\n"
        "gazebo_msgs/ODEPhysics ode_config\n---\nbool success\nstring status_message\n"
    ),
    "gazebo_msgs/srv/SpawnModel": (
        "string model_name\nstring model_xml\nstring robot_namespace\ngeometry_msgs/Pose initial_pose\n"
        "string reference_frame\n---\nbool success\nstring status_message\n"
    ),
    "ros_gz_interfaces/msg/Dataframe": (
        "std_msgs/Header header\nstring src_address\nstring dst_address\nuint8[] data\nfloat64 rssi\n"
    ),
    "ros_gz_interfaces/msg/EntityWrench": (
        "std_msgs/Header header\nros_gz_interfaces/Entity entity\ngeometry_msgs/Wrench wrench\n"
    ),
    "ros_gz_interfaces/msg/Float32Array": "float32[] data\n",
    "ros_gz_interfaces/msg/GuiCamera": (
        "std_msgs/Header header\nstring name\nstring view_controller\ngeometry_msgs/Pose pose\n"
        "ros_gz_interfaces/TrackVisual track\nstring projection_type\n"
    ),
    "ros_gz_interfaces/msg/Light": (
        "std_msgs/Header header\nstring name\nuint8 POINT=0\nuint8 SPOT=1\nuint8 DIRECTIONAL=2\nuint8 type\n"
        "geometry_msgs/Pose pose\nstd_msgs/ColorRGBA diffuse\nstd_msgs/ColorRGBA specular\n"
        "float32 attenuation_constant\nfloat32 attenuation_linear\nfloat32 attenuation_quadratic\n"
        "geometry_msgs/Vector3 direction\nfloat32 range\nbool cast_shadows\nfloat32 spot_inner_angle\n"
        "float32 spot_outer_angle\nfloat32 spot_falloff\nuint32 id\nuint32 parent_id\nfloat32 intensity\n"
    ),
    "ros_gz_interfaces/msg/MaterialColor": (
        "uint8 FIRST=0\nuint8 ALL=1\nstd_msgs/Header header\nros_gz_interfaces/Entity entity\n"
        "std_msgs/ColorRGBA ambient\nstd_msgs/ColorRGBA diffuse\nstd_msgs/ColorRGBA specular\n"
        "std_msgs/ColorRGBA emissive\nfloat64 shininess\nuint8 entity_match\n"
    ),
    "ros_gz_interfaces/msg/ParamVec": "std_msgs/Header header\nrcl_interfaces/Parameter[] params\n",
    "ros_gz_interfaces/msg/SensorNoise": (
        "uint8 NONE=0\nuint8 GAUSSIAN=2\nuint8 GAUSSIAN_QUANTIZED=3\nstd_msgs/Header header\nuint8 type\n"
        "float64 mean\nfloat64 stddev\nfloat64 bias_mean\nfloat64 bias_stddev\nfloat64 precision\n"
        "float64 dynamic_bias_stddev\nfloat64 dynamic_bias_correlation_time\n"
    ),
    "ros_gz_interfaces/msg/StringVec": "std_msgs/Header header\nstring[] data\n",
    "ros_gz_interfaces/msg/TrackVisual": (
        "std_msgs/Header header\nstring name\nuint32 id\nbool inherit_orientation\nfloat64 min_dist\n"
        "float64 max_dist\nbool is_static\nbool use_model_frame\ngeometry_msgs/Vector3 xyz\nbool inherit_yaw\n"
    ),
    "ros_gz_interfaces/msg/VideoRecord": (
        "std_msgs/Header header\nbool start\nbool stop\nstring format\nstring save_filename\n"
    ),
}
