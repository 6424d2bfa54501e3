"""What became of each part of the files that a twin is built from, where it was not simply used."""

from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum
from pathlib import PurePath
from typing import Any

from drake_twin.saved import saved


class Kind(StrEnum):
    """What became of a part of a file, in the order in which findings are listed."""

    FAILED = "failed"  # a controller whose code raised an error: it is deactivated
    NOT_STARTED = "not started"
    IGNORED = "ignored"
    REFUSED_BY_ROS = "refused by ROS 2"  # the twin reads it, and ROS 2 Jazzy would end with an error
    WARNING = "warning"
    MENDED = "mended"
    WINDOW = "window"  # of a program such as RViz: the page replaces it, and nothing is lost


class Weight(StrEnum):
    """What a part of a file is for, in the order in which findings are told."""

    LOST = "lost"  # a robot, a part of it that has a file of its own, or a world: what runs is something else
    MOVES = "moves"  # how robots move, and what is published and heard
    LOOKS = "looks"  # how they look, or what Gazebo's engine (DART) does not use either


@saved("Place")
@dataclass(frozen=True)
class Place:
    """Where something was written: a file and a line (from 1) where it is known."""

    file: str
    line: int | None = None

    def __str__(self) -> str:
        return self.file if self.line is None else f"{self.file}:{self.line}"


# What --strict counts: a file asks for it and the twin does not do it, or ROS does not.
_NOT_DONE = (Kind.FAILED, Kind.IGNORED, Kind.NOT_STARTED, Kind.REFUSED_BY_ROS)

_MOST_LINES = 8  # in a sentence
_MOST_THINGS = 6  # of one cause, in a sentence
_MOST_TOLD = 5  # lines of a run that does not ask for all findings


@saved("Finding")
@dataclass(frozen=True)
class Finding:
    """What became of one thing in a file.

    Attributes:
        kind: Mended, ignored, not started, failed, a warning or a window.
        what: The thing, and why it is so.
        robot: The robot that it is about; empty when it is about the world or the launch.
        file: The file that says it, where that is known.
        lines: Its lines in that file, where they are known.
        rule: The name of the repair.
        weight: What the thing is for.
        common: The end of ``what`` that others of its kind share: their beginnings are told in one line.
    """

    kind: Kind
    what: str
    robot: str = ""
    file: str = ""
    lines: tuple[int, ...] = ()
    rule: str = ""
    weight: Weight = Weight.MOVES
    common: str = ""

    @classmethod
    def at(
        cls, kind: Kind, what: str, place: Place, rule: str = "", *, weight: Weight = Weight.MOVES, common: str = ""
    ) -> "Finding":
        """Return a finding about one place."""
        lines = () if place.line is None else (place.line,)
        return cls(kind, what, file=place.file, lines=lines, rule=rule, weight=weight, common=common)

    def __str__(self) -> str:
        return f"{self.robot}: {self.sentence}" if self.robot else self.sentence

    @property
    def sentence(self) -> str:
        """The finding without the robot's name."""
        more = f" and {len(self.lines) - _MOST_LINES} more" if len(self.lines) > _MOST_LINES else ""
        numbers = ", ".join(map(str, self.lines[:_MOST_LINES])) + more
        where = (f"{PurePath(self.file).name}:{numbers}" if self.file else f"line {numbers}") if numbers else ""
        if self.kind is Kind.MENDED:
            return (f"{where}: " if where else "") + f"{self.what} [{self.rule}]"
        return self.what + (f" ({where})" if where else "")

    def as_plain(self) -> dict[str, Any]:
        """Return the finding as plain data, for JSON."""
        return {
            "kind": str(self.kind),
            "what": self.what,
            "robot": self.robot,
            "file": self.file,
            "lines": list(self.lines),
            "rule": self.rule,
            "weight": str(self.weight),
        }


def at_places(kind: Kind, found: Iterable[tuple[str, Place]], *, weight: Weight = Weight.MOVES) -> Iterator[Finding]:
    """Group what was found at several places into findings: one for each file, with its lines."""
    return merged(Finding.at(kind, what, place, weight=weight) for what, place in found)


