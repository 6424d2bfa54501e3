"""Nodes and the world: with a wire open, other programs hear nodes, are heard, and ask their services."""

from contextlib import contextmanager

import numpy as np
from conftest import rovers
from node_runs import HEAD, lines, script
from wires.local_wire import LocalWire

from drake_twin.messages.interface_types import deserialize, make, serialize
from drake_twin.services.graph import connect

NODE = """
from std_srvs.srv import Trigger


class My(Node):
    def __init__(self):
        super().__init__("my")
        self.publisher = self.create_publisher(String, "said", 10)
        self.create_subscription(String, "told", self.told, 10)
        self.create_service(Trigger, "ask", self.ask)
        self.create_timer(0.1, lambda: self.publisher.publish(String(data="hello")))

    def told(self, message):
        print("told", message.data)

    def ask(self, request, response):
        response.success, response.message = True, "yes"
        return response
"""


def test_a_wire_carries_what_nodes_have(tmp_path, capsys):
    twin = rovers(1).node(script(tmp_path, "my.py", NODE)).build()
    (nodes,) = twin.companions
    wire = LocalWire()
    seam = connect(twin, [wire], nodes)
    try:
        twin.advance_to(0.01)
        twin.advance_to(0.02)  # the seam looks between two advances
        sent = wire.hear("/said")
        twin.advance_to(0.05)
        wire.listeners["/told"].call(serialize(make("std_msgs/msg/String", {"data": "secret"})))
        replies = []
        wire.services["/ask"].call(serialize(make("std_srvs/srv/Trigger_Request", {})), replies.append)
        for step in range(6, 26):
            twin.advance_to(step / 100)
        seam.flush()
    finally:
        seam.close()
        twin.close()
    assert lines(capsys) == ["told secret"]
    assert [deserialize("std_msgs/msg/String", data).data for data, _ in sent] == ["hello"] * 2
    assert [time for _, time in sent] == [100000000, 200000000]
    (reply,) = replies
    assert deserialize("std_srvs/srv/Trigger_Response", reply).message == "yes"


PARAMETERS = """
from rcl_interfaces.msg import FloatingPointRange, ParameterDescriptor, SetParametersResult


class My(Node):
    def __init__(self):
        super().__init__("my")
        self.declare_parameter("speed", 1.5, ParameterDescriptor(description="m/s", floating_point_range=[
            FloatingPointRange(from_value=0.0, to_value=2.0)]))
        self.declare_parameter("gains.p", [1.0, 2.0])
        self.declare_parameter("name", "a", ParameterDescriptor(read_only=True))
        self.add_on_set_parameters_callback(self.decide)

    def decide(self, parameters):
        print("set", {item.name: item.value for item in parameters})
        return SetParametersResult(successful=parameters[0].value != 0.25, reason="not a quarter")
"""


QUALITIES = """
from rclpy.duration import Duration
from rclpy.qos import DurabilityPolicy, HistoryPolicy, LivelinessPolicy, QoSProfile, ReliabilityPolicy


class My(Node):
    def __init__(self):
        super().__init__("my")
        self.ends = []
        for spans in ((0.25, 2.0, 3.0), (0.5, 1.0, 4.0)):
            deadline, lifespan, lease = (Duration(seconds=span) for span in spans)
            alive = {"liveliness": LivelinessPolicy.MANUAL_BY_TOPIC, "liveliness_lease_duration": lease}
            profile = QoSProfile(depth=round(spans[2]), deadline=deadline, lifespan=lifespan, **alive)
            self.ends.append(self.create_publisher(String, "said", profile))
            self.ends.append(self.create_subscription(String, "told", print, profile))
        lossy = QoSProfile(history=HistoryPolicy.KEEP_ALL, reliability=ReliabilityPolicy.BEST_EFFORT)
        self.ends.append(self.create_publisher(String, "lossy", lossy))
        kept = QoSProfile(depth=7, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        self.ends.append(self.create_publisher(String, "kept", kept))
        self.ends.append(self.create_subscription(String, "plain", print, 3))
"""


def test_the_world_is_told_the_quality_of_service_of_nodes(tmp_path):
    """One endpoint is for all of a topic: it offers the best that they offer, and requests what suits all."""

    def quality(endpoint):
        return {
            name: value
            for name in (
                "latched",
                "is_best_effort",
                "depth",
                "lifespan",
                "keeps_all",
                "deadline",
                "is_manual",
                "lease",
            )
            if (value := getattr(endpoint, name)) not in (None, False, 0)
        }

    with wired(tmp_path, QUALITIES) as (_, wire, _ask):
        said, told = wire.senders["/said"].topic, wire.listeners["/told"].endpoint
        assert quality(said) == {"depth": 4, "lifespan": 2.0, "deadline": 0.25, "is_manual": True, "lease": 3.0}
        assert quality(told) == {"depth": 4, "deadline": 0.5, "is_manual": True, "lease": 4.0}
        assert quality(wire.senders["/lossy"].topic) == {"is_best_effort": True, "keeps_all": True}
        assert quality(wire.senders["/kept"].topic) == {"latched": True, "depth": 7}
        assert quality(wire.listeners["/plain"].endpoint) == {"depth": 3}


