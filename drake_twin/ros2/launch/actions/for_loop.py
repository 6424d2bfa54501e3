"""Loops over numbers and over sets of values."""

from collections.abc import Callable, Mapping
from typing import Any

from drake_twin.description.bounded_yaml import load_yaml
from drake_twin.errors import InputError
from drake_twin.ros2.launch.action import Action
from drake_twin.ros2.launch.launch_context import LaunchContext
from drake_twin.ros2.launch.substitution import SomeSubstitutionsType
from drake_twin.ros2.launch.utilities.normalize_to_list_of_entities_impl import normalize_to_list_of_entities
from drake_twin.ros2.launch.utilities.normalize_to_list_of_substitutions_impl import normalize_to_list_of_substitutions
from drake_twin.ros2.visiting import visit_list


class ForLoop(Action):
    """Calls a function for 0, 1, … and visits what it returns."""

    def __init__(
        self,
        length: SomeSubstitutionsType,
        *,
        function: Callable[..., Any] | None = None,
        name: str = "",
        actions: Any = None,
        **kwargs: Any,
    ):
        super().__init__(**kwargs)
        self.length = normalize_to_list_of_substitutions(str(length) if isinstance(length, int) else length)
        self.function = function
        self.actions = actions
        self.name = name

    def execute(self, context: LaunchContext) -> None:
        """Visit what each round returns.

        Raises:
            InputError: If the length is not a whole number.
        """
        text = context.perform_substitution(self.length)
        try:
            length = int(text)
        except ValueError:
            raise InputError(f"the loop's length is {text!r}, which is not a whole number") from None
        for index in range(length):
            _round(context, {self.name or "index": index}, self.function and self.function(index), self.actions)


class ForEach(Action):
    """Calls a function for each set of values of a list, and visits what it returns.

    Args:
        input_values: Sets separated by ``;``, each a YAML mapping's content: ``{name: 'a', x: 1}; {name: 'b', x: 2}``.
        function: Takes the values by name.
        actions: What to visit where the function is not given, or returns nothing.
    """

    def __init__(
        self,
        input_values: SomeSubstitutionsType,
        *,
        function: Callable[..., Any] | None = None,
        actions: Any = None,
        **kwargs: Any,
    ):
        super().__init__(**kwargs)
        self.input_values = normalize_to_list_of_substitutions(input_values)
        self.function = function
        self.actions = actions

    def execute(self, context: LaunchContext) -> None:
        """Visit what each round returns.

        Raises:
            InputError: If a set is not a mapping.
        """
        for part in context.perform_substitution(self.input_values).split(";"):
            if part.strip():
                values = load_yaml(part)
                if not isinstance(values, dict):
                    raise InputError(f"{part.strip()!r} is not a set of values such as {{name: 'a', x: 1}}")
                _round(context, values, self.function and self.function(**values), self.actions)


def _round(context: LaunchContext, values: Mapping[str, Any], returned: Any, actions: Any) -> None:
    with context.restored(context.snapshot()):
        context.extend_locals({"for_each": values})
        visit_list(normalize_to_list_of_entities(returned) or normalize_to_list_of_entities(actions), context)
