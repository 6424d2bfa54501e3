"""Types as they go over a wire: CDR bytes, hashes (RIHS01, of REP 2011 and REP 2016), texts; services and actions, too.

A service ``pkg/srv/X`` has the messages ``pkg/srv/X_Request`` and ``X_Response``. An action ``pkg/action/X`` has the
messages ``pkg/action/X_Goal``, ``X_Result``, ``X_Feedback`` and ``X_FeedbackMessage`` and the services
``pkg/action/X_SendGoal`` and ``X_GetResult``.
"""

import ast
import re
from functools import cache
from typing import Any

import yaml

from drake_twin.messages import DEFAULTS, EMPTY, base_packages, field_value, message, type_store
from drake_twin.messages.definitions import DEFINITIONS
from drake_twin.messages.interface_texts import interface_names, interface_text

_FIELD_WITH_DEFAULT = re.compile(r"\s*(?P<type>[\w/]\S*)\s+(?P<name>\w+)\s+(?P<value>[^\s=#].*)")
_MESSAGE_OF_PACKAGES = re.compile(r"^(\w+)/(\w+)(?=\S* )", re.MULTILINE)
_TEXT_OR_COMMENT = re.compile(r"""#.*|("(?:\\.|[^"])*"|'(?:\\.|[^'])*'|[^#])""")

# Types of rosbags' store with a char, which is a uint8 in ROS 2's hashes.
_WITH_CHAR = {
    "service_msgs/msg/ServiceEventInfo": (
        "uint8 event_type\nbuiltin_interfaces/Time stamp\nchar[16] client_gid\nint64 sequence_number\n"
    ),
    "std_msgs/msg/Char": "char data\n",
    "rmw_dds_common/msg/Gid": "char[16] data\n",
}
# Packages whose types the twin sends and answers with, beside those of rosbags' store.
_OF_THE_TWIN = (
    *("ackermann_msgs", "actuator_msgs", "control_msgs", "controller_manager_msgs", "gazebo_msgs", "ros_gz_interfaces"),
    *("simulation_interfaces", "std_srvs", "topic_tools_interfaces"),
)
_CHAR = re.compile(r"^\s*char\b", re.MULTILINE)


def type_hash(name: str) -> str:
    """Return the hash of a message, a service, or the service of an action, for example ``RIHS01_eeff2cd6…``.

    Raises:
        ValueError: If the type is unknown.
    """
    return str(_known(name).hash_rihs01(name))


def definition(name: str) -> str:
    """Return a message's text, with those of the messages in it.

    Raises:
        ValueError: If the type is unknown.
    """
    return str(_known(name).generate_msgdef(name, ros_version=2)[0])


def type_names() -> list[str]:
    """Return the names of all known messages, services and actions, sorted; not all of their parts."""
    return sorted({*_store().fielddefs, *interface_names()})


def make(name: str, data: Any) -> Any:
    """Make a message from its fields; those that are missing have ROS's default values.

    Raises:
        ValueError: If the type is unknown, or the data does not fit it.
    """
    _known(name)
    return message(name, data)


def knows(name: str) -> bool:
    """Return whether a message, service or action is known."""
    _load(name)
    return _is_registered(name)


def is_settled(name: str) -> bool:
    """Return whether a message, service or action is used already or by the twin itself: files of it come too late."""
    if is_of_the_twin(name.partition("/")[0]):
        _load(name)
    return _is_registered(name)


def is_of_the_twin(package: str) -> bool:
    """Return whether the twin itself uses types of a package, which do not depend on files of a workspace."""
    return package in _OF_THE_TWIN or package in base_packages()


def known_names(package: str, kind: str) -> list[str]:
    """Return the messages, services or actions of a package, without their parts; ``kind`` is ``msg`` and so on."""
    start = f"{package}/{kind}/"
    names = [name.removeprefix(start) for name in _store().fielddefs if name.startswith(start)]
    if kind == "action":
        names = [name.removesuffix("_Goal") for name in names if name.endswith("_Goal")]
    elif kind == "srv":
        names = [name for name in names if f"{name}_Request" in names]
    return sorted({*names, *(name.removeprefix(start) for name in interface_names() if name.startswith(start))})


def known_packages() -> frozenset[str]:
    """Return the packages that have a type."""
    return frozenset(name.partition("/")[0] for name in (*_store().fielddefs, *interface_names()))


