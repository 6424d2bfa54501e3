"""Programs on a disk that fails at a chosen call: what they write, how they are run, and what must hold afterwards."""

import csv
import errno
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import pytest
import yaml
from PIL import Image
from program_runs import LAUNCH_ARM, ROVER
from rosbags.highlevel import AnyReader

SOURCE = Path(__file__).with_name("failing_disk.c")
TESTS = Path(__file__).parent
KILLED = 0
BEFORE = b"before"
NODE_BAG = """
import rclpy, rosbag2_py
from rclpy.serialization import serialize_message
from std_msgs.msg import String
from sensor_msgs.msg import JointState

rclpy.init()
node = rclpy.create_node("writer")
writer = rosbag2_py.SequentialWriter()
writer.open(rosbag2_py.StorageOptions(uri={folder!r}, storage_id={kind!r}), rosbag2_py.ConverterOptions("", ""))
writer.create_topic(rosbag2_py.TopicMetadata(0, "/states", "sensor_msgs/msg/JointState", "cdr"))
def heard(message):
    writer.write("/states", serialize_message(message), node.get_clock().now().nanoseconds)
node.create_subscription(JointState, "/robot_1/joint_states", heard, 10)
rclpy.spin(node)
"""


def compiled() -> Path:
    """The library; the test is skipped where no compiler is."""
    if shutil.which("cc") is None or sys.platform != "linux":
        pytest.skip("a library that lets calls of Linux fail needs a C compiler")
    made = Path(tempfile.mkdtemp(prefix="drake_twin_faults_")) / "failing_disk.so"
    subprocess.run(["cc", "-shared", "-fPIC", "-O1", str(SOURCE), "-o", str(made), "-ldl"], check=True)
    return made


def _json(file: Path) -> None:
    json.loads(file.read_text())


def _page(file: Path) -> None:
    assert file.read_text().rstrip().endswith("</html>")


def _picture(file: Path) -> None:
    with Image.open(file) as picture:
        picture.load()


def _table(file: Path) -> None:
    if file.suffix == ".parquet":
        import pyarrow.parquet

        assert pyarrow.parquet.read_table(file).num_rows == 2
    elif file.suffix == ".csv":
        assert len(list(csv.reader(file.read_text().splitlines()[1:]))) == 3
    else:
        assert [type(json.loads(line)) for line in file.read_text().splitlines()] == [dict] * 3


def _svg(file: Path) -> None:
    assert file.read_text().rstrip().endswith("</svg>")


def _scenario(file: Path) -> None:
    assert "robots" in yaml.safe_load(file.read_text())


def _bag(folder: Path) -> None:
    with AnyReader([folder]) as reader:
        for _ in reader.messages():
            pass


def _lines(file: Path) -> None:
    assert file.read_text().endswith("\n")


_READERS: dict[str, Callable[[Path], None]] = {
    ".json": _json,
    ".html": _page,
    ".png": _picture,
    ".csv": _table,
    ".jsonl": _table,
    ".parquet": _table,
    ".svg": _svg,
    ".yaml": _scenario,
    ".dot": _lines,
    ".txt": _lines,
    "": _bag,
}


@dataclass(frozen=True)
class Job:
    """A program and what it is to write.

    Attributes:
        program: Its module.
        words: Its command line; ``OUT`` is the folder that fails, ``IN`` one with the files that it needs.
        outputs: What is to be in ``OUT``.
        environment: More of its environment.
        may_do_without: Whether what it writes there is a cache, and all else is as without a fault.
        beside: What else may be in ``OUT``.
    """

    program: str
    words: str
    outputs: tuple[str, ...] = ()
    environment: dict[str, str] = field(default_factory=dict)
    may_do_without: bool = False
    beside: tuple[str, ...] = ()


