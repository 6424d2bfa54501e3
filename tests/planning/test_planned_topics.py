"""The names of a robot's topics in ROS, and those that it alone may have."""

import pytest

from drake_twin.description.package_index import PackageIndex
from drake_twin.planning.plan_robot import plan_robot
from drake_twin.planning.topics import controller_topic, topics_with_one_owner
from drake_twin.scenario import Robot

OWN = {f"/cart/{name}" for name in ("joint_states", "dynamic_joint_states", "robot_description", "ground_truth/odom")}
CART = """<robot name="cart"><link name="base"/><link name="wheel"/>
  <joint name="left" type="continuous"><parent link="base"/><child link="wheel"/></joint>{}</robot>"""
PLUGIN = """<gazebo><plugin filename="gz-sim-joint-position-controller-system" name="p"><joint_name>left</joint_name>
  </plugin></gazebo>"""
CONTROL = """<ros2_control name="s" type="system"><hardware><plugin>mock_components/GenericSystem</plugin></hardware>
  <joint name="left"><command_interface name="velocity"/><state_interface name="position"/></joint></ros2_control>"""


@pytest.fixture
def plan(tmp_path):
    def plan(inside, **options):
        (tmp_path / "cart.urdf").write_text(CART.format(inside))
        return plan_robot(Robot("cart", str(tmp_path / "cart.urdf"), **options), PackageIndex())

    return plan


def test_a_robots_own_topics_are_its_alone_also_where_they_are_renamed(plan):
    assert topics_with_one_owner(plan(CONTROL)) == OWN
    renamed = plan(CONTROL, remappings={"/cart/joint_states": "/all_joints"})
    assert topics_with_one_owner(renamed) == OWN - {"/cart/joint_states"} | {"/all_joints"}


def test_a_plugins_topics_are_its_robots_by_the_names_of_gazebo_and_of_ros(plan):
    """gz-sim's JointPositionController listens to /model/NAME/joint/JOINT/INDEX/cmd_pos."""
    found = plan(PLUGIN)
    (controller,) = found.controllers
    ((own, _),) = controller.wiring.gz_topics.items()
    assert controller_topic(found, controller, own) in topics_with_one_owner(found)
    assert "/model/cart/joint/left/0/cmd_pos" in topics_with_one_owner(found)
    bridged = plan(PLUGIN, remappings={"/model/cart/joint/left/0/cmd_pos": "/left/goal"})
    assert controller_topic(bridged, controller, own) == "/left/goal"
    assert "/left/goal" in topics_with_one_owner(bridged)


def test_a_remapped_topic_of_a_controller_is_its_robots(plan):
    name = "/cart/forward_velocity_controller/commands"
    assert "/wheel/goal" in topics_with_one_owner(plan(CONTROL, remappings={name: "/wheel/goal"}))
    assert "/wheel/goal" not in topics_with_one_owner(plan(CONTROL, remappings={"/cart/other": "/wheel/goal"}))
