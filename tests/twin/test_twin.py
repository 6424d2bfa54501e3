from types import SimpleNamespace

import numpy as np
import pytest
from conftest import ARM, ROVER, rovers
from living import living
from pydrake.systems.framework import LeafSystem

from drake_twin import TwinBuilder, World, messages
from drake_twin.errors import CommandError, InputError, RunError
from drake_twin.twin.event_topics import PARAMETER_EVENTS, ROSOUT

WHEELS_1 = "/robot_1/forward_velocity_controller/commands"
WHEELS_2 = "/robot_2/forward_velocity_controller/commands"


@pytest.fixture
def twin():
    return rovers().build()


def wheel_velocities(twin, robot="robot_1"):
    return np.array(twin.robot_state(robot).velocities)


def full_state(twin, robot):
    state = twin.robot_state(robot)
    return np.array([*state.positions, *state.velocities, *state.base_pose])


# --- robots move, hold, and do not move when another is commanded


def test_wheels_on_the_ground_reach_their_command_within_half_a_second(twin):
    twin.publish(WHEELS_1, [5, 5, 5, 5])
    twin.advance_to(0.5)
    assert np.all(np.abs(wheel_velocities(twin) - 5) < 0.005 * 5)


def test_a_commanded_rover_drives_forward_and_the_other_stays(twin):
    twin.publish(WHEELS_1, [5, 5, 5, 5])
    twin.advance_to(2.0)
    assert twin.robot_state("robot_1").base_pose[0] == pytest.approx(0.1 * 5 * 2.0, rel=0.05)
    assert abs(twin.robot_state("robot_2").base_pose[0]) < 1e-6


def test_opposite_sides_turn_the_rover_on_the_spot(twin):
    twin.publish(WHEELS_1, [-4, 4, -4, 4])
    twin.advance_to(1.0)
    x, y, _, qw, _, _, qz = twin.robot_state("robot_1").base_pose
    assert np.hypot(x, y) < 0.02
    assert 2 * np.arctan2(qz, qw) > 0.5


@pytest.mark.parametrize(("own", "bound"), [([0, 0, 0, 0], 1e-8), ([3, 5, 3, 5], 1e-6)], ids=["standing", "driving"])
def test_commanding_one_robot_leaves_the_other_as_it_was(own, bound):
    states = []
    for command in ([0, 0, 0, 0], [6, 2, 6, 2]):
        twin = rovers(spacing=3.0).build()
        twin.publish(WHEELS_1, command)
        twin.publish(WHEELS_2, own)
        twin.advance_to(2.0)
        states.append(full_state(twin, "robot_2"))
    assert np.abs(states[1] - states[0]).max() < bound


def test_a_rover_that_drives_into_another_pushes_it():
    builder = TwinBuilder()
    builder.robot("robot_1", ROVER, xyz=(0, 0, 0.13)).robot("robot_2", ROVER, xyz=(1.0, 0, 0.13))
    twin = builder.build()
    twin.publish(WHEELS_1, [5, 5, 5, 5])
    twin.advance_to(0.5)
    assert abs(twin.robot_state("robot_2").base_pose[0] - 1.0) < 1e-3  # not touched yet
    twin.advance_to(3.0)
    first, second = (twin.robot_state(robot).base_pose[0] for robot in twin.robots)
    assert second > 1.05
    assert second - first > 0.5  # two half lengths, and wheels: they do not run through each other


def test_rovers_whose_paths_do_not_cross_stay_apart():
    twin = rovers(spacing=1.0).build()
    for topic in (WHEELS_1, WHEELS_2):
        twin.publish(topic, [5, 5, 5, 5])
    twin.advance_to(2.0)
    first, second = (np.array(twin.robot_state(robot).base_pose[:3]) for robot in twin.robots)
    assert np.abs(second - first - (0, 1.0, 0)).max() < 1e-6


def test_a_standing_rover_does_not_creep_sink_or_shake(twin):
    twin.advance_to(0.2)
    before = full_state(twin, "robot_1")
    twin.advance_to(3.0)
    assert np.abs(full_state(twin, "robot_1") - before).max() < 1e-4


def test_the_arm_without_ros2_control_droops():
    twin = TwinBuilder().robot("arm", ARM, xacro_args={"use_ros2_control": False}).build()
    twin.advance_to(2.0)
    positions = dict(zip(twin.robot_state("arm").joints, twin.robot_state("arm").positions, strict=True))
    assert positions["joint_3"] > 0.5
    assert twin.built.commanded == {}


