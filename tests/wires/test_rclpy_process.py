"""``--ros rclpy`` and ``--ros`` alone: which is chosen, what is refused, and what is said of it."""

import ast
import socket
import sys
from pathlib import Path

import pytest
from program_runs import refused, run
from wires.rclpy_network import SOURCED, Network

from drake_twin.cli.options import parser
from drake_twin.errors import InputError
from drake_twin.ros2.ros_arguments import without_ros_arguments
from drake_twin.wires import rclpy_program
from drake_twin.wires.kinds import ros
from drake_twin.wires.rclpy_process import find_rclpy

TWIN = ("--robots", 1, "--headless", "--duration", 0.01)
WIRES = Path(rclpy_program.__file__).parent
OF_PROCESS = ("program", "graph", "waiter", "endpoints", "classes", "records")


@pytest.fixture
def bare(monkeypatch):
    """A machine without ROS."""
    for name in ("PYTHONPATH", "AMENT_PREFIX_PATH", "ROS_DISTRO", "RMW_IMPLEMENTATION", "ROS_DOMAIN_ID"):
        monkeypatch.delenv(name, raising=False)
    if find_rclpy() is not None:
        pytest.skip("an rclpy is installed where the tests' packages are")


@pytest.fixture
def sourced(bare, monkeypatch):
    """A machine on which the double is sourced."""
    monkeypatch.setenv("PYTHONPATH", SOURCED)
    monkeypatch.setenv("ROS_DISTRO", "jazzy")


def rclpy_in(folder, *files):
    package = folder / "rclpy"
    package.mkdir(parents=True)
    for name, text in (("__init__.py", ""), *files):
        (package / name).write_text(text)
    return folder


def test_what_runs_with_the_machines_python_needs_neither_a_newer_one_nor_the_twins_packages():
    allowed = {*sys.stdlib_module_names, "rclpy"}
    files = {name: WIRES / f"rclpy_{name}.py" for name in OF_PROCESS}
    files["python_process"] = WIRES.parent / "python_process.py"
    for name, file in files.items():
        tree = ast.parse(file.read_text("utf-8"), feature_version=(3, 10))
        for node in ast.walk(tree):
            if isinstance(node, ast.ImportFrom):
                own = node.module.removeprefix("drake_twin.wires.rclpy_").removeprefix("drake_twin.")
                assert own in files or node.module.partition(".")[0] in allowed, (name, node.module)
            elif isinstance(node, ast.Import):
                assert all(each.name in allowed for each in node.names), name


def test_without_ros_it_says_what_to_source(bare, capsys, monkeypatch):
    assert refused(capsys, "--robots", 1, "--ros", "rclpy") == (
        "error: --ros rclpy: no ROS 2 is sourced: `source /opt/ros/DISTRO/setup.bash` in this terminal; --ros zenoh and"
        " --ros dds need none.\n"
    )
    monkeypatch.setenv("ROS_DISTRO", "humble")
    text = refused(capsys, "--robots", 1, "--ros", "rclpy")
    assert "ROS 2 humble is sourced, but it has no rclpy: `sudo apt install ros-humble-rclpy`" in text


def test_another_python_is_named_with_the_twins_own(bare, capsys, monkeypatch, tmp_path):
    prefix = rclpy_in(tmp_path / "lib" / "python3.7" / "site-packages", ("_rclpy_pybind11.cpython-37m-x.so", ""))
    monkeypatch.setenv("AMENT_PREFIX_PATH", str(tmp_path))
    monkeypatch.setenv("PATH", str(tmp_path))
    own = f"{sys.version_info[0]}.{sys.version_info[1]}"
    assert refused(capsys, "--robots", 1, "--ros", "rclpy") == (
        f"error: --ros rclpy: the rclpy in {prefix} is for Python 3.7, but no python3.7 is on the PATH, and the twin"
        f" runs with Python {own}.\n"
    )


