"""Which controllers are active after the launch, for each way that launch files name them."""

from pathlib import Path

import pytest
from hinge import (
    CONTROLLERS,
    RENAMED,
    command,
    create,
    hinge,
    launched,
    launched_hinge,
    node,
    publisher,
    spawner,
    write_hinge,
)
from launch_files import not_started, write, write_package

from drake_twin.scenario import Command
from drake_twin.twin.controller_manager import ControllerManager


def states(launch):
    (robot,) = launch.scenario.robots
    return robot.active_controllers, robot.inactive_controllers


@pytest.mark.parametrize(
    "entities",
    [
        spawner("states", "velocity"),
        spawner("states") + spawner("velocity", "-c", "controller_manager"),
        spawner("states", "velocity", "--controller-manager", "/controller_manager"),
        spawner("states", "velocity", "--service-call-timeout", "30", "--switch-timeout=9"),
        spawner("--controller-manager-timeout", "30", "states", "--activate-as-group", "velocity"),
        node("controller_manager", "spawner.py", "states", "velocity"),
        command("ros2", "control", "load_controller", "--set-state", "active", "states")
        + command("ros2", "control", "load_controller", "velocity", "--set-state", "active"),
        command(
            "ros2 control load_controller --set-state start states && ros2 run controller_manager spawner velocity",
            shell=True,
        ),
        command("ros2", "control", "load_start_controller", "states") + spawner("velocity"),
        spawner("states")
        + spawner("velocity", "--inactive")
        + command("ros2", "control", "set_controller_state", "velocity", "active"),
        spawner("states", "velocity", "--inactive")
        + command("ros2", "control", "switch_controllers", "--strict", "--activate", "states", "velocity"),
        spawner("states", "velocity", "--inactive")
        + command("ros2", "control", "switch_controllers", "--start-controllers", "states", "velocity"),
        command("ros2", "run", "controller_manager", "spawner", "states", "velocity"),
        command("bash", "-c", "ros2 run controller_manager spawner states velocity"),
    ],
)
def test_every_way_to_activate_controllers(tmp_path, entities):
    launch = launched_hinge(tmp_path, entities)
    assert states(launch) == (("states", "velocity"), ())
    assert (not_started(launch.scenario), launch.log) == ((), ())


@pytest.mark.parametrize(
    ("entities", "expected"),
    [
        (spawner("states", "--inactive"), ((), ("states",))),
        (spawner("states", "--stopped"), ((), ("states",))),
        (command("ros2", "control", "load_controller", "states", "--set-state", "inactive"), ((), ("states",))),
        (
            spawner("states", "velocity") + command("ros2", "control", "set_controller_state", "velocity", "inactive"),
            (("states",), ("velocity",)),
        ),
        (
            spawner("states", "velocity") + command("ros2", "control", "switch_controllers", "--deactivate", "states"),
            (("velocity",), ("states",)),
        ),
        (spawner("states", "velocity") + node("controller_manager", "unspawner", "states"), (("velocity",), ())),
        (spawner("states") + command("ros2", "control", "unload_controller", "states"), ((), ())),
        ("", ((), ())),
    ],
)
def test_every_way_to_leave_controllers_inactive_or_out(tmp_path, entities, expected):
    launch = launched_hinge(tmp_path, entities)
    assert states(launch) == expected
    assert not_started(launch.scenario) == ()


@pytest.mark.parametrize(
    "entity", [spawner("states", "--load-only"), command("ros2", "control", "load_controller", "states")]
)
def test_a_controller_that_is_only_loaded_is_unconfigured(tmp_path, entity):
    launch = launched_hinge(tmp_path, entity)  # test_spawner_unspawner.cpp: --load-only
    assert (states(launch), launch.scenario.robots[0].unconfigured_controllers) == (((), ()), ("states",))
    manager = ControllerManager(launch.plans[0], lambda *switch: None)
    assert manager.states == {"states": "unconfigured"}
    assert manager.configure_controller("states")
    assert manager.switch_controller(["states"])


