"""Which robots a launch file brings into the world: who describes them, their names, poses and namespaces."""

import shlex
from math import cos, sin
from pathlib import Path

import pytest
from hinge import command, create, gz, hinge, launched, launched_hinge, node, publisher, spawner, write_hinge
from launch_files import not_started, write

from drake_twin.errors import InputError
from drake_twin.findings import Kind, grouped


def robots(launch):
    return {robot.name: robot for robot in launch.scenario.robots}


@pytest.mark.parametrize(
    "form",
    ["topic", "file", "string", "param", "parameters", "spawn_entity topic", "spawn_entity file", "gz_spawn_model"],
)
def test_every_way_to_spawn_an_entity(tmp_path, form):
    file = write_hinge(tmp_path)
    pose = ("-x", "1", "-y", "-2", "-z", "0.5", "-R", "0.1", "-P", "0.2", "-Y", "-0.3")
    parameters = {
        "name": "r",
        "topic": "robot_description",
        "x": 1.0,
        "y": -2.0,
        "z": 0.5,
        "R": 0.1,
        "P": 0.2,
        "Y": -0.3,
    }
    given = {"x": "1", "y": "-2", "z": "0.5", "roll": "0.1", "pitch": "0.2", "yaw": "-0.3"}
    entity = {
        "topic": create("-topic", "/robot_description", "-name", "r", *pose),
        "file": create("-file", file, "-name", "r", *pose),
        "string": create("-string", file.read_text(), "-name", "r", *pose),
        "param": create("-param", "text", "-name", "r", *pose, parameters=[{"text": file.read_text()}]),
        "parameters": create(parameters=[parameters]),
        "spawn_entity topic": node(
            "gazebo_ros", "spawn_entity.py", "-entity", "r", "-topic", "robot_description", "-timeout", "30", *pose
        ),
        "spawn_entity file": node("gazebo_ros", "spawn_entity.py", "-entity", "r", "-file", file, "-unpause", *pose),
        "gz_spawn_model": "IncludeLaunchDescription(os.path.join(get_package_share_directory('ros_gz_sim'), 'launch',"
        " 'gz_spawn_model.launch.py'), launch_arguments="
        + repr({"file": str(file), "entity_name": "r", **given})
        + ".items()),",
    }[form]
    launch = launched(tmp_path, publisher(file), entity)
    (robot,) = launch.scenario.robots
    assert (robot.name, robot.xyz, robot.rpy) == ("r", (1, -2, 0.5), (0.1, 0.2, -0.3))
    assert '<joint name="hinge"' in Path(robot.model).read_text()
    assert not_started(launch.scenario) == ()


@pytest.mark.parametrize(
    ("entity", "option"),
    [
        (("ros_gz_sim", "create", "-topic", "robot_description", "-zz", "1"), "-zz (did you mean -z?)"),
        (("ros_gz_sim", "create", "-topic", "robot_description", "-robot_namespace", "r"), "-robot_namespace"),
        (("gazebo_ros", "spawn_entity.py", "-entity", "r", "-topc", "robot_description", "-file", "{file}"),
         "-topc (did you mean -topic?)"),
    ],
)  # fmt: skip
def test_an_option_that_the_spawner_of_an_entity_does_not_have_is_a_finding(tmp_path, entity, option):
    file = write_hinge(tmp_path)
    launch = launched(tmp_path, publisher(file), node(*(word.format(file=file) for word in entity)))
    (finding,) = [item for item in launch.scenario.findings if "unknown option" in item.what]
    assert finding.what == f"{option}: unknown option of {entity[0]}/{entity[1]}"
    kind = Kind.REFUSED_BY_ROS if entity[0] == "gazebo_ros" else Kind.IGNORED  # gflags skips it, argparse ends
    assert (finding.kind, bool(finding.lines)) == (kind, True)


def test_what_create_does_not_know_names_and_moves_nothing(tmp_path):
    file = write_hinge(tmp_path)
    words = ("-topic", "robot_description", "-entity", "other", "-robot_namespace", "elsewhere")
    launch = launched(tmp_path, publisher(file), create(*words))
    (robot,) = launch.scenario.robots
    assert (robot.name, robot.namespace) == ("hinge", "/")


