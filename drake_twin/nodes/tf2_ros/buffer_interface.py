"""Stand-in for ``tf2_ros.buffer_interface``: how data of many types is transformed and converted."""

from collections.abc import Callable
from typing import Any, ClassVar

from drake_twin.nodes.message_classes import message_class

__all__ = [
    "BufferInterface",
    "ConvertRegistration",
    "NotImplementedException",
    "Stamped",
    "TransformRegistration",
    "TypeException",
    "convert",
]

_Function = Callable[..., Any]


class TypeException(Exception):  # noqa: N818 (ROS's name)
    """Raised for a type that nobody has registered."""

    def __init__(self, errstr: str):
        super().__init__(errstr)
        self.errstr = errstr


class NotImplementedException(Exception):  # noqa: N818 (ROS's name)
    """Raised by a buffer without lookups."""

    def __init__(self) -> None:
        self.errstr = "CanTransform or LookupTransform not implemented"
        super().__init__(self.errstr)


class BufferInterface:
    """What all buffers can do."""

    def __init__(self) -> None:
        self.registration = TransformRegistration()

    def transform(self, object_stamped: Any, target_frame: str, timeout: Any = None, new_type: Any = None) -> Any:
        """Return data with a header in another frame.

        Raises:
            TypeException: If nobody has registered its type: ``tf2_geometry_msgs`` does so for poses, points, ….
            TransformException: If the transform cannot be computed.
        """
        do_transform = self.registration.get(type(object_stamped))
        header = object_stamped.header
        found = self.lookup_transform(target_frame, header.frame_id, header.stamp, timeout)
        return _converted(do_transform(object_stamped, found), new_type)

    def transform_full(
        self,
        object_stamped: Any,
        target_frame: str,
        target_time: Any,
        fixed_frame: str,
        timeout: Any = None,
        new_type: Any = None,
    ) -> Any:
        """Return data with a header in another frame at another time, by way of a fixed frame."""
        do_transform = self.registration.get(type(object_stamped))
        header = object_stamped.header
        found = self.lookup_transform_full(
            target_frame, target_time, header.frame_id, header.stamp, fixed_frame, timeout
        )
        return _converted(do_transform(object_stamped, found), new_type)

    def lookup_transform(self, *where: Any, **options: Any) -> Any:
        """Return the transform between two frames; see `Buffer` for the arguments of this and the next three."""
        raise NotImplementedException

    def lookup_transform_full(self, *where: Any, **options: Any) -> Any:
        """Return the transform between two frames at two times."""
        raise NotImplementedException

    def can_transform(self, *where: Any, **options: Any) -> Any:
        """Return whether there is a transform."""
        raise NotImplementedException

    def can_transform_full(self, *where: Any, **options: Any) -> Any:
        """Return whether there is a transform."""
        raise NotImplementedException


class TransformRegistration:
    """The functions that transform data, by its type."""

    _known: ClassVar[dict[Any, _Function]] = {}

    def add(self, key: Any, callback: _Function) -> None:
        """Let a function transform data of a type."""
        self._known[key] = callback

    def get(self, key: Any) -> _Function:
        """Return the function for a type."""
        return _found(self._known, key)


class ConvertRegistration:
    """The functions that convert data from one type into another."""

    _to_message: ClassVar[dict[Any, _Function]] = {}
    _from_message: ClassVar[dict[Any, _Function]] = {}
    _converters: ClassVar[dict[Any, _Function]] = {}

    def add_from_msg(self, key: Any, callback: _Function) -> None:
        """Let a function make data of a type from a message."""
        self._from_message[key] = callback

    def add_to_msg(self, key: Any, callback: _Function) -> None:
        """Let a function make a message from data of a type."""
        self._to_message[key] = callback

    def add_convert(self, key: Any, callback: _Function) -> None:
        """Let a function convert data; the key is a pair of types."""
        self._converters[key] = callback

    def get_from_msg(self, key: Any) -> _Function:
        """Return the function that makes data of a type from a message."""
        return _found(self._from_message, key)

    def get_to_msg(self, key: Any) -> _Function:
        """Return the function that makes a message from data of a type."""
        return _found(self._to_message, key)

    def get_convert(self, key: Any) -> _Function:
        """Return the function that converts data; the key is a pair of types."""
        return _found(self._converters, key)


def convert(a: Any, b_type: Any) -> Any:
    """Return data as another type, by way of a message where nobody converts it directly."""
    known = ConvertRegistration()
    try:
        return known.get_convert((type(a), b_type))(a)
    except TypeException:
        if type(a) is b_type:
            return a
        return known.get_from_msg(b_type)(known.get_to_msg(type(a))(a))


def Stamped(obj: Any, stamp: Any, frame_id: str) -> Any:
    """Give data a header."""
    obj.header = message_class("std_msgs/msg/Header")(frame_id=frame_id, stamp=stamp)
    return obj


def _converted(value: Any, new_type: Any) -> Any:
    return value if new_type is None else convert(value, new_type)


def _found(known: dict[Any, _Function], key: Any) -> _Function:
    if key not in known:
        raise TypeException(f"Type {key} is not loaded or supported")
    return known[key]
