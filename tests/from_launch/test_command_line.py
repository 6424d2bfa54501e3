import pytest

from drake_twin.errors import InputError
from drake_twin.findings import Place
from drake_twin.from_launch.command_line import command_line
from drake_twin.ros2.launched import LaunchedProcess


def line(*words, **options):
    return command_line(LaunchedProcess("node", "x", Place("f.launch.py", 7), arguments=words), **options)


@pytest.mark.parametrize("words", [("-x", "1"), ("--x", "1"), ("--x=1",), ("-x=1",)])
def test_the_ways_to_write_an_option_are_the_same(words):
    assert line(*words).number("x") == 1


def test_negative_numbers_are_values():
    parsed = line("-x", "-1.5", "-2e3", "name")
    assert (parsed.number("x"), parsed.words) == (-1.5, ("-2e3", "name"))


def test_a_flag_leaves_the_next_word_alone():
    assert line("--inactive", "name", flags=("inactive",)).words == ("name",)
    assert line("--inactive", "name").words == ()


def test_a_flag_may_be_a_number():
    parsed = line("-1", "topic", flags=("1",))
    assert (parsed.flag("1"), parsed.words) == (True, ("topic",))


def test_a_list_ends_at_the_next_option():
    parsed = line("--activate", "a", "b", "--strict", lists=("activate",))
    assert parsed.options["activate"] == ("a", "b")


def test_a_verbatim_value_may_look_like_an_option():
    parsed = line("name", "--args", "-r a:=b", "-c", "m", verbatim=("args",))
    assert parsed.options == {"args": ("-r a:=b",), "c": ("m",)}


def test_the_last_of_several_values_holds_and_an_option_goes_before_a_parameter():
    parsed = line("-x", "1", "-x", "2", defaults={"x": 3.0, "y": 4.0})
    assert (parsed.number("x"), parsed.number("y"), parsed.number("z")) == (2, 4, 0)


@pytest.mark.parametrize(("value", "given"), [("true", True), ("1", True), ("False", False), ("0", False)])
def test_a_flag_with_a_value_is_what_the_value_says(value, given):
    assert line(f"-allow_renaming={value}").flag("allow_renaming") is given


@pytest.mark.parametrize(
    ("value", "message"), [("abc", "which is not a number"), ("nan", "is not finite"), ("inf", "is not finite")]
)
def test_what_is_no_number_is_refused_with_its_place(value, message):
    with pytest.raises(InputError, match=rf"f.launch.py:7: -x is '{value}', .*{message}"):
        line("-x", value).number("x")