@pytest.mark.parametrize("shell", [False, True])
@pytest.mark.parametrize("program", ["gz", "ign"])
def test_a_call_of_gazebos_service_spawns_an_entity(tmp_path, program, shell):
    file = write_hinge(tmp_path)
    turned = f"orientation {{ z: {sin(0.15)}, w: {cos(0.15)} }}"
    request = f'sdf_filename: "{file}", name: "r" pose: {{ position: {{x: 1, y: -2; z: 0.5}} {turned} }}'
    words = (program, "service", "-s", "/world/w/create", "--reqtype", "gz.msgs.EntityFactory", "--req", request)
    entity = command("bash", "-c", f"sleep 2 && {shlex.join(words)}") if shell else command(*words)
    launch = launched(tmp_path, publisher(file), entity)
    (robot,) = launch.scenario.robots
    assert (robot.name, robot.xyz) == ("r", (1, -2, 0.5))
    assert robot.rpy == pytest.approx((0, 0, 0.3))
    assert not_started(launch.scenario) == ()


@pytest.mark.parametrize("request_text", ["", 'name: "r"', "} {", 'sdf_filename: { name: "r" }'])
def test_a_call_of_gazebos_service_without_a_description_is_named(tmp_path, request_text):
    entity = command("gz", "service", "-s", "/world/w/create", "--req", request_text)
    launch = launched_hinge(tmp_path, entity)
    assert list(robots(launch)) == ["hinge"]
    (reason,) = not_started(launch.scenario)
    assert "one of -topic, -file, -string and -param is needed" in reason


def test_another_call_of_gazebos_service_is_not_started(tmp_path):
    entity = command("gz", "service", "-s", "/world/w/set_pose", "--req", 'name: "hinge"')
    assert not_started(launched_hinge(tmp_path, entity).scenario) == (
        "gz (of programs, the twin starts only Python nodes)",
    )


MARKER = """<sdf version="1.9"><model name="marker"><link name="link"><inertial><mass>1</mass></inertial></link>
</model></sdf>"""


def test_texts_that_only_include_a_model_are_that_model(tmp_path):
    write(tmp_path / "models" / "marker" / "model.sdf", MARKER)
    write(
        tmp_path / "models" / "marker" / "model.config",
        "<model><name>marker</name><sdf version='1.9'>model.sdf</sdf></model>",
    )
    text = "<sdf version='1.9'><include><uri>model://marker</uri></include></sdf>"
    resources = f"AppendEnvironmentVariable('GZ_SIM_RESOURCE_PATH', {str(tmp_path / 'models')!r}),"
    pair = [create("-string", text, "-name", name, "-x", x) for name, x in (("one", "1"), ("two", "2"))]
    launch = launched(tmp_path, resources, *pair)
    assert [(plan.name, plan.robot.xyz, plan.description.links) for plan in launch.plans] == [
        ("one", (1, 0, 0), ("link",)),
        ("two", (2, 0, 0), ("link",)),
    ]
    assert [plan.frame_prefix for plan in launch.plans] == ["", "two/"]


def test_plugins_of_the_include_are_the_models_and_what_is_lost_is_a_finding(tmp_path):
    write(tmp_path / "models" / "marker" / "model.sdf", MARKER)
    text = "<sdf version='1.9'><include><uri>marker/model.sdf</uri><extra/>"
    text += "<plugin filename='gz-sim-pose-publisher-system' name='pose'/></include></sdf>"
    file = write(tmp_path / "models" / "both.sdf", text)
    (plan,) = launched(tmp_path, create("-file", file, "-name", "one")).plans
    assert [item.type for item in plan.controllers] == ["gz_sim/PosePublisher"]
    assert "<extra> in <include>" in [finding.what for finding in plan.findings]


def test_a_text_that_includes_a_missing_model_says_so(tmp_path):
    text = "<sdf version='1.9'><include><uri>model://nowhere</uri></include></sdf>"
    with pytest.raises(InputError, match="the model is not included: nowhere"):
        launched(tmp_path, create("-string", text, "-name", "one"))


def test_a_relative_file_is_in_the_working_folder_or_beside_the_launch_file(tmp_path, monkeypatch):
    here = tmp_path / "here"
    write_hinge(tmp_path)
    monkeypatch.chdir(tmp_path)
    (here / "models").mkdir(parents=True)
    launch = launched(here, create("-file", f"./{write_hinge(tmp_path).name}", "-name", "r"))
    assert list(robots(launch)) == ["r"]
    write_hinge(here / "models")
    launch = launched(here, create("-file", f"./models/{write_hinge(tmp_path).name}", "-name", "r"))
    assert list(robots(launch)) == ["r"]


