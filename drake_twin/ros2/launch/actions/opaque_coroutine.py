"""Runs a coroutine of the launch file."""

import asyncio
from collections.abc import Callable, Iterable, Mapping
from typing import Any

from drake_twin.ros2.launch.action import Action
from drake_twin.ros2.launch.launch_context import LaunchContext


class OpaqueCoroutine(Action):
    """Runs a coroutine of the launch file to its end."""

    def __init__(
        self,
        *,
        coroutine: Callable[..., Any],
        args: Iterable[Any] | None = None,
        kwargs: Mapping[str, Any] | None = None,
        ignore_context: bool = False,
        **left_over_kwargs: Any,
    ):
        super().__init__(**left_over_kwargs)
        self.coroutine = coroutine
        self.args = tuple(args or ())
        self.kwargs = dict(kwargs or {})
        self.ignore_context = ignore_context

    def execute(self, context: LaunchContext) -> None:
        """Run the coroutine."""
        first = () if self.ignore_context else (context,)
        asyncio.run(self.coroutine(*first, *self.args, **self.kwargs))
