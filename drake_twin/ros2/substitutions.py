"""ROS 2's substitutions (``launch.substitutions`` and ``launch_ros.substitutions``)."""

from __future__ import annotations

import importlib
import math
import os
import shlex
import shutil
import subprocess
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import yaml

from drake_twin.errors import InputError
from drake_twin.ros2.logic_substitutions import (
    AllSubstitution,
    AndSubstitution,
    AnySubstitution,
    EqualsSubstitution,
    IfElseSubstitution,
    NotEqualsSubstitution,
    NotSubstitution,
    OrSubstitution,
)
from drake_twin.ros2.packages import AbsentError, absent_package_in
from drake_twin.ros2.substitution import (
    SomeSubstitutionsType,
    Substitution,
    SubstitutionFailure,
    TextSubstitution,
    as_texts,
    normalize_to_list_of_substitutions,
    perform,
    perform_substitutions,
)
from drake_twin.ros2.xacro_command import run_xacro

if TYPE_CHECKING:
    from drake_twin.ros2.context import LaunchContext

__all__ = [
    "AllSubstitution",
    "AndSubstitution",
    "AnonName",
    "AnySubstitution",
    "Command",
    "EnvironmentVariable",
    "EqualsSubstitution",
    "ExecutableInPackage",
    "FileContent",
    "FindExecutable",
    "FindPackage",
    "FindPackagePrefix",
    "FindPackageShare",
    "ForEachVar",
    "ForLoopIndex",
    "IfElseSubstitution",
    "LaunchConfiguration",
    "LaunchLogDir",
    "LocalSubstitution",
    "NotEqualsSubstitution",
    "NotSubstitution",
    "OrSubstitution",
    "Parameter",
    "PathJoinSubstitution",
    "PathSubstitution",
    "PythonExpression",
    "StringJoinSubstitution",
    "Substitution",
    "SubstitutionFailure",
    "TextSubstitution",
    "ThisLaunchFile",
    "ThisLaunchFileDir",
]


class LaunchConfiguration(Substitution):
    """The value of a launch configuration, such as an argument.

    Args:
        variable_name: its name.
        default: what it is where nobody set it.
    """

    def __init__(self, variable_name: SomeSubstitutionsType, *, default: Any = None):
        self.variable_name = normalize_to_list_of_substitutions(variable_name)
        self.default = None if default is None else normalize_to_list_of_substitutions(as_texts(default))

    def perform(self, context: LaunchContext) -> str:
        """The value.

        Raises:
            InputError: nobody set it, and there is no default.
        """
        name = perform_substitutions(context, self.variable_name)
        if name in context.launch_configurations:
            return str(context.launch_configurations[name])
        if self.default is not None:
            return perform_substitutions(context, self.default)
        known = [key for key in context.launch_configurations if key not in ("ros_remaps", "global_params")]
        raise InputError(f"launch configuration {name!r} does not exist", value=name, valid=known)

    def describe(self) -> str:
        """As in ROS."""
        return f"LaunchConfig({_described(self.variable_name)})"


class EnvironmentVariable(Substitution):
    """An environment variable's value."""

    def __init__(self, name: SomeSubstitutionsType, *, default_value: SomeSubstitutionsType | None = None):
        self.name = normalize_to_list_of_substitutions(name)
        self.default_value = None if default_value is None else normalize_to_list_of_substitutions(default_value)

    def perform(self, context: LaunchContext) -> str:
        """The value, or the default.

        Raises:
            InputError: it is not set, and there is no default.
        """
        name = perform_substitutions(context, self.name)
        value = context.environment.get(name)
        if value is not None:
            return value
        if self.default_value is None:
            raise InputError(f"environment variable {name!r} is not set")
        return perform_substitutions(context, self.default_value)

    def describe(self) -> str:
        """As in ROS."""
        return f"EnvVar({_described(self.name)})"


class PathJoinSubstitution(Substitution):
    """Parts of a path, joined; each is text, a substitution or a list of them."""

    def __init__(self, substitutions: Iterable[Any]):
        self.substitutions = [normalize_to_list_of_substitutions(part) for part in substitutions]

    def perform(self, context: LaunchContext) -> str:
        """The path."""
        return os.path.join(*(perform_substitutions(context, part) for part in self.substitutions))

    def describe(self) -> str:
        """The parts between slashes."""
        return "/".join(_described(part).strip("'") for part in self.substitutions)


class PathSubstitution(PathJoinSubstitution):
    """A path to which parts are added with ``/``."""

    def __init__(self, path: SomeSubstitutionsType):
        super().__init__([path])


class StringJoinSubstitution(Substitution):
    """Texts, joined with a delimiter."""

    def __init__(self, substitutions: Iterable[Any], delimiter: SomeSubstitutionsType = ""):
        self.substitutions = [normalize_to_list_of_substitutions(part) for part in substitutions]
        self.delimiter = normalize_to_list_of_substitutions(delimiter)

    def perform(self, context: LaunchContext) -> str:
        """The joined text."""
        parts = (perform_substitutions(context, part) for part in self.substitutions)
        return perform_substitutions(context, self.delimiter).join(parts)


