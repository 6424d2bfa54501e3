"""tricycle_controller/test/test_traction_limiter.cpp on `TractionLimiter`, which gives no limiting factor."""

from math import nan
from sys import float_info

from drake_twin.control.tricycle_limiters import TractionLimiter
from upstream.suite import Suite, refuses

ASSERTIONS = 50
SUITE = Suite("tricycle_controller/test/test_traction_limiter.cpp")

NONE = (nan,) * 8
VELOCITY = (0.5, 1.0, nan, nan, nan, nan, nan, nan)
ACCELERATION = (nan, nan, 0.5, 1.0, 2.0, 3.0, nan, nan)
JERK = (nan, nan, nan, nan, nan, nan, 0.5, 5.0)
ALL = (0.5, 1.0, 0.5, 1.0, 2.0, 3.0, 0.5, 5.0)
ALL_BUT_VELOCITY = (nan, nan, 0.5, 1.0, 2.0, 3.0, 0.5, 5.0)

PAIRS = ((-10.0, nan), (-10.0, -20.0), (nan, -10.0), (20.0, 10.0))
WRONG = (
    (22, NONE, False),
    *(
        (line + 13 * n, (nan,) * place + pair + (nan,) * (6 - place), True)
        for line, place in ((36, 0), (91, 2), (146, 4), (201, 6))
        for n, pair in enumerate(PAIRS)
    ),
)
LIMITED = (  # line, limits, velocity, the one before (which was the same before that), expected
    (261, NONE, 10.0, 0.0, 10.0),
    (266, NONE, -10.0, 0.0, -10.0),
    (277, VELOCITY, 10.0, 0.0, 1.0),
    (283, VELOCITY, 0.1, 0.0, 0.5),
    (290, VELOCITY, 0.0, 0.0, 0.5),
    (296, VELOCITY, -10.0, 0.0, -1.0),
    (302, VELOCITY, -0.1, 0.0, -0.5),
    (311, ALL, 10.0, 0.0, 0.5),
    (318, ALL, -10.0, 0.0, -0.5),
    (332, NONE, 10.0, 0.0, 10.0),
    (338, NONE, -10.0, 0.0, -10.0),
    (350, ALL_BUT_VELOCITY, 10.0, 0.0, 0.5),
    (357, ALL_BUT_VELOCITY, -10.0, 0.0, -0.5),
    (369, JERK, 10.0, 0.0, 2.5),
    (375, JERK, -10.0, 0.0, -2.5),
    (391, ACCELERATION, 10.0, 0.0, 0.5),
    (397, ACCELERATION, -10.0, 0.0, -0.5),
    (409, ACCELERATION, 0.0, 0.0, 0.25),
    (415, ACCELERATION, -float_info.epsilon, 0.0, -0.25),
    (426, ALL_BUT_VELOCITY, 10.0, 0.0, 0.5),
    (432, ALL_BUT_VELOCITY, -10.0, 0.0, -0.5),
    (448, ACCELERATION, 0.0, 10.0, 8.5),
    (454, ACCELERATION, 0.0, -10.0, -8.5),
    (466, ACCELERATION, 9.9, 10.0, 9.0),
    (471, ACCELERATION, -9.9, -10.0, -9.0),
    (480, ALL_BUT_VELOCITY, 0.0, 10.0, 8.5),
    (486, ALL_BUT_VELOCITY, 0.0, -10.0, -8.5),
    (502, JERK, 10.0, 0.0, 2.5),
    (508, JERK, -10.0, 0.0, -2.5),
    (521, JERK, 0.0, 0.0, 0.25),
    (527, JERK, -float_info.epsilon, 0.0, -0.25),
    (538, ALL_BUT_VELOCITY, 10.0, 0.0, 0.5),
    (544, ALL_BUT_VELOCITY, -10.0, 0.0, -0.5),
)


@SUITE.table(WRONG)
def limits_that_are_negative_or_in_the_wrong_order(limits):
    return refuses(lambda: TractionLimiter(*limits), ValueError)


@SUITE.table(LIMITED)
def velocities_are_limited(limits, velocity, before):
    return TractionLimiter(*limits).limited(velocity, before, before, 0.5)


test_holds_against_upstream = SUITE.test()
