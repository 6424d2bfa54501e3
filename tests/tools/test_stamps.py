"""Times that ``topic pub`` fills in."""

from drake_twin.messages.interface_types import make
from drake_twin.tools.stamps import set_times, without_words


def stamped(kind, values, now=3_000_000_007):
    plain, paths = without_words(kind, values)
    message = make(kind, plain)
    set_times(message, paths, now)
    return message


def test_a_header_and_a_time():
    pose = stamped("geometry_msgs/msg/PoseStamped", {"header": "auto", "pose": {"position": {"x": 2.0}}})
    assert (pose.header.stamp.sec, pose.header.stamp.nanosec, pose.pose.position.x) == (3, 7, 2.0)
    odometry = stamped("nav_msgs/msg/Odometry", {"header": {"stamp": "now", "frame_id": "odom"}})
    assert (odometry.header.stamp.nanosec, odometry.header.frame_id) == (7, "odom")


def test_headers_in_lists():
    path = stamped("nav_msgs/msg/Path", {"poses": [{"header": "auto"}, {}, {"header": {"stamp": "now"}}]})
    assert [pose.header.stamp.sec for pose in path.poses] == [3, 0, 3]


def test_the_words_elsewhere_are_texts():
    assert stamped("std_msgs/msg/String", {"data": "now"}).data == "now"
    assert stamped("std_msgs/msg/Header", {"frame_id": "auto"}).frame_id == "auto"
