"""What is stopped brakes with its effort and is held where it comes to rest; nothing goes to a position too fast."""

from math import asin, hypot

import numpy as np
import pytest
from arms import ARMS, ArmScene
from bases import RADIUS, four_wheels
from conftest import ROVER
from scenes import ENGINES, G, Scene, every_engine, on_slope, plane, position

from drake_twin import TwinBuilder
from drake_twin.twin.replay import replay

SPEED = 3.0  # rad/s, within every joint's limit but the demo arm's
STOPS = ("emergency stop", "deactivation", "zero")


def stop(twin, robot, controller, how, zero):
    if how == "emergency stop":
        twin.control.emergency_stop(robot)
    elif how == "deactivation":
        assert twin.control.manager(robot).switch_controller(deactivate=[controller])
    else:
        twin.publish(f"/{robot}/{controller}/commands", zero)


def assert_stops_joint_by_joint(scene, how):
    twin = scene.twin
    for joint in range(len(scene.joints)):
        twin.reset()
        speed = min(SPEED, scene.limits[joint].velocity)
        scene.move_one(joint, speed)
        start, bound = scene.positions[joint], scene.stopping_distance(joint, speed)
        stop(twin, "arm", "driver", how, [0.0] * len(scene.joints))
        farthest = start
        while twin.time < 0.7:
            twin.step()
            farthest = max(farthest, scene.positions[joint])
        assert farthest - start <= 1.2 * bound
        # It rests there; joints that it has pushed out of the way push back while they brake, too.
        assert scene.positions[joint] == pytest.approx(farthest, abs=1e-2)
        assert np.abs(scene.velocities).max() < 1e-2
        twin.control.manager("arm").switch_controller(activate=["driver"])
        twin.control.clear_emergency_stop("arm")


# The sample: every engine, every way to stop, every arm, but not all at once.


@pytest.mark.parametrize(
    ("name", "engine", "how"),
    [
        ("arduinobot", "1ms", STOPS[1]),
        ("arduinobot", "cenic", STOPS[0]),
        ("ur5", "10ms", STOPS[0]),
        ("xarm7", "cenic", STOPS[2]),
    ],
)
def test_a_joint_stops_within_the_distance_that_its_effort_allows(tmp_path, name, engine, how):
    assert_stops_joint_by_joint(ArmScene(tmp_path, name, engine), how)


@pytest.mark.slow
@every_engine
@pytest.mark.parametrize("name", ARMS)
@pytest.mark.parametrize("how", STOPS)
def test_any_joint_of_any_arm_stops_within_the_distance_that_its_effort_allows(tmp_path, name, engine, how):
    assert_stops_joint_by_joint(ArmScene(tmp_path, name, engine), how)


# Rovers


def driving(folder, engine, effort, tilt=0.0):
    """A twin with a base of four wheels that rolls down a slope at 1 m/s, or one of the repository's rovers."""
    if effort is None:
        twin = TwinBuilder(**ENGINES[engine]).robot("base", ROVER, xyz=(0, 0, 0.13)).build()
    else:
        text = four_wheels(roll="-1.5708").replace('effort="20"', f'effort="{effort}"')
        scene = Scene(folder, engine, plane(tilt))
        twin = scene.add("base", text, on_slope(tilt, z=RADIUS), (0, tilt, 0)).build()
    twin.advance_to(0.5)
    twin.publish("/base/forward_velocity_controller/commands", [1.0 / RADIUS] * 4)
    twin.advance_to(2.0)
    return twin


@every_engine
@pytest.mark.parametrize(("effort", "how"), [(None, STOPS[0]), (20.0, STOPS[1]), (0.5, STOPS[2])])
def test_a_rover_stops_within_the_distance_that_its_motors_and_the_ground_allow(tmp_path, engine, effort, how):
    twin = driving(tmp_path, engine, effort)
    start, speed = position(twin, "base"), np.linalg.norm(twin.entities.state("base").linear)
    context = twin.plant.GetMyContextFromRoot(twin.context)
    mass = twin.plant.CalcTotalMass(context, [twin.plant.GetModelInstanceByName("base")])
    efforts = sum(joint.limits.effort for joint in twin.built.plans[0].description.actuated_joints)
    stop(twin, "base", "forward_velocity_controller", how, [0.0] * 4)
    heights, tilts = [], []
    while twin.time < 4.0:
        twin.advance_to(twin.time + 0.01)
        heights.append(position(twin, "base")[2])
        _, x, y, _ = twin.entities.state("base").orientation
        tilts.append(2 * asin(hypot(x, y)))
    way = np.linalg.norm(position(twin, "base") - start)
    assert way <= 1.2 * speed**2 / (2 * min(G, efforts / (RADIUS * mass)))
    assert max(tilts) < 0.01
    assert np.abs(np.array(heights) - start[2]).max() < 1e-3
    assert np.linalg.norm(twin.entities.state("base").linear) < 1e-4


