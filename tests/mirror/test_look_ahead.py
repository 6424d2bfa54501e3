"""Looking ahead says what a plain twin then really does, leaves the twin alone, and survives its process."""

import gc
import json
import os
import signal
import threading
from dataclasses import replace
from math import nan

import numpy as np
import pytest
from checked_robots import (
    FOLLOW,
    TRAJECTORY,
    WHEELS,
    arm,
    box,
    first_touch,
    length,
    random_trajectory,
    rover,
    trajectory,
)

from drake_twin.errors import InputError, RunError
from drake_twin.mirror.look_ahead import MOST_WAITING, LookAhead, answer_later, check_trajectory, look_ahead_of
from drake_twin.mirror.run_ahead import run_ahead
from drake_twin.mirror.trajectory_verdict import (
    COLLISION,
    EFFORT_LIMIT,
    NOT_REACHED,
    POSITION_LIMIT,
    REFUSED,
    TIPPING,
    VELOCITY_LIMIT,
    Allowed,
    Verdict,
)
from drake_twin.twin.twin import Twin

LONGEST_WAIT = 120.0  # s of wall time, which only a fault takes
CLOSE = 0.02  # s
FREE = trajectory((0.4, (0.3, 0.2, 0.1)))
INTO_THE_POST = trajectory((0.5, (1.3, 0.4, 0.1)))


@pytest.fixture(scope="module")
def arm_scenario(tmp_path_factory):
    return arm(tmp_path_factory.mktemp("arm"))


@pytest.fixture(scope="module")
def ahead(arm_scenario):
    with LookAhead(arm_scenario) as ahead:
        ahead.wait_until_warm(LONGEST_WAIT)
        yield ahead


@pytest.fixture(scope="module")
def arm_twin(arm_scenario):
    """The twin of the arm, always in the state in which `moment` was taken."""
    with Twin(arm_scenario) as twin:
        twin.advance_to(0.1)
        yield twin


@pytest.fixture(scope="module")
def moment(arm_twin):
    return arm_twin.snapshot()


@pytest.fixture(scope="module")
def own_twin(arm_scenario):
    """A twin for looking ahead in this process."""
    with Twin(arm_scenario) as twin:
        yield twin


def now(topic, message):
    return [(0.0, topic, message)]


def alone(verdict: Verdict):
    assert len(verdict.problems) == 1, str(verdict)
    return verdict.problems[0]


# What is found, beside a twin that executes it ------------------------------------------------------------------------


def bodies(problem):
    """Drake's names of what touches; a static model's shapes belong to the body of the world."""
    return frozenset(part.rpartition("::")[2] if "::" in part else "world" for part in problem.parts)


def compare_random_trajectories(ahead, twin, moment, seed, wanted):
    """Compare so many colliding and so many free ones at least.

    Returns:
        Whether one collides → how many there were; the same → how many of them were judged otherwise; and how much the
        times of the first touches differ at most (s).
    """
    generator, seen, wrong, late = np.random.default_rng(seed), {True: 0, False: 0}, {True: 0, False: 0}, 0.0
    while min(seen.values()) < wanted:
        message = random_trajectory(generator)
        pending = ahead.check(moment, now(TRAJECTORY, message))
        touch = first_touch(twin, moment, TRAJECTORY, message, length(message) + Allowed().settling)
        verdict, collides = pending.result(LONGEST_WAIT), touch is not None
        seen[collides] += 1
        wrong[collides] += verdict.is_safe == collides
        if collides and (collisions := verdict.of_kind(COLLISION)):
            late = max(late, abs(collisions[0].time - touch.time))
            assert touch.bodies in {bodies(problem) for problem in collisions}
    twin.restore(moment)
    return seen, wrong, late


def test_random_trajectories_are_judged_as_a_twin_then_executes_them(ahead, arm_twin, moment):
    _, wrong, late = compare_random_trajectories(ahead, arm_twin, moment, seed=1, wanted=6)
    assert wrong == {True: 0, False: 0}
    assert late <= CLOSE


