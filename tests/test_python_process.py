"""Processes that are started search modules where the one that starts them does: not in a stranger's working folder."""

import os
import signal
import subprocess
import sys

import pytest

from drake_twin.python_process import end_module_search, python_command, same_module_search, stops_held_back

# A folder as a stranger's package may be, and programs as ``drake-twin`` starts them: not with ``python -m``.
SHADOWS = ("json", "struct", "numpy", "lxml", "yaml")
ROVER = "package://rover_description/urdf/rover.urdf.xacro"


@pytest.fixture
def folder(tmp_path, monkeypatch):
    for name in SHADOWS:
        (tmp_path / f"{name}.py").write_text(f"open('{name}.ran', 'w'); raise SystemExit(3)")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def drake_twin(*arguments):
    code = "import sys; del sys.path[0]; from drake_twin.__main__ import main; sys.exit(main())"
    if not sys.flags.safe_path:
        code = code.replace("del sys.path[0]", "sys.path.remove('')")
    return subprocess.run([sys.executable, "-c", code, *arguments], capture_output=True, text=True, check=False)


@pytest.mark.parametrize(
    "arguments",
    [
        ("run", "--robots", "1", "--headless", "--duration", "0.05", "--bag", "bag"),
        (
            *("sweep", "s.yaml", "--vary", "friction=0.1,0.5"),
            *["--duration", "0.05", "--metric", "distance", "--out", "a.csv"],
        ),
    ],
    ids=lambda arguments: arguments[0],
)
def test_what_drake_twin_starts_imports_nothing_from_the_working_folder(folder, arguments):
    (folder / "s.yaml").write_text(f"robots: [{{name: r, model: '{ROVER}', xyz: [0, 0, 0.2]}}]")
    done = drake_twin(*arguments)
    assert not list(folder.glob("*.ran"))
    assert done.returncode == 0, done.stderr
    assert "warning" not in done.stderr


def test_the_command_is_python_m_where_the_working_folder_is_searched(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "path", ["", *sys.path])
    assert python_command("a.b") == (sys.executable, "-m", "a.b")
    monkeypatch.setattr(sys, "path", [place for place in sys.path if place])
    assert python_command("a.b") == (sys.executable, "-P", "-m", "a.b")


def test_the_environment_is_as_before(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "path", [place for place in sys.path if place])
    for given in (None, "1"):
        monkeypatch.delenv("PYTHONSAFEPATH", raising=False)
        if given:
            monkeypatch.setenv("PYTHONSAFEPATH", given)
        with same_module_search():
            assert os.environ["PYTHONSAFEPATH"]
            end_module_search()  # in the process that was started
            assert os.environ.get("PYTHONSAFEPATH") == given
        assert os.environ.get("PYTHONSAFEPATH") == given


CHILD = """
import sys
sys.stdin.readline()
from drake_twin.python_process import ignore_stops
ignore_stops()
print("ready", flush=True)
sys.stdin.readline()
print("end", flush=True)
"""


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_a_signal_that_stops_programs_stops_no_process_of_the_twins_own_at_any_time(number):
    before = signal.pthread_sigmask(signal.SIG_BLOCK, ())
    with stops_held_back():
        pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "text": True}
        child = subprocess.Popen([sys.executable, "-c", CHILD], **pipes)
    assert signal.pthread_sigmask(signal.SIG_BLOCK, ()) == before
    child.send_signal(number)  # while Python starts
    child.stdin.write("\n")
    child.stdin.flush()
    assert child.stdout.readline() == "ready\n"
    child.send_signal(number)
    assert child.communicate("\n")[0] == "end\n"
    assert child.returncode == 0


DIES_WITH = """
import os, signal, subprocess, sys
child = "import signal, sys; from drake_twin.python_process import die_with; die_with(int(sys.argv[1]));"
child += "print('here', flush=True); signal.pause()"
subprocess.Popen([sys.executable, "-c", child, str(os.getpid())])
signal.pause()
"""


def test_a_process_ends_with_the_twin_that_is_killed():
    twin = subprocess.Popen([sys.executable, "-c", DIES_WITH], stdout=subprocess.PIPE, text=True)
    assert twin.stdout.readline() == "here\n"
    twin.kill()
    assert twin.communicate()[0] == ""  # the pipe's end: nobody has it open any longer
