"""Sources of launch descriptions."""

from drake_twin.ros2.described_substitutions import described_text
from drake_twin.ros2.launch.launch_context import LaunchContext
from drake_twin.ros2.launch.launch_description import LaunchDescription
from drake_twin.ros2.launch.substitution import SomeSubstitutionsType
from drake_twin.ros2.launch.utilities.normalize_to_list_of_substitutions_impl import normalize_to_list_of_substitutions
from drake_twin.ros2.launch_files import load_launch_file


class LaunchDescriptionSource:
    """The source of a launch description.

    Args:
        launch_description: The description itself, where it exists already.
        location: The launch file.
        method: How it was read; for people.

    Attributes:
        form: How to read the file: python, xml or yaml; by its name where None.
    """

    form: str | None = None

    def __init__(
        self,
        launch_description: LaunchDescription | None = None,
        location: SomeSubstitutionsType = "",
        method: str = "unspecified mechanism from a script",
    ):
        self._description = launch_description
        self._location = normalize_to_list_of_substitutions(location)
        self._method = method

    @property
    def location(self) -> str:
        """The launch file, as given."""
        return described_text(self._location)

    @property
    def method(self) -> str:
        """How it is read."""
        return self._method

    def perform_location(self, context: LaunchContext) -> str:
        """Return the launch file."""
        return context.perform_substitution(self._location)

    def get_launch_description(self, context: LaunchContext) -> LaunchDescription:
        """Return the description."""
        if self._description is None:
            self._description = load_launch_file(self.perform_location(context), context, self.form)
        return self._description

    def try_get_launch_description_without_context(self) -> LaunchDescription | None:
        """Return the description, if it exists already."""
        return self._description

    @property
    def is_description(self) -> bool:
        """Whether it is a description without a file."""
        return self._description is not None and not self.location
