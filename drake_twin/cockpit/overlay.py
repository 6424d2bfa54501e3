"""What a page can draw besides the robots; an overlay exists while it is shown, so that a hidden one costs nothing."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol, TypeVar

from drake_twin.cockpit.extensions import PageRegistry
from drake_twin.cockpit.scene import Scene
from drake_twin.twin.twin import Twin


class Overlay(Protocol):
    """Something drawn in the scene.

    It is made with the page's scene and the twin when its switch is turned on, and made again when robots come or go.
    """

    def __init__(self, scene: Scene, twin: Twin): ...

    def draw(self) -> None:
        """Draw the present state."""

    def remove(self) -> None:
        """Remove everything that was drawn."""


_T = TypeVar("_T", bound=type[Overlay])


@dataclass(frozen=True)
class OverlayKind:
    """A registered overlay.

    Attributes:
        name: Its name in requests.
        label: The text of its switch.
        hint: The tooltip of its switch.
        type: Its class.
    """

    name: str
    label: str
    hint: str
    type: type[Overlay]


# The registered ones by name; those of other packages are found when they are asked for.
OVERLAY_KINDS: PageRegistry[OverlayKind] = PageRegistry(
    "overlay", ["drake_twin.cockpit.overlays"], ["frames", "contact_forces", "collision_shapes"]
)


def overlay(name: str, label: str, hint: str = "") -> Callable[[_T], _T]:
    """Register an `Overlay` class, so that every page has a switch for it.

    A package of its own does so in a module that its entry point in the group ``drake_twin.page_panels`` names.

    Args:
        name: An identifier, unique among the overlays. Objects belong below ``f"{OVERLAYS}/{name}"`` of the scene.
        label: The text of its switch.
        hint: The tooltip of its switch.

    Raises:
        InputError: If the name is not an identifier, or belongs to another class.
    """

    def register_type(kind: _T) -> _T:
        OVERLAY_KINDS.add(name, OverlayKind(name, label, hint, kind), kind)
        return kind

    return register_type
