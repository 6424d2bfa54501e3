from pathlib import Path

import pytest
from launch_files import launch_python

from drake_twin.errors import InputError


def first(folder, entities, before="", **arguments):
    return launch_python(folder, entities, before, **arguments).processes[0]


def test_a_node_with_all_it_may_say(tmp_path):
    node = first(
        tmp_path,
        """PushRosNamespace("fleet"),
        Node(package="p", executable="e",
             name=["n", LaunchConfiguration("i")], namespace=["r", LaunchConfiguration("i")],
             parameters=["/a.yaml", {"x": 1}], remappings=[("a", "b"), (["c", LaunchConfiguration("i")], "d")],
             arguments=["-x", LaunchConfiguration("i"), ["--n=", LaunchConfiguration("i")]], output="screen",
             additional_env={"A": "1"}, respawn=True, emulate_tty=True, prefix=["xterm -e"], exec_name="z")""",
        i="1",
    )
    assert (node.kind, node.what, node.full_name) == ("node", "p/e", "/fleet/r1/n1")
    assert node.parameters == (Path("/a.yaml"), {"x": 1})
    assert node.remappings == (("a", "b"), ("c1", "d"))
    assert node.arguments == ("-x", "1", "--n=1")
    assert (node.output, node.environment) == ("screen", {"A": "1"})


@pytest.mark.parametrize(
    ("pushed", "given", "namespace"),
    [
        ((), None, "/"),
        ((), "r", "/r"),
        (("a",), None, "/a"),
        (("a", "b"), "c", "/a/b/c"),
        (("a", "/b"), "c", "/b/c"),
        (("a",), "/c", "/c"),
        (("",), "", "/"),
    ],
)
def test_namespaces_are_stacked_as_in_ros(tmp_path, pushed, given, namespace):
    pushes = "".join(f"PushRosNamespace({name!r})," for name in pushed)
    assert first(tmp_path, f"{pushes} Node(package='p', executable='e', namespace={given!r})").namespace == namespace


def test_parameters_and_remappings_for_all_nodes_come_before_a_nodes_own(tmp_path):
    (tmp_path / "all.yaml").write_text("")
    node = first(
        tmp_path,
        """SetUseSimTime(True), SetParameter("rate", value="50"),
        SetParametersFromFile([ThisLaunchFileDir(), "/all.yaml"]),
        SetRemap("tf", "/tf"), Node(package="p", executable="e", parameters=[{"rate": 10}], remappings=[("a", "b")])""",
    )
    assert node.parameters == ({"use_sim_time": True}, {"rate": 50}, tmp_path / "all.yaml", {"rate": 10})
    assert node.remappings == (("tf", "/tf"), ("a", "b"))


def test_what_ros_args_say_is_taken_apart(tmp_path):
    node = first(
        tmp_path,
        """Node(package="p", executable="e", name="old", ros_arguments=["--log-level", "debug", "-r", "x:=y"],
                arguments=["own", "--ros-args", "-r", "__ns:=/r", "-r", "__node:=new", "--remap", "a:=b", "-p",
                           "k:=2.5", "--params-file", "/f.yaml", "--", "more"])""",
    )
    assert node.arguments == ("own", "more")
    assert node.full_name == "/r/new"
    assert node.remappings == (("a", "b"), ("x", "y"))
    assert node.parameters == ({"k": 2.5}, Path("/f.yaml"))


@pytest.mark.parametrize(
    ("executable", "ends"),
    [
        ("spawner", True),
        ("spawner.py", True),
        ("unspawner", True),
        ("create", True),
        ("spawn_entity.py", True),
        ("robot_state_publisher", False),
        ("parameter_bridge", False),
        ("ros2_control_node", False),
        ("static_transform_publisher", False),
    ],
)
def test_which_executables_do_their_work_and_end(tmp_path, executable, ends):
    assert first(tmp_path, f"Node(package='p', executable='{executable}')").ends is ends


