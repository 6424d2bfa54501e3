"""A force/torque sensor's values as messages, as force_torque_sensor_broadcaster publishes them."""

import re
from collections.abc import Mapping
from dataclasses import field, replace
from typing import Any, ClassVar

import numpy as np
from pydrake.systems.framework import Context, EventStatus, State

from drake_twin import messages
from drake_twin.control.low_pass_filter import LowPassFilter, LowPassMemory
from drake_twin.controllers.base_controller import ControllerSetup
from drake_twin.controllers.registry import controller
from drake_twin.controllers.sensor_broadcaster import SensorBroadcaster
from drake_twin.dataclass import dataclass
from drake_twin.errors import InputError, described
from drake_twin.saved import saved
from drake_twin.systems.weak_callback import weakly

_AXES = tuple((vector, axis) for vector in ("force", "torque") for axis in "xyz")


def wrench_interfaces(sensor: str) -> tuple[str, ...]:
    """Return the state interfaces of a force/torque sensor, forces first."""
    return tuple(f"{sensor}/{vector}.{axis}" for vector, axis in _AXES)


@dataclass(frozen=True)
class AxisNames:
    """The full name of each axis's state interface, for example ``sensor/force.x``; empty for an axis without one.

    Attributes:
        x: The component about or along x.
        y: The component about or along y.
        z: The component about or along z.
    """

    x: str = ""
    y: str = ""
    z: str = ""


@dataclass(frozen=True)
class WrenchInterfaceNames:
    """The state interfaces of a sensor that lacks some or has other names for them."""

    force: AxisNames = AxisNames()
    torque: AxisNames = AxisNames()


@dataclass(frozen=True)
class AxisOffsets:
    """The offset of each axis (N or N·m).

    Attributes:
        x: The component about or along x.
        y: The component about or along y.
        z: The component about or along z.
    """

    x: float = 0.0
    y: float = 0.0
    z: float = 0.0


@dataclass(frozen=True)
class WrenchOffsets:
    """The offset of a wrench."""

    force: AxisOffsets = AxisOffsets()
    torque: AxisOffsets = AxisOffsets()


@dataclass(frozen=True)
class AxisMultipliers:
    """The factor of each axis, applied after the offset.

    Attributes:
        x: The component about or along x.
        y: The component about or along y.
        z: The component about or along z.
    """

    x: float = 1.0
    y: float = 1.0
    z: float = 1.0


@dataclass(frozen=True)
class WrenchMultipliers:
    """The factors of a wrench."""

    force: AxisMultipliers = AxisMultipliers()
    torque: AxisMultipliers = AxisMultipliers()


@dataclass(frozen=True)
class WrenchFilterParameters:
    """The parameters of ``control_filters/LowPassFilterWrench``.

    Attributes:
        sampling_frequency: The rate of the values (Hz): the controller's update rate.
        damping_frequency: The cut-off frequency (Hz).
        damping_intensity: The intensity (dB).
    """

    sampling_frequency: float
    damping_frequency: float
    damping_intensity: float


@dataclass(frozen=True)
class WrenchFilter:
    """A filter of the chain, ``filter1``, ``filter2``, …

    Attributes:
        type: The filter's plugin.
        name: The filter's name.
        params: Its parameters.
    """

    type: str = field(metadata={"choices": ("control_filters/LowPassFilterWrench",)})
    params: WrenchFilterParameters
    name: str = ""


@dataclass(frozen=True)
class ForceTorqueSensorBroadcasterParameters:
    """Parameters of ``force_torque_sensor_broadcaster/ForceTorqueSensorBroadcaster``.

    Attributes:
        frame_id: The frame of the values.
        sensor_name: The sensor in ``<ros2_control>``; either this or ``interface_names``.
        interface_names: The state interface of each axis.
        offset: The offset of each axis.
        multiplier: The factor of each axis, applied after the offset.
        sensor_filter_chain: The filters of ``~/wrench_filtered``.
    """

    live: ClassVar[tuple[str, ...]] = ("offset.*", "multiplier.*")

    frame_id: str = field(metadata={"not_empty": True})
    sensor_name: str = ""
    interface_names: WrenchInterfaceNames = WrenchInterfaceNames()
    offset: WrenchOffsets = WrenchOffsets()
    multiplier: WrenchMultipliers = WrenchMultipliers()
    sensor_filter_chain: Mapping[str, WrenchFilter] = field(default_factory=dict)

    @property
    def interfaces(self) -> tuple[str, ...]:
        """The state interface of each axis, forces first; empty for an axis without one."""
        if self.sensor_name:
            return wrench_interfaces(self.sensor_name)
        return tuple(_of_axes(self.interface_names))


@saved("FilteredWrench")
@dataclass(frozen=True)
class FilteredWrench:
    """The memory of a filter chain: its last output and each filter's memory."""

    wrench: tuple[float, ...]
    filters: tuple[LowPassMemory, ...]


