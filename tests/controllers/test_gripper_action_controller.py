from math import isnan

import numpy as np
import pytest
from device_harness import ROBOT, Running, setup_of

from drake_twin import messages
from drake_twin.controllers.effort_controllers import (
    EffortGripperActionController,
    EffortGripperActionParameters,
    GripperGains,
)
from drake_twin.controllers.goal_state import GoalState
from drake_twin.controllers.gripper_action_controller import GripperActionParameters
from drake_twin.controllers.interface import Interface
from drake_twin.controllers.parallel_gripper_action_controller import (
    ParallelGripperActionController,
    ParallelGripperActionParameters,
)
from drake_twin.controllers.position_controllers import PositionGripperActionController
from drake_twin.errors import CommandError

START = [0.2, 0.0, 0.0, 0.0]


def position_gripper(state=START, **parameters):
    kind = PositionGripperActionController
    return Running(kind(setup_of(kind, GripperActionParameters("finger", **parameters))), state=state)


def effort_gripper(state=START, gains=None, **parameters):
    kind = EffortGripperActionController
    gains = {} if gains is None else {"finger": gains}
    return Running(
        kind(setup_of(kind, EffortGripperActionParameters("finger", gains=gains, **parameters))), state=state
    )


def parallel_gripper(state=START, **parameters):
    kind = ParallelGripperActionController
    return Running(kind(setup_of(kind, ParallelGripperActionParameters("finger", **parameters))), state=state)


def goal(position, max_effort=0.0):
    command = messages.GripperCommand(position=position, max_effort=max_effort)
    return messages.GripperCommand_Goal(command=command)


def parallel_goal(position, velocity=(), effort=()):
    command = messages.JointState(
        header=messages.header(0.0),
        name=[],
        position=np.array(position, dtype=float),
        velocity=np.array(velocity, dtype=float),
        effort=np.array(effort, dtype=float),
    )
    return messages.ParallelGripperCommand_Goal(command=command)


def state_of(run):
    return run.controller.goal_state(run.context)


def test_it_holds_where_it_is_activated_until_a_goal_comes():
    run = position_gripper()
    run.fix("state", [0.3, 0.0, 0.0, 0.0])
    run.advance(0.05)
    assert run.commands() == [0.2]
    assert state_of(run) is None


def test_a_goal_is_accepted_then_executed_then_reached_and_its_position_stays_commanded():
    run = position_gripper()
    run.advance(0.02)
    run.send("gripper_cmd", goal(0.8, max_effort=5.0))
    assert state_of(run) == GoalState(1, "accepted")
    run.advance(0.05)
    assert run.commands() == [0.8]
    assert state_of(run) == GoalState(1, "executing")
    run.fix("state", [0.7901, 0.0, 0.3, 0.0])
    assert run.advance(1.0) == pytest.approx(0.06)  # the twin is told at the update that finds it
    assert state_of(run) == GoalState(1, "succeeded")
    result = run.controller.result(run.context)
    assert (result.position, result.effort, result.reached_goal, result.stalled) == (0.7901, 5.0, True, False)
    run.advance(1.0)
    assert run.commands() == [0.8]


@pytest.mark.parametrize(("allow_stalling", "status"), [(False, "aborted"), (True, "succeeded")])
def test_a_gripper_that_stands_still_short_of_its_goal_has_stalled(allow_stalling, status):
    run = position_gripper(stall_timeout=0.1, allow_stalling=allow_stalling)
    run.send("gripper_cmd", goal(0.8))
    run.fix("state", [0.5, 0.0, 0.002, 0.0])
    assert run.advance(0.3) == 0.3
    run.fix("state", [0.5, 0.0, 0.0005, 0.0])
    assert run.advance(1.0) == pytest.approx(0.41)  # longer than 0.1 s after the last movement at 0.3 s
    assert state_of(run) == GoalState(1, status)
    result = run.controller.result(run.context)
    assert (result.position, result.reached_goal, result.stalled) == (0.5, False, True)


