"""Filtered state interfaces, as ros2_controllers' chained_filter_controller exports them."""

from collections.abc import Iterator, Mapping
from dataclasses import field, fields
from math import isfinite, isnan, nan
from typing import ClassVar

import numpy as np
from pydrake.systems.framework import BasicVector, Context, OutputPort

from drake_twin.control.filters import ExponentialFilter, Filter, FilterMemory, LowPass, MeanFilter, RateLimiter
from drake_twin.control.low_pass_filter import LowPassFilter
from drake_twin.control.speed_limiter import SpeedLimiter
from drake_twin.controllers.base_controller import ControllerSetup
from drake_twin.controllers.interface import Interface
from drake_twin.controllers.periodic_controller import PeriodicController, Update
from drake_twin.controllers.registry import controller
from drake_twin.dataclass import dataclass
from drake_twin.description.parameters import ParameterError
from drake_twin.description.robot_description import RobotDescription
from drake_twin.saved import saved
from drake_twin.systems.weak_callback import weakly

_AT_LEAST_ZERO = {"lower": 0.0}
_AT_MOST_ZERO = {"upper": 0.0}
# In the order of `SpeedLimiter`'s attributes.
_LIMITS = (
    "min_value",
    "max_value",
    "min_first_derivative_neg",
    "max_first_derivative_pos",
    "min_first_derivative_pos",
    "max_first_derivative_neg",
    "min_second_derivative",
    "max_second_derivative",
)
# Filter type → the parameters that it needs, and those that it may have.
_KINDS: Mapping[str, tuple[tuple[str, ...], tuple[str, ...]]] = {
    "filters/MeanFilterDouble": (("number_of_observations",), ()),
    "control_filters/LowPassFilterDouble": (("sampling_frequency", "damping_frequency", "damping_intensity"), ()),
    "control_filters/ExponentialFilterDouble": (("alpha",), ()),
    "control_filters/RateLimiterDouble": (("sampling_interval",), _LIMITS),
}


@dataclass(frozen=True)
class FilterParameters:
    """The parameters of all types of filters; each has some of them.

    Attributes:
        number_of_observations: Of a mean, the number of values.
        sampling_frequency: Of a low-pass filter, the rate of the values (Hz): the controller's update rate.
        damping_frequency: Of a low-pass filter, the cut-off frequency (Hz).
        damping_intensity: Of a low-pass filter, the intensity (dB).
        alpha: Of an exponential filter, the share of a new value.
        sampling_interval: Of a rate limiter, the time between two values (s).
        max_value: Of a rate limiter, the highest value; NaN for no limit, also below.
        min_value: The lowest value; NaN for minus the highest.
        max_first_derivative_pos: The highest rate of a positive value (per second).
        min_first_derivative_pos: The lowest rate of a positive value (per second).
        max_first_derivative_neg: The highest rate of a negative value (per second).
        min_first_derivative_neg: The lowest rate of a negative value (per second).
        max_second_derivative: The highest second derivative (per second squared).
        min_second_derivative: The lowest second derivative (per second squared).
    """

    number_of_observations: int = field(default=0, metadata={"lower": 1})
    sampling_frequency: float = field(default=nan, metadata={"above": 0.0})
    damping_frequency: float = field(default=nan, metadata={"above": 0.0})
    damping_intensity: float = nan
    alpha: float = field(default=nan, metadata={"lower": 0.0, "upper": 1.0})
    sampling_interval: float = field(default=nan, metadata={"above": 0.0})
    max_value: float = field(default=nan, metadata=_AT_LEAST_ZERO)
    min_value: float = field(default=nan, metadata=_AT_MOST_ZERO)
    max_first_derivative_pos: float = field(default=nan, metadata=_AT_LEAST_ZERO)
    min_first_derivative_pos: float = field(default=nan, metadata=_AT_MOST_ZERO)
    max_first_derivative_neg: float = field(default=nan, metadata=_AT_LEAST_ZERO)
    min_first_derivative_neg: float = field(default=nan, metadata=_AT_MOST_ZERO)
    max_second_derivative: float = field(default=nan, metadata=_AT_LEAST_ZERO)
    min_second_derivative: float = field(default=nan, metadata=_AT_MOST_ZERO)

    def __post_init__(self) -> None:
        try:
            self.limiter()
        except ValueError as error:
            raise ParameterError(str(error)) from None

    def limiter(self) -> SpeedLimiter:
        """Return the limits of a rate limiter."""
        return SpeedLimiter(*(getattr(self, name) for name in _LIMITS))

    def given(self) -> Iterator[str]:
        """Yield the names of the parameters that have a value."""
        for item in fields(self):
            value = getattr(self, item.name)
            if value != item.default and not isnan(value):
                yield item.name


