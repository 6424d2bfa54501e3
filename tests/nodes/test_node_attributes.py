"""Attributes of a user's subclass: only those that rclpy's own classes have are taken."""

from pathlib import Path

import pytest
from node_runs import HEAD, lines, running, script

import drake_twin.nodes

TREE = Path(drake_twin.nodes.__file__).parent

# What Node of rclpy 7.1.3 has beside its documented members (rclpy/node.py, rclpy/lifecycle/node.py).
OF_RCLPY = """
_context _parameters _publishers _subscriptions _clients _services _timers _guards _default_callback_group _rate_group
_pre_set_parameters_callbacks _on_set_parameters_callbacks _post_set_parameters_callbacks _parameter_overrides
_allow_undeclared_parameters _descriptors _logger _clock _managed_entities _state_machine _callbacks
_service_change_state _service_get_state _service_get_available_states _service_get_available_transitions
_service_get_transition_graph
"""

WALK = """
from rclpy.lifecycle import LifecycleNode

rclpy.init()
for node in (Node("my"), LifecycleNode("managed")):
    print(*sorted({*vars(node), *(name for kind in type(node).__mro__[:-1] for name in vars(kind))}))
"""

NAMES = """
name namespace full graph actions entities jumps arguments handle_ program executor_ events node task state base
_name _namespace _full _full_name _graph _actions _action _entities _jumps _arguments _handle _program _executor _events
_node _task _state _base _waitables _waitable _lock _thread _cli_args _publishes_log _own _twin _time _now _rate
_resolved _added _removed _destroyed _jump _looked _known_node _expanded _infos _offers _topics_of _declare _set _take
_set_declared _refusal _parameter_events _declare_quickly _spin _timer _publisher _subscription _client _service _goal
_transition_events _pass_on _change_state _trigger _called_back _on_change_state _on_get_state current_state
"""

PROGRAM = """
import itertools
from std_srvs.srv import Trigger
from example_interfaces.action import Fibonacci
from rclpy.action import ActionClient, ActionServer, get_action_names_and_types

NAMES = {names!r}.split()


class Walker({base}):
    def __init__(self):
        for name in NAMES:
            setattr(self, name, [])
        super().__init__("my")
        for name in NAMES:
            setattr(self, name, [])
        self.told = []
        self.declare_parameter("speed", 1.0)
        self.talker = self.create_publisher(String, "talk", 10)
        self.create_subscription(String, "talk", lambda message: self.told.append(message.data), 10)
        self.create_service(Trigger, "ask", lambda request, response: response)
        self.asked = self.create_client(Trigger, "ask")
        self.create_timer(0.1, lambda: self.talker.publish(String(data="x")))
        self.server = ActionServer(self, Fibonacci, "count", self.count)
        self.sender = ActionClient(self, Fibonacci, "count")

    def count(self, handle):
        handle.succeed()
        return Fibonacci.Result()


rclpy.init()
node = Walker()
assert node.asked.wait_for_service(1.0) and node.sender.wait_for_server(1.0)
for future in (node.asked.call_async(Trigger.Request()), node.sender.send_goal_async(Fibonacci.Goal())):
    rclpy.spin_until_future_complete(node, future)
while not node.told:
    rclpy.spin_once(node)
node.set_parameters([rclpy.Parameter("speed", value=2.0)])
print(len(node.told) > 0, node.get_parameter("speed").value, node.get_name(), node.get_fully_qualified_name())
print(node.count_publishers("talk"), len(node.get_publishers_info_by_topic("/talk")), get_action_names_and_types(node))
node.destroy_node()
print([name for name in NAMES if getattr(node, name) != []])
"""


def test_nodes_have_no_other_attributes_than_those_of_rclpy(tmp_path, capsys):
    members = (TREE / "ros_members.txt").read_text("utf-8").splitlines()
    known = {line.partition("(")[0].rpartition(".")[2] for line in members if line.startswith("rclpy.")}
    known |= {*OF_RCLPY.split(), "_rclpy_declare_quickly", "set_parameters_callback"}
    with running(script(tmp_path, "my.py", HEAD + WALK)) as twin:
        twin.advance_to(0.1)
    found = {name for line in lines(capsys) for name in line.split() if "__" not in name}
    assert found - known == set()


@pytest.mark.parametrize("base", ["Node", "rclpy.lifecycle.LifecycleNode"])
def test_a_subclass_has_attributes_of_any_name(tmp_path, capsys, base):
    text = HEAD + "import rclpy.lifecycle\n" + PROGRAM.format(names=NAMES, base=base)
    with running(script(tmp_path, "my.py", text)) as twin:
        twin.advance_to(3.0)
        assert twin.findings == ()
    assert lines(capsys) == [
        "True 2.0 my /my",
        "1 1 [('/count', ['example_interfaces/action/Fibonacci'])]",
        "[]",
    ]