@pytest.mark.parametrize("active", [None, []], ids=["claimed", "unclaimed"])
def test_the_arm_with_ros2_control_holds_its_start_position(active):
    start = {"joint_2": 0.4, "joint_3": -0.3}
    twin = TwinBuilder().robot("arm", ARM, initial_positions=start, active_controllers=active).build()
    before = np.array(twin.robot_state("arm").positions)
    twin.advance_to(5.0)
    assert np.abs(np.array(twin.robot_state("arm").positions) - before).max() < 0.01


def test_the_right_finger_mimics_the_left():
    twin = TwinBuilder().robot("arm", ARM, initial_positions={"joint_4": 0.2}).build()
    assert twin.robot_state("arm").positions[-1] == pytest.approx(-0.2)
    twin.publish("/arm/forward_velocity_controller/commands", [0, 0, 0, 0.5])
    twin.advance_to(1.0)
    left, right = twin.robot_state("arm").positions[-2:]
    assert left > 0.6
    assert right == pytest.approx(-left, abs=1e-3)


def test_a_command_beyond_the_limits_is_driven_up_to_the_joints_as_in_gazebo(twin):
    # ros2_control allows 15, which nobody enforces; the joint allows 20, as Gazebo's physics do.
    twin.publish(WHEELS_1, [30, 30, 30, 30])
    twin.advance_to(2.0)
    assert wheel_velocities(twin) == pytest.approx([20] * 4, rel=0.005)


def test_an_arm_spawned_away_from_the_origin_stands_there():
    twin = TwinBuilder().robot("arm", ARM, xyz=(1, 2, 0.5), rpy=(0, 0, np.pi / 2)).build()
    twin.advance_to(0.1)
    assert twin.robot_state("arm").base_pose[:3] == pytest.approx((1, 2, 0.5))


# --- publish, subscribe, time


def test_a_command_takes_effect_at_the_next_step(twin):
    twin.step()
    twin.publish(WHEELS_1, [5, 5, 5, 5])
    before = wheel_velocities(twin)
    twin.step()
    assert np.all(wheel_velocities(twin) > before + 0.1)


def test_a_command_from_inside_a_callback_takes_effect_at_the_next_step():
    stamps = {}
    for when in ("callback", "between"):
        twin = rovers(1).build()

        def stop_or_go(message, twin=twin):
            if message.clock.nanosec == 100_000_000:
                twin.publish(WHEELS_1, [5, 5, 5, 5])

        if when == "callback":
            twin.subscribe("/clock", stop_or_go, rate=100)
        else:
            twin.advance_to(0.1)
            twin.publish(WHEELS_1, [5, 5, 5, 5])
        twin.advance_to(0.5)
        stamps[when] = twin.state_sha256()
    assert stamps["callback"] == stamps["between"]


def test_a_command_that_is_not_one_changes_nothing(twin):
    twin.publish(WHEELS_1, [1, 1, 1, 1])
    with pytest.raises(CommandError, match=r"/robot_1/.*robot_1_front_right_wheel_joint/velocity is nan"):
        twin.publish(WHEELS_1, [5, np.nan, 5, 5])
    with pytest.raises(CommandError, match="is not a list of numbers"):
        twin.publish(WHEELS_1, ["fast", 1, 1, 1])
    twin.advance_to(1.0)
    assert wheel_velocities(twin) == pytest.approx([1] * 4, rel=0.005)


def test_publishing_where_nobody_listens_names_the_topics_that_exist(twin):
    with pytest.raises(InputError, match=r"nothing listens to '/robot_3/.*Did you mean '/robot_\d/.*Valid: /robot_1/"):
        twin.publish("/robot_3/forward_velocity_controller/commands", [1, 1, 1, 1])


@pytest.mark.parametrize(
    ("rate", "expected"), [(50, 50), (100, 100), (1000, 1000), (3000, 1000), (30, 30), (1e12, 1000)]
)
def test_a_subscriber_is_called_at_its_rate_of_simulation_time(twin, rate, expected):
    seen = []
    twin.subscribe("/clock", seen.append, rate=rate)
    twin.advance_to(1.0)
    assert len(seen) == expected
    assert seen[0].clock.nanosec == 0


