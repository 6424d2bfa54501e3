"""Node programs on the graph, against clients that nobody here wrote: zenoh-ros2-sdk, and a plain Zenoh peer."""

import pytest
from conftest import rovers
from nodes.node_runs import HEAD, script
from waiting import until
from wires.ros_client import ros_client, while_running
from wires.zenoh_peer import free_port, peer, tokens

from drake_twin.services.graph import connect
from drake_twin.wires.zenoh_wire import ZenohWire

pytest.importorskip("zenoh")
pytest.importorskip("zenoh_ros2_sdk", reason="zenoh-ros2-sdk, an independent ROS 2 client, is not installed")

from wires.test_ros2_peers import DOMAIN, follow

NODE = f"""{HEAD}
import time
from example_interfaces.action import Fibonacci
from rclpy.action import ActionServer


class My(Node):
    def __init__(self):
        super().__init__("counter", namespace="/lab")
        self.declare_parameter("pause", 0.1)
        self.server = ActionServer(self, Fibonacci, "count", self.execute)

    def execute(self, goal):
        found = [0, 1]
        for number in range(1, goal.request.order):
            time.sleep(self.get_parameter("pause").value)
            found.append(found[-1] + found[-2])
            goal.publish_feedback(Fibonacci.Feedback(sequence=found))
        goal.succeed()
        return Fibonacci.Result(sequence=found)


rclpy.init()
rclpy.spin(My())
"""


ASKING = f"""{HEAD}
from rclpy.action import ActionClient
from example_interfaces.action import Fibonacci

rclpy.init()
node = Node("asking")
client = ActionClient(node, Fibonacci, "/lab/count")
client.wait_for_server()


def say(*words):
    with open(__file__ + ".said", "a") as file:
        print(*words, file=file)


def wait(future):
    rclpy.spin_until_future_complete(node, future)
    return future.result()


def hear(message):
    say("feedback:", *message.feedback.sequence)


goal = wait(client.send_goal_async(Fibonacci.Goal(order=3), hear))
result = wait(goal.get_result_async())
say("result:", result.status, *result.result.sequence)
say("too late:", wait(goal.cancel_goal_async()).return_code)
"""


@pytest.fixture
def port():
    return free_port()


@pytest.fixture
def twin(tmp_path, port):
    twin = rovers(1).node(script(tmp_path, "node.py", NODE)).build()
    seam = connect(twin, [ZenohWire(domain=DOMAIN, port=port)], twin.companions[0])
    twin.advance_to(0.01)
    twin.advance_to(0.02)
    try:
        yield twin
    finally:
        seam.close()
        twin.close()


def test_a_ros_client_reads_and_sets_a_nodes_parameters(twin, port):
    """Type 3 is a double: rcl_interfaces/msg/ParameterType."""
    with ros_client(port, DOMAIN) as client:
        gets = client.service("/lab/counter/get_parameters", "rcl_interfaces/srv/GetParameters")
        sets = client.service("/lab/counter/set_parameters", "rcl_interfaces/srv/SetParameters")
        (before,) = while_running(twin, lambda: gets.call(names=["pause"])).values
        assert (before.type, before.double_value) == (3, 0.1)
        before.double_value = 0.05
        parameter = client.message("rcl_interfaces/msg/Parameter", name="pause", value=before)
        (result,) = while_running(twin, lambda: sets.call(parameters=[parameter])).results
        assert result.successful
        (after,) = while_running(twin, lambda: gets.call(names=["pause"])).values
        assert after.double_value == 0.05


def test_a_nodes_action_is_followed_from_outside(twin, port):
    with peer(port) as other:
        kind, goal = "example_interfaces/action/Fibonacci", {"order": 5}
        response, statuses, feedback = while_running(twin, lambda: follow(other, "/lab/count", kind, goal))
    assert (response.status, response.result.sequence.tolist()) == (4, [0, 1, 1, 2, 3, 5])
    assert [item.feedback.sequence.tolist() for item in feedback] == [
        [0, 1, 1],
        [0, 1, 1, 2],
        [0, 1, 1, 2, 3],
        [0, 1, 1, 2, 3, 5],
    ]
    assert [item.status_list[0].status for item in statuses][-1] == 4


def test_a_node_asks_an_action_of_another_twin(twin, port, tmp_path):
    """The codes are action_msgs's: 4 is a goal that has succeeded, 3 a cancel for one that has ended."""
    node = script(tmp_path, "asking.py", ASKING)
    said = node.with_name(f"{node.name}.said")

    def ask():
        with rovers(1).node(node).build() as other:
            seam = connect(other, [ZenohWire(domain=DOMAIN, port=port)], other.companions[0])
            try:
                while_running(other, lambda: until(lambda: said.exists() and "too late" in said.read_text()))
            finally:
                seam.close()

    while_running(twin, ask)
    assert said.read_text().splitlines() == [
        "feedback: 0 1 1",
        "feedback: 0 1 1 2",
        "result: 4 0 1 1 2",
        "too late: 3",
    ]


def test_a_node_is_on_the_graph_with_its_name_until_it_ends(twin, port):
    def nodes():
        with peer(port) as other:
            return {tuple(text.split("/")[7:9]) for text in tokens(other) if "/NN/" in text}

    assert ("%lab", "counter") in nodes()
    twin.companions[0].close()
    twin.advance_to(0.1)
    twin.advance_to(0.2)
    assert ("%lab", "counter") not in nodes()
