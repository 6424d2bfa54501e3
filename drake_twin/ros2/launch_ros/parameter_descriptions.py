"""Parameters of nodes: single values, and files of them."""

import os
from pathlib import Path
from typing import Any

from drake_twin.errors import InputError
from drake_twin.ros2.launch.frontend.parse_substitution import parse_substitution
from drake_twin.ros2.launch.launch_context import LaunchContext
from drake_twin.ros2.launch.substitution import SomeSubstitutionsType
from drake_twin.ros2.launch.utilities.normalize_to_list_of_substitutions_impl import normalize_to_list_of_substitutions
from drake_twin.ros2.launched import ParameterText
from drake_twin.ros2.launched import ParameterValue as Value
from drake_twin.ros2.parameter_values import typed_as
from drake_twin.ros2.rewritten_files import read_parameter_file, write_rewritten
from drake_twin.ros2.typed_text import typed_text


class ParameterValue:
    """A parameter's value, read as a type.

    Args:
        value: A number, text, a substitution, or a list of them.
        value_type: ``bool``, ``int``, ``float``, ``str`` or a list of one of them (``List[float]``); None for what
            YAML takes the text for.
    """

    def __init__(self, value: Any, *, value_type: Any = None):
        self.value = value
        self.value_type = value_type

    def evaluate(self, context: LaunchContext, what: str = "the parameter") -> Value:
        """Return the value.

        Args:
            context: The context.
            what: The parameter in words, for messages.

        Raises:
            InputError: If the text is not of the type.
        """
        return typed_as(context, self.value, self.value_type, what)


class Parameter(ParameterValue):
    """A parameter: name and value."""

    def __init__(self, name: SomeSubstitutionsType, value: Any, *, value_type: Any = None):
        super().__init__(value, value_type=value_type)
        self.name = normalize_to_list_of_substitutions(name)

    def evaluate_pair(self, context: LaunchContext) -> tuple[str, Value]:
        """Return name and value."""
        name = context.perform_substitution(self.name)
        return name, self.evaluate(context, f"parameter {name!r}")


class ParameterFile:
    """A YAML file of parameters.

    Args:
        param_file: The file.
        allow_substs: Whether ``$(var x)`` and the like are filled in.
    """

    def __init__(self, param_file: Any, *, allow_substs: Any = False):
        param_file = os.fsdecode(param_file) if isinstance(param_file, bytes) else param_file
        self.param_file = normalize_to_list_of_substitutions(param_file)
        self.allow_substs = allow_substs

    def evaluate(self, context: LaunchContext) -> Path:
        """Return the file; one with its substitutions filled in, where they are allowed."""
        content = self.read(context)
        return content if isinstance(content, Path) else write_rewritten(context, content)

    def read(self, context: LaunchContext) -> Path | ParameterText:
        """Return the file, or its text where that differs from the file.

        Raises:
            InputError: If there are substitutions to fill in, and the file cannot be read or one of them fails.
        """
        path = context.locate(context.perform_substitution(self.param_file))
        known = context.rewritten.get(str(path))
        if known is None and not self._substitutes(context):
            return path
        if known is None:
            known = ParameterText(path, read_parameter_file(path))
        if self._substitutes(context):
            try:
                known = ParameterText(known.file, context.perform_substitution(parse_substitution(known.text)))
            except InputError as error:
                raise InputError(error.message, file=known.file, valid=error.valid, value=error.value) from None
        return known

    def _substitutes(self, context: LaunchContext) -> bool:
        if isinstance(self.allow_substs, bool):
            return self.allow_substs
        return bool(typed_text(context.perform_substitution(self.allow_substs), bool).value)
