"""What the page asks for and what it is told, without a browser."""

import logging

import pytest
from conftest import ARM, ROVER, rovers
from fake_page import FakePage
from robots_to_steer import CMD_VEL, TRAJECTORY, WHEELS_1, arm_with_trajectories, driven_rovers

from drake_twin import TwinBuilder
from drake_twin.cockpit import protocol, stepping
from drake_twin.cockpit.scene import Scene
from drake_twin.scenario import Robot


@pytest.fixture(scope="module")
def scene():
    return Scene()


@pytest.fixture
def page(scene):
    """Two rovers that stand still."""
    page = FakePage(rovers(2).build(), scene)
    yield page
    page.cockpit.close()


# --- time


def test_pause_and_play(page):
    page.ask(protocol.Pause())
    assert page.twin.clock.paused
    assert page.state["paused"] is True
    page.ask(protocol.Play())
    assert not page.twin.clock.paused


def test_steps_are_made_at_once_and_the_twin_stays_paused(page):
    page.ask(protocol.Step(7))
    assert page.twin.clock.step_count == 7
    assert page.twin.clock.paused
    assert page.state["steps"] == 7


def test_many_steps_are_made_in_parts_and_a_stop_comes_between_them(page, monkeypatch):
    monkeypatch.setattr(stepping, "_LONGEST", 0.0)  # one part a frame
    page.ask(protocol.Step(10_000))
    assert page.twin.clock.step_count == 10
    page.ask(protocol.EmergencyStop("robot_1"))
    assert page.twin.control.is_stopped("robot_1")
    assert page.twin.clock.step_count == 20  # they go on: the robot is stopped, and not the time
    page.ask(protocol.Pause())
    page.cockpit.process_requests()
    assert page.twin.clock.step_count == 20
    page.ask(protocol.Step(10), protocol.Step(5))
    page.cockpit.process_requests()
    assert page.twin.clock.step_count == 35


@pytest.mark.parametrize("request_", [protocol.Play(), protocol.Reset(), protocol.RunTo(5.0)])
def test_what_moves_the_time_otherwise_ends_the_steps(page, monkeypatch, request_):
    monkeypatch.setattr(stepping, "_LONGEST", 0.0)
    page.ask(protocol.Step(10_000), request_)
    page.cockpit.process_requests()
    assert page.twin.clock.step_count in (0, 10)


def test_what_a_callback_may_do_is_done_within_the_advance_that_it_meets(page):
    page.cockpit.process_requests()  # a browser is connected
    asked = page.twin.time + 0.02
    stopped = []

    def each_step(message):
        if page.twin.time == pytest.approx(asked):
            page.server.ask(protocol.EmergencyStop("robot_1"))
        if page.twin.control.is_stopped("robot_1"):
            stopped.append(page.twin.time)

    page.twin.subscribe("/clock", each_step, 1000)
    page.twin.advance_to(asked + 0.1)
    assert stopped[0] <= asked + 0.006


def test_what_a_callback_may_not_do_waits_for_the_frame_and_what_follows_it_too(page):
    page.cockpit.process_requests()
    done = []

    def each_frame():
        if not done:
            page.server.ask(protocol.Reset())
            page.server.ask(protocol.EmergencyStop("robot_1"))
            page.twin.inbox.look()
            done.append((page.twin.control.is_stopped("robot_1"), [text for _, text in page.cockpit._log.as_plain()]))
            return True
        page.cockpit.process_requests()
        return False

    page.twin.run(each_frame=each_frame, as_fast_as_possible=True)
    assert not done[0][0]
    assert page.twin.control.is_stopped("robot_1")
    assert not any("refused" in text for level, text in page.messages)


def test_nobody_looks_into_the_inbox_for_a_page_without_browsers(page):
    page.cockpit.process_requests()
    assert page.twin.inbox.is_open
    page.server.clients = ()
    page.cockpit.process_requests()
    assert not page.twin.inbox.is_open
    page.server.clients = (2,)
    page.cockpit.process_requests()
    page.cockpit.close()
    assert not page.twin.inbox.is_open


