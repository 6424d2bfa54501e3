import pytest
from launch_files import launch_python, launch_xml, write, write_package, write_python

from drake_twin.errors import InputError

NODE = '<launch><arg name="who" default="nobody"/><node pkg="p" exec="e" name="$(var who)"/></launch>'


def test_an_include_is_no_scope_so_its_arguments_leak_as_in_ros(tmp_path):
    write(tmp_path / "one.launch.xml", NODE)
    launched = launch_xml(
        tmp_path,
        """<include file="$(dirname)/one.launch.xml"><arg name="who" value="a"/></include>
        <include file="$(dirname)/one.launch.xml"/>
        <node pkg="p" exec="e" name="$(var who)"/>""",
    )
    assert [process.name for process in launched.processes] == ["a", "a", "a"]


def test_a_group_keeps_an_includes_arguments_to_itself(tmp_path):
    write(tmp_path / "one.launch.xml", NODE)
    launched = launch_xml(
        tmp_path,
        """<group><include file="$(dirname)/one.launch.xml"><arg name="who" value="a"/></include></group>
        <include file="$(dirname)/one.launch.xml"/>""",
    )
    assert [process.name for process in launched.processes] == ["a", "nobody"]


@pytest.mark.parametrize(
    "source",
    [
        "PythonLaunchDescriptionSource(os.path.join(os.path.dirname(__file__), 'x.launch.py'))",
        "PythonLaunchDescriptionSource([ThisLaunchFileDir(), '/x.launch.py'])",
        "AnyLaunchDescriptionSource([ThisLaunchFileDir(), '/x.launch.py'])",
        "PathJoinSubstitution([ThisLaunchFileDir(), 'x.launch.py'])",
        "[ThisLaunchFileDir(), '/x.launch.py']",
        """LaunchDescription([DeclareLaunchArgument('a', default_value='none'),
             Node(package='p', executable='e', name=LaunchConfiguration('a'))])""",
    ],
)
@pytest.mark.parametrize("arguments", ["{'a': 'b'}.items()", "[('a', 'b')]", "{'a': 'b'}", "[('a', ['', 'b'])]"])
def test_an_include_takes_sources_paths_and_descriptions_and_pairs_of_arguments(tmp_path, source, arguments):
    write_python(
        tmp_path / "x.launch.py",
        "DeclareLaunchArgument('a', default_value='none'),"
        "Node(package='p', executable='e', name=LaunchConfiguration('a'))",
    )
    launched = launch_python(tmp_path, f"IncludeLaunchDescription({source}, launch_arguments={arguments})")
    assert [process.name for process in launched.processes] == ["b"]


def test_an_include_of_an_absent_package_is_left_out_and_the_launch_goes_on(tmp_path):
    launched = launch_xml(
        tmp_path,
        """<include file="$(find-pkg-share nav2_bringup)/launch/bringup_launch.py"/>
        <node pkg="p" exec="e"/>""",
    )
    (failed,) = launched.failed_includes
    assert failed.what.endswith("nav2_bringup/launch/bringup_launch.py")
    assert failed.reason.startswith("package 'nav2_bringup' is absent")
    assert failed.place.line == 2
    assert len(launched.processes) == 1


def test_an_include_that_needs_an_absent_python_module_is_left_out(tmp_path):
    write(tmp_path / "moveit.launch.py", "from launch_pal import helpers\n")
    launched = launch_xml(tmp_path, '<include file="$(dirname)/moveit.launch.py"/><node pkg="p" exec="e"/>')
    (failed,) = launched.failed_includes
    assert failed.reason == "needs the Python module launch_pal, which is not there"
    assert len(launched.processes) == 1


def test_an_absent_package_that_an_include_reads_from_ends_that_include_only(tmp_path):
    write_python(
        tmp_path / "robot.launch.py",
        "Node(package='p', executable='first'), LogInfo(msg=open(get_package_share_directory('gone') + '/x').read())",
    )
    launched = launch_xml(tmp_path, '<include file="$(dirname)/robot.launch.py"/><node pkg="p" exec="after"/>')
    assert "package 'gone' is absent" in launched.failed_includes[0].reason
    assert [process.executable for process in launched.processes] == ["after"]


def test_what_an_include_started_before_it_failed_is_said(tmp_path):
    write_python(
        tmp_path / "robot.launch.py",
        "Node(package='p', executable='first'), LogInfo(msg=Command(['xacro ', FindPackageShare('gone'), '/x.xacro']))",
    )
    launched = launch_xml(tmp_path, '<include file="$(dirname)/robot.launch.py"/>')
    assert launched.failed_includes[0].reason.endswith("(1 of its processes had started before)")


def test_the_top_file_itself_may_not_need_absent_modules(tmp_path):
    with pytest.raises(InputError, match=r"test.launch.py:\d+: needs the Python module launch_pal, which is not there"):
        launch_python(tmp_path, "", before="from launch_pal.include_utils import include_launch_py_description")


def test_an_include_that_is_not_there_says_where_it_was_looked_for(tmp_path):
    package = write_package(tmp_path, "robots")
    write(package / "launch" / "spawn_robot.launch.py", "")
    with pytest.raises(InputError) as error:
        launch_xml(tmp_path, '<include file="$(find-pkg-share robots)/launch/spawn_robots.launch.py"/>')
    assert f"looked in {package}/launch" in str(error.value)
    assert "Did you mean 'spawn_robot.launch.py'?" in str(error.value)
    assert str(error.value).startswith(f"{tmp_path}/test.launch.xml:2")


