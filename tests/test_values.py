from fractions import Fraction
from math import inf, nan

import numpy as np
import pytest

from drake_twin.values import is_number, is_true, needed, number_or_none, parse_number, yaml_number


@pytest.mark.parametrize("value", [0, -1, 1.5, Fraction(1, 2), np.float32(2.0), np.int64(3)])
def test_finite_real_numbers_are_numbers(value):
    assert is_number(value)


@pytest.mark.parametrize("value", [True, False, np.True_, nan, inf, 10**400, "1", None, 1j, [1.0]])
def test_other_values_are_not_numbers(value):
    assert not is_number(value)


def test_a_number_may_have_a_bound():
    assert is_number(0.0, least=0.0)
    assert not is_number(-1e-9, least=0.0)


@pytest.mark.parametrize(("text", "value"), [("1", 1.0), (" -1.5e3 ", -1500.0), (".5", 0.5), ("+2.", 2.0)])
def test_text_is_read_as_a_number(text, value):
    assert parse_number(text) == number_or_none(text) == yaml_number(text) == value


@pytest.mark.parametrize("text", ["", "one", "1_000", "١", "1 2", "0x10"])
def test_text_that_is_not_written_as_in_c_is_refused(text):
    assert number_or_none(text) is yaml_number(text) is None
    with pytest.raises(ValueError, match=r"^not a number$"):
        parse_number(text)


@pytest.mark.parametrize("text", ["nan", "-inf", "1e999"])
def test_a_number_that_is_not_finite_is_refused_where_it_must_be(text):
    assert number_or_none(text) is not None
    with pytest.raises(ValueError, match=r"^not finite$"):
        parse_number(text)


@pytest.mark.parametrize(("value", "number"), [(1, 1.0), (np.float32(0.5), 0.5), (True, None), ([], None)])
def test_yaml_values_are_read_as_numbers(value, number):
    assert yaml_number(value) == number


def test_an_integer_that_is_too_large_for_a_float_is_none():
    assert yaml_number(10**400) is None


@pytest.mark.parametrize(("text", "flag"), [("1", True), (" True ", True), ("0", False), ("yes", False), (None, False)])
def test_flags_are_written_as_in_sdf(text, flag):
    assert is_true(text) is flag


def test_a_count_of_numbers_is_said_in_words():
    assert [needed(count) for count in (1, 3, 4)] == [
        "one number is needed",
        "three numbers are needed",
        "4 numbers are needed",
    ]
