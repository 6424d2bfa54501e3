"""Panels of a user's own: sliders, buttons, plots, images, tables and markers from a few lines of Python."""

import logging
from collections.abc import Callable, Iterator, Sequence
from typing import Any, TypeVar
from weakref import ref

from drake_twin.cockpit import page_values as values
from drake_twin.cockpit.page_controls import SHAPES, Control, Layout, Marker, Part, Parts, View
from drake_twin.errors import InputError
from drake_twin.extensions import Registry
from drake_twin.twin.others_code import OthersCode
from drake_twin.twin.owner import Owned
from drake_twin.twin.twin import Twin

_LONGEST_LABEL = 100  # characters
_COLOR = (0.14, 0.42, 0.85)

PanelMaker = Callable[["PagePanel", Twin], object]
_M = TypeVar("_M", bound=PanelMaker)

# The registered ones by title; those of other packages are found when a page is opened.
PAGE_PANELS: Registry[PanelMaker] = Registry(
    "panel of the page",
    "page_panel",
    "drake_twin.page_panels",
    [],
    failed=logging.getLogger(__name__).warning,
)


def page_panel(title: str) -> Callable[[_M], _M]:
    """Register a function that fills a panel, so that every page has the panel.

    A file ``mine.py`` for ``python -m drake_twin.run --robots 1 --panel mine.py``; what else a panel can have are the
    methods of `PagePanel`::

        from drake_twin.cockpit.page_panel import page_panel

        @page_panel("Mine")
        def fill(panel, twin):
            def drive(speed):
                twin.publish("/robot_1/forward_velocity_controller/commands", [speed] * 4)

            panel.slider("speed", -5, 5, unit="rad/s", on_change=drive)

    The function is called with an empty `PagePanel` and the twin when a page shows a twin, and again when the twin is
    built again. A package of its own does so in a module that its entry point in the group ``drake_twin.page_panels``
    names.

    Args:
        title: The panel's heading, unique among the panels.

    Raises:
        InputError: If the title is not a short text of one line, or belongs to another function.
    """
    check_title(title)

    def register(make: _M) -> _M:
        PAGE_PANELS.add(title, make, make)
        return make

    return register


def check_title(title: object) -> None:
    """Raise `InputError` unless it can be a panel's title, or a control's label."""
    if not isinstance(title, str) or not title.strip() or not title.isprintable() or len(title) > _LONGEST_LABEL:
        raise InputError(
            f"{title!r} cannot be a name on the page: a text of 1 to {_LONGEST_LABEL} characters is needed"
        )


