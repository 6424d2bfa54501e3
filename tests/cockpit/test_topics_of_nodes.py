"""What node programs have between themselves, on the page: listed, shown, plotted, published on, their frames."""

import pytest
from conftest import rovers
from nodes.node_runs import lines, script

from drake_twin.cockpit.topics_panel import TopicsPanel

NODE = """
import math

from geometry_msgs.msg import TransformStamped, Vector3
from rclpy.qos import DurabilityPolicy, QoSProfile
from tf2_ros import StaticTransformBroadcaster


class My(Node):
    def __init__(self):
        super().__init__("my")
        self.publisher = self.create_publisher(Vector3, "wave", 10)
        latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        self.create_publisher(String, "motto", latched).publish(String(data="once"))
        self.create_subscription(String, "told", self.told, 10)
        self.create_timer(0.02, self.wave)
        self.frames = StaticTransformBroadcaster(self)
        item = TransformStamped()
        item.header.frame_id, item.child_frame_id = "world", "dock"
        item.transform.translation.x, item.transform.rotation.w = 3.0, 1.0
        self.frames.sendTransform(item)

    def wave(self):
        seconds = self.get_clock().now().nanoseconds * 1e-9
        self.publisher.publish(Vector3(x=math.sin(seconds), y=seconds))

    def told(self, message):
        print("told", message.data)
"""


def look(panel, echo="", frames=False):
    panel.ask({"do": "Look", "version": 0, "echo": echo, "frames": frames})
    return panel.state()


def test_they_are_listed_shown_plotted_and_published_on(tmp_path, capsys):
    twin = rovers(1).node(script(tmp_path, "my.py", NODE)).build()
    panel = TopicsPanel(twin)
    twin.advance_to(0.1)
    listed = {(item["name"], item["kind"]): item["type"] for item in look(panel, "/wave")["topics"]}
    assert listed["/wave", "published"] == "geometry_msgs/msg/Vector3"
    assert listed["/told", "commanded"] == "std_msgs/msg/String"
    assert len(twin.more_topics.taps) == 2  # the messages and their rate
    panel.ask({"do": "Plot", "topic": "/wave", "field": "y"})
    panel.state()
    twin.advance_to(0.5)
    state = look(panel, "/wave")
    assert dict(row[:2] for row in state["echoes"]["/wave"]["rows"])["y"] == "0.48"
    assert state["echoes"]["/wave"]["rate"] == pytest.approx(50)
    (samples,) = [batch["samples"]["/wave.y"] for batch in state["batches"] if batch["samples"]]
    assert samples[-1] == pytest.approx((0.48, 0.48))
    assert len(samples) == 20
    assert state["problems"] == {}
    form = look(panel, "/told")["echoes"]["/told"]["form"]
    assert form["fields"] == {"data": ""}
    panel.ask({"do": "Publish", "topic": "/told", "text": "{data: secret}", "key": "k"})
    assert panel.state()["outcome"] == {"key": "k", "problem": "", "text": "Published at 0.500 s."}
    panel.ask({"do": "Publish", "topic": "/told", "text": "{date: secret}", "key": "l"})
    assert "date" in panel.state()["outcome"]["problem"]
    twin.advance_to(0.6)
    assert lines(capsys) == ["told secret"]
    motto = look(panel, "/motto")["echoes"]["/motto"]
    assert [row[:2] for row in motto["rows"]] == [("data", "once")]
    panel.watch(False)
    assert twin.more_topics.taps == []
    twin.companions.pop().close()  # the nodes
    assert all(item["name"] != "/wave" for item in look(panel)["topics"])
    twin.close()


def test_their_frames_are_in_the_tree_of_frames(tmp_path):
    with rovers(1).node(script(tmp_path, "my.py", NODE)).build() as twin:
        panel = TopicsPanel(twin)
        twin.advance_to(0.1)
        frames = {item["frame"]: item for item in look(panel, frames=True)["frames"]}
        assert (frames["dock"]["parent"], frames["dock"]["xyz"], frames["dock"]["static"]) == ("world", [3, 0, 0], True)
        assert frames["robot_1_base_link"]["static"] is False or len(frames) > 5
        assert twin.more_topics.taps
        panel.watch(False)
        assert twin.more_topics.taps == []
