"""Topics between nodes, and between nodes and the twin."""

from dataclasses import replace

import pytest
from conftest import rovers
from node_runs import COMMANDS, HEAD, TAIL, lines, running, script


def test_a_node_drives_a_robot(tmp_path):
    """At 2 rad/s on wheels of 0.1 m a rover drives 0.2 m/s."""
    file = script(
        tmp_path,
        "drive.py",
        f"""
class My(Node):
    def __init__(self):
        super().__init__("drive")
        self.publisher = self.create_publisher(Float64MultiArray, "{COMMANDS}", 10)
        self.create_timer(0.1, self.drive)

    def drive(self):
        self.publisher.publish(Float64MultiArray(data=[2.0, 2.0, 2.0, 2.0]))
""",
    )
    with running(file) as twin:
        twin.advance_to(2.0)
        start = twin.entities.state("robot_1").position[0]
        twin.advance_to(4.0)
        assert twin.entities.state("robot_1").position[0] - start == pytest.approx(0.4, rel=0.02)


def test_what_a_node_publishes_is_heard_in_the_next_step(tmp_path, capsys):
    talker = script(
        tmp_path,
        "talker.py",
        """
class My(Node):
    def __init__(self):
        super().__init__("talker")
        self.publisher = self.create_publisher(String, "chatter", 10)
        self.create_timer(0.25, lambda: self.publisher.publish(String(data=str(self.get_clock().now().nanoseconds))))
""",
    )
    listener = script(
        tmp_path,
        "listener.py",
        """
class My(Node):
    def __init__(self):
        super().__init__("listener")
        self.create_subscription(String, "chatter", self.heard, 10)

    def heard(self, message):
        print(message.data, self.get_clock().now().nanoseconds)
""",
    )
    with running(talker, listener) as twin:
        twin.advance_to(0.6)
    assert lines(capsys) == ["250000000 251000000", "500000000 501000000"]


def test_a_message_is_as_it_was_when_it_was_published(tmp_path, capsys):
    talker = script(
        tmp_path,
        "talker.py",
        HEAD
        + """
rclpy.init()
node = rclpy.create_node("talker")
publisher = node.create_publisher(String, "chatter", 10)
node.create_subscription(String, "chatter", lambda message: print(message.data), 10)
message = String(data="before")
publisher.publish(message)
message.data = "after"
rclpy.spin(node)
""",
    )
    with running(talker) as twin:
        twin.advance_to(0.1)
    assert lines(capsys) == ["before"]


def test_a_node_hears_the_twin(tmp_path, capsys):
    file = script(
        tmp_path,
        "listener.py",
        """
from rclpy.qos import DurabilityPolicy, QoSProfile
from sensor_msgs.msg import JointState


class My(Node):
    def __init__(self):
        super().__init__("listener")
        self.create_subscription(JointState, "/robot_1/joint_states", self.heard, 10)
        latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        self.create_subscription(String, "/robot_1/robot_description", self.described, latched)

    def heard(self, message):
        assert isinstance(message, JointState)
        print(len(message.name), message.header.stamp.sec, message.header.stamp.nanosec)

    def described(self, message):
        print(message.data[:30].startswith("<"))
""",
    )
    with running(file) as twin:
        twin.advance_to(0.015)
    assert lines(capsys) == ["4 0 1000000", "True", "4 0 10000000"]  # subscribed in step 0


def test_the_last_messages_wait_in_the_queue_only(tmp_path, capsys):
    file = script(
        tmp_path,
        "late.py",
        HEAD
        + """
import time
rclpy.init()
node = rclpy.create_node("late")
publisher = node.create_publisher(String, "chatter", 10)
node.create_subscription(String, "chatter", lambda message: print(message.data), 2)
for number in range(5):
    publisher.publish(String(data=str(number)))
time.sleep(0.05)
rclpy.spin(node)
""",
    )
    with running(file) as twin:
        twin.advance_to(0.1)
    assert lines(capsys) == ["3", "4"]


def test_a_latched_message_waits_for_late_subscribers(tmp_path, capsys):
    head = HEAD + "from rclpy.qos import DurabilityPolicy, QoSProfile\nimport time\n"
    qos = "QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)"
    talker = script(
        tmp_path,
        "talker.py",
        head
        + f"""
rclpy.init()
node = rclpy.create_node("talker")
publisher = node.create_publisher(String, "map", {qos})
publisher.publish(String(data="first"))
publisher.publish(String(data="second"))
rclpy.spin(node)
""",
    )
    listener = script(
        tmp_path,
        "listener.py",
        head
        + f"""
time.sleep(0.05)
rclpy.init()
node = rclpy.create_node("listener")
node.create_subscription(String, "map", lambda message: print("latched", message.data), {qos})
node.create_subscription(String, "map", lambda message: print("volatile", message.data), 1)
rclpy.spin(node)
""",
    )
    with running(talker, listener) as twin:
        twin.advance_to(0.1)
    assert lines(capsys) == ["latched second"]


