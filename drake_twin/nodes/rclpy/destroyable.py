"""Stand-in for ``rclpy.destroyable``."""

from typing import Any, Protocol


class DestroyableType(Protocol):
    """Something that can be destroyed."""

    def __enter__(self) -> None:
        """Begin to use it."""

    def __exit__(self, exc_type: Any, exc_val: Any, exctb: Any) -> None:
        """End its use."""

    def destroy_when_not_in_use(self) -> None:
        """Destroy it once nothing uses it."""