@dataclass(frozen=True)
class ChainFilter:
    """A filter of a chain.

    Attributes:
        name: The filter's name.
        type: The filter's plugin.
        params: Its parameters.
    """

    name: str
    type: str = field(metadata={"choices": tuple(_KINDS)})
    params: FilterParameters = FilterParameters()

    def __post_init__(self) -> None:
        needed, _ = _KINDS[self.type]
        given = [*self.params.given()]
        for name in needed:
            if name not in given:
                raise ParameterError(f"the parameter {name!r} of a {self.type} is missing", "params")

    def unused(self) -> list[str]:
        """Return the parameters that a filter of this type does not have."""
        needed, possible = _KINDS[self.type]
        return [name for name in self.params.given() if name not in needed + possible]

    def filter(self) -> Filter:
        """Return the filter."""
        params = self.params
        if self.type == "filters/MeanFilterDouble":
            return MeanFilter(params.number_of_observations)
        if self.type == "control_filters/LowPassFilterDouble":
            return LowPass(LowPassFilter(params.sampling_frequency, params.damping_frequency, params.damping_intensity))
        if self.type == "control_filters/ExponentialFilterDouble":
            return ExponentialFilter(params.alpha)
        return RateLimiter(params.limiter(), params.sampling_interval)


@dataclass(frozen=True)
class FilterChain:
    """The filters of one input interface.

    Attributes:
        filter_chain: ``filter1``, ``filter2``, … → a filter, where not all interfaces have the same.
    """

    filter_chain: Mapping[str, ChainFilter] = field(default_factory=dict)

    def __post_init__(self) -> None:
        _check_names(self.filter_chain)


@dataclass(frozen=True)
class ChainedFilterParameters:
    """Parameters of ``chained_filter_controller/ChainedFilter``.

    Attributes:
        input_interfaces: The state interfaces that are filtered: ``joint/position``, ``gpio/name``.
        output_interfaces: The name of each filtered state interface, which gets the controller's name as prefix.
        filter_chain: ``filter1``, ``filter2``, … → a filter, for every interface.
        interfaces: The filters of single interfaces, beside the other parameters, under the interface's name; without
            ``filter_chain``, and for two or more interfaces.
    """

    read_only: ClassVar[tuple[str, ...]] = ("input_interfaces", "output_interfaces")

    input_interfaces: tuple[str, ...]
    output_interfaces: tuple[str, ...]
    filter_chain: Mapping[str, ChainFilter] = field(default_factory=dict)
    interfaces: Mapping[str, FilterChain] = field(default_factory=dict, metadata={"of_joints": True})

    def __post_init__(self) -> None:
        inputs, outputs = len(self.input_interfaces), len(self.output_interfaces)
        if inputs != outputs:
            raise ParameterError(f"there are {inputs} input_interfaces, but {outputs} output_interfaces")
        _check_names(self.filter_chain)

    @property
    def inputs(self) -> tuple[Interface, ...]:
        """The state interfaces that are filtered."""
        return tuple(Interface(*name.rpartition("/")[::2]) for name in self.input_interfaces)

    def chain(self, interface: str) -> Mapping[str, ChainFilter]:
        """Return the filters of an interface, of which the first gap ends the chain."""
        return self.filter_chain if self._is_common() else self.interfaces.get(interface, FilterChain()).filter_chain

    def warnings(self) -> Iterator[str]:
        """Yield what has no effect."""
        chains = {"": self.filter_chain}
        for interface, own in self.interfaces.items():
            chains[f"{interface}."] = own.filter_chain
            if interface not in self.input_interfaces:
                yield f"{interface}.filter_chain is ignored: it is not among the input_interfaces"
            elif self._is_common():
                why = "filter_chain is for all" if self.filter_chain else "a single interface has filter_chain"
                yield f"{interface}.filter_chain is ignored: {why}"
        for prefix, chain in chains.items():
            used = [*_in_order(chain)]
            for key, each in chain.items():
                name = f"{prefix}filter_chain.{key}"
                if each not in used:
                    yield f"{name} is ignored: filters are filter1, filter2 and so on, without a gap"
                for parameter in each.unused():
                    yield f"{name}.params.{parameter} is ignored: a {each.type} has no such parameter"

    def _is_common(self) -> bool:
        return len(self.input_interfaces) == 1 or "filter1" in self.filter_chain


@saved("ChainedFilterMemory")
@dataclass(frozen=True)
class ChainedFilterMemory:
    """What the controller keeps; tuples have an element for each interface.

    Attributes:
        values: The filtered values; NaN before the first finite input.
        filters: What each filter of a chain keeps.
    """

    values: tuple[float, ...]
    filters: tuple[tuple[FilterMemory, ...], ...]


