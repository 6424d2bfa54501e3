"""Ends the launch."""

from typing import Any

from drake_twin.ros2.launch.actions.emit_event import EmitEvent
from drake_twin.ros2.launch.events.shutdown import Shutdown as ShutdownEvent
from drake_twin.ros2.launch.frontend.expose import expose_action
from drake_twin.ros2.launch.launch_context import LaunchContext
from drake_twin.ros2.launch.substitution import SomeSubstitutionsType
from drake_twin.ros2.launch.utilities.normalize_to_list_of_substitutions_impl import normalize_to_list_of_substitutions


@expose_action("shutdown")
class Shutdown(EmitEvent):
    """Ends the launch."""

    _optional = ("reason",)

    def __init__(self, *, reason: SomeSubstitutionsType = "reason not given", **kwargs: Any):
        super().__init__(event=ShutdownEvent(), **kwargs)
        self.reason = normalize_to_list_of_substitutions(reason)

    def execute(self, context: LaunchContext) -> None:
        """End the launch after what is due before."""
        self.event = ShutdownEvent(reason=context.perform_substitution(self.reason))
        super().execute(context)
