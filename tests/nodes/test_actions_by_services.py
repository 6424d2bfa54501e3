"""An action that a node offers by services of its own; the expected lines are what rclpy 7.1 prints."""

from conftest import rovers
from node_runs import HEAD, lines, running, script

PROGRAM = """
from example_interfaces.action import Fibonacci
from rclpy.action import ActionClient
from rclpy.qos import qos_profile_action_status_default

rclpy.init()
node = Node("my")


def accept(request, response):
    response.accepted = request.goal.order < 9
    return response


def result(request, response):
    response.status, response.result.sequence = 4, [0, 1, 1]
    return response


client = ActionClient(node, Fibonacci, "fibonacci")
print(client.wait_for_server(timeout_sec=0.1))
node.create_service(Fibonacci.Impl.SendGoalService, "fibonacci/_action/send_goal", accept)
node.create_service(Fibonacci.Impl.CancelGoalService, "fibonacci/_action/cancel_goal", lambda _, response: response)
node.create_service(Fibonacci.Impl.GetResultService, "fibonacci/_action/get_result", result)
publisher = node.create_publisher(Fibonacci.Impl.FeedbackMessage, "fibonacci/_action/feedback", 1)
node.create_publisher(Fibonacci.Impl.GoalStatusMessage, "fibonacci/_action/status", qos_profile_action_status_default)
print(client.wait_for_server(timeout_sec=5.0))


def sent(order):
    future = client.send_goal_async(Fibonacci.Goal(order=order), feedback_callback=lambda told: heard.append(told))
    rclpy.spin_until_future_complete(node, future)
    return future.result()


heard = []
print(sent(9).accepted)
handle = sent(3)
print(handle.accepted)
message = Fibonacci.Impl.FeedbackMessage()
publisher.publish(message)
future = handle.get_result_async()
rclpy.spin_until_future_complete(node, future)
print(future.result().status, list(future.result().result.sequence), heard)
"""


def test_a_client_uses_the_services_of_a_node(tmp_path, capsys):
    with running(script(tmp_path, "my.py", HEAD + PROGRAM)) as twin:
        twin.advance_to(1.0)
        assert twin.findings == ()
    assert lines(capsys) == ["False", "True", "False", "True", "4 [0, 1, 1] []"]


SERVER = """
from action_msgs.msg import GoalStatusArray
from action_msgs.srv import CancelGoal
from example_interfaces.action import Fibonacci
from rclpy.action import ActionServer, CancelResponse
from rclpy.qos import qos_profile_action_status_default
from unique_identifier_msgs.msg import UUID

rclpy.init()
node = Node("my")
handles, statuses, feedback = [], [], []
server = ActionServer(
    node, Fibonacci, "count", lambda handle: Fibonacci.Result(), handle_accepted_callback=handles.append,
    cancel_callback=lambda handle: CancelResponse.ACCEPT if handle.request.order else CancelResponse.REJECT,
    result_timeout=1,
)
node.create_subscription(
    GoalStatusArray, "count/_action/status", lambda told: statuses.append([item.status for item in told.status_list]),
    qos_profile_action_status_default,
)
node.create_subscription(Fibonacci.Impl.FeedbackMessage, "count/_action/feedback", feedback.append, 10)


def asked(kind, part, **fields):
    client = node.create_client(kind, f"count/_action/{part}")
    assert client.wait_for_service(1.0)
    future = client.call_async(kind.Request(**fields))
    rclpy.spin_until_future_complete(node, future, timeout_sec=1.0)
    return future.result()


def key(number):
    return UUID(uuid=[number] * 16)


for number, order in ((1, 1), (1, 1), (2, 0), (3, 2)):
    goal = Fibonacci.Goal(order=order)
    print(asked(Fibonacci.Impl.SendGoalService, "send_goal", goal_id=key(number), goal=goal).accepted)
request = CancelGoal.Request()
response = asked(CancelGoal, "cancel_goal", goal_info=request.goal_info)
found = [int(item.goal_id.uuid[0]) for item in response.goals_canceling]
print(response.return_code, found, handles[0].is_cancel_requested)
request.goal_info.goal_id = key(9)
print(asked(CancelGoal, "cancel_goal", goal_info=request.goal_info).return_code)
for act in (handles[1].succeed, handles[0].execute, handles[0].canceled, handles[0].abort, handles[1].execute):
    try:
        act()
    except RuntimeError as error:
        print(error)
handles[1].publish_feedback(Fibonacci.Feedback(sequence=[1, 2]))
handles[1].succeed()
request.goal_info.goal_id = key(2)
print(asked(CancelGoal, "cancel_goal", goal_info=request.goal_info).return_code)
print(statuses[-1])
print([(int(told.goal_id.uuid[0]), list(told.feedback.sequence)) for told in feedback])
rclpy.spin_until_future_complete(node, rclpy.Future(), timeout_sec=1.5)
print([asked(Fibonacci.Impl.GetResultService, "get_result", goal_id=key(number)).status for number in (2, 9)])
print(handles[1].status, handles[2].status)
"""


def test_the_services_and_topics_of_an_action(tmp_path, capsys):
    """Clients and subscriptions of another kind than `ActionClient` reach an action server."""
    with running(script(tmp_path, "my.py", HEAD + SERVER)) as twin:
        twin.advance_to(10.0)
        assert twin.findings == ()
    invalid = "Failed to update goal state: goal_handle attempted invalid transition from state"
    assert lines(capsys) == [
        "True",
        "False",
        "True",
        "True",
        "0 [1, 3] True",
        "2",
        f"{invalid} ACCEPTED with event SUCCEED",
        f"{invalid} CANCELED with event ABORT",
        "3",
        "[5, 4, 3]",
        "[(2, [1, 2])]",
        "[0, 0]",
        "0 3",
    ]


COUNTER = """
from example_interfaces.action import Fibonacci
from rclpy.action import ActionServer


class My(Node):
    def __init__(self):
        super().__init__("counter")
        self.server = ActionServer(self, Fibonacci, "count", self.count)

    def count(self, handle):
        self.get_clock().sleep_for(rclpy.duration.Duration(seconds=0.2))
        handle.publish_feedback(Fibonacci.Feedback(sequence=[handle.request.order]))
        handle.succeed()
        return Fibonacci.Result()
"""

ASKER = """
import sys
from example_interfaces.action import Fibonacci
from rclpy.action import ActionClient

rclpy.init()
node = Node("asker")
client = ActionClient(node, Fibonacci, "count")
client.wait_for_server()
for _ in range(int(sys.argv[1])):
    told = []
    future = client.send_goal_async(Fibonacci.Goal(order=int(sys.argv[1])), feedback_callback=told.append)
    rclpy.spin_until_future_complete(node, future)
    future = future.result().get_result_async()
    rclpy.spin_until_future_complete(node, future)
    print(sys.argv[1], [list(item.feedback.sequence) for item in told], future.result().status)
"""


def test_two_programs_ask_one_action_and_one_ends_before_the_other(tmp_path, capsys):
    asker = script(tmp_path, "asker.py", HEAD + ASKER)
    builder = rovers(1).node(script(tmp_path, "counter.py", COUNTER)).node(asker, "1").node(asker, "3")
    with builder.build() as twin:
        twin.advance_to(3.0)
        assert twin.findings == ()
    assert lines(capsys) == ["1 [[1]] 4", *["3 [[3]] 4"] * 3]
