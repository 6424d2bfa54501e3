"""A step that fails in one island, and the state of all the others."""

import numpy as np
import pytest
from crates import crates, drive, groups, model, resting, state, with_rovers

from drake_twin.errors import RunError

ENOUGH = 1e30  # N·m


def scene(folder, threads=2):
    """A rover that rests, two that drive, and crates."""
    models = (model("crate", (0, 6, 0.2)), model("other", (5, 6, 3.0)))
    found = crates(folder, *models, islands=1, threads=threads)
    return with_rovers(found, (0, 0, 0), (0, 2, 0), (0, -2, 0)).build()


def begun(folder, **options):
    twin = scene(folder, **options)
    twin.advance_to(1.0)
    for robot in ("r1", "r2"):
        drive(twin, robot, 3.0)
    twin.advance_to(1.5)
    assert "r0" in resting(twin)
    return twin


def spoil(twin):
    twin.entities.apply_wrench("r1", torque=(0, 0, ENOUGH), duration=1.0)


def failed(twin, advance):
    with pytest.raises(RunError) as raised:
        advance(twin)
    return str(raised.value)


def step_by_step(twin):
    for _ in range(1000):
        twin.step()


@pytest.mark.parametrize("threads", [1, 2])
def test_the_run_ends_with_the_name_of_the_robot_whose_step_fails(tmp_path, threads):
    twin = begun(tmp_path, threads=threads)
    spoil(twin)
    what = failed(twin, lambda twin: twin.advance_to(4.0))
    assert what.startswith("the simulation failed after 1.5 s: ")
    assert "of robot 'r1'" in what
    assert "r0" not in what
    assert "r2" not in what


def test_all_are_kept_at_the_last_good_step(tmp_path):
    twin = begun(tmp_path)
    spoil(twin)
    before, good = state(twin), twin.state_sha256()
    for _ in range(2):
        failed(twin, lambda twin: twin.advance_to(4.0))
        assert twin.time == 1.5
        assert (state(twin) == before).all()
        assert twin.state_sha256() == good


def test_a_failure_in_the_middle_of_an_advance_leaves_what_single_steps_leave(tmp_path):
    """Also of a rover that was woken by a command in the same advance."""
    long, short, plain = (begun(tmp_path) for _ in range(3))
    for twin in (long, short, plain):
        drive(twin, "r0", 4.0)
    for twin in (long, short):
        twin.entities.apply_wrench("r1", torque=(0, 0, 4e11), duration=1.0)  # absurd after some steps
    whats = [failed(long, lambda twin: twin.advance_to(4.0)), failed(short, step_by_step)]
    assert whats[0].split(":")[0] == whats[1].split(":")[0]
    assert long.time == short.time
    assert long.state_sha256() == short.state_sha256()
    plain.advance_to(long.time)
    for name in ("r0", "r2", "crate", "other"):
        assert long.entities.state(name) == plain.entities.state(name)


def test_it_goes_on_without_what_has_failed(tmp_path):
    twin, plain = begun(tmp_path), begun(tmp_path)
    spoil(twin)
    failed(twin, lambda twin: twin.advance_to(4.0))
    for each in (twin, plain):
        each.entities.delete("r1")
        each.advance_to(2.5)
    assert (state(twin) == state(plain)).all()
    assert np.isfinite(state(twin)).all()


def test_it_goes_on_after_a_reset_as_a_new_twin(tmp_path):
    twin, new = begun(tmp_path), scene(tmp_path)
    spoil(twin)
    failed(twin, lambda twin: twin.advance_to(4.0))
    twin.reset()
    for each in (twin, new):
        drive(each, "r0", 2.0)
        each.advance_to(1.0)
    assert twin.state_sha256() == new.state_sha256()
    assert groups(twin) == groups(new)


def test_it_goes_on_from_a_snapshot_before_the_failure(tmp_path):
    twin, plain = begun(tmp_path), begun(tmp_path)
    good = twin.snapshot()
    spoil(twin)
    failed(twin, lambda twin: twin.advance_to(4.0))
    twin.restore(good)
    for each in (twin, plain):
        each.advance_to(2.5)
    assert twin.state_sha256() == plain.state_sha256()


@pytest.mark.parametrize("value", [np.nan, np.inf, 1e200])
@pytest.mark.parametrize("name", ["r0", "r2"])
def test_a_state_that_cannot_be_is_told_with_its_owner(tmp_path, value, name):
    """Of a rover that rests, and of one that drives."""
    twin = begun(tmp_path)
    instance = twin.built.robots[name].instance
    spoiled, velocities = state(twin), np.arange(twin.plant.num_velocities())
    last = twin.plant.GetVelocitiesFromArray(instance, velocities).astype(int)[-1]
    spoiled[twin.plant.num_positions() + last] = value
    twin.plant.GetMyMutableContextFromRoot(twin.context).SetDiscreteState(spoiled)
    what = failed(twin, lambda twin: twin.advance_to(4.0))
    assert f"robot {name!r}" in what
    twin.reset()
    new = scene(tmp_path)
    for each in (twin, new):
        each.advance_to(0.5)
    assert twin.state_sha256() == new.state_sha256()


def test_a_model_of_the_world_is_named_as_well(tmp_path):
    twin = begun(tmp_path)
    twin.entities.apply_wrench("crate", force=(0, 4e14, 0), duration=1.0)
    assert "model 'crate' of the world" in failed(twin, lambda twin: twin.advance_to(4.0))


def test_masses_that_the_solver_cannot_take_are_told(tmp_path):
    twin = begun(tmp_path)
    body = twin.plant.GetBodyByName("r1_base_link")
    body.SetMass(twin.plant.GetMyMutableContextFromRoot(twin.context), 1e-300)
    spoil(twin)
    assert "robot 'r1'" in failed(twin, lambda twin: twin.advance_to(4.0))
    twin.reset()
    twin.advance_to(0.5)
    assert np.isfinite(state(twin)).all()
