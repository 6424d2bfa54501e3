"""The parameters of a node."""

from collections.abc import Callable, Iterable, Sequence
from typing import Any

from drake_twin.nodes.message_classes import message_class, to_wire
from drake_twin.nodes.rclpy.exceptions import (
    InvalidParameterException,
    InvalidParameterTypeException,
    InvalidParameterValueException,
    ParameterAlreadyDeclaredException,
    ParameterNotDeclaredException,
    ParameterUninitializedException,
)
from drake_twin.nodes.rclpy.parameter import Parameter, parameter_value_to_python
from drake_twin.twin.event_topics import EventTopic

_Result = Any  # rcl_interfaces.msg.SetParametersResult


class NodeParameters:
    """What ``Node`` does with parameters.

    Args:
        overrides: Values of the command line and of the program.
        allow_undeclared: Whether undeclared parameters can be read and set.
        events: ``/parameter_events``.
    """

    def __init__(self, overrides: dict[str, Any], allow_undeclared: bool, events: EventTopic):
        self._parameter_events = events
        self._overrides, self._allow_undeclared = overrides, allow_undeclared
        self._parameters: dict[str, Parameter] = {}
        self._descriptors: dict[str, Any] = {}
        self._pre_set: list[Callable[[list[Parameter]], list[Parameter]]] = []
        self._on_set: list[Callable[[list[Parameter]], _Result]] = []
        self._post_set: list[Callable[[list[Parameter]], None]] = []

    def declare_parameter(
        self, name: str, value: Any = None, descriptor: Any = None, ignore_override: bool = False
    ) -> Parameter:
        return self.declare_parameters("", [(name, value, descriptor)], ignore_override)[0]

    def declare_parameters(
        self, namespace: str, parameters: Iterable[Any], ignore_override: bool = False
    ) -> list[Parameter]:
        parameter_descriptor = message_class("rcl_interfaces/msg/ParameterDescriptor")

        found = []
        for item in parameters:
            name, *rest = item
            if not isinstance(name, str):
                raise TypeError(f"First element {name!r} of a parameter tuple must be a string")
            full = f"{namespace}.{name}" if namespace else name
            if not full:
                raise InvalidParameterException(full)
            if full in self._parameters:
                raise ParameterAlreadyDeclaredException(full)
            value = rest[0] if rest else None
            descriptor = rest[1] if len(rest) > 1 and rest[1] is not None else parameter_descriptor()
            found.append(self._declare(full, value, descriptor, ignore_override))
        return found

    def _declare(self, name: str, value: Any, descriptor: Any, ignore_override: bool) -> Parameter:
        kind = None
        if isinstance(value, Parameter.Type):
            kind, value = value, None
        elif type(value).__name__ == "ParameterValue":
            value = parameter_value_to_python(value)
        elif value is not None:
            kind = Parameter.Type.from_parameter_value(value)
        is_dynamic = getattr(descriptor, "dynamic_typing", False) or kind is None
        if name in self._overrides and not ignore_override:
            value = self._overrides[name]
        parameter = Parameter(name, value=value)
        if not is_dynamic and value is not None and parameter.type_ != kind:
            assert kind is not None
            if not (value == [] and kind >= Parameter.Type.BYTE_ARRAY):
                raise InvalidParameterTypeException(parameter, kind.name)
            parameter = Parameter(name, kind, value)
        descriptor.name = name
        descriptor.type = int(kind or parameter.type_)
        self._descriptors[name] = descriptor
        result = self._asked([parameter])
        if not result.successful:
            del self._descriptors[name]
            raise InvalidParameterValueException(name, value, result.reason)
        self._take([parameter], is_declared=True)
        return parameter

    def undeclare_parameter(self, name: str) -> None:
        if name not in self._parameters:
            raise ParameterNotDeclaredException(name)
        del self._parameters[name], self._descriptors[name]

    def has_parameter(self, name: str) -> bool:
        return name in self._parameters

    def get_parameter(self, name: str) -> Parameter:
        parameter = self._parameters.get(name)
        if parameter is None:
            if self._allow_undeclared:
                return Parameter(name)
            raise ParameterNotDeclaredException(name)
        descriptor = self._descriptors[name]
        declared = getattr(descriptor, "type", 0)
        if parameter.type_ == Parameter.Type.NOT_SET and declared and not getattr(descriptor, "dynamic_typing", False):
            raise ParameterUninitializedException(name)
        return parameter

    def get_parameters(self, names: Sequence[str]) -> list[Parameter]:
        return [self.get_parameter(name) for name in names]

    def get_parameter_or(self, name: str, alternative_value: Parameter | None = None) -> Parameter:
        known = self._parameters.get(name)
        if known is not None and known.type_ != Parameter.Type.NOT_SET:
            return known
        return alternative_value or Parameter(name)

    def get_parameter_type(self, name: str) -> Parameter.Type:
        return self.get_parameter(name).type_

    def get_parameters_by_prefix(self, prefix: str) -> dict[str, Parameter]:
        start = f"{prefix}." if prefix else ""
        return {name[len(start) :]: item for name, item in self._parameters.items() if name.startswith(start)}

    def describe_parameter(self, name: str) -> Any:
        if name not in self._descriptors:
            raise ParameterNotDeclaredException(name)
        if self._descriptors[name] is None:
            kind = int(self._parameters[name].type_)
            self._descriptors[name] = message_class("rcl_interfaces/msg/ParameterDescriptor")(name=name, type=kind)
        return self._descriptors[name]

    def describe_parameters(self, names: Sequence[str]) -> list[Any]:
        return [self.describe_parameter(name) for name in names]

    def set_parameters(self, parameter_list: Sequence[Parameter]) -> list[_Result]:
        _check_types(parameter_list)
        return [self.set_parameters_atomically([parameter]) for parameter in parameter_list]

    def set_parameters_atomically(self, parameter_list: Sequence[Parameter]) -> _Result:
        _check_types(parameter_list)
        given = list(parameter_list)
        if self._pre_set:
            given = [parameter for callback in self._pre_set for parameter in callback(list(parameter_list))]
            if not given:
                text = "parameter list cannot be empty, this might be due to pre_set_parameters_callback modifying"
                return _result(f"{text} the original parameters list.")
        self._check_declared(given)
        return self._set(given)

    def list_parameters(self, prefixes: Sequence[str], depth: int) -> Any:
        list_parameters_result = message_class("rcl_interfaces/msg/ListParametersResult")

        names = [
            name
            for name in self._parameters
            if (not prefixes or any(name == item or name.startswith(f"{item}.") for item in prefixes))
            and (not depth or name.count(".") < depth)
        ]
        return list_parameters_result(names=names, prefixes=sorted({name.rpartition(".")[0] for name in names} - {""}))

    def add_on_set_parameters_callback(self, callback: Callable[[list[Parameter]], _Result]) -> None:
        self._on_set.insert(0, callback)

    def remove_on_set_parameters_callback(self, callback: Callable[[list[Parameter]], _Result]) -> None:
        self._on_set.remove(callback)

    def add_post_set_parameters_callback(self, callback: Callable[[list[Parameter]], None]) -> None:
        self._post_set.insert(0, callback)

    def remove_post_set_parameters_callback(self, callback: Callable[[list[Parameter]], None]) -> None:
        self._post_set.remove(callback)

    def add_pre_set_parameters_callback(self, callback: Callable[[list[Parameter]], list[Parameter]]) -> None:
        self._pre_set.insert(0, callback)

    def remove_pre_set_parameters_callback(self, callback: Callable[[list[Parameter]], list[Parameter]]) -> None:
        self._pre_set.remove(callback)

    def set_parameters_callback(self, callback: Callable[[list[Parameter]], _Result]) -> None:
        self._on_set = [callback]

    def _check_declared(self, parameters: Sequence[Parameter]) -> None:
        unknown = [item.name for item in parameters if item.name not in self._parameters]
        if unknown and not self._allow_undeclared:
            raise ParameterNotDeclaredException(unknown)

    def _set(self, parameters: list[Parameter]) -> _Result:
        for parameter in parameters:
            descriptor = self._descriptors.get(parameter.name)
            if descriptor is None:
                continue
            if getattr(descriptor, "read_only", False):
                return _result(f"Trying to set a read-only parameter: {parameter.name}.")
            known = Parameter.Type(descriptor.type)
            is_dynamic = getattr(descriptor, "dynamic_typing", False) or known == Parameter.Type.NOT_SET
            if not is_dynamic and parameter.type_ != known:
                return _result(f"Wrong parameter type, expected '{known}' got '{parameter.type_}'")
        result = self._asked(parameters)
        if result.successful:
            self._take(parameters)
            for callback in self._post_set:
                callback(parameters)
        return result

    def _take(self, parameters: list[Parameter], *, is_declared: bool = False) -> None:
        """Take new values, and tell of them; one without a type ends its parameter, unless it is being declared."""
        changes: dict[str, list[Any]] = {"deleted_parameters": [], "new_parameters": [], "changed_parameters": []}
        for parameter in parameters:
            if parameter.type_ == Parameter.Type.NOT_SET and not is_declared:
                self._parameters.pop(parameter.name, None)
                self._descriptors.pop(parameter.name, None)
                kind = "deleted_parameters"
            else:
                is_new = self.get_parameter_or(parameter.name).type_ == Parameter.Type.NOT_SET
                self._parameters[parameter.name] = parameter
                if parameter.name not in self._descriptors:
                    self._descriptors[parameter.name] = message_class("rcl_interfaces/msg/ParameterDescriptor")(
                        dynamic_typing=True
                    )
                kind = "new_parameters" if is_new else "changed_parameters"
            if self._parameter_events.is_heard:
                changes[kind].append(to_wire(parameter.to_parameter_msg()))
        if self._parameter_events.is_heard:
            node: Any = self
            stamp = to_wire(node.get_clock().now().to_msg())
            fields = {"stamp": stamp, "node": node.get_fully_qualified_name(), **changes}
            self._parameter_events.put(lambda: fields)

    def _asked(self, parameters: list[Parameter]) -> _Result:
        for parameter in parameters:
            if reason := _out_of_range(parameter, self._descriptors.get(parameter.name)):
                return _result(reason)
        for callback in list(self._on_set):
            result = callback(parameters)
            if not result.successful:
                return result
        return _result()


def _result(refusal: str = "") -> _Result:
    return message_class("rcl_interfaces/msg/SetParametersResult")(successful=not refusal, reason=refusal)


def _check_types(parameters: Sequence[Parameter]) -> None:
    for parameter in parameters:
        if not isinstance(parameter, Parameter):
            raise TypeError("parameter must be instance of type 'rclpy.parameter.Parameter'")


def _out_of_range(parameter: Parameter, descriptor: Any) -> str:
    kinds = {Parameter.Type.INTEGER: "integer_range", Parameter.Type.DOUBLE: "floating_point_range"}
    for bounds in getattr(descriptor, kinds.get(parameter.type_, ""), ()) or ():
        if not bounds.from_value <= parameter.value <= bounds.to_value:
            text = f"Parameter {parameter.name} out of range. Min: {bounds.from_value}, Max: {bounds.to_value}"
            return f"{text}, value: {parameter.value}"
    return ""