@pytest.mark.slow
def test_of_200_colliding_trajectories_none_is_accepted_and_of_free_ones_at_most_2_percent_are_refused(
    ahead, arm_twin, moment
):
    seen, wrong, late = compare_random_trajectories(ahead, arm_twin, moment, seed=2026, wanted=200)
    assert wrong[True] == 0
    assert wrong[False] <= 0.02 * seen[False]
    assert late <= CLOSE


def test_with_the_twins_own_steps_the_time_of_contact_is_that_of_the_twin(own_twin, arm_twin, moment):
    verdict = run_ahead(own_twin, moment, now(TRAJECTORY, INTO_THE_POST), longest_step=0.0)
    touch = first_touch(arm_twin, moment, TRAJECTORY, INTO_THE_POST, 1.0)
    arm_twin.restore(moment)
    assert verdict.problems[0].kind == COLLISION
    assert verdict.problems[0].time == pytest.approx(touch.time, abs=1e-9)
    assert verdict.problems[0].parts[1] == "post"
    assert verdict.problems[0].robot == "arm"


def test_ten_seconds_need_a_fifth_of_the_steps_of_the_twin(ahead, moment, arm_twin):
    message = trajectory((5.0, (0.3, 0.2, 0.1)), (10.0, (-0.3, -0.2, 0.1)))
    verdict = ahead.check(moment, now(TRAJECTORY, message), 10.0).result(LONGEST_WAIT)
    assert verdict.is_safe, str(verdict)
    assert verdict.ended == pytest.approx(10.0, abs=0.005)
    assert verdict.steps * 5 == pytest.approx(10.0 / arm_twin.clock.time_step, abs=5)


def test_ends_when_the_joints_may_have_settled(ahead, moment):
    verdict = ahead.check(moment, now(TRAJECTORY, FREE)).result(LONGEST_WAIT)
    assert verdict.is_safe, str(verdict)
    assert verdict.ended == pytest.approx(0.4 + Allowed().settling, abs=0.005)


def test_links_of_one_robot_touch_also_where_they_may_pass_in_the_twin(tmp_path):
    message = trajectory((1.6, (0.0, 0.0, 1.55)))
    scenario, apart = arm(tmp_path, self_collision=True), arm(tmp_path, self_collision=False)
    with Twin(scenario) as real, Twin(apart) as passing:
        touch = first_touch(real, real.snapshot(), TRAJECTORY, message, 1.6)
        assert first_touch(passing, passing.snapshot(), TRAJECTORY, message, 1.6) is None
        passing.reset()
        moment = passing.snapshot()
        collisions = run_ahead(passing, moment, now(TRAJECTORY, message)).of_kind(COLLISION)
        ignoring = run_ahead(passing, moment, now(TRAJECTORY, message), allowed=Allowed(self_collisions=True))
    assert touch.bodies in {bodies(problem) for problem in collisions}  # of two fingers at the same height
    assert collisions[0].time == pytest.approx(touch.time, abs=CLOSE)
    assert not ignoring.of_kind(COLLISION)


def test_what_may_be_touched_is_not_a_collision(own_twin, moment):
    for allowed in ("post", "arm"):
        verdict = run_ahead(own_twin, moment, now(TRAJECTORY, INTO_THE_POST), allowed=Allowed(touches=(allowed,)))
        assert not verdict.of_kind(COLLISION)


# Limits: closed forms -------------------------------------------------------------------------------------------------


def test_a_point_beyond_the_range_of_a_joint_is_a_position_limit_at_its_time(own_twin, moment):
    verdict = run_ahead(own_twin, moment, now(TRAJECTORY, trajectory((0.9, (0, -1.6, 0)), (1.8, (0, 0, 0)))))
    problem = verdict.of_kind(POSITION_LIMIT)[0]
    assert (problem.time, problem.parts) == (0.9, ("joint_2",))
    assert problem.text == "joint_2 is commanded to -1.6, beyond its range from -1.571 to 1.571 rad"


