"""What becomes of a command: pending, valid, expired, scheduled, cleared."""

import pytest
from two_hinges import hinges, trajectories, velocities, write_hinges

from drake_twin import Twin
from drake_twin.scenario import Robot

WHEELS = "/r/wheels/commands"


@pytest.fixture
def make(tmp_path):
    def make(timeout=0.0, names=("r",), commands=(), **more):
        wheels = velocities("left", "right", command_timeout=timeout)
        builder = hinges(tmp_path, {"wheels": wheels, **more}, names)
        for topic, data, options in commands:
            builder.command(topic, data, **options)
        return builder.build()

    return make


def valid(twin, topic=WHEELS):
    """The numbers of the command that is valid."""
    command = twin.graph.command(topic)
    return None if command is None else list(command.data)


def left(twin):
    return twin.robot_state("r").positions[0]


def test_a_command_expires_at_its_time_and_not_a_step_before_or_after(make):
    twin = make(timeout=0.1)
    twin.step(500)
    twin.publish(WHEELS, [2.0, 0.0])
    twin.step(100)  # what is due at a time is done by the step that begins there
    assert valid(twin) == [2.0, 0.0]
    twin.step()
    assert valid(twin) is None


def test_a_command_expires_within_an_advance_too(make):
    twin = make(timeout=0.1)
    twin.publish(WHEELS, [2.0, 0.0])
    twin.advance_to(2.0)
    assert left(twin) == pytest.approx(0.2, abs=0.03)  # 0.1 s at 2 rad/s, and the way to speed and to rest
    assert twin.robot_state("r").velocities[0] == pytest.approx(0.0, abs=1e-6)


def test_each_new_command_restarts_its_timeout(make):
    twin = make(timeout=0.1)
    for _ in range(5):
        twin.publish(WHEELS, [2.0, 0.0])
        twin.advance_to(twin.time + 0.08)
    assert valid(twin) == [2.0, 0.0]
    twin.advance_to(twin.time + 0.03)
    assert valid(twin) is None


@pytest.mark.parametrize("timeout", [1e-12, 1e-4])
@pytest.mark.parametrize("first", [0, 1])
def test_a_timeout_that_is_shorter_than_a_step_lasts_for_one_step(make, timeout, first):
    twin = make(timeout=timeout)
    twin.publish(WHEELS, [2.0, 0.0])
    twin.advance_to(first * 0.001)
    assert valid(twin) == [2.0, 0.0]
    twin.advance_to(1.0)
    assert valid(twin) is None
    assert 0.0 < left(twin) < 2.0 * 0.01


def test_a_command_that_has_expired_or_been_cleared_leaves_nothing_to_expire(make):
    twin = make(timeout=0.1)
    twin.publish(WHEELS, [2.0, 0.0])
    twin.step(150)
    assert twin.snapshot().expiries == {}
    twin.publish(WHEELS, [2.0, 0.0])
    twin.step()
    assert twin.snapshot().expiries == {WHEELS: pytest.approx(0.15 + 0.1)}
    twin.control.manager("r").switch_controller(deactivate=["wheels"])
    saved = twin.snapshot()
    assert (saved.expiries, saved.commands) == ({}, {})
    twin.restore(saved)
    assert twin.snapshot() == saved


def test_what_waits_is_forgotten_when_its_controller_is_deactivated(make):
    twin = make()
    manager = twin.control.manager("r")
    twin.publish(WHEELS, [2.0, 0.0])
    manager.switch_controller(deactivate=["wheels"])
    manager.switch_controller(activate=["wheels"])
    twin.advance_to(0.5)
    assert valid(twin) is None
    assert left(twin) == pytest.approx(0.0, abs=1e-9)


def test_the_robots_clear_only_their_own_commands(make):
    twin = make(names=("r", "other"))
    for robot in ("r", "other"):
        twin.publish(f"/{robot}/wheels/commands", [2.0, 0.0])
    twin.step()
    twin.publish("/other/wheels/commands", [1.0, 0.0])
    twin.control.manager("r").switch_controller(deactivate=["wheels"])
    twin.advance_to(0.5)
    assert valid(twin) is None
    assert valid(twin, "/other/wheels/commands") == [1.0, 0.0]
    assert twin.robot_state("other").velocities[0] == pytest.approx(1.0, rel=1e-3)


def test_of_several_messages_in_one_step_the_last_holds(make):
    twin = make()
    for speed in (1.0, 3.0, 2.0):
        twin.publish(WHEELS, [speed, 0.0])
        assert valid(twin) == [speed, 0.0]  # before the step, too
    twin.advance_to(0.5)
    assert valid(twin) == [2.0, 0.0]


def test_what_is_published_at_the_time_of_a_scheduled_command_comes_after_it(make):
    twin = make(commands=[(WHEELS, [1.0, 0.0], {"time": 0.5})])
    twin.advance_to(0.5)
    twin.publish(WHEELS, [2.0, 0.0])
    twin.advance_to(1.0)
    assert valid(twin) == [2.0, 0.0]


def test_a_goal_leaves_the_commands_of_others_waiting(make):
    twin = make(arm=trajectories("right"))
    manager = twin.control.manager("r")
    assert manager.active == ("wheels", "arm")  # one claims velocities, the other positions
    twin.publish(WHEELS, [2.0, 0.0])
    points = [{"positions": [0.1], "time_from_start": 0.5}]
    goal = {"trajectory": {"joint_names": ["right"], "points": points}}
    twin.graph.send_goal("/r/arm/follow_joint_trajectory", goal)
    twin.advance_to(0.2)
    assert valid(twin) == [2.0, 0.0]
    assert twin.robot_state("r").velocities[0] == pytest.approx(2.0, rel=1e-3)


def test_a_silence_is_saved(make):
    scheduled = [(WHEELS, [1.0, 0.0], {"time": 0.1, "period": 0.1})]
    twin = make(commands=scheduled)
    twin.graph.silence(WHEELS)
    other = Twin(twin.scenario)
    other.restore(twin.snapshot())
    for each in (twin, other):
        each.advance_to(0.55)
        assert valid(each) is None
    assert other.state_sha256() == twin.state_sha256()


def test_what_was_published_on_schedule_is_not_published_again_when_a_robot_comes(make, tmp_path):
    twin = make(commands=[(WHEELS, [1.0, 0.0], {"time": 0.1})])
    twin.advance_to(0.2)
    twin.publish(WHEELS, [2.0, 0.0])
    twin.advance_to(0.3)
    robot, controllers = write_hinges(tmp_path, {"wheels": velocities("left")})
    twin.entities.spawn(Robot("new", str(robot), xyz=(0.0, -5.0, 0.0), controllers=(str(controllers),)))
    twin.advance_to(0.6)
    assert valid(twin) == [2.0, 0.0]


def test_a_flood_of_commands_between_two_steps_keeps_the_newest_of_each_topic(make):
    """As in ros2_control, whose controllers have a buffer of one command."""
    flooded, plain = make(), make()
    for index in range(3000):
        flooded.publish(WHEELS, [index * 1e-3, 0.0])
    plain.publish(WHEELS, [2.999, 0.0])
    assert len(flooded._session.commands.queue) < 1200
    for twin in (flooded, plain):
        twin.step(50)
    assert valid(flooded) == [2.999, 0.0]
    assert flooded.state_sha256() == plain.state_sha256()
