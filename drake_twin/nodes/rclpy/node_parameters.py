"""The parameters of a node.

Source: ros2/rclpy (jazzy), rclpy/rclpy/node.py.
"""

import warnings
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any

from drake_twin.nodes.message_classes import message_class, to_wire
from drake_twin.nodes.rclpy.exceptions import (
    InvalidParameterException,
    InvalidParameterTypeException,
    InvalidParameterValueException,
    ParameterAlreadyDeclaredException,
    ParameterImmutableException,
    ParameterNotDeclaredException,
    ParameterUninitializedException,
)
from drake_twin.nodes.rclpy.parameter import Parameter
from drake_twin.nodes.rclpy.parameter_ranges import out_of_range
from drake_twin.twin.event_topics import EventTopic

_Result = Any  # rcl_interfaces.msg.SetParametersResult
_NOT_SET = Parameter.Type.NOT_SET


class NodeParameters:
    """What ``Node`` does with parameters.

    Args:
        overrides: Values of the command line and of the program.
        allow_undeclared: Whether undeclared parameters can be read and set.
        events: ``/parameter_events``.
    """

    def __init__(self, overrides: dict[str, Any], allow_undeclared: bool, events: EventTopic):
        self.__events = events
        self._parameter_overrides = {name: Parameter(name, value=value) for name, value in overrides.items()}
        self._allow_undeclared_parameters = allow_undeclared
        self._parameters: dict[str, Parameter] = {}
        self._descriptors: dict[str, Any] = {}
        self._pre_set_parameters_callbacks: list[Callable[[list[Parameter]], list[Parameter]]] = []
        self._on_set_parameters_callbacks: list[Callable[[list[Parameter]], _Result]] = []
        self._post_set_parameters_callbacks: list[Callable[[list[Parameter]], None]] = []

    def _rclpy_declare_quickly(self, name: str, value: Any, *, read_only: bool = False) -> None:
        """Declare a parameter that each node has, with a descriptor that is made when it is asked for."""
        self._descriptors[name] = read_only
        self.__take([Parameter(name, value=value)], keeps_unset=True)

    def declare_parameter(
        self, name: str, value: Any = None, descriptor: Any = None, ignore_override: bool = False
    ) -> Parameter:
        if value is None and descriptor is None:
            return self.declare_parameters("", [(name,)], ignore_override)[0]
        descriptor = _descriptor() if descriptor is None else descriptor
        return self.declare_parameters("", [(name, value, descriptor)], ignore_override)[0]

    def declare_parameters(
        self, namespace: str, parameters: Iterable[Any], ignore_override: bool = False
    ) -> list[Parameter]:
        found = []
        for index, item in enumerate(parameters):
            if not 1 <= len(item) <= 3:
                raise TypeError(f"Invalid parameter tuple length at index {index} in parameters list: {item}")
            if not isinstance(item[0], str):
                raise TypeError(f"First element {item[0]} at index {index} in parameters list is not a str.")
            name = f"{namespace}.{item[0]}" if namespace else item[0]
            if not name:
                raise InvalidParameterException(name)
            descriptor = item[2] if len(item) > 2 else _descriptor()
            if type(descriptor).__name__ != "ParameterDescriptor":
                raise TypeError(f"Third element {descriptor} at index {index} in parameters list is not a descriptor.")
            if len(item) == 1:
                warnings.warn(f"declaring parameter {name!r} only by its name is deprecated", stacklevel=2)
                descriptor.dynamic_typing = True
            value = _typed(name, item[1] if len(item) > 1 else None, descriptor)
            if not ignore_override and name in self._parameter_overrides:
                value = self._parameter_overrides[name].value
            found.append((Parameter(name, value=value), descriptor))
        known = [parameter.name for parameter, _ in found if parameter.name in self._parameters]
        if known:
            raise ParameterAlreadyDeclaredException(known)
        for parameter, descriptor in found:
            self.__declare(parameter, descriptor)
        return [self._parameters[parameter.name] for parameter, _ in found]

    def __declare(self, parameter: Parameter, descriptor: Any) -> None:
        kind = Parameter.Type(descriptor.type)
        if not descriptor.dynamic_typing and parameter.type_ not in (_NOT_SET, kind):
            raise InvalidParameterTypeException(parameter, kind.name)
        result = self.__set([parameter], {parameter.name: descriptor}, keeps_unset=True)
        if not result.successful:
            if result.reason.startswith("Wrong parameter type"):
                raise InvalidParameterTypeException(parameter, kind.name)
            raise InvalidParameterValueException(parameter.name, parameter.value, result.reason)

    def undeclare_parameter(self, name: str) -> None:
        if name not in self._parameters:
            raise ParameterNotDeclaredException(name)
        if self.describe_parameter(name).read_only:
            raise ParameterImmutableException(name)
        del self._parameters[name], self._descriptors[name]

    def has_parameter(self, name: str) -> bool:
        return name in self._parameters

    def get_parameter(self, name: str) -> Parameter:
        parameter = self._parameters.get(name)
        if parameter is None:
            if self._allow_undeclared_parameters:
                return Parameter(name, _NOT_SET, None)
            raise ParameterNotDeclaredException(name)
        if parameter.type_ is _NOT_SET and not self.describe_parameter(name).dynamic_typing:
            raise ParameterUninitializedException(name)
        return parameter

    def get_parameters(self, names: Sequence[str]) -> list[Parameter]:
        if not all(isinstance(name, str) for name in names):
            raise TypeError("All names must be instances of type str")
        return [self.get_parameter(name) for name in names]

    def get_parameter_or(self, name: str, alternative_value: Parameter | None = None) -> Parameter:
        known = self._parameters.get(name)
        if known is not None and known.type_ is not _NOT_SET:
            return known
        return Parameter(name, _NOT_SET) if alternative_value is None else alternative_value

    def get_parameter_type(self, name: str) -> Any:
        if name in self._parameters:
            return self._parameters[name].type_.value
        if self._allow_undeclared_parameters:
            return _NOT_SET
        raise ParameterNotDeclaredException(name)

    def get_parameter_types(self, names: Sequence[str]) -> list[Any]:
        if not all(isinstance(name, str) for name in names):
            raise TypeError("All names must be instances of type str")
        return [self.get_parameter_type(name) for name in names]

    def get_parameters_by_prefix(self, prefix: str) -> dict[str, Parameter]:
        start = f"{prefix}." if prefix else ""
        return {name[len(start) :]: item for name, item in self._parameters.items() if name.startswith(start)}

    def describe_parameter(self, name: str) -> Any:
        if name not in self._descriptors:
            if self._allow_undeclared_parameters:
                return _descriptor()
            raise ParameterNotDeclaredException(name)
        known = self._descriptors[name]
        if isinstance(known, bool):
            kind = self._parameters[name].type_.value
            known = self._descriptors[name] = _descriptor(name=name, type=kind, read_only=known)
        return known

    def describe_parameters(self, names: Sequence[str]) -> list[Any]:
        return [self.describe_parameter(name) for name in names]

    def set_descriptor(self, name: str, descriptor: Any, alternative_value: Any = None) -> Any:
        if name not in self._parameters:
            if not self._allow_undeclared_parameters:
                raise ParameterNotDeclaredException(name)
            return self.get_parameter(name).get_parameter_value()
        if self.describe_parameter(name).read_only:
            raise ParameterImmutableException(name)
        parameter = self.get_parameter(name)
        if self.__refusal(parameter, descriptor):
            if alternative_value is not None:
                from drake_twin.nodes.rclpy.parameter import parameter_value_to_python

                parameter = Parameter(name, value=parameter_value_to_python(alternative_value))
            if reason := self.__refusal(parameter, descriptor):
                raise InvalidParameterValueException(name, parameter.value, reason)
        self._parameters[name], self._descriptors[name] = parameter, descriptor
        return parameter.get_parameter_value()

    def set_parameters(self, parameter_list: Sequence[Parameter]) -> list[_Result]:
        return [self.__set_declared([parameter]) for parameter in parameter_list]

    def set_parameters_atomically(self, parameter_list: Sequence[Parameter]) -> _Result:
        return self.__set_declared(list(parameter_list))

    def __set_declared(self, parameters: list[Parameter]) -> _Result:
        if self._pre_set_parameters_callbacks:
            parameters = [item for callback in self._pre_set_parameters_callbacks for item in callback(parameters)]
            if not parameters:
                text = "parameter list cannot be empty, this might be due to pre_set_parameters_callback modifying"
                return _result(f"{text} the original parameters list.")
        if not all(isinstance(parameter, Parameter) for parameter in parameters):
            raise TypeError("parameter must be instance of type 'rclpy.parameter.Parameter'")
        unknown = [item.name for item in parameters if item.name not in self._parameters]
        if unknown and not self._allow_undeclared_parameters:
            raise ParameterNotDeclaredException(unknown[1:])  # rclpy names the others only
        return self.__set(parameters)

    def list_parameters(self, prefixes: list[str], depth: int) -> Any:
        if not isinstance(prefixes, list):
            raise TypeError("The prefixes argument must be a list")
        if not all(isinstance(prefix, str) for prefix in prefixes):
            raise TypeError("All prefixes must be instances of type str")
        if not isinstance(depth, int):
            raise TypeError("The depth must be instance of type int")
        if depth < 0:
            raise ValueError("The depth must be greater than or equal to zero")

        def is_shallow(name: str) -> bool:
            return depth == 0 or name.count(".") < depth

        names = [
            name
            for name in self._parameters
            if (not prefixes and is_shallow(name))
            or any(
                name == item or (name.startswith(f"{item}.") and is_shallow(name[len(item) + 1 :])) for item in prefixes
            )
        ]
        found = dict.fromkeys(name.rpartition(".")[0] for name in names)
        list_parameters_result = message_class("rcl_interfaces/msg/ListParametersResult")
        return list_parameters_result(names=names, prefixes=[prefix for prefix in found if prefix])

    def add_on_set_parameters_callback(self, callback: Callable[[list[Parameter]], _Result]) -> None:
        self._on_set_parameters_callbacks.insert(0, callback)

    def remove_on_set_parameters_callback(self, callback: Callable[[list[Parameter]], _Result]) -> None:
        self._on_set_parameters_callbacks.remove(callback)

    def add_post_set_parameters_callback(self, callback: Callable[[list[Parameter]], None]) -> None:
        self._post_set_parameters_callbacks.insert(0, callback)

    def remove_post_set_parameters_callback(self, callback: Callable[[list[Parameter]], None]) -> None:
        self._post_set_parameters_callbacks.remove(callback)

    def add_pre_set_parameters_callback(self, callback: Callable[[list[Parameter]], list[Parameter]]) -> None:
        self._pre_set_parameters_callbacks.insert(0, callback)

    def remove_pre_set_parameters_callback(self, callback: Callable[[list[Parameter]], list[Parameter]]) -> None:
        self._pre_set_parameters_callbacks.remove(callback)

    def set_parameters_callback(self, callback: Callable[[list[Parameter]], _Result]) -> None:
        """Replace the callbacks by one, as in releases before Jazzy."""
        self._on_set_parameters_callbacks = [callback]

    # -----------------------------------------------------------------------------------------------------------------

    def __set(
        self, parameters: list[Parameter], descriptors: Mapping[str, Any] | None = None, *, keeps_unset: bool = False
    ) -> _Result:
        """Set parameters together, those that are declared with new descriptors."""
        for parameter in parameters:
            if descriptors is None and parameter.name not in self._descriptors:
                continue
            descriptor = self.describe_parameter(parameter.name) if descriptors is None else descriptors[parameter.name]
            if descriptors is None and descriptor.read_only:
                return _result(f"Trying to set a read-only parameter: {parameter.name}.")
            if reason := self.__refusal(parameter, descriptor):
                return _result(reason)
        result = _result()
        for callback in list(self._on_set_parameters_callbacks):
            result = callback(parameters)
            if not result.successful:
                return result
        self._descriptors.update(descriptors or {})
        self.__take(parameters, keeps_unset=keeps_unset)
        for notified in list(self._post_set_parameters_callbacks):
            notified(parameters)
        return result

    def __refusal(self, parameter: Parameter, descriptor: Any) -> str:
        """Return why a descriptor does not fit a value; it gets the parameter's name, and a dynamic one its type."""
        descriptor.name, kind = parameter.name, parameter.type_
        if descriptor.dynamic_typing:
            descriptor.type = kind.value
        elif kind is _NOT_SET:
            return "Static parameter cannot be undeclared" if parameter.name in self._parameters else ""
        elif kind.value != descriptor.type:
            return f"Wrong parameter type, expected '{Parameter.Type(descriptor.type)}' got '{kind}'"
        return out_of_range(parameter, descriptor)

    def __take(self, parameters: list[Parameter], *, keeps_unset: bool) -> None:
        """Take new values, and publish the event; one without a type ends its parameter, unless that is kept."""
        changes: dict[str, list[Any]] = {"deleted_parameters": [], "new_parameters": [], "changed_parameters": []}
        for parameter in parameters:
            if parameter.type_ is _NOT_SET and not keeps_unset:
                self._parameters.pop(parameter.name, None)
                self._descriptors.pop(parameter.name, None)
                kind = "deleted_parameters"
            else:
                is_new = self.get_parameter_or(parameter.name).type_ is _NOT_SET
                self._parameters[parameter.name] = parameter
                if parameter.name not in self._descriptors:
                    self._descriptors[parameter.name] = _descriptor(dynamic_typing=True)
                kind = "new_parameters" if is_new else "changed_parameters"
            if self.__events.is_heard:
                changes[kind].append(to_wire(parameter.to_parameter_msg()))
        if self.__events.is_heard:
            node: Any = self
            stamp = to_wire(node.get_clock().now().to_msg())
            fields = {"stamp": stamp, "node": node.get_fully_qualified_name(), **changes}
            self.__events.put(lambda: fields)


def _descriptor(**fields: Any) -> Any:
    return message_class("rcl_interfaces/msg/ParameterDescriptor")(**fields)


def _typed(name: str, given: Any, descriptor: Any) -> Any:
    """Return the value of what a declaration gives: a value or a type, which the descriptor gets."""
    if isinstance(given, Parameter.Type):
        if given is _NOT_SET:
            raise ValueError(f"Cannot declare parameter {{{name}}} as statically typed of type NOT_SET")
        if descriptor.dynamic_typing:
            raise ValueError(f"When declaring parameter {{{name}}}: dynamic_typing=True is not allowed with a type")
        descriptor.type = given.value
        return None
    if type(given).__name__ == "ParameterValue":
        from drake_twin.nodes.rclpy.parameter import parameter_value_to_python

        given = parameter_value_to_python(given)
    if not descriptor.dynamic_typing:
        descriptor.type = Parameter.Type.from_parameter_value(given).value
        if descriptor.type == _NOT_SET.value:
            text = "Cannot declare a statically typed parameter with default value of type PARAMETER_NOT_SET"
            raise ValueError(text)
    return given


def _result(refusal: str = "") -> _Result:
    return message_class("rcl_interfaces/msg/SetParametersResult")(successful=not refusal, reason=refusal)
