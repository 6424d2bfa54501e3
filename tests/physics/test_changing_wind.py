"""gz-sim's WindEffects beside mechanics: drifts, terminal speeds, a wind that rises, swings and is told another way."""

from dataclasses import replace
from math import atan2, cos, degrees, exp, pi, sin, sqrt

import numpy as np
import pytest
from flyers import RHO, flyer, plugin
from repeated_runs import goes_on_to_the_same_bits
from winds import GROUND, STEPS, air, blown, body, effects, gaussian, sinusoid, velocity, windy_world

from drake_twin import TwinBuilder
from drake_twin.errors import CommandError, InputError
from drake_twin.messages.interface_types import make
from drake_twin.scenario import Robot, World

G = 9.8


@pytest.fixture(params=STEPS, ids="{:g} s".format)
def step(request):
    return request.param


def wanted(x=0.0, y=0.0, z=0.0):
    return make("geometry_msgs/msg/Vector3", {"x": x, "y": y, "z": z})


@pytest.mark.parametrize("factor", [0.5, 2.0, 100.0, 1e6])
def test_a_free_body_drifts_with_the_wind_whatever_its_factor(tmp_path, step, factor):
    """v = w (1 - exp(-k t)), of 1e6 with steps ten thousand times as long as the time constant."""
    twin = blown(tmp_path, effects(factor) + body("b", "0 0 0 0.3 0.2 0.1", low=0.1), step, wind="4 -3 0")
    for time in (0.1, 0.5, 1.0):
        twin.advance_to(time)
        assert velocity(twin) == pytest.approx(np.array([4, -3, 0]) * (1 - exp(-factor * time)), rel=1e-3, abs=1e-9)
    assert twin.entities.state("b").angular == pytest.approx((0, 0, 0), abs=1e-9)


def test_links_without_enable_wind_feel_none(tmp_path):
    flags = {"a": ("", "true"), "b": ("", ""), "c": ("false", "false"), "d": ("true", "false"), "e": ("1", "")}
    models = (
        body(name, f"{3 * n} 0 0 0 0 0", of_model=f[0], of_link=f[1]) for n, (name, f) in enumerate(flags.items())
    )
    twin = blown(tmp_path, effects(2.0) + "".join(models), 0.01)
    twin.advance_to(0.5)
    blown_away = 4 * (1 - exp(-1.0))
    expected = {"a": blown_away, "b": 0.0, "c": 0.0, "d": blown_away, "e": blown_away}
    assert {name: velocity(twin, name)[0] for name in flags} == pytest.approx(expected, rel=1e-3)


def test_a_robot_is_blown_as_a_model_is(tmp_path, step):
    twin = blown(tmp_path, effects(2.0), step, robots={"b": body("b")})
    twin.advance_to(0.5)
    assert velocity(twin) == pytest.approx((4 * (1 - exp(-1.0)), 0, 0), rel=1e-3)


def test_a_box_slides_at_the_speed_at_which_wind_and_friction_balance(tmp_path, step):
    """k (w - v) = μ g."""
    twin = blown(tmp_path, GROUND + effects(2.0) + body("b", "0 0 0.25 0 0 0"), step, gravity=G)
    twin.advance_to(4.0)
    assert velocity(twin) == pytest.approx((4 - 0.2 * G / 2, 0, 0), rel=0.01, abs=1e-3)


def test_a_wind_from_below_lifts_a_body_that_falls(tmp_path, step):
    twin = blown(tmp_path, effects(2.0) + body("b"), step, wind="0 0 6", gravity=G)
    twin.advance_to(0.7)
    assert velocity(twin) == pytest.approx((0, 0, (6 - G / 2) * (1 - exp(-1.4))), rel=1e-3, abs=1e-9)


def test_the_wind_rises_and_the_body_follows(tmp_path, step):
    """Two filters behind each other: 1/T and k."""
    rise, factor = 0.5, 3.0
    twin = blown(tmp_path, effects(factor, rise, climb=0.25) + body("b"), step, wind="4 -3 2")
    for time in (0.2, 1.0):
        twin.advance_to(time)
        done = {T: 1 - exp(-time / T) for T in (rise, 0.25)}
        assert air(twin) == pytest.approx((4 * done[rise], -3 * done[rise], 2 * done[0.25]))
        response = 1 - (factor * rise * exp(-time / rise) - exp(-factor * time)) / (factor * rise - 1)
        assert velocity(twin)[:2] == pytest.approx(np.array([4, -3]) * response, rel=5e-3)


