"""Links are pushed at a point and dragged with a spring, as Newton says; recorded, and free of cost for the others."""

from operator import attrgetter

import numpy as np
import pytest
from conftest import ARM, rovers
from world_with_crate import CRATE_AT, rover_and_crate

from drake_twin import Recording, Snapshot, Twin, TwinBuilder
from drake_twin.errors import InputError
from drake_twin.scenario import World
from drake_twin.twin.recording import CALLS
from drake_twin.twin.replay import replay

BOX = """<robot name="box"><link name="base"><inertial><mass value="2"/>
  <inertia ixx="0.5" iyy="0.5" izz="0.5" ixy="0" ixz="0" iyz="0"/></inertial></link></robot>"""
ROD = """<robot name="rod"><link name="base"><inertial><mass value="3"/>
  <inertia ixx="0.001" iyy="0.25" izz="0.25" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <link name="feather"><inertial><mass value="0.01"/>
  <inertia ixx="1e-5" iyy="1e-5" izz="1e-5" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="slide" type="prismatic"><parent link="base"/><child link="feather"/><axis xyz="1 0 0"/>
  <limit lower="-1" upper="1" effort="0" velocity="10"/></joint></robot>"""


def floating(tmp_path, text=BOX, **options):
    """A body without gravity."""
    (tmp_path / "body.urdf").write_text(text)
    builder = TwinBuilder(world=World(gravity=(0, 0, 0), ground=False), **options)
    return builder.robot("box", tmp_path / "body.urdf", xyz=(0, 0, 5)).build()


def test_a_force_at_a_point_gives_the_impulse_and_the_spin_that_newton_says(tmp_path):
    twin = floating(tmp_path)
    twin.entities.apply_wrench("box", force=(0, 4, 0), duration=0.01, at=(0.5, 0, 0))
    twin.advance_to(0.5)
    state = twin.entities.state("box")
    assert state.linear == pytest.approx((0, 4 * 0.01 / 2, 0), abs=1e-9)  # F t / m
    assert state.angular == pytest.approx((0, 0, 0.5 * 4 * 0.01 / 0.5), abs=1e-6)  # r F t / I


@pytest.mark.parametrize("engine", ["discrete", "cenic"])
def test_a_dragged_body_follows_as_a_critically_damped_oscillator(tmp_path, engine):
    options = {} if engine == "discrete" else {"engine": "cenic"}
    twin = floating(tmp_path, **options)
    twin.entities.drag("box", (0.3, 0, 5))
    seen = []
    for time in (0.1, 0.2, 0.4, 0.8):
        twin.advance_to(time)
        seen.append(twin.entities.state("box").position[0])
    expected = [0.3 * (1 - (1 + 10 * t) * np.exp(-10 * t)) for t in (0.1, 0.2, 0.4, 0.8)]
    assert seen == pytest.approx(expected, abs=0.3 * 0.03)  # the force is 2.5 ms late in the mean, of 100 ms
    twin.advance_to(3.0)
    assert twin.entities.state("box").position == pytest.approx((0.3, 0, 5), abs=1e-5)


def test_a_given_stiffness_is_the_springs(tmp_path):
    twin = floating(tmp_path)
    twin.entities.drag("box", (0.3, 0, 5), stiffness=2 * 4.0**2)  # 4 rad/s
    twin.advance_to(0.5)
    assert twin.entities.state("box").position[0] == pytest.approx(0.3 * (1 - 3 * np.exp(-2)), abs=0.005)


def test_a_dragged_crate_is_lifted_hangs_below_the_target_and_falls_when_released(tmp_path):
    twin = rover_and_crate(tmp_path).build()
    x, y, z = CRATE_AT
    twin.entities.drag("crate", (x, y, 1.2))
    twin.advance_to(3.0)
    assert twin.entities.state("crate").position == pytest.approx((x, y, 1.2 - 9.81 / 10**2), abs=2e-3)  # g / ω²
    twin.entities.drag("crate", (x, y + 0.5, 1.2))
    twin.advance_to(5.0)
    assert twin.entities.state("crate").position == pytest.approx((x, y + 0.5, 1.2 - 9.81 / 10**2), abs=2e-3)
    twin.entities.release("crate")
    twin.entities.release("crate")
    twin.advance_to(7.0)
    assert twin.entities.state("crate").position == pytest.approx((x, y + 0.5, z), abs=5e-3)


def test_a_light_link_of_a_heavy_robot_is_dragged_without_swinging_up(tmp_path):
    twin = floating(tmp_path, ROD)
    twin.entities.drag("box::feather", (0.2, 0.1, 5.0), at=(0.0, 0.0, 0.1))
    speeds = []
    for step in range(1, 200):
        twin.advance_to(0.02 * step)
        speeds.append(max(map(abs, twin.entities.state("box::feather").linear)))
    assert max(speeds) < 5.0  # a feather starts at once
    assert speeds[10] < 0.5
    assert speeds[-1] < 0.02
    point = np.array(twin.entities.state("box::feather").position)
    assert np.linalg.norm(point - (0.2, 0.1, 5.0)) < 0.2


