"""The context of a launch file under ROS's own names."""

import pytest

from drake_twin.ros2.launch.launch_context import LaunchContext
from drake_twin.ros2.launch.substitutions.text_substitution import TextSubstitution


def test_a_context_has_the_arguments_that_it_is_given():
    given = ["a:=1"]
    context = LaunchContext(argv=given, noninteractive=True, arguments={"a": "1"})
    assert (context.argv, context.noninteractive) == (["a:=1"], True)
    assert context.argv is not given
    assert context.launch_configurations["a"] == "1"
    plain = LaunchContext()
    assert (plain.argv, plain.noninteractive, plain.is_shutdown, plain.asyncio_loop) == ([], False, False, None)
    assert dict(plain.launch_configurations) == {}


def test_locals_come_before_globals_and_are_attributes():
    context = LaunchContext()
    context.extend_globals({"a": 1, "b": 2})
    context.extend_locals({"b": 3})
    assert context.get_locals_as_dict() == {"a": 1, "b": 3}
    assert (context.locals.a, context.locals.b) == (1, 3)


def test_texts_and_substitutions_are_joined():
    context = LaunchContext()
    assert context.perform_substitution(["a", TextSubstitution(text="b"), "c"]) == "abc"
    with pytest.raises(TypeError):
        context.perform_substitution(3)


def test_what_ros_refuses_is_noted_once():
    context = LaunchContext()
    for what in ("a", "b", "a"):
        context.refused_by_ros(what)
    assert [item.what for item in context.refused] == ["a", "b"]


def test_an_anonymous_name_is_the_same_each_time():
    context = LaunchContext()
    assert [context.anonymous_name(name) for name in ("n", "m", "n")] == ["n_1", "m_2", "n_1"]