class PythonExpression(Substitution):
    """A Python expression; the launch file's code, run as it is.

    Args:
        expression: text and substitutions that make the expression.
        python_modules: modules that it may name; what ``math`` holds may be named without ``math.``.
    """

    def __init__(self, expression: SomeSubstitutionsType, python_modules: SomeSubstitutionsType | None = None):
        self.expression = normalize_to_list_of_substitutions(as_texts(expression))
        modules = ["math"] if python_modules is None else python_modules
        modules = [modules] if isinstance(modules, str | Substitution) else list(modules)
        self.python_modules = [normalize_to_list_of_substitutions(module) for module in modules]

    def perform(self, context: LaunchContext) -> str:
        """The expression's value as text.

        Raises:
            InputError: the expression raises something.
        """
        expression = perform_substitutions(context, self.expression)
        names: dict[str, Any] = {}
        for parts in self.python_modules:
            module = importlib.import_module(perform_substitutions(context, parts))
            names[module.__name__.partition(".")[0]] = importlib.import_module(module.__name__.partition(".")[0])
            if module is math:
                names.update((name, value) for name, value in vars(math).items() if not name.startswith("_"))
        try:
            return str(eval(expression, {}, names))
        except Exception as error:  # the file's own code raises whatever it likes
            raise InputError(f"the Python expression {expression!r} fails: {type(error).__name__}: {error}") from None

    def describe(self) -> str:
        """As in ROS."""
        return f"PythonExpr({_described(self.expression)})"


class Command(Substitution):
    """What a command prints; ``xacro`` is expanded by the twin itself.

    Args:
        command: the command line.
        on_stderr: what ROS does about warnings: ``fail``, ``ignore``, ``warn`` or ``capture``. Here warnings are
            logged whatever it says, for xacro warns about files that work.
    """

    def __init__(self, command: SomeSubstitutionsType, *, on_stderr: SomeSubstitutionsType = "fail"):
        self.command = normalize_to_list_of_substitutions(command)
        self.on_stderr = normalize_to_list_of_substitutions(on_stderr)

    def perform(self, context: LaunchContext) -> str:
        """The command's output.

        Raises:
            InputError: it is not there, or it fails.
        """
        command = perform_substitutions(context, self.command)
        on_stderr = perform_substitutions(context, self.on_stderr)
        try:
            words = shlex.split(command)
        except ValueError as error:
            raise InputError(f"the command {command!r} cannot be split into words ({error})") from None
        if not words:
            raise InputError("the command is empty")
        expanded = run_xacro(words, context) or _parameter_of_node(words, context)
        output, warnings = _run(command, words) if expanded is None else expanded
        if warnings.strip() and on_stderr != "ignore":
            context.log.append(f"{words[0]}: {warnings.strip()}")
        return output + (warnings if on_stderr == "capture" else "")

    def describe(self) -> str:
        """As in ROS."""
        return f"Command({_described(self.command)})"


def _parameter_of_node(words: Sequence[str], context: LaunchContext) -> tuple[str, str] | None:
    """``ros2 param get NODE NAME``: the parameter that the launch gave the node; None for another command."""
    names = [word for word in words[3:] if not word.startswith("-")]
    if list(words[:3]) != ["ros2", "param", "get"] or len(names) != 2:
        return None
    node, parameter = f"/{names[0].lstrip('/')}", names[1]
    for process in context.processes:
        values = [entry[parameter] for entry in process.parameters if isinstance(entry, Mapping) and parameter in entry]
        if process.full_name == node and values:
            return str(values[-1]), ""
    raise AbsentError(f"{' '.join(words)!r} asks for a parameter of {node}, which this launch file does not start")


def _run(command: str, words: Sequence[str]) -> tuple[str, str]:
    try:
        result = subprocess.run(words, capture_output=True, text=True, check=False)
    except OSError as error:
        raise AbsentError(f"the command {command!r} cannot be run: {words[0]}: {error.strerror}") from None
    if result.returncode != 0:
        absent = absent_package_in(command)
        because = f", for package {absent!r} is absent" if absent else ""
        kind = AbsentError if absent else InputError
        raise kind(
            f"the command {command!r} fails with exit code {result.returncode}{because}: {result.stderr.strip()}"
        )
    return result.stdout, result.stderr


class FindExecutable(Substitution):
    """The path of an executable; where there is none (``ros2``, ``gz``), its name."""

    def __init__(self, *, name: SomeSubstitutionsType):
        self.name = normalize_to_list_of_substitutions(name)

    def perform(self, context: LaunchContext) -> str:
        """The path."""
        name = perform_substitutions(context, self.name)
        return name if name == "xacro" else shutil.which(name, path=context.environment.get("PATH")) or name

    def describe(self) -> str:
        """As in ROS."""
        return f"FindExec({_described(self.name)})"


