"""The panel of parameters: those of each robot's nodes as ``ros2 param`` lists them, and each can be set."""

from collections import deque
from collections.abc import Callable
from pathlib import Path
from typing import Any

import yaml

from drake_twin import messages
from drake_twin.cockpit.panel import panel
from drake_twin.cockpit.protocol import Lines, read_as
from drake_twin.dataclass import dataclass
from drake_twin.description.bounded_yaml import load_yaml
from drake_twin.description.declared_parameters import DeclaredParameter
from drake_twin.errors import InputError
from drake_twin.services.parameters import ParameterNode, parameter_nodes
from drake_twin.twin.event_topics import PARAMETER_EVENTS
from drake_twin.twin.twin import Twin

_PATIENCE = 60  # snapshots, about 4 s, that a tab is given data for without asking again
_LONGEST = 200  # letters of a value; a robot's description has thousands


@dataclass(frozen=True)
class Look:
    """A tab shows the panel; repeated about once a second.

    Attributes:
        version: The version of the list that it has; 0 for none.
    """

    version: int


@dataclass(frozen=True)
class SetParameter:
    """Set a parameter.

    Attributes:
        node: The full name of its node.
        name: Its name.
        text: The value as YAML.
        key: What the tab knows the outcome by.
    """

    node: str
    name: str
    text: Lines
    key: str


_REQUESTS = {kind.__name__: kind for kind in (Look, SetParameter)}


@panel("parameters", Path(__file__).with_name("static") / "parameters_panel.js")
class ParametersPanel:
    """The parameters of a twin's nodes."""

    def __init__(self, twin: Twin):
        self._twin = twin
        self._asked: deque[SetParameter] = deque()
        self._outcome = {"key": "", "problem": ""}
        self._left = 0  # snapshots for which a tab is shown
        self._known = 0  # the oldest version that a tab has
        self._version = 0
        self._rows: list[dict[str, Any]] = []
        self._plans: object = None
        self._is_changed = False  # since they were read
        self._end: Callable[[], None] | None = None  # ends listening to what others set

    def state(self) -> dict[str, Any] | None:
        """Set what was asked; return the parameters for those who do not have them, None while nobody looks."""
        while self._asked:
            self._set(self._asked.popleft())
        self._left -= 1
        if self._left <= 0:
            self.watch(False)
            return None
        if self._end is None:
            self._end = self._twin.subscribe(PARAMETER_EVENTS, self._note)
            self._is_changed = True  # who knows what was set before
        if self._is_changed or self._plans is not self._twin.built.plans:
            self._read()
        rows = self._rows if self._known < self._version else None
        self._known = self._version
        return {"version": self._version, "rows": rows, "outcome": self._outcome}

    def ask(self, data: Any) -> None:
        """Do what a tab asks; why a value is refused is part of the state.

        Raises:
            InputError: If the request is not one.
        """
        match request := read_as(_REQUESTS, data):
            case Look(version):
                self._left, self._known = _PATIENCE, min(self._known, version)
            case SetParameter():
                self._asked.append(request)  # between two steps: the diagram is built again
            case _:
                raise InputError(f"unknown request {messages.shortened(data)} of the panel of parameters")

    def watch(self, is_watched: bool) -> None:
        """Listen to nothing while no browser is connected."""
        if not is_watched and self._end is not None:
            self._end()
            self._end = None

    def _note(self, _event: Any) -> None:
        self._is_changed = True

    def _set(self, request: SetParameter) -> None:
        node = next((each for each in parameter_nodes(self._twin) if each.name == request.node), None)
        try:
            value = load_yaml(request.text)
        except yaml.YAMLError:
            problem = f"{request.text!r} is not a value"
        else:
            problem = (
                f"unknown node {request.node}"
                if node is None
                else node.put({request.name: _typed(node, request.name, value)})
            )
        self._outcome = {"key": request.key, "problem": problem}
        self._read()

    def _read(self) -> None:
        rows = [_row(node, item) for node in parameter_nodes(self._twin) for item in node.declared().values()]
        self._plans, self._is_changed = self._twin.built.plans, False
        if rows != self._rows:
            self._rows, self._version = rows, self._version + 1


def _typed(node: ParameterNode, name: str, value: Any) -> Any:
    """Return a number as the type of its parameter: ``1`` is what people write for 1.0."""
    is_double = isinstance(getattr(node.declared().get(name), "value", None), float)
    return float(value) if is_double and isinstance(value, int) and not isinstance(value, bool) else value


def _row(node: ParameterNode, item: DeclaredParameter) -> dict[str, Any]:
    value = _text(item.value)
    about = " ".join(part for part in (item.description, item.constraints) if part)
    return {
        "node": node.name,
        "name": item.name,
        "value": value,
        "about": about,
        "read_only": item.is_read_only or value.endswith("…"),
    }


def _text(value: Any) -> str:
    plain = list(value) if isinstance(value, tuple) else value
    text = (
        yaml.safe_dump(plain, default_flow_style=True, width=10_000, allow_unicode=True).removesuffix("\n...\n").strip()
    )
    return text if len(text) <= _LONGEST else f"{text[:_LONGEST]}…"