def test_a_group_is_activated_as_a_whole_or_not(tmp_path):
    alone = launched_hinge(tmp_path, spawner("states", "wings", "velocity"))
    assert states(alone) == (("states", "velocity"), ())
    launch = launched_hinge(tmp_path, spawner("states", "wings", "velocity", "--activate-as-group"))
    assert states(launch) == ((), ("states", "velocity"))
    assert ControllerManager(launch.plans[0], lambda *switch: None).states == {
        "states": "inactive",
        "velocity": "inactive",
    }
    assert "controller velocity of hinge: 'wings' of its --activate-as-group is not active" in not_started(
        launch.scenario
    )


FORWARD = "forward_command_controller/ForwardCommandController"


def parameters_of(launch, name):
    (robot,) = launch.plans
    (found,) = (item for item in robot.controllers if item.name == name)
    return found.type, found.parameters


def test_several_controllers_with_a_file_each(tmp_path):
    """As spawner.py's --controller mode: options after a name are that controller's."""
    one, two = (
        write(tmp_path / f"{name}.yaml", f"{name}:\n  ros__parameters: {{type: {FORWARD}, joints: [hinge], {more}}}\n")
        for name, more in (("one", "interface_name: velocity"), ("two", "interface_name: velocity"))
    )
    arguments = ("--controller", "one", "-p", one, "--controller", "two", "-p", two, "--inactive")
    launch = launched_hinge(tmp_path, spawner("-c", "controller_manager", *arguments))
    assert states(launch) == (("one",), ("two",))
    assert (not_started(launch.scenario), launch.log) == ((), ())
    assert launch.scenario.robots[0].controllers[-2:] == (str(one), str(two))


@pytest.mark.parametrize("key", ["/**", "'/**'"])
def test_a_parameters_file_for_any_node_is_the_controllers(tmp_path, key):
    text = f"{key}:\n  ros__parameters:\n    type: {FORWARD}\n    joints: [hinge]\n    interface_name: velocity\n"
    file = write(tmp_path / "any.yaml", text)
    launch = launched_hinge(tmp_path, spawner("mine", "-p", file), spawner("states"))
    assert states(launch) == (("mine", "states"), ())
    kind, parameters = parameters_of(launch, "mine")
    assert (kind, parameters.joints) == (FORWARD, ("hinge",))


def test_parameters_and_a_type_on_the_command_line(tmp_path):
    given = "--ros-args -p joints:=[hinge] -p interface_name:=velocity"
    launch = launched_hinge(tmp_path, spawner("mine", "-t", FORWARD, "--controller-ros-args", given))
    assert states(launch) == (("mine",), ())
    kind, parameters = parameters_of(launch, "mine")
    assert (kind, parameters.joints, parameters.interface_name) == (FORWARD, ("hinge",), "velocity")
    more = ("--controller-ros-args", "-p command_timeout:=0.5", "--controller-ros-args", "-r ~/commands:=/go")
    launch = launched_hinge(tmp_path, spawner("velocity", *more))
    assert parameters_of(launch, "velocity")[1].command_timeout == 0.5
    assert launch.scenario.robots[0].remapped("/velocity/commands") == "/go"


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("velocity", "--activate-at-once"), "unknown option --activate-at-once. Valid: --load-only"),
        (("--controller",), "--controller needs the name of a controller"),
    ],
)
def test_a_command_line_that_the_spawner_refuses_is_a_finding_and_the_others_start(tmp_path, arguments, message):
    launch = launched_hinge(tmp_path, spawner(*arguments), spawner("states"))
    assert states(launch) == (("states",), ())
    (reason,) = not_started(launch.scenario)
    assert message in reason
    assert "test.launch.py:" in reason


def in_namespace(folder, *entities):
    """The hinge below /left, its twin below /right."""
    robots = [
        publisher(
            write_hinge(folder, name, plugin=f"<ros><namespace>{name}</namespace></ros>"),
            namespace=name,
        )
        + create("-topic", f"/{name}/robot_description", "-name", name)
        for name in ("left", "right")
    ]
    launch = launched(folder, *robots, *entities)
    return {robot.name: robot.active_controllers for robot in launch.scenario.robots}, launch


