"""How often a launch file's robots are planned and their files read: counts, which unlike times are the same always."""

from collections import Counter

import pytest

from drake_twin.builder import launch_file
from drake_twin.builder.launch_file import launch_file_scenario
from drake_twin.description import robot_models
from drake_twin.description.package_index import share_folder
from drake_twin.description.xacro_file import installed_xacro
from drake_twin.from_launch import launched_entities
from drake_twin.planning import plan_robot, plans
from drake_twin.twin.twin import Twin

MAIN = share_folder("models") / "rover_gazebo" / "launch" / "main.launch.xml"

CART = """<robot name="cart" xmlns:xacro="http://www.ros.org/wiki/xacro"><xacro:arg name="mass" default="1"/>
<link name="base"><inertial><mass value="$(arg mass)"/>
<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
<collision><geometry><box size="1 1 1"/></geometry></collision></link></robot>"""

CART_NODES = """
<node pkg="robot_state_publisher" exec="robot_state_publisher" namespace="cart_{0}">
  <param name="robot_description" value="{text}" type="str"/></node>
<node pkg="ros_gz_sim" exec="create" namespace="cart_{0}" args="-name cart_{0} -topic robot_description -y {y}"/>
<node pkg="ros_gz_bridge" exec="parameter_bridge" name="bridge_{0}" args="/gz_{0}@x"/>"""


@pytest.fixture
def counted(monkeypatch):
    calls = Counter()

    def count(module, name):
        original = getattr(module, name)

        def counting(*arguments, **named):
            calls[name] += 1
            return original(*arguments, **named)

        monkeypatch.setattr(module, name, counting)

    count(launch_file, "plan_robot")
    count(plans, "plan_robot")
    count(plan_robot, "plan_controllers")
    count(robot_models, "load_robot_model")
    count(launched_entities, "bridge_lines")
    count(installed_xacro(), "process_file")
    return calls


def twin_of(file):
    launched = launch_file_scenario(file)
    return Twin(launched.scenario, plans=launched.plans)


def fleet(folder, masses):
    """A launch file with a cart of each mass, and a bridge beside each."""
    (folder / "cart.xacro").write_text(CART)
    nodes = []
    for number, mass in enumerate(masses):
        text = f"$(command 'xacro {folder}/cart.xacro mass:={mass}')"
        nodes.append(CART_NODES.format(number, text=text, y=2 * number))
    file = folder / "fleet.launch.xml"
    file.write_text(f"<launch>{''.join(nodes)}</launch>")
    return file


def test_each_robot_of_a_launch_file_is_planned_once(counted):
    twin_of(MAIN)
    expected = {"plan_robot": 2, "plan_controllers": 2, "load_robot_model": 2, "process_file": 2, "bridge_lines": 1}
    assert counted == expected  # two rovers, each with a name of its own in its xacro arguments; a bridge for /clock


def test_robots_of_one_command_share_its_expansion_and_their_model(counted, tmp_path):
    twin = twin_of(fleet(tmp_path, [1, 1, 1, 1, 1]))
    assert [robot.name for robot in twin.scenario.robots] == [f"cart_{number}" for number in range(5)]
    assert counted["plan_robot"] == counted["plan_controllers"] == 5
    assert counted["load_robot_model"] == 1
    assert counted["bridge_lines"] == 5  # once a bridge, not once a bridge and robot
    assert counted["process_file"] == 1


def test_each_distinct_command_is_expanded_once(counted, tmp_path):
    twin = twin_of(fleet(tmp_path, [1, 2, 1, 2]))
    assert counted["load_robot_model"] == 2
    assert counted["process_file"] == 2
    bodies = [
        twin.plant.GetUniqueFloatingBaseBodyOrThrow(twin.plant.GetModelInstanceByName(f"cart_{n}")) for n in range(4)
    ]
    assert [body.default_mass() for body in bodies] == [1.0, 2.0, 1.0, 2.0]


def test_robots_that_share_a_model_move_apart(tmp_path):
    twin = twin_of(fleet(tmp_path, [1, 1]))
    before = twin.robot_state("cart_1").base_pose
    twin.entities.set_state("cart_0", position=(0.0, 0.0, 3.0))
    assert tuple(twin.robot_state("cart_1").base_pose) == tuple(before)
    assert twin.robot_state("cart_0").base_pose[2] == 3.0
