"""The folder of the launch file."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

from drake_twin.ros2.launch.frontend.expose import expose_substitution
from drake_twin.ros2.launch.substitutions.this_launch_file import ThisLaunchFile

if TYPE_CHECKING:
    from drake_twin.ros2.launch.launch_context import LaunchContext


@expose_substitution("dirname")
class ThisLaunchFileDir(ThisLaunchFile):
    """The folder of the launch file."""

    def perform(self, context: LaunchContext) -> str:
        """Return the folder.

        Raises:
            InputError: If no launch file is being executed.
        """
        return os.path.dirname(super().perform(context))