@pytest.mark.parametrize("time_step", [0.001, 0.002, 0.02])
def test_a_drag_ends_after_its_duration_with_any_step(tmp_path, time_step):
    twin = floating(tmp_path, time_step=time_step)
    twin.entities.drag("box", (1, 0, 5), duration=0.1)
    twin.advance_to(0.1)
    speed = twin.entities.state("box").linear[0]
    assert speed > 0.5
    twin.advance_to(1.0)
    assert twin.entities.state("box").linear[0] == speed
    assert twin.snapshot().wrenches == Twin(twin.scenario).snapshot().wrenches


def test_a_dragged_run_replays_to_the_same_hash_with_and_without_listeners(tmp_path):
    twin = rover_and_crate(tmp_path).build()
    twin.recorder.begin()
    x, y, _ = CRATE_AT
    for index in range(30):  # as the page does
        twin.entities.drag("crate", (x + 0.02 * index, y, 0.5), at=(0.1, 0.0, 0.2), duration=1.0)
        twin.advance_to(0.033 * (index + 1))
    twin.entities.release("crate")
    twin.entities.apply_wrench("rover", force=(0, 50, 0), duration=0.2, at=(0.2, 0, 0))
    twin.entities.drag("rover", (0, 0, 0.5))
    twin.advance_to(1.5)
    assert twin.entities.state("crate").position[0] > x + 0.1
    twin.recorder.recording().save(tmp_path / "run.json")
    again = replay(Recording.load(tmp_path / "run.json"))
    assert again.state_sha256() == twin.state_sha256()
    middle = Twin(twin.scenario)
    middle.subscribe("/clock", lambda _: None, rate=1000)
    middle.restore(twin.recorder.recording().start)
    for call in twin.recorder.recording().calls:
        middle.advance_to(call.time)
        attrgetter(CALLS[call.name])(middle)(*call.arguments, **call.named)
        middle.snapshot().save(tmp_path / "half.json")
    middle.restore(Snapshot.load(tmp_path / "half.json"))  # while the rover is dragged, off the grid
    middle.advance_to(1.233)
    middle.restore(middle.snapshot())
    middle.advance_to(1.5)
    assert middle.state_sha256() == twin.state_sha256()


def test_a_twin_that_nobody_drags_has_no_force_and_the_state_that_it_had(tmp_path):
    plain, dragged = rovers(1).build(), rovers(1).build()
    port = plain.plant.get_applied_spatial_force_input_port()
    assert not port.HasValue(plain.plant.GetMyContextFromRoot(plain.context))
    dragged.entities.drag("robot_1", (0, 0, 0.13))
    dragged.entities.release("robot_1")
    for twin in (plain, dragged):
        twin.advance_to(0.5)
    assert plain.state_sha256() == dragged.state_sha256()
    assert "Pull" not in str(plain.snapshot().wrenches)


def test_a_drag_survives_a_rebuild_and_ends_with_what_is_dragged(tmp_path):
    twin = rover_and_crate(tmp_path).build()
    x, y, _ = CRATE_AT
    twin.entities.drag("crate", (x, y, 1.2))
    twin.advance_to(0.5)
    twin.entities.place("ramp", (5, 5, 0.05))
    twin.clock.set_time_step(0.002)
    twin.advance_to(3.0)
    assert twin.entities.state("crate").position == pytest.approx((x, y, 1.2 - 9.81 / 10**2), abs=2e-3)
    twin.entities.delete("crate")
    twin.advance_to(3.1)
    twin.reset()
    assert twin.snapshot().wrenches["items"] == []


def test_what_cannot_be_dragged_is_said(tmp_path):
    twin = rover_and_crate(tmp_path).robot("arm", ARM, xyz=(0, -2, 0)).build()
    sha256 = twin.state_sha256()
    base = twin.built.plans[1].description.root_link
    for call, what in (
        (lambda: twin.entities.drag("nobody", (0, 0, 0)), r"Entity \[nobody\] does not exist"),
        (lambda: twin.entities.drag(f"arm::{base}", (0, 0, 0)), "cannot be dragged: it is fixed to the world"),
        (lambda: twin.entities.drag("crate", (0, 0)), "the target .* is not 3 finite numbers"),
        (lambda: twin.entities.drag("crate", (0, 0, 0), at="here"), "the point 'here' is not a list of numbers"),
        (lambda: twin.entities.drag("crate", (0, 0, 0), duration=-1), "invalid duration -1 s"),
        (lambda: twin.entities.drag("crate", (0, 0, 0), stiffness=0), "invalid stiffness 0 N/m: it must be above zero"),
        (lambda: twin.entities.apply_wrench("crate", at=(1, 2)), "the point .* is not 3 finite numbers"),
    ):
        with pytest.raises(InputError, match=what):
            call()
    twin.entities.release("nobody")
    assert twin.state_sha256() == sha256