@controller("chained_filter_controller/ChainedFilter")
class ChainedFilter(PeriodicController):
    """Filter state interfaces, and export the filtered values as state interfaces.

    Behaves as ``chained_filter_controller/ChainedFilter`` in ROS 2 Jazzy: an input that is not finite changes nothing,
    and filters continue when the controller is activated again. State interfaces of joints and GPIOs can be filtered,
    those of sensors cannot. No other controller of the twin reads the exported interfaces: they are listed by the
    controller manager, and are on a vector port.

    .. pydrake_system::

        name: ChainedFilter
        input_ports:
        - state
        - net_actuation
        - gpio_states
        output_ports:
        - state_interfaces

    - ``state``: vector ``[q; v]`` of the robot (rad, rad/s, or m, m/s).
    - ``net_actuation``: vector of the efforts of its actuators (N·m or N); with an effort among the inputs only.
    - ``gpio_states``: vector of the states of the robot's GPIOs; with one among the inputs only.
    - ``state_interfaces``: vector of the filtered values, in the order of ``output_interfaces``; NaN before the first.
    """

    Parameters: ClassVar[type] = ChainedFilterParameters

    @classmethod
    def exported_interfaces(cls, parameters: ChainedFilterParameters) -> tuple[str, ...]:
        """Return the filtered state interfaces."""
        return parameters.output_interfaces

    @classmethod
    def problem(cls, parameters: ChainedFilterParameters, description: RobotDescription) -> str | None:
        """Return which state interface cannot be filtered; None if all can."""
        for owner, interface in parameters.inputs:
            if owner in description.gpios:
                if (problem := description.gpios[owner].problem("state", interface)) is not None:
                    return problem
                continue
            if owner not in description.controlled_joints:
                known = ", ".join((*description.controlled_joints, *description.gpios)) or "none"
                return f"the state of {owner!r} cannot be filtered, only a joint's or gpio's of <ros2_control>: {known}"
            has = [item.name for item in description.controlled_joints[owner].state_interfaces]
            if interface not in has or interface not in ("position", "velocity", "effort"):
                return f"joint {owner} has no state interface {interface!r} (it has {', '.join(has) or 'none'})"
        return None

    def __init__(self, setup: ControllerSetup):
        super().__init__(setup)
        parameters: ChainedFilterParameters = setup.parameters
        self.warnings = tuple(parameters.warnings())
        self._chains: list[list[Filter]] = [
            [each.filter() for each in _in_order(parameters.chain(name))] for name in parameters.input_interfaces
        ]
        gpios = [Interface(gpio.name, name) for gpio in setup.description.gpios.values() for name in gpio.states]
        layout, self._efforts, self._gpios = setup.layout, None, None
        if any(item in gpios for item in parameters.inputs):
            self._gpios = self.declare_robot_input("gpio_states", len(gpios))
        if any(item.name == "effort" and item not in gpios for item in parameters.inputs):
            self._efforts = self.declare_robot_input("net_actuation", layout.num_actuators)
        # Indices into the state, the efforts, the GPIOs, and a NaN at the end.
        efforts = layout.size + (layout.num_actuators if self._efforts is not None else 0)
        missing = efforts + (len(gpios) if self._gpios is not None else 0)
        self._places: list[int] = []
        for item in parameters.inputs:
            if item in gpios:
                self._places.append(efforts + gpios.index(item))
            else:
                place = layout.place(*item)
                self._places.append(missing if place is None else place)
        self.vector_outputs["state_interfaces"] = self.DeclareVectorOutputPort(
            "state_interfaces", len(self._chains), weakly(self._calc_state_interfaces), {self.sample_ticket()}
        )

    def get_state_interfaces_output_port(self) -> OutputPort:
        """Return the port ``state_interfaces``."""
        return self.GetOutputPort("state_interfaces")

    def start(self, context: Context) -> ChainedFilterMemory:
        """Return a memory without values; the filters continue from the last activation."""
        last: ChainedFilterMemory | None = self.sample(context).memory
        filters = tuple(tuple(() for _ in chain) for chain in self._chains) if last is None else last.filters
        return ChainedFilterMemory((nan,) * len(self._chains), filters)

    def update(self, context: Context, time: float, memory: ChainedFilterMemory) -> Update:
        """Filter each interface's present value."""
        values, filters = list(memory.values), list(memory.filters)
        for index, (value, chain) in enumerate(zip(self._inputs(context), self._chains, strict=True)):
            if not isfinite(value):
                continue
            kept = []
            for each, before in zip(chain, filters[index], strict=True):
                value, after = each.update(value, before)
                kept.append(after)
            values[index], filters[index] = value, tuple(kept)
        return Update(ChainedFilterMemory(tuple(values), tuple(filters)), ())

    def _inputs(self, context: Context) -> list[float]:
        ports = [self.get_state_input_port(), self._efforts, self._gpios]
        known = np.concatenate([*(port.Eval(context) for port in ports if port is not None), [nan]])
        return [float(known[place]) for place in self._places]

    def _calc_state_interfaces(self, context: Context, output: BasicVector) -> None:
        memory: ChainedFilterMemory | None = self.sample(context).memory
        output.SetFromVector([nan] * len(self._chains) if memory is None else memory.values)


def _in_order(chain: Mapping[str, ChainFilter]) -> Iterator[ChainFilter]:
    """Yield ``filter1``, ``filter2`` and so on, up to the first that is missing."""
    number = 1
    while f"filter{number}" in chain:
        yield chain[f"filter{number}"]
        number += 1


def _check_names(chain: Mapping[str, ChainFilter]) -> None:
    names = [each.name for each in chain.values()]
    for key, each in chain.items():
        if names.count(each.name) > 1:
            raise ParameterError(f"two filters have the name {each.name!r}", "filter_chain", key, "name")