LARGE = """
from std_msgs.msg import UInt8MultiArray


class My(Node):
    def __init__(self):
        super().__init__("my")
        self.create_subscription(UInt8MultiArray, "picture", lambda message: print(len(message.data)), 1)
"""


def test_a_node_hears_a_message_of_ten_megabytes(tmp_path, capsys):
    """A picture in HD has six; what commands a robot has a kilobyte."""
    with wired(tmp_path, LARGE) as (twin, wire, _):
        data = serialize(make("std_msgs/msg/UInt8MultiArray", {"data": np.zeros(10_000_000, np.uint8)}))
        wire.listeners["/picture"].call(data)
        twin.advance_to(twin.time + 0.02)
        assert wire.listeners["/picture"].endpoint.largest == 64 << 20
        assert wire.listeners["/robot_1/forward_velocity_controller/commands"].endpoint.largest == 1 << 20
    assert lines(capsys) == ["10000000"]


@contextmanager
def wired(tmp_path, *texts):
    """A twin of nodes on a local wire, and the function that asks their services."""
    builder = rovers(1)
    for index, text in enumerate(texts):
        builder.node(script(tmp_path, f"my{index}.py", text))
    twin = builder.build()
    wire = LocalWire()
    seam = connect(twin, [wire], twin.companions[0])

    def ask(name, fields, seconds=0.05):
        kind = wire.services[name].endpoint.type
        replies = []
        wire.services[name].call(serialize(make(f"{kind}_Request", fields)), replies.append)
        for _ in range(round(seconds / 0.01)):
            twin.advance_to(twin.time + 0.01)
        seam.flush()
        (reply,) = replies
        return deserialize(f"{kind}_Response", reply)

    try:
        twin.advance_to(0.01)
        twin.advance_to(0.02)
        yield twin, wire, ask
    finally:
        seam.close()
        twin.close()


def test_a_nodes_parameters_are_asked_for_and_set(tmp_path, capsys):
    """The answers are those of rclpy's parameter_service.py; types are of rcl_interfaces/msg/ParameterType."""
    with wired(tmp_path, PARAMETERS) as (_, wire, ask):
        assert wire.services["/my/list_parameters"].endpoint.node == "/my"
        listed = ask("/my/list_parameters", {}).result
        assert listed.names == ["use_sim_time", "start_type_description_service", "speed", "gains.p", "name"]
        assert listed.prefixes == ["gains"]
        assert ask("/my/get_parameters", {"names": ["speed", "absent"]}).values == []
        values = ask("/my/get_parameters", {"names": ["speed", "gains.p"]}).values
        assert [item.type for item in values] == [3, 8]
        assert values[0].double_value == 1.5
        assert values[1].double_array_value.tolist() == [1.0, 2.0]
        assert ask("/my/get_parameter_types", {"names": ["name", "use_sim_time"]}).types.tolist() == [4, 1]
        assert ask("/my/describe_parameters", {"names": ["speed", "absent"]}).descriptors == []
        speed, clock = ask("/my/describe_parameters", {"names": ["speed", "use_sim_time"]}).descriptors
        assert (speed.name, speed.description, speed.floating_point_range[0].to_value) == ("speed", "m/s", 2.0)
        assert (clock.name, clock.type) == ("use_sim_time", 1)
        wanted = [
            {"name": name, "value": value}
            for name, value in (
                ("speed", {"type": 3, "double_value": 0.5}),
                ("speed", {"type": 3, "double_value": 0.25}),
                ("speed", {"type": 3, "double_value": 3.0}),
                ("speed", {"type": 4, "string_value": "fast"}),
                ("speed", {"type": 77}),
                ("name", {"type": 4, "string_value": "b"}),
                ("absent", {"type": 2, "integer_value": 1}),
            )
        ]
        capsys.readouterr()
        results = ask("/my/set_parameters", {"parameters": wanted}).results
        assert [item.successful for item in results] == [True, False, False, False, False, False, False]
        assert results[1].reason == "not a quarter"
        assert "out of range" in results[2].reason
        assert "read-only" in results[5].reason
        assert lines(capsys) == ["set {'speed': 0.5}", "set {'speed': 0.25}"]
        together = [{"name": "speed", "value": {"type": 3, "double_value": 1.0}}, wanted[5]]
        assert not ask("/my/set_parameters_atomically", {"parameters": together}).result.successful
        assert ask("/my/get_parameters", {"names": ["speed"]}).values[0].double_value == 0.5


