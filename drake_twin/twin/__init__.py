"""A running twin: the façade, time, topics, actions, controllers, entities, state and recording."""

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from drake_twin.twin.twin import Twin

__all__ = ["Twin"]

if not TYPE_CHECKING:  # else every name that is not there would have the type Any

    def __getattr__(name: str) -> Any:
        if name != "Twin":
            raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
        from drake_twin.twin.twin import Twin

        return Twin