def test_a_wind_that_swings_drags_a_body_after_it(tmp_path, step):
    """The response of a first-order filter: amplitude k / √(k² + ω²), phase -atan(ω / k)."""
    factor, omega, swing = 3.0, 2 * pi / 0.8, 0.4
    wind = effects(factor, swing=sinusoid("amplitude_percent", swing, 0.8))
    twin = blown(tmp_path, wind + body("b"), step)
    amplitude, phase = swing * factor / sqrt(factor**2 + omega**2), atan2(omega, factor)
    for time in (0.3, 1.0, 1.7):
        twin.advance_to(time)
        past = 1 - exp(-factor * time)
        swung = amplitude * (sin(omega * time - phase) + sin(phase) * exp(-factor * time))
        assert velocity(twin)[0] == pytest.approx(4 * (past + swung), rel=5e-3)
        assert air(twin)[0] == pytest.approx(4 * (1 + swing * sin(omega * time)))


def test_the_direction_swings_by_degrees(tmp_path):
    twin = blown(tmp_path, effects(veer=sinusoid("amplitude", 30, 2.0)), 0.01, wind="0 4 0")
    for time, angle in ((0.5, 120), (1.0, 90), (1.25, 90 - 30 * sin(pi / 4))):
        twin.advance_to(time)
        x, y, z = air(twin)
        assert (degrees(atan2(y, x)), sqrt(x * x + y * y), z) == pytest.approx((angle, 4, 0), abs=1e-9)


def test_a_wing_has_the_drag_of_the_wind_that_rises(tmp_path, step):
    """gz-sim's LiftDrag reads what WindEffects writes."""
    brake = plugin("LiftDrag", {"a0": 0.5, "cla": 0.0, "cda": 0.8, "area": 0.5})
    world = World(file=str(windy_world(tmp_path, effects(1.0, rise=2.0), "-8 0 0")))
    twin = flyer(tmp_path, brake, world=world, time_step=step)
    twin.advance_to(1.5)
    twin.entities.set_state("flyer", linear=(0.0, 0.0, 0.0), angular=(0.0, 0.0, 0.0))
    twin.advance_to(1.5 + step)
    size = 0.5 * RHO * (8 * (1 - exp(-0.75))) ** 2 * 0.5 * 0.8 * 0.5 / 2.0
    assert velocity(twin, "flyer")[0] / step == pytest.approx(-size, rel=0.01)


def test_a_pendulum_hangs_at_the_angle_of_wind_and_weight(tmp_path, step):
    """Its link's origin is at the hinge, which does not move: tan φ = k w / g."""
    arm = """<model name="arm"><link name="base"/><joint name="to_world" type="fixed"><parent>world</parent>
<child>base</child></joint><link name="bob"><enable_wind>true</enable_wind><inertial><pose>0 0 -1 0 0 0</pose>
<mass>2</mass><inertia><ixx>.01</ixx><iyy>.01</iyy><izz>.01</izz></inertia></inertial></link>
<joint name="hinge" type="revolute">
<parent>base</parent><child>bob</child><axis><xyz>0 1 0</xyz><dynamics><damping>6</damping></dynamics></axis></joint>
</model>"""
    twin = blown(tmp_path, effects(2.0), step, gravity=G, robots={"arm": arm})
    twin.advance_to(8.0)
    assert twin.joint_states("arm").position[0] == pytest.approx(-atan2(2.0 * 4.0, G), rel=1e-3)


def test_another_mass_is_blown_with_the_force_of_that_mass(tmp_path):
    twin = blown(tmp_path, effects(2.0), 0.01, robots={"b": body("b")})
    twin.entities.set_values({"b.hull.mass": 7.0})
    twin.advance_to(0.5)
    assert velocity(twin) == pytest.approx((4 * (1 - exp(-1.0)), 0, 0), rel=1e-3)


def test_the_factor_is_that_of_the_place(tmp_path, step):
    """None below z = 0, one that grows with x² above it."""
    field = '<when zge="0"><k>0.5</k><px>0 1 0 0</px><qy>0 0 0 2</qy></when>'
    models = body("low", "3 0 -5 0 0 0") + body("b", "0 3 5 0 0 0") + body("far", "2 0 5 0 0 0")
    twin = blown(tmp_path, effects(field) + models, step, wind="0 0 4")
    twin.advance_to(0.5)
    found = [velocity(twin, name)[2] for name in ("low", "b", "far")]
    assert found == pytest.approx([0, 4 * (1 - exp(-0.5)), 4 * (1 - exp(-0.5 * 6 * 0.5))], rel=1e-3)


