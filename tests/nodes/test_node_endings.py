"""What follows when a node of a launch file ends, as ``ros2 launch`` does it."""

from dataclasses import replace

import pytest
from launch_files import write, write_package, write_python
from node_runs import lines

from drake_twin import Twin
from drake_twin.builder.launch_file import launch_file_scenario
from drake_twin.findings import Kind
from drake_twin.nodes.nodes import Nodes
from drake_twin.run import main
from drake_twin.scenario import NodeProgram
from drake_twin.scenario.node_program import OnExit, Respawn
from drake_twin.scenario.scenario_file import ScenarioFile, scenario_to_yaml

INERTIA = "<inertia ixx='1' iyy='1' izz='1' ixy='0' ixz='0' iyz='0'/>"
URDF = f"<robot name='r'><link name='base'><inertial><mass value='1'/>{INERTIA}</inertial></link></robot>"
ROBOT = f"""
        Node(package="robot_state_publisher", executable="robot_state_publisher",
             parameters=[{{"robot_description": {URDF!r}}}]),
        Node(package="gazebo_ros", executable="spawn_entity.py",
             arguments=["-entity", "r", "-topic", "robot_description"]),
"""
# A program that says its word at its start, and ends after so many tenths of a second with a code.
PROGRAM = """
import sys, time
word, tenths, code = sys.argv[1:4]
print(word, round(time.time(), 1))
time.sleep(int(tenths) / 10)
sys.exit(int(code))
"""
STEP = """
def step(word, tenths=1, code=0, **more):
    return Node(package="steps", executable="step", arguments=[word, str(tenths), str(code)], **more)
"""


def launch_file(folder, entities):
    package = write_package(folder, "steps")
    write(package / "setup.py", "from setuptools import setup\n"
          "setup(name='steps', entry_points={'console_scripts': ['step = steps.step:main']})\n")  # fmt: skip
    write(package / "steps" / "__init__.py", "")
    body = "\n".join(f"    {line}" for line in PROGRAM.splitlines())
    write(package / "steps" / "step.py", f"def main():\n{body}\n")
    return write_python(package / "launch" / "all.launch.py", ROBOT + entities, STEP)


def run(folder, entities, until=1.0):
    """The scenario of a launch file, and the findings after a run."""
    scenario = launch_file_scenario(launch_file(folder, entities)).scenario
    with Twin(scenario) as twin:
        nodes = Nodes(twin)
        twin.advance_to(until)
        nodes.close()
        return scenario, [item.what for item in twin.findings if item.kind is Kind.FAILED], nodes


def test_a_node_is_started_again_as_often_as_the_launch_file_says(tmp_path, capsys):
    """After an end with an error and after one without, as `launch.actions.ExecuteLocal` does."""
    entities = """
        step("a", 1, 1, respawn=True, respawn_delay=0.2, respawn_max_retries=2),
        step("b", 1, 0, respawn=LaunchConfiguration("again", default="true"), respawn_delay=0.5),
        step("c", 1, 1, respawn=False, respawn_delay=0.5),
"""
    scenario, failed, _ = run(tmp_path, entities, 1.5)
    assert [node.respawn for node in scenario.nodes] == [Respawn(0.2, 2), Respawn(0.5, -1), None]
    spoken = sorted(lines(capsys))
    assert spoken == ["a 0.0", "a 0.3", "a 0.6", "b 0.0", "b 0.6", "b 1.2", "c 0.0"]
    assert len(failed) == 2  # one line for each program, however often it has ended


def test_a_node_without_a_delay_is_not_started_in_each_step(tmp_path, capsys):
    run(tmp_path, 'step("a", 0, 1, respawn=True),', 0.55)
    assert [line.partition(" ")[2] for line in lines(capsys)] == ["0.0", "0.1", "0.2", "0.3", "0.4", "0.5"]


def test_what_waits_for_the_end_of_a_node_starts_then(tmp_path, capsys):
    entities = """
        *(lambda first, second: [
            first,
            RegisterEventHandler(OnProcessExit(target_action=first, on_exit=[
                LogInfo(msg="the first has ended"), second, TimerAction(period=0.2, actions=[step("late")])])),
            RegisterEventHandler(OnProcessExit(target_action=second, on_exit=[step("third")])),
        ])(step("first", 2), step("second", 3, on_exit=[step("own")])),
"""
    scenario, failed, _ = run(tmp_path, entities)
    assert failed == []
    assert not any("event handler" in item.what for item in scenario.findings)
    spoken = lines(capsys)
    assert spoken[:2] == ["first 0.0", "[INFO] [launch.user]: the first has ended"]
    assert sorted(spoken[2:]) == ["late 0.4", "own 0.5", "second 0.2", "third 0.5"]
    assert ScenarioFile(scenario_to_yaml(scenario), "x.yaml").scenario.nodes == scenario.nodes


