"""Controllers' parameters files, read for one robot: its controllers, their types and parameters."""

import re
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import field, replace
from pathlib import Path
from typing import Any

from drake_twin.dataclass import dataclass
from drake_twin.description.source_file import check_regular, file_text
from drake_twin.description.yaml_document import YamlDocument
from drake_twin.errors import InputError, did_you_mean
from drake_twin.findings import Cause, Finding, Kind, Place
from drake_twin.typed_data import Reader, ValuePath
from drake_twin.values import is_number

HIGHEST_RATE = 1e9  # Hz: a nanosecond is the shortest that ROS counts
LOWEST_RATE = 1e-9  # Hz: once in thirty years

_OF_MANAGER = (
    *("update_rate", "enforce_command_limits", "use_sim_time"),
    *("hardware_components_initial_state.inactive", "hardware_components_initial_state.unconfigured"),
    *("defaults.switch_controller.strictness", "defaults.allow_controller_activation_with_inactive_hardware"),
)
_OF_CONTROLLER = ("type", "params_file", "fallback_controllers", "node_options_args")
_PROCESS = "the twin has no process for it"
_UNUSED_OF_MANAGER = {
    **dict.fromkeys(("thread_priority", "lock_memory", "cpu_affinity", "overruns", "handle_exceptions"), _PROCESS),
    "hardware_components_initial_state.shutdown_on_initial_state_failure": "simulated hardware does not fail",
    "defaults.deactivate_controllers_on_hardware_self_deactivate": "simulated hardware stays active",
    "diagnostics": "the twin publishes no diagnostics",
    "robot_description": "it is the robot's file",
}
_STATES = "hardware_components_initial_state"
_STRICTNESS = "defaults.switch_controller.strictness"
_USES_INACTIVE = "defaults.allow_controller_activation_with_inactive_hardware"
_STRICTNESSES = {"best_effort": 1, "strict": 2}
_GROUPS = (_STATES, "defaults")  # their parameters may be written as nested mappings
_PARAMETERS = "ros__parameters"
_NODES = ("controller_manager", "*")
_DEEPEST_NAME = 32  # dots in one name
DEFAULT_UPDATE_RATE = 100.0  # Hz, controller_manager's default in Jazzy

_PLACEHOLDER = re.compile(r"\$\(var\s+([\w.]+)\s*\)|\$\{(\w+)\}")


@dataclass(frozen=True)
class ControllerParameters:
    """One controller's entry in a parameters file.

    Attributes:
        name: The controller's name; its topics are below it.
        type: The plugin's name, for example ``forward_command_controller/ForwardCommandController``.
        parameters: Its ``ros__parameters``.
        sources: The documents that give them, the one that overrides the others last, each with the path in it.
    """

    name: str
    type: str
    parameters: Mapping[str, Any]
    sources: tuple[tuple[YamlDocument, ValuePath], ...] = ()

    def names(self, parameter: str) -> tuple[str, ...]:
        """Read a parameter that is a list of names; empty when it is not given."""
        value = self.parameters.get(parameter, [])
        if not isinstance(value, list) or not all(isinstance(item, str) for item in value):
            raise self.error(f"{value!r} is not a list of names", parameter)
        return tuple(value)

    def text(self, parameter: str, default: str) -> str:
        """Read a parameter that is text."""
        value = self.parameters.get(parameter, default)
        if not isinstance(value, str):
            raise self.error(f"{value!r} is not text", parameter)
        return value

    def error(self, message: str, *path: str | int, **more: Any) -> InputError:
        """Return an error that points at a parameter of this controller."""
        if not self.sources:
            return InputError(f"controller {self.name!r}: {message}", **more)
        document, above = self._source(path)
        return document.error((*above, *path), message, **more)

    def place(self, *path: str | int) -> Place:
        """Return where a parameter of this controller is written."""
        if not self.sources:
            return Place("")
        document, above = self._source(path)
        return Place(str(document.file), document.line((*above, *path)))

    def _source(self, path: ValuePath) -> tuple[YamlDocument, ValuePath]:
        """Return the last of the sources that gives a parameter."""
        for part in (path, path[:1]):
            named = (source for source in reversed(self.sources) if part and source[0].has((*source[1], *part)))
            if (found := next(named, None)) is not None:
                return found
        return self.sources[-1]


