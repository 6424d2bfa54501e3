"""What several rooms' tests share: the rover and arm as data, and other people's robots where they are present."""

import os
import signal
import sys
from collections import defaultdict
from collections.abc import Generator
from pathlib import Path
from typing import Any

import hypothesis
import pytest
from figures import figure, pytest_terminal_summary  # noqa: F401  # for the tests in physics

from drake_twin.builder.twin_builder import TwinBuilder
from drake_twin.scenario import CENIC, Scenario
from drake_twin.twin.twin import Twin
from drake_twin.wires.rclpy_process import find_rclpy

# Hundreds of processes start: each compiles every module again where the environment forbids to keep what is compiled.
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
sys.dont_write_bytecode = False

# Programs follow a closed terminal, unless `nohup` has started them: here it may have started the tests.
signal.signal(signal.SIGHUP, signal.SIG_DFL)

# `DRAKE_TWIN_TEST_ISLANDS=1 pytest`: twins of this process have their robots in islands of so many, as `--islands 1`.
ISLANDS = int(os.environ.get("DRAKE_TWIN_TEST_ISLANDS", "0"))

# The same cases in each run: other ones are a search, for which a seed is given.
hypothesis.settings.register_profile("fixed", derandomize=True, deadline=None)
hypothesis.settings.load_profile("fixed")

ROVER = "package://rover_description/urdf/rover.urdf.xacro"
ARM = "package://arduinobot_description/urdf/arduinobot.urdf.xacro"
TESTS = Path(__file__).resolve().parent
CORPUS = Path(__file__).resolve().parents[2] / "shared" / "corpus"

# Where the tests stand beside an installed package in place of its sources, there is nothing to build and to mutate.
OF_SOURCES = ["test_distributions.py", "test_mutants.py"]
IN_CHECKOUT = (Path(__file__).parent.parent / "drake_twin" / "__init__.py").is_file()
collect_ignore = [] if IN_CHECKOUT else OF_SOURCES


if ISLANDS:
    in_one_plant: list[bool] = []
    chosen = Scenario.most_in_an_island.fget
    assert chosen is not None

    def most(scenario: Scenario) -> int:
        """Return how many share an island, in tests that do not let Drake step the plant itself."""
        if in_one_plant or scenario.engine == CENIC:
            return chosen(scenario)
        return ISLANDS if scenario.islands is None else scenario.islands

    Scenario.most_in_an_island = property(most)  # type: ignore[method-assign,assignment]

    @pytest.fixture(autouse=True)
    def _one_plant(request: pytest.FixtureRequest) -> Generator[None]:
        in_one_plant.extend([True] * (request.node.get_closest_marker("one_plant") is not None))
        yield
        in_one_plant.clear()


@pytest.fixture(autouse=True)
def _close_twins_of_islands(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> Generator[None]:
    """Twins of tests/islands have many plants: each is closed after its test, so that their memory is freed."""
    if request.path.parent.name != "islands":
        yield
        return
    made: list[Twin] = []
    plain = Twin.__init__

    def note(self: Twin, *args: Any, **kwargs: Any) -> None:
        plain(self, *args, **kwargs)
        made.append(self)

    monkeypatch.setattr(Twin, "__init__", note)
    yield
    for twin in made:
        twin.close()


def pytest_report_header() -> str | None:
    """Say what is left out."""
    return None if IN_CHECKOUT else f"not a checkout of drake_twin, left out: {', '.join(OF_SOURCES)}"


# The fast lane, `pytest -m fast`: units without a process, a browser or a long simulation.
FAST_ROOMS = frozenset(
    ("control", "controllers", "description", "from_launch", "kinematics", "messages", "planning", "ros2", "scenario")
) | {"sensors", "systems"}
TOO_SLOW_FOR_FAST = frozenset(
    ("test_bounded_yaml", "test_drake_urdf", "test_gazebo_drives", "test_hostile_files", "test_mesh_cache")
) | {"test_robot_model", "test_sdf_includes", "test_unread", "test_yaml_document"}


# The thorough lane, `pytest -m thorough`: file and function of the tests that take long.
THOROUGH = frozenset(
    line for line in (TESTS / "thorough_tests.txt").read_text(encoding="utf-8").split("\n") if line and line[0] != "#"
)


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Marks the tests of the fast and of the thorough lane; the last case of several is an everyday test.

    Tests of the machine's own ROS 2 are deselected where none is sourced.
    """
    of_ros = [item for item in items if item.get_closest_marker("ros") is not None]
    if of_ros and find_rclpy() is None:
        config.hook.pytest_deselected(items=of_ros)
        items[:] = [item for item in items if item not in of_ros]
    cases: dict[str, list[pytest.Item]] = defaultdict(list)
    for item in items:
        if item.get_closest_marker("slow") is not None or item.get_closest_marker("ros") is not None:
            continue
        name = f"{item.path.relative_to(TESTS).as_posix()}::{item.nodeid.partition('::')[2].partition('[')[0]}"
        if name in THOROUGH:
            cases[name].append(item)
        elif item.path.parent.name in FAST_ROOMS and item.path.stem not in TOO_SLOW_FOR_FAST:
            item.add_marker("fast")
    for several in cases.values():
        everyday = several[-1] if len(several) > 1 else None
        for item in several:
            if item is not everyday:
                item.add_marker("thorough")


@pytest.hookimpl(wrapper=True)
def pytest_runtest_call() -> Generator[None, None, None]:
    """Let a test fail that leaves the process looking like a node program's: later ones would fail for it."""
    environment = os.environ
    try:
        return (yield)
    finally:
        is_own = os.environ is environment
        os.environ = environment  # noqa: B003  # the object itself
        assert is_own, "os.environ is another one"


FAILED = pytest.StashKey[bool]()  # of a test whose fixtures end


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(item: pytest.Item) -> Generator[None, pytest.TestReport, pytest.TestReport]:
    """Notes for the fixtures whether their test has failed."""
    report = yield
    item.stash[FAILED] = report.failed
    return report


@pytest.fixture(scope="session")
def corpus() -> Path:
    """Robots that nobody here wrote."""
    if not CORPUS.is_dir():
        pytest.skip("the folder shared/corpus with other people's robots is not here")
    return CORPUS


def rovers(count: int = 2, spacing: float = 2.0, **options) -> TwinBuilder:
    """Rovers side by side along y, facing x, standing still."""
    builder = TwinBuilder(**options)
    for index in range(count):
        builder.robot(f"robot_{index + 1}", ROVER, xyz=(0, spacing * index, 0.13))
    return builder
