import pytest

from drake_twin.findings import Place
from drake_twin.ros2.launched import LaunchedProcess, joined_namespace


def node(namespace="/", name="n", remappings=()):
    return LaunchedProcess("node", "x", Place("f"), name=name, namespace=namespace, remappings=tuple(remappings))


@pytest.mark.parametrize(
    ("namespace", "remapping", "resolved"),
    [
        ("/", ("robot_description", "rd"), "/rd"),
        ("/", ("/robot_description", "/rd"), "/rd"),
        ("/r", ("robot_description", "/rd"), "/rd"),
        ("/r", ("robot_description", "rd"), "/r/rd"),
        ("/r", ("/robot_description", "/rd"), "/r/robot_description"),  # matches the root's name only
        ("/r", ("/r/robot_description", "rd"), "/r/rd"),
        ("/r", ("n:robot_description", "rd"), "/r/rd"),
        ("/r", ("other:robot_description", "rd"), "/r/robot_description"),
    ],
)
def test_a_remapping_matches_the_fully_qualified_name(namespace, remapping, resolved):
    assert node(namespace, remappings=[remapping]).resolve("robot_description") == resolved


def test_the_first_remapping_that_matches_wins():
    assert node(remappings=[("a", "b"), ("a", "c")]).resolve("a") == "/b"


def test_private_names_stand_below_the_node():
    assert node("/r").resolve("~/commands") == "/r/n/commands"


@pytest.mark.parametrize(
    ("base", "namespace", "joined"),
    [
        (None, None, "/"),
        (None, "a", "/a"),
        ("/a", "b", "/a/b"),
        ("/a", "/b", "/b"),
        ("/a", "", "/a"),
        ("/", "b/", "/b"),
    ],
)
def test_namespaces_are_joined_as_ros_does(base, namespace, joined):
    assert joined_namespace(base, namespace) == joined
