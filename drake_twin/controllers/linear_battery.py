"""A battery whose voltage follows from its charge and its current, as gz-sim's LinearBatteryPlugin has it."""

from dataclasses import field, replace
from typing import Any, ClassVar

from pydrake.systems.framework import Context

from drake_twin import messages
from drake_twin.controllers.base_controller import ControllerSetup
from drake_twin.controllers.periodic_controller import COMMANDED_MOTION, PeriodicController, Update
from drake_twin.controllers.registry import controller
from drake_twin.dataclass import dataclass
from drake_twin.description.gazebo_drive import LINEAR_BATTERY
from drake_twin.description.parameters import ParameterError
from drake_twin.description.robot_description import RobotDescription
from drake_twin.frozen import Frozen
from drake_twin.saved import saved

_WINDOW = 100  # steps whose currents gz-sim counts again in each step
_FULL, _STILL = 0.9, 1e-3  # of the capacity; rad/s or m/s
_EMPTY_VOLTAGE = 1e-3  # V
_HOUR = 3600.0  # s
_CHARGING, _DISCHARGING, _NOT_CHARGING, _IS_FULL = 1, 2, 3, 4  # sensor_msgs/msg/BatteryState
_TOPICS = ("draining", "recharge_start", "recharge_stop")


@dataclass(frozen=True, kw_only=True)
class LinearBatteryParameters:
    """Parameters of ``gz_sim/LinearBattery``, named after the elements of ``gz-sim-linearbatteryplugin-system``.

    Attributes:
        battery_name: The battery's name.
        voltage: The voltage before the first load (V).
        open_circuit_voltage_constant_coef: The voltage of the full battery without a load (V).
        open_circuit_voltage_linear_coef: What is added to it until the battery is empty (V).
        capacity: The charge of the full battery (Ah).
        initial_charge: The charge at the start (Ah).
        resistance: The inner resistance (Ω).
        smooth_current_tau: The time constant with which the current follows the load (s).
        power_load: The power that is drawn (W).
        start_draining: Whether it is drawn from the start on.
        charging_time: The hours in which the empty battery is charged (h); zero for one that is not recharged.
        fix_issue_225: Whether the percentage is that of the charge, from 0 to 100; else it is gz-sim's older one from
            0 to 1, which falls up to a hundred times as fast.
        invert_current_sign: Whether the current of a load is negative.
    """

    battery_name: str
    voltage: float
    open_circuit_voltage_constant_coef: float = 0.0
    open_circuit_voltage_linear_coef: float = 0.0
    capacity: float
    initial_charge: float = field(default=0.0, metadata={"lower": 0.0})
    resistance: float = 0.0
    smooth_current_tau: float = 1.0
    power_load: float = 0.0
    start_draining: bool = False
    charging_time: float = field(default=0.0, metadata={"lower": 0.0})
    fix_issue_225: bool = False
    invert_current_sign: bool = False

    def __post_init__(self) -> None:
        for name in ("capacity", "smooth_current_tau"):
            if getattr(self, name) <= 0.0:
                raise ParameterError(f"{name} is {getattr(self, name):g}, and has to be above zero", name)
        if self.initial_charge > self.capacity:
            what = f"initial_charge is {self.initial_charge:g}, which is more than the capacity of {self.capacity:g}"
            raise ParameterError(what, "initial_charge")


@saved("BatterySwitch")
@dataclass(frozen=True)
class BatterySwitch(Frozen):
    """A message that starts or ends the load or the recharge.

    Attributes:
        id: The number of the message, counted from 1.
        is_on: Whether it starts it.
    """

    id: int
    is_on: bool


@saved("BatteryMemory")
@dataclass(frozen=True)
class BatteryMemory(Frozen):
    """What a battery has.

    Attributes:
        charge: Its charge (Ah).
        voltage: Its voltage (V).
        current: The smoothed current (A).
        level: The level that is published, from 0 to 1.
        is_draining: Whether it has its load.
        is_charging: Whether it is recharged.
        currents: What the last steps have taken (As), where gz-sim counts them.
        message: The number of the last message.
    """

    charge: float
    voltage: float
    current: float = 0.0
    level: float = 1.0
    is_draining: bool = False
    is_charging: bool = False
    currents: tuple[float, ...] = ()
    message: int = 0


