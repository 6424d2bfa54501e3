"""Forward and inverse kinematics of wheeled bases."""

from math import atan, atan2, cos, fsum, inf, pi, sin, tan

from drake_twin.dataclass import dataclass

Twist = tuple[float, float, float]


@dataclass(frozen=True)
class DifferentialDrive:
    """Two sides of wheels on one axle.

    Attributes:
        wheel_separation: The distance between the sides (m).
        left_radius: Radius of the left wheels (m).
        right_radius: Radius of the right wheels (m).
    """

    wheel_separation: float
    left_radius: float
    right_radius: float

    def wheel_velocities(self, linear: float, angular: float) -> tuple[float, float]:
        """Return the velocities of the left and right wheels (rad/s) for a velocity of the base (m/s, rad/s)."""
        half = 0.5 * angular * self.wheel_separation
        return (linear - half) / self.left_radius, (linear + half) / self.right_radius

    def base_velocity(self, left: float, right: float) -> tuple[float, float]:
        """Return the base's velocity (m/s, rad/s) for those of its left and right wheels (rad/s)."""
        left, right = left * self.left_radius, right * self.right_radius
        return 0.5 * (left + right), (right - left) / self.wheel_separation


@dataclass(frozen=True)
class MecanumDrive:
    """Four mecanum wheels; their order is front left, front right, rear right, rear left.

    Attributes:
        wheel_radius: Radius of the wheels (m).
        projection: Distance from the robot's centre to a wheel along x, plus that along y (m).
        offset: The base frame in the robot's centre: x, y (m), theta (rad).
    """

    wheel_radius: float
    projection: float
    offset: Twist = (0.0, 0.0, 0.0)

    def wheel_velocities(self, linear_x: float, linear_y: float, angular: float) -> tuple[float, float, float, float]:
        """Return the velocities of the wheels (rad/s) for a velocity of the base frame (m/s, m/s, rad/s)."""
        offset_x, offset_y, theta = self.offset
        x, y = _turned(linear_x, linear_y, theta)
        x, y = x + offset_y * angular, y - offset_x * angular
        turn = self.projection * angular
        return (
            (x - y - turn) / self.wheel_radius,
            (x + y + turn) / self.wheel_radius,
            (x - y + turn) / self.wheel_radius,
            (x + y - turn) / self.wheel_radius,
        )

    def base_velocity(self, front_left: float, front_right: float, rear_right: float, rear_left: float) -> Twist:
        """Return the base frame's velocity (m/s, m/s, rad/s) for those of the wheels (rad/s)."""
        quarter = 0.25 * self.wheel_radius
        x = quarter * (front_left + front_right + rear_right + rear_left)
        y = quarter * (-front_left + front_right - rear_right + rear_left)
        angular = quarter * (-front_left + front_right + rear_right - rear_left) / self.projection
        offset_x, offset_y, theta = self.offset
        return *_turned(x - offset_y * angular, y + offset_x * angular, -theta), angular


@dataclass(frozen=True)
class OmniWheelDrive:
    """Three or more omnidirectional wheels at equal angles on a circle, counted counterclockwise.

    Attributes:
        wheel_radius: Radius of the wheels (m).
        robot_radius: Radius of the circle (m).
        count: The number of wheels.
        offset: The angle of the first wheel from the base's x axis (rad).
    """

    wheel_radius: float
    robot_radius: float
    count: int
    offset: float = 0.0

    def wheel_velocities(self, linear_x: float, linear_y: float, angular: float) -> tuple[float, ...]:
        """Return the velocities of the wheels (rad/s) for a velocity of the base (m/s, m/s, rad/s)."""
        turn = self.robot_radius * angular
        return tuple(
            (sin(angle) * linear_x - cos(angle) * linear_y - turn) / self.wheel_radius for angle in self._angles()
        )

    def base_velocity(self, *wheels: float) -> Twist:
        """Return the base's velocity (m/s, m/s, rad/s) that fits those of the wheels (rad/s) best.

        For wheels at equal angles the least squares solution is a mean over each wheel's share.
        """
        rims = [self.wheel_radius * wheel / self.count for wheel in wheels]
        x = 2.0 * fsum(rim * sin(angle) for rim, angle in zip(rims, self._angles(), strict=True))
        y = -2.0 * fsum(rim * cos(angle) for rim, angle in zip(rims, self._angles(), strict=True))
        return x, y, -fsum(rims) / self.robot_radius

    def _angles(self) -> list[float]:
        return [self.offset + 2.0 * pi * index / self.count for index in range(self.count)]


