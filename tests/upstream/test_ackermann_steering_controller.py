"""ackermann_steering_controller/test/test_ackermann_steering_controller.cpp on the twin's controller."""

from upstream.steering import add_scenarios
from upstream.suite import Suite

ASSERTIONS = 38
SUITE = Suite("ackermann_steering_controller/test/test_ackermann_steering_controller.cpp")
PARAMETERS = {
    "reference_timeout": 2.0,
    "open_loop": False,
    "velocity_rolling_window_size": 10,
    "position_feedback": False,
    "traction_joints_names": ["rear_right_wheel_joint", "rear_left_wheel_joint"],
    "steering_joints_names": ["front_right_steering_joint", "front_left_steering_joint"],
    "wheelbase": 3.24644,
    "traction_wheels_radius": 0.45,
    "traction_track_width": 1.76868,
}
SPEED, ANGLE = 0.22222222222222224, 1.4179821977774734

add_scenarios(
    SUITE,
    "ackermann_steering_controller/AckermannSteeringController",
    PARAMETERS,
    (SPEED, SPEED, ANGLE, ANGLE),
    driven=2,
    lines={
        "parameters": (34, 36, 38, 39, 40, 41, 42, 43),
        "claims": (53, 54, 57, 60, 63),
        "references": (86, 91, 95),
        "reactivated": (144, 146),
        "update": (176, 179, 182, 185),
        "chained": (219, 222, 225, 228),
        "received": (260, 261, 262, 263, 273, 276, 279, 282, 289, 291, 293, 294),
    },
)

test_holds_against_upstream = SUITE.test()
