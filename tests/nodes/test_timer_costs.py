"""What a node's timer costs, in calls of Python functions, which do not depend on the machine."""

import sys
import threading

from conftest import rovers
from node_runs import HEAD, script

from drake_twin.messages import float64_multi_array

TOPICS = [f"/robot_{index}/forward_velocity_controller/commands" for index in (1, 2)]

DRIVE = (
    HEAD
    + f"""
class Drive(Node):
    def __init__(self):
        super().__init__("drive")
        self.drives = [self.create_publisher(Float64MultiArray, topic, 10) for topic in {TOPICS}]
        self.create_timer(0.005, self.tick)

    def tick(self):
        for publisher in self.drives:
            publisher.publish(Float64MultiArray(data=[2.0, 2.0, 2.0, 2.0]))


rclpy.init()
rclpy.spin(Drive())
"""
)


def calls(twin):
    """The calls of Python functions in all threads, in each of 100 periods of 5 ms."""
    count = 0

    def take(frame, event, argument):
        nonlocal count
        count += event == "call"

    before = sys.getprofile()
    threading.setprofile(take)
    sys.setprofile(take)
    try:
        twin.advance_to(0.1)  # nodes begin
        begin = count
        twin.advance_to(0.6)
        return (count - begin) / 100
    finally:
        threading.setprofile(None)
        sys.setprofile(before)


def test_a_timer_costs_less_than_a_tenth_above_a_subscriber(tmp_path):
    """Both publish the same message at the same rate; measured are 166 and 181 calls, without either 1."""
    with rovers(2).build() as twin:
        idle = calls(twin)
    with rovers(2).build() as twin:

        def publish(_):
            for topic in TOPICS:
                twin.publish(topic, float64_multi_array([2.0, 2.0, 2.0, 2.0]))

        twin.subscribe("/clock", publish, rate=200)
        subscriber = calls(twin)
    with rovers(2).node(script(tmp_path, "drive.py", DRIVE)).build() as twin:
        timer = calls(twin)
        assert twin.graph.command(TOPICS[1]).data.tolist() == [2.0, 2.0, 2.0, 2.0]
    assert timer < 1.1 * subscriber
    assert subscriber > idle + 20
