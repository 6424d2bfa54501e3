"""The errors of plans: values of ``moveit_msgs/MoveItErrorCodes``."""

from enum import IntEnum


class ErrorCode(IntEnum):
    """What has become of a plan or its execution."""

    SUCCESS = 1
    FAILURE = 99999
    PLANNING_FAILED = -1
    CONTROL_FAILED = -4
    TIMED_OUT = -6
    PREEMPTED = -7
    START_STATE_IN_COLLISION = -10
    GOAL_IN_COLLISION = -12
    INVALID_GROUP_NAME = -15
    INVALID_GOAL_CONSTRAINTS = -16
    INVALID_LINK_NAME = -18
    FRAME_TRANSFORM_FAILURE = -21
    START_STATE_INVALID = -26
    NO_IK_SOLUTION = -31


class PlanningError(Exception):
    """A request that has no plan.

    Args:
        code: Why, for the response.
        text: Why, for the log.
    """

    def __init__(self, code: ErrorCode, text: str):
        super().__init__(text)
        self.code = code
