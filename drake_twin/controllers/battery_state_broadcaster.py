"""The states of batteries as messages, as ros2_controllers' battery_state_broadcaster publishes them."""

from collections.abc import Iterable, Mapping
from dataclasses import field, fields
from math import fsum, isfinite, isnan, nan
from typing import Any, ClassVar

import numpy as np
from pydrake.systems.framework import Context

from drake_twin import messages
from drake_twin.controllers.base_controller import ControllerSetup
from drake_twin.controllers.hardware_sensor_broadcaster import HardwareSensorBroadcaster
from drake_twin.controllers.registry import controller
from drake_twin.dataclass import dataclass
from drake_twin.description.parameters import ParameterError

_TECHNOLOGY = {"lower": 0, "upper": 8}


@dataclass(frozen=True)
class BatteryInterfaces:
    """Which state interfaces of a battery are read beside ``battery_voltage``.

    Attributes:
        battery_temperature: Whether the temperature is read (°C).
        battery_current: Whether the current is read (A).
        battery_charge: Whether the charge is read (Ah).
        battery_percentage: Whether the charge level is read (0 to 100); else it follows linearly from the voltage and
            its two bounds, if they are given.
        battery_power_supply_status: Whether the status is read, as numbered in ``BatteryState``.
        battery_power_supply_health: Whether the health is read, as numbered in ``BatteryState``.
        battery_present: Whether the presence is read; else a battery with a voltage is present.
    """

    battery_temperature: bool = False
    battery_current: bool = False
    battery_charge: bool = False
    battery_percentage: bool = False
    battery_power_supply_status: bool = False
    battery_power_supply_health: bool = False
    battery_present: bool = False


@dataclass(frozen=True)
class BatteryProperties:
    """What is known of a battery.

    Attributes:
        minimum_voltage: The voltage of an empty battery (V).
        maximum_voltage: The voltage of a full battery (V).
        capacity: The last known capacity (Ah).
        design_capacity: The capacity by design (Ah).
        power_supply_technology: The chemistry, as numbered in ``BatteryState``.
        location: Where the battery is.
        serial_number: Its serial number.
    """

    minimum_voltage: float = nan
    maximum_voltage: float = nan
    capacity: float = nan
    design_capacity: float = nan
    power_supply_technology: int = field(default=0, metadata=_TECHNOLOGY)
    location: str = ""
    serial_number: str = ""

    def percentage(self, voltage: float) -> float:
        """Return the charge level (0 to 100) at a voltage (V); NaN without the two bounds."""
        if not (isfinite(self.minimum_voltage) and isfinite(self.maximum_voltage)):
            return nan
        return (voltage - self.minimum_voltage) * 100.0 / (self.maximum_voltage - self.minimum_voltage)


@dataclass(frozen=True)
class BatteryStateBroadcasterParameters:
    """Parameters of ``battery_state_broadcaster/BatteryStateBroadcaster``.

    Attributes:
        batteries: The batteries: sensors in ``<ros2_control>``.
        interfaces: The state interfaces of each battery.
        properties: The properties of each battery.
        sensor_name: A single battery with the state interface ``voltage``, instead of ``batteries``; deprecated in
            Jazzy.
        design_capacity: The capacity by design of ``sensor_name`` (Ah).
        power_supply_technology: The chemistry of ``sensor_name``, as numbered in ``BatteryState``.
    """

    read_only: ClassVar[tuple[str, ...]] = ("*",)

    batteries: tuple[str, ...] = ()
    interfaces: Mapping[str, BatteryInterfaces] = field(default_factory=dict, metadata={"keys": "batteries"})
    properties: Mapping[str, BatteryProperties] = field(
        default_factory=dict, metadata={"of_joints": True, "keys": "batteries"}
    )
    sensor_name: str = ""
    design_capacity: float = nan
    power_supply_technology: int = field(default=0, metadata=_TECHNOLOGY)

    def __post_init__(self) -> None:
        if bool(self.batteries) == bool(self.sensor_name):
            what = "and not both" if self.batteries else "and neither is given"
            raise ParameterError(f"batteries or sensor_name is needed, {what}")
        if len(set(self.batteries)) < len(self.batteries):
            raise ParameterError(f"batteries has a name twice: {', '.join(self.batteries)}", "batteries")
        for name in self.batteries:
            known = self.properties_of(name)
            if known.minimum_voltage >= known.maximum_voltage and not self.interfaces_of(name).battery_percentage:
                raise ParameterError(
                    f"battery {name!r}: maximum_voltage ({known.maximum_voltage:g}) is not above minimum_voltage"
                    f" ({known.minimum_voltage:g})",
                    name,
                    "maximum_voltage",
                )

    def interfaces_of(self, battery: str) -> BatteryInterfaces:
        """Return which state interfaces of a battery are read."""
        return self.interfaces.get(battery, BatteryInterfaces())

    def properties_of(self, battery: str) -> BatteryProperties:
        """Return the properties of a battery."""
        return self.properties.get(battery, BatteryProperties())

    def interface_names(self, battery: str) -> tuple[str, ...]:
        """Return the state interfaces of a battery that are read, in upstream's order."""
        read = self.interfaces_of(battery)
        return ("battery_voltage", *(item.name for item in fields(read) if getattr(read, item.name)))


