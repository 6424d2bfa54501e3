"""What libsdformat makes of a file, by ``read_values.cc``, which is compiled where libsdformat 12 is installed."""

import json
import shutil
import subprocess
from pathlib import Path

import numpy as np
from pydrake.common.eigen_geometry import Quaternion
from pydrake.math import RigidTransform

SOURCE = Path(__file__).with_name("read_values.cc")


def compile_reader(folder):
    """Compile the reader and return it; None without libsdformat."""
    program = Path(folder) / "read_values"
    if shutil.which("pkg-config") is None or shutil.which("g++") is None:
        return None
    flags = subprocess.run(["pkg-config", "--cflags", "--libs", "sdformat12"], capture_output=True, text=True)
    if flags.returncode != 0:
        return None
    if not program.is_file() or program.stat().st_mtime < SOURCE.stat().st_mtime:
        command = ["g++", "-std=c++17", "-O1", str(SOURCE), "-o", str(program), *flags.stdout.split()]
        subprocess.run(command, check=True)
    return program


def gazebo_models(reader, file, folders=()):
    """Return the models that libsdformat reads from a file, and what it says on its error output."""
    command = [str(reader), str(file), *map(str, folders)]
    try:
        done = subprocess.run(command, capture_output=True, text=True, errors="replace", timeout=60)
    except subprocess.TimeoutExpired:
        return [], "it needs more than 60 s"
    if done.returncode != 0:
        return [], done.stderr
    return [json.loads(line) for line in done.stdout.splitlines() if line.startswith("{")], done.stderr


def transform(numbers):
    quaternion = np.array(numbers[3:])
    return RigidTransform(Quaternion(quaternion / np.linalg.norm(quaternion)), numbers[:3])


def flattened(model, X_WO=None, prefix=""):
    """Yield a model and those in it as they stand in the world: links there, names ``OUTER::INNER``."""
    if model["pose"] is None:  # it is relative to what is not there
        return
    X_WM = (RigidTransform() if X_WO is None else X_WO) @ transform(model["pose"])
    name = f"{prefix}{model['name']}"
    yield name, X_WM, model
    for inner in model.get("models", ()):
        yield from flattened(inner, X_WM, f"{name}::")