class FindPackage(Substitution):
    """A package's folder; subclasses say which."""

    def __init__(self, package: SomeSubstitutionsType):
        self.package = normalize_to_list_of_substitutions(package)

    def perform(self, context: LaunchContext) -> str:
        """The folder."""
        name = perform_substitutions(context, self.package)
        return self._folder(context, name)

    def find(self, package_name: str) -> str:
        """The folder of a package, seen from the file at hand."""
        from drake_twin.ros2.evaluation import current_context

        return self._folder(current_context(), package_name)

    def _folder(self, context: LaunchContext, name: str) -> str:
        return str(context.find_package(name))

    def describe(self) -> str:
        """As in ROS."""
        return f"{type(self).__name__.replace('Package', 'Pkg')}(pkg={_described(self.package)})"


class FindPackageShare(FindPackage):
    """A package's share folder."""


class FindPackagePrefix(FindPackage):
    """The folder that holds ``share/PACKAGE``."""

    def _folder(self, context: LaunchContext, name: str) -> str:
        return str(context.packages.prefix(name, context.current_launch_file))


class ExecutableInPackage(FindPackage):
    """The path of an executable that a package installs; it need not exist here."""

    def __init__(self, executable: SomeSubstitutionsType, package: SomeSubstitutionsType):
        super().__init__(package)
        self.executable = normalize_to_list_of_substitutions(executable)

    def perform(self, context: LaunchContext) -> str:
        """The path."""
        package = perform_substitutions(context, self.package)
        prefix = context.packages.prefix(package, context.current_launch_file)
        return str(prefix / "lib" / package / perform_substitutions(context, self.executable))


class ThisLaunchFile(Substitution):
    """The path of the launch file."""

    def perform(self, context: LaunchContext) -> str:
        """The path."""
        if context.current_launch_file is None:
            raise InputError("there is no launch file here")
        return context.current_launch_file


class ThisLaunchFileDir(Substitution):
    """The folder of the launch file."""

    def perform(self, context: LaunchContext) -> str:
        """The folder."""
        if context.current_launch_file is None:
            raise InputError("there is no launch file here")
        return str(Path(context.current_launch_file).parent)


class FileContent(Substitution):
    """The text of a file."""

    def __init__(self, path: SomeSubstitutionsType):
        self.path = normalize_to_list_of_substitutions(path)

    def perform(self, context: LaunchContext) -> str:
        """The text.

        Raises:
            InputError: the file cannot be read.
        """
        path = context.locate(perform_substitutions(context, self.path))
        absent = absent_package_in(str(path))
        if absent is not None:
            raise AbsentError(f"package {absent!r} is absent, and a file of it is read: {path}")
        try:
            return path.read_text(encoding="utf-8")
        except (OSError, UnicodeDecodeError) as error:
            raise InputError(f"cannot be read ({error})", file=path) from None


class AnonName(Substitution):
    """A name that nobody else has; the same in every run."""

    def __init__(self, name: SomeSubstitutionsType):
        self.name = normalize_to_list_of_substitutions(name)

    def perform(self, context: LaunchContext) -> str:
        """The name."""
        return context.anonymous_name(perform_substitutions(context, self.name))


class LaunchLogDir(Substitution):
    """The folder of the log files."""

    def perform(self, context: LaunchContext) -> str:
        """The folder."""
        home = context.environment.get("ROS_HOME") or os.path.expanduser("~/.ros")
        return context.environment.get("ROS_LOG_DIR") or os.path.join(home, "log")


class LocalSubstitution(Substitution):
    """A value of the context's locals, by an expression such as ``event.reason``."""

    def __init__(self, expression: str, description: str | None = None):
        self.expression = expression

    def perform(self, context: LaunchContext) -> str:
        """The value."""
        try:
            return str(eval(f"context.{self.expression}", {}, {"context": context.locals}))
        except Exception as error:  # the file's own code raises whatever it likes
            raise InputError(f"the local {self.expression!r} is not there ({error})") from None


class ForEachVar(Substitution):
    """The value of a ForEach's variable."""

    def __init__(self, name: SomeSubstitutionsType, default_value: SomeSubstitutionsType | None = None):
        self.name = normalize_to_list_of_substitutions(name)
        self.default_value = default_value

    def perform(self, context: LaunchContext) -> str:
        """The value."""
        name = perform_substitutions(context, self.name)
        values = context.get_locals_as_dict().get("for_each", {})
        if name in values:
            return str(values[name])
        if self.default_value is None:
            raise InputError(f"the loop has no variable {name!r}", value=name, valid=values)
        return perform(context, self.default_value)


class ForLoopIndex(ForEachVar):
    """The index of a ForLoop."""


class Parameter(Substitution):
    """The value of a parameter that SetParameter gave to all nodes."""

    def __init__(self, name: SomeSubstitutionsType):
        self.name = normalize_to_list_of_substitutions(name)

    def perform(self, context: LaunchContext) -> str:
        """The value."""
        name = perform_substitutions(context, self.name)
        for item in reversed(context.launch_configurations.get("global_params", [])):
            if isinstance(item, tuple) and item[0] == name:
                return yaml.safe_dump(item[1]).split("\n")[0] if not isinstance(item[1], str) else item[1]
        raise InputError(f"no SetParameter gives a value to {name!r}")


def _described(subst: SomeSubstitutionsType) -> str:
    return " + ".join(part.describe() for part in normalize_to_list_of_substitutions(subst))
