"""Files that are rewritten during the evaluation: ``$(var …)`` filled in, keys and texts replaced."""

from abc import ABC, abstractmethod
from pathlib import Path

from drake_twin.description.lasting_files import lasting_file
from drake_twin.description.source_file import file_text
from drake_twin.errors import InputError
from drake_twin.ros2.launch.launch_context import LaunchContext
from drake_twin.ros2.launch.substitution import SomeSubstitutionsType, Substitution
from drake_twin.ros2.launch.utilities.normalize_to_list_of_substitutions_impl import normalize_to_list_of_substitutions
from drake_twin.ros2.launched import ParameterText
from drake_twin.ros2.packages import AbsentError, absent_package_in


class RewrittenFile(Substitution, ABC):
    """The path of a file that is made of another.

    Args:
        source_file: The other file.
    """

    def __init__(self, source_file: SomeSubstitutionsType):
        self.source_file = normalize_to_list_of_substitutions(source_file)

    def perform(self, context: LaunchContext) -> str:
        """Return the path of the rewritten file.

        Raises:
            InputError: If the source file cannot be read.
        """
        source = source_of(context, self.source_file)
        return str(write_rewritten(context, ParameterText(source.file, self.rewrite(source, context))))

    @abstractmethod
    def rewrite(self, source: ParameterText, context: LaunchContext) -> str:
        """Return the text that replaces the file's."""


def source_of(context: LaunchContext, source_file: SomeSubstitutionsType) -> ParameterText:
    """Read a file, which may be a rewritten one.

    Raises:
        InputError: If it cannot be read.
    """
    path = context.locate(context.perform_substitution(source_file))
    return context.rewritten.get(str(path)) or ParameterText(path, read_parameter_file(path))


def read_parameter_file(path: Path) -> str:
    """Read a parameter file's text.

    Raises:
        InputError: If it cannot be read.
    """
    absent = absent_package_in(str(path))
    if absent is not None:
        raise AbsentError(f"package {absent!r} is absent, and a file of it is read: {path}")
    try:
        return file_text(path)
    except (OSError, UnicodeDecodeError) as error:
        reason = getattr(error, "strerror", None) or error
        raise InputError(f"the parameter file {path} cannot be read ({reason})") from None


def write_rewritten(context: LaunchContext, content: ParameterText) -> Path:
    """Write a rewritten file, and note its content in the context."""
    path = lasting_file(content.file.name, content.text)
    context.rewritten[str(path)] = content
    return path
