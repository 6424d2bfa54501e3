"""Vehicles on tracks as gz-sim's TrackedVehicle, beside mechanics."""

from math import atan, atan2, cos, sin

import numpy as np
import pytest
from belts import (
    FRICTION,
    HEIGHT,
    STEPS,
    G,
    box,
    moving,
    number,
    stands_still,
    steady_turn,
    tank_twin,
    twist,
)
from repeated_runs import goes_on_to_the_same_bits

from drake_twin.description.surface_velocity import has_surface_velocity
from drake_twin.findings import Kind
from drake_twin.scenario import Robot

BASE = "/tank/cmd_vel"


@pytest.fixture(params=STEPS, ids=str)
def step(request):
    return request.param


def tracks(twin, left, right):
    for side, speed in (("left", left), ("right", right)):
        twin.publish(f"/tank/link/{side}/track_cmd_vel", number(speed))


def velocity(twin):
    return np.array(twin.entities.state("tank").linear)


def height(twin):
    return twin.entities.state("tank").position[2]


def turning(twin):
    return twin.entities.state("tank").angular[2]


@moving
def test_on_a_straight_line_it_is_as_fast_as_its_tracks(tmp_path, step):
    twin = tank_twin(tmp_path, step)
    twin.publish(BASE, twist(0.3, 0.0))
    twin.advance_to(0.3)
    assert velocity(twin) == pytest.approx((0.3, 0, 0), abs=1e-4)
    twin.publish(BASE, twist(-0.2, 0.0))
    twin.advance_to(0.6)
    assert velocity(twin) == pytest.approx((-0.2, 0, 0), abs=1e-4)


@moving
@pytest.mark.parametrize(("left", "right"), [(-0.1, 0.1), (0.0, 0.2), (0.5, 0.2), (-0.3, 0.1)])
def test_it_turns_where_the_friction_of_its_tracks_has_no_moment(tmp_path, step, left, right):
    twin = tank_twin(tmp_path, step)
    tracks(twin, left, right)
    twin.advance_to(0.6)
    speed, rate = steady_turn(left, right)
    assert turning(twin) == pytest.approx(rate, rel=0.01)
    assert np.hypot(*velocity(twin)[:2]) == pytest.approx(speed, rel=0.01, abs=1e-4)


FLOOR = f"""<sdf version="1.9"><world name="w"><model name="floor"><static>1</static><pose>0 0 -0.05 0 0 0</pose>
<link name="l"><collision name="c"><geometry>{box(5, 5, 0.1)}</geometry></collision></link></model></world></sdf>"""


@moving
def test_it_turns_on_a_box_as_on_a_plane(tmp_path, step):
    """Boxes yield to tracks, and planes do not."""
    (tmp_path / "floor.sdf").write_text(FLOOR)
    twin = tank_twin(tmp_path, step, file=str(tmp_path / "floor.sdf"), ground=False)
    tracks(twin, -0.1, 0.1)
    twin.advance_to(0.4)
    assert turning(twin) == pytest.approx(steady_turn(-0.1, 0.1)[1], rel=0.01)
    assert height(twin) == pytest.approx(HEIGHT / 2, abs=1e-4)


@moving
def test_a_turn_is_as_fast_as_the_efficiency_makes_its_tracks(tmp_path):
    """Its tracks run at ±ω b / 2 e, which turn it at the rate of that."""
    own = steady_turn(-0.1, 0.1)[1]
    twin = tank_twin(tmp_path)
    twin.publish("/tank/steering_efficiency", number(own * 0.4 / 0.2))
    twin.publish(BASE, twist(0.0, 0.25))
    twin.advance_to(0.5)
    assert turning(twin) == pytest.approx(0.25, rel=0.01)


@moving
@pytest.mark.parametrize("share", [0.9, 1.2])
def test_it_climbs_slopes_below_the_angle_of_friction_and_slides_down_steeper_ones(tmp_path, step, share):
    angle = share * atan(FRICTION)
    twin = tank_twin(tmp_path, step, gravity=(-G * sin(angle), 0, -G * cos(angle)))
    twin.publish(BASE, twist(0.2, 0.0))
    twin.advance_to(0.3)
    before = velocity(twin)[0]
    twin.advance_to(0.6)
    if share < 1:
        assert velocity(twin) == pytest.approx((0.2, 0, 0), abs=1e-3)
    else:
        assert (velocity(twin)[0] - before) / 0.3 == pytest.approx(G * (FRICTION * cos(angle) - sin(angle)), rel=0.01)
    assert height(twin) == pytest.approx(HEIGHT / 2, abs=1e-4)


