"""ROS messages, services and actions as the Python classes that rosidl_generator_py makes of them.

`message_class` makes the class of a message that drake_twin knows; `service_class` and `action_class` those that hold
the classes of a service's or an action's messages. The same name always gives the same class.
"""

import re
from functools import cache
from operator import attrgetter
from typing import TYPE_CHECKING, Any, ClassVar, cast

from drake_twin.messages import interface_types
from drake_twin.messages.store import EMPTY
from drake_twin.nodes.message_elements import BOOLEAN, OCTET, Element, integer, real, string
from drake_twin.nodes.message_fields import Field, ListField, NumberArray, NumberSequence


class _Sealed(type):
    """The class of messages' classes, whose constants and default values cannot be changed."""

    def __setattr__(cls, name: str, value: Any) -> None:
        if name.isupper() and name in vars(cls):
            raise AttributeError(f"{name!r} of {cls.__name__!r} has no setter")
        super().__setattr__(name, value)


class Message(metaclass=_Sealed):
    """The base of all messages: keyword arguments for the fields, and ``check_fields`` (see the fields)."""

    __slots__ = ("_check_fields",)
    __hash__ = None  # type: ignore[assignment]

    __ros_type__: ClassVar[str]
    __ros_fields__: ClassVar[dict[str, Field]]
    _fields_and_field_types: ClassVar[dict[str, str]]

    def __init__(self, *, check_fields: Any = None, **values: Any):
        fields = self.__ros_fields__
        if check_fields is not False and not values.keys() <= fields.keys():
            unknown = ", ".join(sorted(values.keys() - fields.keys()))
            raise AssertionError(f"Invalid arguments passed to constructor: {unknown}")
        self._check_fields = check_fields
        for name, field in fields.items():
            if name not in values:
                value = field.default()
            elif check_fields is False:
                value = field.unchecked(values[name])
            else:
                value = field.constructed(values[name], strictly=check_fields is True)
            setattr(self, field.slot, value)

    def __repr__(self) -> str:
        shown = (f"{name}={field.shown(getattr(self, field.slot))}" for name, field in self.__ros_fields__.items())
        return f"{type(self).__module__.rpartition('.')[0]}.{type(self).__name__}({', '.join(shown)})"

    def __eq__(self, other: object) -> bool:
        return isinstance(other, type(self)) and not any(
            field.differs(getattr(self, field.slot), getattr(other, field.slot))
            for field in self.__ros_fields__.values()
        )

    if TYPE_CHECKING:  # the fields

        def __getattr__(self, name: str) -> Any: ...
        def __setattr__(self, name: str, value: Any) -> None: ...

    @classmethod
    def get_fields_and_field_types(cls) -> dict[str, str]:
        """Return the type of each field."""
        return dict(cls._fields_and_field_types)


def _submessage(name: str) -> Element:
    """Return a message in a field of another one."""
    package, _, own = name.split("/")
    cls = message_class(name)
    return Element(
        f"{package}/{own}",
        own,
        cls,
        lambda value: isinstance(value, cls),
        f"a sub message of type '{own}'",
        to_wire=to_wire,
        from_wire=lambda data: from_wire(name, data),
    )


def to_wire(message: Message) -> Any:
    """Return a message as `Twin.publish` takes it; it shares nothing with the message.

    Raises:
        AssertionError: If a list in it holds what it must not, or an unchecked field does.
    """
    values: dict[str, Any] = {}
    for name, field in message.__ros_fields__.items():
        value = getattr(message, field.slot)
        if field.is_open or message._check_fields is False:
            field.checked(value)
        values[name] = field.to_wire(value)
    return interface_types.class_of(message.__ros_type__)(**(values or {EMPTY: 0}))


def from_wire(name: str, data: Any) -> Message:
    """Return one of the twin's messages as its class that nodes see; it shares nothing with it.

    Args:
        name: Its type, for example ``geometry_msgs/msg/Twist``.
        data: What `Twin.subscribe` hands over.
    """
    cls = message_class(name)
    message = cls.__new__(cls)
    message._check_fields = None
    for field in cls.__ros_fields__.values():
        setattr(message, field.slot, field.from_wire(getattr(data, field.name)))
    return message


def type_name(cls: type) -> str:
    """Return the type of a class of a message, a service or an action, for example ``geometry_msgs/msg/Twist``.

    Raises:
        TypeError: If the class is another one.
    """
    name = getattr(cls, "__ros_type__", None)
    if name is None:
        raise TypeError(f"{cls!r} is neither a message, a service nor an action of ROS")
    return str(name)


