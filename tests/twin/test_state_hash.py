"""The hash is of all that decides how a twin goes on: change any item of the state, and it is another one."""

import contextlib
import copy

import numpy as np
import pytest
from conftest import ROVER
from random_use import RandomUse, build, write_files

from drake_twin.errors import TwinError
from drake_twin.scenario import Robot
from drake_twin.twin.plain_data import from_plain, to_plain
from drake_twin.twin.snapshot import Snapshot

IN_WORDS = {"joints", "base_pose"}  # of a robot: its state vector once more, for people


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    return write_files(tmp_path_factory.mktemp("state"))


def lively(files):
    """A twin in which there is something of everything: goals, pushes, waiting and expiring commands, a stop."""
    twin = build(files)
    twin.entities.spawn(Robot("rover", ROVER, xyz=(3.0, 0.0, 0.13)))
    points = [{"positions": [1.0, 0.5], "time_from_start": 2.0}]
    goal = {"trajectory": {"joint_names": ["shoulder", "elbow"], "points": points}}
    twin.graph.send_goal("/used/trajectories/follow_joint_trajectory", goal)
    twin.publish("/rover/forward_velocity_controller/commands", [1.0, 2.0, 1.0, 2.0])
    twin.publish("/used/wheels/cmd_vel", {"twist": {"linear": {"x": 0.2}, "angular": {"z": 0.1}}})
    twin.entities.apply_wrench("used::link_elbow", force=(1.0, 0.0, 0.0), duration=1.0)
    twin.advance_to(0.3)
    twin.control.emergency_stop("alone")
    twin.advance_to(0.35)
    twin.clock.set_time_step(0.003)
    body = twin.plant.GetBodyByName("rover_base_link")
    body.SetMass(twin.plant.GetMyContextFromRoot(twin.context), 11.0)
    twin.publish("/rover/forward_velocity_controller/commands", [2.0, 2.0, 2.0, 2.0])
    return twin


def leaves(value, path=()):
    """Paths to all numbers, texts and flags of plain data; names of saved classes are none of them."""
    if isinstance(value, dict | list):
        items = value.items() if isinstance(value, dict) else enumerate(value)
        for key, item in items:
            if key != "!" and not (len(path) == 2 and path[0] == "robots" and key in IN_WORDS):
                yield from leaves(item, (*path, key))
    else:
        yield path


def perturbed(value):
    if isinstance(value, bool):
        return not value
    if isinstance(value, int):
        return value + 1
    if isinstance(value, float):
        return float(np.nextafter(value, np.inf))
    return 0.5 if value is None else f"{value}x"


def with_another(data, path):
    changed = copy.deepcopy(data)
    place = changed
    for key in path[:-1]:
        place = place[key]
    place[path[-1]] = perturbed(place[path[-1]])
    return changed


def test_each_item_of_a_saved_state_is_in_the_hash(files):
    twin, other = lively(files), build(files)
    saved, before = dict(vars(twin.snapshot())), twin.state_sha256()
    scenario = saved.pop("scenario")
    paths, taken, unseen = list(leaves(saved)), 0, []
    assert {path[0] for path in paths} >= {"robots", "step", "parameters", "waiting", "wrenches", "next_time_step"}
    for path in paths:
        try:
            other.restore(Snapshot(scenario=scenario, **with_another(saved, path)))
        except TwinError:
            continue  # it does not fit, and is refused
        taken += 1
        if other.state_sha256() == before:
            unseen.append(path)
    assert unseen == []
    assert taken > 100
    other.restore(Snapshot(scenario=scenario, **saved))
    assert other.state_sha256() == before


def test_each_item_of_the_diagrams_own_state_is_in_the_hash(files):
    twin = lively(files)
    before, context = twin.state_sha256(), twin.context
    for group in range(context.num_discrete_state_groups()):
        for index in range(context.get_discrete_state(group).size()):
            vector = context.get_mutable_discrete_state(group)
            value = vector.GetAtIndex(index)
            vector.SetAtIndex(index, np.nextafter(value, np.inf))
            assert twin.state_sha256() != before, (group, index)
            context.get_mutable_discrete_state(group).SetAtIndex(index, value)
    assert twin.state_sha256() == before
    seen = 0
    for index in range(context.num_abstract_states()):
        value = context.get_abstract_state(index).get_value()
        plain = to_plain(value)
        for path in leaves(plain):
            try:
                changed = from_plain(with_another(plain, path))
            except TwinError:
                continue  # no value of the type
            context.SetAbstractState(index, changed)
            assert twin.state_sha256() != before, (type(value).__name__, path)
            seen += 1
        context.SetAbstractState(index, value)
    assert twin.state_sha256() == before
    assert seen > 50


@pytest.mark.parametrize("seed", range(6))
def test_twins_of_the_same_hash_go_on_alike_under_the_same_commands(files, seed):
    twin, other = lively(files), build(files)
    other.restore(twin.snapshot())
    assert other.state_sha256() == twin.state_sha256()
    uses = [RandomUse(each, np.random.default_rng(seed)) for each in (twin, other)]
    for _ in range(8):
        for use in uses:
            for call in (use.publish, use.switch, use.publish, use.publish):
                with contextlib.suppress(TwinError):
                    call()
            use.twin.step(20)
        assert twin.state_sha256() == other.state_sha256()
