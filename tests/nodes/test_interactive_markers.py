"""Nodes that drive where a marker of RViz is dragged, by ``interactive_markers``."""

from conftest import rovers
from node_runs import lines, script

SERVER = """
import rclpy
from geometry_msgs.msg import Pose
from interactive_markers import InteractiveMarkerServer
from visualization_msgs.msg import InteractiveMarker, InteractiveMarkerFeedback

rclpy.init()
node = rclpy.create_node("server")
server = InteractiveMarkerServer(node, "goal")


def dragged(feedback):
    print("dragged", feedback.client_id, feedback.pose.position.x, server.get("arrow").pose.position.x)
    server.applyChanges()


def clicked(feedback):
    print("clicked", server.erase("arrow"), server.get("arrow"))
    server.applyChanges()


marker = InteractiveMarker(name="arrow")
marker.header.frame_id = "map"
server.insert(marker, feedback_callback=dragged)
server.setCallback("arrow", clicked, InteractiveMarkerFeedback.BUTTON_CLICK)
print(server.setPose("arrow", Pose()), server.setPose("none", Pose()))
server.applyChanges()
rclpy.spin(node)
"""
RVIZ = """
import time, rclpy
from rclpy.executors import SingleThreadedExecutor
from visualization_msgs.msg import InteractiveMarkerFeedback, InteractiveMarkerUpdate
from visualization_msgs.srv import GetInteractiveMarkers

rclpy.init()
node = rclpy.create_node("rviz")
publisher = node.create_publisher(InteractiveMarkerFeedback, "goal/feedback", 10)


def show(update):
    markers = [each.name for each in update.markers]
    print("shown", update.seq_num, markers, [each.pose.position.x for each in update.poses], list(update.erases))


node.create_subscription(InteractiveMarkerUpdate, "goal/update", show, 10)
client = node.create_client(GetInteractiveMarkers, "goal/get_interactive_markers")
client.wait_for_service()
future = client.call_async(GetInteractiveMarkers.Request())
rclpy.spin_until_future_complete(node, future)
print([(each.name, each.header.frame_id) for each in future.result().markers], future.result().sequence_number)


def do(kind, x=0.0, who="a", then=0.1):
    message = InteractiveMarkerFeedback(marker_name="arrow", client_id=who, event_type=kind)
    message.pose.position.x = x
    publisher.publish(message)
    end = time.time() + then
    while time.time() < end:
        rclpy.spin_once(node, timeout_sec=0.02)


do(InteractiveMarkerFeedback.POSE_UPDATE, 1.5)
do(InteractiveMarkerFeedback.POSE_UPDATE, 9.0, who="b")
do(InteractiveMarkerFeedback.POSE_UPDATE, 2.5, then=1.2)
do(InteractiveMarkerFeedback.BUTTON_CLICK, who="b")
"""


def test_a_marker_is_dragged_and_clicked(tmp_path, capsys):
    builder = rovers(1, time_step=0.01).node(script(tmp_path, "server.py", SERVER))
    with builder.node(script(tmp_path, "rviz.py", RVIZ)).build() as twin:
        twin.advance_to(3.0)
        assert twin.more_findings == []
    assert lines(capsys) == [
        "False False",  # it is not shown yet
        "[('arrow', 'map')] 1",
        *("dragged a 1.5 1.5", "shown 2 [] [1.5] []"),
        *("dragged a 2.5 2.5", "shown 3 [] [2.5] []"),
        *("clicked True None", "shown 4 [] [] ['arrow']"),
    ]