def merged(findings: Iterable[Finding]) -> Iterator[Finding]:
    """Merge findings that differ only in their lines."""
    lines: dict[Finding, dict[int, None]] = {}  # in place of an ordered set
    for finding in findings:
        lines.setdefault(replace(finding, lines=()), {}).update(dict.fromkeys(finding.lines))
    for finding, numbers in lines.items():
        yield replace(finding, lines=tuple(numbers))


def texts(findings: Iterable[Finding], *kinds: Kind) -> tuple[str, ...]:
    """Return the findings of some kinds as sentences."""
    return tuple(str(finding) for finding in findings if finding.kind in kinds)


def grouped(findings: Iterable[Finding]) -> list[tuple[Kind, str]]:
    """Return kind and sentence of each finding: what is lost, then kind by kind; one about several robots once."""
    kinds = list(Kind)
    ranked = sorted(findings, key=lambda finding: (finding.weight is not Weight.LOST, kinds.index(finding.kind)))
    return _sentences(ranked)


def most_telling(findings: Iterable[Finding]) -> list[str]:
    """Return a few lines of the findings, the weightiest first; the last one tells of the rest."""
    weights, kinds = list(Weight), list(Kind)
    ranked = sorted(findings, key=lambda finding: (weights.index(finding.weight), kinds.index(finding.kind)))
    sentences = _sentences(_together(ranked))
    told = len(sentences) if len(sentences) <= _MOST_TOLD else _MOST_TOLD - 1
    lines = [f"{kind}: {sentence}" for kind, sentence in sentences[:told]]
    if rest := sentences[told:]:
        numbers = ", ".join(f"{count} {kind}" for kind, count in Counter(kind for kind, _ in rest).items())
        lines.append(f"and {len(rest)} more findings ({numbers}): --findings prints them all")
    return lines


def _together(findings: Iterable[Finding]) -> Iterator[Finding]:
    """Join findings of one robot that have one cause: the same end of their sentences, or the same repair."""
    groups: dict[object, list[Finding]] = {}
    for finding in findings:
        cause = (finding.kind, finding.robot, finding.file, finding.common, finding.rule)
        groups.setdefault(cause if finding.common or finding.rule else finding, []).append(finding)
    for first, *others in groups.values():
        if first.common and others:
            things = [finding.what.removesuffix(first.common) for finding in (first, *others)]
            more = f" and {len(things) - _MOST_THINGS} more" if len(things) > _MOST_THINGS else ""
            what = f"{', '.join(things[:_MOST_THINGS])}{more}{first.common}"
            lines = sorted({line for finding in (first, *others) for line in finding.lines})
            yield replace(first, what=what, lines=tuple(lines))
        elif others:
            yield replace(first, what=f"{first.what}, and {len(others)} more of this repair")
        else:
            yield first


def _sentences(findings: Iterable[Finding]) -> list[tuple[Kind, str]]:
    """Return kind and sentence of each finding, with the names of all robots that it is about."""
    about: dict[tuple[Kind, str], list[str]] = {}
    for finding in findings:
        robots = about.setdefault((finding.kind, finding.sentence), [])
        if finding.robot and finding.robot not in robots:
            robots.append(finding.robot)
    return [
        (kind, f"{', '.join(robots)}: {sentence}" if robots else sentence) for (kind, sentence), robots in about.items()
    ]


def strict_text(lost: Iterable[Finding]) -> str:
    """Count findings by kind: ``2 ignored, 1 not started``."""
    return ", ".join(f"{count} {kind}" for kind, count in Counter(finding.kind for finding in lost).items())


def counted(findings: Sequence[Finding], strict: str | None) -> list[Finding]:
    """Select the findings that ``--strict`` does not accept.

    Args:
        findings: All findings.
        strict: None without ``--strict``; ``lost`` for what is ignored, not started or refused by ROS 2, ``mended`` for
            that and what is mended.
    """
    kinds = () if strict is None else (*_NOT_DONE, Kind.MENDED) if strict == "mended" else _NOT_DONE
    return [finding for finding in findings if finding.kind in kinds]
