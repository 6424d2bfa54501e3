"""Asks lifecycle nodes for transitions."""

from collections.abc import Iterable
from typing import Any

from drake_twin.ros2.launch.action import Action


class LifecycleTransition(Action):
    """Asks lifecycle nodes for transitions; the twin does not run them."""

    def __init__(self, *, lifecycle_node_names: Iterable[Any], transition_ids: Iterable[Any], **kwargs: Any):
        super().__init__(**kwargs)
