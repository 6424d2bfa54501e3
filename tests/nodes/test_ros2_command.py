"""``ros2`` in the processes that nodes start: the twin's own tools, or a finding; and what such a process inherits."""

import os
import shutil

import pytest
from node_runs import running, script

from drake_twin.findings import Kind
from drake_twin.nodes.ros2_command import missing, with_command

NO_ROS = "the twin needs no ROS, and 'ros2 {}' is not there"
WITHOUT = with_command({"PATH": os.defpath})


@pytest.mark.parametrize(
    ("call", "texts"),
    [
        (["ros2", "run", "a", "b"], [f"{NO_ROS.format('run')}: start the node by --node, or in a launch file"]),
        ("cd / && ros2 doctor", [NO_ROS.format("doctor")]),
        (
            ["bash", "-c", "source x; ros2 topic list"],
            ["'ros2 topic' finds no twin on the ROS 2 graph: start the twin "],
        ),
        ([b"/opt/ros/bin/ros2", "launch", 3], [NO_ROS.format("launch")]),
        ("ros2 interface list", []),
        (["say", "hello", "ros2", "world"], []),
        (["macros2", "run"], []),
        (None, []),
    ],
)
def test_what_is_missing(call, texts):
    found = missing(call, WITHOUT, has_wires=False)
    assert len(found) == len(texts)
    assert all(each.startswith(text) for each, text in zip(found, texts, strict=True))


def test_on_a_graph_the_tools_do_their_work():
    assert missing("ros2 topic list; ros2 bag record", WITHOUT, has_wires=True)[0].startswith(NO_ROS.format("bag"))


def test_the_command_of_a_ros_that_is_installed_comes_first(tmp_path):
    (tmp_path / "ros2").write_text("#!/bin/sh\n")
    (tmp_path / "ros2").chmod(0o755)
    environment = with_command({"PATH": str(tmp_path)})
    assert shutil.which("ros2", path=environment["PATH"]) == str(tmp_path / "ros2")
    assert missing("ros2 run a b", environment, has_wires=False) == []


def test_a_node_that_starts_it(tmp_path, capfd, monkeypatch):
    """`interface` needs no graph; the others say where the twin would have to be, or that they are not there."""
    monkeypatch.setenv("PATH", os.defpath)
    file = script(
        tmp_path,
        "f.py",
        """
import os, subprocess
print(subprocess.run(["ros2", "interface", "show", "std_msgs/msg/Bool"], capture_output=True, text=True).stdout)
print(subprocess.run("ros2 bag record -a", shell=True).returncode, os.system("ros2 pkg list") >> 8)
""",
    )
    with running(file) as twin:
        while not any(name in str(twin.findings) for name in ("pkg", "failed")):
            twin.advance_to(twin.time + 0.01)
        twin.advance_to(twin.time + 0.1)
        found = [item.what for item in twin.findings if item.kind is Kind.IGNORED]
        assert [item for item in twin.findings if item.kind is Kind.FAILED] == []
    instead = "write a bag with --bag FOLDER, and play one with drake-twin play"
    assert found == [
        f"node f.py: {NO_ROS.format('bag')}: {instead} ({file}:4)",
        f"node f.py: {NO_ROS.format('pkg')} ({file}:4)",
    ]
    out, err = capfd.readouterr()
    assert out.startswith("bool data\n")
    assert f"error: {NO_ROS.format('bag')}: {instead}" in err


def test_a_process_has_the_environment_of_its_program(tmp_path, capfd):
    file = script(
        tmp_path,
        "f.py",
        """
import os, subprocess
os.environ["MINE"] = "mine"
subprocess.run("echo $MINE $ROS_DISTRO", shell=True)
subprocess.run(["/bin/sh", "-c", "echo own $MINE"], env={"MINE": "other"})
print(os.system("echo by system $MINE; exit 3"), os.system("kill -9 $$"))
""",
    )
    with running(file) as twin:
        while not (twin.findings or twin.time > 1.0):
            twin.advance_to(twin.time + 0.1)
        assert twin.findings == ()
    assert capfd.readouterr().out.splitlines() == ["mine jazzy", "own other", "by system mine", "768 9"]
    assert "MINE" not in os.environ
