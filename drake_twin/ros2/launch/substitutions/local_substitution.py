"""A value of the context's locals."""

from drake_twin.ros2.launch.launch_context import LaunchContext
from drake_twin.ros2.launch.substitution import Substitution
from drake_twin.ros2.launch.substitutions.substitution_failure import SubstitutionFailure


class LocalSubstitution(Substitution):
    """A value of the context's locals, by an expression such as ``event.reason``."""

    def __init__(self, expression: str, description: str | None = None):
        self.expression = expression
        self.description = description

    def describe(self) -> str:
        """Return what it stands for, in words."""
        return f"LocalVar('{self.description or self.expression}')"

    def perform(self, context: LaunchContext) -> str:
        """Return the value.

        Raises:
            SubstitutionFailure: If the expression raises an exception.
        """
        try:
            return str(eval(f"context.{self.expression}", {}, {"context": context.locals}))
        except Exception as error:  # the file's own code raises whatever it likes
            raise SubstitutionFailure(f"the local {self.expression!r} is not there ({error})") from None