ACTION = f"""{HEAD}
import time
from example_interfaces.action import Fibonacci
from rclpy.action import ActionServer, CancelResponse, GoalResponse
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor


class My(Node):
    def __init__(self):
        super().__init__("my")
        self.server = ActionServer(
            self, Fibonacci, "count", self.execute, callback_group=ReentrantCallbackGroup(),
            goal_callback=lambda goal: GoalResponse.ACCEPT if goal.order < 10 else GoalResponse.REJECT,
            cancel_callback=lambda goal: CancelResponse.ACCEPT if goal.request.order > 3 else CancelResponse.REJECT)

    def execute(self, goal):
        found = [0, 1]
        for number in range(1, goal.request.order):
            time.sleep(0.1)
            if goal.is_cancel_requested:
                goal.canceled()
                return Fibonacci.Result(sequence=found)
            found.append(found[-1] + found[-2])
            goal.publish_feedback(Fibonacci.Feedback(sequence=found))
        if goal.request.order == 9:
            rclpy.shutdown()
            time.sleep(10.0)
        goal.succeed()
        return Fibonacci.Result(sequence=found)


def main():
    rclpy.init()
    executor = MultiThreadedExecutor()
    executor.add_node(My())
    try:
        executor.spin()
    except ExternalShutdownException:
        pass


main()
"""
KIND = "example_interfaces/action/Fibonacci"
FIRST, SECOND = ({"uuid": [number] * 16} for number in (1, 2))


def test_a_nodes_action_takes_goals_from_the_wire(tmp_path):
    """The services and topics are those of ROS's actions; statuses are of action_msgs/msg/GoalStatus."""
    with wired(tmp_path, ACTION) as (_, wire, ask):
        feedback, statuses = wire.hear("/count/_action/feedback"), wire.hear("/count/_action/status")
        assert wire.services["/count/_action/send_goal"].endpoint.type == f"{KIND}_SendGoal"
        assert wire.services["/count/_action/send_goal"].endpoint.node == "/my"
        answer = ask("/count/_action/send_goal", {"goal_id": FIRST, "goal": {"order": 3}})
        assert answer.accepted
        assert answer.stamp.nanosec > 0
        assert not ask("/count/_action/send_goal", {"goal_id": SECOND, "goal": {"order": 10}}).accepted
        ended = ask("/count/_action/get_result", {"goal_id": FIRST}, 0.3)
        assert (ended.status, ended.result.sequence.tolist()) == (4, [0, 1, 1, 2])
        assert ask("/count/_action/get_result", {"goal_id": SECOND}).status == 0
        wire_type = f"{KIND}_FeedbackMessage"
        heard = [deserialize(wire_type, data) for data, _ in feedback]
        assert [item.feedback.sequence.tolist() for item in heard] == [[0, 1, 1], [0, 1, 1, 2]]
        assert {bytes(item.goal_id.uuid) for item in heard} == {bytes([1] * 16)}
        arrays = [deserialize("action_msgs/msg/GoalStatusArray", data) for data, _ in statuses]
        assert [[item.status for item in array.status_list] for array in arrays] == [[2], [4]]


def test_a_goal_of_a_node_is_canceled_from_the_wire_if_the_node_wants(tmp_path):
    """The codes are those of action_msgs/srv/CancelGoal."""
    with wired(tmp_path, ACTION) as (_, _, ask):
        ask("/count/_action/send_goal", {"goal_id": FIRST, "goal": {"order": 3}})
        ask("/count/_action/send_goal", {"goal_id": SECOND, "goal": {"order": 8}})
        refused = ask("/count/_action/cancel_goal", {"goal_info": {"goal_id": FIRST}})
        assert (refused.return_code, refused.goals_canceling) == (0, [])  # as rclpy, where no goal is left
        canceled = ask("/count/_action/cancel_goal", {})
        assert canceled.return_code == 0
        assert [bytes(item.goal_id.uuid) for item in canceled.goals_canceling] == [bytes([2] * 16)]
        assert ask("/count/_action/get_result", {"goal_id": SECOND}, 0.3).status == 5
        assert ask("/count/_action/get_result", {"goal_id": FIRST}).status == 4
        assert ask("/count/_action/cancel_goal", {"goal_info": {"goal_id": SECOND}}).return_code == 3
        assert ask("/count/_action/cancel_goal", {"goal_info": {"goal_id": {"uuid": [9] * 16}}}).return_code == 2


def test_an_action_ends_with_its_node_and_answers_no_more(tmp_path):
    """As in ROS: who waits for the result of a server that has died waits for ever."""
    with wired(tmp_path, ACTION) as (twin, wire, ask):
        assert ask("/count/_action/send_goal", {"goal_id": FIRST, "goal": {"order": 9}}).accepted
        replies = []
        request = serialize(make(f"{KIND}_GetResult_Request", {"goal_id": FIRST}))
        wire.services["/count/_action/get_result"].call(request, replies.append)
        while twin.time < 1.5:
            twin.advance_to(twin.time + 0.01)
        assert replies == []
        assert wire.services["/count/_action/send_goal"].is_closed
        assert wire.services["/my/get_parameters"].is_closed
