from drake_twin.control.gripper import GripperRun, StallRule, judged

RULE = StallRule(goal_tolerance=0.01, stall_velocity_threshold=0.001, stall_timeout=1.0)
RUN = GripperRun(id=3, status="executing", last_movement=2.0)


def test_a_goal_is_reached_nearer_than_the_tolerance_whatever_the_velocity():
    run = judged(RUN, RULE, time=2.1, goal=0.5, position=0.4901, velocity=1.0, effort=7.0)
    assert (run.status, run.reached_goal, run.stalled, run.position, run.effort) == (
        "succeeded",
        True,
        False,
        0.4901,
        7.0,
    )


def test_what_moves_faster_than_the_threshold_has_not_stalled():
    run = judged(RUN, RULE, time=99.0, goal=0.5, position=0.0, velocity=-0.002, effort=0.0)
    assert (run.status, run.last_movement) == ("executing", 99.0)


def test_a_stall_counts_from_the_last_movement_and_lasts_longer_than_the_timeout():
    still = {"goal": 0.5, "position": 0.0, "velocity": 0.001, "effort": 0.0}
    assert judged(RUN, RULE, time=3.0, **still).is_executing
    run = judged(RUN, RULE, time=3.01, **still)
    assert (run.status, run.stalled, run.reached_goal) == ("aborted", True, False)


def test_a_stall_is_success_when_it_is_allowed():
    rule = StallRule(allow_stalling=True)
    run = judged(RUN, rule, time=3.01, goal=0.5, position=0.0, velocity=0.0, effort=0.0)
    assert (run.status, run.stalled, run.reached_goal) == ("succeeded", True, False)


def test_a_goal_that_has_ended_is_not_judged_again():
    ended = GripperRun(id=3, status="canceled")
    assert judged(ended, RULE, time=9.0, goal=0.5, position=0.5, velocity=0.0, effort=0.0) is ended