def test_an_installation_that_cannot_be_imported_is_told(bare, capsys, monkeypatch, tmp_path):
    folder = rclpy_in(tmp_path, ("__init__.py", "raise ImportError('librcl.so: cannot open shared object file')"))
    monkeypatch.setenv("PYTHONPATH", str(folder))
    text = refused(capsys, "--robots", 1, "--ros", "rclpy")
    assert f"the rclpy in {folder} is for an unknown Python, and " in text
    assert "cannot import it (ImportError: librcl.so: cannot open shared object file)" in text


def test_a_middleware_that_is_missing_is_told(sourced, capsys, monkeypatch):
    monkeypatch.setenv("RMW_IMPLEMENTATION", "rmw_foo_cpp")
    text = refused(capsys, "--robots", 1, "--ros", "rclpy")
    assert "RMW_IMPLEMENTATION=rmw_foo_cpp is not installed: `sudo apt install ros-jazzy-rmw-foo-cpp`" in text
    assert "(Expected RMW implementation identifier of 'rmw_foo_cpp' but" in text


def test_a_reason_that_is_only_printed_is_told(sourced, capsys, monkeypatch):
    monkeypatch.setenv("CYCLONEDDS_URI", "<nonsense")
    text = refused(capsys, "--robots", 1, "--ros", "rclpy")
    assert "RCLError: error creating node: error not set; before, it has printed: 1795774557.250770 [81]" in text
    assert text.endswith(
        "config: //CycloneDDS/Domain/#text: parser error expecting '/>' or '>' () at line 1 (line 1).\n"
    )


@pytest.mark.parametrize(
    ("arguments", "problem"),
    [
        (["--nosuch"], "ROS 2 jazzy does not start: UnknownROSArgsError: ['--nosuch']."),
        (["-r", "bad"], "does not start: RCLError: failed to initialize rcl: Couldn't parse remap rule: '-r bad'."),
        (["-r", "__ns:=/a"], "would put all nodes of the twin into one namespace: --ros-namespace a goes before"),
        (["-r", "__node:=a"], "would give all nodes of the twin one name: write -r NODE:__node:=a for one of them"),
    ],
)
def test_wrong_arguments_of_ros_are_refused(sourced, capsys, arguments, problem):
    assert problem in refused(capsys, "--robots", 1, "--ros", "rclpy", "--ros-args", *arguments, "--")


def test_arguments_of_ros_reach_it_and_those_without_effect_are_told(sourced, tmp_path, monkeypatch):
    network = Network(tmp_path)
    monkeypatch.setenv("RCLPY_DOUBLE", network.address)
    rule = ("--ros-args", "-r", "/robot_1/joint_states:=/states", "-p", "a:=1", "--")
    ended = run("--ros", "rclpy", *rule, *TWIN)
    network.close()
    assert (ended.returncode, "Traceback" in ended.stderr) == (0, False)
    assert network.of("publisher", "/states")
    assert not network.of("publisher", "/robot_1/joint_states")
    assert "warning: --ros-args: -p and --params-file have no effect on the twin: the nodes have" in ended.stderr
    first, *_ = ended.stdout.splitlines()
    assert first.startswith("ros: domain 0 in ROS 2 jazzy of this machine (rclpy, rmw_cyclonedds_cpp), with ")


def test_a_second_twin_is_refused_unless_a_namespace_parts_them(sourced, monkeypatch):
    monkeypatch.setenv("RCLPY_DOUBLE_BESIDE", '{"/drake_twin": ["/clock", "/own"]}')
    second = run("--ros", "rclpy", *TWIN)
    assert (second.returncode, "Traceback" in second.stderr) == (2, False)
    assert "error: another twin is on ROS domain 0 and publishes /clock, which this one would publish" in second.stderr
    assert run("--ros", "rclpy", "--ros-namespace", "second", *TWIN).returncode == 0


