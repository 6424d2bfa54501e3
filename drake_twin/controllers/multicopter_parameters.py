"""The parameters of a multicopter's controller."""

from dataclasses import field

from drake_twin.dataclass import dataclass
from drake_twin.description.parameters import ParameterError

_FAST = (1e300, 1e300, 1e300)


@dataclass(frozen=True, kw_only=True)
class MulticopterParameters:
    """Parameters of ``gz_sim/Multicopter``, named after the elements of gz-sim's two systems; lists go rotor by rotor.

    Attributes:
        joints: The rotors' joints.
        links: Their links; thrust is along z.
        actuator_numbers: The place of each in a message's velocities.
        turning_directions: 1 for counter-clockwise, -1 for clockwise.
        motor_constants: The thrust ÷ the square of the speed (N·s²).
        moment_constants: The moment on the body ÷ the thrust (m).
        max_rot_velocities: The largest speed (rad/s).
        time_constants_up: The lag of a speed that rises (s).
        time_constants_down: The lag of one that falls (s).
        rotor_drag_coefficients: The drag ÷ the speed and the velocity across the axis (kg).
        rolling_moment_coefficients: The rolling moment ÷ the same (kg·m).
        rotor_velocity_slowdowns: The speed ÷ the velocity of the joint.
        controls_velocity: Whether it follows velocities, and not speeds of rotors.
        com_link: The link whose velocity is controlled.
        velocity_gain: The force for an error of the velocity (N·s/m).
        attitude_gain: The moment for an error of the orientation (N·m).
        angular_rate_gain: The moment for an error of the angular velocity (N·m·s).
        maximum_linear_acceleration: For an error of the velocity (m/s²).
        maximum_linear_velocity: Of a command (m/s).
        maximum_angular_velocity: Of a command (rad/s).
        control_joints: The rotors' joints as the controller of the velocity knows them.
        control_force_constants: As it knows their ``motor_constants``.
        control_moment_constants: As it knows their ``moment_constants``.
        control_directions: As it knows their ``turning_directions``.
    """

    joints: tuple[str, ...]
    links: tuple[str, ...]
    actuator_numbers: tuple[int, ...] = field(metadata={"lower": 0})
    turning_directions: tuple[int, ...] = field(metadata={"choices": (1, -1)})
    motor_constants: tuple[float, ...]
    moment_constants: tuple[float, ...]
    max_rot_velocities: tuple[float, ...]
    time_constants_up: tuple[float, ...]
    time_constants_down: tuple[float, ...]
    rotor_drag_coefficients: tuple[float, ...]
    rolling_moment_coefficients: tuple[float, ...]
    rotor_velocity_slowdowns: tuple[float, ...]
    controls_velocity: bool = False
    com_link: str = ""
    velocity_gain: tuple[float, ...] = ()
    attitude_gain: tuple[float, ...] = ()
    angular_rate_gain: tuple[float, ...] = ()
    maximum_linear_acceleration: tuple[float, ...] = _FAST
    maximum_linear_velocity: tuple[float, ...] = _FAST
    maximum_angular_velocity: tuple[float, ...] = _FAST
    control_joints: tuple[str, ...] = ()
    control_force_constants: tuple[float, ...] = ()
    control_moment_constants: tuple[float, ...] = ()
    control_directions: tuple[int, ...] = ()

    def __post_init__(self) -> None:
        lists = [name for name in vars(type(self))["__annotations__"] if name.endswith("s") and name in _OF_ROTORS]
        for name in lists:
            if len(getattr(self, name)) != len(self.joints):
                raise ParameterError(
                    f"{name} has {len(getattr(self, name))} entries for {len(self.joints)} joints", name
                )
        for name in ("time_constants_up", "time_constants_down", "rotor_velocity_slowdowns", "max_rot_velocities"):
            for value in getattr(self, name):
                if value <= 0.0:
                    raise ParameterError(f"{name} has {value:g}, which is not above zero", name)


_OF_ROTORS = (
    *("links", "actuator_numbers", "turning_directions", "motor_constants", "moment_constants"),
    *("max_rot_velocities", "time_constants_up", "time_constants_down", "rotor_drag_coefficients"),
    *("rolling_moment_coefficients", "rotor_velocity_slowdowns"),
)
