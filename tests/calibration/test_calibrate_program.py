"""``python -m drake_twin.calibrate``: what it prints and writes, and what it refuses."""

import os
import signal
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from pendulum_logs import ARRAY, MASS, STATE_TOPIC, STATES, TOPIC, messages, pendulum, write_log
from rosbags.rosbag2 import StoragePlugin

from drake_twin import calibrate
from drake_twin.scenario.scenario_file import ScenarioFile, scenario_to_yaml

FIT = ["--fit", "pendulum.arm.mass=0.5:5", "--fit", "pendulum.hinge.damping=0.02:2"]
PROGRAM = ["robot.yaml", "--log", "log", *FIT, "--method", "least-squares"]


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "robot.yaml").write_text(scenario_to_yaml(pendulum(tmp_path)))
    return tmp_path


def test_the_values_are_reported_drawn_and_written(folder, capsys):
    write_log(folder / "log", messages())
    file = next((folder / "log").glob("*.mcap"))
    arguments = [str(file) if word == "log" else word for word in PROGRAM]
    assert calibrate.main([*arguments, "--out", "fitted.yaml", "--plot", "fit.svg"]) == 0
    captured = capsys.readouterr()
    assert "pendulum.arm.mass" in captured.out
    assert "χ²/dof" in captured.out
    assert "correlations" in captured.out
    assert "second halves of the logs" in captured.out
    assert f"{STATE_TOPIC} is " in captured.out
    assert f"{STATE_TOPIC} hinge.velocity" in (folder / "fit.svg").read_text().replace("\n", " ")
    text = (folder / "fitted.yaml").read_text()
    assert text.startswith("# Fitted by drake_twin.calibrate: χ²/dof ")
    assert "# pendulum.arm.mass: 1." in text
    values = ScenarioFile.read(folder / "fitted.yaml").scenario.values
    assert values["pendulum.arm.mass"] == pytest.approx(MASS, rel=0.02)


def test_values_that_do_not_fit_are_written_by_force_only(folder, capsys):
    write_log(folder / "log", messages(friction=0.4))
    assert calibrate.main([*PROGRAM, "--out", "fitted.yaml"]) == 1
    captured = capsys.readouterr()
    assert "problem: χ²/dof is " in captured.out
    assert "fitted.yaml is not written (--force writes it)" in captured.err
    assert not (folder / "fitted.yaml").exists()
    assert calibrate.main([*PROGRAM, "--out", "fitted.yaml", "--force"]) == 1
    assert "# problem: χ²/dof is " in (folder / "fitted.yaml").read_text()


def test_values_that_cannot_be_written_do_not_prevent_the_figure(folder, capsys):
    write_log(folder / "log", messages())
    (folder / "fitted.yaml").mkdir()
    assert calibrate.main([*PROGRAM, "--out", "fitted.yaml", "--plot", "fit.svg"]) == 1
    assert "fitted.yaml cannot be written (Is a directory)" in capsys.readouterr().err
    assert (folder / "fit.svg").is_file()


def test_ctrl_c_names_the_command_that_continues(folder):
    write_log(folder / "log", messages())
    root = str(Path(__file__).resolve().parents[2])
    run = subprocess.Popen(
        [sys.executable, "-c", SLOW, *PROGRAM, "--start", "pendulum.arm.mass=1"],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env={**os.environ, "PYTHONPATH": root},
    )
    assert run.stdout is not None
    for line in run.stdout:
        if line == "third\n":
            run.send_signal(signal.SIGINT)
            break
    out, err = run.communicate(timeout=100)
    assert run.returncode == 130, err
    assert "so that nothing is known for certain. To continue: python -m drake_twin.calibrate robot.yaml" in out
    assert out.count("--start pendulum.arm.mass=") == 1
    assert out.count("--start pendulum.hinge.damping=") == 1
    assert "Traceback" not in err


SLOW = """
import sys
from drake_twin import calibrate
from drake_twin.calibration import evaluations

simulate = evaluations.Evaluations.simulate
def slowly(self, *arguments):
    if len(self.every) == 3:
        print("third", flush=True)
        while not self._stopped:
            pass
    return simulate(self, *arguments)
evaluations.Evaluations.simulate = slowly
sys.exit(calibrate.main(sys.argv[1:]))
"""


def nan_at(index):
    items = list(messages())
    states = [message for topic, _, _, message in items if topic == STATE_TOPIC]
    states[index].velocity = np.array([np.nan])
    return items


def of(topic):
    return [item for item in messages() if item[0] == topic]


def later(seconds):
    moved = [(*item[:2], item[2] + seconds, item[3]) for item in of(STATE_TOPIC)]
    for *_, message in moved:
        message.header.stamp.sec = message.header.stamp.nanosec = 0
    return of(TOPIC) + moved


