"""gz-sim's WindEffects on its own: the wrenches of its system, its field of factors, and what a file may say."""

from math import inf

import numpy as np
import pytest
from sdf_worlds import findings, refusal, world_of
from winds import blown, body, effects, gaussian, sinusoid

from drake_twin.control.scalar_field import ScalarField
from drake_twin.control.wind import WindState
from drake_twin.description.plugins.wind import FieldPiece, Interval, SwingParameters, WindEffectsParameters
from drake_twin.systems.wind import Wind

MASS = 2.0
NONE = (0.0, 0.0, 0.0, 0.0)


@pytest.fixture
def system(tmp_path):
    """The system of forces of a world with one box whose center of mass is 0.1 m low, in steps of 10 ms."""
    twin = blown(tmp_path, effects(1.0) + body("b", low=0.1), 0.01)
    found = twin.diagram.GetSubsystemByName("forces/on_links")
    context = found.CreateDefaultContext()
    found.GetInputPort("pushes").FixValue(context, [])
    return found, context


def wrench(system, wind, linear=(0.0, 0.0, 0.0), turn=(1.0, 0.0, 0.0, 0.0), blows=1.0):
    """On the box about its origin, in its own axes."""
    dut, context = system
    dut.GetInputPort("state").FixValue(context, [*turn, 0, 0, 0, 0, 0, 0, *linear])
    dut.GetInputPort("wind").FixValue(context, wind)
    dut.GetInputPort("signals").FixValue(context, [blows])
    return dut.GetOutputPort("wrenches").Eval(context)


def test_the_force_is_that_of_the_way_relative_to_the_wind_at_the_center_of_mass(system):
    """Over a step of h = 10 ms its mean is (1 + h/2) / (1 + h + h²/2) of that at the start."""
    force = MASS * np.array([3.0, -2.0, 1.0]) * 1.005 / 1.01005
    found = wrench(system, (4.0, -3.0, 1.0), linear=(1.0, -1.0, 0.0))
    assert found == pytest.approx([*np.cross([0, 0, -0.1], force), *force])


def test_the_force_on_a_turned_body_is_along_the_wind(system):
    half = np.sqrt(0.5)
    found = wrench(system, (4.0, 0.0, 0.0), turn=(half, 0.0, 0.0, half))  # x of the box is y of the world
    assert found[3:] == pytest.approx([0.0, -4 * MASS * 1.005 / 1.01005, 0.0])


def test_a_wind_that_does_not_blow_exerts_none(system):
    assert not wrench(system, (4.0, 0.0, 0.0), blows=0.0).any()


def test_a_world_in_which_nothing_feels_wind_has_no_such_system(tmp_path):
    twin = blown(tmp_path, effects(1.0) + body("b", of_model=""))
    assert not twin.diagram.HasSubsystemNamed("forces/on_links")


def test_the_system_of_the_wind_outputs_what_it_was_told(tmp_path):
    dut = blown(tmp_path, effects(1.0, rise=1.0), 0.01).diagram.GetSubsystemByName("world/wind")
    assert isinstance(dut, Wind)
    context = dut.CreateDefaultContext()
    assert dut.state(context) == WindState(0.0, (4.0, 0.0, 0.0), 0.0, 0.0, 0.0)
    context.SetTime(0.495)  # the middle of the step is at 0.5 s
    assert dut.get_velocity_output_port().Eval(context) == pytest.approx([4 * (1 - np.exp(-0.5)), 0, 0])
    assert dut.get_wind_info_output_port().Eval(context).x == pytest.approx(4 * (1 - np.exp(-0.495)))


def test_a_wind_that_is_told_to_hold_does_not_swing_either(tmp_path):
    wind = effects(1.0, swing=sinusoid("amplitude_percent", 0.5, 2.0), noise=gaussian(0.5))
    dut = blown(tmp_path, wind, 0.01).diagram.GetSubsystemByName("world/wind")
    context = dut.CreateDefaultContext()
    context.SetTime(0.5)
    dut.tell(context, (0.0, 1.0, 0.0), blows=False)
    held = dut.present(context)
    assert held[0] == pytest.approx(6, abs=2.5)
    context.SetTime(1.5)
    assert dut.get_blows_output_port().Eval(context) == [0.0]
    assert dut.present(context) == held
    dut.tell(context, None, blows=True)
    context.SetTime(2.0)
    assert dut.present(context) == pytest.approx((0, 1, 0), abs=2.5)


def test_the_parameters_are_those_of_the_file(tmp_path):
    """With SDF's spelling of noise; the first of two elements counts."""
    more = """<horizontal><magnitude><time_for_rise>10</time_for_rise><sin><amplitude_percent>0.05</amplitude_percent>
<period>60</period></sin><noise type="gaussian"><mean>0.1</mean><stddev>0.2</stddev></noise></magnitude><direction><sin>
<amplitude>5</amplitude><period>20</period></sin><noise type="none"><stddev>3</stddev></noise></direction></horizontal>
<vertical><time_for_rise>3</time_for_rise><noise type="gaussian_quantized"><precision>0.5</precision></noise>
</vertical>"""
    world = world_of(tmp_path, f'<plugin filename="gz-sim-wind-effects-system" name="w">{more}<gust>1</gust></plugin>')
    constant = FieldPiece(1.0, ((0.0, 0.0, 0.0, 1.0), NONE, NONE))
    assert world.wind_effects == WindEffectsParameters(
        SwingParameters(10.0, 0.05, 60.0, {"mean": 0.1, "stddev": 0.2}),
        SwingParameters(1.0, 5.0, 20.0),
        SwingParameters(3.0, noise={"precision": 0.5}),
        (constant,),
    )
    assert world.forces == world.plugins
    assert findings(world) == ("<gust> of Gazebo plugin w",)