def test_an_entity_without_a_name_has_its_descriptions(tmp_path):
    assert list(robots(launched_hinge(tmp_path))) == ["hinge"]
    launch = launched(tmp_path, publisher(write_hinge(tmp_path)), node("gazebo_ros", "spawn_entity.py", "-entity", "r"))
    assert list(robots(launch)) == ["hinge"]  # only displayed
    assert "one of -topic, -file" in not_started(launch.scenario)[0]


def test_the_plugins_namespace_is_the_robots(tmp_path):
    file = write_hinge(tmp_path, plugin="<ros><namespace>/left</namespace></ros>")
    (robot,) = launched(tmp_path, publisher(file), create("-topic", "robot_description")).scenario.robots
    assert robot.topic_namespace == "/left"
    assert robot.remapped("/left/robot_description") == "/robot_description"  # of the publisher, which is outside


def test_the_namespace_of_another_plugin_is_not_the_controller_managers(tmp_path):
    """As that of a tool's plugin: gz_ros2_control has its own, or none."""
    tool = '<plugin name="tool" filename="libtool.so"><ros><namespace>/tool</namespace></ros></plugin>'
    file = write_hinge(tmp_path, extra=f"<gazebo>{tool}</gazebo>")
    (robot,) = launched(tmp_path, create("-file", file), spawner("velocity")).scenario.robots
    assert (robot.topic_namespace, robot.active_controllers) == ("", ("velocity",))


def test_robot_namespaces_keep_two_of_one_description_apart(tmp_path):
    file = write_hinge(tmp_path)
    entities = [
        node("gazebo_ros", "spawn_entity.py", "-entity", name, "-file", file, "-robot_namespace", name)
        + spawner("velocity", "-c", f"/{name}/controller_manager")
        for name in ("left", "right")
    ]
    launch = launched(tmp_path, *entities)
    found = robots(launch)
    assert [robot.topic_namespace for robot in found.values()] == ["/left", "/right"]
    assert [robot.active_controllers for robot in found.values()] == [("velocity",), ("velocity",)]
    assert not_started(launch.scenario) == ()


def test_two_robots_in_one_namespace_are_kept_apart_and_both_run(tmp_path):
    from drake_twin.twin.twin import Twin

    launch = launched_hinge(tmp_path, create("-topic", "robot_description", "-name", "second", "-x", "2"))
    first, second = launch.scenario.robots
    assert (first.topic_namespace, second.topic_namespace) == ("", "/second")
    assert (first.frame_prefix, second.frame_prefix) == ("", "second/")
    assert [item.robot for item in launch.scenario.findings if item.kind is Kind.WARNING] == ["second", "second"]
    twin = Twin(launch.scenario)
    assert {"/robot_description", "/second/robot_description"} <= set(twin.graph.topics())
    frames = [item.child_frame_id for item in twin.latest("/tf").transforms]
    assert frames == ["arm", "second/arm"]


def test_many_robots_with_frames_of_the_same_names_are_one_line(tmp_path):
    file = write_hinge(tmp_path)
    names = ("one", "two", "three")
    entities = [create("-file", file, "-name", name, "-x", str(x)) for x, name in enumerate(names)]
    about = [line for _, line in grouped(launched(tmp_path, *entities).scenario.findings) if "/tf" in line]
    assert about == [
        "two, three: another robot publishes frames of the same names, so its own begin with its name and / on /tf"
    ]


LINKS_TOUCH = "<gazebo reference='arm'><selfCollide>1</selfCollide></gazebo>"
MODEL_TOUCHES = """<sdf version='1.9'><model name='m'><self_collide>true</self_collide>
<link name='l'><self_collide>true</self_collide></link></model></sdf>"""


@pytest.mark.parametrize(
    ("simulator", "text", "collides", "told"),
    [
        (gz("-r empty.sdf"), hinge(extra=LINKS_TOUCH), False, 1),
        (gz("-r empty.sdf"), hinge(), False, 0),
        (gz("-r empty.sdf"), MODEL_TOUCHES, True, 0),
        (command("gzserver", "empty.world"), hinge(extra=LINKS_TOUCH), None, 0),
    ],
)
def test_gazebo_sim_reads_the_self_collision_of_models_only(tmp_path, simulator, text, collides, told):
    """As DART 6.12 behind gz-physics 5 does; Gazebo classic reads that of links, as a twin without a launch file."""
    file = write(tmp_path / "robot.sdf", text)
    scenario = launched(tmp_path, simulator, create("-file", file, "-name", "one")).scenario
    assert [robot.self_collision for robot in scenario.robots] == [collides]
    assert ["<self_collide> has no effect" in item.what for item in scenario.findings].count(True) == told


