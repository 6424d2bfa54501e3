"""The panel of topics, without a browser, against what the twin publishes."""

import json

import pytest
import yaml
from conftest import ARM, rovers
from fake_page import FakePage
from robots_to_steer import TRAJECTORY, arm_with_trajectories

from drake_twin import InputError, TwinBuilder
from drake_twin.cockpit import protocol
from drake_twin.cockpit.message_fields import field_rows, number_at
from drake_twin.cockpit.topics_panel import TopicsPanel
from drake_twin.messages import message

STATES = "/robot_1/joint_states"
COMMANDS = "/robot_1/forward_velocity_controller/commands"
WHEEL = "robot_1_rear_left_wheel_joint"


@pytest.fixture
def twin():
    return rovers(2).command(COMMANDS, [1.0, 2.0, 3.0, 4.0]).build()


def look(panel, version=0, echo="", frames=False):
    panel.ask({"do": "Look", "version": version, "echo": echo, "frames": frames})


def publish(panel, topic, text):
    panel.ask({"do": "Publish", "topic": topic, "text": text, "key": "k"})
    return panel.state()["outcome"]


def plot(panel, field, topic=STATES):
    panel.ask({"do": "Plot", "topic": topic, "field": field})
    return panel.state()


def listeners(twin):
    return sorted(item.topic for item in twin._session.subscriptions._items)


def test_fields_have_paths_with_the_names_of_joints():
    states = message("sensor_msgs/msg/JointState", {"name": ["a", "b/c.d"], "position": [1.5, -2.0], "velocity": [3.0]})
    rows = {path: (text, is_number) for path, text, is_number in field_rows(states)}
    assert rows["position[a]"] == ("1.5", True)
    assert rows["position[b/c.d]"] == ("-2", True)
    assert rows["velocity[0]"] == ("3", True)  # not one for each joint
    assert rows["name[0]"] == ("a", False)
    assert rows["effort"] == ("0 elements", False)
    assert number_at(states, "position[b/c.d]") == -2.0
    assert number_at(states, "velocity[0]") == 3.0
    assert number_at(states, "header.stamp.sec") == 0.0
    for path in ("position[c]", "position", "name[0]", "mass", "position[9]"):
        with pytest.raises(InputError):
            number_at(states, path)


def test_names_of_a_message_name_the_fields_of_those_in_it():
    state = message(
        "control_msgs/msg/JointTrajectoryControllerState",
        {"joint_names": ["a", "b"], "feedback": {"positions": [1.0, 2.0]}},
    )
    assert number_at(state, "feedback.positions[b]") == 2.0
    assert ("feedback.positions[b]", "2", True) in [*field_rows(state)]


def test_nobody_looks_and_nothing_is_subscribed(twin):
    panel = TopicsPanel(twin)
    twin.advance_to(0.1)
    assert panel.state() is None
    assert panel._heard == {}
    look(panel, echo=STATES)
    panel.state()
    assert [*panel._heard] == [STATES]
    for _ in range(100):
        last = panel.state()
    assert last is None
    assert panel._heard == {}


def test_nothing_is_subscribed_without_a_browser(twin):
    it = FakePage(twin)
    it.ask(protocol.AskPanel("topics", json.dumps({"do": "Plot", "topic": "/clock", "field": "clock.sec"})))
    assert it.state["panels"]["topics"]["layout"]
    assert "/clock" in listeners(twin)
    it.server.clients = ()
    it.cockpit.process_requests()
    assert "/clock" not in listeners(twin)
    it.cockpit.close()


def test_the_layout_is_kept_for_robots_of_these_names_and_files(twin):
    layouts = set()
    arm = TwinBuilder().robot("robot_1", ARM).build()
    for other in (twin, rovers(2).build(), rovers(1).build(), arm):
        panel = TopicsPanel(other)
        look(panel)
        layouts.add(panel.state()["layout"])
    assert len(layouts) == 3


def test_why_a_curve_has_no_samples_is_said(twin):
    panel = TopicsPanel(twin)
    plot(panel, "x", "/nothing")
    plot(panel, "velocity[9]")
    assert plot(panel, "velocity[0]")["problems"] == {"/nothing.x": "Nothing is published on /nothing."}
    twin.advance_to(0.1)
    state = panel.state()
    assert state["problems"][f"{STATES}.velocity[9]"] == f"{STATES}: the message has no field 'velocity[9]' now."
    assert f"{STATES}.velocity[0]" not in state["problems"]