class PagePanel(Owned, path="panel"):
    """A panel of a user's own on the page. `TwinPage.panel` makes one, and `page_panel` is given one.

    Each method adds something below what is there. Callbacks and functions are called in the twin's thread, between
    two steps: they may use all of the twin. One that raises an error of `drake_twin` refuses, and the page shows why;
    one that raises another exception has failed: it is named, and not called again, and the rest continues.

    What a callback does to the twin is recorded as if the program did it, so that a recording replays without the
    panel. The values of controls are no part of the twin's state: a reset or a snapshot leaves them as they are.

    Args:
        twin: The twin.
        title: Its heading.
        known: The parts of all panels of the page.
        path: The titles of what it is in, for messages.
    """

    def __init__(self, twin: Twin, title: str, known: Parts, path: str = ""):
        check_title(title)
        self._owner, self._title, self._known = twin.owner, title, known
        self._twin = ref(twin)
        self._path = f"{path}{title}"
        self._items: dict[str, Part | PagePanel] = {}
        self._number = known.number()
        self._is_removed = False
        self._on_removal: Callable[[], object] = lambda: None

    @property
    def title(self) -> str:
        """Its heading."""
        return self._title

    def slider(
        self,
        label: str,
        lower: float,
        upper: float,
        *,
        value: float | None = None,
        step: float | None = None,
        unit: str = "",
        hint: str = "",
        on_change: Callable[[float], object] | None = None,
    ) -> Control[float]:
        """Add a slider, with a number beside it.

        Args:
            label: Its name.
            lower: The lowest value.
            upper: The highest value.
            value: The first value; by default the lowest.
            step: What an arrow key changes it by; by default about a hundredth of the range.
            unit: The unit, for the eye.
            hint: Its tooltip.
            on_change: Called with each value that a person sets.

        Raises:
            InputError: If a name is taken or not a text, or a number does not fit.
        """
        check = self._built(label, lambda: values.number_between(values.finite(lower), values.finite(upper), unit))
        if step is not None:
            check_step = self._built(label, lambda: values.number_between(0.0, upper - lower, unit))
            self._built(label, lambda: check_step(step))
        more = {"lower": lower, "upper": upper, "step": step or None, "unit": unit}
        return self._control("slider", label, lower if value is None else value, check, on_change, hint, **more)

    def number(
        self,
        label: str,
        value: float = 0.0,
        *,
        lower: float | None = None,
        upper: float | None = None,
        unit: str = "",
        hint: str = "",
        on_change: Callable[[float], object] | None = None,
    ) -> Control[float]:
        """Add a field for a number; the arguments are those of `slider`, and bounds are optional."""
        check = self._built(label, lambda: values.number_between(lower, upper, unit))
        more = {"lower": lower, "upper": upper, "unit": unit}
        return self._control("number", label, value, check, on_change, hint, **more)

    def checkbox(
        self,
        label: str,
        value: bool = False,
        *,
        hint: str = "",
        on_change: Callable[[bool], object] | None = None,
    ) -> Control[bool]:
        """Add a switch; `on_change` is called with True or False."""
        return self._control("checkbox", label, value, values.flag, on_change, hint)

    def choice(
        self,
        label: str,
        choices: Sequence[str],
        *,
        value: str | None = None,
        hint: str = "",
        on_change: Callable[[str], object] | None = None,
    ) -> Control[str]:
        """Add a list of texts of which one is chosen; by default the first.

        Raises:
            InputError: If the choices are empty, or one is not a text.
        """
        texts = self._built(label, lambda: tuple(values.short_text(choice) for choice in choices))
        if not texts:
            raise InputError(f"{self._what('choice', label)}: at least one choice is needed")
        value = texts[0] if value is None else value
        return self._control("choice", label, value, values.one_of(texts), on_change, hint, choices=list(texts))

    def text(
        self,
        label: str,
        value: str = "",
        *,
        hint: str = "",
        on_change: Callable[[str], object] | None = None,
    ) -> Control[str]:
        """Add a field for a text of one line."""
        return self._control("text", label, value, values.short_text, on_change, hint)

    def button(self, label: str, *, hint: str = "", on_press: Callable[[], object] | None = None) -> Control[None]:
        """Add a button; its value is None."""
        callback = None if on_press is None else lambda _: on_press()
        return self._control("button", label, None, lambda _: None, callback, hint)

    def plot(self, label: str, get: Callable[[], Any], *, unit: str = "", hint: str = "") -> None:
        """Add a plot over simulation time.

        Args:
            label: Its name.
            get: Returns a number, several of them, or a mapping from names of curves to numbers. It is called about 15
                times a second while a tab shows the panel, and else not.
            unit: The unit of the numbers, for the eye.
            hint: Its tooltip.
        """
        self._view("plot", label, get, lambda value: values.curves(value, label), hint, unit=unit)

    def table(self, label: str, get: Callable[[], Any], *, columns: Sequence[str] = (), hint: str = "") -> None:
        """Add a table.

        Args:
            label: Its name.
            get: Returns a mapping from names to a value or a list of them, or a list of rows; called as for `plot`.
            columns: The headings; by default none.
            hint: Its tooltip.
        """
        heads = self._built(label, lambda: [values.short_text(name) for name in columns])
        self._view("table", label, get, lambda value: values.rows(value, heads), hint, columns=heads)

    def image(self, label: str, get: Callable[[], Any], *, hint: str = "") -> None:
        """Add an image.

        Args:
            label: Its name.
            get: Returns an array of uint8, shape (height, width) or (height, width, 3). It is called about 5 times a
                second while a tab shows the panel, and else not.
            hint: Its tooltip.
        """
        self._view("image", label, get, values.png_of, hint)

    def marker(
        self,
        label: str,
        xyz: Sequence[float] | Callable[[], Sequence[float]],
        *,
        shape: str = "sphere",
        size: float = 0.1,
        color: tuple[float, float, float] = _COLOR,
        hint: str = "",
    ) -> Marker:
        """Add a shape in the scene, and its switch to the panel.

        Args:
            label: Its name.
            xyz: Its position (m, in the world), or a function that returns it, called for each picture that is drawn.
            shape: ``sphere``, ``box`` or ``cylinder``.
            size: Its diameter, the length of its edges, or its diameter and height (m).
            color: Red, green and blue, from 0 to 1.
            hint: The tooltip of its switch.

        Raises:
            InputError: If a value does not fit.
        """

        def built() -> tuple[Any, tuple[float, float, float]]:
            if shape not in SHAPES:
                raise InputError(f"unknown shape {shape!r}", value=shape, valid=SHAPES)
            if values.finite(size) <= 0.0:
                raise InputError(f"the size {size:g} m is not positive")
            red, green, blue = (
                values.number_between(0.0, 1.0, "")(item) for item in values.vector3(color, "the color")
            )
            return SHAPES[shape](float(size)), (red, green, blue)

        drawn, rgb = self._built(label, built)
        if not callable(xyz):
            self._built(label, lambda: values.vector3(xyz, "the position"))
        part = self._part("marker", label, hint, color=[round(255 * item) for item in rgb])
        marker = Marker(self._owner, part, xyz, drawn, rgb)
        self._known.markers[part.number] = marker
        return marker

    def folder(self, label: str) -> "PagePanel":
        """Add a part that can be folded, with the same methods."""
        self._check_free(label)
        folder = self._items[label] = PagePanel(self._here(), label, self._known, f"{self._path} / ")
        folder._on_removal = lambda: self._items.pop(label)
        return folder

    def remove(self) -> None:
        """Take the panel, or the folder, off the page with all that is in it."""
        if self._is_removed:
            return
        self._is_removed = True
        for item in tuple(self._items.values()):
            if isinstance(item, PagePanel):
                item.remove()
            else:
                self._known.remove(item.number)
        self._known.remove(self._number)
        self._on_removal()

    def __repr__(self) -> str:
        return f"PagePanel({self._path!r})"

    def _layout(self) -> Layout:
        """Return what the page draws it from."""
        items = [item._layout() if isinstance(item, PagePanel) else item.layout for item in self._items.values()]
        return {"id": self._number, "kind": "folder", "label": self._title, "items": items}

    def _parts(self) -> Iterator[Part]:
        """Yield all that is in it, and in its folders."""
        for item in self._items.values():
            if isinstance(item, PagePanel):
                yield from item._parts()
            else:
                yield item

    def _here(self) -> Twin:
        twin = self._twin()
        assert twin is not None
        return twin

    def _what(self, kind: str, label: str) -> str:
        return f"{kind} {label!r} of the panel {self._path!r}"

    def _built(self, label: str, build: Callable[[], Any]) -> Any:
        """Return what a function returns; its error names the part that it is for."""
        try:
            return build()
        except InputError as error:
            raise InputError(f"{label!r} of the panel {self._path!r}: {error}") from None

    def _check_free(self, label: str) -> None:
        check_title(label)
        if self._is_removed:
            raise InputError(f"the panel {self._path!r} has been removed: page.panel({self._title!r}) makes a new one")
        if label in self._items:
            raise InputError(f"the panel {self._path!r} already has {label!r}: each name stands for one thing")

    def _part(self, kind: str, label: str, hint: str, **more: Any) -> Part:
        self._check_free(label)
        self._built(label, lambda: [values.short_text(text) for text in (hint, more.get("unit", ""))])
        layout = {"kind": kind, "label": label, "hint": hint, **more}
        part = Part(self._known.number(), layout, OthersCode(self._what(kind, label), self._here()))
        self._items[label] = part
        return part

    def _control(
        self,
        kind: str,
        label: str,
        value: Any,
        check: Callable[[Any], Any],
        callback: Callable[[Any], object] | None,
        hint: str,
        **more: Any,
    ) -> Control[Any]:
        self._built(label, lambda: check(value))
        part = self._part(kind, label, hint, **more)
        control = self._known.controls[part.number] = Control(self._owner, part, value, check, callback)
        return control

    def _view(
        self, kind: str, label: str, get: Callable[[], Any], plain: Callable[[Any], Any], hint: str, **more: Any
    ) -> None:
        if not callable(get):
            raise InputError(f"{self._what(kind, label)}: {get!r} is not a function without arguments")
        part = self._part(kind, label, hint, **more)
        self._known.views[part.number] = View(part, get, plain)
