"""The panels of a user's own: what the page draws them from, what it reads while a tab shows them, and what it asks."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

from drake_twin.cockpit.page_controls import Layout, Parts
from drake_twin.cockpit.page_panel import PAGE_PANELS, PagePanel
from drake_twin.cockpit.panel import panel
from drake_twin.cockpit.protocol import read_as
from drake_twin.cockpit.scene import Scene
from drake_twin.dataclass import dataclass
from drake_twin.errors import InputError
from drake_twin.twin.others_code import OthersCode
from drake_twin.twin.twin import Twin

_PATIENCE = 60  # snapshots, about 4 s, that panels are read without a tab asking again
_MOST_LOOKS = 20
_IMAGES_EVERY = 3  # snapshots, of which there are 15 a second


@dataclass(frozen=True)
class Look:
    """A tab shows panels; repeated about once a second.

    Attributes:
        version: The version of the layout that it has; 0 for none.
        images: The number of the newest image that it has; 0 for none.
        shown: The panels that it shows.
    """

    version: int
    images: int
    shown: tuple[int, ...]


@dataclass(frozen=True)
class Set:
    """Set a control to a value."""

    control: int
    value: Any


@dataclass(frozen=True)
class Press:
    """Press a button."""

    control: int


_REQUESTS = {kind.__name__: kind for kind in (Look, Set, Press)}


@panel("own", Path(__file__).with_name("static") / "own_panels.js")
class OwnPanels:
    """The panels of a user's own."""

    def __init__(self, twin: Twin):
        self._twin = twin
        self._parts = Parts()
        self._panels: dict[str, PagePanel] = {}
        self._makers: dict[str, OthersCode] = {}
        self._looks: dict[tuple[int, ...], int] = {}  # shown panels → snapshots for which it holds
        self._needs_layout = self._needs_images = False
        self._images: dict[int, str] = {}
        self._newest_image = 0
        self._snapshots = 0
        self._scene: Scene | None = None
        for title, make in PAGE_PANELS.items():
            code = self._makers[title] = OthersCode.of(twin, f"page panel {title!r}")
            made = self.add(title)
            code.run(lambda make=make, made=made: make(made, twin))

    def add(self, title: str) -> PagePanel:
        """Return a new panel, in place of the one of this title.

        Raises:
            InputError: If the title is not a short text of one line.
        """
        made = PagePanel(self._twin, title, self._parts)
        if title in self._panels:
            self._panels[title].remove()
        self._panels[title] = made
        made._on_removal = lambda: self._forget(made)
        return made

    def _forget(self, removed: PagePanel) -> None:
        self._panels = {title: item for title, item in self._panels.items() if item is not removed}

    def state(self) -> dict[str, Any] | None:
        """Return what tabs show, and the layout for those who do not have it; None if there has never been a panel."""
        self._looks = {look: left - 1 for look, left in self._looks.items() if left > 1}
        if not self._parts.version:
            return None
        if not self._looks:
            return {"version": self._parts.version}
        layout = [self._layout(item) for item in self._panels.values()] if self._needs_layout else None
        self._needs_layout = False
        shown = {number for look in self._looks for number in look}
        parts = [part for item in self._panels.values() if item._number in shown for part in item._parts()]
        known, images = self._parts, self._read_images([part.number for part in parts])
        numeric = [part.number for part in parts if part.layout["kind"] in ("plot", "table")]
        read = {number: known.views[number].read() for number in numeric}
        controls = [known.controls[part.number] for part in parts if part.number in known.controls]
        markers = [known.markers[part.number] for part in parts if part.number in known.markers]
        return {
            "version": known.version,
            "panels": layout,
            "time": round(self._twin.time, 9),
            "values": {item._part.number: item.value for item in controls}
            | {item._part.number: item.visible for item in markers},
            "disabled": [item._part.number for item in controls if not item.enabled or item._part.code.fault],
            "read": {number: content for number, content in read.items() if content is not None},
            "images": images,
            "newest_image": self._newest_image,
            "problems": {part.number: part.problem for part in parts if part.problem},
        }

    def ask(self, data: Any) -> None:
        """Do what a tab asks.

        Raises:
            InputError: If the request is not one, or it is refused.
        """
        request = read_as(_REQUESTS, data)
        match request:
            case Look(version, images, shown):
                self._needs_layout |= version != self._parts.version
                self._needs_images |= images != self._newest_image
                looks = {look: left for look, left in self._looks.items() if look != shown}
                self._looks = dict([*looks.items(), (shown, _PATIENCE)][-_MOST_LOOKS:])
            case Set(number, value) if number in self._parts.controls:
                self._parts.controls[number]._set(value)
            case Set(number, bool(value)) if number in self._parts.markers:
                self._parts.markers[number].visible = value
            case Press(number) if number in self._parts.controls:
                self._parts.controls[number]._set(None)
            case Set() | Press():
                raise InputError("what was set or pressed is not in a panel of the page any more")
            case _:
                raise InputError(f"unknown request {data!r} of a panel")

    def draw(self, scene: Scene, _time: float) -> None:
        """Draw the markers."""
        self._scene = scene
        self._parts.draw(scene)

    def watch(self, is_watched: bool) -> None:
        """Draw no markers when the last browser goes."""
        if not is_watched and self._scene is not None:
            self._parts.erase(self._scene)

    def _layout(self, item: PagePanel) -> Layout:
        code = self._makers.get(item.title)
        fault = "" if code is None or code.fault is None else f"{code.what} has failed: {code.fault}"
        return {**item._layout(), "problem": fault}

    def _read_images(self, numbers: list[int]) -> dict[int, str]:
        """Read the images among parts, less often than the rest; return those that a tab lacks."""
        self._snapshots += 1
        fresh = {}
        if self._snapshots % _IMAGES_EVERY == 0 or self._needs_images:
            for number, view in self._image_views(numbers):
                image = view.read()
                if image is not None and image != self._images.get(number):
                    fresh[number] = self._images[number] = image
                    self._newest_image += 1
        known = {number: self._images[number] for number, _ in self._image_views(numbers) if number in self._images}
        sent = known if self._needs_images else fresh
        self._needs_images = False
        return sent

    def _image_views(self, numbers: list[int]) -> Iterator[tuple[int, Any]]:
        for number in numbers:
            view = self._parts.views.get(number)
            if view is not None and view.part.layout["kind"] == "image":
                yield number, view
