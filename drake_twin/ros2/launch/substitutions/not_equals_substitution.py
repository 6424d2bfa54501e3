"""Whether two texts differ."""

from drake_twin.ros2.launch.frontend.expose import expose_substitution
from drake_twin.ros2.launch.launch_context import LaunchContext
from drake_twin.ros2.launch.substitutions.boolean_substitution import text_of
from drake_twin.ros2.launch.substitutions.equals_substitution import EqualsSubstitution


@expose_substitution("not-equals")
class NotEqualsSubstitution(EqualsSubstitution):
    """``true`` if two texts, numbers or truth values differ."""

    def perform(self, context: LaunchContext) -> str:
        """Return ``true`` or ``false``."""
        return text_of(not self.equal(context))