@every_engine
def test_the_wheels_of_a_rover_on_a_slope_do_not_creep_at_a_command_of_zero(tmp_path, engine):
    twin = driving(tmp_path, engine, 20.0, tilt=0.2)
    twin.publish("/base/forward_velocity_controller/commands", [0.0] * 4)
    twin.advance_to(3.0)
    before = np.array(twin.robot_state("base").positions)
    twin.advance_to(8.0)  # wheels that are braced against each other on the ground relax by 1e-4
    assert np.mean(np.array(twin.robot_state("base").positions) - before) == pytest.approx(0.0, abs=1e-4)


# Holding


def assert_holds(scene, seconds, most):
    """Holds an arm at commands of zero that come again and again."""
    twin = scene.twin
    scene.publish([0.3] * len(scene.joints))
    twin.advance_to(0.2)
    scene.publish([0.0] * len(scene.joints))
    twin.advance_to(3.0)
    before = scene.positions
    for _ in range(50):
        scene.publish([0.0] * len(scene.joints))
        twin.advance_to(twin.time + 0.01)
    twin.advance_to(twin.time + seconds)
    assert np.abs(scene.positions - before).max() < most


@pytest.mark.parametrize(("name", "engine"), [("arduinobot", "10ms"), ("ur5", "cenic")])
def test_a_velocity_of_zero_holds_an_arm_under_gravity_for_a_minute(tmp_path, name, engine):
    assert_holds(ArmScene(tmp_path, name, engine), 60.0, 1e-5)


@pytest.mark.slow
@every_engine
@pytest.mark.parametrize("name", ["arduinobot", "ur5"])
def test_a_velocity_of_zero_holds_an_arm_under_gravity_for_an_hour(tmp_path, name, engine):
    assert_holds(ArmScene(tmp_path, name, engine), 600.0 if engine == "1ms" else 3600.0, 1e-5)


@every_engine
def test_a_command_ends_the_hold_at_once_and_without_a_jump(tmp_path, engine):
    scene = ArmScene(tmp_path, "arduinobot", engine)
    scene.publish_one(0, 0.0)
    scene.twin.advance_to(1.0)
    scene.publish_one(0, 0.2)
    velocities = []
    while scene.twin.time < 1.1:
        scene.twin.step()
        velocities.append(scene.velocities[0])
    assert min(velocities) > -1e-4
    assert max(velocities) < 0.2 * 1.01
    assert velocities[-1] == pytest.approx(0.2, rel=0.01)
    assert scene.twin.time - len([v for v in velocities if v > 0.18]) * scene.twin.clock.time_step < 1.03


@every_engine
def test_an_arm_that_is_pushed_away_is_held_where_that_leaves_it(tmp_path, engine):
    scene = ArmScene(tmp_path, "ur5", engine)
    scene.publish([0.0] * 6)
    scene.twin.advance_to(1.0)
    before = scene.positions[0]
    scene.twin.entities.apply_wrench("arm::forearm_link", force=(0.0, 800.0, 0.0), duration=0.3)
    scene.twin.advance_to(1.6)
    pushed = scene.positions[0]
    assert abs(pushed - before) > 0.5
    scene.twin.advance_to(5.0)
    assert scene.positions[0] == pytest.approx(pushed, abs=0.02)


@every_engine
def test_a_joint_that_is_put_somewhere_stays_there_at_a_velocity_of_zero(tmp_path, engine):
    scene = ArmScene(tmp_path, "arduinobot", engine)
    scene.publish([0.0] * 4)
    scene.twin.advance_to(0.5)
    scene.twin.entities.set_joint_positions("arm", {"joint_1": 0.9})
    scene.twin.advance_to(1.5)
    assert scene.positions[0] == pytest.approx(0.9, abs=1e-4)


DIFF_DRIVE = """controller_manager:
  ros__parameters: {update_rate: 100, drive: {type: diff_drive_controller/DiffDriveController}}
drive:
  ros__parameters:
    left_wheel_names: [front_left_joint, rear_left_joint]
    right_wheel_names: [front_right_joint, rear_right_joint]
    wheel_separation: 0.4
    wheel_radius: 0.1
    cmd_vel_timeout: 9.0
    linear: {x: {max_acceleration: 2.0, max_deceleration: -2.0}}
"""