def test_messages_do_not_depend_on_how_the_time_was_cut(twin):
    stamps = []
    twin.subscribe("/clock", lambda message: stamps.append(message.clock.nanosec), rate=30)
    whole, cut = [], []
    twin.advance_to(0.5)
    whole, stamps[:] = stamps[:], []
    twin.reset()
    for time in np.arange(0.007, 0.5, 0.0073):
        twin.advance_to(time)
    twin.advance_to(0.5)
    cut = stamps
    assert cut == whole


def test_a_subscription_made_on_the_way_and_ended_again(twin):
    seen = []
    twin.advance_to(0.105)
    end = twin.subscribe("/clock", lambda message: seen.append(message.clock.nanosec), rate=100)
    twin.advance_to(0.125)
    end()
    twin.advance_to(0.2)
    assert seen == [105_000_000, 110_000_000, 120_000_000]


def test_what_never_changes_is_delivered_once(twin):
    seen = []
    twin.subscribe("/robot_1/robot_description", seen.append)
    twin.subscribe("/tf_static", seen.append)
    twin.advance_to(1.0)
    assert len(seen) == 2
    assert "<robot" in seen[0].data


def test_subscribing_to_no_topic_names_the_topics(twin):
    with pytest.raises(InputError, match=r"nothing is published on '/joint_states'.*/robot_1/joint_states"):
        twin.subscribe("/joint_states", print)


def test_pausing_inside_a_callback_stops_there_and_playing_goes_on(twin):
    def stop(message):
        if message.clock.nanosec == 200_000_000:
            twin.pause()

    twin.subscribe("/clock", stop, rate=100)
    assert twin.advance_to(1.0) == pytest.approx(0.2)
    assert twin.advance_to(1.0) == pytest.approx(0.2)
    assert twin.step(3) == pytest.approx(0.203)
    twin.play()
    assert twin.advance_to(1.0) == pytest.approx(1.0)


def test_time_is_counted_in_whole_steps(twin):
    assert twin.advance_to(0.0105) == pytest.approx(0.011)
    for count in range(12, 112):
        assert twin.step() == pytest.approx(0.001 * count)
    assert twin.clock.step_count == 111


def test_the_past_and_no_time_at_all_are_refused(twin):
    twin.advance_to(0.1)
    with pytest.raises(InputError, match=r"0\.05 s lies in the past: the twin is at 0\.1 s"):
        twin.advance_to(0.05)
    with pytest.raises(InputError, match="nan is not a simulation time"):
        twin.advance_to(float("nan"))
    with pytest.raises(InputError, match="must be at least 1"):
        twin.step(0)


def test_an_exception_in_a_callback_reaches_the_caller_and_the_twin_goes_on(twin):
    def fail(message):
        raise KeyError("mine")

    end = twin.subscribe("/clock", fail, rate=10)
    with pytest.raises(KeyError, match="mine"):
        twin.advance_to(1.0)
    end()
    assert twin.advance_to(1.0) == pytest.approx(1.0)


# --- repeatable to the last bit


def drive(twin, until=1.0):
    twin.publish(WHEELS_1, [5, 2, 5, 2])
    twin.advance_to(until)
    return twin.state_sha256()


def test_two_twins_of_one_scenario_end_in_the_same_bits():
    assert drive(rovers().build()) == drive(rovers().build())


def test_reset_goes_back_to_the_same_bits(twin):
    first = drive(twin)
    for _ in range(5):
        twin.reset()
        assert twin.time == 0
        assert twin.graph.command(WHEELS_1) is None
        assert drive(twin) == first


def test_listening_and_cutting_the_time_change_nothing(twin):
    alone = drive(rovers().build())
    for topic in twin.graph.topics():
        if topic not in twin.built.commanded:
            twin.subscribe(topic, lambda message: None, rate=77)
    twin.publish(WHEELS_1, [5, 2, 5, 2])
    for step in range(1, 101):
        twin.advance_to(0.01 * step)
    assert twin.state_sha256() == alone


def test_the_hash_tells_commands_and_states_apart(twin):
    at_start = twin.state_sha256()
    twin.step()
    moved = twin.state_sha256()
    twin.publish(WHEELS_1, [0, 0, 0, 0])
    twin.step()
    other = rovers().build()
    other.step(2)
    assert len({at_start, moved, twin.state_sha256(), other.state_sha256()}) == 4


