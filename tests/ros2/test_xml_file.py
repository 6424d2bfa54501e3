from pathlib import Path

import pytest
from launch_files import launch_xml, write

from drake_twin.errors import InputError
from drake_twin.ros2.evaluate import evaluate
from drake_twin.ros2.launched import ParameterText


def first(folder, elements, **arguments):
    return launch_xml(folder, elements, **arguments).processes[0]


def test_a_node_with_all_it_may_say(tmp_path):
    write(tmp_path / "subst.yaml", "x: $(var i)")
    node = first(
        tmp_path,
        """<arg name="i" default="1"/>
        <node pkg="p" exec="e" name="n$(var i)" namespace="r$(var i)" output="screen" respawn="true"
              args="-x $(var i) 'two words' --n=$(var i)" ros_args="--log-level debug" launch-prefix="xterm -e">
          <param name="number" value="5"/>
          <param name="text" value="5" type="str"/>
          <param name="list" value="1;2" sep=";"/>
          <param name="floats" value="[1, 2]" type="list_of_float"/>
          <param name="from_argument" value="$(var i)"/>
          <param name="robot_description" value="&lt;robot name='r: x'/&gt;" type="str"/>
          <param name="outer"><param name="inner" value="true"/></param>
          <param from="/a.yaml"/>
          <param from="$(dirname)/subst.yaml" allow_substs="true"/>
          <remap from="a" to="/b$(var i)"/>
          <env name="A" value="$(var i)"/>
        </node>""",
    )
    assert (node.what, node.full_name, node.output) == ("p/e", "/r1/n1", "screen")
    assert node.arguments == ("-x", "1", "two words", "--n=1")
    assert node.parameters == (
        {"number": 5},
        {"text": "5"},
        {"list": (1, 2)},
        {"floats": (1.0, 2.0)},
        {"from_argument": 1},
        {"robot_description": "<robot name='r: x'/>"},
        {"outer.inner": True},
        Path("/a.yaml"),
        ParameterText(tmp_path / "subst.yaml", "x: 1"),
    )
    assert node.remappings == (("a", "/b1"),)
    assert node.environment == {"A": "1"}


def test_groups_scopes_and_what_holds_in_them(tmp_path):
    launched = launch_xml(
        tmp_path,
        """<group>
          <push_ros_namespace namespace="a"/><push-ros-namespace namespace="b"/>
          <set_parameter name="p" value="1.5"/><set_remap from="x" to="y"/><set_env name="E" value="1"/>
          <set_use_sim_time value="true"/><let name="v" value="inner"/>
          <node pkg="p" exec="e" name="$(var v)"/>
        </group>
        <group scoped="false"><let name="v" value="leaks"/></group>
        <unset_env name="E"/><append_env name="E" value="2"/>
        <node pkg="p" exec="e" name="$(var v)"/>""",
    )
    inner, outer = launched.processes
    assert inner.full_name == "/a/b/inner"
    assert inner.parameters == ({"p": 1.5}, {"use_sim_time": True})
    assert (inner.remappings, inner.environment) == ((("x", "y"),), {"E": "1"})
    assert (outer.full_name, outer.parameters, outer.environment) == ("/leaks", (), {"E": "2"})


@pytest.mark.parametrize(
    ("attribute", "executed"),
    [('if="true"', True), ('if="0"', False), ('unless="$(var no)"', True), ("if=\"$(eval '1 > 2')\"", False)],
)
def test_conditions(tmp_path, attribute, executed):
    launched = launch_xml(tmp_path, f'<group {attribute}><node pkg="p" exec="e" {attribute}/></group>', no="False")
    assert len(launched.processes) == int(executed)


def test_a_command_a_timer_and_a_word(tmp_path):
    launched = launch_xml(
        tmp_path,
        """<timer period="2.0"><executable cmd="ros2 topic pub $(var t) '{data: 1}'" output="both" cwd="/tmp">
          <env name="A" value="1"/></executable></timer>
        <log message="hello $(var t)"/><log message="careful" level="WARNING"/><log_info message="info"/>""",
        t="/x",
    )
    (process,) = launched.processes
    assert (process.executable, process.arguments, process.start_time) == (
        "ros2",
        ("topic", "pub", "/x", "{data: 1}"),
        2.0,
    )
    assert launched.log == ("hello /x", "[WARNING] careful", "info")


def test_containers_and_lifecycle_nodes(tmp_path):
    launched = launch_xml(
        tmp_path,
        """<node_container pkg="rclcpp_components" exec="component_container" name="c" namespace="r">
          <composable_node pkg="p" plugin="p::A" name="a"><param name="x" value="1"/><remap from="i" to="o"/>
            <extra_arg name="use_intra_process_comms" value="true"/></composable_node>
        </node_container>
        <load_composable_node target="/r/c"><composable_node pkg="p" plugin="p::B" name="b"/></load_composable_node>
        <lifecycle_node pkg="p" exec="e" name="l" namespace=""/>""",
    )
    assert [(item.kind, item.full_name, item.container) for item in launched.processes] == [
        ("node", "/r/c", None),
        ("component", "/a", "/r/c"),  # a container's own namespace is not its components'
        ("component", "/b", "/r/c"),
        ("node", "/l", None),
    ]


