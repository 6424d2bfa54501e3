"""Where the twin differs from upstream's assertions on purpose."""

from dataclasses import dataclass
from math import nan
from typing import Any


@dataclass(frozen=True)
class Difference:
    """What the twin does instead, and why."""

    twin: Any
    because: str


_TRAJECTORY = "joint_trajectory_controller/test/test_trajectory.cpp"
_COMPLETE_SAMPLE = "a sample is complete whatever the interpolation: what the points do not give is zero"
_SAMPLE_BEFORE = "before its first segment a trajectory stands at its begin, as a slowed-down one lags behind the clock"
_ACKERMANN = "ackermann_steering_controller/test/test_ackermann_steering_controller.cpp"
_BICYCLE = "bicycle_steering_controller/test/test_bicycle_steering_controller.cpp"
_TRICYCLE = "tricycle_steering_controller/test/test_tricycle_steering_controller.cpp"
_NO_COMMAND_YET = "upstream's test has put a command onto the interface before; here it has none, which is NaN"
_JOINT_STATES = "joint_state_broadcaster/test/test_joint_state_broadcaster.cpp"
_NO_SUCH_JOINT = "the simulation has no state of a joint that the robot's description lacks"
_NO_VALUE = "the simulation has no value for a state interface of another name, which is NaN"
_KEPT_AS_NAN = "joints that are asked for stay in the messages with NaN, so that readers see that they have no state"
_GROUPS = tuple(f"{kind}_controllers/test/test_joint_group_{kind}_controller.cpp" for kind in ("velocity", "effort"))
_HELD = "a deactivated controller writes nothing, and a joint that no controller claims holds its position"
_IMMUTABLE_GAINS = "gains of a Pid are immutable: a new Pid is made, and bad limits raise, where upstream keeps the old"

_DIFF_DRIVE = "diff_drive_controller/test/test_diff_drive_controller.cpp"
_NO_COMMAND_AGAIN = "an activated controller writes nothing until a command comes; the joint holds its position"

DELIBERATE: dict[tuple[str, int], Difference] = {
    ("control_toolbox/test/pid_tests.cpp", 80): Difference(True, _IMMUTABLE_GAINS),
    ("control_toolbox/test/pid_tests.cpp", 326): Difference(True, _IMMUTABLE_GAINS),
    (_ACKERMANN, 262): Difference(nan, _NO_COMMAND_YET),
    (_ACKERMANN, 263): Difference(nan, _NO_COMMAND_YET),
    (_BICYCLE, 246): Difference(nan, _NO_COMMAND_YET),
    (_TRICYCLE, 246): Difference(nan, _NO_COMMAND_YET),
    **{(_JOINT_STATES, line): Difference(2, _NO_SUCH_JOINT) for line in (519, 520, 572, 573)},
    **{(_JOINT_STATES, line): Difference(["joint1", "joint2"], _NO_SUCH_JOINT) for line in (521, 574)},
    (_JOINT_STATES, 817): Difference(True, _KEPT_AS_NAN),
    (_JOINT_STATES, 1054): Difference([nan], _NO_VALUE),
    **{(file, line): Difference(nan, _HELD) for file in _GROUPS for line in (234, 235, 236)},
    **{(_DIFF_DRIVE, line): Difference(nan, _NO_COMMAND_AGAIN) for line in (1174, 1176)},
    **{(_TRAJECTORY, line): Difference(True, _SAMPLE_BEFORE) for line in (133, 383, 566, 662, 840)},
    **{(_TRAJECTORY, line): Difference(1, _COMPLETE_SAMPLE) for line in (828, 830, 854, 856, 870, 872)},
}
