"""gz-sim's SpacecraftThrusterModel (gz-sim-spacecraft-thruster-model-system): impulses beside mechanics."""

import numpy as np
import pytest
from repeated_runs import goes_on_to_the_same_bits
from waters import box, twin_of

from drake_twin.controllers.spacecraft_thruster import SpacecraftThrusterParameters
from drake_twin.description.parameters import ParameterError
from drake_twin.errors import CommandError, InputError
from drake_twin.findings import Kind

STEPS = (0.001, 0.01)
MASS, THRUST = 4.0, 3.0
TOPIC = "/craft/command/duty"


@pytest.fixture(params=STEPS, ids="{:g} s".format)
def step(request):
    return request.param


def thruster(link="hull", **values):
    given = {
        "link_name": link,
        "actuator_number": 0,
        "duty_cycle_frequency": 10,
        "max_thrust": THRUST,
        "topic": "craft",
        "sub_topic": "command/duty",
        **values,
    }
    elements = "".join(f"<{tag}>{value}</{tag}>" for tag, value in given.items() if value is not None)
    name = "gz::sim::systems::SpacecraftThrusterModel"
    return f'\n<plugin filename="gz-sim-spacecraft-thruster-model-system" name="{name}">{elements}</plugin>'


def craft(folder, step=0.001, more=None, rpy=(0, 0, 0), **values):
    """A twin of a box in free space, whose center of mass is 0.2 m below its middle."""
    text = box("craft", (1, 1, 1), mass=MASS, low=0.2, more=more or thruster(**values))
    return twin_of(folder, "<gravity>0 0 0</gravity>", step, {"craft": (text, (0, 0, 0), rpy)})


def push(twin, *parts):
    twin.publish(TOPIC, {"normalized": list(parts)})


def velocity(twin):
    return np.array(twin.entities.state("craft").linear)


@pytest.mark.parametrize("part", [1.0, 0.5, 0.25, 0.037])
def test_the_impulse_is_the_part_of_the_cycles(tmp_path, step, part):
    twin = craft(tmp_path, step)
    push(twin, part)
    twin.advance_to(1.0)
    assert velocity(twin) == pytest.approx((0, 0, THRUST * part / MASS), rel=1e-3, abs=1e-9)


def test_it_is_on_at_the_begin_of_each_cycle_that_counts_from_the_first_command(tmp_path, step):
    twin = craft(tmp_path, step)
    twin.advance_to(0.23)
    push(twin, 0.3)
    found = []
    for time in (0.24, 0.26, 0.33, 0.34):  # in the first cycle, at its end of thrust, at its end, in the next one
        twin.advance_to(time)
        found.append(velocity(twin)[2] * MASS / THRUST)
    assert found == pytest.approx([0.01, 0.03, 0.03, 0.04])


def test_another_part_does_not_begin_the_cycle_again(tmp_path):
    twin = craft(tmp_path)
    push(twin, 0.2)
    twin.advance_to(0.05)
    push(twin, 0.8)
    twin.advance_to(0.1)
    assert velocity(twin)[2] * MASS / THRUST == pytest.approx(0.02 + 0.03)


@pytest.mark.parametrize(("asked", "part"), [(1.7, 1.0), (-0.5, 0.0)])
def test_more_than_all_and_less_than_nothing_cannot_be_on(tmp_path, asked, part):
    twin = craft(tmp_path)
    push(twin, asked)
    twin.advance_to(0.2)
    assert velocity(twin)[2] == pytest.approx(THRUST * part / MASS * 0.2)


def test_the_thrust_is_along_the_z_axis_at_the_center_of_mass(tmp_path, step):
    """The middle of the link, 0.2 m beside that, does not turn about it."""
    twin = craft(tmp_path, step, rpy=(np.pi / 2, 0, 0))
    push(twin, 1.0)
    twin.advance_to(1.0)
    assert velocity(twin) == pytest.approx((0, -THRUST / MASS, 0), rel=1e-3, abs=1e-9)
    assert twin.entities.state("craft").angular == pytest.approx((0, 0, 0), abs=1e-9)


