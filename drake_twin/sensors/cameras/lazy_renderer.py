"""A renderer that is made when it is needed."""

from typing import TYPE_CHECKING

from drake_twin.findings import Finding

if TYPE_CHECKING:
    from drake_twin.sensors.cameras.renderer import Renderer


class LazyRenderer:
    """The renderer of a twin, which outlives its diagrams; nothing of it is imported before the first picture."""

    def __init__(self) -> None:
        self._renderer: Renderer | None = None

    @property
    def asked(self) -> int:
        """The number of pictures asked for."""
        return 0 if self._renderer is None else self._renderer.asked

    @property
    def findings(self) -> tuple[Finding, ...]:
        """Why there are no pictures any more, if so."""
        return () if self._renderer is None else self._renderer.findings

    def get(self) -> "Renderer":
        """Return the renderer."""
        if self._renderer is None:
            from drake_twin.sensors.cameras.renderer import Renderer

            self._renderer = Renderer()
        return self._renderer

    def close(self) -> None:
        """End its process."""
        if self._renderer is not None:
            self._renderer.close()