def test_a_newer_goal_takes_the_place_of_an_older_one():
    run = position_gripper()
    run.send("gripper_cmd", goal(0.8))
    run.advance(0.02)
    run.send("gripper_cmd", goal(0.1))
    run.advance(0.04)
    assert run.commands() == [0.1]
    assert state_of(run) == GoalState(2, "executing")


def test_a_pending_goal_takes_the_place_of_one_that_has_ended():
    run = position_gripper()
    run.send("gripper_cmd", goal(0.2))
    run.advance(0.05)
    assert state_of(run) == GoalState(1, "succeeded")
    run.send("gripper_cmd", goal(0.8))
    assert state_of(run) == GoalState(2, "accepted")


def test_of_two_goals_between_two_updates_the_last_is_executed():
    run = position_gripper()
    run.advance(0.011)
    assert [run.send("gripper_cmd", goal(position)).id for position in (0.8, 0.6)] == [1, 2]
    run.advance(0.02)
    assert run.commands() == [0.6]
    assert state_of(run).id == 2


def test_cancelling_holds_the_gripper_where_it_is():
    run = position_gripper()
    run.send("gripper_cmd", goal(0.8))
    run.advance(0.05)
    run.fix("state", [0.4, 0.0, 0.5, 0.0])
    run.controller.cancel(run.context)
    run.advance(0.1)
    assert run.commands() == [0.4]
    assert state_of(run) == GoalState(1, "canceled")
    assert run.controller.result(run.context).position == 0.0


def test_a_goal_that_is_cancelled_before_its_first_update_is_never_executed():
    run = position_gripper()
    run.advance(0.011)
    run.send("gripper_cmd", goal(0.8))
    run.controller.cancel(run.context)
    run.advance(0.05)
    assert run.commands() == [0.2]
    assert state_of(run) == GoalState(1, "canceled")


def test_cancelling_without_a_goal_changes_nothing():
    run = position_gripper()
    run.fix("state", [0.4, 0.0, 0.0, 0.0])
    run.controller.cancel(run.context)
    run.advance(0.05)
    assert run.commands() == [0.2]


def test_deactivation_cancels_the_goal_and_the_numbers_of_goals_go_on():
    run = position_gripper()
    run.send("gripper_cmd", goal(0.8))
    run.advance(0.05)
    run.controller.deactivate(run.context)
    assert state_of(run) == GoalState(1, "canceled")
    assert isnan(run.commands()[0])
    run.fix("gripper_cmd", None)
    run.controller.activate(run.context)
    assert run.send("gripper_cmd", goal(0.7)).id == 2


def test_a_goal_that_is_no_number_is_refused():
    run = position_gripper()
    with pytest.raises(CommandError, match="the position of the goal is nan, which is not a finite number"):
        run.send("gripper_cmd", goal(float("nan")))


def test_the_feedback_is_the_present_state():
    run = position_gripper()
    run.send("gripper_cmd", goal(0.8, max_effort=3.0))
    run.fix("state", [0.4, 0.0, 0.5, 0.0])
    run.advance(0.05)
    feedback = run.controller.feedback(run.context)
    assert (feedback.position, feedback.effort, feedback.stalled, feedback.reached_goal) == (0.4, 3.0, False, False)


def test_a_saved_context_goes_on_as_the_original():
    run = position_gripper(stall_timeout=0.1)
    run.send("gripper_cmd", goal(0.8))
    run.advance(0.05)
    saved = run.root.Clone()
    first = run.advance(1.0)
    run.root.SetTimeStateAndParametersFrom(saved)
    run.simulator.Initialize()
    assert state_of(run).status == "executing"
    assert run.advance(1.0) == first
    assert state_of(run).status == "aborted"


