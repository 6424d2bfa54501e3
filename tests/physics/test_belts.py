"""Belts as gz-sim's TrackController on what stands still: what lies on them moves as mechanics says."""

from math import atan, cos, sin

import numpy as np
import pytest
from belts import CENIC, FRICTION, STEPS, box, built, moving, number, shape, solid, track
from program_runs import summary_of
from repeated_runs import goes_on_to_the_same_bits

from drake_twin.description.surface_velocity import has_surface_velocity
from drake_twin.scenario import Robot

G = 9.81
SPEED = 0.5
COMMAND = "/conveyor/link/belt/track_cmd_vel"
SIZE, PARCEL = (6, 1, 0.2), (0.3, 0.2, 0.1)


@pytest.fixture(params=STEPS, ids=str)
def step(request):
    return request.param


def conveyor(more="", size=SIZE, pose="0 0 0 0 0 0"):
    link = f'<link name="belt"><pose>{pose}</pose>{shape(box(*size))}</link>'
    return f'<model name="conveyor"><static>1</static>{link}{track("belt", more)}</model>'


def parcel(height=0.0):
    link = f'<link name="l">{solid(2, *PARCEL)}{shape(box(*PARCEL))}</link>'
    return f'<model name="parcel"><pose>0 0 {height} 0 0 0</pose>{link}</model>'


def on_a_belt(folder, step=0.001, more="", height=SIZE[2] / 2 + 0.05, **world):
    """A twin with a parcel on a belt."""
    robots = {"conveyor": (conveyor(more), (0, 0, 0)), "parcel": (parcel(), (0, 0, height))}
    robots = {name: (f'<sdf version="1.9">{model}</sdf>', place) for name, (model, place) in robots.items()}
    return built(folder, step, robots, **{"ground": False} | world)


def state(twin):
    entity = twin.entities.state("parcel")
    return np.array(entity.position), np.array(entity.linear)


@moving
def test_a_parcel_is_accelerated_by_friction_and_then_carried(tmp_path, step):
    """Δv = μ g Δt while it slips, and in all it is behind the belt by v² / 2 μ g."""
    twin = on_a_belt(tmp_path, step)
    twin.advance_to(0.1)
    start = state(twin)[0]
    twin.publish(COMMAND, number(2 * SPEED))
    twin.advance_to(0.14)
    before = state(twin)[1]
    twin.advance_to(0.24)
    _, velocity = state(twin)
    assert velocity[0] - before[0] == pytest.approx(FRICTION * G * 0.1, rel=0.01)
    twin.advance_to(0.6)
    place, velocity = state(twin)
    assert velocity == pytest.approx((2 * SPEED, 0, 0), abs=1e-4)
    period = 0.001 if step == CENIC else step
    way = 2 * SPEED * 0.5 - (2 * SPEED) ** 2 / (2 * FRICTION * G)
    assert place - start == pytest.approx((way, 0, 0), abs=0.01 * way + 2 * SPEED * period)


@moving
def test_a_belt_whose_command_is_too_old_stops_what_lies_on_it(tmp_path, step):
    """It comes to rest after v² / 2 μ g."""
    twin = on_a_belt(tmp_path, step, "<max_command_age>0.3</max_command_age>")
    twin.publish(COMMAND, number(SPEED))
    twin.advance_to(0.3)
    start, velocity = state(twin)
    assert velocity[0] == pytest.approx(SPEED, abs=1e-4)
    twin.advance_to(0.7)
    place, velocity = state(twin)
    assert velocity == pytest.approx(np.zeros(3), abs=1e-4)
    assert place[0] - start[0] == pytest.approx(SPEED**2 / (2 * FRICTION * G), rel=0.01, abs=0.011 * SPEED)


@moving
@pytest.mark.parametrize(
    ("orientation", "direction"),
    [
        ("0 0 0", (1, 0, 0)),
        ("0 0 1.5707963", (0, 1, 0)),
        ("0 0 3.1415927", (-1, 0, 0)),
        ("0 0 0.5", (cos(0.5), sin(0.5), 0)),
        ("3.1415927 0 0", (-1, 0, 0)),
    ],
)
def test_a_track_may_be_turned_on_its_link(tmp_path, orientation, direction):
    """It runs along the turned x; where the turned y is below, it is its other strand that is above."""
    twin = on_a_belt(tmp_path, 0.01, f"<track_orientation>{orientation}</track_orientation>")
    twin.publish(COMMAND, number(SPEED))
    twin.advance_to(0.3)
    assert state(twin)[1] == pytest.approx(SPEED * np.array(direction), abs=1e-4)


@moving
@pytest.mark.parametrize("share", [0.9, 1.2])
def test_a_belt_carries_up_a_slope_below_the_angle_of_friction(tmp_path, step, share):
    angle, speed = share * atan(FRICTION), 0.2
    twin = on_a_belt(tmp_path, step, gravity=(-G * sin(angle), 0, -G * cos(angle)))
    twin.publish(COMMAND, number(speed))
    twin.advance_to(0.1)
    before = state(twin)[1][0]
    twin.advance_to(0.3)  # below the angle it still slips then
    gain = G * (FRICTION * cos(angle) - sin(angle)) * 0.2
    assert state(twin)[1][0] - before == pytest.approx(gain, rel=0.01)
    if share < 1:
        twin.advance_to(0.6)
        assert state(twin)[1] == pytest.approx((speed, 0, 0), abs=1e-3)


@moving
def test_a_belt_moves_what_is_below_it_the_other_way(tmp_path):
    """A plate under a belt whose lower strand lies on it, pressed up by the world's gravity."""
    twin = on_a_belt(tmp_path, 0.01, gravity=(0, 0, G), height=-SIZE[2] / 2 - 0.05)
    twin.publish(COMMAND, number(SPEED))
    twin.advance_to(0.4)
    assert state(twin)[1] == pytest.approx((-SPEED, 0, 0), abs=1e-4)


@moving
def test_a_run_on_a_belt_repeats_to_the_last_bit(tmp_path):
    twin = on_a_belt(tmp_path, 0.01)
    twin.recorder.begin()
    twin.publish(COMMAND, number(SPEED))
    twin.entities.spawn(Robot("other", str(tmp_path / "parcel.sdf"), xyz=(0.5, 0, 0.2)))
    goes_on_to_the_same_bits(twin, tmp_path)
    assert twin.entities.state("other").linear[0] == pytest.approx(SPEED, abs=1e-3)


def test_a_belt_of_a_worlds_file_carries_its_models(tmp_path, capsys):
    """It is a robot that stands still, so that its topics are those of one."""
    world = tmp_path / "belt.sdf"
    world.write_text(f'<sdf version="1.9"><world name="w">{conveyor()}{parcel(0.15)}</world></sdf>')
    pub = ("--pub", COMMAND, "{data: 0.5}") if has_surface_velocity() else ()
    result = summary_of(tmp_path, world, "--duration", 0.5, "--time-step", 0.01, *pub)
    assert [*result["robots"]] == ["conveyor"]
    assert result["robots"]["conveyor"]["base_pose"][:3] == [0, 0, 0]
    said = capsys.readouterr().err
    assert ("needs Drake 1.56" in said) is not has_surface_velocity()
