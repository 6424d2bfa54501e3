"""The space that a robot takes that is not in the twin yet, measured in a process of its own."""

import json
import sys
from collections.abc import Mapping, Sequence

from drake_twin.cockpit.limited_process import LimitedProcess
from drake_twin.errors import TwinError
from drake_twin.python_process import die_with

LONGEST = 30.0  # s of wall time


class RobotBox(LimitedProcess):
    """A box that is measured; `output` is the lower and the upper corner in the root link's frame (m), as JSON.

    Args:
        file: The robot's file.
        arguments: Its xacro arguments.
        folders: The folders of packages to search first.
    """

    def __init__(self, file: str, arguments: Mapping[str, str], folders: Sequence[str]):
        given = [file, json.dumps([dict(arguments), list(folders)])]
        super().__init__(__name__, given, "the robot takes longer than {longest} s to measure", LONGEST)


def main(parent: str, file: str, data: str) -> int:
    """Print a robot's box, or what is wrong with it."""
    die_with(int(parent))
    arguments, folders = json.loads(data)
    from drake_twin.description.package_index import PackageIndex
    from drake_twin.diagram.footprint import footprint
    from drake_twin.planning.plan_robot import plan_robot
    from drake_twin.scenario import Robot

    try:
        box = footprint(plan_robot(Robot("robot", file, xacro_args=arguments), PackageIndex(folders)))
    except (TwinError, RuntimeError) as error:
        print(error, file=sys.stderr)
        return 2
    print(json.dumps([box.lower, box.upper]))
    return 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
