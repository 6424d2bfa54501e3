import pytest
from conftest import ARM, ROVER

from drake_twin.description.package_index import PackageIndex
from drake_twin.errors import InputError
from drake_twin.planning.plan_robot import plan_robot
from drake_twin.planning.plans import plan_robots
from drake_twin.planning.topics import controller_topic, robot_topic
from drake_twin.scenario import Robot, Scenario, ScenarioError

PACKAGES = PackageIndex()

TWO_WHEELS = """<robot name="cart">
  <link name="base"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1"/></inertial></link>
  <link name="left"/><link name="right"/>
  <joint name="left_joint" type="continuous"><parent link="base"/><child link="left"/>
    <limit effort="1" velocity="8"/></joint>
  <joint name="right_joint" type="continuous"><parent link="base"/><child link="right"/></joint>
  <ros2_control name="s" type="system">
    <joint name="left_joint"><command_interface name="velocity"><param name="min">-20</param>
      <param name="max">3</param></command_interface><state_interface name="position"><param
      name="initial_value">0.5</param></state_interface></joint>
    <joint name="right_joint"><command_interface name="{right}"/></joint>
  </ros2_control>
</robot>"""

CONTROLLERS = """controller_manager:
  ros__parameters:
    update_rate: 50
    one: {type: forward_command_controller/ForwardCommandController}
one:
  ros__parameters:
    joints: [left_joint]
    interface_name: velocity
"""


@pytest.fixture
def cart(tmp_path):
    def make(controllers=CONTROLLERS, right="velocity", file=TWO_WHEELS, **options):
        (tmp_path / "cart.urdf").write_text(file.format(right=right))
        files = ()
        if controllers is not None:
            (tmp_path / "controllers.yaml").write_text(controllers)
            files = (str(tmp_path / "controllers.yaml"),)
        robot = Robot("cart", str(tmp_path / "cart.urdf"), controllers=files, **options)
        (plan,) = plan_robots(Scenario((robot,)), PACKAGES)
        return plan

    return make


def test_a_controllers_file_of_another_machine_is_found_in_its_package(tmp_path):
    rover = tmp_path / "rover"
    rover.mkdir()
    (rover / "package.xml").write_text("<package format='3'><name>rover</name></package>")
    (rover / "c.yaml").write_text(CONTROLLERS)
    (rover / "cart.urdf").write_text(TWO_WHEELS.format(right="velocity"))
    given = "/home/someone/ws/src/rover/c.yaml"
    plan = plan_robot(Robot("cart", str(rover / "cart.urdf"), controllers=(given,)), PackageIndex([tmp_path]))
    assert states(plan) == {"one": "active"}
    (what,) = [finding.what for finding in plan.findings if "not on this machine" in finding.what]
    assert what == f"the controllers' file {given} is not on this machine: {rover / 'c.yaml'} is used"


def states(plan):
    return {controller.name: controller.state for controller in plan.controllers}


def claims(controller):
    return [str(claim) for claim in controller.claims]


def test_commands_are_bounded_by_the_tightest_of_urdf_and_ros2_control(cart):
    assert cart().description.limits_of_command("left_joint", "velocity") == (-8.0, 3.0)


def test_the_update_rate_is_the_parameters_files(cart):
    assert cart().manager.update_rate == 50


def test_a_joint_the_robot_lacks_is_named_with_file_line_and_the_joints_there_are(cart):
    with pytest.raises(
        InputError,
        match=r"controllers\.yaml:7: one\.ros__parameters\.joints\.0: the robot has no joint 'lft_joint'\."
        r" Did you mean 'left_joint'\? Valid: left_joint, right_joint",
    ):
        cart(CONTROLLERS.replace("left_joint", "lft_joint"))


def test_a_controller_without_joints_is_refused(cart):
    with pytest.raises(InputError, match="'joints' is missing"):
        cart(CONTROLLERS.replace("    joints: [left_joint]\n", ""))


def test_a_joint_without_a_velocity_interface_keeps_the_controller_from_starting(cart):
    plan = cart(CONTROLLERS.replace("[left_joint]", "[right_joint]"), right="effort")
    assert states(plan) == {"one": "unloaded"}
    (reason,) = plan.findings.not_started
    has_none = "joint right_joint has no velocity command interface in <ros2_control> (it has effort)"
    assert reason == f"cart: controller one: {has_none} (controllers.yaml:7)"