@pytest.mark.parametrize("time", [0.25, 0.1234, 1.0])
def test_run_to_pauses_at_that_step_and_no_other(page, time):
    page.ask(protocol.Step(3), protocol.RunTo(time))
    page.frames(until=lambda: page.twin.clock.paused)
    assert page.twin.clock.step_count == round(time / 0.001 + 0.4999)
    page.ask(protocol.Play())
    page.frames(until=lambda: page.twin.time > 2.5 * time)  # it holds once


def test_a_page_that_is_closed_pauses_nothing_any_more(page):
    page.ask(protocol.RunTo(0.1), protocol.Play())
    page.cockpit.close()
    page.twin.advance_to(0.2)
    assert not page.twin.clock.paused


def test_the_last_run_to_counts(page):
    page.ask(protocol.RunTo(0.1), protocol.RunTo(0.3))
    page.frames(until=lambda: page.twin.clock.paused)
    assert page.twin.time == pytest.approx(0.3)


def test_running_to_the_past_is_refused_in_words(page):
    page.twin.advance_to(0.2)
    page.ask(protocol.RunTo(0.1))
    assert not page.twin.clock.paused
    assert any("lies in the past" in text for level, text in page.messages if level == "error")


def test_reset_begins_anew(page):
    page.ask(protocol.MoveJoint(WHEELS_1, 0, 3.0))
    page.twin.advance_to(0.2)
    page.ask(protocol.Reset())
    assert page.twin.time == 0
    assert page.state["commands"][WHEELS_1] == [0, 0, 0, 0]


def test_the_speed_is_set_and_a_speed_that_is_none_is_refused(page):
    page.ask(protocol.SetRate(0.5))
    assert page.twin.clock.real_time_rate == 0.5
    page.ask(protocol.SetRate(0.0))
    assert page.twin.clock.real_time_rate == 0.5
    assert page.state
    assert any("above zero" in text for level, text in page.messages if level == "error")


# --- joints and controllers


def test_a_slider_drives_that_wheel_and_no_other_robot(page):
    page.ask(protocol.MoveJoint(WHEELS_1, 2, 3.0))
    page.twin.advance_to(0.01)
    assert page.twin.graph.command(WHEELS_1).data.tolist() == [0, 0, 3, 0]
    assert page.twin.graph.command(WHEELS_1.replace("1", "2")) is None
    assert page.state["commands"][WHEELS_1] == [0, 0, 3, 0]


def test_a_slider_moved_while_paused_acts_when_time_goes_on(page):
    page.ask(protocol.Pause(), protocol.MoveJoint(WHEELS_1, 2, 3.0), protocol.MoveJoint(WHEELS_1, 0, 1.0))
    assert page.state["commands"][WHEELS_1] == [1, 0, 3, 0]
    page.twin.play()
    page.twin.advance_to(0.01)
    assert page.twin.graph.command(WHEELS_1).data.tolist() == [1, 0, 3, 0]


def test_sliders_show_commands_that_came_from_elsewhere(page):
    page.twin.publish(WHEELS_1, [1, 2, 3, 4])
    page.twin.advance_to(0.01)
    assert page.state["commands"][WHEELS_1] == [1, 2, 3, 4]


def test_whoever_moves_a_slider_takes_over_from_the_scenario(scene):
    page = FakePage(rovers(1).command(WHEELS_1, [1] * 4, period=0.1).build(), scene)
    page.twin.advance_to(0.05)
    page.ask(protocol.MoveJoint(WHEELS_1, 2, 3.0))
    page.twin.advance_to(0.5)
    assert page.twin.graph.command(WHEELS_1).data.tolist() == [1, 1, 3, 1]


@pytest.mark.parametrize("request_", [protocol.MoveJoint("/x", 0, 1.0), protocol.MoveJoint(WHEELS_1, 4, 1.0)])
def test_a_slider_that_is_not_there_changes_nothing(page, request_):
    page.ask(request_)
    page.twin.step()
    assert page.twin.graph.command(WHEELS_1) is None
    assert page.state
    assert page.messages[-1][0] == "error"


