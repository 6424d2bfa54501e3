"""ROS 2 services and actions that the twin offers, and the messages that they need, by the text of their files.

They are those of ROS 2 Jazzy; ``gazebo_msgs`` is that of Gazebo classic.
"""

# Message, service or action → the text of its file.
SERVICES = {
    "controller_manager_msgs/msg/ChainConnection": "string name\nstring[] reference_interfaces\n",
    "controller_manager_msgs/msg/ControllerState": (
        "string name\nstring state\nstring type\nbool is_async\nuint16 update_rate\nstring[] claimed_interfaces\n"
        "string[] required_command_interfaces\nstring[] required_state_interfaces\nbool is_chainable\nbool is_chained\n"
        "string[] exported_state_interfaces\nstring[] reference_interfaces\n"
        "controller_manager_msgs/ChainConnection[] chain_connections\n"
    ),
    "controller_manager_msgs/msg/HardwareComponentState": (
        "string name\nstring type\nbool is_async\nuint16 rw_rate\nstring class_type\nstring plugin_name\n"
        "lifecycle_msgs/State state\ncontroller_manager_msgs/HardwareInterface[] command_interfaces\n"
        "controller_manager_msgs/HardwareInterface[] state_interfaces\n"
    ),
    "controller_manager_msgs/msg/HardwareInterface": (
        "string name\nstring data_type\nbool is_available\nbool is_claimed\n"
    ),
    "gazebo_msgs/msg/EntityState": (
        "string name\ngeometry_msgs/Pose pose\ngeometry_msgs/Twist twist\nstring reference_frame\n"
    ),
    "ros_gz_interfaces/msg/EntityFactory": (
        "string name\nbool allow_renaming\nstring sdf\nstring sdf_filename\nstring clone_name\n"
        'geometry_msgs/Pose pose\nstring relative_to "world"\n'
    ),
    "ros_gz_interfaces/msg/WorldControl": (
        "bool pause\nbool step\nuint32 multi_step\nros_gz_interfaces/WorldReset reset\nuint32 seed\n"
        "builtin_interfaces/Time run_to_sim_time\n"
    ),
    "ros_gz_interfaces/msg/WorldReset": "bool all\nbool time_only\nbool model_only\n",
    "simulation_interfaces/msg/Bounds": (
        "uint8 TYPE_EMPTY=0\nuint8 TYPE_BOX=1\nuint8 TYPE_CONVEX_HULL=2\nuint8 TYPE_SPHERE=3\nuint8 type\n"
        "geometry_msgs/Vector3[] points\n"
    ),
    "simulation_interfaces/msg/EntityCategory": (
        "uint8 CATEGORY_OBJECT=0\nuint8 CATEGORY_ROBOT=1\nuint8 CATEGORY_HUMAN=2\nuint8 CATEGORY_DYNAMIC_OBJECT=4\n"
        "uint8 CATEGORY_STATIC_OBJECT=5\nuint8 category\n"
    ),
    "simulation_interfaces/msg/EntityFilters": (
        "string filter\nsimulation_interfaces/EntityCategory[] categories\nsimulation_interfaces/TagsFilter tags\n"
        "simulation_interfaces/Bounds bounds\n"
    ),
    "simulation_interfaces/msg/EntityState": (
        "std_msgs/Header header\ngeometry_msgs/Pose pose\ngeometry_msgs/Twist twist\ngeometry_msgs/Accel acceleration\n"
    ),
    "simulation_interfaces/msg/Result": (
        "uint8 RESULT_FEATURE_UNSUPPORTED=0\nuint8 RESULT_OK=1\nuint8 RESULT_NOT_FOUND=2\n"
        "uint8 RESULT_INCORRECT_STATE=3\nuint8 RESULT_OPERATION_FAILED=4\nuint8 result\nstring error_message\n"
    ),
    "simulation_interfaces/msg/SimulationState": (
        "uint8 STATE_STOPPED=0\nuint8 STATE_PLAYING=1\nuint8 STATE_PAUSED=2\nuint8 STATE_QUITTING=3\n"
        "uint8 STATE_NO_WORLD=4\nuint8 STATE_LOADING_WORLD=5\nuint8 state\n"
    ),
    "simulation_interfaces/msg/SimulatorFeatures": (
        "uint8 SPAWNING=0\nuint8 DELETING=1\nuint8 NAMED_POSES=2\nuint8 POSE_BOUNDS=3\nuint8 ENTITY_TAGS=4\n"
        "uint8 ENTITY_BOUNDS=5\nuint8 ENTITY_BOUNDS_BOX=6\nuint8 ENTITY_BOUNDS_CONVEX=7\nuint8 ENTITY_CATEGORIES=8\n"
        "uint8 SPAWNING_RESOURCE_STRING=9\nuint8 ENTITY_STATE_GETTING=10\nuint8 ENTITY_STATE_SETTING=11\n"
        "uint8 ENTITY_INFO_GETTING=12\nuint8 ENTITY_INFO_SETTING=13\nuint8 SPAWNABLES=14\nuint8 SIMULATION_RESET=20\n"
        "uint8 SIMULATION_RESET_TIME=21\nuint8 SIMULATION_RESET_STATE=22\nuint8 SIMULATION_RESET_SPAWNED=23\n"
        "uint8 SIMULATION_STATE_GETTING=24\nuint8 SIMULATION_STATE_SETTING=25\nuint8 SIMULATION_STATE_PAUSE=26\n"
        "uint8 STEP_SIMULATION_SINGLE=31\nuint8 STEP_SIMULATION_MULTIPLE=32\nuint8 STEP_SIMULATION_ACTION=33\n"
        "uint8 WORLD_LOADING=40\nuint8 WORLD_RESOURCE_STRING=41\nuint8 WORLD_TAGS=42\nuint8 WORLD_UNLOADING=43\n"
        "uint8 WORLD_INFO_GETTING=44\nuint8 AVAILABLE_WORLDS=45\nuint8 SPAWNING_ENTITIES=50\nuint16[] features\n"
        "string[] spawn_formats\nstring custom_info\n"
    ),
    "simulation_interfaces/msg/Spawnable": (
        "string uri\nstring description\nsimulation_interfaces/Bounds spawn_bounds\n"
    ),
    "simulation_interfaces/msg/TagsFilter": (
        "string[] tags\nuint8 FILTER_MODE_ANY=0\nuint8 FILTER_MODE_ALL=1\nuint8 filter_mode\n"
    ),
    "action_msgs/srv/CancelGoal": (
        "action_msgs/GoalInfo goal_info\n---\nint8 ERROR_NONE=0\nint8 ERROR_REJECTED=1\nint8 ERROR_UNKNOWN_GOAL_ID=2\n"
        "int8 ERROR_GOAL_TERMINATED=3\nint8 return_code\naction_msgs/GoalInfo[] goals_canceling\n"
    ),
    "controller_manager_msgs/srv/ConfigureController": "string name\n---\nbool ok\n",
    "controller_manager_msgs/srv/ListControllerTypes": "---\nstring[] types\nstring[] base_classes\n",
    "controller_manager_msgs/srv/ListControllers": "---\ncontroller_manager_msgs/ControllerState[] controller\n",
    "controller_manager_msgs/srv/ListHardwareComponents": (
        "---\ncontroller_manager_msgs/HardwareComponentState[] component\n"
    ),
    "controller_manager_msgs/srv/ListHardwareInterfaces": (
        "---\ncontroller_manager_msgs/HardwareInterface[] command_interfaces\n"
        "controller_manager_msgs/HardwareInterface[] state_interfaces\n"
    ),
    "controller_manager_msgs/srv/LoadController": "string name\n---\nbool ok\n",
    "controller_manager_msgs/srv/ReloadControllerLibraries": "bool force_kill\n---\nbool ok\n",
    "controller_manager_msgs/srv/SwitchController": (
        "string[] activate_controllers\nstring[] deactivate_controllers\nint32 strictness\nint32 BEST_EFFORT=1\n"
        "int32 STRICT=2\nint32 AUTO=3\nint32 FORCE_AUTO=4\nbool activate_asap\nbuiltin_interfaces/Duration timeout\n"
        "---\nbool ok\nstring message\n"
    ),
    "controller_manager_msgs/srv/UnloadController": "string name\n---\nbool ok\n",
    "gazebo_msgs/srv/DeleteEntity": "string name\n---\nbool success\nstring status_message\n",
    "gazebo_msgs/srv/GetEntityState": (
        "string name\nstring reference_frame\n---\nstd_msgs/Header header\ngazebo_msgs/EntityState state\n"
        "bool success\n"
    ),
    "gazebo_msgs/srv/GetModelList": "---\nstd_msgs/Header header\nstring[] model_names\nbool success\n",
    "gazebo_msgs/srv/SetEntityState": "gazebo_msgs/EntityState state\n---\nbool success\n",
    "gazebo_msgs/srv/SpawnEntity": (
        "string name\nstring xml\nstring robot_namespace\ngeometry_msgs/Pose initial_pose\nstring reference_frame\n"
        "---\nbool success\nstring status_message\n"
    ),
    "rcl_interfaces/srv/DescribeParameters": "string[] names\n---\nrcl_interfaces/ParameterDescriptor[] descriptors\n",
    "rcl_interfaces/srv/GetParameterTypes": "string[] names\n---\nuint8[] types\n",
    "rcl_interfaces/srv/GetParameters": "string[] names\n---\nrcl_interfaces/ParameterValue[] values\n",
    "rcl_interfaces/srv/ListParameters": (
        "uint64 DEPTH_RECURSIVE=0\nstring[] prefixes\nuint64 depth\n---\nrcl_interfaces/ListParametersResult result\n"
    ),
    "rcl_interfaces/srv/SetParameters": (
        "rcl_interfaces/Parameter[] parameters\n---\nrcl_interfaces/SetParametersResult[] results\n"
    ),
    "rcl_interfaces/srv/SetParametersAtomically": (
        "rcl_interfaces/Parameter[] parameters\n---\nrcl_interfaces/SetParametersResult result\n"
    ),
    "ros_gz_interfaces/srv/ControlWorld": "ros_gz_interfaces/WorldControl world_control\n---\nbool success\n",
    "ros_gz_interfaces/srv/DeleteEntity": "ros_gz_interfaces/Entity entity\n---\nbool success\n",
    "ros_gz_interfaces/srv/SetEntityPose": (
        "ros_gz_interfaces/Entity entity\ngeometry_msgs/Pose pose\n---\nbool success\n"
    ),
    "ros_gz_interfaces/srv/SpawnEntity": "ros_gz_interfaces/EntityFactory entity_factory\n---\nbool success\n",
    "simulation_interfaces/srv/DeleteEntity": "string entity\n---\nsimulation_interfaces/Result result\n",
    "simulation_interfaces/srv/GetEntities": (
        "simulation_interfaces/EntityFilters filters\n---\nsimulation_interfaces/Result result\nstring[] entities\n"
    ),
    "simulation_interfaces/srv/GetEntitiesStates": (
        "simulation_interfaces/EntityFilters filters\n---\nsimulation_interfaces/Result result\nstring[] entities\n"
        "simulation_interfaces/EntityState[] states\n"
    ),
    "simulation_interfaces/srv/GetEntityState": (
        "string entity\n---\nsimulation_interfaces/Result result\nsimulation_interfaces/EntityState state\n"
    ),
    "simulation_interfaces/srv/GetSimulationState": (
        "---\nsimulation_interfaces/SimulationState state\nsimulation_interfaces/Result result\n"
    ),
    "simulation_interfaces/srv/GetSimulatorFeatures": "---\nsimulation_interfaces/SimulatorFeatures features\n",
    "simulation_interfaces/srv/GetSpawnables": (
        "string[] sources\n---\nsimulation_interfaces/Result result\nsimulation_interfaces/Spawnable[] spawnables\n"
    ),
    "simulation_interfaces/srv/ResetSimulation": (
        "uint8 SCOPE_DEFAULT=0\nuint8 SCOPE_TIME=1\nuint8 SCOPE_STATE=2\nuint8 SCOPE_SPAWNED=4\nuint8 SCOPE_ALL=255\n"
        "uint8 scope\n---\nsimulation_interfaces/Result result\n"
    ),
    "simulation_interfaces/srv/SetEntityState": (
        "string entity\nsimulation_interfaces/EntityState state\n---\nuint8 INVALID_POSE=101\n"
        "simulation_interfaces/Result result\n"
    ),
    "simulation_interfaces/srv/SetSimulationState": (
        "simulation_interfaces/SimulationState state\n---\nuint8 ALREADY_IN_TARGET_STATE=101\n"
        "uint8 STATE_TRANSITION_ERROR=102\nuint8 INCORRECT_TRANSITION=103\nsimulation_interfaces/Result result\n"
    ),
    "simulation_interfaces/srv/SpawnEntity": (
        "string name\nbool allow_renaming\nstring uri\nstring resource_string\nstring entity_namespace\n"
        "geometry_msgs/PoseStamped initial_pose\n---\nuint8 NAME_NOT_UNIQUE=101\nuint8 NAME_INVALID=102\n"
        "uint8 UNSUPPORTED_FORMAT=103\nuint8 NO_RESOURCE=104\nuint8 NAMESPACE_INVALID=105\n"
        "uint8 RESOURCE_PARSE_ERROR=106\nuint8 MISSING_ASSETS=107\nuint8 UNSUPPORTED_ASSETS=108\n"
        "uint8 INVALID_POSE=109\nsimulation_interfaces/Result result\nstring entity_name\n"
    ),
    "simulation_interfaces/srv/StepSimulation": "uint64 steps 1\n---\nsimulation_interfaces/Result result\n",
    "std_srvs/srv/Empty": "---\n",
    "std_srvs/srv/SetBool": "bool data\n---\nbool success\nstring message\n",
    "std_srvs/srv/Trigger": "---\nbool success\nstring message\n",
    "tf2_msgs/srv/FrameGraph": "---\nstring frame_yaml\n",
    "simulation_interfaces/action/SimulateSteps": (
        "uint64 steps\n---\nsimulation_interfaces/Result result\n---\nuint64 completed_steps\nuint64 remaining_steps\n"
    ),
}
