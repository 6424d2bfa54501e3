"""Includes a launch file in another."""

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from drake_twin.errors import InputError
from drake_twin.findings import Place
from drake_twin.ros2.launch.action import Action
from drake_twin.ros2.launch.actions.declare_launch_argument import DeclareLaunchArgument
from drake_twin.ros2.launch.frontend.entity import Entity
from drake_twin.ros2.launch.frontend.expose import Parsed, expose_action
from drake_twin.ros2.launch.frontend.parser import Parser
from drake_twin.ros2.launch.launch_context import LaunchContext
from drake_twin.ros2.launch.launch_description import LaunchDescription
from drake_twin.ros2.launch.launch_description_source import LaunchDescriptionSource
from drake_twin.ros2.launch.launch_description_sources.any_launch_description_source import AnyLaunchDescriptionSource
from drake_twin.ros2.launch_files import enter_built_in_file, enter_file, existing_file, file_and_line, load_launch_file
from drake_twin.ros2.launched import FailedInclude, Included
from drake_twin.ros2.packages import BUILT_IN, AbsentError
from drake_twin.ros2.text_parts import as_text
from drake_twin.ros2.visiting import every_entity, visit_list

# A file may include itself with other arguments, but hardly more often than this.
_DEEPEST_REPETITION = 8


@expose_action("include")
class IncludeLaunchDescription(Action):
    """Includes a launch file, or a description.

    Like in ROS, an include does not open a scope: its arguments stay set after it.

    Args:
        launch_description_source: A source, a path, or a description.
        launch_arguments: (name, value) pairs.
    """

    def __init__(
        self,
        launch_description_source: Any,
        *,
        launch_arguments: Iterable[Any] | Mapping[Any, Any] | None = None,
        **kwargs: Any,
    ):
        super().__init__(**kwargs)
        source = launch_description_source
        if isinstance(source, LaunchDescription):
            source = LaunchDescriptionSource(source)
        elif not isinstance(source, LaunchDescriptionSource):
            source = AnyLaunchDescriptionSource(source)
        self._source = source
        self._is_mapping = isinstance(launch_arguments, Mapping)
        pairs = launch_arguments.items() if isinstance(launch_arguments, Mapping) else launch_arguments
        self._arguments = [tuple(pair) for pair in pairs or ()]

    @classmethod
    def parse(cls, entity: Entity, parser: Parser) -> Parsed:
        """Return the class and its arguments for ``<include>``."""
        _, arguments = super().parse(entity, parser)
        pairs = parser.parse_children(entity, "arg", "name", "value")
        for child in entity.children_named("let"):
            child.refused_by_ros("ROS 2 Jazzy knows only <arg> in an <include>")
        pairs += parser.parse_children(entity, "let", "name", "value")
        return cls, {
            **arguments,
            "launch_description_source": AnyLaunchDescriptionSource(parser.parse_required(entity, "file")["file"]),
            "launch_arguments": [(pair["name"], pair["value"]) for pair in pairs],
        }

    @property
    def launch_description_source(self) -> LaunchDescriptionSource:
        """The source."""
        source: LaunchDescriptionSource = self._source
        return source

    @property
    def launch_arguments(self) -> list[tuple[Any, ...]]:
        """The arguments, as given."""
        return self._arguments

    def execute(self, context: LaunchContext) -> None:
        """Set the arguments and visit the description.

        What an include needs and this machine does not have is noted in the context, and the launch continues.

        Raises:
            InputError: If the file cannot be used for another reason.
        """
        where = self._source.location or "a launch description"
        processes = len(context.processes)
        try:
            path = "" if self._source.is_description else self._source.perform_location(context)
            where = path or where
            self._include(path, context)
        except AbsentError as error:
            place = self.place or context.position or Place("")
            kept = len(context.processes) - processes
            note = f" ({kept} of its processes had started before)" if kept else ""
            context.failed_includes.append(FailedInclude(where, f"{_reason(error, where)}{note}", place))

    def _include(self, path: str, context: LaunchContext) -> None:
        if self._is_mapping:
            context.refused_by_ros("launch_arguments is a mapping without .items()")
        names = []
        for given, value in self._arguments:
            name = context.perform_substitution(given)
            text = context.perform_substitution(as_text(value))
            if as_text(value) is not value:
                context.refused_by_ros(f"the launch argument {name!r} is {value!r}, which is not text")
            names.append(name)
            context.launch_configurations[name] = text
        if self._source.is_description:
            visit_list([self._source.get_launch_description(context)], context)
            return
        included = Included(path, tuple(names), self.place or context.position or Place(""))
        if path.startswith(BUILT_IN):
            context.includes.append(included)
            enter_built_in_file(path, context, self.place)
            return
        file = existing_file(path, context, self.place)
        repeated = sum(1 for name, _ in context.files if name == str(file))
        if repeated >= _DEEPEST_REPETITION:
            chain = " → ".join(Path(name).name for name, _ in [*context.files[-4:], (str(file), None)])
            raise InputError(f"launch files include each other in a loop: {chain}", **file_and_line(self.place))
        description = load_launch_file(str(file), context, self._form(file))
        context.includes.append(included)
        self._note_missing(description, set(names), context)
        enter_file(str(file), description, context, self.place)

    def _note_missing(self, description: LaunchDescription, names: set[str], context: LaunchContext) -> None:
        """Note required arguments that have a value, but not from this include: ROS looks at its own only."""
        for entity in every_entity(description, conditional=False):
            if isinstance(entity, IncludeLaunchDescription):
                names |= {name for name, _ in entity.launch_arguments if isinstance(name, str)}
        for entity in every_entity(description, conditional=False):
            if not isinstance(entity, DeclareLaunchArgument) or entity.condition or entity.default_value is not None:
                continue
            if entity.name in context.launch_configurations and entity.name not in names:
                context.refused_by_ros(f"the include does not give the required argument {entity.name!r} itself")

    def _form(self, file: Path) -> str | None:
        """Return how to read a file; a source of another form than the file's name would fail in ROS."""
        return None if file.suffix in (".py", ".xml", ".yaml", ".yml") else self._source.form


def _reason(error: AbsentError, where: str) -> str:
    if error.file is None or error.file == where:
        return error.message
    return f"{error.message} ({error.file}{f':{error.line}' if error.line else ''})"
