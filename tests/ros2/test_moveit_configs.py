"""Launch files that build MoveIt's parameters: their robots and controllers start, move_group does not."""

from launch_files import launch_python, write, write_package

from drake_twin.description.package_index import PackageIndex
from drake_twin.ros2.evaluate import evaluate

URDF = '<robot name="arm" xmlns:xacro="http://www.ros.org/wiki/xacro"><xacro:arg name="side" default="left"/>'
URDF += '<link name="$(arg side)_base"/></robot>'
CONTROLLERS = "moveit_simple_controller_manager: {controller_names: [arm_controller]}"


def moveit_package(folder):
    package = write_package(folder, "arm_moveit_config")
    write(package / "config" / "arm.urdf.xacro", URDF)
    semantic = '<virtual_joint name="v" type="fixed" parent_frame="world" child_link="left_base"/>'
    write(package / "config" / "arm.srdf", f'<robot name="arm">{semantic}</robot>')
    write(package / "config" / "kinematics.yaml", "arm: {kinematics_solver: kdl}")
    write(package / "config" / "joint_limits.yaml", "joint_limits: {j: {max_velocity: 1.0}}")
    write(package / "config" / "moveit_controllers.yaml", CONTROLLERS)
    write(package / "config" / "ompl_planning.yaml", "planning_plugins: [ompl]")
    return package


def built(folder, calls, nodes):
    before = f"from moveit_configs_utils import MoveItConfigsBuilder\nconfigs = {calls}"
    return launch_python(folder, nodes, before).processes


def test_the_files_of_the_package_are_read(tmp_path):
    moveit_package(tmp_path)
    nodes = "Node(package='moveit_ros_move_group', executable='move_group', parameters=[configs.to_dict()])"
    (process,) = built(tmp_path, "MoveItConfigsBuilder('arm').to_moveit_configs()", nodes)
    (values,) = process.parameters
    assert 'name="left_base"' in values["robot_description"]
    assert values["robot_description_kinematics.arm.kinematics_solver"] == "kdl"
    assert values["robot_description_planning.joint_limits.j.max_velocity"] == 1.0
    assert values["moveit_simple_controller_manager.controller_names"] == ("arm_controller",)
    assert values["planning_pipelines"] == ("ompl",)
    assert values["default_planning_pipeline"] == "ompl"


def test_mappings_may_be_arguments_of_the_launch_file(tmp_path):
    moveit_package(tmp_path)
    calls = "MoveItConfigsBuilder('arm').robot_description(mappings={'side': LaunchConfiguration('side')})"
    nodes = "DeclareLaunchArgument('side', default_value='right'), Node(package='robot_state_publisher',"
    nodes += "executable='robot_state_publisher', parameters=[configs.robot_description])"
    (process,) = built(tmp_path, f"{calls}.to_moveit_configs()", nodes)
    assert 'name="right_base"' in process.parameters[0]["robot_description"]


def test_the_urdf_of_another_package_is_found_by_the_setup_assistants_file(tmp_path):
    package = moveit_package(tmp_path)
    (package / "config" / "arm.urdf.xacro").rename(write_package(tmp_path, "arm_description") / "arm.xacro")
    urdf = "URDF: {package: arm_description, relative_path: arm.xacro}"
    write(package / ".setup_assistant", f"moveit_setup_assistant_config: {{{urdf}}}")
    nodes = "Node(package='p', executable='e', parameters=[configs.robot_description])"
    (process,) = built(tmp_path, "MoveItConfigsBuilder('arm').to_moveit_configs()", nodes)
    assert 'name="left_base"' in process.parameters[0]["robot_description"]


def test_the_demo_starts_robot_frames_and_controllers(tmp_path):
    package = moveit_package(tmp_path)
    for name in ("rsp", "static_virtual_joint_tfs", "spawn_controllers", "move_group", "moveit_rviz", "demo"):
        text = "from moveit_configs_utils import MoveItConfigsBuilder\n"
        text += f"from moveit_configs_utils.launches import generate_{name}_launch\n"
        text += "def generate_launch_description():\n"
        text += f"    return generate_{name}_launch(MoveItConfigsBuilder('arm').to_moveit_configs())\n"
        write(package / "launch" / f"{name}.launch.py", text)
    launched = evaluate(package / "launch" / "demo.launch.py", {}, PackageIndex([tmp_path]))
    assert launched.failed_includes == ()
    assert [process.executable for process in launched.processes] == [
        *("static_transform_publisher", "robot_state_publisher", "move_group", "rviz2", "ros2_control_node"),
        *("spawner", "spawner"),
    ]
    assert [process.arguments for process in launched.processes[-2:]] == [
        ("arm_controller",),
        ("joint_state_broadcaster",),
    ]


def test_limits_of_the_pilz_planner_are_read_where_there_are_some(tmp_path):
    package = moveit_package(tmp_path)
    limits = "config/pilz_cartesian_limits.yaml"
    nodes = "Node(package='p', executable='e', parameters=[configs.to_dict()])"
    found = {}
    for there in (False, True):
        if there:
            write(package / limits, "cartesian_limits: {max_trans_vel: 1.5}")
        (process,) = built(tmp_path, "MoveItConfigsBuilder('arm').pilz_cartesian_limits().to_moveit_configs()", nodes)
        found[there] = process.parameters[0].get("robot_description_planning.cartesian_limits.max_trans_vel")
    assert found == {False: None, True: 1.5}
