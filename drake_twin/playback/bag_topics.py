"""The panel of topics of a bag: what it holds, the last messages at its moment, curves over all of it, frames."""

import time as wall_clock
from collections.abc import Callable, Iterator, Mapping, Sequence
from hashlib import sha1
from itertools import islice
from typing import Any

from drake_twin.cockpit.message_fields import field_rows
from drake_twin.cockpit.protocol import read_as
from drake_twin.cockpit.topics_panel import Look, Plot
from drake_twin.errors import InputError
from drake_twin.messages import shortened
from drake_twin.playback.bag import Bag
from drake_twin.playback.recorded_frames import RecordedFrames
from drake_twin.playback.series import Series, reading, within

_PATIENCE = 60  # snapshots, about 4 s, that a tab is given data for without asking again
_SENT = 4  # snapshots that a curve is sent with: a slow browser skips some
_BUDGET = 0.015  # s of wall time that each snapshot reads on
_MOST_ROWS = 300
_MOST_CURVES = 100  # that are kept


class BagTopics:
    """What the page's panel of topics shows of a bag; curves are read in parts, between the frames of the page.

    Args:
        bag: The bag.
        slides: Joint → whether it is prismatic.
        now: Returns the bag's moment (s).
        frames: Returns the frames at that moment.
    """

    def __init__(
        self, bag: Bag, slides: Mapping[str, bool], now: Callable[[], float], frames: Callable[[], RecordedFrames]
    ):
        self._bag, self._slides, self._now, self._frames = bag, slides, now, frames
        self._looks: dict[Look, int] = {}
        self._echoes: dict[str, tuple[float, dict[str, Any]]] = {}  # topic → the bag's moment, what is shown
        self._known: dict[Plot, Series] = {}
        self._wanted: dict[Plot, None] = {}
        self._sent: dict[Plot, int] = {}  # → snapshots that it is still sent with
        self._problems: dict[Plot, str] = {}
        self._work: tuple[list[Plot], Series, Iterator[None]] | None = None
        names = repr(sorted((topic, kind) for topic, (kind, _) in bag.topics.items()))
        self._layout = f"bag {sha1(names.encode()).hexdigest()[:12]}"  # what the browser keeps the plots by

    def state(self) -> dict[str, Any] | None:
        """Return what is looked at; None while nobody looks."""
        self._looks = {look: left - 1 for look, left in self._looks.items() if left > 1}
        self._sent = {plot: left - 1 for plot, left in self._sent.items() if left > 0}
        self._read_on()
        if not self._looks and not self._sent and not self._wanted:
            return None
        curves = {_path(plot): self._known[plot].curve(plot.field) for plot in self._sent}
        return {
            "version": 1,
            "layout": self._layout,
            "topics": self._listing() if any(look.version != 1 for look in self._looks) else None,
            "echoes": {topic: self._echo(topic) for topic in {look.echo for look in self._looks if look.echo}},
            "batches": [],
            "curves": curves,
            "units": {path: curve["unit"] for path, curve in curves.items()},
            "problems": {_path(plot): text for plot, text in self._problems.items()},
            "outcome": {"key": "", "problem": "", "text": ""},
            "frames": self._frames().as_plain() if any(look.frames for look in self._looks) else None,
            "diagram": None,
        }

    def ask(self, data: Any) -> None:
        """Do what a tab asks.

        Raises:
            InputError: If the request is not one that a bag can answer.
        """
        match request := read_as({"Look": Look, "Plot": Plot}, data):
            case Look():
                self._looks[request] = _PATIENCE
            case Plot() if request in self._known:
                self._sent[request] = _SENT
            case Plot() if request.topic not in self._bag.topics:
                self._problems[request] = f"Nothing is recorded on {request.topic}."
            case Plot():
                if self._work is None or request not in self._work[0]:
                    self._wanted[request] = None
            case _:
                raise InputError(f"a bag is only shown: {shortened(data)} is refused")

    def _read_on(self) -> None:
        """Read on in the topic of a curve, or begin with the next one."""
        if self._work is None:
            if not self._wanted:
                return
            topic = next(iter(self._wanted)).topic
            plots = [plot for plot in self._wanted if plot.topic == topic]
            series = Series(self._slides, [plot.field for plot in plots])
            self._work = (plots, series, self._reading(topic, plots, series))
        plots, series, work = self._work
        topic = plots[0].topic
        count = self._bag.topics[topic][1]
        is_done = within(_BUDGET, wall_clock.perf_counter, work)
        for plot in plots:
            self._problems.pop(plot, None)
            if not is_done:
                share = len(series.times) * series.every / (count or 1)
                self._problems[plot] = f"Reading {topic}: {100 * share:.0f} %."
            elif plot.field in series.problems:
                self._problems[plot] = f"{topic}: {series.problems[plot.field]}"
            elif series.every > 1:
                self._problems[plot] = f"{topic}: one of {series.every} messages is plotted, of {count}."
        if not is_done:
            return
        self._work = None
        for plot in plots:
            self._wanted.pop(plot, None)
            self._known[plot] = series
            self._sent[plot] = _SENT
        for plot in list(islice(self._known, max(0, len(self._known) - _MOST_CURVES))):
            del self._known[plot]
            self._sent.pop(plot, None)

    def _reading(self, topic: str, plots: Sequence[Plot], series: Series) -> Iterator[None]:
        """Read a topic; if the bag is damaged, what was read until there is kept."""
        try:
            yield from reading(self._bag, topic, series)
        except InputError as error:
            series.problems.update({plot.field: str(error) for plot in plots})

    def _listing(self) -> list[dict[str, Any]]:
        duration = self._bag.duration
        return [
            {
                "kind": "published",
                "name": name,
                "type": kind,
                "rate": None if count < 2 or duration <= 0 else (count - 1) / duration,
                "latched": count == 1,
                "robot": "",
                "controller": "",
            }
            for name, (kind, count) in sorted(self._bag.topics.items())
        ]

    def _echo(self, topic: str) -> dict[str, Any]:
        now = self._now()
        if topic in self._echoes and self._echoes[topic][0] == now:
            return self._echoes[topic][1]
        echo: dict[str, Any] = {"time": None, "rate": None, "rows": [], "form": None}
        try:
            message = self._bag.last(topic, now) if topic in self._bag.topics else None
            if message is not None:
                echo |= {"time": message.time, "rows": list(islice(field_rows(message.read()), _MOST_ROWS))}
        except InputError as error:
            echo["rows"] = [("cannot be read", str(error), False)]
        self._echoes = {topic: (now, echo)}
        return echo


def _path(plot: Plot) -> str:
    return f"{plot.topic}.{plot.field}"