def test_sliders_have_the_interfaces_unit_and_limits(page):
    assert page.state
    (group,) = page.robots["robot_1"]["groups"]
    assert {slider["unit"] for slider in group["sliders"]} == {"rad/s"}
    limit = page.twin.graph.command_limits(WHEELS_1)
    for slider, (lower, upper) in zip(group["sliders"], limit.values(), strict=True):
        assert (slider["lower"], slider["upper"]) == (max(lower, -20), min(upper, 20))


def test_a_controller_is_switched_off_and_on(page):
    page.ask(protocol.Switch("robot_1", "forward_velocity_controller", False))
    assert page.state["robots"]["robot_1"]["controllers"]["forward_velocity_controller"] == "inactive"
    assert "forward_velocity_controller" in page.twin.control.manager("robot_2").active
    page.ask(protocol.Switch("robot_1", "forward_velocity_controller", True))
    assert "forward_velocity_controller" in page.twin.control.manager("robot_1").active


def test_a_switch_that_the_manager_refuses_is_said(page):
    page.ask(protocol.Switch("robot_1", "no_such_controller", True))
    assert page.state
    assert any("robot_1: " in text and "no_such_controller" in text for _, text in page.messages)


def test_an_emergency_stop_refuses_commands_until_it_is_cleared(page):
    page.ask(protocol.EmergencyStop("robot_1"), protocol.MoveJoint(WHEELS_1, 0, 3.0))
    page.twin.advance_to(0.05)
    assert page.twin.graph.command(WHEELS_1) is None
    assert page.state["robots"]["robot_1"]["stopped"] is True
    assert page.state["robots"]["robot_2"]["stopped"] is False
    assert any("emergency stop" in text for _, text in page.messages)
    page.ask(protocol.ClearEmergencyStop("robot_1"), protocol.MoveJoint(WHEELS_1, 0, 3.0))
    page.twin.advance_to(0.1)
    assert page.twin.graph.command(WHEELS_1).data[0] == 3.0


def test_an_arm_that_follows_trajectories_goes_where_its_slider_is(scene, tmp_path):
    page = FakePage(arm_with_trajectories(tmp_path).build(), scene)
    assert page.state
    (group,) = page.robots["arm"]["groups"]
    assert [slider["unit"] for slider in group["sliders"]] == ["rad"] * 3
    page.ask(protocol.MoveJoint(TRAJECTORY, 1, 0.3))
    page.twin.advance_to(0.05)
    page.ask(protocol.MoveJoint(TRAJECTORY, 0, 0.2))  # the other joint still goes where it was told to
    page.twin.advance_to(4.0)
    assert page.twin.robot_state("arm").positions[:3] == pytest.approx((0.2, 0.3, 0.0), abs=0.02)
    assert page.state["commands"][TRAJECTORY] == [0.2, 0.3, 0.0]


# --- driving


@pytest.fixture
def driven(scene, tmp_path):
    page = FakePage(driven_rovers(tmp_path).build(), scene)
    yield page
    page.cockpit.close()


def test_a_base_drives_as_long_as_the_browser_says_so(driven):
    for _ in range(10):
        driven.ask(protocol.Drive(CMD_VEL, 0.5, 0.0, 0.0))
        driven.twin.advance_to(driven.twin.time + 0.1)
    assert driven.twin.robot_state("robot_1").base_pose[0] > 0.3


def test_a_base_stops_when_the_browser_falls_silent(driven):
    driven.ask(protocol.Drive(CMD_VEL, 0.5, 0.0, 0.0))
    driven.twin.advance_to(0.1)
    sent = []
    for _ in range(30):
        driven.cockpit.process_requests()
        sent.append(driven.twin.graph.command(CMD_VEL).linear_x)
        driven.twin.step(20)
    assert sent[0] == 0.5
    assert sent[-1] == 0.0


def test_a_base_stops_when_its_drivers_browser_is_closed_and_not_when_another_one_is(driven):
    driven.ask(protocol.Drive(CMD_VEL, 0.5, 0.0, 0.0), client=1)
    driven.ask(protocol.Gone(), client=2)
    assert driven.twin.graph.command(CMD_VEL).linear_x == 0.5
    driven.ask(protocol.Gone(), client=1)
    assert driven.twin.graph.command(CMD_VEL).linear_x == 0.0


