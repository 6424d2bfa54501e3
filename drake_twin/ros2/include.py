"""Including one launch file in another, and the sources of launch descriptions."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from drake_twin.errors import InputError
from drake_twin.findings import Place
from drake_twin.ros2.actions import DeclareLaunchArgument
from drake_twin.ros2.entity import Action, LaunchDescription, every_entity, visit_list
from drake_twin.ros2.launched import FailedInclude
from drake_twin.ros2.packages import BUILT_IN, AbsentError, absent_package_in
from drake_twin.ros2.substitution import (
    SomeSubstitutionsType,
    describe_all,
    normalize_to_list_of_substitutions,
    perform,
    perform_substitutions,
)

if TYPE_CHECKING:
    from drake_twin.ros2.context import LaunchContext

# A file may include itself with other arguments, but hardly more often than this.
_DEEPEST_REPETITION = 8


class LaunchDescriptionSource:
    """Where a launch description comes from.

    Args:
        launch_description: the description itself, where it exists already.
        location: the launch file.
        method: how it was read; for people.
    """

    form: str | None = None  # how to read the file: python, xml or yaml; by its name where None

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
        return describe_all(self._location)

    @property
    def method(self) -> str:
        """How it is read."""
        return self._method

    def perform_location(self, context: LaunchContext) -> str:
        """The launch file."""
        return perform_substitutions(context, self._location)

    def get_launch_description(self, context: LaunchContext) -> LaunchDescription:
        """The description."""
        if self._description is None:
            self._description = load_launch_file(self.perform_location(context), context, self.form)
        return self._description

    def try_get_launch_description_without_context(self) -> LaunchDescription | None:
        """The description, if it exists already."""
        return self._description

    @property
    def is_description(self) -> bool:
        """Whether it is a description without a file."""
        return self._description is not None and not self.location


class AnyLaunchDescriptionSource(LaunchDescriptionSource):
    """A launch file of any kind."""

    def __init__(self, launch_file_path: SomeSubstitutionsType, **kwargs: Any):
        super().__init__(None, launch_file_path, "interpreted launch file")


FrontendLaunchDescriptionSource = AnyLaunchDescriptionSource


class PythonLaunchDescriptionSource(AnyLaunchDescriptionSource):
    """A Python launch file."""

    form = "python"


class XMLLaunchDescriptionSource(AnyLaunchDescriptionSource):
    """An XML launch file."""

    form = "xml"


class YAMLLaunchDescriptionSource(AnyLaunchDescriptionSource):
    """A YAML launch file."""

    form = "yaml"


def load_launch_file(path: str, context: LaunchContext, form: str | None = None) -> LaunchDescription:
    """Reads a launch file.

    Args:
        path: the file.
        context: where packages are found.
        form: python, xml or yaml; by the file's name (or its first character) where None.

    Raises:
        InputError: it cannot be read.
    """
    from drake_twin.ros2.python_file import load_python_file
    from drake_twin.ros2.xml_file import load_xml_file
    from drake_twin.ros2.yaml_file import load_yaml_file

    loaders = {"python": load_python_file, "xml": load_xml_file, "yaml": load_yaml_file}
    return loaders[form or _form_of(Path(path))](path, context)


def _form_of(path: Path) -> str:
    form = {".py": "python", ".xml": "xml", ".yaml": "yaml", ".yml": "yaml"}.get(path.suffix)
    if form is not None:
        return form
    start = _read_start(path).lstrip("\ufeff \r\n\t")
    if start.startswith("<"):
        return "xml"
    if start.startswith(("launch:", "---", "%YAML")):
        return "yaml"
    if "generate_launch_description" in start:
        return "python"
    raise InputError(
        f"a launch file's name ends with one of these, and this one's is {path.name!r}",
        file=path,
        valid=[".launch.py", ".launch.xml", ".launch.yaml"],
    )


def _read_start(path: Path) -> str:
    try:
        return path.read_text(encoding="utf-8", errors="replace")[:100_000]
    except OSError as error:
        raise InputError(f"the launch file cannot be read ({error.strerror})", file=path) from None


def enter_file(path: str, description: LaunchDescription, context: LaunchContext, included_at: Place | None) -> None:
    """Visits a launch file's description, after checking that its required arguments have values.

    Raises:
        InputError: required arguments without a value; the text lists them all.
    """
    missing = [
        entity
        for entity in every_entity(description, conditional=False)
        if isinstance(entity, DeclareLaunchArgument)
        and entity.default_value is None
        and entity.condition is None
        and entity.name not in context.launch_configurations
    ]
    if missing:
        names = dict.fromkeys(
            f"{item.name} ({item.description})" if item.description else item.name for item in missing
        )
        who = "" if included_at is None else f", included by {included_at},"
        raise InputError(
            f"the launch file{who} needs values for its arguments: {', '.join(names)}. Give each as name:=value",
            file=path,
            line=None if missing[0].place is None else missing[0].place.line,
        )
    with context.in_file(path, included_at):
        visit_list([description], context)


class IncludeLaunchDescription(Action):
    """Includes a launch file, or a description.

    Its arguments are set where it stands: like ROS, an include is no scope.

    Args:
        launch_description_source: a source, a path, or a description.
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
        pairs = launch_arguments.items() if isinstance(launch_arguments, Mapping) else launch_arguments
        self._arguments = [tuple(pair) for pair in pairs or ()]

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
        """Sets the arguments and visits the description.

        What an include needs and this machine does not have is noted in the context, and the launch goes on.
        """
        where = self._source.location or "a launch description"
        processes = len(context.processes)
        try:
            path = "" if self._source.is_description else self._source.perform_location(context)
            where = path or where
            self._include(path, context)
        except AbsentError as error:
            place = self.place or Place(context.place_file or "")
            kept = len(context.processes) - processes
            note = f" ({kept} of its processes had started before)" if kept else ""
            context.failed_includes.append(FailedInclude(where, f"{_reason(error, where)}{note}", place))

    def _include(self, path: str, context: LaunchContext) -> None:
        for name, value in self._arguments:
            text = str(value) if isinstance(value, bool | int | float) else value
            context.launch_configurations[perform(context, name)] = perform(context, text)
        if self._source.is_description:
            visit_list([self._source.get_launch_description(context)], context)
            return
        if path.startswith(BUILT_IN):
            from drake_twin.ros2.stand_ins import include_stand_in

            include_stand_in(path, context, self.place)
            return
        file = existing_file(path, context, self.place)
        repeated = sum(1 for name, _ in context.files if name == str(file))
        if repeated >= _DEEPEST_REPETITION:
            chain = " → ".join(Path(name).name for name, _ in [*context.files[-4:], (str(file), None)])
            raise InputError(f"launch files include each other in a loop: {chain}", **_place(self.place))
        description = load_launch_file(str(file), context, self._form(file))
        enter_file(str(file), description, context, self.place)

    def _form(self, file: Path) -> str | None:
        """A Python source that is given an XML file would fail in ROS as well, but what is meant is clear."""
        return None if file.suffix in (".py", ".xml", ".yaml", ".yml") else self._source.form


def existing_file(path: str, context: LaunchContext, place: Place | None) -> Path:
    """A launch file that is there.

    Raises:
        InputError: it is not; the text says where it was looked for.
    """
    file = context.locate(path)
    if not file.is_absolute():
        file = file.absolute()
    if file.is_file():
        return file
    package = absent_package_in(path)
    if package is not None:
        reason = context.packages.absent.get(package, "")
        raise AbsentError(f"package {package!r} is absent", **_place(place)) from InputError(reason)
    folder = file.parent
    there = sorted(entry.name for entry in folder.iterdir() if "launch" in entry.name) if folder.is_dir() else None
    looked = f"looked in {folder}" if there is not None else f"the folder {folder} does not exist"
    raise InputError(f"the launch file {path} is not there: {looked}", valid=there, value=file.name, **_place(place))


def _place(place: Place | None) -> dict[str, Any]:
    return {} if place is None else {"file": place.file, "line": place.line}


def _reason(error: AbsentError, where: str) -> str:
    if error.file is None or error.file == where:
        return error.message
    return f"{error.message} ({error.file}{f':{error.line}' if error.line else ''})"
