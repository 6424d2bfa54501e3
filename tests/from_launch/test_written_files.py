"""Files of bridges that a launch writes by a shell's echo, as simple_launch does."""

import pytest
from hinge import create, launched, node
from launch_files import not_started, write
from waters import propelled, thruster

from drake_twin import Twin

ENTRY = "- ros_topic_name: {}\\n  gz_topic_name: {}\\n  ros_type_name: x\\n  gz_type_name: y"


def spawned(folder):
    text = propelled((1.0, 0.4, 0.3), thruster())
    file = write(folder / "auv.sdf", f'<sdf version="1.9">{text}</sdf>')
    return create("-file", file, "-name", "auv")


def echo(text, mark, name):
    return f"ExecuteProcess(cmd=['echo ', '\"{text}\"', ' {mark} ', {name!r}], shell=True),"


@pytest.mark.parametrize(("mark", "topics"), [(">>", ["/sim/push", "/sim/turn"]), (">", ["/sim/turn"])])
def test_a_bridges_file_that_the_launch_writes_is_read(tmp_path, mark, topics):
    name = str(tmp_path / "later")
    entities = [
        spawned(tmp_path),
        echo(ENTRY.format("push", "/model/auv/joint/shaft/cmd_thrust"), mark, name),
        echo(ENTRY.format("turn", "/model/auv/joint/shaft/ang_vel"), mark, name),
        node("ros_gz_bridge", "parameter_bridge", namespace="sim", parameters=[{"config_file": name}]),
    ]
    scenario = launched(tmp_path, *entities).scenario
    assert sorted(topic for topic in Twin(scenario).graph.topics() if topic.startswith("/sim/")) == topics
    assert not_started(scenario) == ()


@pytest.mark.parametrize("words", ["['echo', 'x', '>>', 'FILE']", "['echo', 'x']", "['cat', 'x', '>>', 'FILE']"])
def test_what_no_bridge_reads_is_a_program_that_is_not_started(tmp_path, words):
    entities = [
        spawned(tmp_path),
        f"ExecuteProcess(cmd={words.replace('FILE', str(tmp_path / 'b'))}, shell=True),",
    ]
    (finding,) = not_started(launched(tmp_path, *entities).scenario)
    assert finding.endswith(" (of programs, the twin starts only Python nodes)")