def test_driving_while_paused_does_not_pile_up(driven):
    driven.twin.pause()
    for _ in range(50):
        driven.ask(protocol.Drive(CMD_VEL, 0.5, 0.0, 0.0))
    assert driven.twin.graph.command(CMD_VEL) is None


def test_only_drives_can_be_driven(driven):
    driven.ask(protocol.Drive(WHEELS_1, 1.0, 0.0, 0.0))
    assert driven.state
    assert any("does not drive a base" in text for _, text in driven.messages)


# --- what is told


def test_nothing_is_told_while_nobody_is_connected(page):
    page.server.clients = ()
    page.cockpit.process_requests()
    page.cockpit.process_requests()
    assert page.server.told == {}
    page.server.clients = (1,)
    page.cockpit.process_requests()
    assert page.server.told.keys() == {"robots", "messages", "state", "timeline"}


def test_a_second_browser_is_told_everything_and_the_robots_are_not_told_again(page):
    assert page.state
    page.server.told.clear()
    assert page.state
    assert page.server.told.keys() == {"state"}
    page.server.clients = (1, 2)
    page.cockpit.process_requests()
    assert page.server.told.keys() == {"robots", "messages", "state", "timeline"}


def test_the_state_tells_positions_velocities_efforts_and_where_each_robot_is(page):
    page.ask(protocol.MoveJoint(WHEELS_1, 0, 3.0))
    page.twin.advance_to(0.5)
    assert page.state["robots"]["robot_1"]["efforts"] is None  # nobody looks at them
    page.ask(protocol.LookAtEfforts())
    told, state = page.state["robots"]["robot_1"], page.twin.robot_state("robot_1")
    assert told["positions"] == pytest.approx(state.positions, abs=1e-6)
    assert told["velocities"] == pytest.approx(state.velocities, abs=1e-6)
    assert told["efforts"] == pytest.approx(state.efforts, abs=1e-6)
    assert told["pose"] == pytest.approx(state.base_pose, abs=1e-6)


def test_warnings_of_the_build_and_of_the_run_are_on_the_message_line(scene, tmp_path):
    file = tmp_path / "ghost.urdf"
    file.write_text('<robot name="ghost"><link name="a"><inertial><mass value="1"/></inertial></link></robot>')
    page = FakePage(TwinBuilder().robot("ghost", file).build(), scene)
    logging.getLogger("drake_twin.anything").warning("the %s", "run")
    logging.getLogger("drake_twin.anything").warning("the %s", "run")
    assert page.state
    assert any("no collision shape" in text for _, text in page.messages)
    assert page.messages[-1] == ("warning", "the run")
    assert page.server.told["messages"][-1]["times"] == 2
    page.cockpit.close()
    logging.getLogger("drake_twin.anything").warning("after the end")
    assert page.cockpit._log.as_plain()[-1]["text"] == "the run"


def test_what_the_page_asks_and_looks_at_does_not_change_the_run(scene):
    """The same commands at the same steps, with an open page and overlays, and without: the same bits."""
    plain = rovers(2).build()
    plain.advance_to(0.2)
    plain.publish(WHEELS_1, [0, 0, 3, 0])
    plain.advance_to(0.5)
    page = FakePage(rovers(2).build(), scene)
    page.ask(*[protocol.Show(what, True) for what in ("frames", "contacts", "collision", "inertia")])
    page.ask(protocol.RunTo(0.2))
    page.frames(until=lambda: page.twin.clock.paused)
    page.ask(protocol.MoveJoint(WHEELS_1, 2, 3.0), protocol.RunTo(0.5))
    page.frames(until=lambda: page.twin.clock.paused)
    assert page.twin.state_sha256() == plain.state_sha256()
    page.cockpit.close()


# --- robots that are only displayed