# --- topics and messages


def test_topics_are_named_and_typed_as_in_ros(twin):
    topics = twin.graph.topics()
    assert topics["/robot_1/joint_states"] == "sensor_msgs/msg/JointState"
    assert topics["/robot_2/dynamic_joint_states"] == "control_msgs/msg/DynamicJointState"
    assert topics["/robot_1/robot_description"] == "std_msgs/msg/String"
    assert topics["/robot_1/ground_truth/odom"] == "nav_msgs/msg/Odometry"
    assert topics["/tf"] == topics["/tf_static"] == "tf2_msgs/msg/TFMessage"
    assert topics["/clock"] == "rosgraph_msgs/msg/Clock"
    assert topics[WHEELS_1] == "std_msgs/msg/Float64MultiArray"


def test_every_message_serialises_to_ros_wire_format(twin):
    store = messages.type_store()
    twin.advance_to(0.1)
    for topic, kind in twin.graph.topics().items():
        if topic not in (*twin.built.commanded, ROSOUT, PARAMETER_EVENTS):  # nothing has happened yet
            assert store.serialize_cdr(twin.latest(topic), kind)


def test_joint_states_say_what_the_joints_do(twin):
    twin.publish(WHEELS_1, [1, 2, 3, 4])
    twin.advance_to(1.0)
    message = twin.joint_states("robot_1")
    assert message.name[0] == "robot_1_front_left_wheel_joint"
    assert message.velocity == pytest.approx([1, 2, 3, 4], rel=0.01)
    assert np.all(np.abs(message.effort) <= 10.0)
    assert np.all(message.position > 0)


def test_an_unknown_robot_is_named_with_those_that_exist(twin):
    with pytest.raises(InputError, match=r"unknown robot 'robot_3'.*Valid: robot_1, robot_2"):
        twin.joint_states("robot_3")


def parents(*twin_messages):
    found = {}
    for message in twin_messages:
        for transform in message.transforms:
            assert transform.child_frame_id not in found, f"{transform.child_frame_id} has two parents"
            found[transform.child_frame_id] = transform.header.frame_id
    return found


@pytest.mark.parametrize("model", [ROVER, ARM], ids=["rover", "arm"])
def test_two_robots_of_one_file_share_no_frame_and_all_hang_on_the_world(model):
    twin = TwinBuilder().robot("robot_1", model, xyz=(0, 0, 0.13)).robot("robot_2", model, xyz=(0, 2, 0.13)).build()
    tree = parents(twin.latest("/tf"), twin.latest("/tf_static"))
    assert sum(frame.startswith("robot_1") for frame in tree) == sum(frame.startswith("robot_2") for frame in tree)
    for frame in tree:
        while frame in tree:
            frame = tree[frame]
        assert frame == "world"


def test_a_base_frame_that_a_static_transform_places_is_not_broadcast_as_well():
    twin = rovers(1).static_transform("map", "robot_1_base_link").build()
    tree = parents(twin.latest("/tf"), twin.latest("/tf_static"))
    assert tree["robot_1_base_link"] == "map"
    assert twin.latest("/robot_1/ground_truth/odom").child_frame_id == "robot_1_base_link"


def test_frames_that_two_robots_would_share_are_refused():
    with pytest.raises(InputError, match=r"'a' and 'b' would both publish the frame 'base_link'"):
        TwinBuilder().robot("a", ARM, frame_prefix="").robot("b", ARM, frame_prefix="").build()


# --- the scenario's own commands


def test_timed_commands_are_published_at_their_time_and_again_each_period():
    builder = rovers(1).command(WHEELS_1, [1] * 4).command(WHEELS_1, [3] * 4, time=0.5, period=1.0)
    twin = builder.command(WHEELS_1, [2] * 4, time=1.0, period=1.0).build()
    seen = []
    for time in (0.4, 0.9, 1.4, 1.9, 2.4):
        twin.advance_to(time)
        seen.append(float(twin.graph.command(WHEELS_1).data[0]))
    assert seen == [1, 3, 2, 3, 2]


def test_a_silenced_topic_no_longer_gets_the_scenarios_commands_until_reset():
    twin = rovers(1).command(WHEELS_1, [1] * 4, period=0.1).build()
    twin.advance_to(0.05)
    twin.graph.silence(WHEELS_1)
    twin.publish(WHEELS_1, [2] * 4)
    twin.advance_to(0.5)
    assert twin.graph.command(WHEELS_1).data[0] == 2
    twin.reset()
    twin.advance_to(0.05)
    assert twin.graph.command(WHEELS_1).data[0] == 1


