"""Parts of a path, joined."""

import os
from collections.abc import Iterable, Sequence
from pathlib import PurePath
from typing import Any

from drake_twin.ros2.described_substitutions import described
from drake_twin.ros2.launch.frontend.expose import Parsed, expose_substitution
from drake_twin.ros2.launch.launch_context import LaunchContext
from drake_twin.ros2.launch.substitution import MANY, SomeSubstitutionsType, Substitution, check_count
from drake_twin.ros2.launch.utilities.normalize_to_list_of_substitutions_impl import normalize_to_list_of_substitutions


@expose_substitution("path-join", jazzy=False)
class PathJoinSubstitution(Substitution):
    """Parts of a path, joined; each is text, a substitution or a list of them."""

    def __init__(self, substitutions: Iterable[Any]):
        parts = list(substitutions)
        self._has_lists = any(not isinstance(part, str | PurePath | Substitution) for part in parts)
        self.substitutions = [normalize_to_list_of_substitutions(part) for part in parts]

    def perform(self, context: LaunchContext) -> str:
        """Return the path."""
        if self._has_lists:
            context.refused_by_ros("ROS 2 Jazzy refuses a list in a PathJoinSubstitution")
        return os.path.join(*(context.perform_substitution(part) for part in self.substitutions))

    def describe(self) -> str:
        """Return the parts between slashes."""
        return "/".join(described(part).strip("'") for part in self.substitutions)

    @classmethod
    def parse(cls, data: Sequence[SomeSubstitutionsType]) -> Parsed:
        """Return the class and its arguments for ``$(path-join part part …)``."""
        check_count(data, 1, MANY)
        return PathJoinSubstitution, {"substitutions": data}


class PathSubstitution(PathJoinSubstitution):
    """A path to which parts are added with ``/``."""

    def __init__(self, path: SomeSubstitutionsType):
        super().__init__([path])
