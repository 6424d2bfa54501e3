"""Small launch files beside what the real launch and launch_ros (ROS 2 Jazzy) make of each; see their README."""

import json
import re
from pathlib import Path
from typing import Any

import pytest
import yaml

from drake_twin.description.package_index import PackageIndex
from drake_twin.errors import InputError
from drake_twin.ros2.evaluate import evaluate
from drake_twin.ros2.launched import NODE, Launched, LaunchedProcess, ParameterText

HERE = Path(__file__).parent / "launch_outcomes"
OUTCOMES: dict[str, dict[str, Any]] = json.loads((HERE / "outcomes.json").read_text())
INTERNAL = ("global_params", "ros_remaps")  # what ROS keeps among the configurations for SetParameter and SetRemap

# Where the recording shows something else than what is run, and why; then what the twin finds.
SHELL = "a shell is given the words joined with blanks (launch/actions/execute_local.py:571)"
PREFIX = "the prefix is a program that starts the process (launch/descriptions/executable.py:182); the twin starts none"
ROS_ARGUMENTS = "what follows --ros-args is rcl's; the twin has no log levels"
RANDOM = "the name is random (launch/substitutions/anon_name.py:70); that of the twin repeats"
DIFFERENT = {
    "files/act030.launch.xml": (ROS_ARGUMENTS, {"arguments": ["a"]}),
    "files/py059.launch.py": (ROS_ARGUMENTS, {"arguments": []}),
    "files/act033.launch.xml": (SHELL, {"arguments": ["a", "b", "c"]}),
    "files/py052.launch.py": (SHELL, {"command": "echo", "arguments": ["a", "b"]}),
    "files/py053.launch.py": (SHELL, {"command": "echo", "arguments": ["a", "b"]}),
    "files/act035.launch.xml": (PREFIX, {"command": "ls", "arguments": []}),
    "files/py060.launch.py": (PREFIX, {"command": "p/e", "arguments": []}),
    "files/act088.launch.xml": (RANDOM, {"name": "q_1"}),
    "files/sub24.launch.xml": (RANDOM, {"r": "a_1"}),
}
# The stub prepares processes and never starts them, so OnProcessStart does not fire: ProcessStarted is emitted once the
# process runs (launch/actions/execute_local.py:590).
STUB = {"files/py041.launch.py": ["true", "p/e"]}


class EveryPackage(PackageIndex):
    """Takes every package for existing, as the recording did."""

    def __init__(self, root: Path):
        super().__init__(environment={})
        self._root = root

    def find(self, package: str, near: str | Path | None = None) -> Path:
        folder = self._root / "share" / package
        folder.mkdir(parents=True, exist_ok=True)
        return folder


def neutral(text: Any, root: Path) -> Any:
    """Returns text without the paths of this machine, as the recording has it."""
    if isinstance(text, bytes):
        return str(text)
    if not isinstance(text, str):
        return list(text) if isinstance(text, tuple) else text
    for folder in ("share", "lib"):
        text = text.replace(str(root / folder), folder.upper())
    for folder in ("files", "yaml"):
        text = text.replace(str(HERE / folder), "FOLDER")
    return re.sub(r"/(?:tmp|root|home|work|var/folders)\b[^ ]*", "PATH", text)


def flat(values: dict[str, Any], prefix: str = "") -> dict[str, Any]:
    """Joins nested names with dots."""
    found = {}
    for name, value in values.items():
        found |= flat(value, f"{prefix}{name}.") if isinstance(value, dict) else {prefix + name: value}
    return found


def parameters(process: LaunchedProcess) -> dict[str, Any]:
    """Returns a process's parameters, those of files and single ones joined."""
    found: dict[str, Any] = {}
    for entry in process.parameters:
        if isinstance(entry, Path | ParameterText):
            text = entry.text if isinstance(entry, ParameterText) else entry.read_text() if entry.is_file() else "{}"
            for node in (yaml.safe_load(text) or {}).values():
                found |= flat(node.get("ros__parameters", {}))
        else:
            found |= entry
    return found


def outcome(launched: Launched, root: Path) -> dict[str, Any]:
    """Returns an evaluation as the recording writes it."""

    def texts(values: dict[str, Any]) -> dict[str, Any]:
        return {name: neutral(value, root) for name, value in values.items()}

    processes = [
        {
            "command": neutral(process.what, root),
            "arguments": [neutral(word, root) for word in process.arguments],
            "environment": texts(dict(process.environment)),
            "name": process.name if process.kind == NODE else None,
            "namespace": process.namespace,
            "parameters": texts(parameters(process)),
            "remappings": dict(process.remappings),
        }
        for process in launched.processes
    ]
    return {"processes": processes, "configurations": texts(dict(launched.configurations))}


def expected(key: str) -> dict[str, Any]:
    """Returns what ROS makes of a file, without its internals, and as the twin shows it."""
    wanted = json.loads(json.dumps(OUTCOMES[key]))
    wanted["configurations"] = {
        name: value
        for name, value in wanted["configurations"].items()
        if name not in INTERNAL and not name.startswith("anon")
    }
    for name, value in DIFFERENT.get(key, ("", {}))[1].items():
        (wanted["processes"][0] if wanted["processes"] else wanted["configurations"])[name] = value
    return wanted


def test_every_file_has_an_outcome():
    """A file that is missing would pass unseen."""
    files = {f"{file.parent.name}/{file.name}" for file in HERE.glob("*/*") if ".launch." in file.name}
    included = {f"{folder}/{name}" for folder in ("files", "yaml") for name in ("inc.launch.xml", "inc.launch.py")}
    assert files - included == set(OUTCOMES)
    assert len(OUTCOMES) == 524


@pytest.mark.parametrize("key", [key for key in OUTCOMES if not OUTCOMES[key].get("refused") and key not in STUB])
def test_a_file_that_ros_runs_has_the_same_outcome(key, tmp_path, monkeypatch):
    monkeypatch.setenv("PWD", "/home/somebody")  # a file asks for it
    launched = evaluate(HERE / key, {}, EveryPackage(tmp_path))
    assert repr(sorted_keys(outcome(launched, tmp_path))) == repr(sorted_keys(expected(key)))  # NaN is not NaN
    assert launched.refused_by_ros == ()


@pytest.mark.parametrize("key", [key for key in OUTCOMES if OUTCOMES[key].get("refused")])
def test_a_file_that_ros_refuses_is_refused_or_says_so(key, tmp_path):
    try:
        launched = evaluate(HERE / key, {}, EveryPackage(tmp_path))
        reasons = [item.what for item in launched.refused_by_ros]
    except InputError as error:
        reasons = [error.message]
    assert reasons


@pytest.mark.parametrize(("key", "commands"), STUB.items())
def test_what_the_recording_could_not_start(key, commands, tmp_path):
    launched = evaluate(HERE / key, {}, EveryPackage(tmp_path))
    assert [process.what for process in launched.processes] == commands


def sorted_keys(value: Any) -> Any:
    """Sorts the keys of mappings, also in lists."""
    if isinstance(value, dict):
        return {name: sorted_keys(value[name]) for name in sorted(value)}
    return [sorted_keys(item) for item in value] if isinstance(value, list) else value
