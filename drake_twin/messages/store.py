"""rosbags' type store of ROS 2 Jazzy, into which types are loaded when they are first asked for.

They come from the data of `drake_twin.messages.interface_texts` and from the users' own files. Services and actions are
structures in it that only hashing needs.
"""

import ast
import contextlib
import logging
import re
from functools import cache
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from drake_twin.messages.field_values import field_value
from drake_twin.messages.interface_texts import interface_text

EMPTY = "structure_needs_at_least_one_member"  # the only field of a message without fields

# ROS's default values of fields, by type, where they are not false, zero or nothing: those of rosbags' store, which
# leaves them out, and those of the types that are loaded.
DEFAULTS: dict[str, dict[str, Any]] = {
    "geometry_msgs/msg/Quaternion": {"w": 1.0},
    "sensor_msgs/msg/NavSatStatus": {"status": -2},
}

# Packages whose types the twin sends and answers with, beside those of rosbags' store.
OF_THE_TWIN = (
    *("ackermann_msgs", "actuator_msgs", "control_msgs", "controller_manager_msgs", "gazebo_msgs", "ros_gz_interfaces"),
    *("simulation_interfaces", "std_srvs", "topic_tools_interfaces"),
)

_STORE_FILE = ("typesys", "stores", "ros2_jazzy.py")
_NAME_IN_STORE = re.compile(r"^    '(\w+/msg/\w+)':", re.MULTILINE)
_WIDE = re.compile(r"^[ \t]*wstring\b", re.MULTILINE)
_log = logging.getLogger(__name__)
_CHAR = re.compile(r"^\s*char\b", re.MULTILINE)  # a uint8 in ROS 2's hashes
_FIELD_WITH_DEFAULT = re.compile(r"\s*(?P<type>[\w/]\S*)\s+(?P<name>\w+)\s+(?P<value>[^\s=#].*)")
_MESSAGE_OF_PACKAGES = re.compile(r"^(\w+)/(\w+)(?=\S* )", re.MULTILINE)
_TEXT_OR_COMMENT = re.compile(r"""#.*|("(?:\\.|[^"])*"|'(?:\\.|[^'])*'|[^#])""")


@cache
def type_store() -> Any:
    """Return the rosbags ``Typestore``; a type of other packages is in it once it has been loaded."""
    store = _base_store()
    for name, (constants, fields) in store.fielddefs.items():
        store.fielddefs[name] = constants, [(own, _without_char(field)) for own, field in fields]
    return store


def _base_store() -> Any:
    from rosbags.typesys import Stores, get_typestore

    return get_typestore(Stores.ROS2_JAZZY)


def _without_char(field: tuple[Any, Any]) -> tuple[Any, Any]:
    from rosbags.interfaces import Nodetype

    node, details = field
    if node == Nodetype.BASE and details[0] == "char":
        return node, ("uint8", details[1])
    return (node, (_without_char(details[0]), details[1])) if node in (Nodetype.ARRAY, Nodetype.SEQUENCE) else field


def store_with(name: str) -> Any:
    """Return the store with a type loaded.

    Raises:
        ValueError: If the type is unknown.
    """
    store = type_store()
    if name not in store.fielddefs:
        load(name)
    if name not in store.fielddefs:
        raise ValueError(f"unknown type {name!r}")
    return store


@cache
def base_types() -> frozenset[str]:
    """Return the names of the messages that rosbags' store has without any being loaded.

    They are read from its module's text: importing the module takes 0.1 s.
    """
    package = find_spec("rosbags")
    for folder in () if package is None else package.submodule_search_locations or ():
        with contextlib.suppress(OSError):
            text = Path(folder, *_STORE_FILE).read_text(encoding="utf-8")
            if names := frozenset(_NAME_IN_STORE.findall(text)):
                return names
    return frozenset(_base_store().types)


@cache
def _base_packages() -> frozenset[str]:
    return frozenset(name.partition("/")[0] for name in base_types())


def load(name: str) -> None:
    """Load a type of the data, or the one that a request, a result or the like is a part of, and the messages in it."""
    whole = name
    while (text := interface_text(name)) is None:
        name, part, _ = name.rpartition("_")
        if not part:
            _describe_known(whole)
            return
    if is_registered(name):
        return
    for package, own in _MESSAGE_OF_PACKAGES.findall(text):
        load(f"{package}/msg/{own}")
    _add(name, text)


def is_registered(name: str) -> bool:
    """Return whether a message, service or action is loaded."""
    store = type_store()
    return name in store.fielddefs or f"{name}_Goal" in store.fielddefs


def is_settled(name: str) -> bool:
    """Return whether a message, service or action is used already or by the twin itself: files of it come too late."""
    if is_of_the_twin(name.partition("/")[0]):
        load(name)
    return is_registered(name)


def is_of_the_twin(package: str) -> bool:
    """Return whether the twin itself uses types of a package, which do not depend on files of a workspace."""
    return package in OF_THE_TWIN or package in _base_packages()