def test_a_way_that_is_too_long_for_its_time_is_a_velocity_limit_from_its_start_on(own_twin, moment):
    # 0.95 rad in 0.3 s is 3.17 rad/s, and the limit is 3 rad/s.
    verdict = run_ahead(own_twin, moment, now(TRAJECTORY, trajectory((0.5, (0, 0, 0)), (0.8, (-0.95, 0, 0)))))
    problem = verdict.of_kind(VELOCITY_LIMIT)[0]
    assert (problem.time, problem.parts) == (0.5, ("joint_1",))
    assert problem.text == "joint_1 is commanded to move at 3.167 rad/s, beyond its limit of 3 rad/s"


def test_a_joint_that_is_held_up_is_at_its_effort_limit_and_does_not_get_there(own_twin, moment):
    verdict = run_ahead(own_twin, moment, now(TRAJECTORY, INTO_THE_POST), 2.0)
    missed = verdict.of_kind(NOT_REACHED)
    assert ("joint_1",) in [problem.parts for problem in missed]
    assert {problem.time for problem in missed} == {0.5}
    assert ("joint_1",) in [problem.parts for problem in verdict.of_kind(EFFORT_LIMIT)]
    assert [problem.time for problem in verdict.problems] == sorted(problem.time for problem in verdict.problems)
    kinds = [(problem.kind, problem.parts) for problem in verdict.problems]
    assert len(kinds) == len(set(kinds))
    short = run_ahead(own_twin, moment, now(TRAJECTORY, INTO_THE_POST), 2.0, Allowed(effort_time=60.0))
    assert not short.of_kind(EFFORT_LIMIT)


def test_a_goal_of_an_action_is_checked_as_a_trajectory(own_twin, moment):
    verdict = run_ahead(own_twin, moment, now(FOLLOW, {"trajectory": INTO_THE_POST}))
    assert verdict.problems[0].kind == COLLISION
    assert run_ahead(own_twin, moment, now(FOLLOW, {"trajectory": FREE})).is_safe


def test_a_later_command_replaces_the_end_of_an_earlier_one(own_twin, moment):
    back = trajectory((0.5, (0.0, 0.0, 0.0)))
    verdict = run_ahead(own_twin, moment, [(0.0, TRAJECTORY, FREE), (0.1, TRAJECTORY, back)])
    assert verdict.is_safe, str(verdict)
    assert verdict.ended == pytest.approx(0.1 + 0.5 + Allowed().settling, abs=0.005)


# Rovers ---------------------------------------------------------------------------------------------------------------


def test_a_rover_that_drives_into_a_wall_touches_it_when_the_way_is_driven(tmp_path):
    scenario = rover(tmp_path, box("wall", (1.05, 0, 0.5), (0.1, 2, 1)))
    ground = [(f"rover_{side}_wheel", "world") for side in ("front_left", "front_right", "rear_left", "rear_right")]
    with Twin(scenario) as twin, LookAhead(scenario) as ahead:
        twin.advance_to(0.3)
        moment = twin.snapshot()
        pending = ahead.check(moment, now(WHEELS, [5.0] * 4), 2.5)
        touch = first_touch(twin, moment, WHEELS, [5.0] * 4, 2.5, but=ground)
        problem = pending.result(LONGEST_WAIT).problems[0]
        away = ahead.check(moment, now(WHEELS, [-5.0] * 4), 1.0).result(LONGEST_WAIT)
    assert (problem.kind, problem.robot, problem.parts[1]) == (COLLISION, "rover", "wall")
    assert problem.time == pytest.approx(touch.time, abs=CLOSE)
    assert away.is_safe, str(away)


