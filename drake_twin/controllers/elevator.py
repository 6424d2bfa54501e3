"""An elevator with a door at each floor, as gz-sim's Elevator drives it."""

from dataclasses import field, replace
from typing import Any, ClassVar

from pydrake.systems.framework import Context

from drake_twin import messages
from drake_twin.control.elevator_states import ElevatorState, Measured, asked, updated
from drake_twin.controllers.base_controller import ControllerSetup
from drake_twin.controllers.periodic_controller import PeriodicController, Update
from drake_twin.controllers.registry import controller
from drake_twin.dataclass import dataclass
from drake_twin.description.elevator_shaft import Shaft
from drake_twin.description.gazebo_drive import ELEVATOR
from drake_twin.description.parameters import ParameterError
from drake_twin.description.robot_description import RobotDescription
from drake_twin.errors import CommandError
from drake_twin.frozen import Frozen
from drake_twin.saved import saved

_NUMBER, _FLAG, _NUMBERS = "std_msgs/msg/Int32", "std_msgs/msg/Bool", "std_msgs/msg/Int32MultiArray"


@dataclass(frozen=True, kw_only=True)
class ElevatorParameters:
    """Parameters of ``gz_sim/Elevator``, as ``gz-sim-elevator-system`` takes them from its elements and its model.

    Attributes:
        cabin_joint: The joint that moves the cabin.
        floor_heights: The position of that joint at each floor (m).
        door_joints: The joint of each floor's door.
        open_door_positions: The position of each open door (m or rad); closed doors are at zero.
        open_door_wait_duration: How long a door stays open (s).
        state_publish_rate: The rate at which the floor is published (Hz), which is not more than the update rate.
    """

    cabin_joint: str
    floor_heights: tuple[float, ...]
    door_joints: tuple[str, ...]
    open_door_positions: tuple[float, ...]
    open_door_wait_duration: float = field(default=5.0, metadata={"lower": 0.0})
    state_publish_rate: float = field(default=5.0, metadata={"lower": 0.0})

    def __post_init__(self) -> None:
        for name in ("door_joints", "open_door_positions"):
            if len(getattr(self, name)) != len(self.floor_heights) or not self.floor_heights:
                raise ParameterError(f"{name} needs one entry for each of the floor_heights", name)

    @property
    def shaft(self) -> Shaft:
        """The floors and doors."""
        return Shaft(self.floor_heights, self.open_door_positions, self.open_door_wait_duration)


@saved("ElevatorCall")
@dataclass(frozen=True)
class ElevatorCall(Frozen):
    """A message that calls the elevator, or says whether a doorway is blocked.

    Attributes:
        id: The number of the message, counted from 1.
        value: The floor, or whether.
    """

    id: int
    value: int


@controller(ELEVATOR)
class Elevator(PeriodicController):
    """Move a cabin to the floors that are asked for, and open and close a door at each.

    Behaves as gz-sim's Elevator (from its sources), but that the floor is the nearest one, and that of several floors
    that are asked for in one physics step the last one counts.

    .. pydrake_system::

        name: Elevator
        input_ports:
        - state
        - cmd
        - doorway_0
        output_ports:
        - floor
        - orders

    - ``state``: vector ``[q; v]`` of the robot (rad, rad/s, or m, m/s).
    - ``cmd``: ``std_msgs/msg/Int32``, a floor to go to, counted from 0.
    - ``doorway_0``, and one for each other floor: ``std_msgs/msg/Bool``, whether something stands in it.
    - ``floor``: ``std_msgs/msg/Int32``, the floor that the cabin is nearest to; None between two publications.
    - ``orders``: ``std_msgs/msg/Int32MultiArray``, what the last update wants of the joints: floor i for the cabin is
      the number i, to open door i number of floors + i, to close it twice the number of floors + i.
    """

    Parameters: ClassVar[type] = ElevatorParameters

    @classmethod
    def problem(cls, parameters: Any, description: RobotDescription) -> str | None:
        """Return which joint the robot does not have; None if it has all."""
        movable = {joint.name for joint in description.movable_joints}
        wanted = (parameters.cabin_joint, *parameters.door_joints)
        missing = next((joint for joint in wanted if joint not in movable), None)
        return None if missing is None else f"the robot has no movable joint {missing!r}"

    def __init__(self, setup: ControllerSetup):
        super().__init__(setup)
        parameters: ElevatorParameters = setup.parameters
        self._shaft = parameters.shaft
        self._cmd = self.declare_topic_input("cmd", _NUMBER)
        floors = range(len(self._shaft.floors))
        self._doorways = [self.declare_topic_input(f"doorway_{floor}", _FLAG) for floor in floors]
        self._joints = (parameters.cabin_joint, *parameters.door_joints)
        rate = parameters.state_publish_rate
        self._told_every = 1.0 / rate if rate else 0.0
        self.declare_message_output("floor", _NUMBER, self._floor)
        self.declare_message_output("orders", _NUMBERS, self._orders)

    def read(self, topic: str, message: Any, context: Context) -> ElevatorCall:
        """Return a message as a call.

        Raises:
            CommandError: If no floor has this number.
        """
        if topic != "cmd":
            return ElevatorCall(0, int(message.data))
        count = len(self._shaft.floors)
        if not 0 <= message.data < count:
            raise CommandError(f"{message.data} is not a floor: they are from 0 to {count - 1}")
        return ElevatorCall(self.newest_id(context, self._cmd) + 1, int(message.data))

    def used_id(self, memory: ElevatorState) -> int:
        """Return the number of the last message that an update has used."""
        return memory.message

    def start(self, context: Context) -> ElevatorState:
        """Return an elevator that is idle."""
        return ElevatorState()

    def update(self, context: Context, time: float, memory: ElevatorState) -> Update:
        """Look at the joints, and go on."""
        state = replace(memory, orders=())
        call = self.pending(context, self._cmd)
        if call is not None:
            state = replace(asked(state, call.value, self._shaft), message=call.id)
        blocked = [self.received(port, context) for port in self._doorways]
        positions = self.positions(context, self._joints).tolist()
        cabin, *doors = zip(positions, self.velocities(context, self._joints).tolist(), strict=True)
        is_blocked = [call is not None and bool(call.value) for call in blocked]
        state = updated(state, Measured(time, cabin, doors, is_blocked), self._shaft)
        is_told = state.told is None or time - state.told >= self._told_every - 1e-9
        return Update(replace(state, is_told=is_told, told=time if is_told else state.told), ())

    def _floor(self, context: Context) -> Any:
        state: ElevatorState | None = self.sample(context).memory
        return messages.message(_NUMBER, {"data": state.floor}) if state is not None and state.is_told else None

    def _orders(self, context: Context) -> Any:
        state: ElevatorState | None = self.sample(context).memory
        return None if state is None else messages.message(_NUMBERS, {"data": list(state.orders)})
