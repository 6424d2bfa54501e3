"""tricycle_steering_controller/test/test_tricycle_steering_controller.cpp on the twin's controller."""

from upstream.steering import add_scenarios
from upstream.suite import Suite

ASSERTIONS = 32
SUITE = Suite("tricycle_steering_controller/test/test_tricycle_steering_controller.cpp")
PARAMETERS = {
    "reference_timeout": 2.0,
    "open_loop": False,
    "velocity_rolling_window_size": 10,
    "position_feedback": False,
    "traction_joints_names": ["rear_right_wheel_joint", "rear_left_wheel_joint"],
    "steering_joints_names": ["steering_axis_joint"],
    "wheelbase": 3.24644,
    "traction_wheels_radius": 0.45,
    "wheel_track": 1.212121,
}
SPEED, ANGLE = 0.22222222222222224, 1.4179821977774734

add_scenarios(
    SUITE,
    "tricycle_steering_controller/TricycleSteeringController",
    PARAMETERS,
    (SPEED, SPEED, ANGLE),
    driven=2,
    lines={
        "parameters": (34, 36, 38, 39, 40, 41, 42, 43),
        "claims": (53, 54, 57, 60),
        "references": (79, 85, 88),
        "reactivated": (137, 139),
        "update": (168, 171, 174),
        "chained": (206, 209, 212),
        "received": (244, 245, 246, 256, 259, 262, 269, 271, 273),
    },
)

test_holds_against_upstream = SUITE.test()
