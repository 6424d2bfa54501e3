"""The option ``--node``."""

import json

import pytest

from drake_twin.cli.node_options import node_programs
from drake_twin.errors import InputError
from drake_twin.run import main
from drake_twin.scenario import NodeProgram

SPIN = "import rclpy\nrclpy.init()\nnode = rclpy.create_node('n')\nprint('started')\nrclpy.spin(node)\n"


def test_words_of_a_script_and_of_a_package(tmp_path):
    script = tmp_path / "a b.py"
    script.write_text("")
    assert node_programs([f"'{script}' --x 'y z'", "my_package talk --ros-args -p a:=1"]) == (
        NodeProgram(str(script), arguments=("--x", "y z")),
        NodeProgram("talk", "my_package", ("--ros-args", "-p", "a:=1")),
    )
    assert node_programs([str(script)]) == (NodeProgram(str(script)),)  # as a shell hands on "a b.py"


@pytest.mark.parametrize(
    ("line", "why"),
    [("", "needs a script"), ("'x", "No closing quotation"), ("nowhere/x.py", "the script does not exist")],
)
def test_wrong_lines(line, why):
    with pytest.raises(InputError, match=why):
        node_programs([line])


@pytest.mark.parametrize(
    ("text", "why", "traceback"),
    [
        ("raise ValueError('no')", "ValueError: no (FILE:1)", '  File "FILE", line 1, in <module>\n'),
        ("import nowhere", "ModuleNotFoundError: No module named 'nowhere' (FILE:1)", '  File "FILE", line 1, in'),
        ("x = (", "SyntaxError: '(' was never closed (fails.py, line 1) (FILE:1)", '  File "FILE", line 1\n    x = ('),
        ("def f():\n    return {}[3]\nimport threading\nthreading.Thread(target=f).start()", "KeyError: 3 (FILE:2)",
         '  File "FILE", line 2, in f\n'),
        ("import sys\nsys.exit(3)", "it has ended with exit code 3 (FILE:2)", ""),
    ],
)  # fmt: skip
def test_a_run_in_which_a_node_fails_ends_with_1(tmp_path, capsys, text, why, traceback):
    script = tmp_path / "fails.py"
    script.write_text(f"{text}\n")
    run = ["--robots", "1", "--headless", "--duration", "0.1", "--node", str(script)]
    assert main(run) == 1
    paragraph, *more = capsys.readouterr().err.replace(str(script), "FILE").splitlines(keepends=True)
    assert paragraph == f"error: node fails.py: {why}\n"
    assert traceback in "".join(more)
    assert "drake_twin" not in "".join(more)
    assert main([*run, "--strict"]) == 1
    assert main([*run, "--keep-going"]) == 0


def test_saved_states_start_their_nodes_again(tmp_path, capsys):
    script, state, recording = tmp_path / "n.py", tmp_path / "s.json", tmp_path / "r.json"
    script.write_text(SPIN)
    run = ["--robots", "1", "--headless", "--duration", "0.1", "--node", str(script)]
    assert main([*run, "--save-state", str(state), "--record", str(recording)]) == 0
    assert capsys.readouterr().out.startswith("started\n")
    for option, file in (("--load-state", state), ("--replay", recording)):
        assert main([option, str(file), "--headless", "--duration", "0.1"]) == 0
        text = capsys.readouterr()
        assert text.out.startswith("started\n")
        assert "nodes: what is saved has no nodes inside: n.py start again at 0.100 s" in text.err
    again = tmp_path / "again.json"
    assert main(["--replay", str(recording), "--end-with-recording", "--headless", "--save-state", str(again)]) == 0
    assert "started" not in capsys.readouterr().out
    assert json.loads(again.read_text()) == json.loads(state.read_text())


def test_nodes_of_a_saved_state_are_its_own(tmp_path):
    script, state = tmp_path / "n.py", tmp_path / "s.json"
    script.write_text(SPIN)
    assert main(["--robots", "1", "--headless", "--duration", "0.01", "--save-state", str(state)]) == 0
    assert main(["--load-state", str(state), "--headless", "--duration", "0.1", "--node", str(script)]) == 2