PIECES = """<when zlt="0">0</when><when zge="0" zle="2"><k>2</k><px>0 2 0 1</px><qy>0 1 0 1</qy><rz>0 0 0 1</rz></when>
<when zgt="2" xgt="1">7</when><when zge="0" xgt="1" ygt="5">9</when>"""


def test_the_factor_of_a_place_is_that_of_the_piece_that_has_it(tmp_path):
    parameters = world_of(tmp_path, effects(PIECES)).wind_effects
    low, middle, *_ = parameters.scaling
    assert low == FieldPiece(0.0, ((0.0, 0.0, 0.0, 1.0), NONE, NONE), (Interval(), Interval(), Interval(-inf, 0.0)))
    assert middle.region[2] == Interval(0.0, 2.0, has_low=True, has_high=True)
    field = ScalarField(parameters.scaling)
    assert field.constant is None
    points = np.array([[2, 0, -1], [2, 3, 0], [1, 1, 2], [2, 0, 2.1], [1, 0, 3], [2, 6, 3]])
    assert field.at(points) == pytest.approx([0, 2 * (9 + 10 + 1), 2 * (3 + 2 + 1), 7, 0, 7])


def test_a_number_is_the_factor_everywhere(tmp_path):
    assert ScalarField(world_of(tmp_path, effects(0.3)).wind_effects.scaling).constant == pytest.approx(0.3)
    everywhere = world_of(tmp_path, effects("<k>2</k><px>0 0 0 1</px><rz>0 0 0 3</rz>")).wind_effects
    assert ScalarField(everywhere.scaling).constant == pytest.approx(8.0)


@pytest.mark.parametrize(
    ("field", "least"),
    [
        ("<px>0 1 -2 0</px>", -1.0),  # at x = 1
        ('<when xgt="2"><px>0 1 -2 0</px></when>', 0.0),
        ('<when xge="-1" xle="3"><px>1 -3 0 0</px></when>', -4.0),  # at both x = -1 and x = 2
        ("<k>-1</k><qy>0 -1 0 2</qy>", -2.0),
        ("<qy>1 0 0 0</qy>", -inf),
        ('<when yge="0"><qy>1 0 0 5</qy></when>', 5.0),
        ("<rz>0 0 0 0</rz>", 0.0),
    ],
)
def test_the_least_value_of_a_field(tmp_path, field, least):
    if least >= 0.0:
        assert world_of(tmp_path, effects(field)).wind_effects.scaling[0].least == pytest.approx(least)
    else:
        assert "<force_approximation_scaling_factor> has values below zero" in refusal(
            world_of, tmp_path, effects(field)
        )


def inside(text):
    return f'<plugin filename="gz-sim-wind-effects-system" name="w">{text}</plugin>'


@pytest.mark.parametrize(
    ("text", "says"),
    [
        (effects(rise=0), "<horizontal/magnitude/time_for_rise> is 0, and has to be above zero"),
        (effects(turn=-1), "<horizontal/direction/time_for_rise> is -1, and has to be above zero"),
        (effects(climb="soon"), "<vertical/time_for_rise> is 'soon', which is not a number"),
        (effects(swing="<sin><period>0</period></sin>"), "<horizontal/magnitude/sin/period> is 0, and has to be above"),
        (effects(noise=gaussian(-1)), "<horizontal/magnitude/noise/stddev> is -1, and has to be zero or more"),
        (
            effects(turn_noise='<noise type="loud"/>'),
            "<horizontal/direction/noise> has the type 'loud', not one of none",
        ),
        (effects(-1), "<force_approximation_scaling_factor> has values below zero, and has to be zero or more"),
        (effects("much"), "of <force_approximation_scaling_factor> is 'much', which is not a number"),
        (effects("<px>1 2</px>"), "<px> is '1 2', which is not four numbers, the coefficient of the cube first"),
        (effects('<when xgt="0" xge="0">1</when>'), "<when> has both xge and xgt"),
        (effects('<when xgt="1" xlt="0">1</when>'), "<when> has no x: it has to be above 1 and below 0"),
        (
            effects('<when ylt="inf">1</when>'),
            "ylt of <force_approximation_scaling_factor> is 'inf', which is not finite",
        ),
    ],
)
def test_values_that_are_refused_with_file_and_line(tmp_path, text, says):
    said = refusal(world_of, tmp_path, f"\n{text}")
    assert said.startswith(f"{tmp_path / 'test.world'}:5: ")
    assert says in said