def test_a_wrong_command_in_the_scenario_is_refused_when_the_twin_is_built():
    with pytest.raises(InputError, match=r"commands\.0: .*3 elements, but there are 4 command interfaces"):
        rovers(1).command(WHEELS_1, [1, 1, 1]).build()


# --- real time


def test_run_ends_at_its_time_and_looks_after_each_frame(twin):
    frames = []
    twin.run(0.5, each_frame=lambda: frames.append(twin.time) or True, as_fast_as_possible=True)
    assert twin.time == pytest.approx(0.5)
    assert frames[0] == 0


def test_run_stops_when_told_to(twin):
    twin.run(None, each_frame=lambda: twin.time < 0.2, as_fast_as_possible=True)
    assert 0.2 <= twin.time < 5.0


def test_run_in_real_time_grants_each_frame_its_share_of_steps(twin):
    twin.clock.real_time_rate = 0.5
    times = []
    twin.run(0.1, each_frame=lambda: times.append(twin.time) or True)
    steps = np.diff(times) / twin.scenario.time_step
    assert np.all(np.abs(steps - 0.5 / 30 * 1000) <= 1.0 + 1e-6)


@pytest.mark.parametrize(("away", "made_up_for"), [(0.2, 0.2), (5.0, 0.25)])
def test_a_short_absence_of_the_processor_costs_no_simulated_time_and_a_long_one_is_not_run_after(
    twin, monkeypatch, away, made_up_for
):
    wall = SimpleNamespace(now=0.0, frames=0)

    def sleep(duration):
        wall.now += duration

    def each_frame():
        wall.frames += 1
        wall.now += away if wall.frames == 10 else 0.0
        return wall.now < 1.0 + away

    monkeypatch.setattr(
        "drake_twin.twin.real_time.wall_clock", SimpleNamespace(perf_counter=lambda: wall.now, sleep=sleep)
    )
    twin.run(each_frame=each_frame)
    assert twin.time == pytest.approx(1.0 + made_up_for, abs=2 / 30)


def test_a_paused_run_lets_no_time_pass(twin):
    frames = []

    def each_frame():
        frames.append(twin.time)
        return len(frames) < 5

    twin.pause()
    twin.run(1.0, each_frame=each_frame)
    assert frames == [0.0] * 5


# --- what a trial user stumbled over


@pytest.mark.parametrize(
    "options", [{"xyz": (np.nan, 0, 0)}, {"rpy": (0, np.inf, 0)}, {"initial_positions": {"joint_1": np.nan}}]
)
def test_a_nan_in_a_robots_start_never_reaches_the_plant(options):
    with pytest.raises(InputError, match=r"robots\.0\..*(nan|inf) is not a finite number"):
        TwinBuilder().robot("arm", ARM, **options).build()


@pytest.mark.parametrize("options", [{"xyz": (0, 0, 1e308)}, {"rpy": (0, -1e13, 0)}])
def test_a_robot_that_starts_too_far_away_is_refused(options):
    with pytest.raises(InputError, match=r"robots\.0\..*out of bounds: valid are -1e\+12 to 1e\+12"):
        TwinBuilder().robot("arm", ARM, **options).build()


def test_a_nan_in_the_world_or_in_a_frame_never_reaches_the_plant():
    from drake_twin.scenario import World

    with pytest.raises(InputError, match=r"world\.gravity\.2: nan is not a finite number"):
        rovers(1, world=World(gravity=(0, 0, np.nan))).scenario()
    with pytest.raises(InputError, match=r"static_transforms\.0\.xyz\.0: nan is not a finite number"):
        rovers(1).static_transform("world", "a", xyz=(np.nan, 0, 0)).scenario()


def test_static_transforms_in_a_circle_are_refused():
    with pytest.raises(InputError, match="form a circle through"):
        rovers(1).static_transform("a", "b").static_transform("b", "a").scenario()
    with pytest.raises(InputError, match="in a circle: robot_1_base_link in robot_1_rear_left_wheel"):
        rovers(1).static_transform("robot_1_rear_left_wheel", "robot_1_base_link").build()