@dataclass(frozen=True)
class ControllerManagerParameters:
    """The parameters of a robot's controller manager.

    Attributes:
        update_rate: The rate at which controllers are updated (Hz).
        enforce_command_limits: Whether commands are clamped to the joints' limits; as in Jazzy, off by default.
        controllers: The controllers, in file order.
        findings: Parameters of the controller manager that are ignored.
        hardware_states: ``<ros2_control>`` tag → inactive or unconfigured, and where the file says so.
        strictness: The strictness of a switch that names none: 1 for ``best_effort``, 2 for ``strict``.
        uses_inactive_hardware: Whether controllers may claim interfaces of inactive hardware.
    """

    update_rate: float = DEFAULT_UPDATE_RATE
    enforce_command_limits: bool = False
    controllers: tuple[ControllerParameters, ...] = ()
    findings: tuple[Finding, ...] = ()
    hardware_states: Mapping[str, tuple[str, Place]] = field(default_factory=dict)
    strictness: int = 1
    uses_inactive_hardware: bool = False


def read_controllers(
    files: Path | Sequence[Path], namespace: str, placeholders: Mapping[str, str]
) -> ControllerManagerParameters:
    """Read parameters files as the nodes in one namespace see them; a later file's values replace an earlier one's.

    All forms in use are understood: ``controller_manager:`` at the top, below ``/**:``, below a namespace
    (``robot_1:``), and ``/ns/controller_manager`` in one word. An entry for another namespace is ignored.

    Args:
        files: The YAML files.
        namespace: The robot's namespace, for example ``/robot_1``.
        placeholders: Values of ``$(var name)`` and ``${name}`` in the file.

    Raises:
        InputError: If a file is not YAML, a placeholder has no value, or an entry has the wrong shape.
    """
    nodes: dict[str, list[tuple[YamlDocument, ValuePath, Mapping[str, Any]]]] = {}
    findings: list[Finding] = []
    for file in [files] if isinstance(files, Path) else files:
        document = _read_document(file, placeholders)
        findings += _misspelt_groups(document)
        for name, entries in _nodes(document, namespace).items():
            nodes.setdefault(name, []).extend((document, *entry) for entry in entries)
    manager = ControllerManagerParameters()
    fallbacks: dict[str, Any] = {}
    types: dict[str, str] = {}
    places: dict[str, tuple[YamlDocument, ValuePath]] = {}
    for document, path, parameters in nodes.get("controller_manager", []):
        manager = _with_values(manager, document, path, dict(_written(parameters)))
        for name, value in _written(parameters):
            if isinstance(name, str) and name.endswith(".fallback_controllers"):
                fallbacks[name.removesuffix(".fallback_controllers")] = value
            elif isinstance(value, dict) and "fallback_controllers" in value:
                fallbacks[str(name)] = value["fallback_controllers"]
            if isinstance(value, dict) and "type" in value:
                if not isinstance(name, str) or not name:
                    raise document.error((*path, name), f"{name!r} is not a controller's name: it must be text")
                if not isinstance(value["type"], str):
                    raise document.error((*path, name, "type"), f"{value['type']!r} is not a controller's type")
                types[name], places[name] = value["type"], (document, (*path, name))
            elif isinstance(name, str) and name.endswith(".type") and isinstance(value, str):
                types[name.removesuffix(".type")] = value
            elif (what := _unread(str(name), value)) is not None:
                place = Place(str(document.file), document.line((*path, name)))
                told = f"controller_manager: {what}"
                findings.append(Finding.at(Kind.WARNING, told, place, cause=Cause.PARAMETER))
    for name, found in nodes.items():
        for *_, parameters in found:
            if isinstance(parameters.get("type"), str):
                types.setdefault(name, parameters["type"])
    findings += _misspelt_nodes(nodes, types)
    controllers = []
    for name, kind in types.items():
        merged: dict[str, Any] = {}
        found = nodes.get(name, [])
        for *_, parameters in found:
            merge_nested(merged, nested(parameters))
        if name in fallbacks:
            merged.setdefault("fallback_controllers", fallbacks[name])
        sources = [*([places[name]] if name in places else ()), *(entry[:2] for entry in found)]
        controllers.append(ControllerParameters(name, kind, merged, tuple(sources)))
    return replace(manager, controllers=tuple(controllers), findings=tuple(findings))


