"""A command line as data."""

from collections.abc import Iterable, Mapping
from typing import Any

from drake_twin.ros2.launch.substitution import SomeSubstitutionsType
from drake_twin.ros2.launch.utilities.normalize_to_list_of_substitutions_impl import normalize_to_list_of_substitutions
from drake_twin.ros2.text_parts import as_text


class Executable:
    """A command line as data.

    Attributes:
        cmd: Its words, each a list of substitutions.
        numbers: The words that were given as numbers, which ROS refuses.
        single_text: A text in place of a list of words; like ROS, each of its letters is taken for a word.
    """

    def __init__(
        self,
        *,
        cmd: Iterable[SomeSubstitutionsType],
        prefix: SomeSubstitutionsType | None = None,
        name: SomeSubstitutionsType | None = None,
        cwd: SomeSubstitutionsType | None = None,
        env: Mapping[Any, Any] | None = None,
        additional_env: Mapping[Any, Any] | None = None,
        arguments: Iterable[SomeSubstitutionsType] | None = None,
    ):
        self.single_text = next((text for text in (cmd, arguments) if isinstance(text, str)), "")
        words = [*cmd, *(arguments or ())]
        self.numbers = [word for word in words if as_text(word) is not word]
        self.cmd = [normalize_to_list_of_substitutions(as_text(word)) for word in words]
        self.prefix, self.name, self.cwd = prefix, name, cwd
        self.env, self.additional_env = env, additional_env
