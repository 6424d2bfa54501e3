"""Sections that other packages add to the page: a Python class beside the twin, and a script in the browser."""

from collections.abc import Callable
from pathlib import Path
from typing import Any, Protocol, TypeVar

from drake_twin.cockpit.extensions import PageRegistry
from drake_twin.dataclass import dataclass
from drake_twin.twin.twin import Twin


class Panel(Protocol):
    """The Python half of a panel, made with the twin that the page shows. Data are plain: what JSON can hold.

    If it has a method ``watch(is_watched)``, that is called when the first browser connects and when the last one goes;
    ``draw(scene, time)``, with each picture that a browser is shown, and the time (s) that it shows; ``close()``, when
    the page shows another twin or ends.
    """

    def __init__(self, twin: Twin): ...

    def state(self) -> Any:
        """Return the data that the script is given with each snapshot, about 15 times a second."""

    def ask(self, data: Any) -> None:
        """Do what the script asks, between two steps.

        Raises:
            InputError: If it is refused; the page shows the reason.
        """


_T = TypeVar("_T", bound=type[Panel])


@dataclass(frozen=True)
class PanelKind:
    """A registered panel.

    Attributes:
        name: Its name in requests.
        script: Its JavaScript.
        type: The class of its Python half.
    """

    name: str
    script: bytes
    type: type[Panel]


# The registered ones by name; those of other packages are found when they are asked for.
PANEL_KINDS: PageRegistry[PanelKind] = PageRegistry(
    "panel", ["drake_twin.cockpit", "drake_twin.playback"], ["world_panel"]
)


def panel(name: str, script: str | Path) -> Callable[[_T], _T]:
    """Register a `Panel` class, so that every page has the panel.

    A package of its own does so in a module that its entry point in the group ``drake_twin.page_panels`` names.

    Args:
        name: An identifier, unique among the panels.
        script: A JavaScript module, as a file or as text of several lines. Its default export is a class that is made
            with a function ``ask(data)``, has the panel's element as ``node``, and a method ``state(data)``.

    Raises:
        InputError: If the name is not an identifier, or belongs to another class.
        OSError: If the script cannot be read.
    """

    def register_type(kind: _T) -> _T:
        is_text = isinstance(script, str) and "\n" in script
        text = str(script).encode() if is_text else Path(script).read_bytes()
        PANEL_KINDS.add(name, PanelKind(name, text, kind), kind)
        return kind

    return register_type
