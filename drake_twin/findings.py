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


@saved("Place")
@dataclass(frozen=True)
class Place:
    """Where something was written: a file and a line (from 1) where it is known."""

    file: str
    line: int | None = None

    def __str__(self) -> str:
        return self.file if self.line is None else f"{self.file}:{self.line}"


# What --strict counts: a file asks for it and the twin does not do it, or ROS does not.
LOST = (Kind.FAILED, Kind.IGNORED, Kind.NOT_STARTED, Kind.REFUSED_BY_ROS)

_MOST_LINES = 8  # in a sentence
_MOST_TOLD = 5  # lines of a run that does not ask for all findings

# How the sentence begins that names meshes whose faults do not change what collides.
HARMLESS_MESHES = "convex hulls collide in place of faulty meshes"

# What is told last: how a robot looks, and what Gazebo's engine (DART) does not use either.
_LEAST = (
    *("<material>", "<visual>", "<scene>", "<light>", "<script>", "<color>", "<shadows>", "<grid>", "<gui>"),
    *("<transmission>", "stiffness and damping of contact follow from the masses", HARMLESS_MESHES),
)


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
    """

    kind: Kind
    what: str
    robot: str = ""
    file: str = ""
    lines: tuple[int, ...] = ()
    rule: str = ""

    @classmethod
    def at(cls, kind: Kind, what: str, place: Place, rule: str = "") -> "Finding":
        """Return a finding about one place."""
        return cls(kind, what, file=place.file, lines=() if place.line is None else (place.line,), rule=rule)

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
        }


def at_places(kind: Kind, found: Iterable[tuple[str, Place]]) -> Iterator[Finding]:
    """Group what was found at several places into findings: one for each file, with its lines."""
    return merged(Finding.at(kind, what, place) for what, place in found)


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
    """Return kind and sentence of each finding, kind by kind; the same one about several robots once."""
    about: dict[tuple[Kind, str], list[str]] = {}
    kinds = list(Kind)
    for finding in sorted(findings, key=lambda finding: kinds.index(finding.kind)):
        robots = about.setdefault((finding.kind, finding.sentence), [])
        if finding.robot and finding.robot not in robots:
            robots.append(finding.robot)
    return [
        (kind, f"{', '.join(robots)}: {sentence}" if robots else sentence) for (kind, sentence), robots in about.items()
    ]


def most_telling(findings: Sequence[Finding]) -> list[str]:
    """Return a few lines of the findings, kind by kind, first what changes the robot; the last tells of the rest."""
    sentences = grouped(findings)
    if len(sentences) <= _MOST_TOLD:
        return [f"{kind}: {sentence}" for kind, sentence in sentences]
    kinds = list(Kind)
    ranked = sorted(sentences, key=lambda each: (_is_least(*each), kinds.index(each[0])))
    rest = ranked[_MOST_TOLD - 1 :]
    numbers = ", ".join(f"{count} {kind}" for kind, count in Counter(kind for kind, _ in rest).items())
    told = [f"{kind}: {sentence}" for kind, sentence in ranked[: _MOST_TOLD - 1]]
    return [*told, f"and {len(rest)} more findings ({numbers}): --findings prints them all"]


def _is_least(kind: Kind, sentence: str) -> bool:
    is_of_a_file = kind in (Kind.IGNORED, Kind.WARNING, Kind.MENDED)
    return kind is Kind.WINDOW or (is_of_a_file and any(tag in sentence for tag in _LEAST))


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
    kinds = () if strict is None else (*LOST, Kind.MENDED) if strict == "mended" else LOST
    return [finding for finding in findings if finding.kind in kinds]
