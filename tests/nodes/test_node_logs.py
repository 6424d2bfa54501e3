"""Lines of node programs' loggers on ``/rosout``, as rclpy publishes them."""

from itertools import pairwise

from conftest import rovers
from nodes.node_runs import running, script

NODE = """
class My(Node):
    def __init__(self):
        super().__init__("talker", namespace="/lab")
        self.get_logger().info("born")
        self.create_timer(0.1, self.tick)

    def tick(self):
        self.get_logger().warning("late", throttle_duration_sec=0.15)
        self.get_logger().debug("not enabled")
        self.get_logger().get_child("deep").fatal(f"below")
"""


def heard_of(twin, until=0.35):
    heard = []
    twin.subscribe("/rosout", heard.append)
    twin.advance_to(until)
    return [(line.name, line.level, line.msg) for line in heard], heard


def test_a_line_has_the_node_the_level_the_place_and_the_time(tmp_path):
    file = script(tmp_path, "node.py", NODE)
    with running(file) as twin:
        told, lines = heard_of(twin)
    below = ("lab.talker.deep", 50, "below")
    late = ("lab.talker", 30, "late")
    assert told == [("lab.talker", 20, "born"), late, below, below, late, below]
    first, second = lines[:2]
    text = file.read_text().splitlines()
    assert (first.file, first.function) == (str(file), "__init__")
    assert 'info("born")' in text[first.line - 1]
    assert (second.function, second.stamp.sec, second.stamp.nanosec) == ("tick", 0, 100_000_000)
    assert "late" in text[second.line - 1]


SILENT = """
class My(Node):
    def __init__(self):
        super().__init__("silent", enable_rosout=False)
        self.get_logger().info("not on the graph")
        self.get_logger().get_child("below").info("neither")
        rclpy.logging.get_logger("nobody").info("of no node")
        other = Node("other")
        rclpy.logging.get_logger("other").info("by its name")
        other.destroy_node()
        other.get_logger().info("after its end")
"""


def test_a_node_without_rosout_and_loggers_of_no_node_are_not_published(tmp_path, capsys):
    with running(script(tmp_path, "node.py", SILENT)) as twin:
        told, _ = heard_of(twin)
    assert told == [("other", 20, "by its name")]
    assert capsys.readouterr().err.count("[INFO]") == 5


def test_the_command_line_ends_it_for_all_nodes(tmp_path):
    file = script(tmp_path, "node.py", NODE)
    with rovers(1).node(file, "--ros-args", "--disable-rosout-logs").build() as twin:
        assert heard_of(twin)[0] == []
    with rovers(1).node(file, "--ros-args", "--enable-rosout-logs").build() as twin:
        assert heard_of(twin)[0]


LISTENER = """
from rcl_interfaces.msg import Log


class My(Node):
    def __init__(self):
        super().__init__("echo")
        profile = rclpy.qos.QoSProfile(depth=10, durability=rclpy.qos.DurabilityPolicy.TRANSIENT_LOCAL)
        self.create_subscription(Log, "/rosout", self.hear, profile)
        self.count = 0

    def hear(self, line):
        self.count += 1
        self.get_logger().info(f"{self.count}: {line.name}")
"""


def test_a_node_hears_lines_a_step_later_so_that_two_that_answer_each_other_let_time_pass(tmp_path):
    """Each answer is of a step of 1 ms after the line that it answers."""
    files = [script(tmp_path, f"{name}.py", text) for name, text in (("talker", NODE), ("echo", LISTENER))]
    with running(*files) as twin:
        _, lines = heard_of(twin, 0.02)
    echoes = [line for line in lines if line.name == "echo"]
    assert echoes[0].msg == "1: lab.talker"
    stamps = [line.stamp.nanosec for line in echoes]
    assert len(stamps) > 5
    assert all(second - first >= 1_000_000 for first, second in pairwise(stamps))