@moving
def test_it_climbs_stairs_as_fast_as_its_tracks(tmp_path, step):
    """It lies on the edges of stairs that are less steep than the angle of friction, which do not brake it."""
    rise, tread, place = 0.06, 0.18, 0.72
    steps = "".join(
        f'<collision name="c{count}"><pose>{tread * (count - 0.5)} 0 {rise * count / 2} 0 0 0</pose>'
        f"<geometry>{box(tread, 1, rise * count)}</geometry></collision>"
        for count in range(1, 9)
    )
    model = f'<model name="stairs"><static>1</static><link name="l">{steps}</link></model>'
    (tmp_path / "stairs.sdf").write_text(f'<sdf version="1.9"><world name="w">{model}</world></sdf>')
    angle = atan2(rise, tread)
    start = (place, 0, rise + place * rise / tread + 1e-3)
    twin = tank_twin(tmp_path, step, pose=(start, (0, -angle, 0)), file=str(tmp_path / "stairs.sdf"), ground=False)
    twin.publish(BASE, twist(0.3, 0.0))
    twin.advance_to(0.2)
    before = np.array(twin.entities.state("tank").position)
    twin.advance_to(0.5)
    way = np.array(twin.entities.state("tank").position) - before
    assert way == pytest.approx(0.3 * 0.3 * np.array((cos(angle), 0, sin(angle))), rel=0.01, abs=1e-3)


@moving
def test_the_odometry_follows_from_the_tracks_as_if_they_were_wheels(tmp_path):
    twin = tank_twin(tmp_path, 0.01)
    twin.publish(BASE, twist(0.2, 0.1))
    twin.advance_to(1.0)
    pose = twin.latest("/tank/odometry").pose.pose
    heading = 2 * np.arctan2(pose.orientation.z, pose.orientation.w)
    assert heading == pytest.approx(0.1 / 0.5, rel=0.03)  # by the default efficiency
    assert pose.position.x == pytest.approx(np.sin(0.2) / 0.2 * 0.2, rel=0.03)
    assert twin.latest("/tank/link/left/odometry").twist.twist.linear.x == pytest.approx(0.2 - 0.1 * 0.4)


@moving
def test_the_speeds_are_computed_as_often_as_controllers_are_updated(tmp_path, monkeypatch):
    """And not in each step of the physics."""
    from drake_twin.systems.surface_speeds import SurfaceSpeeds

    times, calc = [], SurfaceSpeeds._calc

    def counted(system, context, output):
        times.append(context.get_time())
        calc(system, context, output)

    monkeypatch.setattr(SurfaceSpeeds, "_calc", counted)
    twin = tank_twin(tmp_path)
    twin.publish(BASE, twist(0.2, 0.0))
    twin.advance_to(0.1)
    times.clear()
    twin.advance_to(0.2)
    assert len(times) <= 11


@moving
def test_a_run_on_tracks_repeats_to_the_last_bit(tmp_path):
    twin = tank_twin(tmp_path, 0.01)
    twin.recorder.begin()
    twin.publish(BASE, twist(0.2, 0.3))
    goes_on_to_the_same_bits(twin, tmp_path)


@moving
def test_a_vehicle_that_is_spawned_beside_another_drives_and_leaves_it_be(tmp_path):
    twin = tank_twin(tmp_path)
    twin.publish(BASE, twist(0.2, 0.0))
    twin.advance_to(0.3)
    twin.entities.spawn(Robot("other", str(tmp_path / "tank.sdf"), xyz=(0, 2, 1e-4)))
    twin.publish("/other/cmd_vel", twist(-0.1, 0.0))
    twin.advance_to(0.6)
    assert velocity(twin) == pytest.approx((0.2, 0, 0), abs=1e-4)
    assert np.array(twin.entities.state("other").linear) == pytest.approx((-0.1, 0, 0), abs=1e-4)
    twin.entities.delete("tank")
    twin.advance_to(0.8)
    assert np.array(twin.entities.state("other").linear) == pytest.approx((-0.1, 0, 0), abs=1e-4)


def test_a_drake_without_moving_surfaces_lets_it_stand_and_one_finding_says_why(tmp_path, monkeypatch):
    for module in ("description.plugins.tracks", "controllers.tracks", "description.surface_velocity"):
        monkeypatch.setattr(f"drake_twin.{module}.has_surface_velocity", lambda: False)
    stands_still(tank_twin(tmp_path))


def test_with_them_nothing_is_said(tmp_path):
    found = [item for item in tank_twin(tmp_path).built.findings if item.kind is Kind.NOT_STARTED]
    assert len(found) == (0 if has_surface_velocity() else 1)