def test_composable_nodes_are_listed_with_their_container(tmp_path):
    launched = launch_python(
        tmp_path,
        """PushRosNamespace("r"), ComposableNodeContainer(name="c", namespace="", package="rclcpp_components",
            executable="component_container", composable_node_descriptions=[
                ComposableNode(package="p", plugin="p::A", name="a", parameters=[{"x": 1}], remappings=[("i", "o")]),
                ComposableNode(package="p", plugin="p::B", condition=IfCondition("false"))]),
        LoadComposableNodes(target_container="c", composable_node_descriptions=[
            ComposableNode(package="p", plugin="p::C", namespace="/abs")]),""",
    )
    container, a, c = launched.processes
    assert (container.kind, container.full_name) == ("node", "/r/c")
    assert (a.kind, a.executable, a.full_name, a.container) == ("component", "p::A", "/r/a", "/r/c")
    assert (a.parameters, a.remappings) == (({"x": 1},), (("i", "o"),))
    assert (c.namespace, c.container) == ("/abs", "/r/c")


def test_a_nodes_full_name_is_known_once_it_has_been_started(tmp_path):
    launched = launch_python(
        tmp_path,
        "node, OpaqueFunction(function=lambda context: [LogInfo(msg=node.node_name)])",
        "node = Node(package='p', executable='e', name='n', namespace='r')",
    )
    assert launched.log == ("/r/n",)


def test_an_action_of_the_files_own_is_executed(tmp_path):
    node = first(
        tmp_path,
        "Twice(package='p', executable='e', name='n')",
        "class Twice(Node):\n    def execute(self, context):\n        super().execute(context)\n"
        "        return [LogInfo(msg='x')]",
    )
    assert node.full_name == "/n"
    assert node.place.line == 20


@pytest.mark.parametrize(
    ("entity", "reason"),
    [
        ("Node(package='p')", "missing 1 required keyword-only argument: 'executable'"),
        (
            "Node(package='p', executable='e', remappings=[('a',)])",
            "a remapping is a pair (from, to), and this is ('a',)",
        ),
        ("Node(package='p', executable='e', parameters={'a': 1})", "parameters is a list of files and mappings"),
        (
            "Node(package='p', executable='e', parameters=[5])",
            "parameters holds files and mappings, and 5 is of type int",
        ),
        ("Node(package='p', executable='e', parameters=[{'a': None}])", "parameter 'a' is None, of type NoneType"),
        ("Node(package='p', executable='e', name=5)", "text, a substitution or a list of them is needed, and 5 is"),
    ],
)
def test_a_node_that_is_wrong_is_refused(tmp_path, entity, reason):
    with pytest.raises(InputError) as error:
        launch_python(tmp_path, entity)
    assert reason in str(error.value)
    assert "test.launch.py" in str(error.value)


def test_the_keywords_of_foxy_are_read_and_said(tmp_path):
    launched = launch_python(tmp_path, "Node(package='p', node_executable='e', node_name='n', node_namespace='s')")
    (node,) = launched.processes
    assert (node.executable, node.name, node.namespace) == ("e", "n", "/s")
    assert [item.what.split()[0] for item in launched.refused_by_ros] == [
        *("node_executable", "node_name", "node_namespace"),
    ]


@pytest.mark.parametrize(
    ("entity", "reason"),
    [
        (
            "Node(pakage='p', executable='e')",
            "Node got an unexpected .* 'pakage'. Did you mean 'package'",
        ),
        ("Node(package='p', executable='e', parameter=[])", "Did you mean 'parameters'"),
        ("ExecuteProcess(cmd=['ls'], outputs='screen')", "ExecuteProcess got an .* Did you mean 'output'"),
        ("Node(package='p')", "missing 1 required keyword-only argument: 'executable'"),
    ],
)
def test_a_misspelt_keyword_is_refused_as_in_ros(tmp_path, entity, reason):
    with pytest.raises(InputError, match=reason):
        launch_python(tmp_path, entity)