def test_effort_is_a_pid_on_the_position_error_within_the_goals_effort():
    run = effort_gripper(gains=GripperGains(p=20.0, d=2.0))
    run.fix("state", [0.3, 0.0, 0.5, 0.0])
    run.send("gripper_cmd", goal(0.6, max_effort=100.0))
    run.advance(0.02)
    assert run.commands() == [pytest.approx(20.0 * 0.3 - 2.0 * 0.5)]
    run.send("gripper_cmd", goal(0.6, max_effort=1.5))
    run.advance(0.04)
    assert run.commands() == [1.5]
    run.send("gripper_cmd", goal(0.0, max_effort=1.5))
    run.advance(0.06)
    assert run.commands() == [-1.5]


def test_an_effort_gripper_without_max_effort_is_limp_until_a_goal_brings_its_own():
    run = effort_gripper(gains=GripperGains(p=20.0))
    run.fix("state", [0.5, 0.0, 0.0, 0.0])
    run.advance(0.05)
    assert run.commands() == [0.0]


def test_the_integral_of_an_effort_gripper_is_clamped_and_without_i_clamp_there_is_none():
    for i_clamp, expected in ((0.0, 0.0), (0.7, 0.7)):
        run = effort_gripper(gains=GripperGains(i=10.0, i_clamp=i_clamp), max_effort=50.0, stall_timeout=9.0)
        run.send("gripper_cmd", goal(0.6, max_effort=50.0))
        run.advance(1.0)
        assert run.commands() == [pytest.approx(expected)]


def test_a_parallel_gripper_claims_the_interfaces_of_its_limits():
    claims = ParallelGripperActionController.claimed_interfaces(
        ParallelGripperActionParameters(
            "finger", max_effort_interface="finger/set_max_effort", max_velocity_interface="a/b/velocity"
        ),
        ROBOT,
    )
    assert claims == (
        Interface("finger", "position"),
        Interface("finger", "set_max_effort"),
        Interface("a/b", "velocity"),
    )


def test_a_parallel_gripper_writes_the_goals_limits_or_its_own():
    limits = {"max_effort_interface": "finger/max_effort", "max_velocity_interface": "finger/max_velocity"}
    run = parallel_gripper(max_effort=4.0, max_velocity=0.3, **limits)
    run.advance(0.02)
    assert run.commands() == [0.2, 4.0, 0.3]
    run.send("gripper_cmd", parallel_goal([0.5], velocity=[0.05], effort=[9.0]))
    run.advance(0.04)
    assert run.commands() == [0.5, 9.0, 0.05]
    run.send("gripper_cmd", parallel_goal([0.6]))
    run.advance(0.06)
    assert run.commands() == [0.6, 4.0, 0.3]


def test_a_parallel_gripper_makes_no_use_of_limits_without_an_interface():
    run = parallel_gripper()
    run.send("gripper_cmd", parallel_goal([0.5], velocity=[0.05], effort=[9.0]))
    run.advance(0.02)
    assert run.commands() == [0.5]


@pytest.mark.parametrize("positions", [[], [0.1, 0.2]])
def test_a_parallel_gripper_refuses_a_goal_of_another_size(positions):
    run = parallel_gripper()
    with pytest.raises(CommandError, match=f"the goal has {len(positions)} positions, but the gripper has one joint"):
        run.send("gripper_cmd", parallel_goal(positions))


def test_a_parallel_grippers_result_is_a_joint_state():
    run = parallel_gripper()
    run.send("gripper_cmd", parallel_goal([0.5]))
    run.fix("state", [0.5, 0.0, 0.0, 0.0])
    run.advance(0.5)
    result = run.controller.result(run.context)
    assert (result.state.name, result.state.position.tolist(), result.reached_goal) == (["finger"], [0.5], True)
    store = messages.type_store()
    name = "control_msgs/action/ParallelGripperCommand_Result"
    assert store.deserialize_cdr(store.serialize_cdr(result, name), name).state.effort.tolist() == [10.0]
