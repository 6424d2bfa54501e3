"""Wrong versions of the code, each with one changed line, and the tests that must notice it.

    python tests/mutants.py [--only NAME ...]

Each mutant is put into a copy of the package in a temporary folder, and the tests that belong to it run with that copy.
It is caught when they fail, or do not end. The exit code is 1 when fewer than 95 % are caught.
"""

import argparse
import os
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from importlib.util import cache_from_source
from pathlib import Path
from tempfile import TemporaryDirectory

from mutant_list import MUTANTS, Mutant

ROOT = Path(__file__).resolve().parent.parent
PACKAGE = "drake_twin"
LEAST_CAUGHT = 0.95
TIME_LIMIT = 300.0  # s for the tests of one mutant; what takes longer goes round in a circle

CAUGHT, ENDLESS, SURVIVED = "caught", "endless", "survived"


class MutantError(Exception):
    """A mutant that cannot be made, or tests that say nothing about it."""


@dataclass(frozen=True)
class Outcome:
    """What became of a mutant.

    Attributes:
        mutant: The mutant.
        result: Caught, endless (which is caught as well) or survived.
        seconds: How long its tests took.
    """

    mutant: Mutant
    result: str
    seconds: float

    @property
    def is_caught(self) -> bool:
        return self.result != SURVIVED


def find(mutant: Mutant, package: Path) -> Path:
    """Return the file of a package that has the mutant's source text.

    Raises:
        MutantError: If the text does not occur exactly once in the mutant's files.
    """
    places = [(file, file.read_text().count(mutant.text)) for file in sorted(package.glob(mutant.files))]
    found = [file for file, count in places for _ in range(count)]
    if len(found) != 1:
        where = ", ".join(file.name for file in found) or "nowhere"
        raise MutantError(f"{mutant.name}: {mutant.text!r} is to be once in {mutant.files}, and is in {where}")
    return found[0]


def mutated(mutant: Mutant, file: Path) -> str:
    """Return a file's text with the mutant's line in it."""
    return file.read_text().replace(mutant.text, mutant.replacement)


@contextmanager
def copied_package() -> Iterator[Path]:
    """Copy the package to a temporary folder, with everything that lies beside it in reach."""
    with TemporaryDirectory(prefix="mutants_") as folder:
        home = Path(folder)
        for path in ROOT.iterdir():
            if path.name != PACKAGE and not path.name.startswith("."):
                (home / path.name).symlink_to(path)
        shutil.copytree(ROOT / PACKAGE, home / PACKAGE, ignore=shutil.ignore_patterns("__pycache__"))
        yield home / PACKAGE


def run_tests(package: Path, tests: Sequence[str], time_limit: float = TIME_LIMIT) -> str:
    """Run test files with a copy of the package, and with a cache of meshes of its own: a wrong one is kept nowhere.

    Returns:
        Whether a test failed, did not end, or all passed.

    Raises:
        MutantError: If pytest could not run the tests.
    """
    command = [sys.executable, "-m", "pytest", "-x", "-q", "-p", "no:cacheprovider", "--hypothesis-seed=0"]
    command += [
        "-m",
        "not slow",
        "-c",
        str(ROOT / "pyproject.toml"),
        "--rootdir",
        str(ROOT),
        *(str(ROOT / test) for test in tests),
    ]
    cache = package.parent / "cache"
    shutil.rmtree(cache, ignore_errors=True)
    process = subprocess.Popen(
        command,
        cwd=package.parent,
        env={**os.environ, "PYTHONPATH": str(package.parent), "XDG_CACHE_HOME": str(cache)},
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        start_new_session=True,
    )
    try:
        output, _ = process.communicate(timeout=time_limit)
    except subprocess.TimeoutExpired:
        return ENDLESS
    finally:
        if process.poll() is None:
            os.killpg(process.pid, signal.SIGKILL)
            process.communicate()
    if process.returncode in (3, 4, 5):  # pytest's codes for its own errors, wrong arguments and no tests at all
        raise MutantError(output)
    return CAUGHT if process.returncode else SURVIVED  # a process that Drake has ended is caught, too


def try_mutant(mutant: Mutant, package: Path, time_limit: float = TIME_LIMIT) -> Outcome:
    """Put a mutant into a copy of the package, run its tests, and take it out again."""
    file, begin = find(mutant, package), time.monotonic()
    with written(file, mutated(mutant, file)):
        return Outcome(mutant, run_tests(package, mutant.tests, time_limit), time.monotonic() - begin)


@contextmanager
def written(file: Path, text: str) -> Iterator[None]:
    """Give a module another text for a while."""
    original = file.read_text(encoding="utf-8")
    try:
        _write(file, text)
        yield
    finally:
        _write(file, original)


def _write(file: Path, text: str) -> None:
    """Write a module; its compiled form may be of the same second and size, and goes."""
    file.write_text(text)
    Path(cache_from_source(str(file))).unlink(missing_ok=True)


def try_all(mutants: Sequence[Mutant]) -> Iterator[Outcome]:
    """Try mutants, one after the other."""
    with copied_package() as package:
        for mutant in mutants:
            yield try_mutant(mutant, package)


def main(arguments: Sequence[str] | None = None) -> int:
    """Try the mutants, and print what became of each."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", metavar="NAME", nargs="+", default=(), help="the mutants whose names have this")
    options = parser.parse_args(arguments)
    mutants = [item for item in MUTANTS if not options.only or any(name in item.name for name in options.only)]
    if not mutants:
        parser.error(f"no mutant has {' or '.join(options.only)} in its name")
    tests = tuple(dict.fromkeys(test for mutant in mutants for test in mutant.tests))
    with copied_package() as package:
        for mutant in mutants:
            find(mutant, package)
        if run_tests(package, tests, time_limit=20 * TIME_LIMIT) != SURVIVED:
            raise MutantError(f"without a mutant, these tests do not pass: {', '.join(tests)}")
    outcomes = []
    for outcome in try_all(mutants):
        outcomes.append(outcome)
        note = f"  ({outcome.mutant.survives})" if outcome.mutant.survives else ""
        print(f"{outcome.result:<9}{outcome.seconds:4.0f} s  {outcome.mutant.name}{note}", flush=True)
    caught = sum(outcome.is_caught for outcome in outcomes)
    print(f"{caught} of {len(outcomes)} caught ({caught / len(outcomes):.1%})")
    return 0 if caught >= LEAST_CAUGHT * len(outcomes) else 1


if __name__ == "__main__":
    sys.exit(main())