def class_of(name: str) -> Any:
    """Return the class that drake_twin's own messages of a type are of.

    Raises:
        ValueError: If the type is unknown.
    """
    return _known(name).types[name]


def fields_of(name: str) -> tuple[Any, Any]:
    """Return a message's constants (name, type, value) and its fields: name, and rosbags' (node type, details).

    Raises:
        ValueError: If the type is unknown.
    """
    constants, fields = _known(name).fielddefs[name]
    return constants, fields


def default_values(name: str) -> dict[str, Any]:
    """Return the default values that a message's definition gives to fields, as the twin's messages have them.

    Raises:
        ValueError: If the type is unknown.
    """
    _known(name)
    return dict(DEFAULTS.get(name, {}))


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
            value = yaml.safe_load(text)  # flags, and texts without quotes
    elif len(text) > 1 and text[0] in ("'", '"') and text[-1] == text[0]:
        value = text[1:-1].replace(f"\\{text[0]}", text[0])
    if match["type"] == "bool" and value in (0, 1):
        value = bool(value)
    return {name: field_value(dict(fields)[name], value, f"{name}.")}


def make_response(service: str, fields: Any, reason: str = "") -> Any:
    """Make a service's response from its fields; a reason stands in the field that it has for one.

    Raises:
        ValueError: If the type is unknown, or the fields do not fit it.
    """
    response = make(f"{service}_Response", fields)
    for place, name in (
        (response, "message"),
        (response, "status_message"),
        (getattr(response, "result", None), "error_message"),
    ):
        if reason and isinstance(getattr(place, name, None), str):
            setattr(place, name, reason)
    return response


def serialize(data: Any) -> bytes:
    """Return a message's CDR bytes, little-endian, with the header of four bytes."""
    return bytes(_store().serialize_cdr(data, data.__msgtype__))


def deserialize(name: str, data: bytes) -> Any:
    """Return the message in CDR bytes that another program has made.

    Raises:
        ValueError: If the type is unknown, or they are not the bytes of such a message.
    """
    store = _known(name)
    try:
        return store.deserialize_cdr(data, name)
    except Exception as error:  # rosbags' generated code does not say what it raises
        raise ValueError(f"{len(data)} bytes are not a {name} ({type(error).__name__})") from error


def _known(name: str) -> Any:
    store = _store()
    if name not in store.fielddefs:
        _load(name)
    if name not in store.fielddefs:
        raise ValueError(f"unknown type {name!r}")
    return store


@cache
def _store() -> Any:
    """Return the store, in which services and actions are structures that only hashing needs."""
    store = type_store()
    for name, text in _WITH_CHAR.items():
        del store.fielddefs[name]
        _register(store, name, text)
    for name, texts in _actions_of_controllers().items():
        _register_action(store, name, *texts)
    return store


def _actions_of_controllers() -> dict[str, tuple[str, ...]]:
    """Return the actions whose messages the twin knows already, by their texts."""
    names = [name.removesuffix("_Goal") for name in DEFINITIONS if name.endswith("_Goal")]
    return {name: tuple(DEFINITIONS[f"{name}_{part}"] for part in ("Goal", "Result", "Feedback")) for name in names}


def add_definition(name: str, text: str) -> None:
    """Add a user's own type.

    Args:
        name: Its name, for example ``my_msgs/msg/Speeds``, ``my_msgs/srv/Start`` or ``my_msgs/action/Drive``.
        text: The text of its ``.msg``, ``.srv`` or ``.action`` file.

    Raises:
        ValueError: If the text is not one of such a type.
    """
    if not _is_registered(name):
        _add(name, text)


def _is_registered(name: str) -> bool:
    store = _store()
    return name in store.fielddefs or f"{name}_Goal" in store.fielddefs


def _load(name: str) -> None:
    """Register a type of the data, or the type that a request, a result or the like is of, and those in it."""
    while (text := interface_text(name)) is None:
        name, part, _ = name.rpartition("_")
        if not part:
            return
    if _is_registered(name):
        return
    for package, own in _MESSAGE_OF_PACKAGES.findall(text):
        _load(f"{package}/msg/{own}")
    _add(name, text)


def _add(name: str, text: str) -> None:
    kind = name.split("/")[1]
    parts = _parts(text)
    if len(parts) != {"msg": 1, "srv": 2, "action": 3}[kind]:
        raise ValueError(f"{name}: {len(parts)} parts between lines of ---")
    store = _store()
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
    return get_types_from_msg(_CHAR.sub("uint8", text), whole)[whole]


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