def add_definition(name: str, text: str) -> None:
    """Add a user's own type.

    Args:
        name: Its name, for example ``my_msgs/msg/Speeds``, ``my_msgs/srv/Start`` or ``my_msgs/action/Drive``.
        text: The text of its ``.msg``, ``.srv`` or ``.action`` file.

    Raises:
        ValueError: If the text is not one of such a type.
    """
    if not is_registered(name):
        _add(name, text)


def _add(name: str, text: str) -> None:
    kind = name.split("/")[1]
    parts = _parts(text)
    if len(parts) != {"msg": 1, "srv": 2, "action": 3}[kind]:
        raise ValueError(f"{name}: {len(parts)} parts between lines of ---")
    store = type_store()
    if kind == "msg":
        _register(store, name, text)
    elif kind == "srv":
        _register_service(store, name, *parts)
    else:
        _register_action(store, name, *parts)


def _parts(text: str) -> list[str]:
    parts = [""]
    for line in text.splitlines(keepends=True):
        if line.strip() == "---":
            parts.append("")
        else:
            parts[-1] += line
    return parts


def _register(store: Any, name: str, text: str) -> None:
    """Register a message."""
    if name in store.fielddefs:
        return
    constants, fields = fields_in(name, text or f"uint8 {EMPTY}\n")
    store.register({name: (constants, fields)})
    for line in text.splitlines():
        if default := default_in(line, fields):
            DEFAULTS.setdefault(name, {}).update(default)


def fields_in(name: str, text: str) -> Any:
    """Return the constants and fields in a text, as `fields_of` does.

    Args:
        name: The type whose package short names in it are of.
        text: Lines of a ``.msg`` file.
    """
    from rosbags.typesys import get_types_from_msg

    package, _, own = name.split("/")
    whole = f"{package}/msg/{own}"  # rosbags takes the folder msg for granted
    narrow = _WIDE.sub("string", text)
    if narrow != text:
        _log.warning(
            "%s has a wstring: nodes exchange it, and over a wire it is a string, which ROS does not take", name
        )
    return get_types_from_msg(_CHAR.sub("uint8", narrow), whole)[whole]


def _register_service(store: Any, name: str, request: str, response: str) -> None:
    _register(store, f"{name}_Request", request)
    _register(store, f"{name}_Response", response)
    _describe_service(store, name)


def _register_action(store: Any, name: str, goal: str, result: str, feedback: str) -> None:
    for part, text in (("Goal", goal), ("Result", result), ("Feedback", feedback)):
        _register(store, f"{name}_{part}", text)
    _register(store, f"{name}_SendGoal_Request", f"unique_identifier_msgs/UUID goal_id\n{name}_Goal goal\n")
    _register(store, f"{name}_SendGoal_Response", "bool accepted\nbuiltin_interfaces/Time stamp\n")
    _register(store, f"{name}_GetResult_Request", "unique_identifier_msgs/UUID goal_id\n")
    _register(store, f"{name}_GetResult_Response", f"int8 status\n{name}_Result result\n")
    _register(store, f"{name}_FeedbackMessage", f"unique_identifier_msgs/UUID goal_id\n{name}_Feedback feedback\n")
    _describe_service(store, f"{name}_SendGoal")
    _describe_service(store, f"{name}_GetResult")


def default_in(line: str, fields: Any) -> dict[str, Any]:
    """Return the default value that a line of a definition gives to one of its fields, if it gives one.

    Raises:
        ValueError: If the value does not fit the field.
    """
    match = _FIELD_WITH_DEFAULT.match(line)
    if match is None:
        return {}
    name, text = match["name"], "".join(_TEXT_OR_COMMENT.findall(match["value"])).strip()
    value: Any = text
    if "[" in match["type"] or "string" not in match["type"]:
        try:
            value = ast.literal_eval(text)
        except (SyntaxError, ValueError):
            import yaml

            value = yaml.safe_load(text)  # flags, and texts without quotes
    elif len(text) > 1 and text[0] in ("'", '"') and text[-1] == text[0]:
        value = text[1:-1].replace(f"\\{text[0]}", text[0])
    if match["type"] == "bool" and value in (0, 1):
        value = bool(value)
    return {name: field_value(dict(fields)[name], value, f"{name}.")}


def _describe_known(name: str) -> None:
    """Describe the service of an event, where rosbags' store has it."""
    service = name.removesuffix("_Event")
    store = type_store()
    if name != service and f"{service}_Request" in store.fielddefs:
        _describe_service(store, service)


def _describe_service(store: Any, name: str) -> None:
    """Describe a service as the structure that its hash is of: request, response and event."""
    from rosbags.interfaces import Nodetype

    request, response = ((Nodetype.NAME, f"{name}_{part}") for part in ("Request", "Response"))
    event = [
        ("info", (Nodetype.NAME, "service_msgs/msg/ServiceEventInfo")),
        ("request", (Nodetype.SEQUENCE, (request, 1))),
        ("response", (Nodetype.SEQUENCE, (response, 1))),
    ]
    store.fielddefs[f"{name}_Event"] = ([], event)
    whole = [("request_message", request), ("response_message", response)]
    store.fielddefs[name] = ([], [*whole, ("event_message", (Nodetype.NAME, f"{name}_Event"))])