def test_samples_that_nobody_takes_and_requests_are_bounded(twin):
    twin.clock.set_time_step(0.01)
    panel = TopicsPanel(twin)
    plot(panel, "clock.nanosec", "/clock")
    twin.advance_to(12.0)
    (batch,) = panel.state()["batches"]
    times = [time for time, _ in batch["samples"]["/clock.clock.nanosec"]]
    assert (len(times), times[-1]) == (500, pytest.approx(11.98))
    for number in range(300):
        panel.ask({"do": "Plot", "topic": "/clock", "field": f"x{number}"})
        look(panel, echo=f"/x{number}")
    panel.state()
    assert len(panel._looks) == 120
    assert len(panel._heard["/clock"].pending) == 100


def test_the_list_is_what_the_twin_has_and_comes_once(twin):
    panel = TopicsPanel(twin)
    look(panel)
    listing = {(item["kind"], item["name"]): item["type"] for item in panel.state()["topics"]}
    assert listing == {(item.kind, item.name): item.type for item in twin.graph.endpoints}
    panel = TopicsPanel(twin)
    panel.state()
    look(panel, version=1)
    assert panel.state()["topics"] is None
    twin.entities.delete("robot_2")
    listing = panel.state()["topics"]
    assert listing
    assert all(item["robot"] != "robot_2" for item in listing)


def test_the_echo_is_the_last_message(twin):
    panel = TopicsPanel(twin)
    look(panel, echo=STATES)
    panel.state()
    twin.advance_to(0.5)
    echo = panel.state()["echoes"][STATES]
    rows = {path: text for path, text, _ in echo["rows"]}
    assert echo["time"] == pytest.approx(0.5, abs=0.021)
    index = twin.latest(STATES).name.index(WHEEL)
    assert float(rows[f"velocity[{WHEEL}]"]) == pytest.approx(twin.latest(STATES).velocity[index], abs=0.1)
    assert echo["form"] is None
    assert echo["rate"] == 100.0
    twin.reset()
    twin.advance_to(0.025)
    echo = panel.state()["echoes"][STATES]
    assert (echo["time"], echo["rate"]) == (pytest.approx(0.02), 100.0)


def test_a_paused_twin_has_an_echo_too(twin):
    twin.advance_to(0.1)
    twin.pause()
    panel = TopicsPanel(twin)
    look(panel, echo=STATES)
    echo = panel.state()["echoes"][STATES]
    assert echo["time"] is None
    assert (f"velocity[{WHEEL}]", f"{twin.latest(STATES).velocity[2]:.6g}", True) in [
        tuple(row) for row in echo["rows"]
    ]


def test_samples_come_with_four_snapshots_and_are_those_of_the_messages(twin):
    heard = []
    twin.subscribe(STATES, lambda it: heard.append(float(it.velocity[it.name.index(WHEEL)])), 50.0)
    panel = TopicsPanel(twin)
    key = f"{STATES}.velocity[{WHEEL}]"
    numbers = []
    for frame in range(1, 9):
        panel.ask({"do": "Plot", "topic": STATES, "field": f"velocity[{WHEEL}]"})
        batches = panel.state()["batches"]
        numbers.append([batch["number"] for batch in batches])
        twin.advance_to(0.1 * frame)
    assert numbers[-1] == [4, 5, 6, 7]
    samples = [value for batch in panel.state()["batches"] for _, value in batch["samples"][key]]
    assert samples == pytest.approx(heard[-len(samples) :], abs=1e-8)
    assert len(samples) == 20


def test_a_form_publishes_what_it_says(twin):
    panel = TopicsPanel(twin)
    look(panel, echo=COMMANDS)
    assert panel.state()["echoes"][COMMANDS]["form"]["text"] == "data: [0.0, 0.0, 0.0, 0.0]\n"
    twin.advance_to(0.1)
    panel = TopicsPanel(twin)
    look(panel, echo=COMMANDS)
    echo = panel.state()["echoes"][COMMANDS]
    assert echo["form"]["text"] == "data: [1.0, 2.0, 3.0, 4.0]\n"
    assert echo["form"]["fields"]["data"] == [1.0, 2.0, 3.0, 4.0]
    assert echo["form"]["labels"] == [f"{claim.joint} velocity" for claim in twin.graph.command_limits(COMMANDS)]
    assert ("data[3]", "4", True) in echo["rows"]
    outcome = publish(panel, COMMANDS, "data:\n- 4\n- 3\n- 2\n- 1\n")
    assert outcome == {"key": "k", "problem": "", "text": "Published at 0.100 s."}
    twin.advance_to(0.2)
    assert list(twin.graph.command(COMMANDS).data) == [4.0, 3.0, 2.0, 1.0]


