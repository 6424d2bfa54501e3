"""The page's buttons that switch between controllers of the same joints, in a real Chromium."""

# ruff: noqa: F401, F811 (fixtures are imported, and named again as arguments)

from browser import BROWSER_TESTS, browser, folder, show

from drake_twin.builder.demo import demo_scenario

pytestmark = BROWSER_TESTS

FORWARD, DRIVE = "forward_velocity_controller", "drive_controller"
TRAJECTORIES, GRIPPER = "joint_trajectory_controller", "gripper_controller"


def press(tab, text):
    folder(tab).get_by_role("button", name=f"robot_1: {text}").click()


def said(it, tab, text):
    """Runs until a message was shown: the line's own or, if the demo's schedule warned since, one of the list."""
    if tab.locator("#messages").is_hidden():
        tab.locator("#messages-toggle").click(force=True)
    it.frames(lambda: any(text in line for line in tab.locator("#messages li").all_text_contents()))


def test_one_press_switches_to_the_drive_pad_and_one_back_to_the_sliders(show):
    it, tab = show(demo_scenario("rover", 2))
    manager = it.twin.control.manager("robot_1")
    forwards = folder(tab).get_by_label("robot_1 Forwards")
    slider = folder(tab).get_by_label("rear_left_wheel_joint velocity, number")
    it.frames(lambda: it.twin.robot_state("robot_1").velocities[0] > 2)  # the demo drives
    back = folder(tab).get_by_role("button", name=f"Move with {FORWARD}")
    assert forwards.is_disabled()
    assert not back.is_visible()
    press(tab, f"Drive with {DRIVE}")
    said(it, tab, f"robot_1: switched: {DRIVE} active, {FORWARD} inactive")
    it.frames(lambda: forwards.is_enabled() and slider.is_disabled() and back.is_visible())
    assert not folder(tab).get_by_role("button", name=f"Drive with {DRIVE}").is_visible()
    forwards.scroll_into_view_if_needed()
    box = forwards.bounding_box()
    tab.mouse.move(box["x"] + 10, box["y"] + 10)
    tab.mouse.down()
    odom = lambda: it.twin.latest(f"/robot_1/{DRIVE}/odom")  # noqa: E731
    it.frames(lambda: odom() is not None and odom().twist.twist.linear.x > 0.4)
    tab.mouse.up()
    it.frames(lambda: abs(odom().twist.twist.linear.x) < 0.05)
    press(tab, f"Move with {FORWARD}")
    said(it, tab, f"robot_1: switched: {FORWARD} active, {DRIVE} inactive")
    it.frames(lambda: forwards.is_disabled() and slider.is_enabled())
    slider.fill("3")
    slider.press("Enter")
    it.frames(lambda: it.twin.robot_state("robot_1").velocities[2] > 2.9)
    assert manager.active[1:] == (FORWARD,)
    assert it.twin.control.manager("robot_2").active[1:] == (FORWARD,)


def test_the_arms_sliders_switch_to_trajectories_and_the_gripper_and_back(show):
    it, tab = show(demo_scenario("arduinobot", 1))
    manager = it.twin.control.manager("robot_1")
    place = folder(tab).get_by_label("robot_1 joint_2 position, number")
    grip = folder(tab).get_by_label("robot_1 joint_4 position, number")
    assert place.is_disabled()
    press(tab, f"Move with {TRAJECTORIES}")
    said(it, tab, f"robot_1: switched: {TRAJECTORIES} active, {FORWARD} inactive")
    press(tab, f"Move with {GRIPPER}")
    said(it, tab, f"robot_1: switched: {GRIPPER} active")
    it.frames(lambda: place.is_enabled() and grip.is_enabled())
    for field, value in ((place, "0.3"), (grip, "0.4")):
        field.fill(value)
        field.press("Enter")
    it.frames(lambda: abs(it.twin.robot_state("robot_1").positions[1] - 0.3) < 0.02)
    it.frames(lambda: abs(it.twin.robot_state("robot_1").positions[3] - 0.4) < 0.02)
    press(tab, f"Move with {FORWARD}")
    said(it, tab, f"robot_1: switched: {FORWARD} active, {TRAJECTORIES} inactive, {GRIPPER} inactive")
    it.frames(lambda: place.is_disabled() and grip.is_disabled())
    assert manager.active[1:] == (FORWARD,)
