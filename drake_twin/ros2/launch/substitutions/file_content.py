"""The text of a file."""

from drake_twin.description.source_file import file_text
from drake_twin.ros2.launch.frontend.expose import expose_substitution
from drake_twin.ros2.launch.launch_context import LaunchContext
from drake_twin.ros2.launch.substitution import SomeSubstitutionsType, Substitution
from drake_twin.ros2.launch.substitutions.substitution_failure import AbsentFailure, SubstitutionFailure
from drake_twin.ros2.launch.utilities.normalize_to_list_of_substitutions_impl import normalize_to_list_of_substitutions
from drake_twin.ros2.packages import absent_package_in


@expose_substitution("file-content")
class FileContent(Substitution):
    """The text of a file."""

    def __init__(self, path: SomeSubstitutionsType):
        self.path = normalize_to_list_of_substitutions(path)

    def perform(self, context: LaunchContext) -> str:
        """Return the text.

        Raises:
            SubstitutionFailure: If the file cannot be read.
        """
        path = context.locate(context.perform_substitution(self.path))
        absent = absent_package_in(str(path))
        if absent is not None:
            raise AbsentFailure(f"package {absent!r} is absent, and a file of it is read: {path}")
        try:
            return file_text(path)
        except (OSError, UnicodeDecodeError) as error:
            raise SubstitutionFailure(f"cannot be read ({error})", file=path) from None
