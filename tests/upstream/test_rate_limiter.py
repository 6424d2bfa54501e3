"""control_toolbox/test/rate_limiter.cpp (05de3c6) on the twin's `SpeedLimiter`, which gives no limiting factor."""

from math import nan

from drake_twin.control.speed_limiter import SpeedLimiter
from upstream.suite import Suite, refuses

ASSERTIONS = 41
SUITE = Suite("control_toolbox/test/rate_limiter.cpp")

# In upstream's order: minimum and maximum of the value, of the first derivative, of it with the other sign of the
# value, of the second derivative.
NONE = (nan,) * 8
VALUE = (-0.5, 1.0, nan, nan, nan, nan, nan, nan)
FIRST = (nan, nan, -0.5, 1.0, nan, nan, nan, nan)
ASYMMETRIC = (nan, nan, -0.5, 1.0, -5.0, 10.0, nan, nan)
SECOND = (nan, nan, nan, nan, nan, nan, -1.0, 1.0)

WRONG = (  # line, limits, whether they are refused
    (23, (-1.0, nan, -1.0, 1.0, nan, nan, -1.0, 1.0), False),
    (28, (nan, nan, -1.0, 1.0, nan, nan, -1.0, 1.0), False),
    (33, (nan, 1.0, -1.0, 1.0, nan, nan, -1.0, 1.0), False),
    (38, (1.0, -1.0, -1.0, 1.0, nan, nan, -1.0, 1.0), True),
    (45, (-1.0, 1.0, -1.0, nan, nan, nan, -1.0, 1.0), False),
    (50, (-1.0, 1.0, nan, nan, nan, nan, -1.0, 1.0), False),
    (55, (-1.0, 1.0, nan, 1.0, nan, nan, -1.0, 1.0), False),
    (60, (-1.0, 1.0, 1.0, -1.0, nan, nan, -1.0, 1.0), True),
    (65, (-1.0, 1.0, -1.0, 1.0, -10.0, nan, -1.0, 1.0), False),
    (68, (-1.0, 1.0, -1.0, 1.0, nan, 10.0, -1.0, 1.0), False),
    (71, (-1.0, 1.0, 1.0, -1.0, 10.0, -10.0, -1.0, 1.0), True),
    (76, (-1.0, 1.0, -1.0, 1.0, nan, nan, -1.0, nan), False),
    (80, (-1.0, 1.0, -1.0, 1.0, nan, nan, nan, nan), False),
    (85, (-1.0, 1.0, -1.0, 1.0, nan, nan, nan, 1.0), False),
    (89, (-1.0, 1.0, -1.0, 1.0, nan, nan, 1.0, -1.0), True),
)
ALL = (-0.5, 1.0, -0.5, 1.0, nan, nan, -2.0, 5.0)
LIMITED = (  # line, limits, value, the value before (which was the same before that), expected
    (102, NONE, 10.0, 0.0, 10.0),
    (107, NONE, -10.0, 0.0, -10.0),
    (121, VALUE, 10.0, 0.0, 1.0),
    (126, VALUE, -10.0, 0.0, -0.5),
    (135, ALL, 10.0, 0.0, 0.5),
    (141, ALL, -10.0, 0.0, -0.25),
    (156, NONE, 10.0, 0.0, 10.0),
    (161, NONE, -10.0, 0.0, -10.0),
    (174, (nan, nan, -0.5, 1.0, nan, nan, -2.0, 2.0), 10.0, 0.0, 0.5),
    (180, (nan, nan, -0.5, 1.0, nan, nan, -2.0, 2.0), -10.0, 0.0, -0.25),
    (194, (nan, nan, nan, nan, nan, nan, -0.5, 5.0), 10.0, 0.0, 1.25),
    (200, (nan, nan, nan, nan, nan, nan, -0.5, 5.0), -10.0, 0.0, -0.125),
    (213, NONE, 10.0, 0.0, 10.0),
    (218, NONE, -10.0, 0.0, -10.0),
    (233, FIRST, 10.0, 0.0, 0.5),
    (239, FIRST, -10.0, 0.0, -0.25),
    (247, ALL, 10.0, 0.0, 0.5),
    (253, ALL, -10.0, 0.0, -0.25),
    (267, ASYMMETRIC, 10.0, 5.0, 5.5),
    (273, ASYMMETRIC, -10.0, 5.0, 2.5),
    (282, ASYMMETRIC, 10.0, -5.0, 0.0),
    (288, ASYMMETRIC, -10.0, -5.0, -5.25),
    (303, SECOND, 10.0, 0.0, 0.25),
    (308, SECOND, -10.0, 0.0, -0.25),
    (315, (-0.5, 1.0, -0.5, 1.0, nan, nan, -1.0, 1.0), 10.0, 0.0, 0.25),
    (321, (-0.5, 1.0, -0.5, 1.0, nan, nan, -1.0, 1.0), -10.0, 0.0, -0.25),
)


@SUITE.table(WRONG)
def limits_in_the_wrong_order(limits):
    return refuses(lambda: SpeedLimiter(*limits), ValueError)


@SUITE.table(LIMITED)
def values_are_limited(limits, value, before):
    return SpeedLimiter(*limits).limited(value, before, before, 0.5)


test_holds_against_upstream = SUITE.test()
