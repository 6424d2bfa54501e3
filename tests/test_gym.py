"""Environments of Gymnasium: its own checks, repeatable, the same in processes of their own."""

import pickle
import warnings
from pathlib import Path

import numpy as np
import pytest
from hinge import write_hinge
from test_walk import walk

from drake_twin.errors import CommandError, InputError
from drake_twin.scenario import Robot, Scenario
from drake_twin.scenario.scenario_file import scenario_to_yaml

gymnasium = pytest.importorskip("gymnasium")

from gymnasium.utils.env_checker import check_env  # noqa: E402

from drake_twin.gym import TwinEnv  # noqa: E402

VALUES = {"friction": (0.2, 1.0), "robot_1.payload": (0.0, 5.0)}


@pytest.fixture
def scenario(tmp_path):
    return Scenario((Robot("hinge", str(write_hinge(tmp_path))),), time_step=0.01)


def played(env, seed, actions):
    """What an environment returns for actions."""
    first, info = env.reset(seed=seed)
    return [first, info["values"], *(env.step(action)[:4] for action in actions)]


def same(one, other):
    assert one[1] == other[1]
    np.testing.assert_array_equal(one[0], other[0])
    for mine, theirs in zip(one[2:], other[2:], strict=True):
        np.testing.assert_array_equal(mine[0], theirs[0])
        assert mine[1:] == theirs[1:]


@pytest.mark.parametrize("name", ["Rover", "Arm"])
def test_gymnasiums_own_checks_pass(name):
    env = gymnasium.make(f"drake_twin/{name}-v0")
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", message=".*Box observation space .*imum value is .*infinity.*")
        check_env(env.unwrapped)


def test_a_seed_repeats_an_episode_and_the_next_one_differs():
    env = gymnasium.make("drake_twin/Rover-v0", values=VALUES).unwrapped
    actions = np.random.default_rng(0).uniform(-1, 1, (8, 4))
    first, again = played(env, 5, actions), played(env, 5, actions)
    same(first, again)
    following = played(env, None, actions)
    assert following[1] != first[1]
    assert set(first[1]) == set(VALUES)
    for path, value in first[1].items():
        assert VALUES[path][0] <= value <= VALUES[path][1]


def test_it_is_pickled_and_the_copy_does_the_same():
    env = gymnasium.make("drake_twin/Arm-v0").unwrapped
    actions = np.random.default_rng(0).uniform(-1, 1, (4, 4))
    same(played(env, 1, actions), played(pickle.loads(pickle.dumps(env)), 1, actions))


def test_four_in_processes_are_four_alone_to_the_bit():
    vector = gymnasium.make_vec(
        "drake_twin/Rover-v0", 4, vectorization_mode="async", vector_kwargs={"context": "spawn"}, values=VALUES
    )
    alone = [gymnasium.make("drake_twin/Rover-v0", values=VALUES) for _ in range(4)]
    try:
        together, _ = vector.reset(seed=7)
        for index, env in enumerate(alone):
            np.testing.assert_array_equal(together[index], env.reset(seed=7 + index)[0])
        for action in np.random.default_rng(1).uniform(-1, 1, (5, 4, 4)).astype(np.float32):
            together, rewards, *_ = vector.step(action)
            for index, env in enumerate(alone):
                observation, reward, *_ = env.step(action[index])
                np.testing.assert_array_equal(together[index], observation)
                assert rewards[index] == reward
    finally:
        vector.close()


def test_many_resets_take_no_memory():
    env = gymnasium.make("drake_twin/Rover-v0", values=VALUES)

    def resident():
        return int(Path("/proc/self/statm").read_text().split()[1]) * 4096

    for _ in range(100):
        env.reset()
    before = resident()
    for _ in range(400):
        env.reset()
    assert resident() - before < 2e6


def test_actions_are_scaled_to_limits_and_observations_to_ranges(scenario):
    env = TwinEnv(scenario, control_rate=10, duration=0.5)
    assert env.action_space.shape == (1,)
    env.reset(seed=0)
    for step in range(5):
        observation, reward, terminated, truncated, _ = env.step(np.array([0.5]))
        assert (reward, terminated, truncated) == (0.0, False, step == 4)
    state = env.twin.robot_state("hinge")
    assert state.velocities[0] == pytest.approx(2.5, rel=1e-3)  # half of 5 rad/s
    assert env.twin.time == pytest.approx(0.5)
    assert observation == pytest.approx([state.positions[0], state.velocities[0] / 5])
    env.step(np.array([7.0]))
    env.step(np.array([7.0]))
    assert env.twin.robot_state("hinge").velocities[0] == pytest.approx(5, rel=1e-3)


