"""What members of rclpy do that were once accepted and did nothing: as in ROS 2 Jazzy, or a finding."""

import pytest
from node_runs import lines, running, script

START = """
import rclpy
from rclpy.node import Node
from rclpy.parameter import Parameter
from std_msgs.msg import String
rclpy.init()
"""


def ran(tmp_path, capsys, text, seconds=0.01):
    """What a script prints, and the findings of its run."""
    file = script(tmp_path, "my.py", START + text)
    with running(file) as twin:
        twin.advance_to(seconds)
        return lines(capsys), twin.findings


def test_callbacks_before_parameters_are_set_change_what_is_set(tmp_path, capsys):
    """rclpy/node.py of 7.1.3: each callback gets the given list, and what they return is put together."""
    found, findings = ran(
        tmp_path,
        capsys,
        """
node = Node("my")
node.declare_parameters("", [("speed", 1.0), ("twice", 0.0)])

def double(parameters):
    return [*parameters, *(Parameter("twice", value=2 * item.value) for item in parameters if item.name == "speed")]

def values():
    return [node.get_parameter(name).value for name in ("speed", "twice")]

node.add_pre_set_parameters_callback(double)
print(node.set_parameters([Parameter("speed", value=3.0)])[0].successful, values())
nothing = lambda parameters: []
node.remove_pre_set_parameters_callback(double)
node.add_pre_set_parameters_callback(nothing)
result = node.set_parameters_atomically([Parameter("speed", value=4.0)])
print(result.successful, result.reason.partition(",")[0], values())
node.remove_pre_set_parameters_callback(nothing)
done = []
node.add_post_set_parameters_callback(done.append)
node.set_parameters([Parameter("speed", value=5.0)])
node.remove_post_set_parameters_callback(done.append)
node.set_parameters([Parameter("speed", value=6.0)])
print(len(done), values())
""",
    )
    assert found == [
        "True [3.0, 6.0]",
        "False parameter list cannot be empty [3.0, 6.0]",
        "1 [6.0, 6.0]",
    ]
    assert findings == ()


def test_a_reset_calls_the_callbacks_of_a_clock_whose_thresholds_it_exceeds(tmp_path, capsys):
    file = script(
        tmp_path,
        "jumps.py",
        """
from rclpy.clock import JumpThreshold
from rclpy.duration import Duration

class My(Node):
    def __init__(self):
        super().__init__("jumps")
        for seconds in (-0.2, -0.5):
            threshold = JumpThreshold(min_forward=None, min_backward=Duration(seconds=seconds))
            self.get_clock().create_jump_callback(
                threshold,
                pre_callback=lambda s=seconds: print("before", s),
                post_callback=lambda jump, s=seconds: print("after", s, jump.delta.nanoseconds, jump.clock_change.name),
            )
        forgotten = JumpThreshold(min_forward=None, min_backward=Duration(nanoseconds=-1))
        self.get_clock().create_jump_callback(forgotten, post_callback=print).unregister()
""",
    )
    with running(file) as twin:
        twin.advance_to(0.3)
        assert lines(capsys) == []
        twin.reset()
        twin.advance_to(0.01)
    assert lines(capsys) == ["before -0.2", "after -0.2 -300000000 ROS_TIME_NO_CHANGE"]


@pytest.mark.parametrize(
    ("arguments", "text"),
    [
        ("min_forward=Duration(nanoseconds=-1), min_backward=None", "min_forward must be a positive"),
        ("min_forward=None, min_backward=Duration(nanoseconds=1)", "min_backward must be a negative"),
        ("min_forward=None, min_backward=None, on_clock_change=False", "At least one jump threshold"),
    ],
)
def test_thresholds_that_nothing_exceeds(tmp_path, capsys, arguments, text):
    code = f"from rclpy.clock import JumpThreshold\nfrom rclpy.duration import Duration\nJumpThreshold({arguments})"
    _, (finding,) = ran(tmp_path, capsys, code)
    assert f"ValueError: {text}" in finding.what


def test_a_clock_wakes_when_its_context_is_shut_down(tmp_path, capsys):
    found, findings = ran(
        tmp_path,
        capsys,
        """
import threading, time
from rclpy.clock import Clock
from rclpy.duration import Duration
threading.Timer(0.2, rclpy.shutdown).start()
print(Clock().sleep_for(Duration(seconds=0.1)), Clock().sleep_for(Duration(seconds=5)), time.time() < 0.3)
try:
    Clock().sleep_for(Duration(seconds=1))
except rclpy.exceptions.NotInitializedException:
    print("not initialized")
""",
        0.5,
    )
    assert found == ["True False True", "not initialized"]
    assert findings == ()


def test_arguments_of_a_node_count_before_those_of_its_program(tmp_path, capsys):
    text = """
own = ["--ros-args", "-r", "__node:=own", "-p", "b:=2"]
for options in ({}, {"cli_args": own}, {"cli_args": own, "use_global_arguments": False}):
    node = Node("my", automatically_declare_parameters_from_overrides=True, **options)
    print(node.get_fully_qualified_name(), [node.get_parameter_or(name).value for name in "ab"])
    node.destroy_node()
"""
    file = script(tmp_path, "my.py", START + text)
    with running((file, {"namespace": "/all", "parameters": {"a": 1, "b": 1}})) as twin:
        twin.advance_to(0.01)
        assert twin.findings == ()
    assert lines(capsys) == ["/all/my [1, 1]", "/all/own [1, 2]", "/own [None, 2]"]