def test_a_name_that_begins_like_a_link_is_no_prefix():
    twin = TwinBuilder().robot("fore", ARM).build()
    assert [plan.base_frame for plan in twin.built.plans] == ["fore/world"]


def test_a_published_message_cannot_be_changed_for_others(twin):
    message = twin.joint_states("robot_1")
    with pytest.raises(ValueError, match="read-only"):
        message.position[0] = 99.0


def test_a_subscription_that_another_callback_ends_does_not_fire_again(twin):
    seen = []
    ends = []
    twin.subscribe("/clock", lambda message: ends[0](), rate=10)
    ends.append(twin.subscribe("/clock", seen.append, rate=10))
    twin.advance_to(0.5)
    assert seen == []


@pytest.mark.parametrize(
    "call", [lambda twin: twin.advance_to(1.0), lambda twin: twin.step(), lambda twin: twin.reset()]
)
def test_a_callback_cannot_advance_or_reset_the_twin_that_calls_it(twin, call):
    twin.subscribe("/clock", lambda message: call(twin), rate=10)
    with pytest.raises(InputError, match="a callback cannot"):
        twin.advance_to(0.5)


@pytest.mark.parametrize(
    "call",
    [
        lambda twin: twin.step(1.5),
        lambda twin: twin.advance_to("1"),
        lambda twin: twin.advance_to(1e300),
        lambda twin: twin.run(float("nan")),
        lambda twin: twin.subscribe("/clock", print, rate=float("inf")),
        lambda twin: twin.subscribe("/clock", print, rate=1e-320),
        lambda twin: setattr(twin.clock, "real_time_rate", 0),
        lambda twin: twin.robot_state(3),
        lambda twin: twin.entities.set_joint_positions("robot_1", {"knee": 1.0}),
        lambda twin: twin.entities.set_joint_positions("robot_1", {"robot_1_rear_left_wheel_joint": np.nan}),
    ],
)
def test_a_call_that_makes_no_sense_is_refused_in_words(twin, call):
    with pytest.raises(InputError) as error:
        call(twin)
    assert str(error.value)


def test_joints_can_be_put_somewhere_without_physics():
    twin = TwinBuilder().robot("arm", ARM).build()
    twin.entities.set_joint_positions("arm", {"joint_2": 0.4})
    assert twin.robot_state("arm").positions[1] == 0.4
    assert twin.time == 0


# --- joint friction and self-collision

PENDULUM = """<robot name="p"><link name="world"/><link name="bob"><inertial><origin xyz="0 0 -1"/><mass value="1"/>
<inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial></link><joint name="j" type="continuous">
<parent link="world"/><child link="bob"/><axis xyz="0 1 0"/><dynamics friction="{friction}"/></joint></robot>"""


def pendulum(tmp_path, friction, **options):
    (tmp_path / "p.urdf").write_text(PENDULUM.format(friction=friction))
    return TwinBuilder().robot("p", tmp_path / "p.urdf", initial_positions={"j": 0.1}, **options).build()


def test_joint_friction_holds_what_is_lighter_and_lets_go_what_is_heavier(tmp_path):
    # m g l sin(0.1) = 0.98 N·m
    holds, slips = pendulum(tmp_path, 1.2), pendulum(tmp_path, 0.5)
    for twin in (holds, slips):
        twin.advance_to(1.0)
    assert holds.robot_state("p").positions[0] == pytest.approx(0.1, abs=2e-3)
    assert slips.robot_state("p").positions[0] < 0.09


def test_joint_friction_slows_a_swing_as_coulomb_friction_does(tmp_path):
    """Against the equation of motion, integrated by SciPy."""
    from scipy.integrate import solve_ivp

    friction, inertia, torque = 0.3, 0.1 + 1.0, 9.81
    twin = pendulum(tmp_path, friction)
    twin.entities.set_joint_positions("p", {"j": 1.0})
    twin.advance_to(0.5)

    def falling(_, state):
        return [state[1], (-torque * np.sin(state[0]) + friction) / inertia]

    exact = solve_ivp(falling, (0, 0.5), [1.0, 0.0], rtol=1e-9, atol=1e-12).y[0, -1]
    assert twin.robot_state("p").positions[0] == pytest.approx(exact, abs=5e-3)


def test_joint_friction_can_be_left_out(tmp_path):
    twin = pendulum(tmp_path, 1.2, without_repairs=["joint_friction"])
    twin.advance_to(0.8)
    assert twin.robot_state("p").positions[0] < 0.0