def test_a_rovers_observation_is_its_joints_its_base_and_the_goal():
    env = gymnasium.make("drake_twin/Rover-v0").unwrapped
    env.reset(seed=2)
    for _ in range(20):
        observation = env.step(np.array([1.0, -0.2, 1.0, -0.2]))[0]
    state, base = env.twin.robot_state("robot_1"), env.twin.entities.state("robot_1")
    assert abs(base.angular[2]) > 0.1
    joints = [*state.positions, *(speed / 20.0 for speed in state.velocities)]
    expected = [*joints, *state.base_pose, *base.linear, *base.angular]
    assert observation[:-2] == pytest.approx(expected, abs=1e-6)
    assert float(np.hypot(*(observation[-2:] - state.base_pose[:2]))) == pytest.approx(env._last, abs=1e-6)


@pytest.mark.parametrize("name", ["Rover", "Arm"])
def test_a_step_makes_few_calls_beside_the_twins_own(name):
    env = gymnasium.make(f"drake_twin/{name}-v0").unwrapped
    env.reset(seed=0)
    action = env.action_space.sample()
    env.step(action)
    entered = walk(lambda: env.step(action))
    own = [function for function in entered if "gym.py" in function]
    assert len([*own, *(function for function in entered if "state_vector" in function)]) <= 20, "\n".join(entered)


@pytest.mark.parametrize("action", [[0.5], [0.0] * 5, 0.5, [[0.0] * 4]])
def test_an_action_of_another_shape_is_refused(action):
    env = gymnasium.make("drake_twin/Rover-v0").unwrapped
    env.reset(seed=0)
    with pytest.raises(InputError, match=r"but it must be \(4,\)"):
        env.step(action)


def test_an_error_in_another_process_keeps_its_words():
    vector = gymnasium.make_vec(
        "drake_twin/Rover-v0", 2, vectorization_mode="async", vector_kwargs={"context": "spawn"}
    )
    try:
        vector.reset(seed=0)
        with pytest.raises(CommandError, match="not a finite number"):
            vector.step(np.full((2, 4), np.nan, np.float32))
    finally:
        vector.close()


def test_functions_and_files_and_values_of_ones_own(scenario, tmp_path):
    (tmp_path / "s.yaml").write_text(scenario_to_yaml(scenario))
    env = TwinEnv(
        tmp_path / "s.yaml",
        action={"/hinge/velocity/commands": (0.0, 2.0)},
        observation=lambda twin: [twin.time],
        reward=lambda twin: (3.0, twin.time > 0.055),
        values={"hinge.arm.mass": (1.0, 2.0)},
    )
    observation, info = env.reset(seed=1, options={"hinge.arm.mass": 1.25})
    assert (observation.tolist(), info) == ([0.0], {"values": {"hinge.arm.mass": 1.25}})
    assert env.twin.scenario.values == {"hinge.arm.mass": 1.25}
    outcomes = [env.step(np.array([-1.0]))[1:3] for _ in range(3)]
    assert outcomes == [(3.0, False), (3.0, False), (3.0, True)]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"action": {"/hinge/velocty/commands": None}}, "Did you mean '/hinge/velocity/commands'"),
        ({"control_rate": 0}, "must be above zero"),
        ({"duration": 1e-9}, "must be above zero"),
        ({"values": {"friction": (1, 0.5)}}, "must be two numbers, the lower one first"),
        ({"values": {"friction": 0.5}}, "must be two numbers, the lower one first"),
        ({"action": {"/hinge/velocity/commands": (1, 0)}}, "must be two numbers, the lower one first"),
        ({"render_mode": "rgb_array"}, "with the camera"),
        ({"values": {"hinge.arn.mass": (1, 2)}}, "has no link 'arn'"),
    ],
)
def test_what_cannot_be_used_is_refused(scenario, arguments, message):
    with pytest.raises(InputError) as refused:
        TwinEnv(scenario, **arguments)
    assert message in str(refused.value)


def test_joints_without_limits_need_bounds(scenario, tmp_path):
    urdf = tmp_path / "hinge.urdf"
    urdf.write_text(urdf.read_text().replace('<limit velocity="5" effort="50"/>', ""))
    with pytest.raises(InputError, match="have no limits: give bounds"):
        TwinEnv(scenario)