_RUN = f"{ROVER} --robots 1 --headless --duration 0.3"
_SWEEP = f"{ROVER} --vary ground_friction=0.5,0.6 --duration 0.02 --workers 1 --out OUT/table"
JOBS = {
    "bag": Job("run", f"{_RUN} --bag OUT/bag", ("bag",)),
    "html": Job("run", f"{_RUN} --save-html OUT/page.html", ("page.html",)),
    "summary": Job("run", f"{_RUN} --summary OUT/summary.json", ("summary.json",)),
    "plot": Job("run", f"{_RUN} --plot OUT/plot.png", ("plot.png",)),
    "svg": Job("run", f"{_RUN} --plot OUT/plot.svg", ("plot.svg",)),
    "state": Job("run", f"{_RUN} --save-state OUT/state.json", ("state.json",)),
    "recording": Job("run", f"{_RUN} --record OUT/run.json", ("run.json",)),
    "all": Job(
        "run",
        f"{_RUN} --summary OUT/summary.json --plot OUT/plot.svg --save-state OUT/state.json --record OUT/run.json"
        " --bag OUT/bag",
        ("summary.json", "plot.svg", "state.json", "run.json", "bag"),
    ),
    "diagram": Job("run", f"{_RUN} --graphviz OUT/diagram.dot", ("diagram.dot",)),
    "csv": Job("sweep", f"{_SWEEP}.csv", ("table.csv",), beside=("table.csv.journal",)),
    "jsonl": Job("sweep", f"{_SWEEP}.jsonl", ("table.jsonl",), beside=("table.jsonl.journal",)),
    "parquet": Job("sweep", f"{_SWEEP}.parquet", ("table.parquet",), beside=("table.parquet.journal",)),
    "calibration": Job(
        "calibrate",
        "IN/robot.yaml --log IN/log --fit pendulum.arm.mass=1:3 --fit pendulum.hinge.damping=0.1:1"
        " --method least-squares --start pendulum.arm.mass=1.6 --out OUT/fitted.yaml --plot OUT/fit.svg",
        ("fitted.yaml", "fit.svg"),
    ),
    "caches": Job(
        "run",
        f"{LAUNCH_ARM} --headless --duration 0.05",
        environment={"XDG_CACHE_HOME": "OUT"},
        may_do_without=True,
        beside=("drake_twin",),
    ),
    "mcap of a node": Job("run", f"{_RUN} --node IN/write_mcap.py", ("of_node",)),
    "db3 of a node": Job("run", f"{_RUN} --node IN/write_sqlite3.py", ("of_node",)),
    "output": Job("check", f"{ROVER} --json", ("out.json",)),
    "scenario": Job("run", f"{ROVER} --robots 1 --show-scenario", ("out.yaml",)),
}


def port_jobs(port: int) -> dict[str, Job]:
    """Return programs that open ports: this one, if they can be told."""
    run, outputs = f"{ROVER} --robots 1 --duration 0.3 --summary OUT/summary.json", ("summary.json",)
    return {
        "page at any port": Job("run", f"{run} --no-browser", outputs),
        "zenoh": Job("run", f"{run} --headless --ros zenoh --ros-port {port}", outputs),
        "foxglove": Job("run", f"{run} --headless --foxglove --foxglove-port {port}", outputs),
        "dds": Job("run", f"{run} --headless --ros dds", outputs, {"ROS_DOMAIN_ID": "91"}),
        "page": Job("run", f"{run} --no-browser --port {port}", outputs),
    }


@dataclass(frozen=True)
class Outcome:
    """What a run ended with.

    Attributes:
        code: Its exit code.
        said: Its standard output and error.
        counted: How many calls were counted.
        failed: How many have failed.
        kept: What became of each output: whole, before, absent, or why it is half.
        left: What else is there.
    """

    code: int
    said: str
    counted: int
    failed: int
    kept: dict[str, str]
    left: tuple[str, ...]


class FaultyRuns:
    """Runs jobs with faults, in forks of one process.

    Args:
        folder: For all files.
    """

    def __init__(self, folder: Path, library: Path):
        self._folder = folder
        environment = os.environ | {"LD_PRELOAD": str(library), "PYTHONDONTWRITEBYTECODE": "1", "MPLBACKEND": "agg"}
        environment["PYTHONPATH"] = os.pathsep.join(filter(None, [str(TESTS.parent), os.environ.get("PYTHONPATH")]))
        words = [sys.executable, str(TESTS / "fault_server.py")]
        self._server = subprocess.Popen(
            words, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, env=environment
        )
        self._inputs = folder / "in"
        self._inputs.mkdir()
        self._count = 0

    def __enter__(self) -> "FaultyRuns":
        return self

    def __exit__(self, *_: object) -> None:
        self._server.stdin.close()
        self._server.stdout.close()
        self._server.wait(60)

    @property
    def inputs(self) -> Path:
        """The folder of the files that jobs need."""
        return self._inputs

    def run(
        self, job: Job, *, call="any", number=0, error=errno.ENOSPC, lasts=False, replaces=False, under=None
    ) -> Outcome:
        """Run a job.

        Args:
            job: The job.
            call: Which calls are counted.
            number: The first that fails; none for 0.
            error: With what, or `KILLED`.
            lasts: Whether all that follow fail, too.
            replaces: Whether its files are there before.
            under: The folder whose files' calls are counted, if not the one that the job writes into.
        """
        self._count += 1
        work = self._folder / str(self._count)
        out = work / "out"
        out.mkdir(parents=True)
        (work / "tmp").mkdir()
        for name in job.outputs if replaces else ():
            if "." in name and job.program != "sweep":
                (out / name).write_bytes(BEFORE)
        state = work / "state"
        state.write_bytes(bytes(16))
        environment = {
            **{name: text.replace("OUT", str(out)) for name, text in job.environment.items()},
            "TMPDIR": str(work / "tmp"),
            "FAILING_UNDER": f"{under or out}/",
            "FAILING_CALL": call,
            "FAILING_NUMBER": str(number),
            "FAILING_ERRNO": str(error),
            "FAILING_LASTS": str(int(lasts)),
            "FAILING_STATE": str(state),
        }
        words = [word.replace("OUT", str(out)).replace("IN/", f"{self._inputs}/") for word in job.words.split()]
        printed = next((out / name for name in job.outputs if name.startswith("out.")), work / "printed")
        ask = {"program": job.program, "words": words, "environment": environment}
        self._server.stdin.write(json.dumps({**ask, "out": str(printed), "err": str(work / "err")}) + "\n")
        self._server.stdin.flush()
        code = int(self._server.stdout.readline())
        counted, failed = (int.from_bytes(state.read_bytes()[at : at + 8], "little") for at in (0, 8))
        said = (work / "err").read_text(errors="replace")
        said += "" if printed.parent == out else printed.read_text(errors="replace")
        kept = {name: _became(out / name) for name in job.outputs}
        left = tuple(sorted({item.name for item in out.iterdir()} - {*job.outputs, *job.beside}))
        shutil.rmtree(work)
        return Outcome(code, said.replace(str(out), "OUT"), counted, failed, kept, left)