def test_a_center_of_mass_off_the_axis_does_not_turn_it_either(tmp_path):
    text = box("craft", (1, 1, 1), mass=MASS, more=thruster())
    text = text.replace("<inertial><pose>0 0 -0.0 0 0 0</pose>", "<inertial><pose>0.3 0 0 0 0 0</pose>")
    assert "0.3 0 0" in text
    twin = twin_of(tmp_path, "<gravity>0 0 0</gravity>", 0.001, {"craft": (text, (0, 0, 0))})
    push(twin, 1.0)
    twin.advance_to(0.5)
    assert twin.entities.state("craft").angular == pytest.approx((0, 0, 0), abs=1e-9)
    assert velocity(twin)[2] == pytest.approx(THRUST / MASS / 2)


def test_each_thruster_has_its_number_of_one_message(tmp_path):
    more = thruster() + thruster(actuator_number=2, max_thrust=2 * THRUST)
    twin = craft(tmp_path, more=more)
    push(twin, 0.5, 1.0, 0.25)
    twin.advance_to(1.0)
    assert velocity(twin)[2] == pytest.approx(THRUST * (0.5 + 2 * 0.25) / MASS, rel=1e-3)


@pytest.mark.parametrize(
    ("values", "topic"),
    [
        ({}, "/craft/command/duty"),
        ({"sub_topic": None, "topic": "go"}, "/craft/go"),
        ({"sub_topic": None, "topic": None}, "/craft/duty_cycle"),
    ],
)
def test_topics(tmp_path, values, topic):
    assert craft(tmp_path, **values).graph.topics()[topic] == "actuator_msgs/msg/Actuators"


def test_it_goes_on_from_a_snapshot_and_is_repeated_to_the_same_bits(tmp_path):
    twin = craft(tmp_path, rpy=(0.1, 0.2, 0.3))
    twin.recorder.begin()
    twin.advance_to(0.123)
    push(twin, 0.33)
    goes_on_to_the_same_bits(twin, tmp_path)


@pytest.mark.parametrize(
    ("parts", "why"),
    [((), "normalized has 0 numbers, and this thruster's is number 0"), ((float("nan"),), "nan is not finite")],
)
def test_a_message_without_its_number_is_refused(tmp_path, parts, why):
    with pytest.raises(CommandError, match=why):
        push(craft(tmp_path), *parts)


@pytest.mark.parametrize(
    ("values", "why"),
    [
        ({"link": ""}, "<link_name> is missing"),
        ({"link": "keel"}, "the robot has no link 'keel'"),
        ({"max_thrust": None}, "<max_thrust> is missing: it pushes nothing"),
    ],
)
def test_what_cannot_work_is_a_finding(tmp_path, values, why):
    twin = craft(tmp_path, more=thruster(**values))
    (finding,) = [item for item in twin.findings if item.kind is Kind.NOT_STARTED]
    assert finding.what.endswith(why)
    assert finding.lines == (4,)


@pytest.mark.parametrize(
    ("values", "why"),
    [
        ({"actuator_number": 1.5}, "<actuator_number> is 1.5, which is not a whole number from 0"),
        ({"duty_cycle_frequency": 0}, "<duty_cycle_frequency> is 0, and has to be above zero"),
        ({"max_thrust": "much"}, "<max_thrust> is 'much', which is not a number"),
    ],
)
def test_a_bad_value_is_refused_with_its_file_and_line(tmp_path, values, why):
    with pytest.raises(InputError) as raised:
        craft(tmp_path, **values)
    assert f"craft.sdf:4: <plugin filename='gz-sim-spacecraft-thruster-model-system'>: {why}" in str(raised.value)


@pytest.mark.parametrize(
    ("values", "why"),
    [({"duty_cycle_frequency": 0.0}, "has to be above zero"), ({"actuator_number": -1}, "which is not an index")],
)
def test_bad_parameters_are_refused(values, why):
    with pytest.raises(ParameterError, match=why):
        SpacecraftThrusterParameters(link_name="hull", **values)
