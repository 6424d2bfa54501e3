"""The noise of sensors against the formulas of gz-sensors' src/GaussianNoiseModel.cc."""

import contextlib
from functools import cache
from math import exp, sqrt

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from lxml import etree

from drake_twin.description.robot_description import Sensor
from drake_twin.description.sensor_element import SensorElement
from drake_twin.errors import InputError
from drake_twin.findings import Place
from drake_twin.sensors.noise import SILENT, Noise, NoiseSource, read_noise

MANY = 100_000


def channel(noise, name="x", rate=100.0, **more):
    return NoiseSource(rate=rate, **more).channel(name, noise)


@cache
def samples(noise, count=MANY, rate=100.0, name="x", **more):
    dut = channel(noise, name, rate, **more)
    return np.array([dut.apply(0.0, tick / rate) for tick in range(count)])


def read(text):
    elements = range(len(list(etree.fromstring(text).iter(etree.Element))))
    places = tuple(Place("f", line + 1) for line in elements)
    return read_noise(SensorElement(Sensor("s", "imu", text=text, places=places)))


def test_white_noise_has_its_mean_and_its_standard_deviation():
    found = samples(Noise(mean=0.3, stddev=2.0))
    assert found.mean() == pytest.approx(0.3, abs=4 * 2.0 / sqrt(MANY))
    assert found.std() == pytest.approx(2.0, rel=4 / sqrt(2 * MANY))
    kurtosis = np.mean(((found - found.mean()) / found.std()) ** 4)
    assert kurtosis == pytest.approx(3.0, abs=4 * sqrt(24 / MANY))


