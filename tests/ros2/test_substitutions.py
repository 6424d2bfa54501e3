import pytest
from launch_files import launch_python, value_of, write, write_package

from drake_twin.errors import InputError

XACRO = (
    '<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro"><xacro:arg name="n" default="none"/>'
    '<link name="$(arg n)"/></robot>'
)


@pytest.mark.parametrize(
    ("substitution", "value"),
    [
        ("TextSubstitution(text='a')", "a"),
        ("['a', TextSubstitution(text='b'), ['c']]", "abc"),
        ("LaunchConfiguration('given')", "5"),
        ("[LaunchConfiguration('given'), 'x']", "5x"),
        ("LaunchConfiguration('none', default='d')", "d"),
        ("LaunchConfiguration('none', default=['d', LaunchConfiguration('given')])", "d5"),
        ("EnvironmentVariable('A_VARIABLE')", "set"),
        ("EnvironmentVariable('NO_VARIABLE', default_value='d')", "d"),
        ("PathJoinSubstitution(['/a', 'b', LaunchConfiguration('given')])", "/a/b/5"),
        ("PathJoinSubstitution(['/a', [LaunchConfiguration('given'), '.yaml']])", "/a/5.yaml"),
        ("PathSubstitution('/a') / 'b' / [LaunchConfiguration('given'), '.yaml']", "/a/b/5.yaml"),
        ("FindPackageShare('none') / 'urdf'", "/package-not-found/none/urdf"),
        ("PythonExpression(['2 * ', LaunchConfiguration('given'), ' + 1'])", "11"),
        ("PythonExpression(['\"', LaunchConfiguration('given'), '\" == \"5\" and True'])", "True"),
        ("PythonExpression(['math.pi > 3 and sin(0) == 0'])", "True"),
        ("PythonExpression(['os.path.join(\"a\", \"b\")'], python_modules=['os'])", "a/b"),
        ("PythonExpression('[x for x in (1, 2)][-1]')", "2"),
        ("Command(['echo ', LaunchConfiguration('given')])", "5\n"),
        ("Command('sh -c \"echo out; echo warning >&2\"', on_stderr='ignore')", "out\n"),
        ("FindExecutable(name='sh')", "sh"),
        ("FindExecutable(name='ros2')", "ros2"),
        ("FindExecutable(name='xacro')", "xacro"),
        ("EqualsSubstitution('1', 1.0)", "true"),
        ("EqualsSubstitution('True', 'true')", "true"),
        ("EqualsSubstitution('a', 'b')", "false"),
        ("NotEqualsSubstitution(LaunchConfiguration('given'), '5')", "false"),
        ("NotSubstitution('False')", "true"),
        ("AndSubstitution('true', NotSubstitution('true'))", "false"),
        ("OrSubstitution('true', 'false')", "true"),
        ("AllSubstitution('true', '1', 'True')", "true"),
        ("AnySubstitution('false', '0')", "false"),
        ("IfElseSubstitution('true', if_value='a', else_value='b')", "a"),
        ("IfElseSubstitution(EqualsSubstitution('x', 'y'), 'a', 'b')", "b"),
        ("StringJoinSubstitution(['a', 'b'], delimiter=', ')", "a, b"),
        ("AnonName('x')", "x_1"),
        ("[AnonName('x'), AnonName('y'), AnonName('x')]", "x_1y_2x_1"),
        ("FindPackageShare(package='none').find('none')", "/package-not-found/none"),
        ("ExecutableInPackage('run', 'none')", "/package-not-found/none/lib/none/run"),
    ],
)
def test_what_a_substitution_gives(tmp_path, monkeypatch, substitution, value):
    monkeypatch.setenv("A_VARIABLE", "set")
    monkeypatch.delenv("NO_VARIABLE", raising=False)
    result = value_of(tmp_path, substitution, given="5")
    assert result.removeprefix("/usr").removeprefix("/bin/") == value


