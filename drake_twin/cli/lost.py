"""What a run lacks although its files ask for it: a robot, a part of it, or a world."""

from collections.abc import Iterable

from drake_twin.errors import InputError
from drake_twin.findings import Finding, Place, Weight

_MOST_TOLD = 4


def check_lost(findings: Iterable[Finding], *, keep_going: bool) -> None:
    """Check that everything is there that the files ask for.

    Args:
        findings: What became of the files.
        keep_going: Whether ``--keep-going`` accepts what is lost.

    Raises:
        InputError: If a robot, a part of it or a world is lost, with the file and line that ask for each.
    """
    lost = dict.fromkeys(_text(finding) for finding in findings if finding.weight is Weight.LOST)
    if not lost or keep_going:
        return
    told = "; ".join([*lost][:_MOST_TOLD])
    more = f"; and {len(lost) - _MOST_TOLD} more, see --findings" if len(lost) > _MOST_TOLD else ""
    raise InputError(f"lost although a file asks for it: {told}{more}. --keep-going accepts it, with exit code 0")


def _text(finding: Finding) -> str:
    what = finding.what.rstrip(".")
    place = str(Place(finding.file, next(iter(finding.lines), None)))
    return what if not finding.file or f"{place}:" in what else f"{place}: {what}"