def test_a_context_has_the_domain_that_it_is_given(tmp_path, capsys):
    text = "c = rclpy.Context()\nrclpy.init(context=c, domain_id=7)\n"
    text += "print(c.get_domain_id())\nrclpy.Context().get_domain_id()"
    printed, (finding,) = ran(tmp_path, capsys, text)
    assert printed == ["7"]
    assert "RuntimeError: Context must be initialized before it can have a domain id" in finding.what


def test_a_misspelt_keyword_of_a_logger_is_a_type_error(tmp_path, capsys):
    _, (finding,) = ran(tmp_path, capsys, 'Node("my").get_logger().info("x", trottle_duration_sec=1.0)')
    assert "TypeError" in finding.what
    assert "trottle_duration_sec" in finding.what


def test_the_node_of_the_lifecycle_module_has_states(tmp_path, capsys):
    text = """
from rclpy.lifecycle import LifecycleNode, LifecyclePublisher, Node, Publisher
node = Node("my")
print(isinstance(node, LifecycleNode), Publisher is LifecyclePublisher, node.trigger_configure().name)
"""
    assert ran(tmp_path, capsys, text) == (["True True SUCCESS"], ())


LEVELS = """
from rcl_interfaces.msg import LoggerLevel
from rcl_interfaces.srv import GetLoggerLevels, SetLoggerLevels
node = Node("my", enable_logger_service=True)

def ask(name, request, kind):
    future = node.create_client(kind, f"my/{name}").call_async(request)
    rclpy.spin_until_future_complete(node, future, timeout_sec=1.0)
    return future.result()

level = LoggerLevel(name="my", level=40)
done = ask("set_logger_levels", SetLoggerLevels.Request(levels=[level]), SetLoggerLevels)
print([item.successful for item in done.results])
print([item.level for item in ask("get_logger_levels", GetLoggerLevels.Request(names=["my"]), GetLoggerLevels).levels])
"""


def test_the_levels_of_loggers_are_asked_for_and_set(tmp_path, capsys):
    assert ran(tmp_path, capsys, LEVELS, 0.5) == (["[True]", "[40]"], ())


@pytest.mark.parametrize(
    "start",
    [
        "import rclpy\nfrom rclpy.node import Node\n",
        "import rclpy\nfrom rclpy.action import ActionClient\n",
        "import rclpy\nfrom rclpy.wait_for_message import wait_for_message\n",
        "import rclpy\nrclpy.init()\nrclpy.create_node('my')\n",
    ],
)
def test_modules_that_a_node_needs_are_members_of_rclpy_without_an_import(tmp_path, capsys, start):
    """The modules that `import rclpy.node` loads: the closure of the imports in rclpy 7.1."""
    names = ["qos", "duration", "time", "clock", "executors", "callback_groups", "exceptions", "logging", "parameter"]
    text = f"for name in {names}:\n    assert getattr(rclpy, name).__name__ == 'rclpy.' + name\n"
    file = script(tmp_path, "my.py", start + text + "print(rclpy.qos.QoSProfile(depth=3).depth)\n")
    with running(file) as twin:
        twin.advance_to(0.01)
    assert lines(capsys) == ["3"]


def test_modules_that_nothing_has_imported_are_no_members_of_rclpy(tmp_path, capsys):
    text = """
import rclpy

for name in ("node", "qos", "serialization", "context", "task"):
    print(name, hasattr(rclpy, name))
from rclpy.node import Node

print(hasattr(rclpy, "node"), hasattr(rclpy, "serialization"))
"""
    with running(script(tmp_path, "my.py", text)) as twin:
        twin.advance_to(0.01)
    found = ["node False", "qos False", "serialization False", "context True", "task True", "True False"]
    assert lines(capsys) == found


def test_a_node_may_use_any_name_that_rclpys_own_leaves_free(tmp_path, capsys):
    """rclpy/node.py of 7.1 has none of these: a program that has works on a robot, too."""
    text = """
import rclpy
from rclpy.action import ActionClient
from rclpy.node import Node
from std_msgs.msg import String
from tf2_msgs.action import LookupTransform


class Mine(Node):
    def __init__(self):
        super().__init__("mine")
        for name in ("actions", "entities", "_graph", "_name", "_namespace", "_executor", "_jumps", "_full", "_infos"):
            setattr(self, name, None)
        self.declare_parameter("speed", 1.0)
        self.add_on_set_parameters_callback(lambda items: rclpy.node.SetParametersResult(successful=True))
        self.client = ActionClient(self, LookupTransform, "look")
        self.publisher = self.create_publisher(String, "words", 10)
        self.create_subscription(String, "words", self._take, 10)
        self.create_timer(0.01, self._looked)

    def _set(self):
        return "my own"

    def _take(self, message):
        print(message.data, self._set(), self.get_name(), self.count_publishers("words"))
        raise SystemExit

    def _looked(self):
        self.publisher.publish(String(data=f"{self.get_parameter('speed').value}"))

    _added = _removed = _resolved = _expanded = _refusal = _declare = _offers = _known_node = _set


rclpy.init()
rclpy.spin(Mine())
"""
    with running(script(tmp_path, "my.py", text)) as twin:
        twin.advance_to(0.1)
        assert lines(capsys) == ["1.0 my own mine 1"]
        assert twin.findings == ()
