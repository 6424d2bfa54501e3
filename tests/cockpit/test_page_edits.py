"""Things are moved, duplicated and deleted on the page in a real Chromium: by handles, by numbers, by buttons."""

# ruff: noqa: F401, F811 (fixtures are imported, and named again as arguments)

import pytest
from browser import BROWSER_TESTS, browser, open_tab, show
from in_scene import item, look_at, place_of, tools
from world_with_crate import CRATE_AT, rover_and_crate

from drake_twin.twin.replay import replay

pytestmark = BROWSER_TESTS


@pytest.fixture
def crates(show, tmp_path):
    """A rover beside a crate and a ramp, paused; the crate is selected, and its handles are there."""
    it, tab = show(rover_and_crate(tmp_path).scenario())
    it.twin.pause()
    open_tab(tab, "World")
    it.frames(lambda: item(tab, "model:crate::crate").count() == 1)
    item(tab, "model:crate::crate").click()
    it.frames(lambda: tab.get_by_role("button", name="Move", exact=True).is_visible())
    look_at(tab, "rover", "crate")
    tab.get_by_role("button", name="Move", exact=True).click()
    it.frames(lambda: tools(tab, "handles.pose !== null"))
    it.for_frames(4)
    return it, tab


def drag(it, tab, start, end):
    """Drag from one point of the world to another (m)."""
    tab.mouse.move(*place_of(tab, start))
    tab.mouse.down()
    tab.mouse.move(*place_of(tab, end), steps=6)
    it.for_frames(2)
    tab.mouse.up()


def test_an_arrow_moves_along_its_axis_only_and_undo_returns(crates):
    it, tab = crates
    x, y, z = at = it.twin.entities.state("crate").position  # it may have settled by some micrometers
    size = tools(tab, "handles.group.scale.x")
    camera = tools(tab, "cameraPlace()")
    drag(it, tab, (x, y + 0.7 * size, z), (x, y + 0.7 * size + 0.4, z))
    it.frames(lambda: it.twin.entities.state("crate").position[1] > y + 0.2)
    assert it.twin.entities.state("crate").position == pytest.approx((x, y + 0.4, z), abs=0.02)
    assert it.twin.entities.state("crate").orientation == pytest.approx((1, 0, 0, 0), abs=1e-6)  # as it settled
    assert tools(tab, "cameraPlace()") == pytest.approx(camera)  # the camera was not turned
    it.frames(lambda: tab.get_by_role("button", name="Undo the last edit").is_visible())
    tab.get_by_role("button", name="Undo the last edit").click()
    it.frames(lambda: it.twin.entities.state("crate").position == pytest.approx(at, abs=1e-9))


def test_a_ring_turns_about_its_axis(crates):
    it, tab = crates
    x, y, z = at = it.twin.entities.state("crate").position  # it may have settled by some micrometers
    size = 0.8 * tools(tab, "handles.group.scale.x")
    half = size * 2**-0.5
    drag(it, tab, (x + half, y - half, z), (x + half, y + half, z))
    it.frames(lambda: it.twin.entities.state("crate").orientation[3] > 0.2)
    w, qx, qy, qz = it.twin.entities.state("crate").orientation
    assert (w, qz) == pytest.approx((2**-0.5, 2**-0.5), abs=0.05)
    assert (qx, qy) == pytest.approx((0, 0), abs=1e-6)  # as level as it settled
    assert it.twin.entities.state("crate").position == pytest.approx(at, abs=1e-6)