@controller("force_torque_sensor_broadcaster/ForceTorqueSensorBroadcaster")
class ForceTorqueSensorBroadcaster(SensorBroadcaster):
    """Publish a force/torque sensor's values as ``WrenchStamped`` messages.

    Behaves as ``force_torque_sensor_broadcaster/ForceTorqueSensorBroadcaster`` in ROS 2 Jazzy: an axis without a state
    interface is NaN, and there is a filtered wrench if there are filters. Only then the system has an event, at the
    controller's update rate.

    .. pydrake_system::

        name: ForceTorqueSensorBroadcaster
        input_ports:
        - wrench
        output_ports:
        - wrench
        - wrench_filtered

    - ``wrench`` (input): vector ``[fx fy fz, tx ty tz]`` (N, N·m), as from `ForceTorqueSensor`.
    - ``wrench``: ``geometry_msgs/msg/WrenchStamped`` of the present time, ``None`` while inactive; topic ``~/wrench``.
    - ``wrench_filtered``: the same of the last update, ``None`` without filters; topic ``~/wrench_filtered``.
    """

    Parameters: ClassVar[type] = ForceTorqueSensorBroadcasterParameters
    kind = "force_torque"

    @classmethod
    def sensor_name(cls, parameters: ForceTorqueSensorBroadcasterParameters) -> str:
        """Return the name of the sensor in ``<ros2_control>`` that the controller reads."""
        return next((name.rpartition("/")[0] for name in parameters.interfaces if name), "")

    @classmethod
    def state_interfaces(cls, parameters: ForceTorqueSensorBroadcasterParameters) -> tuple[str, ...]:
        """Return the force's components, then the torque's."""
        return wrench_interfaces(cls.sensor_name(parameters))

    def __init__(self, setup: ControllerSetup):
        parameters: ForceTorqueSensorBroadcasterParameters = setup.parameters
        self._filters = [
            LowPassFilter(item.params.sampling_frequency, item.params.damping_frequency, item.params.damping_intensity)
            for _, item in sorted(parameters.sensor_filter_chain.items(), key=lambda entry: _number(entry[0]))
        ]
        super().__init__(setup, "wrench")
        names = [name for name in _of_axes(parameters.interface_names) if name]
        if bool(parameters.sensor_name) == bool(names):
            what = "and not both" if names else "and neither is given"
            raise InputError(f"controller {setup.name!r}: sensor_name or interface_names is needed, {what}")
        self._elements = _elements(parameters.interfaces, setup.name)
        self._offset = np.array(list(_of_axes(parameters.offset)))
        self._multiplier = np.array(list(_of_axes(parameters.multiplier)))
        kind = "geometry_msgs/msg/WrenchStamped"
        self.declare_message_output("wrench", kind, self._wrench_now, self._present())
        self.declare_message_output("wrench_filtered", kind, self._wrench_filtered)

    def declare_updates(self) -> bool:
        """Declare the updates of the filters, if there are any."""
        if self._filters:
            self.DeclarePeriodicUnrestrictedUpdateEvent(
                self.setup.update_period, self.setup.update_offset, weakly(self._update_filters)
            )
        return bool(self._filters)

    def _wrench(self, context: Context) -> np.ndarray:
        values = np.append(self._sensor.Eval(context), np.nan)[self._elements]
        return np.asarray((values + self._offset) * self._multiplier)

    def _update_filters(self, context: Context, state: State) -> EventStatus:
        sample = self.sample(context)
        if not sample.active or sample.fault is not None:
            return EventStatus.DidNothing()
        try:
            filtered = self._filtered(self._wrench(context), sample.memory)
            sample = replace(sample, time=context.get_time(), memory=filtered)
        except Exception as error:  # an error concerns this controller alone
            sample = replace(sample, fault=described(error))
        state.get_mutable_abstract_state(int(self._sample_index)).set_value(sample)
        return (
            EventStatus.Succeeded() if sample.fault is None else EventStatus.ReachedTermination(self, self.setup.name)
        )

    def _filtered(self, wrench: np.ndarray, kept: FilteredWrench | None) -> FilteredWrench:
        memories = []
        before = (LowPassMemory(),) * len(self._filters) if kept is None else kept.filters
        for item, memory in zip(self._filters, before, strict=True):
            wrench, memory = item.update(wrench, memory)
            memories.append(memory)
        return FilteredWrench(tuple(wrench.tolist()), tuple(memories))

    def _wrench_now(self, context: Context) -> Any:
        return self._message(self._wrench(context), context.get_time())

    def _wrench_filtered(self, context: Context) -> Any:
        sample = self.sample(context)
        return None if sample.memory is None else self._message(np.array(sample.memory.wrench), sample.time)

    def _message(self, wrench: np.ndarray, time: float) -> Any:
        fx, fy, fz, tx, ty, tz = wrench.tolist()
        return messages.WrenchStamped(
            header=messages.header(time, self.setup.frame(self.setup.parameters.frame_id)),
            wrench=messages.Wrench(force=messages.Vector3(x=fx, y=fy, z=fz), torque=messages.Vector3(x=tx, y=ty, z=tz)),
        )


def _of_axes(wrench: Any) -> list[Any]:
    return [getattr(getattr(wrench, vector), axis) for vector, axis in _AXES]


def _elements(interfaces: tuple[str, ...], controller: str) -> np.ndarray:
    """Return for each axis the element of the sensor's port; 6 for an axis without an interface."""
    known = [f"{vector}.{axis}" for vector, axis in _AXES]
    elements = []
    for name in interfaces:
        interface = name.rpartition("/")[2]
        if name and interface not in known:
            raise InputError(
                f"controller {controller!r}: {name!r} is not an interface of a force/torque sensor",
                valid=known,
                value=interface,
            )
        elements.append(known.index(interface) if name else len(known))
    return np.array(elements)


def _number(key: str) -> int:
    """Return the number of a filter, so that ``filter10`` comes after ``filter9``."""
    digits = re.search(r"\d+$", key)
    return int(digits[0]) if digits else 0