def test_choices_of_an_argument(tmp_path):
    argument = '<arg name="mode" default="a"><choice value="a"/><choice value="b"/></arg>'
    assert launch_xml(tmp_path, argument, mode="b").configurations["mode"] == "b"
    with pytest.raises(InputError, match=r"xml:2: the argument 'mode' is 'c', .* Valid: a, b"):
        launch_xml(tmp_path, argument, mode="c")


def test_gazebos_own_elements(tmp_path):
    launched = launch_xml(
        tmp_path, '<gz_server world_sdf_file="/w.sdf"/><ros_gz_bridge bridge_name="b" config_file="/b.yaml"/>'
    )
    assert [item.what for item in launched.processes] == [
        "ros_gz_sim/gz_server.launch.py",
        "ros_gz_bridge/parameter_bridge",
    ]


@pytest.mark.parametrize(
    ("elements", "reason"),
    [
        ("<nod/>", r"xml:2: <nod>: unknown element. Did you mean 'node'"),
        ('<node pkg="p"/>', r"xml:2: <node>: the attribute 'exec' is missing"),
        ('<node pkg="p" exe="e"/>', r"xml:2: <node>: unknown attribute 'exe'. Did you mean 'exec'\?.* unless"),
        ('<set_parameter nam="x"/>', r"<set_parameter>: unknown attribute 'nam'. Did you mean 'name'\?.* value"),
        ('<node pkg="p" exec="e" nam="x"/>', r"xml:2: <node>: unknown attribute 'nam'. Did you mean 'name'"),
        ('<node pkg="p" exec="e"><parm/></node>', r"<parm>: not an element of <node>. Did you mean 'param'"),
        ('<node pkg="p" exec="e"><param value="1"/></node>', r"<param>: a param has a name or a file"),
        ('<node pkg="p" exec="e"><param name="x"/></node>', r"<param>: the attribute 'value' is missing"),
        (
            '<node pkg="p" exec="e"><param name="x" value="1" type="sting"/></node>',
            "unknown type 'sting'. Valid: str, int",
        ),
        ('<node pkg="p" exec="e" if="1" unless="0"/>', "if and unless cannot both be given"),
        ('<include file="x"><node/></include>', "<node>: not an element of <include>. Valid: arg, let"),
        ('<node pkg="p" type="e" name="n"/>', "this is a ROS 1 launch file"),
        ('<rosparam command="load"/>', "this is a ROS 1 launch file"),
        ('<group ns="r"/>', "this is a ROS 1 launch file"),
        ('<env name="A" value="1"/>', "this is a ROS 1 launch file"),
    ],
)
def test_what_is_wrong_is_refused_with_its_line(tmp_path, elements, reason):
    with pytest.raises(InputError, match=reason):
        launch_xml(tmp_path, elements)


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("<launch><node></launch>", r"x.launch.xml:1: this is not well-formed XML"),
        ("<robot/>", "<robot>: a launch file's outermost element is launch"),
        ("", "not well-formed"),
        (
            '<!DOCTYPE l [<!ENTITY a "aaaaaaaaaa">'
            + "".join(f'<!ENTITY {chr(98 + i)} "{10 * f"&{chr(97 + i)};"}">' for i in range(9))
            + ']><launch><log message="&j;"/></launch>',
            "not well-formed XML",
        ),
        (
            '<!DOCTYPE l [<!ENTITY a SYSTEM "file:///etc/passwd">]><launch><log message="&a;"/></launch>',
            "not well-formed",
        ),
    ],
)
def test_what_is_no_xml_launch_file_is_refused(tmp_path, text, reason):
    with pytest.raises(InputError, match=reason):
        evaluate(write(tmp_path / "x.launch.xml", text))


def test_a_file_that_is_not_text_is_refused(tmp_path):
    file = tmp_path / "x.launch.xml"
    file.write_bytes(b"\xff\xfe\x00<")
    with pytest.raises(InputError, match="this is not UTF-8 text"):
        evaluate(file)


def test_the_kind_of_a_file_without_an_ending_is_told_by_its_start(tmp_path):
    assert evaluate(write(tmp_path / "x.launch", "<launch><log message='x'/></launch>")).log == ("x",)
    assert evaluate(write(tmp_path / "y.launch", "launch:\n- log: {message: y}\n")).log == ("y",)
    with pytest.raises(InputError, match=r"a launch file's name ends with one of these, and this one's is 'z.launch'"):
        evaluate(write(tmp_path / "z.launch", "hello"))
