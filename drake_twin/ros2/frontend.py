"""From the elements of XML and YAML launch files to actions."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from drake_twin.errors import InputError
from drake_twin.findings import Place
from drake_twin.ros2 import actions, conditions, gz_actions, include, parameters, process_actions, ros_actions
from drake_twin.ros2.entity import Action, LaunchDescription
from drake_twin.ros2.substitution import Substitution, TextSubstitution
from drake_twin.ros2.substitution_text import parse_substitution

_TYPES: Mapping[str, Any] = {
    "str": str,
    "int": int,
    "float": float,
    "bool": bool,
    "list_of_str": list[str],
    "list_of_int": list[int],
    "list_of_float": list[float],
    "list_of_bool": list[bool],
}


def read_launch_file(path: str) -> str:
    """The text of a launch file.

    Raises:
        InputError: it cannot be read, or is no UTF-8.
    """
    try:
        return Path(path).read_text(encoding="utf-8-sig")
    except OSError as error:
        raise InputError(f"the launch file cannot be read ({error.strerror})", file=path) from None
    except UnicodeDecodeError as error:
        raise InputError(f"this is not UTF-8 text ({error.reason})", file=path) from None


@dataclass(frozen=True)
class Element:
    """An element of a launch file, whatever it was written in.

    Attributes:
        tag: its name.
        place: where it stands.
        attributes: name → text, number, truth value, or a list of them (YAML only).
        children: the elements in it.
    """

    tag: str
    place: Place
    attributes: Mapping[str, Any] = field(default_factory=dict)
    children: tuple[Element, ...] = ()

    def error(self, message: str, **more: Any) -> InputError:
        """An error that points at the element."""
        return InputError(f"<{self.tag}>: {message}", file=self.place.file, line=self.place.line, **more)

    def of(self, *tags: str) -> list[Element]:
        """The children with one of the names."""
        return [child for child in self.children if child.tag in tags]


class FrontEnd:
    """Makes actions of elements."""

    def description(self, root: Element) -> LaunchDescription:
        """The launch description of a file.

        Raises:
            InputError: an element or attribute that is not known, or one that is missing.
        """
        if root.tag != "launch":
            raise root.error("a launch file's outermost element is launch")
        description = LaunchDescription(self.actions(root.children))
        description.place = root.place
        return description

    def actions(self, elements: Iterable[Element]) -> list[Any]:
        """The actions of elements, in order."""
        return [self.action(element) for element in elements]

    def action(self, element: Element) -> Action:
        """The action of an element."""
        tag = element.tag.replace("-", "_")
        if tag in _OF_ROS_1 or "ns" in element.attributes or (tag == "node" and "type" in element.attributes):
            raise element.error("this is a ROS 1 launch file, and the twin reads those of ROS 2")
        if tag not in _ACTIONS:
            raise element.error("there is no such element", value=element.tag, valid=sorted(_ACTIONS))
        make, known = _ACTIONS[tag]
        known_all = {*known, "if", "unless"}
        for name in element.attributes:
            if name.replace("_", "-") not in {key.replace("_", "-") for key in known_all}:
                raise element.error(f"there is no attribute {name!r}", value=name, valid=sorted(known_all))
        try:
            action = make(self, element)
        except InputError as error:
            if error.file is not None:
                raise
            raise InputError(
                f"<{element.tag}>: {error.message}",
                file=element.place.file,
                line=element.place.line,
                valid=error.valid,
                value=error.value,
            ) from None
        action._condition = _condition(element)
        action.place = element.place
        return action

    # ROS's names, for launch files that read others by themselves

    @classmethod
    def parse_substitution(cls, value: str) -> list[Substitution]:
        """Text with ``$(…)`` in it as substitutions."""
        return parse_substitution(value)


def _subs(element: Element, name: str) -> list[Substitution]:
    """A required attribute."""
    value = _raw(element, name)
    if value is None:
        raise element.error(f"the attribute {name!r} is missing")
    return parse_substitution(_text(value))


def _optional(element: Element, name: str, default: Any = None) -> Any:
    value = _raw(element, name)
    return default if value is None else parse_substitution(_text(value))


def _raw(element: Element, name: str) -> Any:
    for spelled in (name, name.replace("_", "-"), name.replace("-", "_")):
        if spelled in element.attributes:
            return element.attributes[spelled]
    return None


def _text(value: Any) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    return str(value)


def _flag(element: Element, name: str, default: bool) -> bool:
    value = _raw(element, name)
    if value is None:
        return default
    word = _text(value).strip().lower()
    if word not in ("true", "false", "1", "0"):
        raise element.error(f"{name} is {value!r}, which is neither true nor false", valid=["true", "false"])
    return word in ("true", "1")


def _condition(element: Element) -> Any:
    if "if" in element.attributes and "unless" in element.attributes:
        raise element.error("if and unless cannot both be given")
    if "if" in element.attributes:
        return conditions.IfCondition(parse_substitution(_text(element.attributes["if"])))
    if "unless" in element.attributes:
        return conditions.UnlessCondition(parse_substitution(_text(element.attributes["unless"])))
    return None


def split_command_line(text: str) -> list[list[Substitution]]:
    """A command line as words, each a list of substitutions: only the text between them is split, quotes kept whole."""
    words: list[list[Substitution]] = []
    open_word: list[Substitution] | None = None
    for part in _parts_of_command_line(text):
        if part is None:
            if open_word is not None:
                words.append(open_word)
            open_word = None
        else:
            open_word = [*(open_word or []), part]
    if open_word is not None:
        words.append(open_word)
    return words


def _parts_of_command_line(text: str) -> Iterable[Substitution | None]:
    """Pieces of words; None where a word ends."""
    for part in parse_substitution(text):
        if not isinstance(part, TextSubstitution):
            yield part
            continue
        piece, quote, quoted = "", "", False
        for character in part.text:
            if quote:
                if character == quote:
                    quote = ""
                else:
                    piece += character
            elif character in "'\"" and part.text.count(character) > 1:
                quote, quoted = character, True
            elif character.isspace():
                if piece or quoted:
                    yield TextSubstitution(text=piece)
                piece, quoted = "", False
                yield None
            else:
                piece += character
        if piece or quoted:
            yield TextSubstitution(text=piece)


def _arg(front: FrontEnd, element: Element) -> Action:
    choices = [_text(choice.attributes.get("value", "")) for choice in element.of("choice")]
    name = _raw(element, "name")
    if name is None:
        raise element.error("the attribute 'name' is missing")
    return actions.DeclareLaunchArgument(
        _text(name),
        default_value=_optional(element, "default"),
        description=_text(_raw(element, "description") or ""),
        choices=choices or None,
    )


def _let(front: FrontEnd, element: Element) -> Action:
    return actions.SetLaunchConfiguration(_subs(element, "name"), _subs(element, "value"))


def _include(front: FrontEnd, element: Element) -> Action:
    for child in element.children:
        if child.tag not in ("arg", "let"):
            raise child.error("an include holds arg and let elements", value=child.tag, valid=["arg", "let"])
    pairs = [(_subs(child, "name"), _subs(child, "value")) for child in element.children]
    return include.IncludeLaunchDescription(
        include.AnyLaunchDescriptionSource(_subs(element, "file")), launch_arguments=pairs
    )


def _group(front: FrontEnd, element: Element) -> Action:
    kept = {child.attributes.get("name", ""): _subs(child, "value") for child in element.of("keep")}
    inside = [child for child in element.children if child.tag != "keep"]
    return actions.GroupAction(
        front.actions(inside),
        scoped=_flag(element, "scoped", True),
        forwarding=_flag(element, "forwarding", True),
        launch_configurations=kept,
    )


def _timer(front: FrontEnd, element: Element) -> Action:
    return actions.TimerAction(period=_subs(element, "period"), actions=front.actions(element.children))


def _process_options(element: Element) -> dict[str, Any]:
    options: dict[str, Any] = {
        name: _optional(element, name) for name in ("cwd", "output") if _raw(element, name) is not None
    }
    if _raw(element, "launch-prefix") is not None:
        options["prefix"] = _optional(element, "launch-prefix")
    variables = {_key(child, "name"): _subs(child, "value") for child in element.of("env")}
    if variables:
        options["additional_env"] = variables
    if _text(_raw(element, "on_exit") or "") == "shutdown":
        options["on_exit"] = [actions.Shutdown()]
    return options


def _key(element: Element, name: str) -> Any:
    return tuple(_subs(element, name))


def _executable(front: FrontEnd, element: Element) -> Action:
    cmd = _raw(element, "cmd")
    if cmd is None:
        raise element.error("the attribute 'cmd' is missing")
    return process_actions.ExecuteProcess(
        cmd=split_command_line(_text(cmd)),
        name=_optional(element, "name"),
        shell=_flag(element, "shell", False),
        **_process_options(element),
    )


def _node_options(element: Element) -> dict[str, Any]:
    for child in element.children:
        if child.tag not in ("param", "remap", "env", "composable_node", "extra_arg"):
            raise child.error(
                f"a {element.tag} holds no such element", value=child.tag, valid=["param", "remap", "env"]
            )
    return {
        **_process_options(element),
        "package": _optional(element, "pkg"),
        "name": _optional(element, "name", _optional(element, "node-name")),
        "namespace": _optional(element, "namespace"),
        "arguments": split_command_line(_text(_raw(element, "args") or "")),
        "ros_arguments": split_command_line(_text(_raw(element, "ros_args") or "")),
        "parameters": _parameters(element),
        "remappings": _remappings(element),
    }


def _node(front: FrontEnd, element: Element) -> Action:
    return ros_actions.Node(executable=_subs(element, "exec"), **_node_options(element))


def _lifecycle_node(front: FrontEnd, element: Element) -> Action:
    options = {key: value for key, value in _node_options(element).items() if value is not None}
    return ros_actions.LifecycleNode(executable=_subs(element, "exec"), **options)


def _container(front: FrontEnd, element: Element) -> Action:
    options = {key: value for key, value in _node_options(element).items() if value is not None}
    return ros_actions.ComposableNodeContainer(
        executable=_subs(element, "exec"), composable_node_descriptions=_composable_nodes(element), **options
    )


def _load_composable_node(front: FrontEnd, element: Element) -> Action:
    return ros_actions.LoadComposableNodes(
        composable_node_descriptions=_composable_nodes(element), target_container=_subs(element, "target")
    )


def _composable_nodes(element: Element) -> list[Any]:
    return [
        ros_actions.ComposableNode(
            package=_subs(child, "pkg"),
            plugin=_subs(child, "plugin"),
            name=_optional(child, "name"),
            namespace=_optional(child, "namespace"),
            parameters=_parameters(child),
            remappings=_remappings(child),
            condition=_condition(child),
        )
        for child in element.of("composable_node")
    ]


def _remappings(element: Element) -> list[Any]:
    return [(_subs(child, "from"), _subs(child, "to")) for child in element.of("remap")]


def _parameters(element: Element) -> list[Any]:
    entries: list[Any] = []
    for child in element.of("param"):
        if "from" in child.attributes:
            allow = _raw(child, "allow_substs")
            entries.append(
                parameters.ParameterFile(
                    _subs(child, "from"), allow_substs=False if allow is None else parse_substitution(_text(allow))
                )
            )
        elif "name" in child.attributes:
            entries.append({_key(child, "name"): _parameter_value(child)})
        else:
            raise child.error("a param has a name or a file (from)")
    return entries


def _parameter_value(element: Element) -> Any:
    nested = element.of("param")
    if nested:
        return {_key(child, "name"): _parameter_value(child) for child in nested}
    value = _raw(element, "value")
    if value is None:
        raise element.error("the attribute 'value' is missing")
    kind = _raw(element, "type")
    if kind is not None and _text(kind) not in _TYPES:
        raise element.error(f"type is {kind!r}, which is not known", value=_text(kind), valid=_TYPES)
    value_type = None if kind is None else _TYPES[_text(kind)]
    separator = _raw(element, "sep") or _raw(element, "value-sep")
    if separator is not None:
        return [parse_substitution(part) for part in _text(value).split(_text(separator))]
    if isinstance(value, str):
        return parameters.ParameterValue(_one(parse_substitution(value)), value_type=value_type)
    if isinstance(value, Sequence):
        return [_one(parse_substitution(item)) if isinstance(item, str) else item for item in value]
    return value if value_type is None else parameters.ParameterValue(value, value_type=value_type)


def _one(parts: list[Substitution]) -> Any:
    """Substitutions as one, so that nothing takes them for a list of values."""
    return _Joined(parts)


class _Joined(Substitution):
    def __init__(self, parts: list[Substitution]):
        self._parts = parts

    def perform(self, context: Any) -> str:
        return "".join(part.perform(context) for part in self._parts)


def _set_env(front: FrontEnd, element: Element) -> Action:
    return actions.SetEnvironmentVariable(_subs(element, "name"), _subs(element, "value"))


def _append_env(front: FrontEnd, element: Element) -> Action:
    return actions.AppendEnvironmentVariable(
        _subs(element, "name"),
        _subs(element, "value"),
        prepend=_flag(element, "prepend", False),
        separator=_optional(element, "separator", ":"),
    )


def _set_parameter(front: FrontEnd, element: Element) -> Action:
    return ros_actions.SetParameter(_subs(element, "name"), _parameter_value(element))


def _log(front: FrontEnd, element: Element) -> Action:
    level = _optional(element, "level")
    message = _subs(element, "message")
    return actions.LogInfo(msg=message) if level is None else actions.Log(msg=message, level=level)


def _log_at(make: Callable[..., Action]) -> Callable[[FrontEnd, Element], Action]:
    return lambda front, element: make(msg=_subs(element, "message"))


def _gz(make: Callable[..., Action]) -> Callable[[FrontEnd, Element], Action]:
    return lambda front, element: make(
        **{name: _subs(element, name) for name in element.attributes if name not in ("if", "unless")}
    )


_OF_ROS_1 = ("env", "machine", "param", "remap", "rosparam", "test")

_PROCESS_ATTRIBUTES = (
    *("cwd", "name", "launch-prefix", "output", "respawn", "respawn_delay", "respawn_max_retries", "shell"),
    *("sigkill_timeout", "sigterm_timeout", "emulate_tty", "on_exit", "log_cmd", "cached_output"),
)
_NODE_ATTRIBUTES = (
    *_PROCESS_ATTRIBUTES,
    *("pkg", "exec", "args", "ros_args", "namespace", "node-name", "exec_name", "machine", "autostart"),
)
_GZ_SERVER = ("world_sdf_file", "world_sdf_string", "container_name", "create_own_container", "use_composition")
_GZ_SPAWN = (
    *("world", "file", "model_string", "topic", "entity_name", "allow_renaming", "x", "y", "z", "roll", "pitch", "yaw"),
)
_GZ_BRIDGE = (
    *("bridge_name", "config_file", "container_name", "create_own_container", "namespace", "use_composition"),
    *("use_respawn", "log_level", "bridge_params", "extra_bridge_params"),
)

# Element → what makes the action, and its attributes.
_ACTIONS: dict[str, tuple[Callable[[FrontEnd, Element], Action], tuple[str, ...]]] = {
    "append_env": (_append_env, ("name", "value", "prepend", "separator")),
    "arg": (_arg, ("name", "default", "description", "value")),
    "executable": (_executable, ("cmd", *_PROCESS_ATTRIBUTES)),
    "group": (_group, ("scoped", "forwarding")),
    "gz_server": (_gz(gz_actions.GzServer), _GZ_SERVER),
    "gz_spawn_model": (_gz(gz_actions.GzSpawnModel), _GZ_SPAWN),
    "include": (_include, ("file",)),
    "let": (_let, ("name", "value")),
    "lifecycle_node": (_lifecycle_node, _NODE_ATTRIBUTES),
    "load_composable_node": (_load_composable_node, ("target",)),
    "log": (_log, ("message", "level")),
    "log_debug": (_log_at(actions.LogDebug), ("message",)),
    "log_error": (_log_at(actions.LogError), ("message",)),
    "log_info": (_log_at(actions.LogInfo), ("message",)),
    "log_warning": (_log_at(actions.LogWarning), ("message",)),
    "node": (_node, _NODE_ATTRIBUTES),
    "node_container": (_container, _NODE_ATTRIBUTES),
    "pop_environment": (lambda front, element: actions.PopEnvironment(), ()),
    "push_environment": (lambda front, element: actions.PushEnvironment(), ()),
    "push_ros_namespace": (
        lambda front, element: ros_actions.PushRosNamespace(_subs(element, "namespace")),
        ("namespace",),
    ),
    "reset": (lambda front, element: actions.ResetLaunchConfigurations(), ()),
    "reset_env": (lambda front, element: actions.ResetEnvironment(), ()),
    "ros_gz_bridge": (_gz(gz_actions.RosGzBridge), _GZ_BRIDGE),
    "ros_timer": (_timer, ("period",)),
    "set_env": (_set_env, ("name", "value")),
    "set_parameter": (_set_parameter, ("name", "value", "type", "sep", "value-sep")),
    "set_parameters_from_file": (
        lambda front, element: ros_actions.SetParametersFromFile(_subs(element, "filename")),
        ("filename",),
    ),
    "set_remap": (
        lambda front, element: ros_actions.SetRemap(_subs(element, "from"), _subs(element, "to")),
        ("from", "to"),
    ),
    "set_ros_log_dir": (
        lambda front, element: ros_actions.SetROSLogDir(_subs(element, "new_log_dir")),
        ("new_log_dir",),
    ),
    "set_use_sim_time": (
        lambda front, element: ros_actions.SetUseSimTime(_parameter_value(element)),
        ("value", "type"),
    ),
    "shutdown": (
        lambda front, element: actions.Shutdown(reason=_optional(element, "reason", "reason not given")),
        ("reason",),
    ),
    "timer": (_timer, ("period",)),
    "unset_env": (lambda front, element: actions.UnsetEnvironmentVariable(_subs(element, "name")), ("name",)),
}
