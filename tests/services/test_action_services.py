"""Actions as a ROS 2 client uses them: send_goal, get_result, cancel_goal, feedback and status."""

from types import SimpleNamespace as Message

import pytest
from conftest import ARM

from drake_twin.builder.twin_builder import TwinBuilder
from drake_twin.messages import message
from drake_twin.scenario import Robot
from drake_twin.services.actions import ActionServer, action_servers
from drake_twin.services.graph import GraphServices

FIRST, SECOND = bytes(range(16)), bytes(range(16, 32))
NOW = Message(sec=0, nanosec=0)
GOAL = "control_msgs/action/FollowJointTrajectory_Goal"


@pytest.fixture
def twin():
    interfaces = {"command_interfaces": ["position"], "state_interfaces": ["position"]}
    kind = "joint_trajectory_controller/JointTrajectoryController"
    builder = TwinBuilder().robot("arm", ARM, active_controllers=())
    with builder.controller("arm", "c", kind, {"joints": ["joint_1"], **interfaces}).build() as twin:
        yield twin


@pytest.fixture
def server(twin):
    return next(item for item in action_servers(twin) if item.name.endswith("follow_joint_trajectory"))


def call(server, name, **request):
    (service,) = (item for item in server.services() if item.name == f"{server.name}/_action/{name}")
    return service.answer(Message(**request))


def uuid(key):
    return Message(uuid=list(key))


def goal(position=0.3, seconds=0.2):
    points = [{"positions": [position], "time_from_start": seconds}]
    return message(GOAL, {"trajectory": {"joint_names": ["joint_1"], "points": points}})


def cancel(server, key, stamp=NOW):
    return call(server, "cancel_goal", goal_info=Message(goal_id=uuid(key), stamp=stamp))


def ended(response):
    """The response that a generator returns now."""
    with pytest.raises(StopIteration) as end:
        next(response)
    return end.value.value


def test_a_goal_from_acceptance_to_result(twin, server):
    assert list(server.news()) == []
    assert call(server, "send_goal", goal_id=uuid(FIRST), goal=goal())["accepted"]
    result, news = call(server, "get_result", goal_id=uuid(FIRST)), []
    next(result)
    while twin.time < 1.0:
        news += server.news()
        twin.advance_to(twin.time + 0.01)
    news += server.news()
    statuses = [fields["status_list"][0]["status"] for topic, fields in news if topic == server.status_topic.name]
    assert statuses in ([1, 2, 4], [2, 4])
    feedback = [fields for topic, fields in news if topic == server.feedback_topic.name]
    assert 4 <= len(feedback) <= 8  # 20 Hz for some 0.2 s, and until the goal's tolerances are met
    assert all(fields["goal_id"] == {"uuid": list(FIRST)} for fields in feedback)
    response = ended(result)
    assert response["status"] == 4
    assert response["result"].error_code == 0


def test_goals_that_are_rejected(twin, server, caplog):
    wrong = message(GOAL, {"trajectory": {"joint_names": ["nobody"], "points": [{"positions": [0.0]}]}})
    assert not call(server, "send_goal", goal_id=uuid(FIRST), goal=wrong)["accepted"]
    assert "the goal is rejected" in caplog.text
    assert ended(call(server, "get_result", goal_id=uuid(FIRST))) == {"status": 0}
    assert list(server.news()) == []


def test_a_goal_is_cancelled(twin, server):
    call(server, "send_goal", goal_id=uuid(FIRST), goal=goal(seconds=5.0))
    twin.advance_to(0.1)
    assert cancel(server, SECOND) == {"return_code": 2}
    response = cancel(server, FIRST)
    assert response["return_code"] == 0
    assert [item["goal_id"] for item in response["goals_canceling"]] == [{"uuid": list(FIRST)}]
    twin.advance_to(0.2)
    assert ended(call(server, "get_result", goal_id=uuid(FIRST)))["status"] == 5
    assert cancel(server, FIRST) == {"return_code": 3}


def test_all_goals_are_cancelled(twin, server):
    call(server, "send_goal", goal_id=uuid(FIRST), goal=goal(seconds=5.0))
    twin.advance_to(0.05)
    assert len(cancel(server, bytes(16))["goals_canceling"]) == 1


def test_a_second_goal_preempts_the_first(twin, server):
    call(server, "send_goal", goal_id=uuid(FIRST), goal=goal(seconds=5.0))
    twin.advance_to(0.05)
    call(server, "send_goal", goal_id=uuid(SECOND), goal=goal(0.2))
    assert not call(server, "send_goal", goal_id=uuid(SECOND), goal=goal())["accepted"]
    twin.advance_to(1.0)
    assert ended(call(server, "get_result", goal_id=uuid(FIRST)))["status"] == 6
    assert ended(call(server, "get_result", goal_id=uuid(SECOND)))["status"] == 4