@controller(LINEAR_BATTERY)
class LinearBattery(PeriodicController):
    """Drain a battery by a constant power, recharge it, and publish its state.

    Behaves as gz-sim's LinearBatteryPlugin (from its sources): in each physics step the current follows power /
    voltage with a time constant, the charge is its integral, and the voltage is linear in the charge, less what the
    resistance takes. The steps since the last update are made at an update, 50 times a second, and what starts or ends
    the load counts from the update before it: a message, or the first velocity or effort that is commanded. Unlike
    there, a joint that follows a position starts it by its motion, and an empty battery does not stop the joints.

    .. pydrake_system::

        name: LinearBattery
        input_ports:
        - state
        - commanded_motion
        - draining
        - recharge_start
        - recharge_stop
        output_ports:
        - battery_state

    - ``state``: vector ``[q; v]`` of the robot (rad, rad/s, or m, m/s).
    - ``commanded_motion``: vector of one element that is not zero while a velocity or an effort is commanded.
    - ``draining``: ``std_msgs/msg/Bool``, whether it has its load, as `BatterySwitch`.
    - ``recharge_start``, ``recharge_stop``: ``std_msgs/msg/Bool`` of any value; with ``charging_time`` only.
    - ``battery_state``: ``sensor_msgs/msg/BatteryState`` of the last update; None while inactive.
    """

    Parameters: ClassVar[type] = LinearBatteryParameters

    @classmethod
    def problem(cls, parameters: Any, description: RobotDescription) -> str | None:
        """Return None: each robot may have a battery."""
        return None

    def __init__(self, setup: ControllerSetup):
        super().__init__(setup)
        names = _TOPICS if setup.parameters.charging_time else _TOPICS[:1]
        self._ports = {name: self.declare_topic_input(name, "std_msgs/msg/Bool") for name in names}
        self._commanded = self.declare_robot_input(COMMANDED_MOTION, 1)
        places = setup.layout.velocities
        self._moving = [
            places[joint.name]
            for joint in setup.description.controlled_joints.values()
            if joint.name in places and any(item.name == "position" for item in joint.command_interfaces)
        ]
        step = setup.physics_step or setup.update_period
        self._steps = max(1, round(setup.update_period / step))
        self._step = setup.update_period / self._steps
        self.declare_message_output("battery_state", "sensor_msgs/msg/BatteryState", self._message)

    def read(self, topic: str, message: Any, context: Context) -> BatterySwitch:
        """Return a message as a switch."""
        id = self.newest_id(context, *self._ports.values()) + 1
        return BatterySwitch(id, bool(message.data) if topic == "draining" else topic == "recharge_start")

    def used_id(self, memory: BatteryMemory) -> int:
        """Return the number of the last message that an update has used."""
        return memory.message

    def start(self, context: Context) -> BatteryMemory:
        """Return the battery at its start."""
        parameters: LinearBatteryParameters = self.setup.parameters
        return BatteryMemory(
            charge=parameters.initial_charge,
            voltage=parameters.voltage,
            level=parameters.initial_charge / parameters.capacity,
            is_draining=parameters.start_draining,
        )

    def update(self, context: Context, time: float, memory: BatteryMemory) -> Update:
        """Make the physics steps since the last update."""
        if time <= self.sample(context).time:  # the first update is at the start
            return Update(memory, ())
        memory = self._switched(context, memory)
        if not memory.is_draining and self._moves(context):
            memory = replace(memory, is_draining=True)
        return Update(drained(memory, self.setup.parameters, self._step, self._steps), ())

    def _switched(self, context: Context, memory: BatteryMemory) -> BatteryMemory:
        """Return the memory after the messages that no update has used, in their order."""
        pending = [(name, self.pending(context, port)) for name, port in self._ports.items()]
        for name, switch in sorted((item for item in pending if item[1] is not None), key=lambda item: item[1].id):
            changed = "is_draining" if name == "draining" else "is_charging"
            memory = replace(memory, message=switch.id, **{changed: switch.is_on})
        return memory

    def _moves(self, context: Context) -> bool:
        """Return whether the robot is commanded to move, or a joint moves that follows a position."""
        if self._commanded.HasValue(context) and self._commanded.Eval(context)[0]:
            return True
        if not self._moving:
            return False
        state = self.get_state_input_port().Eval(context)
        return any(abs(state[index]) > _STILL for index in self._moving)

    def _message(self, context: Context) -> Any:
        sample, parameters = self.sample(context), self.setup.parameters
        memory: BatteryMemory = sample.memory
        percentage = 100.0 * memory.level if parameters.fix_issue_225 else memory.level
        fields = {
            "header": messages.header(sample.time),
            "voltage": memory.voltage,
            "temperature": float("nan"),
            "current": -memory.current if parameters.invert_current_sign else memory.current,
            "charge": memory.charge,
            "capacity": parameters.capacity,
            "design_capacity": float("nan"),
            "percentage": percentage,
            "power_supply_status": _status(memory),
            "present": True,
        }
        return messages.message("sensor_msgs/msg/BatteryState", fields)


def drained(memory: BatteryMemory, parameters: LinearBatteryParameters, step: float, count: int) -> BatteryMemory:
    """Return a battery after a number of steps of a length (s)."""
    charge, voltage, current, level = memory.charge, memory.voltage, memory.current, memory.level
    currents, capacity = list(memory.currents), parameters.capacity
    power = parameters.power_load if memory.is_draining else 0.0
    gain = step / max(parameters.smooth_current_tau, step)
    for _ in range(count if memory.is_draining or memory.is_charging else 0):
        if not memory.is_charging and (abs(voltage) < _EMPTY_VOLTAGE or level < 0.0):
            voltage = voltage if level < 0.0 and abs(voltage) >= _EMPTY_VOLTAGE else 0.0
            break
        load = power / voltage if voltage else 0.0
        if memory.is_charging and level < _FULL:
            load -= capacity / parameters.charging_time
        current += gain * (load - current)
        charge -= step * current / _HOUR
        used = 1.0 - charge / capacity
        voltage = parameters.open_circuit_voltage_constant_coef + parameters.open_circuit_voltage_linear_coef * used
        voltage -= parameters.resistance * current
        if parameters.fix_issue_225:
            level = charge / capacity
        else:
            currents = [*currents[1 - _WINDOW :], step * current]
            level -= sum(currents) / _HOUR / capacity
    return replace(memory, charge=charge, voltage=voltage, current=current, level=level, currents=tuple(currents))


def _status(memory: BatteryMemory) -> int:
    if memory.is_charging:
        return _CHARGING
    if memory.is_draining:
        return _DISCHARGING
    return _IS_FULL if memory.level > _FULL else _NOT_CHARGING
