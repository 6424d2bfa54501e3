"""What a run lacks although its files ask for it: a robot, a part of it, or a world; and what has failed in it."""

from collections.abc import Collection, Iterable

from drake_twin.errors import InputError, RunError
from drake_twin.findings import Finding, Kind, Place, Weight

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
    raise InputError(f"lost although a file asks for it: {_told(lost)}. --keep-going accepts it, with exit code 0")


def check_failed(findings: Iterable[Finding], *, keep_going: bool) -> None:
    """Check that nothing has failed while the twin ran: no node, no controller, no code of another package.

    Args:
        findings: What became of the files and of what runs.
        keep_going: Whether ``--keep-going`` accepts what has failed.

    Raises:
        RunError: If something has failed, with each.
    """
    failed = dict.fromkeys(str(finding) for finding in findings if finding.kind is Kind.FAILED)
    if failed and not keep_going:
        raise RunError(f"failed: {_told(failed)}. --keep-going accepts it, with exit code 0")


def _told(texts: Collection[str]) -> str:
    more = f"; and {len(texts) - _MOST_TOLD} more, see --findings" if len(texts) > _MOST_TOLD else ""
    return "; ".join([*texts][:_MOST_TOLD]) + more


def _text(finding: Finding) -> str:
    what = finding.what.rstrip(".")
    place = str(Place(finding.file, next(iter(finding.lines), None)))
    return what if not finding.file or f"{place}:" in what else f"{place}: {what}"
