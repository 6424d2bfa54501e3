"""gz-sim's DetachableJoint on its own: what it asks for, and when it tells what has become of it."""

from dataclasses import replace

import pytest
from controller_parameters import parameters_of
from device_harness import ROBOT, Running, setup_of

from drake_twin import messages
from drake_twin.controllers.detachable_joint import Attachment, DetachableJoint
from drake_twin.description.gazebo_drive import DETACHABLE_JOINT

POSE = (1.0, 0.0, 0.0, 0.3, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0)
LINKS = {"parent_link": "palm", "child_model": "egg", "child_link": "shell"}


def joint():
    parameters = parameters_of(DETACHABLE_JOINT, **LINKS)
    return Running(DetachableJoint(setup_of(DetachableJoint, parameters)), detach=None, attach=None)


def ask(run, *topics):
    """Publishes all at once, and gives whether the joint is asked for."""
    values = [
        (topic, run.controller.read(topic, messages.message("std_msgs/msg/Empty", {}), run.context)) for topic in topics
    ]
    for topic, value in values:
        run.fix(topic, value)
    asked = run.controller.asked(run.context)
    pose = POSE if asked.wanted else ()
    if bool(asked.pose) != bool(pose):
        asked = replace(asked, pose=pose, since=run.context.get_time())
    run.controller.set_memory(run.context, asked)
    return asked.wanted


def state(run):
    message = run.output("state")
    return None if message is None else message.data


def test_it_asks_for_the_joint_from_the_start_and_does_as_the_last_message_says():
    run = joint()
    assert run.controller.asked(run.context) == Attachment()
    assert [ask(run, topic) for topic in ("attach", "detach", "detach", "attach", "detach")] == [1, 0, 0, 1, 0]


def test_of_two_messages_at_once_the_one_that_changes_something_counts():
    run = joint()
    assert ask(run, "attach", "detach") is False
    assert ask(run, "detach", "attach") is True


def test_each_change_is_told_once_in_the_update_after_it():
    run = joint()
    ask(run)
    told = []
    for step in range(1, 8):
        if step in (3, 5):
            ask(run, "detach" if step == 3 else "attach")
        run.advance(0.01 * step)
        told.append(state(run))
    assert told == ["attached", None, "detached", None, "attached", None, None]


def test_one_without_the_other_model_tells_nothing_and_an_inactive_one_hears_nothing():
    run = joint()
    run.advance(0.01)
    assert state(run) is None
    ask(run)
    run.controller.deactivate(run.context)
    assert ask(run, "detach") is True
    run.advance(0.02)
    assert state(run) is None
    run.controller.activate(run.context)
    assert run.controller.asked(run.context).pose == POSE


@pytest.mark.parametrize(("link", "problem"), [("palm", None), ("arm", "the robot has no link 'arm'")])
def test_a_link_that_the_robot_does_not_have_is_a_problem(link, problem):
    parameters = parameters_of(DETACHABLE_JOINT, **LINKS | {"parent_link": link})
    assert DetachableJoint.problem(parameters, ROBOT) == problem
