"""Topics of several robots: as in ROS, each listener hears every message and each publisher is heard."""

from dataclasses import replace

import pytest

from drake_twin import Snapshot, Twin, TwinBuilder
from drake_twin.builder.demo import demo_scenario
from drake_twin.errors import CommandError, InputError
from drake_twin.findings import Kind
from drake_twin.scenario import Command

COMMANDS = "/fleet/forward_velocity_controller/commands"


def two_in_one_namespace():
    scenario = demo_scenario("rover", 2, drive=False)
    robots = [replace(robot, namespace="/fleet") for robot in scenario.robots]
    return replace(scenario, robots=tuple(robots))


@pytest.fixture(scope="module")
def twin():
    return Twin(two_in_one_namespace())


@pytest.fixture(autouse=True)
def _from_the_start(twin):
    twin.reset()


def velocities(twin, robot):
    return twin.robot_state(robot).velocities


def test_one_message_drives_both(twin):
    twin.publish(COMMANDS, [2.0] * 4)
    twin.advance_to(0.5)
    for robot in twin.robots:
        assert min(velocities(twin, robot)) > 1.0


def test_a_scheduled_command_reaches_both():
    command = Command(COMMANDS, (2.0, 2.0, 2.0, 2.0))
    twin = Twin(replace(two_in_one_namespace(), commands=(command,)))
    twin.advance_to(0.5)
    assert all(min(velocities(twin, robot)) > 1.0 for robot in twin.robots)


def test_each_publisher_is_heard(twin):
    heard = []
    end = twin.subscribe("/fleet/joint_states", heard.append, rate=10)
    twin.advance_to(0.25)
    assert len(heard) == 2 * 3
    end()
    twin.advance_to(0.5)
    assert len(heard) == 2 * 3
    assert list(twin.graph.topics()).count("/fleet/joint_states") == 1
    assert not [topic for topic in twin.graph.topics() if "@" in topic]


def test_who_is_stopped_or_inactive_keeps_no_other_from_hearing(twin):
    twin.control.emergency_stop("robot_1")
    twin.publish(COMMANDS, [2.0] * 4)
    twin.advance_to(0.5)
    assert max(map(abs, velocities(twin, "robot_1"))) < 1e-6
    assert min(velocities(twin, "robot_2")) > 1.0
    twin.control.emergency_stop("robot_2")
    with pytest.raises(CommandError, match="emergency stop of 'robot_1' holds"):
        twin.publish(COMMANDS, [2.0] * 4)
    twin.control.clear_emergency_stop("robot_1")
    twin.control.clear_emergency_stop("robot_2")


def test_what_no_listener_accepts_is_refused(twin):
    with pytest.raises(CommandError):
        twin.publish(COMMANDS, [2.0])


def test_the_state_holds_both_commands(twin, tmp_path):
    twin.publish(COMMANDS, [2.0] * 4)
    twin.advance_to(0.2)
    twin.snapshot().save(tmp_path / "saved.json")
    other = Twin(two_in_one_namespace())
    other.restore(Snapshot.load(tmp_path / "saved.json"))
    for each in (twin, other):
        each.advance_to(0.6)
    assert other.state_sha256() == twin.state_sha256()


def test_a_robot_that_goes_leaves_the_other_its_topic():
    twin = Twin(replace(two_in_one_namespace(), commands=(Command(COMMANDS, (2.0,) * 4, time=0.3),)))
    twin.entities.delete("robot_1")
    twin.advance_to(0.6)
    assert min(velocities(twin, "robot_2")) > 1.0


def test_two_types_on_one_topic_are_refused():
    scenario = two_in_one_namespace()
    own = "/fleet/forward_velocity_controller/commands"
    first = replace(scenario.robots[0], remappings={own: "/fleet/joint_states"})
    builder_scenario = replace(scenario, robots=(first, scenario.robots[1]))
    twin = Twin(builder_scenario)  # one listens where the other publishes: that is what topics are for
    assert twin.graph.topics()["/fleet/joint_states"]
    clash = replace(scenario.robots[0], remappings={"/fleet/joint_states": "/fleet/robot_description"})
    with pytest.raises(InputError, match=r"/fleet/robot_description would have two types"):
        Twin(replace(scenario, robots=(clash, scenario.robots[1])))


def test_launched_robots_without_controller_managers_share_their_topics(tmp_path):
    sdf = """<sdf version="1.9"><model name="base"><link name="{name}"><inertial><mass>1</mass></inertial>
    <collision name="c"><geometry><sphere><radius>0.1</radius></sphere></geometry></collision></link>
    <plugin filename="gz-sim-velocity-control-system" name="gz::sim::systems::VelocityControl">
    <topic>/cmd_vel</topic></plugin></model></sdf>"""
    spawns = []
    for number, name in enumerate(("one", "two")):
        (tmp_path / f"{name}.sdf").write_text(sdf.format(name="base_link"))
        arguments = f"-name {name} -file $(dirname)/{name}.sdf -x {number} -z 0.1"
        spawns.append(f'<node pkg="ros_gz_sim" exec="create" args="{arguments}"/>')
    file = tmp_path / "two.launch.xml"
    file.write_text(f"<launch>{''.join(spawns)}</launch>")
    twin = TwinBuilder().launch(file).build()
    start = [twin.robot_state(robot).base_pose[0] for robot in twin.robots]
    twin.publish("/cmd_vel", {"linear": {"x": 0.5}})
    twin.advance_to(1.0)
    moved = [twin.robot_state(robot).base_pose[0] - x for robot, x in zip(twin.robots, start, strict=True)]
    assert moved == pytest.approx([0.5, 0.5], abs=0.02)
    (finding,) = [item for item in twin.findings if item.kind is Kind.WARNING and "frames" in item.what]
    assert (finding.robot, "begin with its name" in finding.what) == ("two", True)
