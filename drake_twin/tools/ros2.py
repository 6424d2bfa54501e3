"""``ros2 topic list``, …: the tools under the name of ROS's command, for the processes that node programs start."""

import sys
from collections.abc import Sequence
from importlib import import_module

from drake_twin.errors import InputError
from drake_twin.nodes.ros2_command import COMMANDS, refusal
from drake_twin.program import run_program


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the tool that the first argument names."""
    return run_program(_run, arguments)


def _run(arguments: Sequence[str]) -> int:
    name = arguments[0] if arguments else "--help"
    if name in ("-h", "--help"):
        print("usage: ros2 COMMAND …   (ros2 COMMAND --help explains it)\n")
        print("\n".join(f"  {command}" for command in COMMANDS))
        return 0
    if name not in COMMANDS:
        raise InputError(refusal(name), value=name, valid=COMMANDS)
    return int(import_module(f"drake_twin.tools.{name}").main(arguments[1:]))


if __name__ == "__main__":
    sys.exit(main())