def test_a_message_turns_the_wind_and_another_one_holds_it(tmp_path, step):
    twin = blown(tmp_path, effects(2.0, rise=0.5, turn=0.5, climb=0.5) + body("b"), step)
    twin.advance_to(0.5)
    speed = 4 * (1 - exp(-1))
    twin.publish("/world/w/wind", wanted(y=6.0, z=1.0))
    twin.advance_to(1.0)
    speed, angle = 6 + (speed - 6) * exp(-1), 90 * (1 - exp(-1))
    assert air(twin) == pytest.approx((speed * cos(angle * pi / 180), speed * sin(angle * pi / 180), 1 - exp(-1)))
    twin.publish("/world/w/wind/enable", {"data": False})
    held, moving = air(twin), velocity(twin)
    twin.advance_to(1.5)
    assert (air(twin), velocity(twin)) == (held, pytest.approx(moving))
    twin.publish("/world/w/wind/enable", {"data": True})
    assert air(twin) == held
    twin.advance_to(2.0)
    assert air(twin)[2] == pytest.approx(1 - exp(-2))
    assert velocity(twin)[2] > moving[2]


@pytest.mark.parametrize(("topic", "data"), [("wind", {"x": float("nan")}), ("wind", {"speed": 3}), ("wind/enable", 3)])
def test_messages_that_are_refused_change_nothing(tmp_path, topic, data):
    twin = blown(tmp_path, effects(2.0), 0.01)
    twin.advance_to(0.1)
    with pytest.raises(CommandError, match=f"/world/w/{topic}"):
        twin.publish(f"/world/w/{topic}", data)
    assert air(twin) == pytest.approx((4, 0, 0))


def test_the_noise_of_the_wind_is_that_of_the_seed(tmp_path):
    def speeds(seed):
        twin = blown(tmp_path, effects(noise=gaussian(0.5), climb_noise=gaussian(0.2)), 0.01, seed=seed)
        found = []
        for number in range(1, 401):
            twin.advance_to(number * 0.01)
            found.append(air(twin))
        return np.array(found)

    found = speeds(3)
    assert found.mean(axis=0) == pytest.approx((4, 0, 0), abs=0.1)
    assert found.std(axis=0) == pytest.approx((0.5, 0, 0.2), rel=0.15, abs=1e-9)
    assert (found == speeds(3)).all()
    assert (found[:, 0] != speeds(4)[:, 0]).all()


def test_a_run_with_noise_and_a_message_repeats_to_the_same_bits(tmp_path):
    noises = {"noise": gaussian(0.5), "turn_noise": gaussian(3.0), "climb_noise": gaussian(0.2)}
    twin = blown(tmp_path, effects(2.0, rise=0.5, turn=0.5, **noises) + body("b"), 0.01, seed=5)
    twin.recorder.begin()
    twin.advance_to(0.3)
    twin.publish("/world/w/wind", wanted(y=6.0))
    goes_on_to_the_same_bits(twin, tmp_path)
    assert velocity(twin)[1] > 0.1


def test_the_wind_goes_on_while_a_robot_comes_and_after_a_reset_it_rises_again(tmp_path):
    twin = blown(tmp_path, effects(2.0, rise=0.5) + body("b"), 0.01)
    twin.advance_to(0.5)
    twin.publish("/world/w/wind", wanted(x=-6.0))
    twin.advance_to(0.6)
    known = air(twin)
    (tmp_path / "late.sdf").write_text(f'<sdf version="1.9">{body("late")}</sdf>')
    twin.entities.spawn(Robot("late", str(tmp_path / "late.sdf"), xyz=(0.0, 0.0, 9.0)))
    assert air(twin) == known
    twin.reset()
    assert air(twin) == (0, 0, 0)
    twin.advance_to(0.5)
    assert air(twin) == pytest.approx((4 * (1 - exp(-1)), 0, 0))


def test_a_saved_wind_that_is_none_is_refused(tmp_path):
    twin = blown(tmp_path, effects(2.0), 0.01)
    with pytest.raises(InputError, match="the state of the wind is not one"):
        twin.restore(replace(twin.snapshot(), wind={"!": "tuple", "items": []}))


def test_the_engine_with_error_control_has_the_same_wind(tmp_path):
    twin = blown(tmp_path, effects(3.0, rise=0.5) + body("b"), 0.01, engine="cenic")
    twin.advance_to(1.0)
    response = 1 - (1.5 * exp(-2) - exp(-3)) / 0.5
    assert velocity(twin) == pytest.approx((4 * response, 0, 0), rel=0.01, abs=1e-6)


@pytest.mark.parametrize(("name", "valid"), [("my world", "my_world"), ("3rd", "_3rd"), ("", "_")])
def test_the_topics_of_a_world_have_names_that_ros_takes(tmp_path, name, valid):
    file = windy_world(tmp_path, effects(2.0) + body("b"))
    file.write_text(file.read_text().replace('<world name="w">', f'<world name="{name}">'))
    twin = TwinBuilder(world=World(file=str(file))).build()
    topics = [topic for topic in twin.graph.topics() if "wind" in topic]
    assert topics == [f"/world/{valid}/{topic}" for topic in ("wind_info", "wind", "wind/enable")]
