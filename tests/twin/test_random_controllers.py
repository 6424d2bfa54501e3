"""Random use of two robots of one file keeps what must always hold, whatever the order of the calls.

The first robot is used; the second stands apart and goes on as if it were alone.
"""

import contextlib

import numpy as np
import pytest
from random_use import CHAIN, RandomUse, build, write_files

from drake_twin.errors import TwinError

STEPS = 30


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    return write_files(tmp_path_factory.mktemp("random"))


def assert_what_always_holds(twin):
    manager = twin.control.manager("used")
    claims = [claim for item in manager.list_controllers() for claim in item.claimed_interfaces]
    assert len(claims) == len(set(claims))
    claimed = {item.name for item in manager.list_hardware_interfaces()[0] if item.is_claimed}
    assert claimed == set(claims)
    assert not {"broken", "nobody"} & set(manager.active)
    active = [name for name in CHAIN if name in manager.active]
    assert active == [*CHAIN[: len(active)]]
    state = twin.robot_state("used")
    assert np.isfinite([*state.positions, *state.velocities, *state.efforts]).all()


@pytest.mark.parametrize("seed", range(8))
def test_random_use_lets_nothing_escape_and_leaves_the_neighbour_alone(files, seed):
    twin, alone = build(files), build(files, ("alone",))
    use, done, chained = RandomUse(twin, np.random.default_rng(seed)), [], 0
    untouched = dict(twin.control.manager("alone").states)
    for _ in range(60):
        for _ in range(use.random.integers(1, 4)):
            with contextlib.suppress(TwinError):
                done.append(use.call())
            assert_what_always_holds(twin)
        twin.step(STEPS)
        if twin.clock.step_count <= alone.clock.step_count:
            alone.reset()
        alone.step(twin.clock.step_count - alone.clock.step_count)
        assert_what_always_holds(twin)
        chained += set(CHAIN) <= set(use.manager.active)
        one, other = twin.robot_state("alone"), alone.robot_state("alone")
        assert np.abs(np.subtract(one.positions, other.positions)).max() < 1e-6
        assert np.abs(np.subtract(one.velocities, other.velocities)).max() < 1e-6
        assert twin.control.manager("alone").states == untouched
    assert {"switch", "chain", "publish", "send_goal"} <= set(done)
    assert chained > 0, "the whole chain was never active over some steps"
    twin.reset()
    assert all(goal.is_done for goal in use.goals)
    assert twin.state_sha256() == build(files).state_sha256()


def test_the_end_of_a_goal_is_no_step_more_for_anybody(files):
    """The twin stops to tell of the end; a step made twice would show in the neighbour, which settles at the start."""
    twin, alone = build(files), build(files, ("alone",))
    points = [{"positions": [0.05, -0.05], "time_from_start": 0.1}]
    goal = twin.graph.send_goal(
        "/used/trajectories/follow_joint_trajectory",
        {"trajectory": {"joint_names": ["shoulder", "elbow"], "points": points}},
    )
    twin.step(60)
    alone.step(60)
    assert goal.status == "succeeded"
    one, other = twin.robot_state("alone"), alone.robot_state("alone")
    assert one.velocities == pytest.approx(other.velocities, abs=1e-8)  # a step changes them by 1.5e-5


@pytest.mark.parametrize("seed", range(4))
def test_what_an_inactive_controller_is_told_never_moves_a_joint(files, seed):
    """Two twins are switched alike; only one of them is also told things on the topics of inactive controllers."""
    told, quiet = build(files, ("used",)), build(files, ("used",))
    uses = [RandomUse(twin, np.random.default_rng(seed)) for twin in (told, quiet)]
    publisher = RandomUse(told, np.random.default_rng(100 + seed))
    for _ in range(30):
        for use in uses:
            use.switch()
        assert uses[0].manager.states == uses[1].manager.states
        for _ in range(5):
            topic = publisher.topic()
            if told.built.commanded[topic].controller not in uses[0].manager.active:
                told.publish(topic, publisher.message(topic))
        for action in ("trajectories/follow_joint_trajectory", "gripper/gripper_cmd"):
            if action.partition("/")[0] not in uses[0].manager.active:
                with pytest.raises(TwinError, match="not active"):
                    told.graph.send_goal(f"/used/{action}", {})
        for twin in (told, quiet):
            twin.step(STEPS)
        assert told.state_sha256() == quiet.state_sha256()