@every_engine
def test_wheels_are_held_and_let_go_of_as_their_controller_stops_and_starts(tmp_path, engine):
    (tmp_path / "drive.yaml").write_text(DIFF_DRIVE)

    def driven(slices):
        scene = Scene(tmp_path, engine, plane())
        scene.add("base", four_wheels(roll="-1.5708"), (0, 0, RADIUS), controllers=tmp_path / "drive.yaml")
        twin = scene.build()
        for speed in (0.5, 0.0, -0.5):
            twin.publish("/base/drive/cmd_vel", {"twist": {"linear": {"x": speed}}})
            until = twin.time + 1.0
            while twin.time < until - 1e-9:
                twin.advance_to(min(until, twin.time + slices))
            assert np.array(twin.robot_state("base").velocities) == pytest.approx(speed / RADIUS, abs=0.02)
            actuators = [twin.plant.get_joint_actuator(index) for index in twin.plant.GetJointActuatorIndices()]
            stiff = [actuator.get_controller_gains().p > 1.0 for actuator in actuators]
            assert stiff == [speed == 0.0] * 4
        return twin.state_sha256()

    assert driven(1.0) == driven(0.03)


# The way to a position


def assert_keeps_its_velocity_limit(scene, controller, joint, distance):
    twin = scene.twin
    twin.advance_to(0.3)
    goal = scene.positions.copy()
    goal[joint] += distance
    goal_of(scene, controller, goal)
    fastest, farthest, way = 0.0, 0.0, []
    while twin.time < 0.3 + abs(distance) / scene.limits[joint].velocity + 2.0:
        twin.step()
        fastest = max(fastest, abs(scene.velocities[joint]))
        way.append((scene.positions[joint] - goal[joint]) * np.sign(distance))
        farthest = max(farthest, way[-1])
    assert fastest <= 1.01 * scene.limits[joint].velocity
    assert fastest >= 0.85 * scene.limits[joint].velocity
    assert farthest <= 1e-3
    assert way[-1] == pytest.approx(0.0, abs=1e-3)


def goal_of(scene, controller, goal):
    """Commands a position at once."""
    if controller == "position":
        scene.publish(goal)
    else:
        points = [{"positions": goal.tolist(), "time_from_start": {"sec": 0, "nanosec": 10_000_000}}]
        scene.twin.publish("/arm/driver/joint_trajectory", {"joint_names": scene.joints, "points": points})


@pytest.mark.parametrize(
    ("name", "engine", "controller", "joint", "distance"),
    [
        ("arduinobot", "1ms", "position", 0, -1.5),
        ("arduinobot", "cenic", "trajectory", 1, -1.5),
        ("ur5", "10ms", "trajectory", 0, 3.0),
        ("ur5", "cenic", "position", 3, -2.5),
    ],
)
def test_a_far_position_is_approached_within_the_velocity_limit(tmp_path, name, engine, controller, joint, distance):
    assert_keeps_its_velocity_limit(ArmScene(tmp_path, name, engine, controller), controller, joint, distance)


@pytest.mark.slow
@every_engine
@pytest.mark.parametrize("controller", ["position", "trajectory"])
@pytest.mark.parametrize(
    ("name", "joint", "distance"),
    [("arduinobot", 0, -1.5), ("arduinobot", 1, -1.5), ("ur5", 0, 3.0), ("ur5", 3, -2.5), ("xarm7", 0, 3.0)],
)
def test_any_far_position_is_approached_within_the_velocity_limit(tmp_path, engine, controller, name, joint, distance):
    assert_keeps_its_velocity_limit(ArmScene(tmp_path, name, engine, controller), controller, joint, distance)


@pytest.mark.parametrize("controller", ["position", "trajectory"])
def test_a_joint_without_a_velocity_limit_is_as_fast_as_its_servo(tmp_path, controller):
    scene = ArmScene(tmp_path, "ur5", "10ms", controller, limited=False)
    goal_of(scene, controller, scene.positions + 3.0 * np.eye(6)[0])
    fastest = 0.0
    while scene.twin.time < 1.0:
        scene.twin.step()
        fastest = max(fastest, scene.velocities[0])
    assert fastest > 4.0  # the file's own limit is 3.15 rad/s


# Repeatability


@every_engine
def test_a_stop_is_repeated_to_the_last_bit_whoever_looks_and_from_any_moment_of_it(tmp_path, engine):
    def stopping():
        scene = ArmScene(tmp_path, "arduinobot", engine)
        scene.twin.recorder.begin()
        scene.publish([1.0, 0.5, -0.5, 0.0])
        scene.twin.advance_to(0.2)
        scene.publish([0.0] * 4)
        return scene.twin

    plain, watched = stopping(), stopping()
    plain.advance_to(0.5)
    watched.subscribe("/clock", lambda message: None, rate=90)
    while watched.time < 0.5 - 1e-9:
        watched.step()
    assert watched.state_sha256() == plain.state_sha256()
    assert replay(plain.recorder.recording()).state_sha256() == plain.state_sha256()
    if engine == "cenic":  # its step size is not in a snapshot
        return
    again = stopping()
    again.advance_to(0.21)
    saved = again.snapshot()
    again.advance_to(0.5)
    watched.restore(saved)
    watched.advance_to(0.5)
    assert watched.state_sha256() == again.state_sha256() == plain.state_sha256()
