"""gz-sim's BuoyancyEngine (gz-sim-buoyancy-engine-system): its volume, and what that lifts, beside mechanics."""

import pytest
from repeated_runs import goes_on_to_the_same_bits
from waters import WATER, G, box, twin_of

from drake_twin.controllers.buoyancy_engine import BuoyancyEngineParameters
from drake_twin.description.parameters import ParameterError
from drake_twin.errors import CommandError, InputError
from drake_twin.findings import Kind

STEPS = (0.001, 0.01)
MASS = 5.0
START, NEUTRAL, RATE = 2e-3, 1e-3, 4e-4  # m³, m³, m³/s
VALUES = {
    "min_volume": 0.0,
    "max_volume": 3e-3,
    "default_volume": START,
    "neutral_volume": NEUTRAL,
    "max_inflation_rate": RATE,
    "namespace": "glider",
}
TOPIC = "/glider/buoyancy_engine"


@pytest.fixture(params=STEPS, ids="{:g} s".format)
def step(request):
    return request.param


def engine(link="hull", **values):
    given = {**({"link_name": link} if link else {}), **VALUES, **values}
    elements = "".join(f"<{tag}>{value}</{tag}>" for tag, value in given.items() if value is not None)
    name = "gz::sim::systems::BuoyancyEngine"
    return f'\n<plugin filename="gz-sim-buoyancy-engine-system" name="{name}">{elements}</plugin>'


def glider(folder, step=0.001, rpy=(0.4, 0.5, 0.6), **values):
    """A twin of a box that falls, turned so that its axes are not those of the world."""
    text = box("glider", (1, 1, 1), mass=MASS, more=engine(**values))
    return twin_of(folder, "", step, {"glider": (text, (0, 0, -5), rpy)})


def lifted(volume, density=WATER):
    """The acceleration (m/s²) that a volume causes."""
    return density * G * (volume - NEUTRAL) / MASS


def speed(twin):
    return twin.entities.state("glider").linear


def volume(twin):
    return twin.latest(f"{TOPIC}/current_volume").data


def test_a_volume_lifts_against_gravity_at_the_origin_of_the_link(tmp_path, step):
    twin = glider(tmp_path, step, fluid_density=800)
    twin.advance_to(1.0)
    assert speed(twin) == pytest.approx((0, 0, lifted(START, 800) - G), rel=0.01, abs=1e-9)
    assert twin.entities.state("glider").angular == pytest.approx((0, 0, 0), abs=1e-9)


@pytest.mark.parametrize(("target", "sign"), [(3e-3, 1), (5e-4, -1)])
def test_the_volume_changes_at_its_rate(tmp_path, step, target, sign):
    """The lift is linear in time, and its integral is that of the volume: V₀ t ± r t² / 2."""
    twin = glider(tmp_path, step)
    twin.publish(TOPIC, {"data": target})
    twin.advance_to(1.0)
    assert volume(twin) == pytest.approx(START + sign * RATE)
    mean = START + sign * RATE / 2
    assert speed(twin)[2] == pytest.approx(lifted(mean) - G, rel=0.01)


def test_it_ends_at_the_target_and_may_turn_back(tmp_path):
    twin = glider(tmp_path)
    twin.publish(TOPIC, {"data": START + RATE / 2})
    twin.advance_to(1.0)
    assert volume(twin) == pytest.approx(START + RATE / 2)
    twin.publish(TOPIC, {"data": 0.0})
    twin.advance_to(2.0)
    twin.publish(TOPIC, {"data": 3e-3})
    twin.advance_to(2.5)
    assert volume(twin) == pytest.approx(START + RATE / 2 - RATE + RATE / 2)


@pytest.mark.parametrize(("asked", "most"), [(1.0, 3e-3), (-1.0, 1e-3)])
def test_a_volume_is_within_its_range(tmp_path, asked, most):
    twin = glider(tmp_path, 0.01, min_volume=1e-3, max_inflation_rate=1.0)
    twin.publish(TOPIC, {"data": asked})
    twin.advance_to(0.2)
    assert volume(twin) == pytest.approx(most)


def test_above_the_surface_only_its_weight_is_left(tmp_path, step):
    twin = glider(tmp_path, step, surface=-6)
    twin.advance_to(0.4)
    assert speed(twin)[2] == pytest.approx(0.4 * (lifted(0.0) - G), rel=0.01)


def test_without_a_volume_of_the_start_it_approaches_that_of_gz_sim(tmp_path):
    twin = glider(tmp_path, 0.01, default_volume=None, max_inflation_rate=1e-5)
    twin.advance_to(1.0)
    assert volume(twin) == pytest.approx(1e-5)
    twin.advance_to(4.0)
    assert volume(twin) == pytest.approx(3e-5)


def test_without_a_namespace_its_topics_are_those_of_all(tmp_path):
    topics = glider(tmp_path, namespace=None).graph.topics()
    assert {"/buoyancy_engine", "/buoyancy_engine/current_volume"} <= topics.keys()


def test_it_goes_on_from_a_snapshot_and_is_repeated_to_the_same_bits(tmp_path):
    twin = glider(tmp_path)
    twin.recorder.begin()
    twin.advance_to(0.3)
    twin.publish(TOPIC, {"data": 3e-3})
    goes_on_to_the_same_bits(twin, tmp_path)
    twin.reset()
    assert volume(twin) == START


def test_a_volume_that_is_not_finite_is_refused(tmp_path):
    with pytest.raises(CommandError, match="inf is not finite"):
        glider(tmp_path).publish(TOPIC, {"data": float("inf")})


@pytest.mark.parametrize(("link", "why"), [("", "<link_name> is missing"), ("keel", "the robot has no link 'keel'")])
def test_what_cannot_work_is_a_finding(tmp_path, link, why):
    text = box("glider", (1, 1, 1), mass=MASS, more=engine(link))
    twin = twin_of(tmp_path, "", robots={"glider": (text, (0, 0, 0))})
    (finding,) = [item for item in twin.findings if item.kind is Kind.NOT_STARTED]
    assert finding.what.endswith(why)
    assert finding.lines == (4,)


@pytest.mark.parametrize(
    ("values", "why"),
    [
        ({"fluid_density": -1}, "<fluid_density> is -1, and has to be zero or more"),
        ({"max_inflation_rate": -1}, "<max_inflation_rate> is -1, and has to be zero or more"),
        ({"max_volume": -1}, "<max_volume> is less than <min_volume>"),
        ({"surface": "up"}, "<surface> is 'up', which is not a number"),
    ],
)
def test_a_bad_value_is_refused_with_its_file_and_line(tmp_path, values, why):
    with pytest.raises(InputError) as raised:
        glider(tmp_path, **values)
    assert f"glider.sdf:4: <plugin filename='gz-sim-buoyancy-engine-system'>: {why}" in str(raised.value)


def test_a_range_that_is_none_is_refused():
    with pytest.raises(ParameterError, match="max_volume is less than min_volume"):
        BuoyancyEngineParameters(link_name="hull", min_volume=1.0, max_volume=0.5)
