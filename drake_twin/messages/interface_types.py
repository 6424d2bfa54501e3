"""Types as they go over a wire: CDR bytes, hashes (RIHS01, of REP 2011 and REP 2016), texts; services and actions, too.

A service ``pkg/srv/X`` has the messages ``pkg/srv/X_Request`` and ``X_Response``. An action ``pkg/action/X`` has the
messages ``pkg/action/X_Goal``, ``X_Result``, ``X_Feedback`` and ``X_FeedbackMessage`` and the services
``pkg/action/X_SendGoal`` and ``X_GetResult``.
"""

from typing import Any

from drake_twin.messages import message
from drake_twin.messages.interface_texts import interface_names
from drake_twin.messages.store import DEFAULTS, is_registered, load, store_with, type_store


def type_hash(name: str) -> str:
    """Return the hash of a message, a service, or the service of an action, for example ``RIHS01_eeff2cd6…``.

    Raises:
        ValueError: If the type is unknown.
    """
    return str(store_with(name).hash_rihs01(name))


def definition(name: str) -> str:
    """Return a message's text, with those of the messages in it.

    Raises:
        ValueError: If the type is unknown.
    """
    return str(store_with(name).generate_msgdef(name, ros_version=2)[0])


def type_names() -> list[str]:
    """Return the names of all known messages, services and actions, sorted; not all of their parts."""
    return sorted({*type_store().fielddefs, *interface_names()})


def make(name: str, data: Any) -> Any:
    """Make a message from its fields; those that are missing have ROS's default values.

    Raises:
        ValueError: If the type is unknown, or the data does not fit it.
    """
    store_with(name)
    return message(name, data)


def knows(name: str) -> bool:
    """Return whether a message, service or action is known."""
    load(name)
    return is_registered(name)


def known_names(package: str, kind: str) -> list[str]:
    """Return the messages, services or actions of a package, without their parts; ``kind`` is ``msg`` and so on."""
    start = f"{package}/{kind}/"
    names = [name.removeprefix(start) for name in type_store().fielddefs if name.startswith(start)]
    if kind == "action":
        names = [name.removesuffix("_Goal") for name in names if name.endswith("_Goal")]
    elif kind == "srv":
        names = [name for name in names if f"{name}_Request" in names]
    return sorted({*names, *(name.removeprefix(start) for name in interface_names() if name.startswith(start))})


def known_packages() -> frozenset[str]:
    """Return the packages that have a type."""
    return frozenset(name.partition("/")[0] for name in (*type_store().fielddefs, *interface_names()))


def class_of(name: str) -> Any:
    """Return the class that drake_twin's own messages of a type are of.

    Raises:
        ValueError: If the type is unknown.
    """
    store = store_with(name)
    if name not in store.types and name.endswith("_Event"):  # a service's, made once it is asked for
        event = store.fielddefs.pop(name)
        store.register({name: event})
    return store.types[name]


def fields_of(name: str) -> tuple[Any, Any]:
    """Return a message's constants (name, type, value) and its fields: name, and rosbags' (node type, details).

    Raises:
        ValueError: If the type is unknown.
    """
    constants, fields = store_with(name).fielddefs[name]
    return constants, fields


def default_values(name: str) -> dict[str, Any]:
    """Return the default values that a message's definition gives to fields, as the twin's messages have them.

    Raises:
        ValueError: If the type is unknown.
    """
    store_with(name)
    return dict(DEFAULTS.get(name, {}))


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
    return bytes(type_store().serialize_cdr(data, data.__msgtype__))


def deserialize(name: str, data: bytes) -> Any:
    """Return the message in CDR bytes that another program has made.

    Raises:
        ValueError: If the type is unknown, or they are not the bytes of such a message.
    """
    store = store_with(name)
    try:
        return store.deserialize_cdr(data, name)
    except Exception as error:  # rosbags' generated code does not say what it raises
        raise ValueError(f"{len(data)} bytes are not a {name} ({type(error).__name__})") from error
