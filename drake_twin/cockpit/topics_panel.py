"""The panel of topics: their list, one of them echoed and published, numbers for plots, frames, the diagram.

Only what a tab shows is subscribed to: the topic whose messages it shows, and those of its curves.
"""

import contextlib
import json
import threading
from collections import deque
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import yaml

from drake_twin import messages
from drake_twin.cockpit.heard_topic import HeardTopic, TopicRate, all_endpoints, is_of_twin, tap_transforms
from drake_twin.cockpit.message_fields import field_rows
from drake_twin.cockpit.panel import panel
from drake_twin.cockpit.protocol import Lines, read_as
from drake_twin.cockpit.snapshot import layout_key
from drake_twin.cockpit.topic_form import empty_form, form_of
from drake_twin.dataclass import dataclass
from drake_twin.diagram.picture import dot_text, svg_of
from drake_twin.errors import InputError, RunError
from drake_twin.messages.interface_types import make
from drake_twin.messages.transform_tree import TransformTree
from drake_twin.twin.endpoints import ACTION, COMMANDED, PUBLISHED, Endpoint
from drake_twin.twin.twin import Twin

_PATIENCE = 60  # snapshots, about 4 s, that a tab is given data for without asking again
_MOST_LOOKS = 20  # of all tabs together
_MOST_CURVES = 100  # of all tabs together
_MOST_ROWS = 300
_BATCHES = 4  # snapshots that samples are sent with: a slow browser skips some
_FRAMES_EVERY = 4  # snapshots
_TRANSFORMS = "tf2_msgs/msg/TFMessage"
_LISTED = ("kind", "name", "type", "rate", "latched", "robot", "controller")  # of an endpoint


@dataclass(frozen=True)
class Look:
    """A tab shows the panel; repeated about once a second.

    Attributes:
        version: The version of the list that it has; 0 for none.
        echo: The topic whose messages it shows; empty for none.
        frames: Whether it shows the tree of frames.
    """

    version: int
    echo: str
    frames: bool


@dataclass(frozen=True)
class Plot:
    """A tab plots a number of a topic's messages; repeated about once a second."""

    topic: str
    field: str


@dataclass(frozen=True)
class Publish:
    """Publish a message on a topic that a controller listens to.

    Attributes:
        topic: The topic.
        text: The message as YAML, of which JSON is a part; fields that it leaves out have ROS's default values.
        key: What the tab knows the outcome by; if it is empty, what is refused is one of the page's messages.
    """

    topic: str
    text: Lines
    key: str


@dataclass(frozen=True)
class Draw:
    """Draw the diagram."""


_REQUESTS = {kind.__name__: kind for kind in (Look, Plot, Publish, Draw)}