def test_an_entity_that_exists_is_refused_as_gazebo_does(tmp_path):
    launch = launched_hinge(tmp_path, create("-topic", "robot_description", "-name", "hinge"))
    assert list(robots(launch)) == ["hinge"]
    (reason,) = not_started(launch.scenario)
    assert reason.startswith(f"ros_gz_sim/create: {tmp_path}/test.launch.py:")
    assert "Entity [hinge] already exists" in reason


@pytest.mark.parametrize(
    ("arguments", "names"),
    [
        (["-allow_renaming", "true"], ["hinge", "hinge_1"]),
        (["-allow_renaming"], ["hinge", "hinge_1"]),
        (["--allow-renaming"], ["hinge", "hinge_1"]),  # gflags takes dashes for underscores
        (["-allow_renaming=false"], ["hinge"]),
    ],
)
def test_an_entity_that_exists_is_renamed_where_that_is_allowed(tmp_path, arguments, names):
    entity = create("-topic", "robot_description", "-name", "hinge", *arguments)
    assert list(robots(launched_hinge(tmp_path, entity))) == names


@pytest.mark.parametrize("given", ["box", "box/", "{folder}/models/box", "model://box"])
def test_create_takes_a_models_name_or_folder(tmp_path, monkeypatch, given):
    monkeypatch.setenv("GZ_SIM_RESOURCE_PATH", str(tmp_path / "models"))
    write(tmp_path / "models/box/model.config", "<model><sdf version='1.9'>box.sdf</sdf></model>")
    write(tmp_path / "models/box/box.sdf", "<sdf version='1.9'><model name='box'><link name='l'/></model></sdf>")
    launch = launched(tmp_path, create("-file", given.format(folder=tmp_path), "-name", "b"))
    (robot,) = launch.scenario.robots
    assert Path(robot.model) == tmp_path / "models/box/box.sdf"


def test_spawn_entity_opens_a_file_only(tmp_path):
    write(tmp_path / "models/box/model.sdf", "<sdf version='1.9'><model name='box'><link name='l'/></model></sdf>")
    with pytest.raises(InputError, match="it is a folder, not a robot file"):
        launched(tmp_path, node("gazebo_ros", "spawn_entity.py", "-entity", "b", "-file", str(tmp_path / "models/box")))


def test_spawning_one_model_twice_through_launch_files_is_refused_too(tmp_path):
    file = write_hinge(tmp_path)
    include = (
        "IncludeLaunchDescription(os.path.join(get_package_share_directory('ros_gz_sim'), 'launch',"
        f" 'gz_spawn_model.launch.py'), launch_arguments={{'file': {str(file)!r}, 'entity_name': 'q'}}.items()),"
    )
    launch = launched(tmp_path, include, include)
    assert list(robots(launch)) == ["q"]
    assert "Entity [q] already exists" in not_started(launch.scenario)[0]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["-topic", "robot_description", "-name", "r", "-x", "far"], "-x is 'far', which is not a number"),
        (["-topic", "robot_description", "-name", "r", "-z", "nan"], "-z is 'nan', which is not finite"),
        (["-file", "/nowhere/r.sdf", "-name", "r"], "/nowhere/r.sdf"),
        (["-file", "https://fuel.gazebosim.org/r", "-name", "r"], "files are not downloaded"),
        (["-param", "nothing", "-name", "r"], "-param nothing: the node does not have this parameter"),
        (["-name", "r"], "one of -topic, -file, -string and -param is needed"),
    ],
)
def test_an_entity_that_cannot_be_made_is_named_and_the_other_robot_runs(tmp_path, arguments, message):
    launch = launched_hinge(tmp_path, create(*arguments))
    assert list(robots(launch)) == ["hinge"]
    (reason,) = not_started(launch.scenario)
    assert message in reason


def test_a_topic_that_nobody_publishes_is_said(tmp_path):
    file = write_hinge(tmp_path)
    launch = launched(tmp_path, publisher(file, namespace="a"), create("-topic", "robot_description", "-name", "r"))
    assert launch.log[0] == (
        "ros_gz_sim/create waits for /robot_description; the description on /a/robot_description is used instead"
    )
    two = launched(
        tmp_path,
        publisher(file, namespace="a"),
        publisher(file, namespace="b"),
        create("-topic", "/c/robot_description", "-name", "r"),
        create("-topic", "/b/robot_description", "-name", "s"),
    )
    assert list(robots(two)) == ["s"]
    assert "no node publishes a description on /c/robot_description" in not_started(two.scenario)[0]
    assert "Valid: /a/robot_description, /b/robot_description" in not_started(two.scenario)[0]