def _misspelt_groups(document: YamlDocument) -> Iterator[Finding]:
    """Report keys that are nearly ``ros__parameters``: what is below them belongs to no node."""
    for path in document.paths:
        key = str(path[-1])
        hint = did_you_mean(key, [_PARAMETERS], 0.8) if _PARAMETERS not in path else ""
        if hint:
            what = f"the key {key!r}: what is below it belongs to no node{hint}"
            yield Finding.at(Kind.IGNORED, what, Place(str(document.file), document.line(path)))


def _misspelt_nodes(
    nodes: Mapping[str, Sequence[tuple[YamlDocument, ValuePath, Any]]], types: Collection[str]
) -> Iterator[Finding]:
    """Report the parameters of a node whose name is nearly a controller's; other nodes may share the file."""
    for name in (name for name in nodes if name not in types):
        if name not in _NODES and (hint := did_you_mean(name, types, 0.85)):
            document, path, _ = nodes[name][0]
            what = f"parameters of the node {name!r}, which is not a controller{hint}"
            yield Finding.at(Kind.WARNING, what, Place(str(document.file), document.line(path[:-1])))


def _written(parameters: Mapping[Any, Any]) -> Iterator[tuple[Any, Any]]:
    """Yield the controller manager's parameters, those of its nested groups by their names with dots."""
    for name, value in parameters.items():
        if name in _GROUPS and isinstance(value, dict):
            yield from _leaves(value, name)
        else:
            yield name, value


def _leaves(values: Mapping[Any, Any], name: str) -> Iterator[tuple[str, Any]]:
    for key, value in values.items():
        if isinstance(value, dict):
            yield from _leaves(value, f"{name}.{key}")
        else:
            yield f"{name}.{key}", value


def _with_values(
    before: ControllerManagerParameters, document: YamlDocument, path: ValuePath, given: Mapping[str, Any]
) -> ControllerManagerParameters:
    """Return the parameters of a controller manager with those that are given."""
    rate, text = given.get("update_rate", before.update_rate), given.get(_STRICTNESS)
    if not is_number(rate) or not LOWEST_RATE < rate < HIGHEST_RATE:
        raise document.error((*path, "update_rate"), f"{rate!r} is not a positive rate (Hz)")
    if _STRICTNESS in given and str(text) not in _STRICTNESSES:
        at = (*path, _STRICTNESS)
        raise document.error(at, f"unknown strictness {text!r}", value=str(text), valid=_STRICTNESSES)

    def flag(name: str, default: bool) -> bool:
        return bool(Reader(document.error).read(bool, given.get(name, default), (*path, name)))

    states = dict(before.hardware_states)
    for state in ("unconfigured", "inactive"):  # one that is in both lists is inactive, as upstream
        names, where = given.get(f"{_STATES}.{state}", []), (*path, f"{_STATES}.{state}")
        if not isinstance(names, list) or not all(isinstance(item, str) for item in names):
            raise document.error(where, f"{names!r} is not a list of hardware components")
        states |= dict.fromkeys(filter(None, names), (state, Place(str(document.file), document.line(where))))
    return replace(
        before,
        update_rate=float(rate),
        enforce_command_limits=flag("enforce_command_limits", before.enforce_command_limits),
        hardware_states=states,
        strictness=_STRICTNESSES.get(str(text), before.strictness),
        uses_inactive_hardware=flag(_USES_INACTIVE, before.uses_inactive_hardware),
    )


def _unread(name: str, value: Any) -> str | None:
    """Say why a parameter of the controller manager is ignored; return None when it is used, or is a controller's."""
    first, dot, last = name.partition(".")
    if name in _OF_MANAGER or first in _OF_MANAGER or (dot and last in _OF_CONTROLLER):
        return None
    unused = next((key for key in (name, first) if key in _UNUSED_OF_MANAGER), None)
    if unused is not None:
        return f"{name} is ignored: {_UNUSED_OF_MANAGER[unused]}"
    if isinstance(value, dict):
        return f"{name!r} has no type, so it is not a controller: it is ignored"
    return f"unknown parameter {name!r}: it is ignored"