def test_ticks_axes_sensors_robots_and_seeds_are_not_correlated():
    noise = Noise(stddev=1.0)
    found = [
        samples(noise, MANY // 4),
        samples(noise, MANY // 4, name="y"),
        samples(noise, MANY // 4, sensor="other"),
        samples(noise, MANY // 4, robot="other"),
        samples(noise, MANY // 4, seed=1),
    ]
    table = np.corrcoef([*found, np.roll(found[0], 1), np.roll(found[0], 2)])
    assert np.abs(table - np.eye(len(table))).max() < 4 / sqrt(MANY // 4)


def test_a_bias_is_drawn_once_and_its_sign_is_flipped_half_of_the_time():
    noise = Noise(bias_mean=5.0, bias_stddev=0.5)
    found = np.array([channel(noise, sensor=str(number)).bias(0.0) for number in range(4000)])
    assert np.mean(found > 0) == pytest.approx(0.5, abs=4 * 0.5 / sqrt(4000))
    assert np.abs(found).mean() == pytest.approx(5.0, abs=4 * 0.5 / sqrt(4000))
    assert np.abs(found).std() == pytest.approx(0.5, rel=4 / sqrt(2 * 4000))
    assert len(set(samples(noise, 100))) == 1


def test_a_wandering_bias_follows_its_recursion():
    """The autocorrelation and the variance of b ← φ b + N(0, σ_b √(τ/2 (1 − φ²)))."""
    rate, tau, sigma = 50.0, 0.5, 0.8
    found = samples(Noise(dynamic_bias_stddev=sigma, dynamic_bias_correlation_time=tau), rate=rate)
    settled = found[1000:]
    assert settled.std() == pytest.approx(sigma * sqrt(tau / 2), rel=0.05)
    for lag in (1, 7, 25, 60):
        measured = np.corrcoef(settled[:-lag], settled[lag:])[0, 1]
        assert measured == pytest.approx(exp(-lag / rate / tau), abs=0.04), lag
    innovations = settled[1:] - exp(-1 / rate / tau) * settled[:-1]
    assert np.abs(np.corrcoef([innovations[2:], innovations[1:-1], innovations[:-2]]) - np.eye(3)).max() < 0.02
    assert innovations.std() == pytest.approx(sigma * sqrt(tau / 2 * (1 - exp(-2 / rate / tau))), rel=0.01)


@pytest.mark.parametrize("ticks", [20, 100])
def test_the_allan_deviation_of_a_wandering_bias_is_that_of_the_process(ticks):
    """IEEE 952's Gauss-Markov process: σ²(T) = (q τ)²/T [1 − τ/2T (3 − 4 e^(−T/τ) + e^(−2T/τ))]."""
    rate, tau, sigma = 50.0, 1.0, 0.8
    found = samples(Noise(dynamic_bias_stddev=sigma, dynamic_bias_correlation_time=tau), rate=rate)
    T = ticks / rate
    means = found[: MANY // ticks * ticks].reshape(-1, ticks).mean(axis=1)
    measured = sqrt(np.mean(np.diff(means) ** 2) / 2)
    expected = sqrt(sigma**2 * tau**2 / T * (1 - tau / (2 * T) * (3 - 4 * exp(-T / tau) + exp(-2 * T / tau))))
    assert measured == pytest.approx(expected, rel=0.1)


def test_a_wandering_bias_starts_at_its_first_value_and_forgets_it():
    noise = Noise(bias_mean=10.0, dynamic_bias_stddev=1e-6, dynamic_bias_correlation_time=2.0)
    dut = channel(noise)
    first = dut.bias(0.0)
    assert abs(first) == 10.0
    assert dut.bias(2.0) == pytest.approx(first * exp(-1.0), rel=1e-5)


@given(st.lists(st.integers(0, 5000), min_size=1, max_size=30))
@settings(max_examples=25, deadline=None)
def test_a_number_does_not_depend_on_who_asked_before(ticks):
    noise = Noise(stddev=1.0, bias_stddev=1.0, dynamic_bias_stddev=1.0, dynamic_bias_correlation_time=3.0)
    dut = channel(noise)
    for tick in ticks:
        assert dut.apply(1.0, tick / 100.0) == channel(noise).apply(1.0, tick / 100.0)


def test_the_same_seed_repeats_and_another_does_not():
    noise = Noise(stddev=1.0)
    assert samples(noise, 50).tolist() == samples(noise, 50).tolist()
    assert set(samples(noise, 50)).isdisjoint(samples(noise, 50, seed=1))


def test_a_step_of_another_length_changes_no_number_of_a_sensor_with_a_rate():
    noise = Noise(stddev=1.0, dynamic_bias_stddev=1.0, dynamic_bias_correlation_time=1.0)
    found = [channel(noise, time_step=step).apply(0.0, 0.37) for step in (1e-3, 1e-2)]
    assert found[0] == found[1]


def test_a_sensor_without_a_rate_has_a_number_for_each_step():
    dut = channel(Noise(stddev=1.0), rate=0.0, time_step=2e-3)
    found = [dut.apply(0.0, step * 2e-3) for step in range(1000)]
    assert len(set(found)) == 1000


def test_the_precision_rounds_the_sum_half_away_from_zero():
    noise = Noise(precision=0.5)
    dut = channel(noise)
    values = (0.24, 0.25, -0.25, 0.74, 1.26)
    assert [dut.apply(value, 0.0) for value in values] == [0.0, 0.5, -0.5, 0.5, 1.5]
    assert set(np.mod(samples(Noise(stddev=3.0, precision=0.5), 1000), 0.5)) == {0.0}


def test_each_element_of_an_array_has_noise_of_its_own_and_one_bias():
    found = channel(Noise(mean=1.0, stddev=0.1, bias_mean=100.0)).apply(np.zeros((100, 10)), 0.5)
    assert len(np.unique(found)) == 1000
    assert np.abs(np.abs(found.mean()) - 100.0) < 1.1
    assert found.std() == pytest.approx(0.1, rel=0.1)


def test_noise_can_be_left_out():
    assert samples(Noise(stddev=1.0, bias_mean=1.0), 10, factor=0.0).tolist() == [0.0] * 10


def test_both_forms_of_the_element_are_read():
    inside = "<mean>1</mean><stddev>2</stddev><bias_mean>3</bias_mean><bias_stddev>4</bias_stddev>"
    inside += "<dynamic_bias_stddev>5</dynamic_bias_stddev><precision>0.5</precision>"
    inside += "<dynamic_bias_correlation_time>6</dynamic_bias_correlation_time>"
    expected = Noise(1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 0.5)
    assert read(f'<sensor name="s"><noise type="gaussian">{inside}</noise></sensor>') == expected
    assert read(f'<sensor name="s"><noise><type>gaussian_quantized</type>{inside}</noise></sensor>') == expected
    assert read(f'<sensor name="s"><noise type="none">{inside}</noise></sensor>') == SILENT
    assert read('<sensor name="s"/>') == SILENT


@pytest.mark.parametrize(
    ("text", "what"),
    [
        ('<noise type="gaussian"><stddev>nan</stddev></noise>', "stddev is 'nan', which is not finite"),
        ('<noise type="gaussian"><mean>much</mean></noise>', "mean is 'much', which is not a number"),
        ('<noise type="gaussian"><stddev>-1</stddev></noise>', "stddev is '-1', but it must be at least 0"),
        ('<noise type="pink"/>', "unknown noise type 'pink'. Valid: none, gaussian, gaussian_quantized"),
    ],
)
def test_a_wrong_value_is_refused_with_file_line_and_choices(text, what):
    with pytest.raises(InputError, match=what.replace(".", r"\.")) as raised:
        read(f'<sensor name="s">{text}</sensor>')
    assert str(raised.value.file) == "f"
    assert raised.value.line in (2, 3)


@given(st.sampled_from(["type", "mean", "stddev", "precision", "bias_mean"]), st.text(max_size=12))
def test_any_text_is_read_or_refused_in_a_paragraph(tag, text):
    root = etree.Element("sensor", name="s")
    noise = etree.SubElement(root, "noise")
    etree.SubElement(noise, "type").text = "gaussian"
    try:
        etree.SubElement(noise, tag).text = text
    except ValueError:  # characters that XML cannot have
        return
    with contextlib.suppress(InputError):
        read(etree.tostring(root, encoding="unicode"))
