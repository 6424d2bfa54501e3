"""What a panel of a user's own consists of: controls with a value, views that are read while shown, markers."""

from collections.abc import Callable, Sequence
from itertools import count
from typing import Any, Generic, TypeVar

from pydrake.geometry import Box, Cylinder, Rgba, Shape, Sphere
from pydrake.math import RigidTransform, RollPitchYaw

from drake_twin.cockpit.page_values import vector3
from drake_twin.cockpit.scene import OVERLAYS, Scene
from drake_twin.errors import InputError, RunError, TwinError
from drake_twin.twin.others_code import OthersCode
from drake_twin.twin.owner import Owned, Owner

_V = TypeVar("_V")
_T = TypeVar("_T")

MOST_PARTS = 500  # of all panels of a page together
_FOLDER = f"{OVERLAYS}/own"  # of the scene
SHAPES: dict[str, Callable[[float], Shape]] = {
    "sphere": lambda size: Sphere(size / 2),
    "box": lambda size: Box(size, size, size),
    "cylinder": lambda size: Cylinder(size / 2, size),
}

Layout = dict[str, Any]


class Part:
    """Something in a panel.

    Args:
        number: What the page knows it by.
        layout: What the page draws it from, as plain data: ``kind``, ``label``, ``hint``, and more by its kind.
        code: The user's function that it calls.

    Attributes:
        number: What the page knows it by.
        layout: What the page draws it from.
        code: The user's function that it calls.
        problem: What is wrong with it, for the page; empty if nothing is.
    """

    def __init__(self, number: int, layout: Layout, code: OthersCode):
        self.number, self.layout, self.code = number, {"id": number, **layout}, code
        self.problem = ""

    def read(self, function: Callable[[], _T]) -> _T | None:
        """Return what a function of the user returns; None if it cannot, and the problem is kept."""
        try:
            found = self.code.call(function)
        except TwinError as error:
            self.problem = str(error)
            return None
        self.problem = ""
        return found


class Control(Owned, Generic[_V], path="control"):
    """A control with a value, which is the same in all tabs. The methods of a panel make one.

    Args:
        owner: The thread of the twin.
        part: What the page has of it.
        value: Its value.
        check: Returns a value as it is kept, or raises `InputError`.
        callback: Called with a new value that a person has set, in the twin's thread, between two steps.
    """

    def __init__(
        self,
        owner: Owner,
        part: Part,
        value: _V,
        check: Callable[[Any], _V],
        callback: Callable[[_V], object] | None,
    ):
        self._owner, self._part, self._check, self._callback = owner, part, check, callback
        self._value = self._checked(value)
        self._enabled = True

    @property
    def label(self) -> str:
        """Its name on the page."""
        return str(self._part.layout["label"])

    @property
    def value(self) -> _V:
        """Its value, in its unit. Setting it here shows it on all pages and calls no callback.

        Raises:
            InputError: If the value does not fit the control.
        """
        return self._value

    @value.setter
    def value(self, value: _V) -> None:
        self._value = self._checked(value)

    @property
    def enabled(self) -> bool:
        """Whether a person can set it."""
        return self._enabled

    @enabled.setter
    def enabled(self, enabled: bool) -> None:
        self._enabled = bool(enabled)

    def _checked(self, value: Any) -> _V:
        try:
            return self._check(value)
        except InputError as error:
            raise InputError(f"{self._part.code.what}: {error}") from None

    def _set(self, value: Any) -> None:
        """Do what a person asks: the value is as before if the callback refuses it by an error of the twin.

        Raises:
            InputError: If it is refused, or the callback has failed.
        """
        if not self._enabled:
            raise InputError(f"{self._part.code.what} is disabled")
        before, self._value = self._value, self._checked(value)
        self._part.problem = ""
        if self._callback is None:
            return
        has_failed_before = self._part.code.fault is not None
        try:
            self._part.code.call(self._callback, self._value)
        except RunError as error:  # which the log has already at the first time
            self._part.problem = str(error)
            if has_failed_before:
                raise InputError(str(error)) from error
        except TwinError as error:
            self._value = before
            self._part.problem = f"{self._part.code.what}: {error}"
            raise InputError(self._part.problem) from error

    def __repr__(self) -> str:
        return f"Control({self.label!r}, {self._value!r})"


class View:
    """Something that is read from the user's function while a tab shows its panel: a plot, a table, an image.

    Args:
        part: What the page has of it.
        get: The user's function.
        plain: Turns what it returns into plain data, or raises `InputError`.

    Attributes:
        part: What the page has of it.
    """

    def __init__(self, part: Part, get: Callable[[], Any], plain: Callable[[Any], Any]):
        self.part = part
        self._get, self._plain = get, plain

    def read(self) -> Any:
        """Return its present content as plain data; None if it has none."""
        return self.part.read(lambda: self._plain(self._get()))


