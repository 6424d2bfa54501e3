"""What became of each part of the files that a twin is built from, where it was not simply used."""

from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from enum import StrEnum
from pathlib import PurePath
from typing import Any

from drake_twin.dataclass import dataclass
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


class Cause(StrEnum):
    """What findings that are told in one line share, where it is not the end of their sentences or a repair."""

    UNREAD = "unread"  # elements and attributes that nothing reads
    CONTACT = "contact"  # how surfaces touch
    MESH = "mesh"  # files of meshes
    BRIDGE = "bridge"  # topics between Gazebo and ROS
    PARAMETER = "parameter"  # of controllers, that they do not read
    WINDOW = "window"
    PLUGIN = "plugin"  # what plugins of Gazebo do that the twin does otherwise
    START = "start"  # positions at which joints start


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
_MOST_MODELS = 4  # in a sentence
_MOST_TOLD = 5  # lines of a run that does not ask for all findings
_MOST_THINGS = 6  # of one cause, in such a line
_MOST_SENTENCES = 3  # in such a line


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
        cause: What it shares with others whose sentences differ; empty where ``common`` or ``rule`` is all.
    """

    kind: Kind
    what: str
    robot: str = ""
    file: str = ""
    lines: tuple[int, ...] = ()
    rule: str = ""
    weight: Weight = Weight.MOVES
    common: str = ""
    cause: str = ""

    @classmethod
    def at(
        cls,
        kind: Kind,
        what: str,
        place: Place,
        rule: str = "",
        *,
        weight: Weight = Weight.MOVES,
        common: str = "",
        cause: str = "",
    ) -> "Finding":
        """Return a finding about one place."""
        lines = () if place.line is None else (place.line,)
        return cls(kind, what, file=place.file, lines=lines, rule=rule, weight=weight, common=common, cause=cause)

    def __str__(self) -> str:
        return f"{self.robot}: {self.sentence}" if self.robot else self.sentence

    @property
    def sentence(self) -> str:
        """The finding without the robot's name."""
        placed = _placed(self.kind, self.what, _where(self.file, self.lines))
        return placed + (f" [{self.rule}]" if self.kind is Kind.MENDED else "")

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


def at_places(
    kind: Kind, found: Iterable[tuple[str, Place]], *, weight: Weight = Weight.MOVES, common: str = "", cause: str = ""
) -> Iterator[Finding]:
    """Group what was found at several places into findings: one for each file, with its lines."""
    return merged(Finding.at(kind, what, place, weight=weight, common=common, cause=cause) for what, place in found)


def about_models(found: Mapping[Finding, Mapping[str, Place]]) -> Iterator[Finding]:
    """Yield findings of models of a world, with the models' names and places.

    Args:
        found: Each finding, without a place, with the models that it is about and where these are.
    """
    for finding, models in found.items():
        what = f"{first_of(models, _MOST_MODELS)}: {finding.what}"
        yield from merged(
            Finding.at(finding.kind, what, place, weight=finding.weight, cause=finding.cause)
            for place in models.values()
        )


def first_of(names: Collection[str], most: int, separator: str = ", ") -> str:
    """Return the first names as text, and how many more there are."""
    more = f" and {len(names) - most} more" if len(names) > most else ""
    return separator.join(list(names)[:most]) + more


def merged(findings: Iterable[Finding]) -> Iterator[Finding]:
    """Merge findings that differ only in their lines."""
    lines: dict[Finding, dict[int, None]] = {}  # in place of an ordered set
    for finding in findings:
        lines.setdefault(replace(finding, lines=()), {}).update(dict.fromkeys(finding.lines))
    for finding, numbers in lines.items():
        yield replace(finding, lines=tuple(numbers))


class Findings(tuple[Finding, ...]):
    """Findings in their order."""

    @property
    def warnings(self) -> tuple[str, ...]:
        """What was ignored or changed to make the robots run, and what they stood in when they came."""
        return texts(self, Kind.WARNING, Kind.MENDED)

    @property
    def not_started(self) -> tuple[str, ...]:
        """What the files ask for and the twin does not start, each with the reason."""
        return texts(self, Kind.NOT_STARTED)


