import pytest

from drake_twin.cockpit.real_time_factor import RealTimeFactor


def test_the_factor_is_that_of_the_last_moment():
    factor = RealTimeFactor()
    assert factor.note(0.0, 0.0, paused=False) is None
    for index in range(1, 100):
        measured = factor.note(0.03 * index, 0.06 * index, paused=False)
    assert measured == pytest.approx(2.0)
    for index in range(1, 20):  # half a second after a change it is the new one
        measured = factor.note(2.97 + 0.03 * index, 5.94 + 0.015 * index, paused=False)
    assert measured == pytest.approx(0.5)


def test_a_pause_and_a_reset_begin_anew():
    factor = RealTimeFactor()
    for index in range(50):
        factor.note(0.03 * index, 0.03 * index, paused=False)
    assert factor.note(2.0, 1.5, paused=True) is None
    assert factor.note(9.0, 1.5, paused=False) is None
    assert factor.note(9.2, 1.7, paused=False) == pytest.approx(1.0)
    assert factor.note(9.3, 0.0, paused=False) is None
    assert factor.note(9.5, 0.1, paused=False) == pytest.approx(0.5)