def test_wheels_may_touch_another_ground_and_a_rover_that_leaves_it_tips(tmp_path):
    table, ramp = box("table", (0, 0, 0.5), (1.6, 2, 1)), box("plate", (0.3, 0, 1.005), (0.5, 1, 0.01))
    with Twin(rover(tmp_path, table, ramp, xyz=(-0.3, 0, 1.13))) as twin:
        twin.advance_to(0.3)
        moment = twin.snapshot()
        over_the_plate = run_ahead(twin, moment, now(WHEELS, [5.0] * 4), 1.2)
        assert twin.latest("/tf") is not None
        off_the_table = run_ahead(twin, moment, now(WHEELS, [5.0] * 4), 3.0)
        twin.restore(moment)
        twin.publish(WHEELS, [5.0] * 4)
        while (tilt := tilt_of(twin)) < Allowed().tilt and twin.time < 4.0:
            twin.step()
        time = twin.time - moment.step * moment.time_step
    assert over_the_plate.is_safe, str(over_the_plate)
    problem = off_the_table.of_kind(TIPPING)[0]
    assert tilt >= Allowed().tilt
    assert problem.parts == ("rover_base_link",)
    assert problem.time == pytest.approx(time, abs=CLOSE)


def tilt_of(twin):
    """The angle between the rover's vertical axis and the world's, from its quaternion."""
    *_, w, x, y, z = twin.robot_state("rover", with_efforts=False).base_pose
    return np.arccos(1.0 - 2.0 * (x * x + y * y) / (w * w + x * x + y * y + z * z))


def test_a_command_that_wheels_cannot_follow_is_a_velocity_limit(tmp_path):
    with Twin(rover(tmp_path)) as twin:
        verdict = run_ahead(twin, twin.snapshot(), now(WHEELS, [25.0, 1.0, 1.0, 1.0]), 0.1)
    assert alone(verdict).text == (
        "rover_front_left_wheel_joint is commanded to move at 25 rad/s, beyond its limit of 20 rad/s"
    )


# What is refused ------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("topic", "message", "words"),
    [
        ("/nowhere", FREE, "nothing listens to '/nowhere'"),
        (TRAJECTORY, trajectory((1.0, (0, 0)), joints=("joint_1", "joint_9")), "unknown joint 'joint_9'"),
        (TRAJECTORY, trajectory((1.0, (0, 0)), joints=("joint_1", "joint_2")), "leaves out joint_3"),
        (TRAJECTORY, {"joint_names": ["joint_1", "joint_2", "joint_3"], "points": []}, "has no points"),
        (TRAJECTORY, trajectory((1.0, (0, nan, 0))), "nan among its positions"),
        (TRAJECTORY, {"joint_names": 3}, "joint_names"),
        (TRAJECTORY, "home", "home"),
        (FOLLOW, {"trajectory": trajectory((1.0, (0, nan, 0)))}, "nan among its positions"),
        ("/arm/forward_velocity_controller/commands", [0.0], "nothing listens to"),
    ],
)
def test_what_the_twin_refuses_is_a_verdict_in_its_words(ahead, moment, topic, message, words):
    problem = alone(ahead.check(moment, now(topic, message)).result(LONGEST_WAIT))
    assert (problem.kind, problem.time) == (REFUSED, 0.0)
    assert words in problem.text
    assert "Traceback" not in problem.text
    assert "\n" not in problem.text


def test_a_controller_that_is_not_active_hears_nothing(own_twin, arm_twin, moment):
    arm_twin.control.manager("arm").switch_controller([], ["joint_trajectory_controller"])
    verdict = run_ahead(own_twin, arm_twin.snapshot(), now(TRAJECTORY, FREE))
    arm_twin.restore(moment)
    assert alone(verdict).kind == REFUSED
    assert "joint_trajectory_controller of arm is not active" in verdict.problems[0].text


