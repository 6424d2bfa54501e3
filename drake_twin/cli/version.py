"""The option ``--version``."""

import argparse
from collections.abc import Sequence


def version_text() -> str:
    """Return the package's name and version."""
    import drake_twin

    return f"drake_twin {drake_twin.__version__}"


def add_version(parser: argparse.ArgumentParser) -> None:
    """Add ``--version``, which prints the version and ends the program."""
    parser.add_argument("--version", action=_PrintVersion, nargs=0, help="print the version and end")


class _PrintVersion(argparse.Action):
    """Reads the version only when it is printed: reading it takes time that every start would lose."""

    def __call__(
        self,
        parser: argparse.ArgumentParser,
        namespace: argparse.Namespace,
        values: str | Sequence[object] | None,
        option_string: str | None = None,
    ) -> None:
        print(version_text())
        parser.exit()