@panel("topics", Path(__file__).with_name("static") / "topics_panel.js")
class TopicsPanel:
    """The topics and actions of a twin."""

    def __init__(self, twin: Twin):
        self._twin = twin
        self._endpoints: tuple[Endpoint, ...] = ()
        self._version = 0
        self._looks: dict[Look | Plot, int] = {}  # → snapshots for which it holds
        self._heard: dict[str, HeardTopic] = {}
        self._rates: dict[str, TopicRate] = {}
        self._forms: dict[str, dict[str, Any]] = {}
        self._outcome = {"key": "", "problem": "", "text": ""}
        self._tree = TransformTree()
        self._untap: Callable[[], None] | None = None  # ends listening to the frames of node programs
        self._snapshots = -1  # since the frames were first shown
        self._batches: deque[dict[str, Any]] = deque(maxlen=_BATCHES)
        self._batch = 0
        self._layout = layout_key(twin)  # what the browser keeps the plots by
        self._drawing: threading.Thread | None = None
        self._drawn: deque[dict[str, Any]] = deque()  # the diagram, once for each snapshot that it is still sent with

    def state(self) -> dict[str, Any] | None:
        """Return the list for those who do not have it, and what is looked at; None while nobody looks."""
        if not self._looks:
            return None
        self._looks = {look: left - 1 for look, left in self._looks.items() if left > 1}
        self._listen()
        if not self._looks:
            return None
        looks = [look for look in self._looks if isinstance(look, Look)]
        return {
            "version": self._version,
            "layout": self._layout,
            "topics": self._listing_once(looks),
            "echoes": {topic: self._echo(topic) for topic in {look.echo for look in looks if look.echo}},
            "batches": self._next_batches(),
            "problems": self._problems(),
            "units": self._units(),
            "outcome": self._outcome,
            "frames": self._frames() if self._need_frames(looks) else None,
            "diagram": self._drawn.popleft() if self._drawn else None,
        }

    def ask(self, data: Any) -> None:
        """Do what a tab asks; why a form's message is not published is part of the state.

        Raises:
            InputError: If the request is not one, or the twin refuses a message without a key.
        """
        request = read_as(_REQUESTS, data)
        match request:
            case Look():
                self._keep(request, _MOST_LOOKS)
            case Plot():
                self._keep(request, _MOST_CURVES)
            case Publish():
                self._publish(request)
            case Draw():
                self._draw()
            case _:
                raise InputError(f"unknown request {messages.shortened(data)} of the panel of topics")

    def watch(self, is_watched: bool) -> None:
        """Listen to nothing while no browser is connected."""
        if not is_watched:
            self._looks.clear()
            self._listen()

    def _keep(self, request: Look | Plot, most: int) -> None:
        """Hold a request for a while, in place of the oldest of its kind if there are too many."""
        self._looks.pop(request, None)
        same = [look for look in self._looks if type(look) is type(request)]
        for look in same[: max(0, len(same) - most + 1)]:
            del self._looks[look]
        self._looks[request] = _PATIENCE

    def _listen(self) -> None:
        """Listen to what is looked at, and to nothing else."""
        endpoints = all_endpoints(self._twin, self._endpoints)
        if self._endpoints is not endpoints:
            self._endpoints = endpoints
            self._version += 1
            self._forget_frames()
            self._forms.clear()
            self._end({*self._heard})
            self._end_rates({*self._rates})
        published = {item.name: item for item in self._endpoints if item.kind == PUBLISHED}
        curves = [look for look in self._looks if isinstance(look, Plot)]
        echoed = {look.echo for look in self._looks if isinstance(look, Look)}
        wanted = {name: published[name] for name in (*echoed, *(item.topic for item in curves)) if name in published}
        self._end({name for name in self._heard if name not in wanted})
        for name, endpoint in wanted.items():
            if name not in self._heard:
                self._heard[name] = HeardTopic(self._twin, endpoint)
            self._heard[name].plot({item.field for item in curves if item.topic == name})
        self._end_rates(self._rates.keys() - echoed)
        for name in sorted((echoed & published.keys()) - self._rates.keys()):
            self._rates[name] = TopicRate(self._twin, published[name])
        self._forms = {topic: form for topic, form in self._forms.items() if topic in echoed}

        needs_frames = any(look.frames for look in self._looks if isinstance(look, Look))
        if needs_frames and self._untap is None:
            self._untap = tap_transforms(self._twin, self._tree.add)
        elif not needs_frames:
            self._forget_frames()

    def _forget_frames(self) -> None:
        self._tree = TransformTree()
        if self._untap is not None:
            self._untap()
            self._untap = None

    def _end(self, names: set[str]) -> None:
        for name in names:
            self._heard.pop(name).end()

    def _end_rates(self, names: set[str]) -> None:
        for name in names:
            self._rates.pop(name).end()

    def _listing_once(self, looks: list[Look]) -> list[dict[str, Any]] | None:
        """Return the list if a tab does not have it; one that misses it asks again."""
        if all(look.version == self._version for look in looks):
            return None
        self._looks = {
            replace(look, version=self._version) if isinstance(look, Look) else look: left
            for look, left in self._looks.items()
        }
        return self._listing()

    def _listing(self) -> list[dict[str, Any]]:
        kinds = (PUBLISHED, COMMANDED, ACTION)
        ordered = sorted(self._endpoints, key=lambda item: (item.name, kinds.index(item.kind)))
        return [{field: getattr(item, field) for field in _LISTED} for item in ordered]

    def _next_batches(self) -> list[dict[str, Any]]:
        """Return the samples of the last snapshots, newest last, each with a number that counts them."""
        samples = {
            f"{topic}.{field}": list(items)
            for topic, heard in self._heard.items()
            for field, items in heard.pending.items()
            if items
        }
        if samples:
            self._batch += 1
            self._batches.append({"number": self._batch, "samples": samples})
            for heard in self._heard.values():
                for items in heard.pending.values():
                    items.clear()
        return list(self._batches)

    def _units(self) -> dict[str, str]:
        """Return the units of the curves that have one, by their paths."""
        return {
            f"{topic}.{name}": unit
            for topic, heard in self._heard.items()
            for name, unit in heard.units.items()
            if unit
        }

    def _problems(self) -> dict[str, str]:
        """Return why curves have no samples, by their paths."""
        unknown = {
            f"{look.topic}.{look.field}": f"Nothing is published on {look.topic}."
            for look in self._looks
            if isinstance(look, Plot) and look.topic not in self._heard
        }
        found = {
            f"{topic}.{field}": f"{topic}: {text}"
            for topic, heard in self._heard.items()
            for field, text in heard.problems.items()
        }
        return unknown | found

    def _echo(self, topic: str) -> dict[str, Any]:
        """Return a topic's last message, its time (s), the measured rate (Hz), and a form if it is a command topic."""
        echo: dict[str, Any] = {"time": None, "rate": None, "rows": [], "form": None}
        if topic in self._heard:
            heard = self._heard[topic]
            is_known = heard.message is not None
            message = heard.message if is_known else self._present(topic)
            echo |= {"time": heard.time if is_known else None, "rate": self._rates[topic].rate, "rows": _rows(message)}
        elif topic in self._twin.built.commanded:
            echo["rows"] = _rows(self._twin.graph.command(topic))
        if topic not in self._forms and (type_ := self._listeners_type(topic)) is not None:
            is_twins = topic in self._twin.built.commanded
            with contextlib.suppress(ValueError):  # of a type that nobody knows here
                self._forms[topic] = form_of(self._twin, topic) if is_twins else empty_form(type_)
        echo["form"] = self._forms.get(topic)
        return echo

    def _listeners_type(self, topic: str) -> str | None:
        """Return the type of what controllers or node programs listen to on a topic; None if they do not."""
        return next((item.type for item in self._endpoints if (item.kind, item.name) == (COMMANDED, topic)), None)

    def _present(self, topic: str) -> Any:
        """Return a topic's message while time stands still; none of a sensor, which would measure for it."""
        of_sensors = {item.topic for _, plan in self._twin.entities.sensors for item in plan.topics}
        is_there = self._twin.clock.paused and topic not in of_sensors and is_of_twin(self._twin, topic)
        return self._twin.latest(topic) if is_there else None

    def _publish(self, request: Publish) -> None:
        """Publish a message; the outcome for a form is part of the state."""
        twin = self._twin
        if not request.key:
            self._send(request)
            return
        self._outcome = {"key": request.key, "problem": "", "text": f"Published at {twin.time:.3f} s."}
        try:
            self._send(request)
        except InputError as error:
            self._outcome |= {"problem": str(error), "text": ""}
            return
        item = twin.built.commanded.get(request.topic)
        if item is not None and not twin.control.manager(item.robot).is_active(item.controller):
            self._outcome["text"] += f" {item.controller} is not active and does not hear it."

    def _send(self, request: Publish) -> None:
        """Publish a message to a controller, or to the node programs that listen."""
        twin, topic, data = self._twin, request.topic, _message(request)
        type_ = self._listeners_type(topic)
        if twin.graph.hears(topic) or type_ is None or twin.more_topics is None:
            twin.publish(topic, data)
            return
        try:
            twin.more_topics.hear(topic, make(type_, data))
        except ValueError as error:
            raise InputError(f"{topic}: {error}") from None

    def _need_frames(self, looks: list[Look]) -> bool:
        self._snapshots = self._snapshots + 1 if any(look.frames for look in looks) else -1
        return self._snapshots >= 0 and self._snapshots % _FRAMES_EVERY == 0

    def _frames(self) -> list[dict[str, Any]]:
        """Return each frame with the one above it, its translation (m) and roll, pitch, yaw (rad) in that."""
        tree = self._tree
        for item in self._twin.graph.endpoints:
            if item.kind == PUBLISHED and item.type == _TRANSFORMS and (message := self._twin.latest(item.name)):
                tree.add(message, is_static=item.latched)
        return tree.as_plain()

    def _draw(self) -> None:
        """Let Graphviz draw the diagram beside the simulation, one at a time."""
        if self._drawing is not None and self._drawing.is_alive():
            return
        text = dot_text(self._twin.diagram)

        def draw() -> None:
            try:
                drawn = {"svg": svg_of(text), "problem": ""}
            except (InputError, RunError) as error:
                drawn = {"svg": "", "problem": str(error)}
            self._drawn.extend([drawn] * _BATCHES)

        self._drawing = threading.Thread(target=draw, name="dot", daemon=True)
        self._drawing.start()


def _message(request: Publish) -> Any:
    with contextlib.suppress(ValueError, RecursionError):
        return json.loads(request.text)  # whose 8e-06 is a number, unlike YAML's
    try:
        return yaml.safe_load(request.text)
    except (yaml.YAMLError, ValueError, RecursionError) as error:
        text = messages.shortened(" ".join(str(error).split()))
        raise InputError(f"{request.topic}: this is not YAML: {text}") from None


def _rows(message: Any) -> list[tuple[str, str, bool]]:
    if message is None:
        return []
    found = []
    for row in field_rows(message):
        found.append(row)
        if len(found) == _MOST_ROWS:
            found.append(("…", "more fields", False))
            break
    return found
