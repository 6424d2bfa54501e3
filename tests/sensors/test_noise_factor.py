"""The factor on the noise of a robot's sensors, by the spread of many samples."""

from dataclasses import replace

import numpy as np
import pytest
from rig import on_box, twin_with, xyz
from scipy import stats

from drake_twin import Twin
from drake_twin.messages import type_store
from drake_twin.scenario import ScenarioError
from drake_twin.sensors.noise import SILENT, Noise, NoiseSource
from drake_twin.sweeps.variation import with_value

STDDEV, MEAN = 0.05, 0.4
NOISE = f'<noise type="gaussian"><mean>{MEAN}</mean><stddev>{STDDEV}</stddev></noise>'
AXES = "".join(f"<{axis}>{NOISE}</{axis}>" for axis in "xyz")
SCAN = "<scan><horizontal><samples>8</samples><min_angle>-1</min_angle><max_angle>1</max_angle></horizontal></scan>"
RANGE = "<range><min>0.1</min><max>9</max></range>"
WALL = """<model name="wall"><static>true</static><link name="l"><visual name="v"><pose>3 0 0 0 0 0</pose>
<geometry><box><size>0.1 15 9</size></box></geometry></visual></link></model>"""
SENSORS = (
    on_box("imu", f"<update_rate>100</update_rate><imu><angular_velocity>{AXES}</angular_velocity></imu>", "i"),
    on_box("gpu_lidar", f"<update_rate>100</update_rate><lidar>{SCAN}{RANGE}{NOISE}</lidar>", "l"),
)
SECONDS = 1.2


@pytest.fixture
def scenario(tmp_path):
    return twin_with(tmp_path, *SENSORS, world=WALL).scenario


def measured(scenario):
    """The numbers of each message: angular velocities (rad/s), ranges (m); and how the box turned then (rad/s)."""
    twin = Twin(scenario)
    imu, lidar = (next(topic for topic in twin.graph.topics() if f"/box/{name}/" in topic) for name in "il")
    rates, ranges, turning = [], [], []

    def listen(message):
        rates.append(xyz(message.angular_velocity))
        turning.append(twin.entities.state("box").angular)

    twin.subscribe(imu, listen)
    twin.subscribe(lidar, lambda message: ranges.append(message.ranges))
    twin.advance_to(SECONDS)
    return np.array(rates), np.array(ranges, dtype=float), np.array(turning)


@pytest.mark.parametrize("factor", [0.25, 1.0, 3.0])
def test_the_spread_of_many_samples_is_the_factor_times_that_of_the_file(scenario, factor):
    *noisy, _ = measured(with_value(scenario, "box.noise", factor))
    *ideal, _ = measured(with_value(scenario, "box.noise", 0.0))
    for values, exact in zip(noisy, ideal, strict=True):
        errors = (values - exact).ravel()
        assert errors.size >= 360
        least, most = stats.chi2.ppf([1e-4, 1 - 1e-4], errors.size - 1) / (errors.size - 1)
        assert least < errors.var(ddof=1) / (factor * STDDEV) ** 2 < most
        assert errors.mean() == pytest.approx(factor * MEAN, abs=4 * factor * STDDEV / np.sqrt(errors.size))


def test_without_noise_the_values_are_ideal(scenario):
    rates, ranges, turning = measured(with_value(scenario, "box.noise", 0.0))
    assert np.abs(rates - turning).max() < 1e-9
    angles = np.linspace(-1.0, 1.0, 8)
    assert ranges == pytest.approx(np.tile(2.95 / np.cos(angles), (len(ranges), 1)), abs=1e-5)
    other = measured(replace(scenario, sensor_noise=False))
    assert np.array_equal(rates, other[0])
    assert np.array_equal(ranges, other[1])


def test_a_bias_and_its_wandering_have_the_factor_too():
    noise = Noise(bias_mean=2.0, bias_stddev=0.3, dynamic_bias_stddev=0.5, dynamic_bias_correlation_time=1.0)
    found = [NoiseSource(rate=10.0, factor=factor).channel("x", noise) for factor in (1.0, 2.5)]
    one, more = ([channel.apply(0.0, tick / 10) for tick in range(200)] for channel in found)
    assert more == pytest.approx([2.5 * value for value in one], rel=1e-12)
    quantized = replace(noise, precision=0.01)
    assert quantized.scaled(3.0).precision == 0.01
    assert quantized.scaled(0.0) is SILENT
    assert quantized.scaled(1.0) is quantized


def test_the_factor_of_one_robot_is_not_that_of_another(scenario):
    both = replace(scenario, robots=(scenario.robots[0], replace(scenario.robots[0], name="two", xyz=(0, 9, 0.1))))
    twin = Twin(with_value(both, "two.noise", 0.0))
    twin.advance_to(0.1)
    rates = [
        xyz(twin.latest(topic).angular_velocity)
        for topic, kind in sorted(twin.graph.topics().items())
        if kind == "sensor_msgs/msg/Imu"
    ]
    assert [np.abs(rate).max() > 0.1 for rate in rates] == [True, False]


def test_set_on_a_built_twin_is_the_same_to_the_byte_as_built_with_it(scenario):
    varied = with_value(scenario, "box.noise", 2.0)

    def heard(twin):
        imu = next(topic for topic in twin.graph.topics() if "/box/i/" in topic)
        found = []
        twin.subscribe(
            imu, lambda message: found.append(bytes(type_store().serialize_cdr(message, "sensor_msgs/msg/Imu")))
        )
        twin.advance_to(0.3)
        return found, twin.state_sha256()

    twin = Twin(scenario)
    plain, _ = heard(twin)
    twin.reset(varied)
    assert heard(twin) == heard(Twin(varied))
    assert heard(Twin(varied))[0] != plain


@pytest.mark.parametrize(
    ("factor", "message"), [(-1.0, "-1 is below zero"), (float("nan"), "nan is not a finite number")]
)
def test_a_factor_that_cannot_be_is_refused(scenario, factor, message):
    with pytest.raises(ScenarioError, match=message):
        with_value(scenario, "box.noise", factor)