def test_a_volatile_subscription_does_not_get_what_the_twin_has_published_before(tmp_path, capsys, caplog):
    """As DDS decides (DDS 1.4, 2.2.3.4): durability is that of the subscription, too."""
    file = script(
        tmp_path,
        "volatile.py",
        """
from rclpy.qos import DurabilityPolicy, QoSProfile
from tf2_msgs.msg import TFMessage


class My(Node):
    def __init__(self):
        super().__init__("listener")
        latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        for topic, kind in (("robot_description", String), ("/tf_static", TFMessage)):
            self.create_subscription(kind, topic, lambda message, topic=topic: print("volatile", topic), 1)
            self.create_subscription(kind, topic, lambda message, topic=topic: print("latched", topic), latched)
""",
    )
    with running((file, {"namespace": "/robot_1"})) as twin:
        twin.advance_to(0.1)
        assert sorted(lines(capsys)) == ["latched /tf_static", "latched robot_description"]
        twin.reset()
        twin.advance_to(0.1)
        assert sorted(lines(capsys)) == ["latched /tf_static", "latched robot_description"]
    why = "does not get what was published before, as it subscribes with the durability VOLATILE, not TRANSIENT_LOCAL"
    assert f"/robot_1/robot_description: /robot_1/listener {why}" in caplog.text


def test_a_volatile_subscription_gets_what_the_twin_publishes_from_then_on(tmp_path, capsys):
    file = script(
        tmp_path,
        "volatile.py",
        """
class My(Node):
    def __init__(self):
        super().__init__("listener")
        self.create_subscription(String, "/robot_2/robot_description", lambda message: print(message.data[:1]), 1)
""",
    )
    with running(file) as twin:
        twin.advance_to(0.1)
        assert lines(capsys) == []
        twin.entities.spawn(replace(twin.scenario.robots[0], name="robot_2", namespace="/robot_2", xyz=(2.0, 0.0, 0.0)))
        twin.advance_to(0.2)
    assert lines(capsys) == ["<"]


def test_a_wrong_type_is_refused_as_in_ros(tmp_path, capsys):
    file = script(
        tmp_path,
        "wrong.py",
        HEAD
        + f"""
rclpy.init()
node = rclpy.create_node("wrong")
publisher = node.create_publisher(Float64MultiArray, "{COMMANDS}", 10)
try:
    publisher.publish(String())
except TypeError as error:
    print("TypeError")
try:
    String(data=3)
except AssertionError as error:
    print("AssertionError")
""",
    )
    with running(file) as twin:
        twin.advance_to(0.1)
        assert twin.findings == ()
    assert lines(capsys) == ["TypeError", "AssertionError"]


def test_another_type_than_the_twins_is_said_once(tmp_path, caplog):
    file = script(
        tmp_path,
        "wrong.py",
        f"""
class My(Node):
    def __init__(self):
        super().__init__("wrong")
        self.create_publisher(String, "{COMMANDS}", 10).publish(String(data="go"))
        self.create_subscription(String, "/robot_1/joint_states", print, 10)
""",
    )
    with running(file) as twin:
        twin.advance_to(0.1)
    texts = [record.getMessage() for record in caplog.records]
    assert texts == [
        f"{COMMANDS}: /wrong publishes std_msgs/msg/String, but it takes std_msgs/msg/Float64MultiArray",
        "/robot_1/joint_states: /wrong expects std_msgs/msg/String, but this is sensor_msgs/msg/JointState",
    ]


def test_a_refused_command_is_said_once(tmp_path, caplog):
    file = script(
        tmp_path,
        "wrong.py",
        f"""
class My(Node):
    def __init__(self):
        super().__init__("wrong")
        self.publisher = self.create_publisher(Float64MultiArray, "{COMMANDS}", 10)
        self.create_timer(0.01, self.go)

    def go(self):
        self.publisher.publish(Float64MultiArray(data=[float("nan")] * 4))
""",
    )
    with running(file) as twin:
        twin.advance_to(0.1)
    (record,) = caplog.records
    assert "nan" in record.getMessage()
    assert record.getMessage().count(COMMANDS) == 1