class Marker(Owned, path="marker"):
    """A shape in the scene, with a switch in its panel. `PagePanel.marker` makes one.

    Args:
        owner: The thread of the twin.
        part: What the page has of it.
        place: Where it is: its position (m, in the world), or a function that returns it for each picture.
        shape: What is drawn.
        color: Its color: red, green, blue from 0 to 1.
    """

    def __init__(
        self,
        owner: Owner,
        part: Part,
        place: Sequence[float] | Callable[[], Sequence[float]],
        shape: Shape,
        color: tuple[float, float, float],
    ):
        self._owner, self._part, self._shape, self._rgba = owner, part, shape, Rgba(*color)
        self._get: Callable[[], Sequence[float]] | None = place if callable(place) else None
        self._xyz = (0.0, 0.0, 0.0) if callable(place) else vector3(place, "the position")
        self._rpy = (0.0, 0.0, 0.0)
        self._visible = True
        self._drawn: tuple[object, ...] | None = None

    @property
    def xyz(self) -> tuple[float, float, float]:
        """Its position in the world (m). Setting it replaces the function that it had.

        Raises:
            InputError: If it is not three finite numbers.
        """
        return self._xyz

    @xyz.setter
    def xyz(self, xyz: Sequence[float]) -> None:
        self._xyz, self._get = vector3(xyz, "the position"), None

    @property
    def rpy(self) -> tuple[float, float, float]:
        """Its roll, pitch and yaw in the world (rad).

        Raises:
            InputError: If it is not three finite numbers.
        """
        return self._rpy

    @rpy.setter
    def rpy(self, rpy: Sequence[float]) -> None:
        self._rpy = vector3(rpy, "roll, pitch and yaw")

    @property
    def visible(self) -> bool:
        """Whether it is drawn; its switch in the panel sets it, too."""
        return self._visible

    @visible.setter
    def visible(self, visible: bool) -> None:
        self._visible = bool(visible)

    def _draw(self, scene: Scene, folder: str) -> None:
        """Draw it where it is now; it is not drawn while its function cannot tell."""
        path = f"{folder}/{self._part.number}"
        if self._visible and self._get is not None:
            found = self._part.read(lambda get=self._get: vector3(get(), "the position"))  # type: ignore[misc]
            self._xyz = self._xyz if found is None else found
        if not self._visible or self._part.problem:
            self._erase(scene, folder)
            return
        if self._drawn is None:
            scene.set_object(path, self._shape, self._rgba)
        if self._drawn != (self._xyz, self._rpy):
            self._drawn = (self._xyz, self._rpy)
            scene.set_transform(path, RigidTransform(RollPitchYaw(self._rpy), self._xyz))

    def _erase(self, scene: Scene, folder: str) -> None:
        if self._drawn is not None:
            scene.delete(f"{folder}/{self._part.number}")
            self._drawn = None

    def __repr__(self) -> str:
        return f"Marker({self._part.layout['label']!r}, {self._xyz})"


class Parts:
    """The parts of all panels of a page by their numbers.

    Attributes:
        version: Grows whenever a panel or a part comes or goes.
        controls: Number → control.
        views: Number → view.
        markers: Number → marker.
        gone: Markers that are to be erased.
    """

    def __init__(self) -> None:
        self.version = 0
        self.controls: dict[int, Control[Any]] = {}
        self.views: dict[int, View] = {}
        self.markers: dict[int, Marker] = {}
        self.gone: list[Marker] = []
        self._numbers = count(1)
        self._count = 0

    def number(self) -> int:
        """Return the number of a new part.

        Raises:
            InputError: If there are too many.
        """
        if self._count >= MOST_PARTS:
            raise InputError(f"the panels of a page have {MOST_PARTS} controls, plots, … at most: that is the limit")
        self._count += 1
        self.version += 1
        return next(self._numbers)

    def remove(self, number: int) -> None:
        """Remove a part."""
        self._count -= 1
        self.version += 1
        self.controls.pop(number, None)
        self.views.pop(number, None)
        if number in self.markers:
            self.gone.append(self.markers.pop(number))

    def draw(self, scene: Scene) -> None:
        """Draw the markers."""
        for marker in self.gone:
            marker._erase(scene, _FOLDER)
        self.gone = []
        for marker in self.markers.values():
            marker._draw(scene, _FOLDER)

    def erase(self, scene: Scene) -> None:
        """Draw no markers."""
        for marker in (*self.gone, *self.markers.values()):
            marker._erase(scene, _FOLDER)
