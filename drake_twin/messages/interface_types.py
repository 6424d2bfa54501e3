"""Types as they go over a wire: CDR bytes, hashes (RIHS01, of REP 2011 and REP 2016), texts; services and actions, too.

A service ``pkg/srv/X`` has the messages ``pkg/srv/X_Request`` and ``X_Response``. An action ``pkg/action/X`` has the
messages ``pkg/action/X_Goal``, ``X_Result``, ``X_Feedback`` and ``X_FeedbackMessage`` and the services
``pkg/action/X_SendGoal`` and ``X_GetResult``.
"""

from functools import cache
from typing import Any

from drake_twin.messages import message, type_store
from drake_twin.messages.definitions import DEFINITIONS
from drake_twin.messages.service_definitions import ACTIONS, MESSAGES, SERVICES

_EVENT_INFO = "uint8 event_type\nbuiltin_interfaces/Time stamp\nuint8[16] client_gid\nint64 sequence_number\n"


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


def make(name: str, data: Any) -> Any:
    """Make a message from its fields; those that are missing have ROS's default values.

    Raises:
        ValueError: If the type is unknown, or the data does not fit it.
    """
    _known(name)
    return message(name, data)


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
        raise ValueError(f"unknown type {name!r}")
    return store


@cache
def _store() -> Any:
    """Return the store with all messages, and services and actions as structures that only hashing needs."""
    store = type_store()
    for name, text in MESSAGES.items():
        _register(store, name, text)
    # rosbags has the client's id as char, which ROS 2 hashes as uint8.
    del store.fielddefs["service_msgs/msg/ServiceEventInfo"]
    _register(store, "service_msgs/msg/ServiceEventInfo", _EVENT_INFO)
    for name, (request, response) in SERVICES.items():
        _register_service(store, name, request, response)
    for name, texts in (ACTIONS | _actions_of_controllers()).items():
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
    """Register a message; rosbags takes the folder ``msg`` for granted, unless it is ``action``."""
    from rosbags.typesys import get_types_from_msg

    if name in store.fielddefs:
        return
    package, _, own = name.split("/")
    found = get_types_from_msg(text or "uint8 structure_needs_at_least_one_member\n", f"{package}/msg/{own}")
    store.register({name: found[f"{package}/msg/{own}"]})


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