OVERLAPPING = """<robot name="o"><link name="world"/>
<link name="a"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1"/></inertial>
  <collision><geometry><box size="0.2 0.2 0.2"/></geometry></collision></link>
<link name="b"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1"/></inertial>
  <collision><geometry><box size="0.2 0.2 0.2"/></geometry></collision></link>
<joint name="ja" type="prismatic"><parent link="world"/><child link="a"/><origin xyz="0 0 1"/><axis xyz="1 0 0"/>
  <limit lower="-5" upper="5"/></joint>
<joint name="jb" type="prismatic"><parent link="world"/><child link="b"/><origin xyz="0.15 0 1"/><axis xyz="1 0 0"/>
  <limit lower="-5" upper="5"/></joint>{gazebo}</robot>"""
COLLIDES = '<gazebo reference="{}"><selfCollide>true</selfCollide></gazebo>'


@pytest.mark.parametrize(
    ("gazebo", "options", "apart"),
    [
        ("", {}, False),
        (COLLIDES.format("a"), {}, False),
        (COLLIDES.format("a") + COLLIDES.format("b"), {}, True),
        ("", {"self_collision": True}, True),
        (COLLIDES.format("a") + COLLIDES.format("b"), {"self_collision": False}, False),
    ],
    ids=["as in Gazebo", "one link asks", "both links ask", "the scenario asks", "the scenario forbids"],
)
def test_links_of_one_robot_collide_only_where_they_are_told_to(tmp_path, gazebo, options, apart):
    (tmp_path / "o.urdf").write_text(OVERLAPPING.format(gazebo=gazebo))
    twin = TwinBuilder().robot("o", tmp_path / "o.urdf", **options).build()
    twin.advance_to(1.0)
    a, b = twin.robot_state("o").positions
    assert (0.15 + b - a > 0.16) == apart


FIXED = '<joint name="{0}" type="fixed"><parent link="{1}"/><child link="{2}"/></joint>'
MOVED = """<joint name="{0}" type="prismatic"><parent link="{1}"/><child link="{2}"/><origin xyz="0 0 {4}"/>
<axis xyz="{3}"/><limit lower="-99" upper="9" effort="1" velocity="100"/></joint>"""
HEAVY = '<inertial><mass value="1"/><inertia ixx=".1" iyy=".1" izz=".1"/></inertial>'
SHAPE = '<collision><geometry><box size=".4 .4 .4"/></geometry></collision>'


@pytest.mark.parametrize(
    ("between", "kept", "height"),
    [(False, "", -18.6098), (True, "", 0.39968), (False, "p", 0.39968), (False, "t", 0.39968)],
)
def test_what_is_fixed_to_two_links_with_a_joint_does_not_collide(tmp_path, between, kept, height):
    """The heights after 2 s are those of DART 6.12 behind gz-physics 5; Gazebo's reader folds the fixed links.

    Not those of a joint with ``<preserveFixedJoint>``.
    """
    links = {"base": "", "plate": SHAPE, "arm": "", "tip": SHAPE, **({"m": ""} if between else {})}
    text = '<link name="world"/>' + "".join(
        f'<link name="{name}">{HEAVY}{shape}</link>' for name, shape in links.items()
    )
    text += FIXED.format("w", "world", "base") + FIXED.format("p", "base", "plate") + FIXED.format("t", "arm", "tip")
    text += MOVED.format("x", "base", "m", "1 0 0", "0") if between else ""
    text += MOVED.format("z", "m" if between else "base", "arm", "0 0 1", "1")
    if kept:
        text += f'<gazebo reference="{kept}"><preserveFixedJoint>true</preserveFixedJoint></gazebo>'
    (tmp_path / "r.urdf").write_text(f'<robot name="r">{text}</robot>')
    builder = TwinBuilder(world=World(gravity=(0.0, 0.0, -9.8), ground=False))
    twin = builder.robot("r", tmp_path / "r.urdf", self_collision=True).build()
    twin.advance_to(2.0)
    assert 1.0 + twin.robot_state("r").positions[-1] == pytest.approx(height, abs=1.1e-2 if height < 0 else 4e-4)