def test_two_controllers_on_one_joint_conflict_and_the_first_wins(cart):
    text = CONTROLLERS.replace(
        "    one: {", "    two: {type: velocity_controllers/JointGroupVelocityController}\n    one: {"
    )
    text += "two:\n  ros__parameters:\n    joints: [right_joint, left_joint]\n"
    plan = cart(text)
    assert states(plan) == {"two": "active", "one": "inactive"}
    assert plan.findings.not_started == (
        "cart: controller one: resource conflict, left_joint/velocity is already claimed by two (controllers.yaml:8)",
    )


def test_a_controller_type_that_is_not_supported_is_said_and_the_others_start(cart):
    text = CONTROLLERS.replace("    one: {", "    own: {type: my_controllers/OwnController}\n    one: {")
    plan = cart(text)
    assert states(plan) == {"own": "unloaded", "one": "active"}
    (sentence,) = plan.findings.not_started
    assert sentence.startswith(
        "cart: controller own: type my_controllers/OwnController is not supported; a module that"
    )
    assert sentence.endswith(" --plugin (controllers.yaml:4)")


def test_only_the_controllers_asked_for_are_active(cart):
    assert states(cart(active_controllers=())) == {"one": "unloaded"}
    assert states(cart(active_controllers=(), inactive_controllers=("one",))) == {"one": "inactive"}
    assert states(cart(inactive_controllers=("one",))) == {"one": "inactive"}
    with pytest.raises(ScenarioError, match=r"active_controllers: the parameters files have no controller 'on'.*'one'"):
        cart(active_controllers=("on",))


def test_without_a_parameters_file_every_joint_can_be_commanded(cart):
    _, controller = cart(None).controllers
    assert controller.name == "forward_velocity_controller"
    assert claims(controller) == ["left_joint/velocity", "right_joint/velocity"]
    _, velocity, effort = cart(None, right="effort").controllers
    assert (velocity.name, claims(velocity)) == ("forward_velocity_controller", ["left_joint/velocity"])
    assert (effort.name, claims(effort)) == ("forward_effort_controller", ["right_joint/effort"])


def test_of_several_interfaces_velocity_goes_before_position_and_effort(cart):
    for interfaces, expected in (
        (("effort", "position", "velocity"), "velocity"),
        (("effort", "position"), "position"),
    ):
        file = TWO_WHEELS.replace("{right}", '"/><command_interface name="'.join(interfaces))
        names = [controller.name for controller in cart(None, file=file).controllers]
        assert f"forward_{expected}_controller" in names
        assert "forward_effort_controller" not in names


def test_a_proportional_gain_is_of_the_error_in_each_update(cart):
    gain = '<hardware><param name="position_proportional_gain">0.05</param></hardware><joint name="left_joint"><c'
    plan = cart(file=TWO_WHEELS.replace('<joint name="left_joint"><c', gain))
    assert plan.joints.position_time_constant == pytest.approx(1 / (0.05 * 50))  # s, at 50 Hz
    assert cart().joints.position_time_constant == pytest.approx(1 / (0.1 * 50))  # gz_ros2_control's default


@pytest.mark.parametrize("plugin", ["gazebo_ros2_control/GazeboSystem", "mock_components/GenericSystem"])
def test_hardware_that_sets_positions_follows_within_an_update(cart, plugin):
    hardware = f'<hardware><plugin>{plugin}</plugin></hardware><joint name="left_joint"><c'
    plan = cart(file=TWO_WHEELS.replace('<joint name="left_joint"><c', hardware))
    assert plan.joints.position_time_constant == pytest.approx(1 / 50)


def test_dry_friction_is_modelled_where_there_is_some_and_a_follower_has_its_leaders(cart):
    friction = '<dynamics friction="0.3"/>'
    file = TWO_WHEELS.replace('velocity="8"/>', f'velocity="8"/>{friction}')
    assert [joint.name for joint in cart(file=file).friction_joints] == ["left_joint"]
    follower = file.replace('<child link="right"/>', f'<child link="right"/>{friction}<mimic joint="left_joint"/>')
    plan = cart(file=follower)
    assert {joint.name for joint in plan.description.movable_joints if joint.friction} == {"left_joint", "right_joint"}
    assert [joint.name for joint in plan.friction_joints] == ["left_joint"]
    assert cart(file=file, without_repairs=("joint_friction",)).friction_joints == ()