def test_the_snapshot_of_another_robot_has_other_topics(ahead, moment, tmp_path):
    with Twin(rover(tmp_path)) as other:
        problem = alone(ahead.check(other.snapshot(), now(TRAJECTORY, FREE)).result(LONGEST_WAIT))
    assert (problem.kind, problem.parts) == (REFUSED, (TRAJECTORY,))
    assert WHEELS in problem.text
    assert ahead.check(moment, now(TRAJECTORY, FREE)).result(LONGEST_WAIT).is_safe


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("state.json", now(TRAJECTORY, FREE)), "'state.json' is not a Snapshot"),
        (("moment", [(nan, TRAJECTORY, FREE)]), "invalid time nan of a command"),
        (("moment", [(-1.0, TRAJECTORY, FREE)]), "invalid time -1.0 of a command"),
        (("moment", [(0.0, 7, FREE)]), "7 is not a topic"),
        (("moment", [TRAJECTORY]), "is not a command"),
        (("moment", TRAJECTORY), "is not a command"),
        (("moment", [(0.0, TRAJECTORY, object())]), "cannot be sent to another process"),
        (("moment", now(TRAJECTORY, FREE), nan), "invalid duration nan"),
        (("moment", now(TRAJECTORY, FREE), -1.0), "invalid duration -1.0"),
        (("moment", []), "needs a duration"),
    ],
)
def test_invalid_arguments_are_refused_at_once(ahead, moment, arguments, words):
    with pytest.raises(InputError, match=words):
        ahead.check(*(moment if item == "moment" else item for item in arguments))


def test_limits_of_what_is_allowed_are_numbers():
    with pytest.raises(InputError, match="invalid tilt nan"):
        Allowed(tilt=nan)
    with pytest.raises(InputError, match=r"unknown kind of problem 'colision'\. Did you mean 'collision'"):
        Verdict((), 0.0, 0.0, 0).of_kind("colision")


# The twin, and the process --------------------------------------------------------------------------------------------


def test_a_twin_is_the_same_with_and_without_checks(arm_scenario):
    def run(check):
        with Twin(arm_scenario) as twin:
            twin.publish(TRAJECTORY, FREE)
            for _ in range(5):
                twin.advance_to(twin.time + 0.1)
                check(twin)
            return twin.state_sha256()

    pending = []
    with LookAhead(arm_scenario) as ahead:
        watched = run(lambda twin: pending.append(ahead.check(twin.snapshot(), now(TRAJECTORY, INTO_THE_POST))))
        verdicts = [item.result(LONGEST_WAIT) for item in pending]
    assert watched == run(lambda _: None)
    assert [verdict.problems[0].kind for verdict in verdicts] == [COLLISION] * 5


def test_a_command_that_is_under_way_is_continued(ahead, arm_twin, moment):
    arm_twin.publish(TRAJECTORY, INTO_THE_POST)
    arm_twin.step(200)
    under_way = arm_twin.snapshot()
    arm_twin.restore(moment)
    touch = first_touch(arm_twin, moment, TRAJECTORY, INTO_THE_POST, 1.0)
    arm_twin.restore(moment)
    collision = ahead.check(under_way, [], 0.5).result(LONGEST_WAIT).of_kind(COLLISION)[0]
    assert collision.time == pytest.approx(touch.time - 0.2, abs=CLOSE)


def test_a_process_that_is_killed_is_one_error_and_the_next_check_starts_another(arm_scenario, moment):
    with LookAhead(arm_scenario) as ahead:
        ahead.wait_until_warm(LONGEST_WAIT)
        first = ahead.process_id
        pending = ahead.check(moment, [], 3000.0)
        os.kill(first, signal.SIGKILL)
        with pytest.raises(RunError, match="was ended by SIGKILL, without a verdict; the next check starts another"):
            pending.result(LONGEST_WAIT)
        assert ahead.check(moment, now(TRAJECTORY, FREE)).result(LONGEST_WAIT).is_safe
        second = ahead.process_id
        os.kill(second, signal.SIGKILL)  # between two checks
        os.waitid(os.P_PID, second, os.WEXITED | os.WNOWAIT)
        assert ahead.check(moment, now(TRAJECTORY, FREE)).result(LONGEST_WAIT).is_safe
        assert len({first, second, ahead.process_id}) == 3


def test_a_process_that_is_stopped_is_ended_after_a_while(arm_scenario, moment):
    with LookAhead(arm_scenario, longest_check=0.2) as ahead:
        ahead.wait_until_warm(LONGEST_WAIT)
        os.kill(ahead.process_id, signal.SIGSTOP)
        with pytest.raises(RunError, match=r"has not answered for 0\.2 s, and was ended"):
            ahead.check(moment, now(TRAJECTORY, FREE)).result(LONGEST_WAIT)
        assert ahead.process_id is None


