"""The text of substitutions."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from drake_twin.ros2.launch.launch_context import LaunchContext


def perform_substitutions(context: LaunchContext, subs: Sequence[Any]) -> str:
    """Return the joined text of substitutions."""
    return context.perform_substitution(subs)
