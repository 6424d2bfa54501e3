"""Programs of which the output of the real rclpy was recorded, as nodes of a twin or with the machine's own ROS 2."""

import re
import subprocess
from difflib import SequenceMatcher
from pathlib import Path

from drake_twin.builder.twin_builder import TwinBuilder

FOLDER = Path(__file__).parent / "rclpy_outcomes"
PROGRAMS = sorted(file.stem for file in FOLDER.glob("p*.py"))
BOX = (
    '<robot name="box"><link name="base"><inertial><mass value="1"/>'
    '<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link></robot>'
)
ABORTED = ("p16_actions",)  # the real rclpy was aborted by its C++ after the lines that are recorded
LONGEST = 40.0  # s of simulation time
_EXCEPTION = re.compile(r"(@@ .*? ! [A-Z]\w+)( \|[^|]*\|)?.*")

_MEMBER = re.compile(r"(@@ M \S+ \w+\.(\w+)) .*")
# What enumerations and dictionaries have from Python: the parameters differ between its versions.
_OF_PYTHON = frozenset(name for name in (*dir(int), *dir(dict)) if name[0] != "_")


def prepared(name: str, folder: Path) -> Path:
    """Copy a program with what it needs into a folder; return the copy."""
    (folder / "h.py").write_text((FOLDER / "h.py").read_text("utf-8"))
    text = (FOLDER / f"{name}.py").read_text("utf-8")
    file = folder / f"{name}.py"
    file.write_text(text.replace("@TMP@", str(folder)).replace("@SCRATCH@", str(folder)))
    return file


def write_test_msgs(folder: Path) -> Path:
    """Write the package test_msgs; return the folder with its sources."""
    package = folder / "tws" / "src" / "test_msgs"
    package.mkdir(parents=True)
    (package / "package.xml").write_text("<package><name>test_msgs</name></package>\n")
    for line in (FOLDER / "test_msgs.txt").read_text("utf-8").splitlines():
        name, _, declarations = line.partition(":")
        _, kind, own = name.split("/")
        file = package / kind / f"{own}.{kind}"
        file.parent.mkdir(exist_ok=True)
        file.write_text("".join(f"{item}\n" for item in declarations.strip().split("; ")), "utf-8")
    return package.parent


def run_in_twin(file: Path) -> None:
    """Run a program as a node of a twin without robots that matter, until it prints that it has ended."""
    (file.parent / "box.urdf").write_text(BOX)
    builder = TwinBuilder(time_step=0.01).robot("box", file.parent / "box.urdf", xyz=(0, 0, 0.5)).node(file)
    if "test_msgs" in file.read_text("utf-8"):
        builder.package_path(write_test_msgs(file.parent))
    with builder.build() as twin:
        while twin.time < LONGEST and not _ended(twin):
            twin.advance_to(twin.time + 0.5)


def _ended(twin) -> bool:
    return twin.time > 0 and all(program.main.has_ended for program in twin.alarm.call.__self__.programs)


def run_with_ros(file: Path, python: str) -> list[str]:
    """Run a program with a Python that has the real rclpy; return its lines."""
    ran = subprocess.run([python, file.name], cwd=file.parent, capture_output=True, text=True, timeout=120, check=False)
    return judged(ran.stdout.splitlines())


def judged(lines: list[str]) -> list[str]:
    """Return the lines that are compared."""
    return [line for line in lines if line.startswith("@@ ")]


def recorded(name: str) -> list[str]:
    """Return what the real rclpy printed."""
    return judged((FOLDER / f"{name}.out").read_text("utf-8").split("\n"))


def compared(name: str, printed: list[str]) -> list[str]:
    """Return the lines of a program that differ from the recorded ones."""
    expected = recorded(name)
    absent = {line.split()[2] for line in expected if line.startswith("@@ MOD ") and " ABSENT " in line}
    # Of a module that the recorded machine lacked, there is nothing to compare but that it is there.
    printed = [line for line in printed if not line.endswith(".is_integer (self)")]  # since Python 3.12
    printed = [line for line in printed if line.startswith("@@ MOD ") or not absent.intersection(line.split()[2:3])]
    return differences(expected, printed[: len(expected)] if name in ABORTED else printed)


def normal(line: str) -> str:
    """Return a line without an exception's text, and without the parameters of what is Python's own."""
    member = _MEMBER.fullmatch(line)
    if member is not None and (member[2] in _OF_PYTHON or line.endswith((" (*values)", "boundary=)"))):
        return member[1]
    found = _EXCEPTION.fullmatch(line)
    return line if found is None else found[1] + (found[2] or "")


def differences(expected: list[str], printed: list[str]) -> list[str]:
    """Return the lines that differ: those that were expected with ``-``, those that were printed instead with ``+``."""
    found = []
    old, new = [normal(line) for line in expected], [normal(line) for line in printed]
    for kind, a, b, c, d in SequenceMatcher(None, old, new, autojunk=False).get_opcodes():
        if kind != "equal":
            found += [f"- {line}" for line in expected[a:b]] + [f"+ {line}" for line in printed[c:d]]
    return found
