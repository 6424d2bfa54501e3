"""An action that a node offers by services of its own; the expected lines are what rclpy 7.1 prints."""

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
