"""A file with texts replaced."""

from collections.abc import Mapping
from typing import Any

from drake_twin.ros2.launch.launch_context import LaunchContext
from drake_twin.ros2.launch.substitution import SomeSubstitutionsType
from drake_twin.ros2.launched import ParameterText
from drake_twin.ros2.rewritten_files import RewrittenFile


class ReplaceString(RewrittenFile):
    """A file with texts replaced.

    Args:
        source_file: The file.
        replacements: Text to new text.
        condition: Where it does not hold, the file stays as it is.
    """

    def __init__(self, source_file: SomeSubstitutionsType, replacements: Mapping[str, Any], condition: Any = None):
        super().__init__(source_file)
        self.replacements = dict(replacements)
        self._condition = condition

    @property
    def condition(self) -> Any:
        """The condition, or None."""
        return self._condition

    def perform(self, context: LaunchContext) -> str:
        """Return the path of the rewritten file, or of the source."""
        if self._condition is not None and not self._condition.evaluate(context):
            return context.perform_substitution(self.source_file)
        return super().perform(context)

    def rewrite(self, source: ParameterText, context: LaunchContext) -> str:
        """Return the text with the replacements."""
        text = source.text
        for old, new in self.replacements.items():
            text = text.replace(old, context.perform_substitution(new))
        return text
