"""The states of the page: one table, through which the tests of accessibility and of the keyboard go."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import pytest
from browser import folder, open_tab
from conftest import ROVER, rovers
from playback.recorded_bags import record
from played_bag import Played
from robots_to_steer import arm_with_trajectories
from seeing_robot import seeing
from show_menu import switch

COMMANDS = "/robot_1/forward_velocity_controller/commands"
SHOWN = {"rovers": lambda _: rovers(2), "box": seeing, "arm": arm_with_trajectories}  # "bag" is a bag of a rover
PLOT = "async (path) => { (await import('./plots.js')).plots.add(path); }"


@dataclass(frozen=True)
class State:
    """What is shown, and what leads there."""

    of: str
    enter: Callable


STATES: dict[str, State] = {}
LOST = "lost connection"  # nothing is answered there


def state(name, of="rovers"):
    def add(enter):
        STATES[name] = State(of, enter)
        return enter

    return add


@pytest.fixture(scope="module")
def bags(tmp_path_factory):
    """Two bags of a rover, which drives faster in one."""
    folder = tmp_path_factory.mktemp("bags")
    for name, speed in (("slow", 2.0), ("fast", 3.0)):
        record(rovers(1).command(COMMANDS, [2.0, 2.0, speed, 2.0]).build(), folder / name, 2.0)
    return folder


@pytest.fixture
def reach(browser, show, tmp_path, request):
    """Shows a state of the page; returns what runs it, and the tab."""
    played = []

    def reach_(name):
        state = STATES[name]
        if state.of == "bag":
            bags = request.getfixturevalue("bags")
            it = Played(browser, bags / "slow")
            played.append(it)
            it.other = bags / "fast"
            tab = it.tab
        else:
            it, tab = show(SHOWN[state.of](tmp_path).scenario())
        state.enter(it, tab)
        it.frames(lambda: tab.locator("#connection:visible").count() == (name == LOST))
        return it, tab

    yield reach_
    for it in played:
        it.close()


def unfold(tab):
    for summary in tab.locator(".page:visible summary").all():
        summary.evaluate("element => { element.parentElement.open = true; }")


@state("robots")
def _(it, tab):
    unfold(tab)
    it.frames(lambda: folder(tab).locator("tbody td").nth(1).inner_text() not in ("", "–"))


@state("an arm with poses", "arm")
def _(it, tab):
    unfold(tab)
    folder(tab, "arm").get_by_label("Name of the pose").fill("a pose")
    folder(tab, "arm").get_by_role("button", name="Save the joints' present positions").press("Enter")
    it.frames(lambda: folder(tab, "arm").get_by_text("a pose").count() > 0)


@state("stopped robots")
def _(it, tab):
    tab.locator("#stop-all").press("Enter")
    it.frames(lambda: tab.locator(".robot.stopped").count() == 2)


@state("sensors", "box")
def _(it, tab):
    open_tab(tab, "Sensors")
    for name in ("lidar", "imu", "camera"):
        tab.get_by_label(f"Show box_0's {name}").press("Space")
    unfold(tab)
    it.frames(
        lambda: tab.locator("#sensors .picture canvas").count() == 1 and tab.locator("#sensors .plot").count() == 3
    )
    it.frames(lambda: tab.locator(".color-bar:visible").count() == 1)


@state("world")
def _(it, tab):
    open_tab(tab, "World")
    rows = tab.locator("[role=treeitem]")
    it.frames(lambda: rows.count() > 1)
    rows.first.press("ArrowRight")
    rows.first.press("Enter")
    it.frames(lambda: tab.locator(".world table, .world dl").count() > 0)
    unfold(tab)


@state("topics and frames")
def _(it, tab):
    open_tab(tab, "ROS")
    unfold(tab)
    it.frames(lambda: tab.locator(".topics button").count() > 5 and tab.locator(".frames li").count() > 3)
    tab.locator(".topics button", has_text="joint_states").first.press("Enter")
    it.frames(lambda: tab.locator(".echo button").count() > 0)


@state("publishing")
def _(it, tab):
    open_tab(tab, "ROS")
    unfold(tab)
    it.frames(lambda: tab.locator(".topics button").count() > 5)
    tab.locator(".topics button", has_text="forward_velocity_controller").first.press("Enter")
    it.frames(lambda: tab.locator("form.publish:visible").count() > 0)


@state("diagram")
def _(it, tab):
    open_tab(tab, "ROS")
    tab.get_by_role("button", name="Diagram…").press("Enter")
    it.frames(lambda: tab.locator("dialog.drawing svg").count() == 1)


@state("view")
def _(it, tab):
    open_tab(tab, "View")
    tab.get_by_role("button", name="Measure").press("Enter")


@state("time")
def _(it, tab):
    open_tab(tab, "Time")
    unfold(tab)
    it.frames(lambda: tab.locator("#factor-plot canvas").count() == 1)


@state("own panels")
def _(it, tab):
    panel = it.cockpit.panels["own"].add("Gripper")
    panel.slider("width", 0, 0.08, step=0.01, unit="m", hint="Between the fingers")
    panel.number("mass", 1.0, lower=0, unit="kg")
    panel.checkbox("closed")
    panel.choice("gait", ["walk", "trot"]).enabled = False
    panel.text("note")
    panel.button("Break", on_press=lambda: 1 / 0)
    more = panel.folder("More")
    more.plot("height", lambda: 1.0, unit="m")
    more.table("poses", lambda: {"robot_1": (0.0, 1.0)}, columns=("robot", "x", "y"))
    more.image("eye", lambda: np.full((20, 30, 3), (200, 10, 60), dtype=np.uint8))
    more.marker("goal", (0, 0, 1), size=0.5, color=(0.1, 0.2, 0.9))
    breaks = tab.get_by_role("button", name="Break")
    it.frames(lambda: breaks.count() == 1)
    breaks.press("Enter")
    it.frames(lambda: tab.locator(".own .refusal:visible").count() >= 1)
    it.frames(lambda: tab.locator(".own img:visible").count() == 1 and tab.locator(".own .legend output").count() == 1)


@state("plots")
def _(it, tab):
    for name, part in (("front_left", "velocity"), ("front_right", "position")):
        tab.evaluate(PLOT, f"/robot_1/joint_states.{part}[robot_1_{name}_wheel_joint]")
    it.frames(lambda: tab.locator("#plots .legend .unit").all_inner_texts() == ["rad/s", "rad"])
    tab.get_by_role("button", name="New plot").press("Enter")
    tab.evaluate(PLOT, "/nothing.x")
    it.frames(lambda: tab.locator("#plots .refusal:visible").count() == 1)


@state("parameters")
def _(it, tab):
    open_tab(tab, "ROS")
    panel = tab.locator("[data-panel=parameters]")
    panel.locator("summary").press("Enter")
    it.frames(lambda: panel.locator("li").count() > 10)
    panel.locator("li button", has_text="publish_frequency").first.press("Enter")
    panel.get_by_label("Value").fill("fast")
    panel.get_by_label("Value").press("Enter")
    it.frames(lambda: panel.locator(".refusal:visible").count() == 1)


@state("messages")
def _(it, tab):
    it.cockpit._log.add("warning", "a thing happened")
    it.cockpit._log.add("error", "a bad thing happened")
    tab.locator("#messages-toggle").press("Enter")
    it.frames(lambda: tab.locator("#messages li", has_text="a bad thing").count() == 1)


@state("spawn")
def _(it, tab):
    tab.locator("#spawn").press("Enter")
    tab.get_by_label("Robot file").fill(ROVER)
    tab.get_by_label("Name", exact=True).fill("robot_1")
    it.frames(lambda: tab.locator("#spawn-arguments").is_visible())
    for summary in tab.locator("#spawn-dialog summary").all():
        summary.press("Enter")
    tab.get_by_role("button", name="Spawn", exact=True).press("Enter")
    it.frames(lambda: tab.locator("#spawn-message").is_visible())


@state("placing a robot")
def _(it, tab):
    tab.locator("#spawn").press("Enter")
    tab.get_by_label("Robot file").fill(ROVER)
    tab.get_by_role("button", name="Click in the scene…").press("Enter")
    it.frames(lambda: tab.locator("#spawn-hint").is_visible())


@state("find")
def _(it, tab):
    tab.locator("#find-button").press("Enter")
    tab.keyboard.type("robot_2")
    it.frames(lambda: tab.locator("#found li").count() > 5)


@state("help")
def _(it, tab):
    tab.keyboard.press("?")
    it.frames(lambda: tab.locator("#help").is_visible())


@state("show menu")
def _(it, tab):
    switch(tab, "Contact forces").press("Space")
    it.frames(lambda: tab.locator("#show-button").inner_text() == "Show (1)")


@state("timeline in the past")
def _(it, tab):
    it.twin.control.emergency_stop("robot_1")
    it.frames(lambda: it.twin.time > 1.0)
    tab.get_by_label("Time to look at").press("Home")
    it.frames(lambda: tab.locator("#timeline.looking").count() == 1)
    for _ in range(5):
        tab.get_by_label("Time to look at").press("PageUp")  # to where a moment is kept
    it.frames(lambda: tab.get_by_role("button", name="Go on from").is_visible())


@state("panel closed")
def _(it, tab):
    tab.keyboard.press("p")
    it.frames(lambda: tab.locator("#panel-toggle").get_attribute("aria-expanded") == "false")


@state("a bag that plays", "bag")
def _(it, tab):
    tab.get_by_role("button", name="Begin again at the end").press("Enter")
    tab.get_by_role("button", name="Play", exact=True).press("Enter")
    it.frames(lambda: it.player.time > 0.5)


@state("two bags", "bag")
def _(it, tab):
    tab.evaluate(PLOT, "/robot_1/joint_states.velocity[robot_1_rear_left_wheel_joint]")
    open_tab(tab, "Time")
    tab.get_by_label("Bag to compare with").fill(str(it.other))
    tab.get_by_label("Bag to compare with").press("Enter")
    it.frames(lambda: tab.locator(".differences tbody tr").count() > 8)
    it.frames(lambda: tab.locator("#plots .legend .dash.like").count() == 1)


@state(LOST)
def _(it, tab):
    unfold(tab)
    it.frames(lambda: tab.locator(".robot").count() == 2)
    it.is_cut = True
    it.served.server.close()
    tab.locator("#connection").wait_for(state="visible")