def test_results_of_the_last_fifty_goals_are_kept(twin, server):
    for number in range(120):
        call(server, "send_goal", goal_id=uuid(number.to_bytes(16, "big")), goal=goal())
        twin.step()
    assert ended(call(server, "get_result", goal_id=uuid((1).to_bytes(16, "big")))) == {"status": 0}
    assert ended(call(server, "get_result", goal_id=uuid((118).to_bytes(16, "big"))))["status"] == 6
    status = dict(server.news())[server.status_topic.name]["status_list"]
    assert len(status) <= 52


def test_a_goal_and_its_result_survive_a_spawn(twin):
    graph = GraphServices()

    def ask(name, **request):
        services = {item.name: item for item in graph.services(twin)}
        return services[f"/arm/c/follow_joint_trajectory/_action/{name}"].answer(Message(**request))

    assert ask("send_goal", goal_id=uuid(FIRST), goal=goal())["accepted"]
    twin.advance_to(0.05)
    result = ask("get_result", goal_id=uuid(FIRST))
    twin.entities.spawn(Robot("other", ARM, xyz=(0.0, 3.0, 0.0)))
    next(result)
    twin.advance_to(1.0)
    assert ended(result)["status"] == ended(ask("get_result", goal_id=uuid(FIRST)))["status"] == 4
    assert "/other/_action/status" not in {topic.name for topic in graph.topics()}
    assert {name for name, _ in graph.news()} == {"/arm/c/follow_joint_trajectory/_action/status"}


def test_simulate_steps(twin):
    server = next(item for item in action_servers(twin) if item.name == "/drake_twin/simulate_steps")
    request = {"goal_id": uuid(FIRST), "goal": Message(steps=500)}
    assert not call(server, "send_goal", **request)["accepted"]  # time is running
    twin.pause()
    assert call(server, "send_goal", **request)["accepted"]
    news = []
    for _ in range(2000):
        server.proceed()
        news += server.news()
        if twin.clock.step_count == 500:
            break
    news += server.news()
    response = ended(call(server, "get_result", goal_id=uuid(FIRST)))
    assert response == {"status": 4, "result": {"result": {"result": 1, "error_message": ""}}}
    assert (twin.clock.step_count, twin.clock.paused) == (500, True)
    assert [fields["status_list"][0]["status"] for topic, fields in news if topic == server.status_topic.name][-1] == 4


def test_simulate_steps_is_cancelled(twin):
    server = next(item for item in action_servers(twin) if item.name == "/drake_twin/simulate_steps")
    twin.pause()
    call(server, "send_goal", goal_id=uuid(FIRST), goal=Message(steps=1_000_000))
    assert len(cancel(server, FIRST)["goals_canceling"]) == 1
    made = twin.clock.step_count
    server.proceed()
    assert twin.clock.step_count == made
    assert ended(call(server, "get_result", goal_id=uuid(FIRST)))["status"] == 5


def test_feedback_comes_at_20_hz_and_again_after_a_reset():
    now = [0.0]
    running = Message(status="executing", is_done=False, feedback={"x": 1}, result=None)
    kind = "control_msgs/action/FollowJointTrajectory"
    server = ActionServer("/a", kind, "/n", lambda goal: running, lambda: now[0])
    assert call(server, "send_goal", goal_id=uuid(FIRST), goal=None)["accepted"]
    times = []
    for now[0] in (0.0, 0.049, 0.05, 0.06, 0.0999, 0.1, 0.3, 0.34, 0.0, 0.04, 0.05):
        times += [now[0] for topic, _ in server.news() if topic == "/a/_action/feedback"]
    assert times == [0.0, 0.05, 0.1, 0.3, 0.0, 0.05]


def test_a_time_cancels_the_goals_that_were_accepted_until_then():
    now, ended_goals = [0.0], []
    started = iter(["first", "second", "third"])

    def start(goal):
        name = next(started)
        return Message(
            status="executing", is_done=False, feedback=None, result=None, cancel=lambda: ended_goals.append(name)
        )

    kind = "control_msgs/action/FollowJointTrajectory"
    server = ActionServer("/a", kind, "/n", start, lambda: now[0])
    for now[0], key in ((0.9, FIRST), (1.25, SECOND), (1.75, bytes([7] * 16))):
        assert call(server, "send_goal", goal_id=uuid(key), goal=None)["accepted"]
    response = cancel(server, bytes(16), Message(sec=1, nanosec=250_000_000))
    assert ended_goals == ["first", "second"]  # the second was accepted at that very time
    assert len(response["goals_canceling"]) == 2
