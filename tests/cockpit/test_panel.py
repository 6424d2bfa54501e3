import pytest
import umsgpack
from conftest import ARM, rovers

from drake_twin import TwinBuilder
from drake_twin.cockpit.page import open_meshcat, set_scene
from drake_twin.cockpit.panel import PLAY_PAUSE, RESET, SIM_TIME, SPEED, STEP, Panel

WHEELS_1 = "/robot_1/forward_velocity_controller/commands"


@pytest.fixture(scope="module")
def meshcat():
    return open_meshcat()


@pytest.fixture
def page(meshcat):
    """A twin with two rovers and its panel; `click` and `move` do what a person at the page does."""
    twin = rovers(2).build()
    meshcat.DeleteAddedControls()
    yield twin, Panel(meshcat, twin)
    meshcat.DeleteAddedControls()


def click(meshcat, button):
    meshcat._InjectWebsocketMessage(message=umsgpack.packb({"type": "button", "name": button}))


def move(meshcat, slider, value):
    meshcat._InjectWebsocketMessage(message=umsgpack.packb({"type": "slider", "name": slider, "value": value}))


def test_play_pause_stops_and_starts_time(meshcat, page):
    twin, panel = page
    click(meshcat, PLAY_PAUSE)
    panel.obey()
    assert twin.paused
    click(meshcat, PLAY_PAUSE)
    panel.obey()
    assert not twin.paused


def test_two_clicks_between_two_frames_leave_it_as_it_was(meshcat, page):
    twin, panel = page
    click(meshcat, PLAY_PAUSE)
    click(meshcat, PLAY_PAUSE)
    panel.obey()
    assert not twin.paused


def test_step_makes_one_step_and_stays_paused(meshcat, page):
    twin, panel = page
    click(meshcat, STEP)
    panel.obey()
    assert twin.step_count == 1
    assert twin.paused


def test_reset_goes_back_to_the_start(meshcat, page):
    twin, panel = page
    twin.advance_to(0.1)
    click(meshcat, RESET)
    panel.obey()
    assert twin.time == 0


def test_the_speed_slider_sets_the_real_time_rate(meshcat, page):
    twin, panel = page
    move(meshcat, SPEED, 0.5)
    panel.obey()
    assert twin.real_time_rate == 0.5


def test_a_wheels_slider_drives_that_wheel_and_no_other_robot(meshcat, page):
    twin, panel = page
    move(meshcat, "robot_1/rear_left_wheel", 3.0)
    panel.obey()
    twin.advance_to(0.01)
    assert twin.command(WHEELS_1).data.tolist() == [0, 0, 3, 0]
    assert twin.command(WHEELS_1.replace("1", "2")) is None


def test_a_slider_moved_while_paused_keeps_its_value_and_acts_when_time_goes_on(meshcat, page):
    twin, panel = page
    twin.pause()
    move(meshcat, "robot_1/rear_left_wheel", 3.0)
    for _ in range(3):
        panel.obey()
    assert meshcat.GetSliderValue("robot_1/rear_left_wheel") == 3.0
    twin.play()
    twin.advance_to(0.01)
    assert twin.command(WHEELS_1).data[2] == 3.0


def test_sliders_show_commands_that_came_from_elsewhere(meshcat, page):
    twin, panel = page
    twin.publish(WHEELS_1, [1, 2, 3, 4])
    twin.advance_to(0.01)
    panel.obey()
    assert meshcat.GetSliderValue("robot_1/front_right_wheel") == pytest.approx(2, abs=0.1)
    panel.obey()
    assert twin.command(WHEELS_1).data.tolist() == [1, 2, 3, 4]  # showing it does not round it


def test_whoever_moves_a_slider_takes_over_from_the_scenario(meshcat):
    twin = rovers(1).command(WHEELS_1, [1] * 4, period=0.1).build()
    meshcat.DeleteAddedControls()
    panel = Panel(meshcat, twin)
    twin.advance_to(0.05)
    panel.obey()
    move(meshcat, "robot_1/rear_left_wheel", 3.0)
    panel.obey()
    twin.advance_to(0.5)
    assert twin.command(WHEELS_1).data[2] == 3.0
    meshcat.DeleteAddedControls()


def test_the_panel_shows_simulation_time(meshcat, page):
    twin, panel = page
    twin.advance_to(0.25)
    panel.obey()
    assert meshcat.GetSliderValue(SIM_TIME) == pytest.approx(0.25)


def test_a_joint_without_limits_has_a_slider_with_a_range(meshcat, tmp_path):
    file = tmp_path / "cart.urdf"
    inertial = '<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'
    file.write_text(
        f'<robot name="cart"><link name="a">{inertial}</link><link name="b">{inertial}</link><joint name="j"'
        ' type="continuous"><parent link="a"/><child link="b"/></joint><ros2_control name="s" type="system"><joint'
        ' name="j"><command_interface name="velocity"/></joint></ros2_control></robot>'
    )
    twin = TwinBuilder().robot("cart", file).build()
    meshcat.DeleteAddedControls()
    Panel(meshcat, twin)
    move(meshcat, "cart/j", 5.0)
    assert meshcat.GetSliderValue("cart/j") == 5.0
    meshcat.DeleteAddedControls()


def test_the_scene_has_a_ground_and_the_robots_links(meshcat):
    from drake_twin import Twin

    twin = Twin(TwinBuilder().robot("arm", ARM).scenario(), meshcat)
    set_scene(meshcat, twin)
    twin.draw()
    assert meshcat.HasPath("/ground")
    assert meshcat.HasPath("/drake/visualizer/arm/forearm")
