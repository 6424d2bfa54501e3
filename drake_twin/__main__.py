"""``drake-twin PROGRAM …`` and ``python -m drake_twin PROGRAM …``: the same as ``python -m drake_twin.PROGRAM …``."""

import sys
from importlib import import_module

from drake_twin.program import leave, version_text

PROGRAMS = {
    "run": "run robots in one simulation, with a page in the browser",
    "benchmarks": "time the twin beside the bare Drake plant, MuJoCo and PyBullet",
    "check": "report what a robot file contains, what is mended in it and what is ignored",
}


def main() -> int:
    """Run the program that the first argument names."""
    name = sys.argv[1] if len(sys.argv) > 1 else "--help"
    if name in PROGRAMS:
        del sys.argv[1]
        sys.argv[0] = f"drake-twin {name}"
        module = import_module(f"drake_twin.{name}")
        if hasattr(module, "__path__"):  # a package keeps its program in __main__
            module = import_module(f"drake_twin.{name}.__main__")
        return int(module.main())
    lines = [f"  {program:11} {what}" for program, what in PROGRAMS.items()]
    usage = "\n".join(["usage: drake-twin PROGRAM …   (drake-twin PROGRAM --help explains it)", "", *lines])
    if name in ("-h", "--help"):
        print(usage)
        return 0
    if name == "--version":
        print(version_text())
        return 0
    print(f"drake-twin: unknown program {name!r}.\n{usage}", file=sys.stderr)
    return 2


if __name__ == "__main__":
    leave(main())