@pytest.mark.parametrize(
    "entity",
    [
        spawner("states", "-c", "/right/controller_manager"),
        spawner("states", "-c", "right/controller_manager"),
        spawner("states", namespace="right"),
        spawner("states", "-c", "controller_manager", namespace="/right"),
        spawner("states", "--namespace", "right"),
        spawner("states", "--ros-args", "-r", "__ns:=/right"),
        f"PushRosNamespace('right'), {spawner('states')}",
        command(
            "ros2", "control", "load_controller", "--set-state", "active", "states", "-c", "/right/controller_manager"
        ),
        command("ros2", "run", "controller_manager", "spawner", "states", "--ros-args", "-r", "__ns:=/right"),
    ],
)
def test_a_controller_manager_is_named_as_ros_resolves_it(tmp_path, entity):
    active, launch = in_namespace(tmp_path, entity)
    assert active == {"left": (), "right": ("states",)}
    assert not_started(launch.scenario) == ()


def test_a_manager_that_no_robot_has_is_not_started_where_there_are_several(tmp_path):
    active, launch = in_namespace(tmp_path, spawner("states"))
    assert active == {"left": (), "right": ()}
    (reason,) = not_started(launch.scenario)
    assert reason == (
        "controller states (controller_manager/spawner: unknown /controller_manager; the launch file has"
        " /left/controller_manager, /right/controller_manager)"
    )


def test_the_only_manager_is_taken_for_one_of_another_name_and_that_is_said(tmp_path):
    launch = launched_hinge(tmp_path, spawner("states", "velocity", "-c", "/other/controller_manager"))
    assert states(launch) == (("states", "velocity"), ())
    (said,) = launch.log
    assert "waits for /other/controller_manager; /controller_manager is used instead" in said


def test_a_controller_that_the_parameters_files_lack_is_named_and_the_others_start(tmp_path):
    launch = launched_hinge(tmp_path, spawner("states", "wings", "velocity"))
    assert states(launch) == (("states", "velocity"), ())
    assert not_started(launch.scenario) == (
        "controller wings of hinge: the parameters files have no controller 'wings'",
    )


@pytest.mark.parametrize("form", ["spawner", "load_controller"])
def test_a_parameters_file_beside_the_plugins(tmp_path, form):
    file = write(tmp_path / "extra.yaml", RENAMED)
    entity = {
        "spawner": spawner("extra", "-p", file),
        "load_controller": command("ros2", "control", "load_controller", "--set-state", "active", "extra", file),
    }[form]
    launch = launched_hinge(tmp_path, spawner("velocity"), entity)
    assert states(launch) == (("velocity", "extra"), ())
    assert launch.scenario.robots[0].controllers == (str(tmp_path / "controllers.yaml"), str(file))
    assert not_started(launch.scenario) == ()


def test_a_relative_file_of_the_plugins_is_absolute_in_the_scenario(tmp_path):
    share = write_package(tmp_path / "src", "arm_description")
    own = write(share / "config" / "controllers.yaml", CONTROLLERS)
    robot = write(share / "arm.urdf", hinge(Path("./arm_description/config/controllers.yaml")))
    extra = write(share / "extra.yaml", RENAMED)
    launch = launched(
        share / "launch", publisher(robot), create("-topic", "robot_description"), spawner("extra", "-p", extra)
    )
    first, second = (Path(file) for file in launch.scenario.robots[0].controllers)
    assert (first.read_text(), second) == (own.read_text(), extra)


def test_a_parameters_file_that_is_not_there_is_named(tmp_path):
    launch = launched_hinge(tmp_path, spawner("extra", "--param-file", "/nowhere.yaml"), spawner("states"))
    assert states(launch) == (("states",), ())
    missing, lacking = not_started(launch.scenario)
    assert "test.launch.py:" in missing
    assert "the parameters file /nowhere.yaml does not exist" in missing
    assert "no controller 'extra'" in lacking


def test_a_controllers_own_remappings_name_its_topics(tmp_path):
    arguments = ("velocity", "--controller-ros-args", "-r ~/commands:=/go", "-c", "/controller_manager")
    (robot,) = launched_hinge(tmp_path, spawner(*arguments)).scenario.robots
    assert robot.active_controllers == ("velocity",)
    assert robot.remapped("/velocity/commands") == "/go"


