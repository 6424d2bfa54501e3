"""joint_trajectory_controller/test/test_trajectory_controller.cpp: the checks of a message, with `checked_trajectory`.

Upstream runs them with several sets of interfaces; line 1892 is the one with effort commands, 1896 those without.
"""

from drake_twin.control.trajectory import TrajectoryPoint
from drake_twin.control.trajectory_check import TrajectoryRules, checked_trajectory
from drake_twin.errors import CommandError
from upstream.suite import Suite, refuses

ASSERTIONS = 23
SUITE = Suite("joint_trajectory_controller/test/test_trajectory_controller.cpp")

JOINTS = ("joint1", "joint2", "joint3")
NOW = 1000.0  # s; upstream's clock
GOOD = {"positions": (1.0, 2.0, 3.0), "velocities": (-1.0, -2.0, -3.0)}
THREE = (1.0, 2.0, 3.0)


def is_valid(point, *, joints=JOINTS, times=(0.25,), start=None, **rules):
    rules = TrajectoryRules(JOINTS, **({"allow_nonzero_velocity_at_end": True} | rules))
    points = [TrajectoryPoint(**point)] * len(times)
    return not refuses(lambda: checked_trajectory(rules, joints, points, times, start, NOW), CommandError)


@SUITE.table(
    (
        (1847, GOOD, {}, True),
        (1852, GOOD, {"joints": ("bad_name",)}, False),
        (1857, GOOD, {"times": ()}, False),
        (1862, {"velocities": GOOD["velocities"]}, {}, False),
        (1867, GOOD | {"positions": (1.0, 2.0)}, {}, False),
        (1872, GOOD | {"positions": (1.0, 2.0, 3.0, 4.0)}, {}, False),
        (1877, GOOD | {"velocities": (1.0, 2.0)}, {}, False),
        (1882, GOOD | {"accelerations": (1.0, 2.0)}, {}, False),
        (1892, GOOD | {"effort": THREE}, {"has_effort": True}, True),
        (1896, GOOD | {"effort": THREE}, {}, False),
        (1902, GOOD, {"times": (0.25, 0.25)}, False),
        (1907, GOOD, {"start": 1e-9}, False),
        (1913, GOOD, {"start": NOW, "times": (10.0,)}, True),
    )
)
def invalid_messages(point, more):
    return is_valid(point, **more)


@SUITE.table(((1933, (), False), (1942, (0.25,), False)))
def velocity_at_the_end(times):
    return is_valid(GOOD, times=times, allow_nonzero_velocity_at_end=False)


ALL = GOOD | {"accelerations": THREE}


@SUITE.table(
    (
        (1969, ALL, True),
        (1974, ALL | {"positions": ()}, True),
        (1980, {"accelerations": THREE}, True),
        (1987, {}, False),
        (1992, ALL | {"positions": (1.0, 2.0)}, False),
        (1997, ALL | {"positions": (1.0, 2.0, 3.0, 4.0)}, False),
        (2002, ALL | {"velocities": (1.0,)}, False),
        (2007, ALL | {"accelerations": (2.0,)}, False),
    )
)
def missing_positions(point):
    return is_valid(point, allow_integration=True)


test_holds_against_upstream = SUITE.test()
