import subprocess
import sys
from pathlib import Path

import pytest

import drake_twin


@pytest.mark.parametrize("module", ["", ".run", ".check", ".play", ".benchmarks"])
def test_every_program_prints_the_version_and_ends(module):
    command = [sys.executable, "-m", f"drake_twin{module}", "--version"]
    result = subprocess.run(command, capture_output=True, text=True, check=False)
    assert (result.returncode, result.stderr) == (0, "")
    assert result.stdout == f"drake_twin {drake_twin.__version__}\n"


def test_a_program_that_is_named_first_prints_it_too():
    command = [sys.executable, "-m", "drake_twin", "run", "--version"]
    assert subprocess.run(command, capture_output=True, text=True, check=True).stdout.startswith("drake_twin ")


def test_a_checkout_that_is_not_installed_has_the_version():
    code = "import drake_twin, sys; print(drake_twin.__version__, 'importlib.metadata' in sys.modules)"
    root = Path(drake_twin.__file__).parents[1]
    command = [sys.executable, "-S", "-c", code]  # without installed packages
    result = subprocess.run(command, cwd=root, capture_output=True, text=True, check=True)
    assert result.stdout == f"{drake_twin.__version__} False\n"