def test_what_nobody_hears_is_said(twin):
    twin.control.manager("robot_1").switch_controller((), ["forward_velocity_controller"], 2)
    panel = TopicsPanel(twin)
    look(panel)
    text = publish(panel, COMMANDS, "data: [1, 1, 1, 1]")["text"]
    assert text == "Published at 0.000 s. forward_velocity_controller is not active and does not hear it."


def test_a_published_message_is_recorded(twin):
    noted = []
    twin.recorder.listeners.append(lambda name, arguments: noted.append((name, arguments[0])))
    panel = TopicsPanel(twin)
    look(panel)
    publish(panel, COMMANDS, "data: [5, 5, 5, 5]")
    assert noted == [("publish", COMMANDS)]


@pytest.mark.parametrize(
    ("topic", "text", "why"),
    [
        (COMMANDS, "data: [", "this is not YAML"),
        (COMMANDS, "data: [.nan, 0, 0, 0]", "nan"),
        (COMMANDS, "speeds: [1]", "no field speeds"),
        ("/nowhere", "data: [1]", "/nowhere"),
    ],
)
def test_what_does_not_fit_is_refused(twin, topic, text, why):
    panel = TopicsPanel(twin)
    look(panel)
    outcome = publish(panel, topic, text)
    assert why in outcome["problem"]
    assert outcome["text"] == ""
    with pytest.raises(InputError, match=why):
        panel.ask({"do": "Publish", "topic": topic, "text": text, "key": ""})
    assert twin.graph.command(COMMANDS) is None


def test_the_form_of_a_trajectory_holds_the_joints_where_they_are(tmp_path):
    twin = arm_with_trajectories(tmp_path).build()
    panel = TopicsPanel(twin)
    twin.advance_to(0.1)
    look(panel, echo=TRAJECTORY)
    form = panel.state()["echoes"][TRAJECTORY]["form"]["text"]
    data = yaml.safe_load(form)
    assert data["joint_names"] == ["joint_1", "joint_2", "joint_3"]
    here = [number for name, number in zip(*joints_of(twin), strict=True) if name in data["joint_names"]]
    assert data["points"][0]["positions"] == pytest.approx(here)
    publish(panel, TRAJECTORY, form.replace(str(data["points"][0]["positions"][0]), "0.5"))
    twin.advance_to(3.0)
    assert joints_of(twin)[1][0] == pytest.approx(0.5, abs=0.05)


def joints_of(twin):
    state = twin.robot_state("arm")
    return state.joints, state.positions


def test_frames_are_those_of_tf(twin):
    panel = TopicsPanel(twin)
    look(panel, frames=True)
    twin.advance_to(0.5)
    frames = {item["frame"]: item for item in panel.state()["frames"]}
    base = frames["robot_1_base_link"]
    assert base["xyz"] == pytest.approx(twin.entities.state("robot_1").position, abs=1e-3)
    assert frames["robot_1_rear_left_wheel"]["parent"] == "robot_1_base_link"
    assert not base["static"]
    for version in range(1, 4):  # the page asks again and again, while the twin is paused
        look(panel, version, frames=True)
        shown = [found for found in (panel.state()["frames"] for _ in range(10)) if found is not None]
        assert {item["frame"] for item in shown[-1]} == set(frames)


def test_frames_come_at_once_and_with_each_fourth_snapshot(twin):
    panel = TopicsPanel(twin)
    look(panel)
    assert panel.state()["frames"] is None
    look(panel, frames=True)
    came = [panel.state()["frames"] is not None for _ in range(9)]
    assert came == [True, False, False, False, True, False, False, False, True]


def test_the_diagram_is_drawn_beside_the_simulation(twin):
    panel = TopicsPanel(twin)
    look(panel)
    panel.ask({"do": "Draw"})
    panel._drawing.join()
    drawn = [panel.state()["diagram"] for _ in range(6)]
    assert drawn[4:] == [None, None]
    assert all("<svg" in item["svg"] or "dot" in item["problem"] for item in drawn[:4])
