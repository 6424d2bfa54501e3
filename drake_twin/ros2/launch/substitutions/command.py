"""What a command prints."""

import shlex
import subprocess
from collections.abc import Mapping, Sequence
from pathlib import Path

from drake_twin.ros2.described_substitutions import described
from drake_twin.ros2.launch.frontend.expose import expose_substitution
from drake_twin.ros2.launch.launch_context import LaunchContext
from drake_twin.ros2.launch.substitution import SomeSubstitutionsType, Substitution
from drake_twin.ros2.launch.substitutions.substitution_failure import AbsentFailure, SubstitutionFailure
from drake_twin.ros2.launch.utilities.normalize_to_list_of_substitutions_impl import normalize_to_list_of_substitutions
from drake_twin.ros2.package_command import about_package
from drake_twin.ros2.packages import absent_package_in
from drake_twin.ros2.xacro_command import run_xacro


@expose_substitution("command")
class Command(Substitution):
    """What a command prints; ``xacro`` is expanded by the twin itself.

    Args:
        command: The command line.
        on_stderr: What ROS does about warnings: ``fail``, ``ignore``, ``warn`` or ``capture``. Here warnings are
            logged with each of them, for xacro warns about files that work.
    """

    def __init__(self, command: SomeSubstitutionsType, *, on_stderr: SomeSubstitutionsType = "fail"):
        self.command = normalize_to_list_of_substitutions(command)
        self.on_stderr = normalize_to_list_of_substitutions(on_stderr)

    def perform(self, context: LaunchContext) -> str:
        """Return the command's output.

        Raises:
            SubstitutionFailure: If the command is not found, or fails.
        """
        command = context.perform_substitution(self.command)
        on_stderr = context.perform_substitution(self.on_stderr)
        try:
            words = shlex.split(command)
        except ValueError as error:
            raise SubstitutionFailure(f"the command {command!r} cannot be split into words ({error})") from None
        if not words:
            raise SubstitutionFailure("the command is empty")
        expanded = run_xacro(words, context) or _parameter_of_node(words, context) or _of_package(words, context)
        output, warnings = _run(command, words) if expanded is None else expanded
        if warnings.strip() and on_stderr != "ignore":
            context.log.append(f"{words[0]}: {warnings.strip()}")
        if warnings.strip() and on_stderr == "fail":
            context.refused_by_ros(f"the command {words[0]!r} writes to standard error")
        return output + (warnings if on_stderr == "capture" else "")

    def describe(self) -> str:
        """Return ROS's own description."""
        return f"Command({described(self.command)})"


def _parameter_of_node(words: Sequence[str], context: LaunchContext) -> tuple[str, str] | None:
    """Return what ``ros2 param get NODE NAME`` prints, for a node of this launch; None for another command."""
    names = [word for word in words[3:] if not word.startswith("-")]
    if list(words[:3]) != ["ros2", "param", "get"] or len(names) != 2:
        return None
    node, parameter = f"/{names[0].lstrip('/')}", names[1]
    for process in context.processes:
        values = [entry[parameter] for entry in process.parameters if isinstance(entry, Mapping) and parameter in entry]
        if process.full_name == node and values:
            return str(values[-1]), ""
    raise AbsentFailure(f"{' '.join(words)!r} asks for a parameter of {node}, which this launch file does not start")


def _of_package(words: Sequence[str], context: LaunchContext) -> tuple[str, str] | None:
    """Return what ``ros2 pkg prefix`` or ``ros2 pkg xml`` prints; None for another command."""
    packages, near = context.packages, context.current_launch_file

    def share_of(name: str) -> Path:
        if not packages.is_present(name, near):
            raise AbsentFailure(f"{' '.join(words)!r} asks for package {name!r}, which is absent")
        return packages.find(name, near)

    answer = about_package(words, share_of, lambda name: packages.prefix(name, near))
    return None if answer is None else (answer, "")


def _run(command: str, words: Sequence[str]) -> tuple[str, str]:
    try:
        result = subprocess.run(words, capture_output=True, text=True, check=False)
    except OSError as error:
        raise AbsentFailure(f"the command {command!r} cannot be run: {words[0]}: {error.strerror}") from None
    if result.returncode != 0:
        absent = absent_package_in(command)
        because = f", for package {absent!r} is absent" if absent else ""
        kind = AbsentFailure if absent else SubstitutionFailure
        raise kind(
            f"the command {command!r} fails with exit code {result.returncode}{because}: {result.stderr.strip()}"
        )
    return result.stdout, result.stderr
