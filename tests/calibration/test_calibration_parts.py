"""The parts of a calibration without a twin: ranges, noise, shared errors, the search and its certainty."""

import numpy as np
import pytest
from formulas import TIMES, evaluations

from drake_twin.calibration.certainty import certainty
from drake_twin.calibration.fitted import Fitted
from drake_twin.calibration.log import Log, LoggedCommand, Measured
from drake_twin.calibration.measured import NUMBERS
from drake_twin.calibration.noise import noises
from drake_twin.calibration.residuals import Comparison, independent
from drake_twin.calibration.search import search
from drake_twin.messages.interface_types import make


def test_a_range_above_zero_is_searched_by_factors():
    fitted = Fitted.parse("friction = 0.1:10")
    assert fitted == Fitted("friction", 0.1, 10.0)
    assert fitted.at(0.5) == pytest.approx(1.0)
    assert fitted.share(1.0) == pytest.approx(0.5)
    assert fitted.share(100.0) == 1.0
    assert fitted.error(0.5, 0.01) == pytest.approx((fitted.at(0.505) - fitted.at(0.495)), rel=1e-3)
    linear = Fitted("robot_1.x", -1.0, 3.0)
    assert [linear.at(0.25), linear.share(1.0), linear.error(0.5, 0.01)] == pytest.approx([0.0, 0.5, 0.04])


def test_noise_is_estimated_from_what_is_not_smooth():
    generator = np.random.default_rng(0)
    times = np.sort(np.concatenate([np.arange(0, 20, 0.02), np.arange(25, 40, 0.02)]))  # a gap of 5 s
    jumps = np.where(times > 12, 1.0, 0.0)
    series = {
        f"j{i}.velocity": (times, np.sin(3 * times) + jumps + generator.normal(0, 5e-3, len(times))) for i in (1, 2)
    }
    series["j1.position"] = times, np.zeros(len(times))
    found = noises(Measured("/j", "/j", series), {})
    assert found["j1.velocity"] == found["j2.velocity"] == pytest.approx(5e-3, rel=0.05)
    assert found["j1.position"] == 0.0
    assert noises(Measured("/j", "/j", series), {"velocity": 1.0, "j2.velocity": 2.0}) == {
        "j1.velocity": 1.0,
        "j2.velocity": 2.0,
        "j1.position": 0.0,
    }


def test_noise_is_estimated_without_what_the_twin_moves_like():
    generator = np.random.default_rng(0)
    steps = np.cumsum(generator.normal(0, 1, len(TIMES)) * (np.arange(len(TIMES)) % 3 == 0))
    measured = Measured("/j", "/j", {"j.velocity": (TIMES, steps + generator.normal(0, 0.01, len(TIMES)))})
    assert noises(measured, {})["j.velocity"] > 0.1
    smooth = 0.05 * np.sin(TIMES)  # an error of the model, which does not count as noise
    assert noises(measured, {}, {"j.velocity": steps + smooth})["j.velocity"] == pytest.approx(0.01, rel=0.3)


def test_residuals_are_independent_without_the_errors_that_they_share():
    """Against the inverse root of their covariance, by SciPy."""
    from scipy.linalg import inv, sqrtm

    generator = np.random.default_rng(0)
    shared, residuals = generator.normal(size=(7, 2)), generator.normal(size=7)
    expected = inv(sqrtm(np.eye(7) + shared @ shared.T)) @ residuals
    assert independent(residuals, shared) == pytest.approx(expected, abs=1e-12)
    assert independent(residuals, np.zeros((7, 0))) is residuals


def test_errors_are_those_of_linear_least_squares():
    def line(times, offset, slope):
        return offset + slope * times

    fitted = (Fitted("a", -1.0, 1.0), Fitted("b", -1.0, 1.0))
    own = evaluations(line, (0.2, -0.4), fitted)
    found = certainty(own, search(own, "auto", None))
    design = np.stack([np.ones(len(TIMES)), TIMES]).T / 0.01
    covariance = np.linalg.inv(design.T @ design)
    errors = [
        item.error(share, error) for item, share, error in zip(fitted, found.best.point, found.errors, strict=True)
    ]
    assert errors == pytest.approx(np.sqrt(np.diag(covariance)), rel=0.3)  # χ²/dof is a part of them
    assert found.correlation[0, 1] == pytest.approx(covariance[0, 1] / np.sqrt(np.prod(np.diag(covariance))), abs=0.01)
    values = own.values(found.best.point)
    assert abs(values["a"] - 0.2) < 4 * errors[0]
    assert abs(values["b"] + 0.4) < 4 * errors[1]
    assert not found.unknown.any()