def test_a_folder_that_is_not_there_is_named(tmp_path):
    with pytest.raises(InputError, match=r"the folder .*/nowhere does not exist"):
        launch_xml(tmp_path, '<include file="$(dirname)/nowhere/x.launch.py"/>')


def test_files_that_include_each_other_are_a_loop(tmp_path):
    write(tmp_path / "a.launch.xml", '<launch><include file="$(dirname)/b.launch.xml"/></launch>')
    write(tmp_path / "b.launch.xml", '<launch><include file="$(dirname)/a.launch.xml"/></launch>')
    with pytest.raises(InputError, match=r"in a loop: .*a.launch.xml → b.launch.xml → a.launch.xml"):
        launch_xml(tmp_path, '<include file="$(dirname)/a.launch.xml"/>')


def test_a_file_may_include_itself_as_long_as_it_comes_to_an_end(tmp_path):
    launched = launch_xml(
        tmp_path,
        """<arg name="n" default="3"/><node pkg="p" exec="e" name="r$(var n)"/>
        <group if="$(eval '$(var n) > 1')">
          <include file="$(filename)"><arg name="n" value="$(eval '$(var n) - 1')"/></include>
        </group>""",
    )
    assert [process.name for process in launched.processes] == ["r3", "r2", "r1"]


def test_an_included_files_required_arguments_are_listed_with_who_includes_it(tmp_path):
    write(tmp_path / "x.launch.xml", '<launch><arg name="a"/><arg name="b"/></launch>')
    with pytest.raises(InputError, match=r"included by .*test.launch.xml:2, needs values for its arguments: a, b"):
        launch_xml(tmp_path, '<include file="$(dirname)/x.launch.xml"/>')


def test_an_authors_own_path_is_found_by_the_package_in_it(tmp_path):
    package = write_package(tmp_path, "robots")
    write(package / "launch" / "one.launch.xml", NODE)
    launched = launch_xml(tmp_path, '<include file="/home/someone/ws/src/robots/launch/one.launch.xml"/>')
    assert [process.name for process in launched.processes] == ["nobody"]
    assert launched.absent_packages == ()


def test_the_installed_layout_of_a_source_package_is_what_includes_see(tmp_path):
    package = write_package(tmp_path, "robots")
    write(
        package / "CMakeLists.txt",
        "project(robots)\ninstall(DIRECTORY bringup/launch DESTINATION share/${PROJECT_NAME})\n",
    )
    write_package(tmp_path, "others")
    write(
        package / "bringup" / "launch" / "one.launch.xml",
        '<launch><log message="$(find-pkg-share others)"/><log message="$(dirname)"/></launch>',
    )
    launched = launch_xml(tmp_path, '<include file="$(find-pkg-share robots)/launch/one.launch.xml"/>')
    assert launched.log[0] == f"{tmp_path}/others"
    assert launched.log[1].endswith("robots/launch")


INCLUDED = {
    "declares it": "DeclareLaunchArgument('x', default_value='1')",
    "reads it": "LogInfo(msg=LaunchConfiguration('x', default='1'))",
    "reads it in a function": "OpaqueFunction(function=lambda it: LaunchConfiguration('x').perform(it) and [])",
    "hands it on": "IncludeLaunchDescription(os.path.join(os.path.dirname(__file__), 'inner.launch.py'))",
    "does not know it": "DeclareLaunchArgument('xy', default_value='1')",
}


@pytest.mark.parametrize("case", INCLUDED)
def test_an_argument_of_an_include_that_no_file_declares_or_reads_is_noted(tmp_path, case):
    write_python(tmp_path / "inner.launch.py", INCLUDED["declares it"])
    write_python(tmp_path / "part.launch.py", INCLUDED[case])
    arguments = "launch_arguments={'x': '2'}.items()"
    launched = launch_python(
        tmp_path, f"IncludeLaunchDescription(os.path.join(os.path.dirname(__file__), 'part.launch.py'), {arguments})"
    )
    told = "argument x of include part.launch.py (no file declares or reads it). Did you mean 'xy'?"
    assert [item.what for item in launched.lost_arguments] == ([told] if case == "does not know it" else [])
    assert all(item.place.line is not None for item in launched.lost_arguments)


def test_an_argument_of_gazebos_launch_file_that_it_does_not_have_is_noted(tmp_path):
    path = "os.path.join(get_package_share_directory('ros_gz_sim'), 'launch', 'gz_sim.launch.py')"
    launched = launch_python(
        tmp_path, f"IncludeLaunchDescription({path}, launch_arguments={{'gz_arg': 'empty.sdf'}}.items())"
    )
    (lost,) = launched.lost_arguments
    assert lost.what == (
        "argument gz_arg of include gz_sim.launch.py (no file declares or reads it). Did you mean 'gz_args'?"
    )


def test_an_argument_that_an_include_gives_twice_is_noted(tmp_path):
    write(tmp_path / "part.launch.xml", '<launch><arg name="x"/></launch>')
    include = '<include file="$(dirname)/part.launch.xml"><arg name="x" value="1"/><arg name="x" value="2"/></include>'
    (lost,) = launch_xml(tmp_path, include).lost_arguments
    assert lost.what == "argument x of include part.launch.xml (it is given again, and the last value counts)"
