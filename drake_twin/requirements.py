"""The packages that drake_twin requires, what each extra of pyproject.toml is for, and the command that installs them.

The command names the packages themselves. It works wherever drake_twin came from: an index, a wheel or a checkout that
may be gone by now.
"""

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import NamedTuple

from drake_twin.errors import InputError, TwinError

DRAKE = (1, 51, 1)  # the oldest version

# Module → requirement.
BASE = {
    "PIL": "pillow>=10",
    "aiohttp": "aiohttp>=3.10",
    "collada": "pycollada>=0.8",
    "embreex": "embreex>=4",
    "lxml": "lxml>=5",
    "meshcat": "meshcat>=0.3.2",
    "numpy": "numpy>=1.26",
    "pydrake": "drake>=1.51.1",
    "rosbags": "rosbags>=0.11.1",
    "scipy": "scipy>=1.11",
    "trimesh": "trimesh>=4.7",
    "xacro": "xacro>=2.1",
    "xxhash": "xxhash>=3",
    "yaml": "pyyaml>=6",
    "zenoh": "eclipse-zenoh>=1.6.1",
}
OPTIONAL = {
    "av": "av>=14",
    "coacd": "coacd>=1",
    "cyclonedds": "cyclonedds>=11.0.1",
    "dartpy": "dartpy>=6.20",
    "foxglove": "foxglove-sdk>=0.26",
    "gymnasium": "gymnasium>=1.0",
    "jupyterlab": "jupyterlab>=4",
    "matplotlib": "matplotlib>=3.8",
    "mujoco": "mujoco>=3.3",
    "pyarrow": "pyarrow>=17",
    "pybullet": "pybullet>=3.2.7",
    "ray": "ray>=2.60",
    "rich": "rich>=13",
}


class Extra(NamedTuple):
    """An extra for users.

    Attributes:
        purpose: What it is for.
        modules: The modules that it brings, keys of `OPTIONAL`.
    """

    purpose: str
    modules: tuple[str, ...]


EXTRAS = {
    "all": Extra("all of those below", tuple(OPTIONAL)),
    "benchmarks": Extra("`python -m drake_twin.benchmarks`", ("dartpy", "matplotlib", "mujoco", "pybullet")),
    "dds": Extra("`--ros dds`", ("cyclonedds",)),
    "decomposition": Extra("`collision: decomposition`", ("coacd",)),
    "film": Extra("`--record film.mp4`", ("av",)),
    "foxglove": Extra("`--foxglove`", ("foxglove",)),
    "gym": Extra("`import drake_twin.gym`", ("gymnasium",)),
    "notebook": Extra("`diagrams/tour.ipynb`", ("jupyterlab",)),
    "plot": Extra("`--plot`", ("matplotlib",)),
    "ray": Extra("`--engine ray` of a sweep", ("ray",)),
    "sweep": Extra("Parquet, `--plot` and the progress bar of a sweep", ("matplotlib", "pyarrow", "rich")),
}
DEVELOPMENT = ("corpus", "docs", "test")  # extras of those who change drake_twin


class RequirementError(InputError, ImportError):
    """Raised where a package that is needed is missing, too old or broken; the text has the command that helps."""


def missing(what: str, *modules: str, otherwise: str = "") -> RequirementError:
    """Return the error for a feature whose packages are not installed, or which the current exception says are broken.

    Args:
        what: The feature with its verb, such as ``--plot needs``.
        modules: The modules that it imports, keys of `BASE` or `OPTIONAL`.
        otherwise: What can be done instead, appended to the command.
    """
    absent = [module for module in modules if not _is_found(module)]
    requirements = [(BASE | OPTIONAL)[module] for module in absent or modules]
    packages = [requirement.partition(">")[0] for requirement in requirements]
    listed = " and ".join(filter(None, (", ".join(packages[:-1]), packages[-1])))
    error = sys.exception()
    state = "is not installed" if len(packages) == 1 else "are not installed"
    if error is not None and not absent:
        state = f"cannot be imported ({' '.join(str(error).split())})"
        requirements.insert(0, "--force-reinstall")
    return RequirementError(f"{what} {listed}, which {state}: `{_pip(*requirements)}`{otherwise}")