@pytest.mark.parametrize(("code", "word"), [(0, "fine"), (1, "bad"), (3, "bad")])
def test_a_handler_may_ask_how_a_node_has_ended(tmp_path, capsys, code, word):
    entities = f"""
        *(lambda first: [first, RegisterEventHandler(OnProcessExit(target_action=first, on_exit=lambda event, context:
            [step("bad" if event.returncode else "fine")]))])(step("first", 1, {code})),
"""
    scenario, _, _ = run(tmp_path, entities, 0.3)
    assert [following.exit_code for following in scenario.nodes[0].on_exit] == [0, 1]
    assert lines(capsys) == ["first 0.0", f"{word} 0.1"]


@pytest.mark.parametrize(
    "entities",
    [
        'step("a", 2, {code}, on_exit=Shutdown(reason="a is over")), step("b", 9)',
        """*(lambda first: [first, RegisterEventHandler(OnProcessExit(target_action=first, on_exit=[
            EmitEvent(event=events.Shutdown(reason="a is over"))]))])(step("a", 2, {code})), step("b", 9)""",
    ],
)
@pytest.mark.parametrize("code", [0, 1])
def test_a_required_node_ends_the_run(tmp_path, capsys, entities, code):
    file = launch_file(tmp_path, entities.format(code=code))
    file.write_text(f"from launch import events\n{file.read_text()}")
    assert main([str(file), "--headless", "--package-path", str(tmp_path), "--duration", "5"]) == code
    out = capsys.readouterr().out
    assert "shutdown: a is over" in out
    assert "1 robot, 0.200 s simulated" in out


@pytest.mark.parametrize(("more", "end"), [((), "0.300"), (("--duration", "0.2"), "0.200")])
def test_a_timer_that_shuts_down_ends_the_run(tmp_path, capsys, more, end):
    file = launch_file(
        tmp_path,
        'TimerAction(period=0.3, actions=[Shutdown(reason="time is over")]),step("a", 1, on_exit=[step("b", 9)]),',
    )
    assert main([str(file), "--headless", "--package-path", str(tmp_path), *more]) == 0
    out = capsys.readouterr().out
    assert f"1 robot, {end} s simulated" in out
    assert "b 0.1" in out


def test_a_required_node_ends_all_nodes_of_a_twin_in_python(tmp_path, capsys):
    _, _, nodes = run(tmp_path, 'step("a", 2, on_exit=Shutdown()), step("b", 1, respawn=True, respawn_delay=0.15)', 1.0)
    assert nodes.shutdown_reason == "reason not given"
    assert lines(capsys) == ["a 0.0", "b 0.0"]


def test_a_handler_of_what_the_twin_does_not_run_stays_a_finding(tmp_path):
    entities = """
        *(lambda window: [window, RegisterEventHandler(OnProcessExit(target_action=window, on_exit=[step("never")]))])(
            Node(package="rviz2", executable="rviz2")),
"""
    scenario, _, _ = run(tmp_path, entities, 0.1)
    assert scenario.nodes == ()
    assert [item.what for item in scenario.findings if "event handler" in item.what] == [
        "event handler (OnProcessExit of rviz2/rviz2 never happens)"
    ]


def test_what_is_no_node_cannot_start_later(tmp_path):
    entities = 'step("a", 1, on_exit=[Node(package="controller_manager", executable="spawner", arguments=["c"])]),'
    scenario, _, _ = run(tmp_path, entities, 0.1)
    assert [item.what for item in scenario.findings if "spawner" in item.what] == [
        "controller_manager/spawner (it waits for the end of a node, and then only Python nodes can start)"
    ]


def test_programs_that_start_each_other_for_ever_come_to_an_end(tmp_path):
    entities = """
        *(lambda again: [again(again)])(lambda again: step("a", 1, on_exit=lambda event, context: [again(again)])),
"""
    scenario, _, _ = run(tmp_path, entities, 0.1)
    nodes, depth = scenario.nodes, 0
    while nodes:
        nodes, depth = nodes[0].on_exit[0].nodes if nodes[0].on_exit else (), depth + 1
    assert depth == 9


def test_a_handler_that_fails_before_its_time_says_so(tmp_path, capsys):
    run(tmp_path, 'step("a", 1, on_exit=lambda event, context: open("/nowhere/x")),', 0.3)
    assert "what follows could not be evaluated" in lines(capsys)[1]


def test_a_reset_moves_what_is_to_start(tmp_path, capsys):
    file = tmp_path / "a.py"
    file.write_text("import time\nprint('here', round(time.time(), 2))\n")
    program = NodeProgram(str(file), respawn=Respawn(0.5))
    scenario = replace(launch_file_scenario(launch_file(tmp_path, "")).scenario, nodes=(program,))
    with Twin(scenario) as twin:
        nodes = Nodes(twin)
        twin.advance_to(0.3)
        twin.reset()
        twin.advance_to(0.4)
        nodes.close()
    assert lines(capsys) == ["here 0.0", "here 0.2"]


def test_what_follows_is_plain_data():
    assert OnExit() == OnExit(None, (), (), None)
