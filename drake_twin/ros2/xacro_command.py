"""``xacro FILE name:=value`` in a launch file, expanded here instead of in another process."""

from collections.abc import Sequence
from pathlib import Path

from drake_twin.description.xacro_file import expand_xacro
from drake_twin.errors import InputError
from drake_twin.ros2.launch.launch_context import LaunchContext
from drake_twin.ros2.packages import AbsentError, absent_package_in

# Options of the xacro command that change nothing in the result.
_HARMLESS = ("--inorder", "-i", "--xacro-ns", "-q", "--check-order")


def run_xacro(words: Sequence[str], context: LaunchContext) -> tuple[str, str] | None:
    """Return what the command prints to standard output and error; None if it is not xacro, or another use of it.

    Args:
        words: The command and its arguments.
        context: The context.

    Raises:
        InputError: If xacro refuses the file.
    """
    if Path(words[0]).name != "xacro":
        return None
    files = [word for word in words[1:] if ":=" not in word and word not in _HARMLESS]
    if len(files) != 1 or files[0].startswith("-"):
        return None
    arguments = dict(word.split(":=", 1) for word in words[1:] if ":=" in word)
    return expand(files[0], arguments, context)


def expand(name: str, arguments: dict[str, str], context: LaunchContext) -> tuple[str, str]:
    """Return the expanded text of a xacro file, and xacro's warnings.

    Raises:
        InputError: If xacro refuses the file.
    """
    file = context.locate(name)
    absent = absent_package_in(str(file))
    if absent is not None:
        raise AbsentError(f"package {absent!r} is absent, and its file is the robot: {file}")
    if not file.is_file():
        raise InputError(f"the xacro file {file} does not exist")
    try:
        text, _, warnings = expand_xacro(file.absolute(), arguments, context.packages)
    except InputError as error:
        absent = absent_package_in(str(error))
        if absent is not None:
            raise AbsentError(
                f"package {absent!r} is absent, and the robot needs it: {error.message}", file=error.file
            ) from None
        raise
    return text, "\n".join(warnings)