@contextmanager
def imports_explained() -> Iterator[None]:
    """Raise a `RequirementError` in place of an exception whose cause is a base requirement.

    Costs nothing unless there is an exception.
    """
    try:
        yield
    except Exception as error:
        explained = explanation(error)
        if explained is None or explained is error:
            raise
        raise explained from error


def explanation(error: BaseException) -> RequirementError | None:
    """Return the error that names the base requirement which caused an exception; None if none did."""
    if isinstance(error, RequirementError):
        return error
    if isinstance(error, TwinError | OSError | MemoryError) or not isinstance(error, Exception):
        return None
    for each in _chain(error):
        if isinstance(each, ModuleNotFoundError) and _top(each) in BASE and not _is_found(_top(each)):
            return missing("drake_twin needs", *(module for module in BASE if not _is_found(module)))
    if (old := _old_drake()) is not None:
        return old
    return next((_broken_drake(each) for each in _chain(error) if _is_about_drake(each)), None)


def check_drake() -> None:
    """Check the version of the installed Drake.

    Raises:
        RequirementError: If it is older than `DRAKE`.
    """
    if (old := _old_drake()) is not None:
        raise old


def _chain(error: BaseException | None) -> Iterator[BaseException]:
    while error is not None:
        yield error
        error = error.__cause__ or (None if error.__suppress_context__ else error.__context__)


def _top(error: ImportError) -> str:
    return (error.name or "").partition(".")[0]


def _is_found(module: str) -> bool:
    from importlib.util import find_spec

    try:
        return bool(module) and find_spec(module) is not None
    except ValueError:  # a module that was made without a spec
        return True


def _old_drake() -> RequirementError | None:
    import re
    from importlib.metadata import PackageNotFoundError, version

    try:
        installed = version("drake")
    except PackageNotFoundError:  # built from source
        return None
    numbers = tuple(int(number) for number in re.findall(r"\d+", installed)[: len(DRAKE)])
    if numbers >= DRAKE:
        return None
    oldest = ".".join(map(str, DRAKE))
    return RequirementError(
        f"drake_twin needs Drake {oldest} or newer, and {installed} is installed: `{_pip(BASE['pydrake'])}`"
    )


def _is_about_drake(error: BaseException) -> bool:
    """Whether pydrake failed while it was imported, or did not have a name that this package imports."""
    frames = []
    traceback = error.__traceback__
    while traceback is not None:
        code = traceback.tb_frame.f_code
        if not code.co_filename.startswith("<frozen"):
            frames.append((Path(code.co_filename), code.co_name))
        traceback = traceback.tb_next
    is_own = not frames or frames[-1][0].is_relative_to(Path(__file__).parent)
    if isinstance(error, ImportError) and _top(error) == "pydrake" and is_own:
        return True
    return any(name == "<module>" and "pydrake" in file.parts for file, name in frames)


def _broken_drake(error: BaseException) -> RequirementError:
    reason = " ".join(f"{type(error).__name__}: {error}".split())
    text = f"drake_twin needs Drake, which is installed but cannot be imported ({reason}): "
    if "cannot open shared object file" in reason:
        return RequirementError(
            f"{text}install the system's package with that library (https://drake.mit.edu/pip.html)"
        )
    return RequirementError(text + f"`{_pip('--force-reinstall', BASE['pydrake'])}`")


def _pip(*arguments: str) -> str:
    """Return the command with which pip installs into the environment that is running."""
    import shlex

    return shlex.join([_interpreter(), "-m", "pip", "install", *arguments])


def _interpreter() -> str:
    """Return ``python`` where that is the interpreter that is running, otherwise its path from the working folder."""
    import shutil

    own, python = Path(sys.executable), shutil.which("python")
    if python is not None and Path(python).parent == own.parent and Path(python).samefile(own):
        return "python"
    try:
        return str(own.relative_to(Path.cwd()))
    except (OSError, ValueError):  # the folder is gone, or the interpreter stands elsewhere
        return str(own)