def test_numbers_move_a_static_model_and_buttons_delete_and_duplicate(crates):
    it, tab = crates
    item(tab, "model:ramp::ramp").click()
    form = tab.locator(".edits form")
    it.frames(lambda: form.get_by_label("x", exact=True).input_value() == "1")
    form.get_by_label("x", exact=True).fill("2.5")
    form.get_by_label("yaw").fill("0.5")
    form.get_by_role("button", name="Move there").click()
    it.frames(lambda: it.twin.built.world_file.models[0].pose.xyz == (2.5, 2, 0.05))
    assert it.twin.built.world_file.models[0].pose.rpy == (0, 0, 0.5)
    it.frames(lambda: not tab.locator(".inspector").is_hidden())
    buttons = tab.locator(".edits .buttons")
    buttons.get_by_role("button", name="Duplicate").click()
    it.frames(lambda: item(tab, "model:ramp_2::ramp_2").count() == 1)
    copy = next(model for model in it.twin.built.world_file.models if model.name == "ramp_2")
    assert copy.pose.xyz == (2.5, 3, 0.05)
    item(tab, "model:ramp_2::ramp_2").click()
    it.frames(lambda: form.get_by_label("y", exact=True).input_value() == "3")
    buttons.get_by_role("button", name="Delete").click()
    it.frames(lambda: item(tab, "model:ramp_2::ramp_2").count() == 0)
    item(tab, "model:ramp::ramp").click()
    it.frames(lambda: buttons.get_by_title("Delete ramp", exact=True).is_visible())
    buttons.get_by_role("button", name="Delete").click()
    it.frames(lambda: item(tab, "model:ramp::ramp").count() == 0)
    assert [model.name for model in it.twin.built.world_file.models] == ["crate"]
    item(tab, "robot:rover::rover").click()
    it.frames(lambda: buttons.get_by_role("button", name="Duplicate").is_visible())
    buttons.get_by_role("button", name="Duplicate").click()
    it.frames(lambda: item(tab, "robot:rover_2::rover_2").count() == 1)


def test_a_crate_follows_the_mouse_and_the_recording_replays_to_the_same_hash(show, tmp_path):
    it, tab = show(rover_and_crate(tmp_path).scenario())
    it.frames(lambda: item(tab, "model:crate::crate").count() == 1)
    it.frames(lambda: tools(tab, "entityAt !== null"))
    look_at(tab, "rover", "crate")
    it.for_frames(3)
    it.twin.recorder.begin()
    x, y, z = CRATE_AT
    camera = tools(tab, "cameraPlace()")
    open_tab(tab, "World")
    tab.get_by_role("button", name="Drag", exact=True).click()
    it.frames(lambda: tools(tab, "pulls"))
    tab.mouse.move(*place_of(tab, (x, y, z + 0.2)))
    tab.mouse.down()
    across, up = place_of(tab, (x, y, z + 0.2))
    tab.mouse.move(across, up - 110, steps=5)
    it.frames(lambda: it.twin.entities.state("crate").position[2] > z + 0.05)
    tab.mouse.move(across - 150, up - 110, steps=10)
    it.frames(lambda: place_of(tab, it.twin.entities.state("crate").position)[0] < across - 100)
    tab.mouse.up()
    it.frames(lambda: it.twin.snapshot().wrenches["items"] == [])
    it.frames(lambda: it.twin.entities.state("crate").position[2] < z + 0.02)
    assert tools(tab, "cameraPlace()") == pytest.approx(camera)
    recording = it.twin.recorder.recording()
    assert {call.name for call in recording.calls} == {"drag", "release"}
    assert replay(recording).state_sha256() == it.twin.state_sha256()


def test_control_drags_too_and_what_a_closed_tab_held_falls(show, tmp_path):
    it, tab = show(rover_and_crate(tmp_path).scenario())
    it.frames(lambda: item(tab, "model:crate::crate").count() == 1)
    it.frames(lambda: tools(tab, "entityAt !== null"))
    look_at(tab, "rover", "crate")
    it.for_frames(3)
    x, y, z = CRATE_AT
    across, up = place_of(tab, (x, y, z + 0.2))
    tab.keyboard.down("Control")
    tab.mouse.move(across, up)
    tab.mouse.down()
    tab.mouse.move(across, up - 80, steps=5)
    it.frames(lambda: it.twin.entities.state("crate").position[2] > z + 0.05)
    it.tabs.remove(tab)
    tab.close()
    it.frames(lambda: it.twin.snapshot().wrenches["items"] == [])
    it.frames(lambda: it.twin.entities.state("crate").position[2] < z + 0.02)


def test_a_push_is_a_force_for_a_time(crates):
    it, tab = crates
    tab.get_by_role("button", name="Push…").click()
    form = tab.locator(".edits form").nth(1)
    form.get_by_label("Fx").fill("0")
    form.get_by_label("Fz").fill("100")
    form.get_by_label("for").fill("0.1")
    assert form.locator("output").inner_text() == "10.00 N·s"
    form.get_by_role("button", name="Push").click()
    it.frames(lambda: it.twin.snapshot().wrenches["items"] != [])
    it.twin.step(100)  # F t / m - g t, but for the first step, on the ground
    assert it.twin.entities.state("crate").linear[2] == pytest.approx(10 / 2 - 9.81 * 0.1, abs=0.02)