def test_signals_that_stop_a_program_are_for_the_twin(ahead, moment):
    pending = ahead.check(moment, now(TRAJECTORY, FREE))
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        os.kill(ahead.process_id, number)
    assert pending.result(LONGEST_WAIT).is_safe


def test_closing_ends_the_process_and_what_waits_for_it(arm_scenario, moment):
    ahead = LookAhead(arm_scenario)
    ahead.wait_until_warm(LONGEST_WAIT)
    number = ahead.process_id
    pending = [ahead.check(moment, [], 3000.0) for _ in range(3)]
    ahead.close()
    ahead.close()
    with pytest.raises(ProcessLookupError):
        os.kill(number, 0)
    for item in pending:
        with pytest.raises(RunError, match="it has been closed"):
            item.result(LONGEST_WAIT)
    with pytest.raises(InputError, match="it has been closed"):
        ahead.check(moment, [], 1.0)


def test_closing_before_it_is_ready_ends_it(arm_scenario):
    ahead = LookAhead(arm_scenario)
    ahead.close()
    assert ahead.process_id is None
    with pytest.raises(RunError, match="it has been closed"):
        ahead.wait_until_warm(LONGEST_WAIT)
    gc.collect()
    assert "look ahead" not in [thread.name for thread in threading.enumerate() if thread is ahead._thread]


def test_a_scenario_that_cannot_be_built_is_said_by_each_check(arm_scenario, moment, tmp_path):
    file = tmp_path / "bad.urdf"
    file.write_text("<robot name='bad'>")
    bad = replace(arm_scenario, robots=(replace(arm_scenario.robots[0], model=str(file)),))
    with LookAhead(bad) as ahead:
        for wait in (ahead.wait_until_warm, ahead.check(moment, [], 1.0).result):
            with pytest.raises(InputError, match=r"bad\.urdf"):
                wait(LONGEST_WAIT)


def test_more_checks_than_can_wait_are_refused_and_those_that_wait_can_be_cancelled(arm_scenario, moment):
    with LookAhead(arm_scenario) as ahead:
        ahead.wait_until_warm(LONGEST_WAIT)
        os.kill(ahead.process_id, signal.SIGSTOP)
        pending = [ahead.check(moment, [], 1.0) for _ in range(MOST_WAITING)]
        with pytest.raises(InputError, match="16 checks wait already"):
            [ahead.check(moment, [], 1.0) for _ in range(2)]  # one of the first may have begun
        assert pending[-1].cancel()
        with pytest.raises(RunError, match="was cancelled"):
            pending[-1].result()
        with pytest.raises(RunError, match="has no verdict after 0 s"):
            pending[0].result(0.0)


def test_a_python_user_checks_a_trajectory_in_one_call(arm_scenario):
    with Twin(arm_scenario) as twin:
        before = twin.state_sha256()
        assert check_trajectory(twin, TRAJECTORY, FREE, timeout=LONGEST_WAIT).is_safe
        ahead = look_ahead_of(twin)
        verdict = check_trajectory(twin, TRAJECTORY, INTO_THE_POST, timeout=LONGEST_WAIT)
        assert look_ahead_of(twin) is ahead
        assert verdict.fields()["problems"][0]["kind"] == COLLISION
        assert twin.state_sha256() == before
        number = ahead.process_id
    with pytest.raises(ProcessLookupError):
        os.kill(number, 0)


def test_an_answer_of_a_service_is_continued_until_there_is_a_verdict(arm_scenario):
    with Twin(arm_scenario) as twin:

        def service():
            answers.append((yield from answer_later(twin, TRAJECTORY, INTO_THE_POST)))

        answers = []
        assert set(service()) == {None}
    (answer,) = answers
    assert answer["is_safe"] is False
    assert answer["problems"][0]["parts"][1] == "post"
    json.dumps(answer)
