"""Regular expressions on names: as Python's where both know them, and in bounded time whatever is asked."""

import random
import re

import pytest

from drake_twin import InputError
from drake_twin.services.name_filter import NameFilter


@pytest.mark.parametrize(
    "text",
    [
        *(
            "",
            "robot",
            "^robot$",
            "_[13]$",
            "ro.ot",
            "[^_]+_1",
            "(arm|rover)_[0-9]+",
            "a{2}",
            "a{2,}b",
            "a{1,3}$",
            "x*",
        ),
        *("(ab|c)*d", "(?:ab)+", r"\d\d", r"\w+_\d", r"a\.b", r"\[", "[]a]", "[^]a]+", "a|", "(|a)b", "()", "(a*)*$"),
        *("^^a", "a$$", "[a-c.]x", "ab?c", "(a|ab)(c|bcd)", "((a)(b)?)+", "^(?:a|b){2,4}$", r"\s", "-", "}", "a{0}b"),
    ],
)
def test_it_accepts_what_python_accepts(text):
    names = ["", "a", "b", "ab", "abc", "aab", "aaab", "robot", "robot_1", "robot_2", "arm_3", "rover_13", "a.b", "a[b"]
    chance = random.Random(text)
    names += ["".join(chance.choices("abcdx_1.]", k=chance.randrange(12))) for _ in range(300)]
    accepted = NameFilter(text)
    for name in names:
        assert accepted.accepts(name) == bool(re.search(text, name)), name


@pytest.mark.parametrize(
    ("text", "name", "is_accepted"),
    [("[[:alpha:]]+_[[:digit:]]$", "arm_1", True), ("^[^[:upper:]]+$", "aB", False), ("[[:punct:]]", "a-b", True)],
)
def test_the_classes_of_posix_are_known(text, name, is_accepted):
    assert NameFilter(text).accepts(name) == is_accepted


@pytest.mark.parametrize("text", ["^(a|a)*$", "^(a+)+$", "(a*)*b", "(.*)*x", "a*a*a*a*a*a*a*a*a*b", "(a?){60}a{60}$"])
def test_what_takes_hours_when_it_goes_back_is_answered(text):
    assert not NameFilter(text).accepts("a" * 59 + "!")


@pytest.mark.parametrize(
    "text", ["((a{50}){50}){50}", "((((){200}){200}){200}){200}", "(a{0,99}){0,99}", "(a|b|c){900}"]
)
def test_repetitions_that_multiply_are_refused(text):
    with pytest.raises(InputError, match="its repetitions are too many"):
        NameFilter(text)


@pytest.mark.parametrize(
    ("text", "why"),
    [
        *(("(", "missing )"), (")", "unbalanced parenthesis"), ("[a", "a bracket"), ("*a", "nothing to repeat")),
        *(("[z-a]", "bad character range"), ("a{3,1}", "the least count"), ("[[:none:]]", "nested set")),
        *(
            (r"(a)\1", "an escape"),
            (r"\ba", "an escape"),
            ("(?=a)", "unknown in POSIX"),
            ("\\", "a bracket"),
        ),
        *(("(" * 100 + ")" * 100, "groups within each other"), ("a" * 257, "more than 256 characters")),
    ],
)
def test_what_it_cannot_have_is_refused_in_words(text, why):
    with pytest.raises(InputError, match=re.escape(why)):
        NameFilter(text)


def test_any_text_is_a_filter_or_refused_in_words():
    chance = random.Random(5)
    accepted = 0
    for _ in range(3000):
        text = "".join(chance.choices("ab()[]{}|*+?^$.\\,-:12", k=chance.randrange(1, 14)))
        try:
            pattern = NameFilter(text)
        except InputError:
            continue
        accepted += 1
        pattern.accepts("aab12,-")
    assert accepted > 100