def test_words_of_ros_end_with_two_dashes():
    assert without_ros_arguments(["a", "--ros-args", "-r", "b:=c", "--", "-d"]) == (
        ["a", "-d"],
        ["--ros-args", "-r", "b:=c"],
    )
    assert without_ros_arguments(["a", "--"]) == (["a", "--"], [])
    options = parser().parse_args(["--ros", "--ros-args", "--enclave", "/e"])
    assert (options.ros, options.ros_args) == ("any", ["--ros-args", "--enclave", "/e"])


def opened(monkeypatch, *arguments, broken=()):
    """What is opened for ``--ros`` alone."""
    calls = []

    def opens(name):
        def open_it(options, is_first):
            calls.append(name)
            if name in broken:
                raise InputError(f"no {name}")
            return name

        return open_it

    monkeypatch.setattr(ros, "_OPEN", {name: opens(name) for name in ("rclpy", "zenoh", "dds")})
    options = parser().parse_args([*arguments, "--ros"])
    kind = ros.RosKind()
    kind.check(options)
    wire = kind.open(options, lambda address: None, is_first=True)
    assert kind.open(options, lambda address: None, is_first=False) == wire  # as with --watch
    return wire, calls[:-1]


def test_alone_it_takes_rclpy_where_there_is_one(sourced, monkeypatch, capsys):
    assert opened(monkeypatch) == ("rclpy", ["rclpy"])
    assert capsys.readouterr().out == "ros: rclpy is chosen, for ROS 2 jazzy is sourced\n"


def test_alone_it_takes_zenoh_if_a_router_answers_and_dds_otherwise(bare, monkeypatch, capsys):
    with socket.create_server(("127.0.0.1", 0)) as router:
        port = router.getsockname()[1]
        monkeypatch.setattr(ros, "_PORT", port)
        assert opened(monkeypatch)[0] == "zenoh"
    reason = f"no ROS 2 with rclpy is sourced and a Zenoh router answers at 127.0.0.1:{port}"
    assert capsys.readouterr().out == f"ros: zenoh is chosen, for {reason}\n"
    assert opened(monkeypatch)[0] == "dds"
    assert capsys.readouterr().out == f"ros: dds is chosen, for {reason.replace('a Zenoh', 'no Zenoh')}\n"


def test_alone_it_goes_on_where_ros_is_broken_and_says_why(sourced, monkeypatch, capsys):
    monkeypatch.setattr(ros, "_PORT", 1)
    assert opened(monkeypatch, broken=["rclpy"]) == ("dds", ["rclpy", "dds"])
    captured = capsys.readouterr()
    assert captured.err == "ros: no rclpy.\n"
    assert captured.out.splitlines()[1] == (
        "ros: dds is chosen, for rclpy cannot be used and no Zenoh router answers at 127.0.0.1:1"
    )
    with pytest.raises(InputError, match=r"no dds"):
        opened(monkeypatch, broken=["rclpy", "dds"])


def test_alone_it_takes_what_the_other_options_are_for(sourced, monkeypatch):
    assert opened(monkeypatch, "--ros-router", "x")[0] == "zenoh"
    assert opened(monkeypatch, "--ros-port", "1234")[0] == "zenoh"
    assert opened(monkeypatch, "--lockstep")[0] == "rclpy"
    monkeypatch.setattr(ros, "_PORT", 1)
    assert opened(monkeypatch, "--ros-host", "127.0.0.1")[0] == "dds"


def test_options_of_another_transport_are_refused(sourced, capsys):
    text = refused(capsys, "--robots", 1, "--ros", "rclpy", "--ros-host", "127.0.0.1")
    assert "--ros-host is not for --ros rclpy: it needs --ros zenoh or dds" in text
    assert "it needs --ros rclpy" in refused(capsys, "--robots", 1, "--ros", "dds", "--ros-args", "-r", "a:=b")
    together = ("--ros", "--ros-router", "x", "--ros-args", "-r", "a:=b")
    assert "takes --ros-router, --ros-args together: leave one out" in refused(capsys, "--robots", 1, *together)
