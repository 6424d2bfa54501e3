"""A Python expression."""

import importlib
import math
from collections.abc import Sequence
from typing import Any

from drake_twin.description.xacro_expressions import compile_bounded
from drake_twin.ros2.described_substitutions import described
from drake_twin.ros2.evaluation import current_context
from drake_twin.ros2.launch.frontend.expose import Parsed, expose_substitution
from drake_twin.ros2.launch.launch_context import LaunchContext
from drake_twin.ros2.launch.substitution import MANY, SomeSubstitutionsType, Substitution, check_count
from drake_twin.ros2.launch.substitutions.substitution_failure import SubstitutionFailure
from drake_twin.ros2.launch.substitutions.text_substitution import TextSubstitution, joined_words
from drake_twin.ros2.launch.utilities.normalize_to_list_of_substitutions_impl import normalize_to_list_of_substitutions
from drake_twin.ros2.text_parts import as_texts


@expose_substitution("eval")
class PythonExpression(Substitution):
    """A Python expression; the launch file's code, run as it is, but for numbers and lists without end.

    Args:
        expression: Text and substitutions that make the expression.
        python_modules: Modules that it may name; what ``math`` holds may be named without ``math.``.
    """

    def __init__(self, expression: SomeSubstitutionsType, python_modules: SomeSubstitutionsType | None = None):
        self.expression = normalize_to_list_of_substitutions(as_texts(expression))
        modules = ["math"] if python_modules is None else python_modules
        modules = [modules] if isinstance(modules, str | Substitution) else list(modules)
        self.python_modules = [normalize_to_list_of_substitutions(module) for module in modules]

    def perform(self, context: LaunchContext) -> str:
        """Return the expression's value as text.

        Raises:
            SubstitutionFailure: If the expression raises an exception.
        """
        expression = context.perform_substitution(self.expression)
        names: dict[str, Any] = {}
        for parts in self.python_modules:
            module = importlib.import_module(context.perform_substitution(parts))
            names[module.__name__.partition(".")[0]] = importlib.import_module(module.__name__.partition(".")[0])
            if module is math:
                names.update((name, value) for name, value in vars(math).items() if not name.startswith("_"))
        try:
            code, functions = compile_bounded(expression.strip())
            return str(eval(code, dict(functions), names))
        except Exception as error:  # the file's own code raises whatever it likes
            raise SubstitutionFailure(
                f"the Python expression {expression!r} fails: {type(error).__name__}: {error}"
            ) from None

    def describe(self) -> str:
        """Return ROS's own description."""
        return f"PythonExpr({described(self.expression)})"

    @classmethod
    def parse(cls, data: Sequence[SomeSubstitutionsType]) -> Parsed:
        """Return the class and its arguments for ``$(eval 'expression' modules)``.

        Without quotes, the words are the expression.
        """
        check_count(data, 1, MANY)
        if len(data) == 2 and all(isinstance(part, TextSubstitution) for part in data[1]):
            modules = "".join(part.text for part in data[1])
            if modules.replace(",", "").replace(" ", "").replace(".", "").isidentifier():
                names = [module.strip() for module in modules.split(",")]
                return cls, {"expression": data[0], "python_modules": names}
        if len(data) > 1:
            current_context().refused_by_ros("the expression of $(eval …) has blanks and no quotes around it")
        return cls, {"expression": joined_words(data)}