def test_joints_start_at_the_scenarios_position_then_at_initial_value_then_at_zero(cart):
    assert cart().joints.start_positions == {"left_joint": 0.5, "right_joint": 0.0}
    assert cart(initial_positions={"left_joint": 1.5}).joints.start_positions["left_joint"] == 1.5


def test_an_initial_position_of_no_joint_is_refused(cart):
    with pytest.raises(ScenarioError, match=r"initial_positions: the robot has no movable joint 'knee'.*left_joint"):
        cart(initial_positions={"knee": 1.0})


def test_a_start_beyond_the_limits_is_clamped_and_said():
    plan = plan_robot(Robot("arm", ARM, initial_positions={"joint_4": 2.0}), PACKAGES)
    assert plan.joints.start_positions["joint_4"] == 0.8
    assert plan.joints.start_positions["joint_5"] == -0.8
    assert "joint joint_4 starts at its limit 0.8 instead of 2" in plan.findings.warnings[0]


def test_joints_that_start_at_the_same_limit_are_one_warning(cart):
    limit = '<limit lower="1" upper="2" effort="1" velocity="8"/></joint>'
    file = TWO_WHEELS.replace("continuous", "revolute").replace('<limit effort="1" velocity="8"/></joint>', limit)
    file = file.replace('<child link="right"/></joint>', f'<child link="right"/>{limit}').replace(">0.5<", ">0<")
    assert [item for item in cart(file=file).findings.warnings if "start" in item] == [
        "cart: joints left_joint, right_joint start at their limit 1 instead of 0"
    ]


def test_a_start_of_a_joint_that_follows_another_is_said():
    plan = plan_robot(Robot("arm", ARM, initial_positions={"joint_4": 0.3, "joint_5": 0.1}), PACKAGES)
    assert plan.joints.start_positions["joint_5"] == -0.3
    assert plan.findings.warnings == ("arm: joint joint_5 follows joint_4: it starts at -0.3 instead of 0.1",)
    assert not plan_robot(
        Robot("arm", ARM, initial_positions={"joint_4": 0.3, "joint_5": -0.3}), PACKAGES
    ).findings.warnings


def test_link_names_that_carry_the_robots_name_need_no_frame_prefix():
    assert plan_robot(Robot("robot_1", ROVER), PACKAGES).frame_prefix == ""
    assert plan_robot(Robot("robot_1", ARM), PACKAGES).frame_prefix == "robot_1/"
    assert plan_robot(Robot("robot_1", ARM, frame_prefix="x_"), PACKAGES).frame_prefix == "x_"


def test_the_ros2_control_plugin_renames_topics_of_all_controllers(cart):
    rules = ("one/commands:=~/speed", "/r/joint_states:=wheels", "~/other:=/other")
    remappings = "".join(f"<remapping>{rule}</remapping>" for rule in rules)
    plugin = f"<plugin name='gz_ros2_control::GazeboSimROS2ControlPlugin' filename='p'><ros>{remappings}</ros></plugin>"
    file = TWO_WHEELS.replace("</robot>", f"<gazebo>{plugin}</gazebo></robot>")
    plan = cart(file=file, namespace="r", remappings={"/r/joint_states": "/states"})
    (controller,) = plan.controllers
    assert controller_topic(plan, controller, "commands") == "/r/one/speed"
    assert robot_topic(plan, "joint_states") == "/states"  # the scenario has the last word
    assert plan.robot.remapped("/r/one/other") == "/other"
    assert [finding.what for finding in plan.findings if "remapping" in finding.what] == []


def test_a_missing_robot_file_is_said_at_its_place_in_the_scenario():
    with pytest.raises(ScenarioError, match=r"robots\.0\.model: /nowhere/a\.urdf: the file does not exist"):
        plan_robot(Robot("a", "/nowhere/a.urdf"), PACKAGES, ("robots", 0))
