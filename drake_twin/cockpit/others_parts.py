"""Parts of the page that other packages have added: one that fails is empty from then on, and the page continues."""

import json
from collections.abc import Callable, Mapping
from typing import Any

from drake_twin.cockpit.overlay import OVERLAY_KINDS, Overlay, OverlayKind
from drake_twin.cockpit.panel import PANEL_KINDS, Panel, PanelKind
from drake_twin.cockpit.scene import Scene
from drake_twin.errors import InputError, RunError
from drake_twin.twin.others_code import OthersCode
from drake_twin.twin.twin import Twin

NO_STATE = object()  # of a panel that has failed before it had one


def make_panel(kind: PanelKind, twin: Twin) -> Panel:
    """Return a panel for a twin; one of another package is guarded."""
    return _OthersPanel(kind, twin) if PANEL_KINDS.is_of_others(kind.name) else kind.type(twin)


def make_overlay(kind: OverlayKind, scene: Scene, twin: Twin) -> Overlay:
    """Return an overlay for a twin; one of another package is guarded."""
    return _OthersOverlay(kind, scene, twin) if OVERLAY_KINDS.is_of_others(kind.name) else kind.type(scene, twin)


def watch_panels(panels: Mapping[str, Panel], is_watched: bool) -> None:
    """Tell the panels that want to know whether a browser is connected."""
    for panel in panels.values():
        getattr(panel, "watch", lambda _: None)(is_watched)


def drawing(panels: Mapping[str, Panel]) -> list[Callable[[Scene, float], None]]:
    """Return the methods of the panels that draw something in the scene, which shows a time (s)."""
    return [draw for panel in panels.values() if (draw := getattr(panel, "draw", None)) is not None]


def close_panels(panels: Mapping[str, Panel]) -> None:
    """Tell the panels that want to know it that the page ends."""
    for panel in panels.values():
        getattr(panel, "close", lambda: None)()


class _OthersPanel:
    """The state of a panel that has failed is the last good one."""

    def __init__(self, kind: PanelKind, twin: Twin):
        self._code = OthersCode.of(twin, f"panel {kind.name!r}")
        self._panel: Any = self._code.run(kind.type, twin)
        self._last: Any = NO_STATE

    def state(self) -> Any:
        state = self._code.run(lambda: json.loads(json.dumps(self._panel.state(), allow_nan=False)))
        self._last = self._last if self._code.fault else state
        return self._last

    def ask(self, data: Any) -> None:
        try:
            self._code.call(lambda: self._panel.ask(data))
        except RunError as error:
            raise InputError(str(error)) from error

    def watch(self, is_watched: bool) -> None:
        self._code.run(getattr(self._panel, "watch", lambda _: None), is_watched)

    def draw(self, scene: Scene, time: float) -> None:
        draw = getattr(self._panel, "draw", None)
        if draw is not None:
            self._code.run(draw, scene, time)

    def close(self) -> None:
        self._code.run(getattr(self._panel, "close", lambda: None))


class _OthersOverlay:
    def __init__(self, kind: OverlayKind, scene: Scene, twin: Twin):
        self._code = OthersCode.of(twin, f"overlay {kind.name!r}")
        self._overlay: Any = self._code.run(kind.type, scene, twin)

    def draw(self) -> None:
        self._code.run(lambda: self._overlay.draw())

    def remove(self) -> None:
        self._code.run(lambda: self._overlay.remove())