def test_joints_of_a_robot_that_is_only_displayed_go_where_their_sliders_are(scene):
    twin = TwinBuilder().robot("arm", ARM).build()
    twin.pause()
    page = FakePage(twin, scene, only_displayed=True)
    page.ask(protocol.PoseJoint("arm", "joint_4", 0.3), protocol.Play(), protocol.Step(3))
    assert twin.robot_state("arm").positions[-2:] == pytest.approx((0.3, -0.3))  # and the one that follows it
    assert twin.time == 0
    assert twin.clock.paused
    assert page.state["robots"]["arm"]["positions"][-1] == pytest.approx(-0.3)
    follows = {joint["joint"]: joint["follows"] for joint in page.robots["arm"]["joints"]}
    assert [name for name, follower in follows.items() if not follower] == ["joint_1", "joint_2", "joint_3", "joint_4"]


@pytest.mark.parametrize(
    "request_", [protocol.PoseJoint("x", "joint_1", 0.0), protocol.PoseJoint("arm", "joint_5", 0.0)]
)
def test_a_joint_that_cannot_be_posed(scene, request_):
    page = FakePage(TwinBuilder().robot("arm", ARM).build(), scene, only_displayed=True)
    page.ask(request_)
    assert page.state
    assert page.messages[-1][0] == "error"


# --- robots come and go


def test_a_spawned_robot_has_controls_and_a_deleted_one_has_none(page):
    assert list(page.state["robots"]) == ["robot_1", "robot_2"]
    page.ask(protocol.Show("collision", True))
    page.twin.entities.spawn(Robot("robot_3", ROVER, xyz=(3.0, 0.0, 0.13)))
    assert "robot_3" in page.state["robots"]
    assert page.robots["robot_3"]["groups"]
    page.ask(protocol.MoveJoint(WHEELS_1.replace("1", "3"), 0, 2.0), protocol.Follow("robot_3"))
    page.twin.advance_to(0.05)
    assert page.state["followed"] == "robot_3"
    page.ask(protocol.Delete("robot_3"))
    assert list(page.state["robots"]) == ["robot_1", "robot_2"]
    assert list(page.robots) == ["robot_1", "robot_2"]
    assert page.state["followed"] == ""
    page.ask(protocol.MoveJoint(WHEELS_1.replace("1", "3"), 0, 2.0))
    assert page.state
    assert page.messages[-1][0] == "error"


def test_the_physics_step_is_changed_while_it_runs(page):
    page.twin.advance_to(0.1)
    page.ask(protocol.SetTimeStep(0.01))
    page.twin.advance_to(0.2)
    assert page.state["time_step"] == 0.01
    page.ask(protocol.SetTimeStep(0.0))
    assert page.state["time_step"] == 0.01
    assert page.messages[-1][0] == "error"


def test_a_time_that_nobody_lives_to_see_is_no_place_to_run_to(page):
    page.ask(protocol.RunTo(1e308))
    assert page.messages[-1] == ("error", "1e+308 s is not a simulation time: 1e+09 s is the longest.")


def test_of_robots_that_no_tab_shows_it_is_told_only_whether_they_are_stopped():
    it = FakePage(rovers(3).build())
    assert all("positions" in robot for robot in it.state["robots"].values())  # no tab has said what it shows
    it.ask(protocol.LookAtRobots(("robot_2",)), protocol.EmergencyStop("robot_3"))
    state = it.state
    assert state["robots"]["robot_1"] == {"stopped": False}
    assert state["robots"]["robot_3"] == {"stopped": True}
    assert len(state["robots"]["robot_2"]["positions"]) == 4
    assert list(state["commands"]) == ["/robot_2/forward_velocity_controller/commands"]
    it.ask(protocol.LookAtRobots(("robot_1",)), client=2)
    assert [name for name, robot in it.state["robots"].items() if "positions" in robot] == ["robot_1", "robot_2"]
    for _ in range(200):
        it.cockpit.process_requests()
    assert not any("positions" in robot for robot in it.state["robots"].values())
    assert protocol.parse('{"do": "LookAtRobots", "robots": ["robot_1", "robot_2"]}') == protocol.LookAtRobots(
        ("robot_1", "robot_2")
    )
    assert protocol.parse('{"do": "LookAtRobots", "robots": "robot_1"}') is None
    it.cockpit.close()
