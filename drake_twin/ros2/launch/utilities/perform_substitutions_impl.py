"""The text of substitutions."""

from collections.abc import Sequence
from typing import Any

from drake_twin.ros2.launch.launch_context import LaunchContext


def perform_substitutions(context: LaunchContext, subs: Sequence[Any]) -> str:
    """Return the joined text of substitutions."""
    return context.perform_substitution(subs)