@dataclass(frozen=True)
class SteeringDrive:
    """One or two driven wheels on one axle and one or two steered ones on the other; right comes before left.

    One driven and one steered wheel are a bicycle, two and one a tricycle, two and two Ackermann's steering. As in
    ros2_controllers' steering_controllers_library, the base frame is in the middle of the driven axle.

    Attributes:
        wheelbase: The distance between the axles (m).
        wheel_radius: Radius of the driven wheels (m).
        driven: The number of driven wheels, 1 or 2.
        steered: The number of steered wheels, 1 or 2.
        driven_track: The distance between two driven wheels (m).
        steered_track: The distance between two steered wheels (m).
        largest_angle: The largest angle in the middle of the steered axle (rad).
    """

    wheelbase: float
    wheel_radius: float
    driven: int = 1
    steered: int = 1
    driven_track: float = 0.0
    steered_track: float = 0.0
    largest_angle: float = inf

    def steering_angle(self, linear: float, angular: float) -> float:
        """Return the angle (rad) in the middle of the steered axle for a velocity of the base (m/s, rad/s)."""
        if linear == 0.0:
            angle = 0.0 if angular == 0.0 else atan(angular * self.wheelbase * inf)
        else:
            angle = atan(angular * self.wheelbase / linear)
        return self.within_limits(angle)

    def within_limits(self, angle: float) -> float:
        """Return the nearest angle (rad) that the steered axle reaches."""
        return min(max(angle, -self.largest_angle), self.largest_angle)

    def mean_steering_angle(self, angles: tuple[float, ...]) -> float:
        """Return the angle (rad) in the middle of the steered axle for those of its wheels."""
        if self.steered == 1:
            return angles[0]
        half = 0.5 * self.steered_track
        right, left = (tan(angle) for angle in angles)
        base = self.wheelbase
        return 0.5 * (atan(base * right / (base - half * right)) + atan(base * left / (base + half * left)))

    def wheel_commands(
        self, linear: float, angle: float, measured: float | None = None, *, slow_while_steering: bool = False
    ) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """Compute velocities of the driven wheels (rad/s) and angles of the steered ones (rad).

        Args:
            linear: The base's commanded velocity (m/s).
            angle: The commanded angle in the middle of the steered axle (rad); see `steering_angle`.
            measured: The present angle in the middle of the steered axle (rad), for which the driven wheels turn; None
                to turn them for the commanded one.
            slow_while_steering: Whether the driven wheels turn slower while the angle is more than 30° off.
        """
        speed = linear / self.wheel_radius
        if measured is not None and slow_while_steering and abs(measured - angle) >= pi / 6.0:
            speed *= cos(min(abs(measured - angle), 1.5608)) / cos(pi / 6.0)
        present = angle if measured is None else measured
        if self.driven == 1:
            speeds: tuple[float, ...] = (speed,)
        else:
            share = self._share(present)
            speeds = (speed * (1.0 + share), speed * (1.0 - share))
        if self.steered == 1:
            return speeds, (angle,)
        if abs(present) < 1e-6:  # as upstream: the wheels begin to steer together
            return speeds, (angle, angle)
        along, across = 2.0 * self.wheelbase * cos(angle), self.steered_track * sin(angle)
        rise = 2.0 * self.wheelbase * sin(angle)
        return speeds, (atan2(rise, along + across), atan2(rise, along - across))

    def base_velocity(self, speeds: tuple[float, ...], angle: float) -> tuple[float, float]:
        """Compute the base's velocity (m/s, rad/s).

        Args:
            speeds: Velocities of the driven wheels (rad/s).
            angle: The angle in the middle of the steered axle (rad).
        """
        if self.driven == 1:
            linear = speeds[0] * self.wheel_radius
        else:
            share = self._share(angle)
            right, left = (speed * self.wheel_radius for speed in speeds)
            linear = 0.5 * (right / (1.0 + share) + left / (1.0 - share))
        return linear, tan(angle) * linear / self.wheelbase

    def _share(self, angle: float) -> float:
        """Return how much faster the outer driven wheel runs than the middle of its axle."""
        return 0.5 * self.driven_track * tan(angle) / self.wheelbase


@dataclass(frozen=True)
class SteeredDrivenWheel:
    """One wheel in front that is driven and steered, two free ones behind, as in tricycle_controller.

    Attributes:
        wheelbase: The distance from the front wheel to the rear axle (m).
        wheel_radius: Radius of the front wheel (m).
    """

    wheelbase: float
    wheel_radius: float

    def wheel_command(self, linear: float, angular: float) -> tuple[float, float]:
        """Return the front wheel's velocity (rad/s) and angle (rad) for a velocity of the base (m/s, rad/s)."""
        if linear == 0.0 and angular != 0.0:
            return abs(angular) * self.wheelbase / self.wheel_radius, 0.5 * pi if angular > 0.0 else -0.5 * pi
        angle = 0.0 if linear == 0.0 else atan(angular * self.wheelbase / linear)
        return linear / (self.wheel_radius * cos(angle)), angle

    def base_velocity(self, speed: float, angle: float) -> tuple[float, float]:
        """Return the base's velocity (m/s, rad/s) for the front wheel's (rad/s) at an angle (rad)."""
        rim = speed * self.wheel_radius
        return rim * cos(angle), rim * sin(angle) / self.wheelbase


def _turned(x: float, y: float, angle: float) -> tuple[float, float]:
    return x * cos(angle) - y * sin(angle), x * sin(angle) + y * cos(angle)
