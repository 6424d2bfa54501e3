"""Calls a function of the launch file."""

from collections.abc import Callable, Iterable, Mapping
from typing import Any

from drake_twin.ros2.launch.action import Action
from drake_twin.ros2.launch.launch_context import LaunchContext


class OpaqueFunction(Action):
    """Calls a function of the launch file with the context; it may return entities to visit."""

    def __init__(
        self,
        *,
        function: Callable[..., Any],
        args: Iterable[Any] | None = None,
        kwargs: Mapping[str, Any] | None = None,
        **left_over_kwargs: Any,
    ):
        super().__init__(**left_over_kwargs)
        if not callable(function):
            raise TypeError(f"OpaqueFunction needs a function, and got {function!r}")
        self.function = function
        self.args = tuple(args or ())
        self.kwargs = dict(kwargs or {})

    def execute(self, context: LaunchContext) -> Any:
        """Call the function."""
        returned = self.function(context, *self.args, **self.kwargs)
        if callable(getattr(returned, "visit", None)):
            context.refused_by_ros("the function returns an entity, and not a list of them")
        return returned