def unknown_types():
    return [("/torque", "their_msgs/msg/Torque", 0.1, b"\0" * 12)]


def of_another_type():
    items = [(TOPIC, STATES, 0.1, item[3]) for item in of(STATE_TOPIC)[:1]]
    return items + of(STATE_TOPIC)


@pytest.mark.parametrize(
    ("items", "more", "message"),
    [
        (messages, "--fit frictoin=0:1", "nothing of this name to vary. Did you mean 'friction'"),
        (messages, "--fit pendulum.amr.mass=1:2", "has no link 'amr'. Did you mean 'arm'"),
        (messages, "--fit pendulum.arm.inertia=-1:1", "pendulum.arm.inertia is -1: it must be above zero"),
        (messages, "--fit pendulum.arm.ixx=0.01:9", "the largest principal moment must not exceed"),
        (messages, "--fit pendulum.arm.mass=1:2", "--fit pendulum.arm.mass is given twice"),
        (messages, "--fit pendulum.arm.ixx=1", "it must read PATH=LOW:HIGH"),
        (messages, "--fit pendulum.arm.ixx=2:1", "the lower end must be less than the upper one"),
        (messages, "--fit pendulum.arm.ixx=nan:1", "the lower end must be less than the upper one"),
        (messages, "--method magic", "unknown method 'magic'. Valid: auto, least-squares, sobol, evolution"),
        (messages, "--noise speed=1", "the logs have no such number"),
        (messages, "--noise velocity=0", "the standard deviation must be above zero"),
        (messages, "--noise velocity", "it must read NAME=VALUE"),
        (messages, "--without hinge.velocty", "no such topic or number. Did you mean 'hinge.velocity'"),
        (messages, f"--without {STATE_TOPIC}", "--without leaves nothing to compare"),
        (messages, "--map /a=/b", "--map: the bag lacks this topic"),
        (messages, f"--map {STATE_TOPIC}=/joint_state", "--map: the twin lacks this topic"),
        (messages, "--start pendulum.arm.ixx=1", "--start pendulum.arm.ixx: this value is not fitted"),
        (messages, "--start pendulum.arm.mass=x", "it must read PATH=VALUE"),
        (messages, "--episodes 5", "5 episodes are too few to fit 2 values"),
        (messages, "--longest-delay -1", "--longest-delay -1: it must be from 0 to 10 s"),
        (messages, "--out fitted.txt", "it must end in .yaml"),
        (messages, "--plot nowhere/fit.png", "the folder does not exist"),
        (messages, "--log nothing.mcap", "nothing.mcap: the bag does not exist"),
        (lambda: of(STATE_TOPIC), "", f"no topic of the bag commands the twin: {STATE_TOPIC}"),
        (lambda: of(TOPIC), "", f"no topic of the bag is one that the twin measures: {TOPIC}"),
        (unknown_types, "", "no topic of the bag commands the twin: /torque"),
        (lambda: later(10), "", "commands (0.000 to 0.800 s) and measurements (9.900 to 10.880 s) do not overlap"),
        (lambda: later(-10), "", "do not overlap in time"),
        (lambda: nan_at(7), "", "hinge.velocity is nan at 0.140 s of the log: --without hinge.velocity leaves it out"),
        (lambda: messages(joint="elbow"), "", "the twin has none of the log's numbers: elbow.position, elbow.velocity"),
        (of_another_type, "", f"{TOPIC} is a {STATES}, but the twin's {TOPIC} is a {ARRAY}"),
    ],
)
def test_wrong_input_is_one_paragraph(folder, capsys, items, more, message):
    write_log(folder / "log", items(), StoragePlugin.SQLITE3)
    assert calibrate.main([*PROGRAM, *more.split(), *(() if "--out" in more else ("--out", "fitted.yaml"))]) == 2
    err = capsys.readouterr().err
    assert message in err
    assert err.startswith("error: ")
    assert err.count("\n") == 1
    assert not (folder / "fitted.yaml").exists()


def test_options_that_are_missing_are_named(folder, capsys):
    assert calibrate.main(["robot.yaml", "--log", "log"]) == 2
    assert "--fit is missing" in capsys.readouterr().err
    assert calibrate.main(["robot.yaml", *FIT]) == 2
    assert "--log is missing" in capsys.readouterr().err


def test_a_command_that_the_twin_refuses_is_named(folder, capsys):
    items = list(messages())
    items[2][3].data = np.array([1.0, 2.0])
    write_log(folder / "log", items)
    assert calibrate.main(PROGRAM) == 2
    assert "the twin refuses the command at 0.300 s: " in capsys.readouterr().err