@controller("battery_state_broadcaster/BatteryStateBroadcaster")
class BatteryStateBroadcaster(HardwareSensorBroadcaster):
    """Publish the states of batteries as ``BatteryState`` messages: all of them together, and each one.

    Behaves as ``battery_state_broadcaster/BatteryStateBroadcaster`` in ROS 2 Jazzy. Together, voltage, temperature,
    current and percentage are means, charge and capacities are sums, status and health are the highest number, and the
    technology is that of all batteries or unknown. The twin does not simulate batteries: the values are the state
    interfaces' ``initial_value`` in ``<ros2_control>``, or NaN; a status or health that is NaN is unknown. Unlike
    upstream, ``interfaces`` and the properties of a battery may be left out, which stands for their defaults, and the
    sum of the capacities stays the same when the broadcaster is activated again.

    .. pydrake_system::

        name: BatteryStateBroadcaster
        input_ports:
        - values
        output_ports:
        - battery_state
        - raw_battery_states

    - ``values``: vector of the state interfaces, in the order of `state_interfaces` (V, °C, A, Ah).
    - ``battery_state``: ``sensor_msgs/msg/BatteryState`` of all batteries at the present time, None while inactive;
      topic ``~/battery_state``.
    - ``raw_battery_states``: ``control_msgs/msg/BatteryStateArray`` with one state for each of ``batteries``, None
      while inactive; topic ``~/raw_battery_states``.
    """

    Parameters: ClassVar[type] = BatteryStateBroadcasterParameters

    @classmethod
    def sensor_name(cls, parameters: BatteryStateBroadcasterParameters) -> str:
        """Return the name of the first battery."""
        return parameters.sensor_name or parameters.batteries[0]

    @classmethod
    def state_interfaces(cls, parameters: BatteryStateBroadcasterParameters) -> tuple[str, ...]:
        """Return the voltage of each battery and what else is read of it."""
        if parameters.sensor_name:
            return (f"{parameters.sensor_name}/voltage",)
        return tuple(f"{name}/{item}" for name in parameters.batteries for item in parameters.interface_names(name))

    def __init__(self, setup: ControllerSetup):
        super().__init__(setup)
        parameters: BatteryStateBroadcasterParameters = setup.parameters
        named = dict.fromkeys((*parameters.interfaces, *parameters.properties))
        self.warnings += tuple(
            f"the parameters of {name!r} are ignored: it is not in batteries"
            for name in named
            if name not in parameters.batteries
        )
        self._indices = {name: index for index, name in enumerate(self.state_interfaces(parameters))}
        kind = "sensor_msgs/msg/BatteryState"
        self.declare_message_output("battery_state", kind, self._battery_state, self._present())
        self.declare_message_output(
            "raw_battery_states",
            "control_msgs/msg/BatteryStateArray",
            self._raw_battery_states,
            self._present(),
        )

    def _raw_battery_states(self, context: Context) -> Any:
        return messages.BatteryStateArray(self._states(context))

    def _battery_state(self, context: Context) -> Any:
        parameters: BatteryStateBroadcasterParameters = self.setup.parameters
        header = messages.header(context.get_time())
        if parameters.sensor_name:
            return _battery_state(
                header=header,
                voltage=float(self._sensor.Eval(context)[0]),
                capacity=0.0,
                design_capacity=parameters.design_capacity,
                power_supply_technology=parameters.power_supply_technology,
            )
        states = self._states(context)
        pairs = list(zip(parameters.batteries, states, strict=True))

        def read(quantity: str) -> list[float]:
            """Return a quantity of the batteries whose state interface is read."""
            return [
                getattr(state, quantity)
                for name, state in pairs
                if getattr(parameters.interfaces_of(name), f"battery_{quantity}")
            ]

        from_voltage = [
            state.percentage
            for name, state in pairs
            if not parameters.interfaces_of(name).battery_percentage
            and not isnan(parameters.properties_of(name).percentage(0.0))
        ]
        technologies = {state.power_supply_technology for state in states}
        return _battery_state(
            header=header,
            voltage=_mean(state.voltage for state in states),
            temperature=_mean(read("temperature")),
            current=_mean(read("current")),
            charge=fsum(read("charge")) if read("charge") else nan,
            capacity=fsum(state.capacity for state in states),
            design_capacity=fsum(state.design_capacity for state in states),
            percentage=_mean([*read("percentage"), *from_voltage]),
            power_supply_status=max(state.power_supply_status for state in states),
            power_supply_health=max(state.power_supply_health for state in states),
            power_supply_technology=technologies.pop() if len(technologies) == 1 else 0,
            location="".join(f"{state.location}, " for state in states),
            serial_number="".join(f"{state.serial_number}, " for state in states),
        )

    def _states(self, context: Context) -> list[Any]:
        """Return the state of each of ``batteries``."""
        values = self._sensor.Eval(context).tolist()
        time = context.get_time()
        return [self._state(name, values, time) for name in self.setup.parameters.batteries]

    def _state(self, battery: str, values: list[float], time: float) -> Any:
        def value(interface: str) -> float:
            index = self._indices.get(f"{battery}/battery_{interface}")
            return nan if index is None else float(values[index])

        read, known = self.setup.parameters.interfaces_of(battery), self.setup.parameters.properties_of(battery)
        voltage = value("voltage")
        presence = value("present") if read.battery_present else voltage
        return _battery_state(
            header=messages.header(time, battery),
            voltage=voltage,
            temperature=value("temperature"),
            current=value("current"),
            charge=value("charge"),
            capacity=known.capacity,
            design_capacity=known.design_capacity,
            percentage=value("percentage") if read.battery_percentage else known.percentage(voltage),
            power_supply_status=_number(value("power_supply_status")),
            power_supply_health=_number(value("power_supply_health")),
            power_supply_technology=known.power_supply_technology,
            present=not isnan(presence) and presence != 0.0,
            location=known.location,
            serial_number=known.serial_number,
        )


def _battery_state(**given: Any) -> Any:
    """Return a ``sensor_msgs/msg/BatteryState`` with what is not given unknown."""
    unknown = dict.fromkeys(("temperature", "current", "charge", "percentage"), nan)
    numbers = dict.fromkeys(("power_supply_status", "power_supply_health", "power_supply_technology"), 0)
    return messages.BatteryState(
        **{
            **unknown,
            **numbers,
            "present": True,
            "cell_voltage": np.array([], dtype=np.float32),
            "cell_temperature": np.array([], dtype=np.float32),
            "location": "",
            "serial_number": "",
            **given,
        }
    )


def _mean(values: Iterable[float]) -> float:
    items = list(values)
    return fsum(items) / len(items) if items else nan


def _number(value: float) -> int:
    return 0 if isnan(value) else int(value)
