"""joint_trajectory_controller/test/test_trajectory.cpp on `RunningTrajectory` and `interpolate`.

Upstream's iterators are indices here: ``start`` of the last point that has been reached (0 before it), ``end`` of the
next one. They are found from the sample's `time_since_point` and `is_over`.
"""

from math import pi, sqrt

from drake_twin.control.trajectory import Trajectory, TrajectoryPoint, interpolate, take_up
from upstream.suite import Suite

ASSERTIONS = 186
SUITE = Suite("joint_trajectory_controller/test/test_trajectory.cpp")

NOW = 100.0  # s
FIELDS = ("start", "end", "position", "velocity", "acceleration")
TIMES = (1.0, 2.0, 3.0)
REST = TrajectoryPoint((0.0,), (0.0,))

# Rows of a time after the message (s), and the line and value of each of FIELDS.
POSITIONS = (
    (0.0, (120, 0), (121, 0), (122, 0.0), (123, 1.0), (124, 0.0)),
    (0.5, (142, 0), (143, 0), (145, 0.5), (146, 1.0), (147, 0.0)),
    (1.0, (156, 0), (157, 1), (158, 1.0), (159, 1.0), (160, 0.0)),
    (1.5, (169, 0), (170, 1), (172, 1.5)),
    (2.5, (180, 1), None, (182, 2.5)),
    (3.0, (190, 2), None, (191, 3.0)),
    (3.125, (200, 2), (201, 3), (202, 3.0)),
    (30.0, (212, 2), (213, 3), (214, 3.0)),
)
VELOCITIES = (
    (0.0, (370, 0), (371, 0), (372, 0.0), (373, 0.0), (374, 1.0)),
    (0.5, (392, 0), (393, 0), (400, 0.125), (401, 0.5), (402, 1.0)),
    (1.0, (413, 0), (414, 1), (415, 0.5), (416, 1.0), (417, 1.0)),
    (1.5, (428, 0), (429, 1), (433, 1.125), (435, 1.5), (436, 1.0)),
    (2.0, (449, 1), (450, 2), (451, 2.0), (452, 2.0), (453, -1.0)),
    (2.5, (464, 1), (465, 2), (469, 2.875), (471, 1.5), (472, -1.0)),
    (3.0, (485, 2), (486, 3), (487, 3.5), (488, 1.0), (490, 0.0)),
    (3.125, (499, 2), (500, 3), (501, 3.5), (502, 1.0), (503, 0.0)),
)
VELOCITIES_FROM_A_POSITION = (
    (0.0, (552, 0), (553, 0), (554, 0.0), (555, 0.0), (557, 1.0)),
    (0.5, (575, 0), (576, 0), (583, 0.125), (584, 0.5), (585, 1.0)),
    (1.0, (596, 0), (597, 1), (598, 0.5), (599, 1.0), (600, 1.0)),
)
ACCELERATIONS = (
    (0.0, (648, 0), (649, 0), (650, 0.0), (651, 0.0), (653, 0.0)),
    (1.0, (677, 0), (678, 1), (679, 0.25), (680, 0.5), (681, 1.0)),
    (2.0, (694, 1), (695, 2), (696, 1.5), (697, 2.0), (698, 2.0)),
    (3.0, (711, 2), (712, 3), (713, 4.25), (714, 3.5), (715, 1.0)),
    (3.125, (724, 2), (725, 3), (726, 4.25), (727, 3.5), (728, 1.0)),
)
SAME_DEGREE = ((0.0, (777, 0), (778, 0), (779, 0.0), (780, 0.0), (781, 0.0)),)
NOT_INTERPOLATED = (
    (0.0, (824, 0), (825, 0), (826, 0.0)),
    (0.5, (849, 0), (850, 0), (852, 0.0)),
    (1.0, (866, 0), (867, 1), (868, 2.0)),
    (1.5, (882, 0), (883, 1), (884, 2.0)),
    (2.5, (892, 1), None, (893, 3.0)),
    (3.0, (901, 2), None, (902, 3.0)),
    (3.125, (911, 2), (912, 3), (913, 3.0)),
)
UPDATED = (
    (0.0, (974, 0), (975, 0), (976, 0.0), (977, 1.0), (979, 0.0)),
    (1.5, (988, 0), (989, 1), (990, 1.5)),
)


def positions():
    return [TrajectoryPoint((value,)) for value in TIMES]


def started(points, before, times=TIMES, **more):
    return take_up(Trajectory(tuple(points), times), NOW, before, **more)


def expected(rows):
    return {line: value for _, *cells in rows for line, value in filter(None, cells)}


def sampled(trajectory, rows):
    for time, *cells in rows:
        sample = trajectory.sample(NOW + time)
        start = max(trajectory.times.index(time - sample.time_since_point) if sample.time_since_point >= 0.0 else 0, 0)
        point = sample.point
        seen = (
            start,
            0 if sample.time_since_point < 0.0 else start + 1,
            point.positions[0],
            point.velocities[0],
            point.accelerations[0],
        )
        assert sample.is_over == (seen[1] == len(trajectory.times))
        for cell, value in zip(cells, seen, strict=False):
            if cell:
                yield cell[0], value


def before_the_start(trajectory, line):
    """Whether there is a sample half a second before the trajectory."""
    yield line, bool(trajectory.sample(NOW - 0.5).point.positions)


