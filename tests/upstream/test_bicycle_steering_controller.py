"""bicycle_steering_controller/test/test_bicycle_steering_controller.cpp on the twin's controller."""

from upstream.steering import add_scenarios
from upstream.suite import Suite

ASSERTIONS = 25
SUITE = Suite("bicycle_steering_controller/test/test_bicycle_steering_controller.cpp")
PARAMETERS = {
    "reference_timeout": 2.0,
    "open_loop": False,
    "velocity_rolling_window_size": 10,
    "position_feedback": False,
    "traction_joints_names": ["rear_wheel_joint"],
    "steering_joints_names": ["steering_axis_joint"],
    "wheelbase": 3.24644,
    "traction_wheel_radius": 0.45,
}

add_scenarios(
    SUITE,
    "bicycle_steering_controller/BicycleSteeringController",
    PARAMETERS,
    (0.1 / 0.45, 1.4179821977774734),
    driven=1,
    lines={
        "parameters": (34, 36, 38, 39, 40, 41, 42),
        "claims": (52, 53, 56),
        "references": (72, 77, 81),
        "reactivated": (130, 132),
        "update": (161, 164),
        "chained": (195, 198),
        "received": (245, 246, 255, 258, 264, 265),
    },
)

test_holds_against_upstream = SUITE.test()