def nested(parameters: Mapping[Any, Any]) -> dict[str, Any]:
    """Convert ``linear.x.max_velocity: 1`` to ``linear: {x: {max_velocity: 1}}``: for ROS the two are one.

    A list of mappings is one mapping, as for rcl: ROS's own examples have ``gpio: [{interfaces: […]}]``.
    """
    found: dict[str, Any] = {}
    for key, value in parameters.items():
        if isinstance(value, list) and value and all(isinstance(item, Mapping) for item in value):
            value = {name: below for item in value for name, below in item.items()}
        value = nested(value) if isinstance(value, Mapping) else value
        for part in reversed(str(key).split(".", _DEEPEST_NAME)):
            value = {part: value}
        merge_nested(found, value)
    return found


def merge_nested(parameters: dict[str, Any], later: Mapping[str, Any]) -> None:
    """Add parameters to others: mappings are merged, any other later value replaces the earlier one."""
    for key, value in later.items():
        known = parameters.get(key)
        if isinstance(known, dict) and isinstance(value, Mapping):
            merge_nested(known, value)
        else:
            parameters[key] = value


def _read_document(file: Path, placeholders: Mapping[str, str]) -> YamlDocument:
    try:
        check_regular(file)
        text = file_text(file)
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"the parameters file cannot be read ({error})", file=file) from None
    return YamlDocument(_with_placeholders(text, file, placeholders), file, like_rcl=True)


def _with_placeholders(text: str, file: Path, placeholders: Mapping[str, str]) -> str:
    if "$" not in text:
        return text
    lines = []
    for number, line in enumerate(text.splitlines(keepends=True), start=1):
        start = line.find("#")  # $(var …) in a comment is not a placeholder
        code, comment = (line, "") if start < 0 else (line[:start], line[start:])
        for match in _PLACEHOLDER.finditer(code):
            name = match[1] or match[2]
            if name not in placeholders:
                raise InputError(
                    f"{match[0]} has no value", file=file, line=number, valid=sorted(placeholders), value=name
                )
        lines.append(_PLACEHOLDER.sub(lambda match: placeholders[match[1] or match[2]], code) + comment)
    return "".join(lines)


def _nodes(document: YamlDocument, namespace: str) -> dict[str, list[tuple[ValuePath, Mapping[str, Any]]]]:
    """Return node name → the ``ros__parameters`` that apply to it in ``namespace``, general ones first."""
    data = document.data
    if data is None:
        return {}
    if not isinstance(data, dict):
        raise document.error((), "a parameters file is a mapping of node names")
    found: list[tuple[int, str, ValuePath, Mapping[str, Any]]] = []

    def walk(value: Any, path: ValuePath) -> None:
        for key, below in value.items():
            if not isinstance(key, str) or not isinstance(below, dict):
                continue
            here = (*path, key)
            if "ros__parameters" in below:
                parameters = below["ros__parameters"]
                if parameters is None:
                    parameters = {}
                if not isinstance(parameters, dict):
                    raise document.error((*here, "ros__parameters"), "the parameters of a node are a mapping")
                rank_and_name = _match("/".join(str(part) for part in here), namespace)
                if rank_and_name is not None:
                    found.append((*rank_and_name, (*here, "ros__parameters"), parameters))
            else:
                walk(below, here)

    walk(data, ())
    names = dict.fromkeys([*(name for _, name, _, _ in found if name != "*"), "controller_manager"])
    nodes: dict[str, list[tuple[ValuePath, Mapping[str, Any]]]] = {}
    for _, name, path, parameters in sorted(found, key=lambda entry: entry[0]):
        for each in names if name == "*" else [name]:
            nodes.setdefault(each, []).append((path, parameters))
    return nodes


def _match(pattern: str, namespace: str) -> tuple[int, str] | None:
    """Return how well a node pattern fits the namespace (higher is closer) and the node's name; else None."""
    parts = [part for part in pattern.split("/") if part]
    if not parts:
        return None
    *places, name = parts
    own = [part for part in namespace.split("/") if part]
    if name == "**":
        return 0, "*"
    if places in (["**"], []):
        return (1 if places else 2), name
    if places == own:
        return 3, name
    return None
