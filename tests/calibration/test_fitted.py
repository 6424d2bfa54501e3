"""Ranges that are searched: shares of them, by factors where they are above zero."""

import pytest

from drake_twin.calibration.fitted import Fitted
from drake_twin.errors import InputError

LINEAR, FACTOR = Fitted("x", 2.0 - 6.0, 8.0), Fitted("mass", 0.5, 8.0)


@pytest.mark.parametrize(
    ("share", "linear", "factor"), [(0.0, -4.0, 0.5), (0.25, -1.0, 1.0), (0.5, 2.0, 2.0), (1.0, 8.0, 8.0)]
)
def test_a_share_is_a_value_and_a_value_is_a_share(share, linear, factor):
    assert [LINEAR.at(share), FACTOR.at(share)] == pytest.approx([linear, factor])
    assert [LINEAR.share(linear), FACTOR.share(factor)] == pytest.approx([share, share])


def test_beyond_its_ends_it_is_its_ends():
    for fitted in (LINEAR, FACTOR):
        assert [fitted.at(-0.1), fitted.at(1.7)] == pytest.approx([fitted.low, fitted.high])
        assert (fitted.share(fitted.low - 1.0), fitted.share(fitted.high + 1.0)) == (0.0, 1.0)


def test_an_error_of_a_share_is_one_of_the_value():
    assert LINEAR.error(0.3, -0.01) == pytest.approx(0.12)
    assert FACTOR.error(0.5, 0.001) == pytest.approx(FACTOR.at(0.5005) - FACTOR.at(0.4995), rel=1e-6)


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("mass", "must read PATH=LOW:HIGH"),
        ("mass=1", "must read PATH=LOW:HIGH"),
        ("mass=a:2", "must read PATH=LOW:HIGH"),
        ("=1:2", "must read PATH=LOW:HIGH"),
        ("mass=1:2:3", "must read PATH=LOW:HIGH"),
        ("mass=2:2", "the lower end must be less"),
        ("mass=1:inf", "both finite"),
    ],
)
def test_what_is_no_range_is_refused(text, why):
    with pytest.raises(InputError, match=why):
        Fitted.parse(text)
    assert Fitted.parse("r.mass = 1 : 2.5") == Fitted("r.mass", 1.0, 2.5)
