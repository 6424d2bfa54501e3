"""Which topics of a robot are used: by their names, by what only one robot has, or as the user says."""

import pytest

from drake_twin import Twin
from drake_twin.builder.demo import demo_scenario
from drake_twin.errors import InputError
from drake_twin.mirror.watched import watched_topics

STATES, ODOMETRY, ARRAY = "sensor_msgs/msg/JointState", "nav_msgs/msg/Odometry", "std_msgs/msg/Float64MultiArray"


@pytest.fixture(scope="module")
def endpoints():
    found = {}
    for count in (1, 2):
        with Twin(demo_scenario("rover", count, drive=False)) as twin:
            found[count] = twin.graph.endpoints
    return found


def test_topics_of_the_same_names_belong_together(endpoints):
    known = {
        "/robot_1/joint_states": STATES,
        "/robot_1/forward_velocity_controller/commands": ARRAY,
        "/robot_2/ground_truth/odom": ODOMETRY,
        "/camera": "sensor_msgs/msg/Image",
    }
    found = watched_topics(known, endpoints[2], {}, "the bag")
    assert found.commands == {
        "/robot_1/forward_velocity_controller/commands": "/robot_1/forward_velocity_controller/commands"
    }
    assert {topic: (item.robot, item.kind) for topic, item in found.measured.items()} == {
        "/robot_1/joint_states": ("robot_1", "joints"),
        "/robot_2/ground_truth/odom": ("robot_2", "pose"),
    }
    assert found.notes == ("/camera (sensor_msgs/msg/Image) is not used",)


def test_the_only_robot_has_topics_of_any_name_and_of_two_only_the_user_knows(endpoints):
    known = {"/joint_states": STATES, "/odom": ODOMETRY}
    assert {item.robot for item in watched_topics(known, endpoints[1], {}, "it").measured.values()} == {"robot_1"}
    with pytest.raises(InputError, match=r"no topic of it measures a robot of the twin; its topics are: /joint_states"):
        watched_topics(known, endpoints[2], {}, "it")
    found = watched_topics(known, endpoints[2], {"/joint_states": "/robot_2/joint_states"}, "it")
    assert found.measured["/joint_states"].robot == "robot_2"
    assert any("/odom" in note and "--map" in note for note in found.notes)


def test_of_two_topics_with_a_robots_pose_that_of_its_name_is_used(endpoints):
    known = {"/odom": ODOMETRY, "/robot_1/ground_truth/odom": ODOMETRY}
    found = watched_topics(known, endpoints[1], {}, "it")
    assert set(found.measured) == {"/robot_1/ground_truth/odom"}
    assert found.notes == ("/odom is not used: robot_1 has another topic for this",)


@pytest.mark.parametrize(
    ("renamed", "said"),
    [
        ({"/no": "/robot_1/joint_states"}, "it lacks the first topic"),
        ({"/joint_states": "/no"}, "lacks the second topic"),
    ],
)
def test_names_that_are_not_there_are_refused(endpoints, renamed, said):
    with pytest.raises(InputError, match=said):
        watched_topics({"/joint_states": STATES}, endpoints[1], renamed, "it")
