"""``drake-twin PROGRAM …`` and ``python -m drake_twin PROGRAM …``: the same as ``python -m drake_twin.PROGRAM …``.

Those that talk to a running twin are modules of `drake_twin.tools`.
"""

import sys
from collections.abc import Sequence
from importlib import import_module

from drake_twin.program import collecting_later, leave, run_program, version_text

PROGRAMS = {
    "run": "run robots in one simulation, with a page in the browser",
    "benchmarks": "time the twin beside the bare Drake plant, DART, MuJoCo and PyBullet",
    "sweep": "run a scenario over values and seeds, and tabulate what came of it",
    "play": "show a bag of ROS 2 on the page",
    "mirror": "follow a running robot, or a bag of it, and say what is wrong with it",
    "calibrate": "find the values with which a twin moves as logs of its robot say",
    "check": "report what a robot file contains, what is mended in it and what is ignored",
}
TOOLS = {
    "action": "list the actions of a running twin and send goals, as `ros2 action` does",
    "control": "list, load and switch the controllers, as `ros2 control` does",
    "interface": "list and show the types that are known, as `ros2 interface` does",
    "node": "list the nodes and what they publish, hear and serve, as `ros2 node` does",
    "param": "list, get, set, dump and load parameters, as `ros2 param` does",
    "service": "list and call the services, as `ros2 service` does",
    "tf_echo": "print the transform between two frames, as tf2_ros's tf2_echo does",
    "topic": "list, echo, publish and time the topics, as `ros2 topic` does",
}


def main() -> int:
    """Run the program that the first argument names."""
    name = sys.argv[1] if len(sys.argv) > 1 else "--help"
    if name in PROGRAMS or name in TOOLS:
        del sys.argv[1]
        sys.argv[0] = f"drake-twin {name}"
        return run_program(lambda arguments: _run(name, arguments), None)
    lines = [f"  {program:11} {what}" for program, what in (PROGRAMS | TOOLS).items()]
    usage = "\n".join(["usage: drake-twin PROGRAM …   (drake-twin PROGRAM --help explains it)", "", *lines])
    if name in ("-h", "--help"):
        print(usage)
        return 0
    if name == "--version":
        print(version_text())
        return 0
    print(f"drake-twin: unknown program {name!r}.\n{usage}", file=sys.stderr)
    return 2


def _run(name: str, arguments: Sequence[str]) -> int:
    with collecting_later():
        module = import_module(f"drake_twin.tools.{name}" if name in TOOLS else f"drake_twin.{name}")
        if hasattr(module, "__path__"):  # a package keeps its program in __main__
            module = import_module(f"drake_twin.{name}.__main__")
    return int(module.main(arguments))


if __name__ == "__main__":
    leave(main())
