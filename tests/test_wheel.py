"""What a newcomer installs: the wheel, in an empty environment, used from another folder."""

import json
import os
import subprocess
import sys
import venv
import zipfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent


def test_the_wheel_alone_runs_two_robots_from_another_folder(tmp_path):
    subprocess.run(
        [sys.executable, "-m", "pip", "wheel", "--no-deps", "-q", "-w", tmp_path / "dist", ROOT],
        check=True,
        capture_output=True,
    )
    (wheel,) = (tmp_path / "dist").glob("drake_twin-*.whl")
    names = set(zipfile.ZipFile(wheel).namelist())
    assert {"drake_twin/py.typed", "drake_twin/docs/start.md", "drake_twin/share/diagrams/tour.ipynb"} <= names
    assert [name for name in names if name.startswith("drake_twin/docs/") and not name.endswith(".md")] == []
    venv.create(tmp_path / "env", with_pip=True)
    python = tmp_path / "env" / "bin" / "python"
    environment = {name: value for name, value in os.environ.items() if not name.startswith("PYTHON")}
    subprocess.run([python, "-m", "pip", "install", "-q", wheel], check=True, capture_output=True, env=environment)
    (tmp_path / "elsewhere").mkdir()

    def run(*command):
        result = subprocess.run(
            list(map(str, command)),
            capture_output=True,
            text=True,
            cwd=tmp_path / "elsewhere",
            env=environment,
            check=False,
        )
        assert result.returncode == 0, result.stderr
        return result.stdout

    home = Path(run(python, "-c", "import drake_twin; print(drake_twin.__file__)").strip())
    assert tmp_path in home.parents
    run(python, "-m", "drake_twin.run", "--robots", 2, "--headless", "--duration", 0.5, "--summary", "out.json")
    robots = json.loads((tmp_path / "elsewhere" / "out.json").read_text())["robots"]
    assert robots["robot_2"]["velocities"][0] > 1
    arms = ("--robot", "arduinobot", "--headless", "--duration", 0.1)
    run(tmp_path / "env" / "bin" / "drake-twin", "run", *arms)
    run(python, "-m", "drake_twin.run", "diagrams/two_rovers.yaml", "--headless", "--duration", 0.1)
