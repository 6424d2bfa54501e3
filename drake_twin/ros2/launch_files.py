"""Launch files: finding, reading and entering them."""

from pathlib import Path
from typing import Any

from drake_twin.description.source_file import file_text
from drake_twin.errors import InputError
from drake_twin.findings import Place
from drake_twin.ros2.built_in_packages import built_in_arguments, built_in_processes
from drake_twin.ros2.launch.actions.declare_launch_argument import DeclareLaunchArgument
from drake_twin.ros2.launch.launch_context import LaunchContext
from drake_twin.ros2.launch.launch_description import LaunchDescription
from drake_twin.ros2.launch_xml.parser import load_xml_file
from drake_twin.ros2.launch_yaml.parser import load_yaml_file
from drake_twin.ros2.packages import AbsentError, absent_package_in
from drake_twin.ros2.python_file import load_python_file
from drake_twin.ros2.visiting import every_entity, visit_list


def load_launch_file(path: str, context: LaunchContext, form: str | None = None) -> LaunchDescription:
    """Read a launch file.

    Args:
        path: The file.
        context: The context.
        form: python, xml or yaml; by the file's name (or its first character) where None.

    Raises:
        InputError: If it cannot be read, its code fails, or an element of it is unknown or wrong.
    """
    form = form or _form_of(Path(path))
    if form == "python":
        return load_python_file(path, context)
    with context.loading(path):
        return load_xml_file(path) if form == "xml" else load_yaml_file(path)


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
        return file_text(path, errors="replace")[:100_000]
    except OSError as error:
        raise InputError(f"the launch file cannot be read ({error.strerror})", file=path) from None


def enter_file(path: str, description: LaunchDescription, context: LaunchContext, included_at: Place | None) -> None:
    """Visit a launch file's description, after checking that its required arguments have values.

    Args:
        path: The file.
        description: Its description.
        context: The context.
        included_at: Where it is included; None for the outermost file.

    Raises:
        InputError: If required arguments have no value; the text lists them all.
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


def enter_built_in_file(path: str, context: LaunchContext, place: Place | None) -> None:
    """Start what a launch file of a built-in package starts; its arguments are the configurations at hand.

    Args:
        path: The file, below `drake_twin.ros2.packages.BUILT_IN`.
        context: The context.
        place: Where it is included.

    Raises:
        InputError: If the package has no such launch file.
    """
    for argument in built_in_arguments(path, place):
        context.declared.add(argument.name)
        if argument.default:
            context.launch_configurations.setdefault(argument.name, argument.default)
    arguments = {name: str(value) for name, value in context.launch_configurations.items()}
    namespace = context.launch_configurations.get("ros_namespace") or "/"
    for process in built_in_processes(path, arguments, namespace, place):
        context.start(process)


def existing_file(path: str, context: LaunchContext, place: Place | None) -> Path:
    """Return the path of a launch file, found by the package in it where need be.

    Args:
        path: The file.
        context: The context.
        place: Where it is included.

    Raises:
        InputError: If it does not exist; the text says where it was searched.
    """
    file = context.locate(path)
    if not file.is_absolute():
        file = file.absolute()
    if file.is_file():
        return file
    package = absent_package_in(path)
    if package is not None:
        reason = context.packages.absent.get(package, "")
        raise AbsentError(f"package {package!r} is absent", **file_and_line(place)) from InputError(reason)
    if not path.isprintable():
        raise InputError(f"the launch file {path[:80]!r}… does not exist", **file_and_line(place))
    folder = file.parent
    there = sorted(entry.name for entry in folder.iterdir() if "launch" in entry.name) if folder.is_dir() else None
    looked = f"looked in {folder}" if there is not None else f"the folder {folder} does not exist"
    raise InputError(
        f"the launch file {path} does not exist: {looked}", valid=there, value=file.name, **file_and_line(place)
    )


def file_and_line(place: Place | None) -> dict[str, Any]:
    """Return the arguments of an InputError that point at a place."""
    return {} if place is None else {"file": place.file, "line": place.line}