# --- without a simulator


def test_a_ros2_control_node_without_a_simulator_is_a_twin_of_its_robot(tmp_path):
    file, parameters = write(tmp_path / "r.urdf", hinge()), tmp_path / "controllers.yaml"
    write_hinge(tmp_path)
    control = node("controller_manager", "ros2_control_node", namespace="a", parameters=[str(parameters)])
    launch = launched(tmp_path, publisher(file, namespace="a"), control, spawner("states", "velocity", namespace="a"))
    (robot,) = launch.scenario.robots
    assert (robot.name, robot.topic_namespace, robot.controllers) == ("hinge", "/a", (str(parameters),))
    assert robot.active_controllers == ("states", "velocity")
    assert (launch.only_displayed, not_started(launch.scenario)) == (False, ())


def test_two_ros2_control_nodes_of_one_description(tmp_path):
    text = write_hinge(tmp_path).read_text()
    nodes = [
        node("controller_manager", "ros2_control_node", namespace=name, parameters=[{"robot_description": text}])
        for name in ("a", "b")
    ]
    launch = launched(tmp_path, *nodes, spawner("velocity", namespace="b"))
    assert [(robot.name, robot.topic_namespace) for robot in launch.scenario.robots] == [
        ("hinge", "/a"),
        ("hinge_1", "/b"),
    ]
    assert [robot.active_controllers for robot in launch.scenario.robots] == [(), ("velocity",)]


def test_a_ros2_control_nodes_remappings_name_its_controllers_topics(tmp_path):
    text = write_hinge(tmp_path).read_text()
    remappings = [("~/robot_description", "/robot_description"), ("/velocity/commands", "/go")]
    control = node(
        "controller_manager", "ros2_control_node", parameters=[{"robot_description": text}], remappings=remappings
    )
    (robot,) = launched(tmp_path, control, spawner("velocity")).scenario.robots
    assert robot.remapped("/velocity/commands") == "/go"


def test_a_ros2_control_node_beside_a_simulator_is_not_started(tmp_path):
    launch = launched_hinge(tmp_path, node("controller_manager", "ros2_control_node"))
    assert list(robots(launch)) == ["hinge"]
    (reason,) = not_started(launch.scenario)
    assert "the simulated robot has its own controller manager" in reason


def test_a_ros2_control_node_of_other_hardware_is_not_put_into_the_simulators_world(tmp_path):
    """As a driver that runs beside Gazebo: its robot would stand in the simulated one, and hear its spawners."""
    described = publisher(write(tmp_path / "real.urdf", hinge()), namespace="real")
    driver = node("controller_manager", "ros2_control_node", namespace="real")
    launch = launched_hinge(tmp_path, described, driver, spawner("velocity", namespace="real"))
    assert [(name, robot.active_controllers) for name, robot in robots(launch).items()] == [("hinge", ())]
    driver_reason, spawner_reason = not_started(launch.scenario)
    assert "its hardware is not in the simulator, which has 'hinge'" in driver_reason
    assert "/real/controller_manager is not started" in spawner_reason


# --- only to look at


def test_a_description_alone_is_displayed_with_its_joints_states(tmp_path):
    from drake_twin.twin.twin import Twin

    gui = node("joint_state_publisher_gui", "joint_state_publisher_gui")
    launch = launched(tmp_path, publisher(write_hinge(tmp_path)), gui)
    assert launch.only_displayed
    assert not_started(launch.scenario) == ()
    assert launch.scenario.world.gravity == (0, 0, 0)
    assert list(Twin(launch.scenario).latest("/joint_states").name) == ["hinge"]


def test_the_same_description_twice_is_displayed_once(tmp_path):
    entity = publisher(write_hinge(tmp_path))
    assert list(robots(launched(tmp_path, entity, entity))) == ["hinge"]


def test_nothing_to_run_is_one_paragraph_that_names_all_that_is_missing(tmp_path):
    with pytest.raises(InputError) as caught:
        launched(tmp_path, spawner("states"), node("nav2_bringup", "bringup"), create("-topic", "robot_description"))
    text = str(caught.value)
    assert "test.launch.py: the launch file starts no robot for its controllers (states)" in text
    assert "nav2_bringup/bringup (navigation is not a part of the twin: goals will not be planned or followed)" in text
    assert text.endswith("no node publishes a description on /robot_description.")
    assert "\n" not in text
