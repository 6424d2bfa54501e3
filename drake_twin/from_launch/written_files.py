"""The files of bridges that a launch writes itself: ``echo TEXT >> FILE``, as simple_launch configures its bridges."""

from collections.abc import Sequence
from pathlib import Path

from drake_twin.from_launch.bridges import is_bridge
from drake_twin.from_launch.launched_robots import parameters
from drake_twin.ros2.launched import LaunchedProcess


class WrittenFiles:
    """Find what ``echo`` writes into files that are not there yet and that bridges of the launch read.

    Args:
        processes: All that the launch starts.

    Attributes:
        texts: Name of a file → its text.
    """

    def __init__(self, processes: Sequence[LaunchedProcess]):
        names = [str(parameters(process).get("config_file", "")) for process in processes if is_bridge(process)]
        missing = {name for name in names if name and not Path(name).is_file()}
        self.texts: dict[str, str] = {}
        for process in processes:
            if _is_echo(process) and (name := process.arguments[2]) in missing:
                before = self.texts.get(name, "") if process.arguments[1] == ">>" else ""
                self.texts[name] = f"{before}{process.arguments[0]}\n"

    def are_by(self, process: LaunchedProcess) -> bool:
        """Return whether a process writes one of them."""
        return _is_echo(process) and process.arguments[2] in self.texts


def _is_echo(process: LaunchedProcess) -> bool:
    is_echo = process.package is None and process.executable == "echo" and len(process.arguments) == 3
    return is_echo and process.arguments[1] in (">", ">>")