def texts(findings: Iterable[Finding], *kinds: Kind) -> tuple[str, ...]:
    """Return the findings of some kinds as sentences."""
    return tuple(str(finding) for finding in findings if finding.kind in kinds)


def grouped(findings: Iterable[Finding]) -> list[tuple[Kind, str]]:
    """Return kind and sentence of each cause: what is lost first, then kind by kind.

    What has one cause is one sentence, with all its things, robots, files and lines.
    """
    kinds = list(Kind)
    ranked = sorted(findings, key=lambda finding: (finding.weight is not Weight.LOST, kinds.index(finding.kind)))
    return _sentences(ranked, everything=True)


def most_telling(findings: Iterable[Finding]) -> list[str]:
    """Return a few lines of the findings, the weightiest first; the last one tells of the rest."""
    weights, kinds = list(Weight), list(Kind)
    ranked = sorted(findings, key=lambda finding: (weights.index(finding.weight), kinds.index(finding.kind)))
    sentences = _sentences(ranked, everything=False)
    told = len(sentences) if len(sentences) <= _MOST_TOLD else _MOST_TOLD - 1
    lines = [f"{kind}: {sentence}" for kind, sentence in sentences[:told]]
    if rest := sentences[told:]:
        numbers = ", ".join(f"{count} {kind}" for kind, count in Counter(kind for kind, _ in rest).items())
        lines.append(f"and {len(rest)} more findings ({numbers}): --findings prints them all")
    return lines


def _sentences(findings: Iterable[Finding], *, everything: bool) -> list[tuple[Kind, str]]:
    """Return kind and sentence of each cause, with the names of all robots that it is about."""
    robots: dict[Finding, dict[str, None]] = {}
    for finding in findings:
        bare = replace(finding, robot="", file=PurePath(finding.file).name)
        robots.setdefault(bare, {}).setdefault(finding.robot)
    groups: dict[tuple[tuple[str, ...], object], list[Finding]] = {}
    for finding, names in robots.items():
        cause = finding.cause or finding.common or finding.rule
        key = (finding.kind, finding.weight is Weight.LOST, cause) if cause else finding.sentence
        groups.setdefault((tuple(filter(None, names)), key), []).append(finding)
    return [
        (group[0].kind, (f"{', '.join(names)}: " if names else "") + _joined(group, everything))
        for (names, _), group in groups.items()
    ]


def _joined(group: Sequence[Finding], everything: bool) -> str:
    """Join findings of one cause: first those that end alike."""
    alike: dict[object, list[Finding]] = {}
    for finding in group:
        alike.setdefault(finding.common or finding.what, []).append(finding)
    sentences = [_joined_alike(findings, everything) for findings in alike.values()]
    told = len(sentences) if everything else _MOST_SENTENCES
    more = [f"and {len(sentences) - told} more"] if len(sentences) > told else []
    return "; ".join((*sentences[:told], *more)) + (f" [{group[0].rule}]" if group[0].rule else "")


def _joined_alike(findings: Sequence[Finding], everything: bool) -> str:
    first, common = findings[0], findings[0].common
    things = list(dict.fromkeys(finding.what.removesuffix(common) for finding in findings))
    told = len(things) if everything else _MOST_THINGS
    lines: dict[str, set[int]] = {}
    for finding in findings:
        lines.setdefault(finding.file, set()).update(finding.lines)
    where = "; ".join(filter(None, (_where(file, sorted(numbers)) for file, numbers in lines.items())))
    return _placed(first.kind, first_of(things, told) + common, where)


def _where(file: str, lines: Sequence[int]) -> str:
    """Return ``FILE:LINE, LINE``; nothing without lines."""
    numbers = first_of([*map(str, lines)], _MOST_LINES)
    return (f"{PurePath(file).name}:{numbers}" if file else f"line {numbers}") if numbers else ""


def _placed(kind: Kind, what: str, where: str) -> str:
    if not where:
        return what
    return f"{where}: {what}" if kind is Kind.MENDED else f"{what} ({where})"


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