@cache
def message_class(name: str) -> type[Message]:
    """Return the class of a message.

    Args:
        name: Its type, for example ``geometry_msgs/msg/Twist`` or ``std_srvs/srv/Trigger_Request``.

    Raises:
        ValueError: If drake_twin does not know the type.
    """
    constants, descriptions = interface_types.fields_of(name)
    defaults = interface_types.default_values(name)
    fields = {}
    for own, description in descriptions:
        if own != EMPTY:
            fields[own] = _field(own, description, defaults)
    content: dict[str, Any] = {
        "__slots__": tuple(field.slot for field in fields.values()),
        "__module__": module_name(name),
        "__doc__": f"The message {name}.",
        "__ros_type__": name,
        "__ros_fields__": fields,
        "_fields_and_field_types": {own: field.type_text for own, field in fields.items()},
    }
    content |= {constant: bytes((value,)) if kind == "byte" else value for constant, kind, value in constants}
    content |= {f"{own.upper()}__DEFAULT": fields[own].default() for own in defaults}
    content |= {own: property(attrgetter(field.slot), _setter(field)) for own, field in fields.items()}
    return cast("type[Message]", _Sealed(name.rpartition("/")[2], (Message,), content))


@cache
def service_class(name: str) -> type:
    """Return the class that holds a service's messages, for example ``std_srvs/srv/Trigger``.

    Raises:
        ValueError: If drake_twin does not know the type.
    """
    return _holder(
        name, "Service", {part: message_class(f"{name}_{part}") for part in ("Request", "Response", "Event")}
    )


@cache
def action_class(name: str) -> type:
    """Return the class that holds an action's messages, for example ``control_msgs/action/FollowJointTrajectory``.

    Raises:
        ValueError: If drake_twin does not know the type.
    """
    parts: dict[str, Any] = {part: message_class(f"{name}_{part}") for part in ("Goal", "Result", "Feedback")}
    inner = {
        "SendGoalService": service_class(f"{name}_SendGoal"),
        "GetResultService": service_class(f"{name}_GetResult"),
        "FeedbackMessage": message_class(f"{name}_FeedbackMessage"),
        "CancelGoalService": service_class("action_msgs/srv/CancelGoal"),
        "GoalStatusMessage": message_class("action_msgs/msg/GoalStatusArray"),
    }
    parts["Impl"] = _holder(name, "Action implementation", inner)
    return _holder(name, "Action", parts)


def module_name(name: str) -> str:
    """Return the module that ROS has a type's class in: ``std_srvs.srv._trigger`` of ``std_srvs/srv/Trigger_Request``.

    rosidl's rule for its names has an underscore before a capital letter that follows a small one or a digit, or that
    a small one follows.
    """
    package, kind, own = name.split("/")
    if kind != "msg":
        own = own.partition("_")[0]
    own = re.sub(r"(?<=[a-z0-9])(?=[A-Z])|(?<=.)(?=[A-Z][a-z])", "_", own)
    return f"{package}.{kind}._{own.lower()}"


def _holder(name: str, what: str, parts: dict[str, Any]) -> type:
    def refuse(self: object) -> None:
        raise NotImplementedError(f"{what} classes can not be instantiated")

    content = {"__init__": refuse, "__module__": module_name(name), "__doc__": f"{what} {name}.", "__ros_type__": name}
    return type(name.rpartition("/")[2], (), content | parts)


def _setter(field: Field) -> Any:
    slot, checked, unchecked = field.slot, field.checked, field.unchecked

    def assign(message: Message, value: Any) -> None:
        check = message._check_fields
        setattr(message, slot, unchecked(value) if check is False else checked(value, strictly=check is True))

    return assign


def _field(name: str, description: Any, defaults: dict[str, Any]) -> Field:
    """Return a field; ``description`` is rosbags' (node type, details)."""
    from rosbags.interfaces import Nodetype

    node, details = description
    if node in (Nodetype.BASE, Nodetype.NAME):
        field = Field(name, _element(description))
    else:
        element = _element(details[0])
        kind = ListField if not element.code else NumberArray if node == Nodetype.ARRAY else NumberSequence
        field = kind(name, element, **{"size" if node == Nodetype.ARRAY else "limit": details[1]})
    if name in defaults:
        field.default = lambda: field.from_wire(defaults[name])
    return field


def _element(description: Any) -> Element:
    from rosbags.interfaces import Nodetype

    node, details = description
    if node == Nodetype.NAME:
        return _submessage(details)
    kind, limit = details
    return string(limit) if kind == "string" else _ELEMENTS[kind]


_ELEMENTS: dict[str, Element] = {
    "bool": BOOLEAN,
    "byte": OCTET,
    "char": integer(8, is_signed=False),
    "float32": real(32),
    "float64": real(64),
    **{f"int{bits}": integer(bits, is_signed=True) for bits in (8, 16, 32, 64)},
    **{f"uint{bits}": integer(bits, is_signed=False) for bits in (8, 16, 32, 64)},
}
