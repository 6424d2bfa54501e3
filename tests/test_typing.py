"""A user's program that imports the public names passes ``mypy --strict``, and mypy finds its mistakes.

The programs stand in ``typed_programs``. mypy sees the package as a user's does: among the installed packages, without
this checkout's configuration. Its cache lasts: the first run takes 20 s of processor time, the next 1 s.
"""

import re
import subprocess
import sys
import venv
from pathlib import Path

import pytest

import drake_twin

PACKAGE = Path(drake_twin.__file__).resolve().parent
PROGRAMS = Path(__file__).parent / "typed_programs"


@pytest.fixture(scope="module")
def users_python(tmp_path_factory) -> Path:
    """A virtual environment that has the package beside all that is installed here."""
    folder = tmp_path_factory.mktemp("environment")
    venv.create(folder, symlinks=True)
    (packages,) = folder.glob("lib/python3.*/site-packages")
    (packages / "drake_twin").symlink_to(PACKAGE)
    installed = [path for path in sys.path if path.endswith("site-packages")]
    (packages / "others.pth").write_text("\n".join(installed))
    return folder / "bin" / "python"


def errors(python: Path, cache: Path, *programs: Path) -> list[tuple[str, int, str]]:
    """File, line and code of each error that ``mypy --strict`` finds."""
    options = ["--strict", "--config-file", "", "--python-executable", str(python), "--cache-dir", str(cache)]
    command = [sys.executable, "-m", "mypy", *options, "--no-error-summary", *map(str, programs)]
    run = subprocess.run(command, cwd=python.parent, capture_output=True, text=True, timeout=300, check=False)
    found = re.findall(r"^(.+):(\d+): error: .*\[([\w-]+)\]$", run.stdout, re.MULTILINE)
    assert (run.returncode != 0) == bool(found), run.stdout + run.stderr
    return [(Path(file).name, int(line), code) for file, line, code in found]


def test_mypy_finds_the_mistakes_of_users_and_none_of_the_packages(users_python, pytestconfig):
    pytest.importorskip("mypy")
    misuse = (PROGRAMS / "misuse.py").read_text(encoding="utf-8").splitlines()
    marked = [
        ("misuse.py", number, line.partition("  # ")[2]) for number, line in enumerate(misuse, 1) if "  # " in line
    ]
    programs = (PROGRAMS / "user.py", PROGRAMS / "misuse.py")
    assert errors(users_python, pytestconfig.cache.mkdir("mypy"), *programs) == marked


def test_the_users_program_has_no_exemption_and_runs(tmp_path):
    program = PROGRAMS / "user.py"
    assert "type: ignore" not in program.read_text(encoding="utf-8").partition('"""\n\n')[2]
    run = subprocess.run([sys.executable, str(program)], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stdout + run.stderr