def test_remapping_namespace_and_name(tmp_path, capsys):
    file = script(
        tmp_path,
        "relative.py",
        """
class My(Node):
    def __init__(self):
        super().__init__("own")
        publisher = self.create_publisher(String, "chatter", 10)
        private = self.create_publisher(String, "~/state", 10)
        print(self.get_fully_qualified_name(), publisher.topic_name, private.topic_name)
        print(self.count_publishers("chatter"), self.count_subscribers("chatter"))
""",
    )
    options = {"name": "other", "namespace": "/robot_1", "remappings": {"chatter": "/elsewhere"}}
    with running(file, (file, options)) as twin:
        twin.advance_to(0.1)
    assert lines(capsys) == [
        "/own /chatter /own/state",
        "1 0",
        "/robot_1/other /elsewhere /robot_1/other/state",
        "0 0",  # a name that is asked for is not remapped (rclpy/node.py of 7.1.3)
    ]


def test_a_spawned_robots_topics_are_heard(tmp_path, capsys):
    file = script(
        tmp_path,
        "listener.py",
        """
from sensor_msgs.msg import JointState


class My(Node):
    def __init__(self):
        super().__init__("listener")
        self.create_subscription(JointState, "/robot_2/joint_states", lambda message: print("heard"), 10)
""",
    )
    assert TAIL in file.read_text()
    with running(file, robots=2) as twin:
        second = twin.scenario.robots[1]
        twin.entities.delete("robot_2")
        twin.advance_to(0.05)
        assert lines(capsys) == []
        twin.entities.spawn(second)
        twin.advance_to(0.075)
    assert lines(capsys) == ["heard"] * 3


def test_log_levels_are_those_of_a_name_and_what_is_below(tmp_path, capfd):
    text = """
import rclpy

rclpy.init()
node = rclpy.create_node("talk")
rclpy.logging._root_logger.info("root")
for logger in (node.get_logger(), node.get_logger().get_child("arm"), rclpy.logging.get_logger("other")):
    logger.debug(f"{logger.name} before")
    rclpy.logging.set_logger_level("talk", rclpy.logging.LoggingSeverity.DEBUG)
    logger.debug(f"{logger.name} after")
    logger.warning(f"{logger.name} warns")
node.get_logger().get_child("arm").set_level(rclpy.logging.LoggingSeverity.ERROR)
node.get_logger().get_child("arm").warning("unheard")
rclpy.logging.get_logger("other").info("other is heard")
"""
    file = script(tmp_path, "talk.py", text)
    arguments = ("--ros-args", "--log-level", "other:=DEBUG", "--log-level", "error", "--log-level", "talk:=info")
    with rovers(1).node(file).node(file, *arguments).build() as twin:
        twin.advance_to(0.01)
        assert twin.findings == ()
    said = [line.rpartition("]: ")[2] for line in capfd.readouterr().err.splitlines() if "]: " in line]
    talk = ["talk after", "talk warns", "talk.arm before", "talk.arm after", "talk.arm warns"]
    assert said == [
        *("root", *talk, "other warns", "other is heard"),
        *(*talk, "other before", "other after", "other warns", "other is heard"),
    ]


def test_an_unknown_log_level(tmp_path):
    file = script(tmp_path, "talk.py", "import rclpy\nrclpy.init()\n")
    with rovers(1).node(file, "--ros-args", "--log-level", "loud").build() as twin:
        twin.advance_to(0.01)
        (finding,) = twin.findings
        assert "Couldn't parse log level: '--log-level loud'" in finding.what


def test_a_raw_subscription_gets_the_bytes_with_their_padding(tmp_path, capsys):
    """As recorded of rclpy 7.1 with rmw_cyclonedds_cpp; what is serialized has none."""
    text = """
import rclpy
from rclpy.serialization import serialize_message
from std_msgs.msg import String
rclpy.init()
node = rclpy.create_node("raw")
node.create_subscription(String, "t", lambda data: print(data[8:]), 10, raw=True)
publisher = node.create_publisher(String, "t", 10)
for each in ("a", "abc", "abcd"):
    print(serialize_message(String(data=each))[8:])
    publisher.publish(String(data=each))
for _ in range(3):
    rclpy.spin_once(node)
"""
    file = script(tmp_path, "raw.py", text)
    with running(file) as twin:
        twin.advance_to(0.1)
    assert lines(capsys) == [
        *(r"b'a\x00'", r"b'abc\x00'", r"b'abcd\x00'"),
        *(r"b'a\x00\x00\x00'", r"b'abc\x00'", r"b'abcd\x00\x00\x00\x00'"),
    ]