def test_a_value_without_an_effect_is_unknown():
    own = evaluations(
        lambda times, slope, idle: slope * times, (0.3, 0.5), (Fitted("a", -1.0, 1.0), Fitted("b", 0.0, 1.0))
    )
    found = certainty(own, search(own, "auto", None))
    assert found.unknown.tolist() == [False, True]
    assert found.errors[0] < 0.01
    assert found.errors[1] == pytest.approx(12**-0.5, rel=0.05)  # of a value of which only the range is known


def test_two_places_that_fit_equally_well_are_found():
    def bump(times, width):
        return np.sin(3 * times) * (np.cos(2 * np.pi * width) + 0.1)

    own = evaluations(bump, (0.2,), (Fitted("width", 0.0, 1.0),))
    ends = search(own, "auto", None)
    found = certainty(own, ends)
    (other,) = found.others
    assert found.errors[0] < 0.01
    assert sorted([other.point[0], found.best.point[0]]) == pytest.approx([0.2, 0.8], abs=0.01)


def test_a_cost_that_is_rough_makes_the_errors_larger():
    """Where the simulation changes erratically with the values, derivatives say too little about the errors."""

    def rough(times, slope, height=0.0):
        return slope * times + height * np.sin(3e4 * slope) * np.cos(40 * times)

    errors = []
    for height in (0.0, 0.1):
        own = evaluations(
            lambda times, slope, height=height: rough(times, slope, height), (0.5,), (Fitted("s", 0.1, 1.0),)
        )
        errors.append(certainty(own, search(own, "auto", None)).errors[0])
    assert errors[1] > 3 * errors[0]


def test_a_wrong_valley_is_left():
    """Descents from most points of the range end in wrong valleys, whose χ² is far too large."""

    def wave(times, rate, size):
        return size * np.sin(rate * times)

    fitted = (Fitted("rate", 3.0, 60.0), Fitted("size", 0.1, 10.0))
    own = evaluations(wave, (17.0, 1.3), fitted, most=700)
    found = certainty(own, search(own, "auto", None))
    values = own.values(found.best.point)
    assert values == pytest.approx({"rate": 17.0, "size": 1.3}, rel=0.01)
    assert found.best.cost / own.freedom < 1.5


def test_numbers_of_messages_have_the_same_names_whatever_their_type():
    place = {"position": {"x": 1.0, "y": 2.0, "z": 3.0}, "orientation": {"w": 0.5**0.5, "z": 0.5**0.5}}
    pose = make("geometry_msgs/msg/PoseStamped", {"pose": place})
    moved = {"translation": place["position"], "rotation": place["orientation"]}
    transform = make("geometry_msgs/msg/TransformStamped", {"transform": moved})
    odometry = make("nav_msgs/msg/Odometry", {"pose": {"pose": place}, "twist": {"twist": {"linear": {"x": 0.5}}}})
    expected = {"x": 1.0, "y": 2.0, "z": 3.0, "roll": 0.0, "pitch": 0.0, "yaw": np.pi / 2}
    assert NUMBERS["geometry_msgs/msg/PoseStamped"](pose) == pytest.approx(expected)
    assert NUMBERS["geometry_msgs/msg/TransformStamped"](transform) == pytest.approx(expected)
    found = NUMBERS["nav_msgs/msg/Odometry"](odometry)
    assert {key: found[key] for key in expected} == pytest.approx(expected)
    assert found["linear.x"] == 0.5


def test_poses_are_compared_in_the_frame_of_the_log():
    """A path, and the same in a frame that is turned by 40° and elsewhere: no residual is left."""
    times, turn = np.arange(0, 2, 0.05), np.deg2rad(40)
    x, y, yaw = np.sin(times), times**2, np.cos(times)
    other = {
        "x": np.cos(turn) * x - np.sin(turn) * y + 3,
        "y": np.sin(turn) * x + np.cos(turn) * y - 1,
        "yaw": yaw + turn,
    }
    measured = Measured("/pose", "/pose", {name: (times, values) for name, values in other.items()})
    log = Log("log", (LoggedCommand(0.0, "/c", [1.0]),), (measured,))
    comparison = Comparison([log], {"place": 1e-3, "angle": 1e-3}, [{}], 0.0)
    simulated = [{"/pose": {"x": (times, x), "y": (times, y), "yaw": (times, yaw)}}]
    assert np.abs(comparison.compare(simulated).residuals).max() < 1e-6
    assert comparison.freedoms == 3
    measured.series["yaw"][1][:] += 0.2  # a compass that is off, and known to be poor: the places tell the frame
    comparison = Comparison([log], {"place": 1e-3, "angle": 1.0}, [{}], 0.0)
    residuals = comparison.compare(simulated).residuals
    assert residuals[: 2 * len(times)] == pytest.approx(0.0, abs=1e-3)
    assert residuals[2 * len(times) :] == pytest.approx(0.2, abs=1e-3)