@SUITE.scenario(expected(POSITIONS) | {133: False})
def points_with_positions():
    trajectory = started(positions(), TrajectoryPoint((0.0,)))
    yield from sampled(trajectory, POSITIONS)
    yield from before_the_start(trajectory, 133)


@SUITE.scenario(expected(VELOCITIES) | {383: False})
def points_with_velocities():
    trajectory = started([TrajectoryPoint((), (v,)) for v in (1.0, 2.0, 1.0)], REST)
    yield from sampled(trajectory, VELOCITIES)
    yield from before_the_start(trajectory, 383)


@SUITE.scenario(expected(VELOCITIES_FROM_A_POSITION) | {566: False})
def points_with_velocities_from_a_state_without():
    trajectory = started([TrajectoryPoint((), (v,)) for v in (1.0, 2.0, 1.0)], TrajectoryPoint((0.0,)))
    yield from sampled(trajectory, VELOCITIES_FROM_A_POSITION)
    yield from before_the_start(trajectory, 566)


@SUITE.scenario(expected(ACCELERATIONS) | {662: False})
def points_with_accelerations():
    trajectory = started([TrajectoryPoint((), (), (a,)) for a in (1.0, 2.0, 1.0)], REST)
    yield from sampled(trajectory, ACCELERATIONS)
    yield from before_the_start(trajectory, 662)


@SUITE.scenario(expected(SAME_DEGREE))
def the_state_before_has_the_degree_of_the_points():
    points = [TrajectoryPoint((1.0,), (0.0,), (0.0,)), TrajectoryPoint((2.0,), (0.0,), (0.0,))]
    return sampled(started(points, TrajectoryPoint((0.0,)), (1.0, 2.0)), SAME_DEGREE)


@SUITE.scenario(expected(NOT_INTERPOLATED) | {828: 0, 830: 0, 840: False, 854: 0, 856: 0, 870: 0, 872: 0})
def points_that_are_not_interpolated():
    trajectory = started(positions(), TrajectoryPoint((0.0,)), interpolation_method="none")
    yield from sampled(trajectory, NOT_INTERPOLATED)
    yield from before_the_start(trajectory, 840)
    for time, line in ((0.0, 828), (0.5, 854), (1.0, 870)):
        point = trajectory.sample(NOW + time).point
        yield line, len(point.velocities)
        yield line + 2, len(point.accelerations)


@SUITE.scenario({958: 1} | expected(UPDATED))
def another_trajectory_in_its_place():
    yield from sampled(started(positions(), TrajectoryPoint((0.0,))), ((2.5, (958, 1)),))
    yield from sampled(started(positions(), TrajectoryPoint((0.0,))), UPDATED)


# line of the position, first state, last state, duration, elapsed, then position, velocity, acceleration
CUBIC = (TrajectoryPoint((0.0,), (-2.0,)), TrajectoryPoint((4.0,), (10.0,), (0.0,)))
QUINTIC = (TrajectoryPoint((0.0,), (24.0,), (-100.0,)), TrajectoryPoint((0.0,), (4.0,), (0.0,)))
SPLINES = (
    (245, CUBIC, 0.0, (0.0, -2.0, 0.0)),
    (256, CUBIC, sqrt(2.0), (0.0, 4.0, 6.0 * sqrt(2.0))),
    (266, CUBIC, 2.0, (4.0, 10.0, 12.0)),
    (299, QUINTIC, 0.0, (0.0, 24.0, -100.0)),
    (310, QUINTIC, 1.0, (0.0, -6.0, 10.0)),
    (320, QUINTIC, 2.0, (0.0, 4.0, 0.0)),
)


@SUITE.scenario({line + n: value for line, *_, values in SPLINES for n, value in enumerate(values)})
def splines_between_two_points():
    for line, (first, last), elapsed, _ in SPLINES:
        point = interpolate(first, last, 2.0, elapsed)
        yield line, point.positions[0]
        yield line + 1, point.velocities[0]
        yield line + 2, point.accelerations[0]


GOAL = (1.5 * pi,) * 3
WRAPS = (  # line of the first joint, where the joints are, which wrap around, where they begin
    (1003, (0.0,) * 3, (False,) * 3, (0.0, 0.0, 0.0)),
    (1017, (0.0,) * 3, (True, False, False), (2.0 * pi, 0.0, 0.0)),
    (1031, (0.0,) * 3, (True,) * 3, (2.0 * pi,) * 3),
    (1045, GOAL, (True,) * 3, GOAL),
)


@SUITE.scenario({line + n: value for line, *_, begins in WRAPS for n, value in enumerate(begins)})
def joints_that_wrap_around():
    for line, positions, wraps, _ in WRAPS:
        trajectory = started([TrajectoryPoint(GOAL)], TrajectoryPoint(positions), (1.0,), wraparound=wraps)
        for n, begin in enumerate(trajectory.firsts[0].positions):
            yield line + n, begin


@SUITE.scenario({1090: True, 1098: True, 1099: True, 1102: 1})
def a_segment_shorter_than_a_period_is_integrated_too():
    first = TrajectoryPoint((0.0,), (1.0,))
    moving = TrajectoryPoint((), (1.0,))
    trajectory = started([first, moving, moving], first, (1.0, 2.0, 2.001))
    yield 1090, bool(trajectory.sample(NOW + 1.5).point.positions)
    sample = trajectory.sample(NOW + 3.0)
    yield 1098, sample.is_over
    yield 1099, bool(sample.point.positions)
    yield 1102, len(sample.point.positions)


test_holds_against_upstream = SUITE.test()