@pytest.mark.parametrize(
    ("substitution", "reason"),
    [
        ("LaunchConfiguration('gven')", "launch configuration 'gven' does not exist. Did you mean 'given'"),
        ("EnvironmentVariable('NO_VARIABLE')", "environment variable 'NO_VARIABLE' is not set"),
        ("PythonExpression('9**9**9')", "the Python expression '9**9**9' fails: OverflowError: 9 ** 387420489 has too"),
        ("PythonExpression('1 / 0')", "the Python expression '1 / 0' fails: ZeroDivisionError: division by zero"),
        ("Command('false')", "the command 'false' fails with exit code 1"),
        ("Command('no_such_command_here x')", "cannot be run: no_such_command_here: No such file or directory"),
        ("NotSubstitution('maybe')", "'maybe' is neither true nor false"),
        ("FileContent('/none')", "/none: cannot be read"),
    ],
)
def test_a_substitution_that_fails_names_file_line_and_reason(tmp_path, substitution, reason):
    with pytest.raises(InputError) as error:
        value_of(tmp_path, substitution, given="5")
    assert reason in str(error.value)
    if not reason.startswith("/"):
        assert str(error.value).startswith(f"{tmp_path}/test.launch.py:17: ")


def test_a_substitution_that_does_not_exist_is_refused_with_its_line(tmp_path):
    with pytest.raises(InputError, match=r"test.launch.py:13: launch.substitutions has no 'PathJoin'"):
        value_of(tmp_path, "'x'", before="from launch.substitutions import PathJoin")


def test_perform_gives_the_text_in_an_opaque_function(tmp_path):
    launched = launch_python(
        tmp_path,
        "OpaqueFunction(function=say, args=['n is '], kwargs={'end': '!'})",
        before="def say(context, start, end):\n"
        "    n = LaunchConfiguration('n').perform(context)\n"
        "    assert context.launch_configurations['n'] == n == context.perform_substitution(LaunchConfiguration('n'))\n"
        "    return [LogInfo(msg=start + n + end)]\n",
        n="3",
    )
    assert launched.log == ("n is 3!",)


def test_a_substitution_of_the_files_own_is_performed(tmp_path):
    before = "class Twice(Substitution):\n    def __init__(self, s):\n        self.s = s\n"
    before += "    def perform(self, context):\n        return 2 * self.s.perform(context)\n"
    assert value_of(tmp_path, "[Twice(LaunchConfiguration('n')), 'x']", before, n="ab") == "ababx"


def test_the_launch_file_and_its_folder(tmp_path):
    assert value_of(tmp_path, "[ThisLaunchFile(), '|', ThisLaunchFileDir()]") == f"{tmp_path}/test.launch.py|{tmp_path}"


@pytest.mark.parametrize("command", ["'xacro '", "FindExecutable(name='xacro'), ' '", "'/opt/ros/jazzy/bin/xacro '"])
def test_xacro_is_expanded_by_the_twin_itself(tmp_path, command):
    package = write_package(tmp_path, "robots")
    write(package / "r.xacro", XACRO)
    text = value_of(
        tmp_path,
        f"Command([{command}, FindPackageShare('robots'), '/r.xacro', ' n:=', LaunchConfiguration('n')])",
        n="b",
    )
    assert '<link name="b"/>' in text


def test_a_xacro_file_at_its_authors_path_is_found_by_the_package_in_it(tmp_path):
    write(write_package(tmp_path, "robots") / "urdf" / "r.xacro", XACRO)
    assert '<link name="none"/>' in value_of(tmp_path, "Command('xacro /home/me/ws/src/robots/urdf/r.xacro')")


def test_a_xacro_file_that_is_wrong_is_refused_with_its_own_name(tmp_path):
    write(tmp_path / "r.xacro", "<robot>")
    with pytest.raises(InputError, match=r"r.xacro:1: this is not well-formed XML"):
        value_of(tmp_path, "Command(['xacro ', ThisLaunchFileDir(), '/r.xacro'])")


def test_xacros_warnings_do_not_stop_the_launch(tmp_path):
    write(tmp_path / "r.xacro", XACRO.replace("<link", '<xacro:property name="a" value="1"/><link'))
    assert '<link name="none"/>' in value_of(tmp_path, "Command(['xacro ', ThisLaunchFileDir(), '/r.xacro'])")


def test_a_nodes_parameter_is_known_to_ros2_param_get(tmp_path):
    launched = launch_python(
        tmp_path,
        "Node(package='p', executable='robot_state_publisher', parameters=[{'robot_description': 'URDF'}]),"
        "LogInfo(msg=Command('ros2 param get --hide-type /robot_state_publisher robot_description'))",
    )
    assert launched.log == ("URDF",)


def test_locals_of_an_event_are_known(tmp_path):
    launched = launch_python(
        tmp_path,
        "RegisterEventHandler(OnShutdown(on_shutdown=[LogInfo(msg=LocalSubstitution('event.reason'))])),"
        "Shutdown(reason='done')",
    )
    assert launched.log == ("done",)