def _became(file: Path) -> str:
    if not file.exists():
        return "absent"
    if file.is_file() and file.read_bytes() == BEFORE:
        return "before"
    try:
        _READERS[file.suffix](file)
    except Exception as error:
        return f"half: {type(error).__name__}: {error}"
    return "whole"


def problems(job: Job, outcome: Outcome, healthy: Outcome, *, killed: bool) -> list[str]:
    """Return what does not hold of a run with a fault."""
    found = []
    ended = outcome.code < 0 or killed
    is_of_node = "error: node " in outcome.said  # whose traceback is its author's to read
    if "Traceback" in outcome.said and not is_of_node:
        found.append("it ends in a traceback")
    if outcome.code not in (0, 1, 2) and not killed:
        found.append(f"exit code {outcome.code}")
    lost = [name for name, what in outcome.kept.items() if what != "whole"]
    half = [name for name, what in outcome.kept.items() if what.startswith("half")]
    if outcome.code == 0 and lost:
        found.append(f"exit code 0 without {lost}")
    told = [name for name in half if name.startswith(("bag", "of_node", "out.")) and outcome.code]
    if set(half) - set(told):
        found.append(f"{ {name: outcome.kept[name] for name in half} }")
    if not ended and lost and not outcome.said.strip():
        found.append(f"not a word about {lost}")
    if not ended:
        is_refused = outcome.code == 2 and not half  # before anything runs
        if is_refused:
            lost = []
        found += [f"{name} is not named" for name in lost if name not in outcome.said and not name.startswith("out.")]
        if outcome.left:
            found.append(f"it leaves {outcome.left}")
    if not killed:
        states = [re.findall(r"state (\w+)", item.said) for item in (outcome, healthy)]
        if outcome.code == 0 and states[0] != states[1]:
            found.append("the robot is another one")
    return found


def error_name(number: int) -> str:
    """The name of an error, or that the process is killed."""
    return errno.errorcode.get(number, "killed") if number else "killed"


def prepare(inputs: Path) -> None:
    """Write the files that jobs need."""
    from calibration.pendulum_logs import messages, pendulum, write_log

    from drake_twin.scenario.scenario_file import scenario_to_yaml

    (inputs / "robot.yaml").write_text(scenario_to_yaml(pendulum(inputs)))
    write_log(inputs / "log", messages())
    for kind in ("mcap", "sqlite3"):
        text = NODE_BAG.format(folder="FOLDER", kind=kind).replace(
            "'FOLDER'", 'os.environ["FAILING_UNDER"] + "of_node"'
        )
        (inputs / f"write_{kind}.py").write_text("import os\n" + text)


def moments(counts: dict[str, int], most: int, seed: int) -> Sequence[tuple[str, int, int, bool, bool]]:
    """Draw moments: job, number of the call, error, whether it lasts, whether files are replaced."""
    import random

    generator = random.Random(seed)
    kinds = [(errno.ENOSPC, True), (errno.ENOSPC, False), (errno.EIO, False), (errno.EPERM, False)]
    kinds += [(errno.EROFS, True), (errno.EDQUOT, True), (KILLED, False)]
    every = [
        (name, number, error, lasts)
        for name, count in counts.items()
        for number in range(1, count + 1)
        for error, lasts in kinds
    ]
    drawn = every if len(every) <= most else generator.sample(every, most)
    return [(*item, generator.random() < 0.5) for item in drawn]
