"""What a page can draw besides the robots; an overlay exists while it is shown, so that a hidden one costs nothing."""

from collections.abc import Callable
from typing import Protocol, TypeVar

from drake_twin.cockpit.extensions import PageRegistry
from drake_twin.cockpit.scene import Scene
from drake_twin.dataclass import dataclass
from drake_twin.errors import InputError
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
        key: The letter that switches it; empty if none does.
        type: Its class.
    """

    name: str
    label: str
    hint: str
    key: str
    type: type[Overlay]


# The registered ones by name; those of other packages are found when they are asked for.
OVERLAY_KINDS: PageRegistry[OverlayKind] = PageRegistry(
    "overlay",
    ["drake_twin.cockpit.overlays"],
    ["tracks", "ghosts", "contact_forces", "centers_of_mass", "inertia"],
)


def overlay(name: str, label: str, hint: str = "", key: str = "") -> Callable[[_T], _T]:
    """Register an `Overlay` class, so that every page has a switch for it.

    A package of its own does so in a module that its entry point in the group ``drake_twin.page_panels`` names.

    Args:
        name: An identifier, unique among the overlays. Objects belong below ``f"{OVERLAYS}/{name}"`` of the scene.
        label: The text of its switch.
        hint: The tooltip of its switch.
        key: The letter from ``A`` to ``Z`` that switches it, unless the page has another use for that key.

    Raises:
        InputError: If the name is not an identifier, or belongs to another class, or the key is not such a letter.
    """
    if key and not (len(key) == 1 and "A" <= key <= "Z"):
        raise InputError(f"overlay {name!r}: {key!r} is not a letter from A to Z", value=key)

    def register_type(kind: _T) -> _T:
        OVERLAY_KINDS.add(name, OverlayKind(name, label, hint, key, kind), kind)
        return kind

    return register_type
