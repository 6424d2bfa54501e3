"""However a program is stopped, and whenever: it ends with its exit code, without a traceback; nothing of it is left.

The moments are counted in what a program does, not in time: it sends itself and its children the signals then.
"""

import json
import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest
from rosbags.rosbag2 import Reader
from waiting import until

ROVER = "package://rover_description/urdf/rover.urdf.xacro"
FILES = {
    "--summary": "s.json",
    "--record": "r.json",
    "--save-state": "st.json",
    "--save-html": "p.html",
    "--bag": "bag",
}
OUTPUT = [word for item in FILES.items() for word in item]
SWEEP = ["drake_twin.sweep", ROVER, "--vary", "friction=0.3:1.0:40", "--metric", "distance", "--out", "t.csv"]
PROGRAMS = {
    "run": ["drake_twin.run", "--robots", "1", "--headless", *OUTPUT],
    "page": ["drake_twin.run", "--robots", "1", "--no-browser", *OUTPUT],
    "launch": ["drake_twin.run", "rover_gazebo", "main.launch.xml", "--headless", *OUTPUT],
    "sweep": [*SWEEP, "--duration", "1"],
    "view": ["drake_twin.check", ROVER, "--view", "--no-browser"],
}
STATUS = "drake_twin.cli.status_line:StatusLine.show"
RUNNING = {
    **dict.fromkeys(("run", "page", "launch"), STATUS),
    "sweep": "drake_twin.sweeps.results:Results.add",
    "view": "drake_twin.cockpit.cockpit:Cockpit.process_requests",
}
# Imports, and calls of functions, after which the signals arrive.
MOMENTS = {
    "import": "drake_twin.description.package_index",
    "build": "pydrake.multibody.plant",
    "child": "subprocess:Popen.__init__",
    "running": "",
    "end": "drake_twin.run:save_results",
}
STOPS = {
    "Ctrl-C": [signal.SIGINT],
    "Ctrl-C twice": [signal.SIGINT, signal.SIGINT],
    "Ctrl-C and SIGTERM": [signal.SIGINT, signal.SIGTERM],
    "SIGTERM": [signal.SIGTERM],
    "closed terminal": [signal.SIGHUP],
    "kill -9": [signal.SIGKILL],
}
CASES = [
    (program, moment, stop)
    for stop in STOPS
    for program in PROGRAMS
    for moment in MOMENTS
    if program not in ("sweep", "view") or moment not in ("child", "end")
]
EVERYDAY = [
    ("run", "child", "Ctrl-C"),
    ("page", "running", "Ctrl-C twice"),
    ("launch", "end", "kill -9"),
    ("sweep", "build", "closed terminal"),
    ("view", "running", "Ctrl-C and SIGTERM"),
]

STOPS_ITSELF = """
import builtins, importlib, os, signal, sys
moment, numbers, program, *arguments = sys.argv[1:]

def stop():
    for number in numbers.split(","):
        (os.kill if int(number) == signal.SIGKILL else os.killpg)(os.getpid(), int(number))

sys.argv = ["-m"]  # as while the first package of `python -m` is imported
import drake_twin
sys.argv = [program, *arguments]
module, _, place = moment.partition(":")
if place:
    owner = importlib.import_module(module)
    *within, name = place.split(".")
    for part in within:
        owner = getattr(owner, part)
    original = getattr(owner, name)
    def called(*given, **more):
        setattr(owner, name, original)
        if name != "__init__":
            stop()
        result = original(*given, **more)
        if name == "__init__":
            stop()
        return result
    setattr(owner, name, called)
else:
    original = builtins.__import__
    def importing(name, *rest, **more):
        if name == module:
            builtins.__import__ = original
            stop()
        return original(name, *rest, **more)
    builtins.__import__ = importing
main = importlib.import_module(program).main
from drake_twin.program import leave
leave(main())
"""


def run_and_stop(folder, program, moment, stop):
    """Run a program that is stopped at a moment, in a session of its own as that of a terminal."""
    (folder / "tmp").mkdir()
    numbers = ",".join(str(int(number)) for number in STOPS[stop])
    words = [MOMENTS[moment] or RUNNING[program], numbers, *PROGRAMS[program]]
    if moment == "end":
        words += ["--duration", "0.2"]
    return subprocess.run(
        [sys.executable, "-c", STOPS_ITSELF, *words],
        cwd=folder,
        capture_output=True,
        text=True,
        timeout=120,
        start_new_session=True,
        env={**os.environ, "TMPDIR": str(folder / "tmp"), "STOPPED_IN": str(folder)},
    )


def left_of(folder):
    """The processes of a program that still run."""
    mark, found = f"STOPPED_IN={folder}\0".encode(), []
    for process in Path("/proc").glob("[0-9]*"):
        try:
            if mark in (process / "environ").read_bytes():
                found.append((process / "cmdline").read_bytes())
        except OSError:  # it has just ended, or is another user's
            continue
    return found


def is_whole(file):
    if file.is_dir():
        with Reader(file) as bag:
            return len(list(bag.messages())) == bag.message_count
    text = file.read_text()
    return text.rstrip().endswith("</html>") if file.suffix == ".html" else isinstance(json.loads(text), dict)


def codes_of(program, moment, stop):
    """The exit codes of the documentation: a program that is soon built still writes everything."""
    if stop == "kill -9":
        return {-signal.SIGKILL}
    if moment in ("import", "build", "child"):
        return {130, *({0} if program != "sweep" else ()), *(-number for number in STOPS[stop] if moment == "import")}
    return {130} if program == "sweep" else {0}


@pytest.mark.parametrize(
    ("program", "moment", "stop"),
    [pytest.param(*case, marks=() if case in EVERYDAY else pytest.mark.slow) for case in CASES],
    ids=lambda word: word.replace(" ", "_"),
)
def test_a_stopped_program(tmp_path, program, moment, stop):
    result = run_and_stop(tmp_path, program, moment, stop)
    assert result.returncode in codes_of(program, moment, stop), result.stdout + result.stderr
    assert "Traceback" not in result.stderr
    until(lambda: not left_of(tmp_path))
    files = [tmp_path / name for name in FILES.values()] if OUTPUT[0] in PROGRAMS[program] else []
    assert all(is_whole(file) for file in files if file.exists())
    if result.returncode == 0:
        assert all(file.exists() for file in files), result.stdout + result.stderr
    if result.returncode >= 0:
        assert list((tmp_path / "tmp").iterdir()) == []
    assert list(tmp_path.glob(".*.part")) == []