INERTIAL = "<inertial><mass>1</mass><inertia><ixx>.1</ixx><iyy>.1</iyy><izz>.1</izz></inertia></inertial>"
BLOCK = '<collision name="c"><geometry><box><size>.4 .4 .4</size></box></geometry></collision>'
SLIDES = """<joint name="{}" type="prismatic"><parent>{}</parent><child>{}</child><axis><xyz>{}</xyz></axis></joint>"""


@pytest.mark.parametrize(
    ("model", "below", "above", "height"),
    [
        ("", "", "", -18.6098),
        ("<self_collide>true</self_collide>", "", "", 0.39968),
        ("<self_collide>1</self_collide>", "", "<self_collide>0</self_collide>", -18.6098),
        ("", "<self_collide>1</self_collide>", "<self_collide>true</self_collide>", 0.39968),
    ],
)
def test_links_of_sdf_collide_where_model_or_both_links_are_told_to(tmp_path, model, below, above, height):
    """The heights after 2 s are those of gz-physics 5 with DART 6.12, which does not read the links' own flags."""
    joints = SLIDES.format("x", "a", "m", "1 0 0") + SLIDES.format("z", "m", "b", "0 0 1")
    (tmp_path / "r.sdf").write_text(
        f"""<sdf version="1.9"><model name="r">{model}<link name="a">{INERTIAL}{BLOCK}{below}</link>
<link name="m">{INERTIAL}</link><link name="b"><pose>0 0 1 0 0 0</pose>{INERTIAL}{BLOCK}{above}</link>
<joint name="w" type="fixed"><parent>world</parent><child>a</child></joint>{joints}</model></sdf>"""
    )
    twin = TwinBuilder(world=World(gravity=(0.0, 0.0, -9.8), ground=False)).robot("r", tmp_path / "r.sdf").build()
    assert twin.findings == ()
    twin.advance_to(2.0)
    assert 1.0 + twin.robot_state("r").positions[1] == pytest.approx(height, abs=1.1e-2 if height < 0 else 4e-4)


def test_a_subscription_made_in_a_callback_begins_with_the_present_message(twin):
    seen = []

    def first(message):
        if not seen:
            twin.subscribe("/clock", lambda message: seen.append(message.clock.nanosec), rate=10)

    twin.subscribe("/clock", first, rate=0.5)
    twin.advance_to(0.25)
    assert seen == [0, 100_000_000, 200_000_000]


def test_the_command_that_holds_is_a_message_that_can_be_published_again():
    twin = rovers(2).build()
    topic = "/robot_1/forward_velocity_controller/commands"
    twin.publish(topic, [1, 2, 1, 2])
    for advance in (0.1, 0.2):  # waiting, then on its port
        message = twin.graph.command(topic)
        assert message.data.tolist() == [1, 2, 1, 2]
        twin.publish(topic.replace("robot_1", "robot_2"), message)
        twin.advance_to(advance)
    other = twin.robot_state("robot_2").velocities
    assert twin.robot_state("robot_1").velocities == pytest.approx(other, abs=1e-12)


def test_a_twin_may_be_closed_twice():
    twin = rovers(1).build()
    twin.close()
    twin.close()


@pytest.mark.parametrize(
    "use",
    [
        lambda twin: twin.advance_to(1.0),
        lambda twin: twin.step(),
        lambda twin: twin.robot_state("robot_1"),
        lambda twin: twin.publish("/robot_1/forward_velocity_controller/commands", [1.0, 1.0, 1.0, 1.0]),
        lambda twin: twin.reset(),
        lambda twin: twin.graph.topics(),
        lambda twin: twin.plant,
    ],
)
def test_a_closed_twin_says_that_it_is_closed(use):
    twin = rovers(1).build()
    twin.close()
    with pytest.raises(RunError, match="the twin is closed"):
        use(twin)


def test_a_closed_twin_is_freed():
    before = living(LeafSystem)
    for _ in range(3):
        with rovers(1).build() as twin:
            twin.advance_to(0.01)
        del twin
    assert living(LeafSystem) == before


def test_the_simulated_time_counts_what_was_before_a_reset(twin):
    before = twin.clock.simulated
    twin.advance_to(0.5)
    snapshot = twin.snapshot()
    twin.reset()
    twin.advance_to(0.2)
    twin.restore(snapshot)
    twin.step(100)
    assert twin.clock.simulated - before == pytest.approx(0.8)
    assert twin.time == pytest.approx(0.6)