TYPE = "std_msgs/msg/Float64MultiArray"


def published(*what):
    """A command of a launch file, which ROS would publish also where nobody hears it."""
    return Command(*what, optional=True)


ONCE = [published("/velocity/commands", (1.0,), 0.0)]


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        (["--once", "/velocity/commands", TYPE, "{data: [1.0]}"], ONCE),
        (["-1", "/velocity/commands", TYPE, "data: [1]"], ONCE),
        (["/velocity/commands", TYPE, "data: [1]", "-1"], ONCE),
        (["-w", "1", "--once", "--keep-alive", "2", "velocity/commands", TYPE, "data: [1]"], ONCE),
        (["/velocity/commands", TYPE, "data: [1]"], [published("/velocity/commands", (1.0,), 0.0, 1.0)]),
        (["-r", "10", "/velocity/commands", TYPE, "data: [1]"], [published("/velocity/commands", (1.0,), 0.0, 0.1)]),
        (
            ["--rate=1e6", "/velocity/commands", TYPE, "data: [1]"],
            [published("/velocity/commands", (1.0,), 0.0, 0.001)],
        ),
        (
            ["-t", "3", "-r", "2", "/velocity/commands", TYPE, "data: [1]"],
            [published("/velocity/commands", (1.0,), time) for time in (0.0, 0.5, 1.0)],
        ),
        (
            ["--once", "/cmd_vel", "geometry_msgs/msg/Twist", "{linear: {x: 0.5}}"],
            [published("/cmd_vel", {"linear": {"x": 0.5}}, 0.0)],
        ),
    ],
)
def test_what_ros2_topic_pub_publishes(tmp_path, words, expected):
    launch = launched_hinge(tmp_path, command("ros2", "topic", "pub", *words))
    assert list(launch.scenario.commands) == expected
    assert not_started(launch.scenario) == ()


def test_a_timer_publishes_in_simulation_time(tmp_path):
    pub = command("ros2 topic pub --once /velocity/commands " + TYPE + " '{data: [1.0]}'", shell=True)
    launch = launched_hinge(tmp_path, f"TimerAction(period=2.5, actions=[{pub}]),")
    assert launch.scenario.commands == (published("/velocity/commands", (1.0,), 2.5),)


def test_a_line_of_the_shell_is_what_its_commands_are(tmp_path):
    line = f"source /opt/x; sleep 2 && ros2 topic pub --once /velocity/commands {TYPE} '{{data: [1.0]}}'; rosbag play"
    launch = launched_hinge(tmp_path, command("bash", "-c", line))
    assert launch.scenario.commands == (published("/velocity/commands", (1.0,), 2.0),)
    assert not_started(launch.scenario) == ("rosbag (the twin records with --record)",)


def test_the_waits_of_a_line_of_the_shell_add_up_from_when_it_starts(tmp_path):
    pub = f"ros2 topic pub --once /velocity/commands {TYPE} '{{data: [1.0]}}'"
    line = command("bash", "-c", f"sleep 2; {pub}; sleep 0.5s && {pub}")
    launch = launched_hinge(tmp_path, f"TimerAction(period=1.0, actions=[{line}]),")
    assert [item.time for item in launch.scenario.commands] == [3.0, 3.5]


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["/velocity/commands", TYPE, "{data: [fast]}"], "the data must all be numbers"),
        (["/velocity/commands", TYPE, "[1.0]"], "is not the fields of a message"),
        (["/velocity/commands", TYPE, "{data: ["], "is not valid YAML"),
        (["-r", "-1", "/velocity/commands", TYPE], "a rate of -1 Hz is invalid"),
        (["-r", "often", "/velocity/commands", TYPE], "-r is 'often', which is not a number"),
        (["/velocity/commands"], "needs a topic and a type"),
    ],
)
def test_a_publication_that_ros_refuses_is_named_with_its_line(tmp_path, words, message):
    launch = launched_hinge(tmp_path, command("ros2", "topic", "pub", *words))
    assert launch.scenario.commands == ()
    (reason,) = not_started(launch.scenario)
    assert message in reason
    assert "test.launch.py:" in reason
