"""The timeline of the page, in a real Chromium."""

# ruff: noqa: F401, F811 (fixtures are imported, and named again as arguments)

import pytest
from browser import BROWSER_TESTS, browser, orange, picture, show
from conftest import rovers

pytestmark = BROWSER_TESTS

WHEELS = "/robot_1/forward_velocity_controller/commands"


@pytest.fixture
def driving(show):
    """A rover that drives, two seconds after its start."""
    it, tab = show(rovers(1).command(WHEELS, [2.0, 2.0, 2.0, 2.0]).scenario())
    it.twin.reset()  # time went by while the page was loaded
    it.frames(lambda: it.twin.time > 2.0)
    return it, tab


def scrub(it, tab, time):
    """Moves the slider to a time, as a person's hand does."""
    tab.get_by_label("Time to look at").evaluate(
        "(slider, time) => { slider.value = time; slider.dispatchEvent(new Event('input')); }", time
    )
    it.frames(lambda: it.cockpit._timeline._looked is not None and it.twin.clock.paused)
    it.frames(lambda: tab.locator("#timeline.looking").count() == 1)


def test_scrubbing_shows_where_the_robot_was_and_now_where_it_is(driving):
    it, tab = driving
    it.twin.pause()
    it.for_frames(10)
    present = picture(tab)
    scrub(it, tab, 0.3)
    it.for_frames(10)
    past = picture(tab)
    assert abs(orange(past)[1].mean() - orange(present)[1].mean()) > 20  # pixels
    assert "At 0." in tab.locator("#timeline").inner_text()
    tab.get_by_role("button", name="Back to now").click()
    it.frames(lambda: tab.locator("#timeline.looking").count() == 0)
    it.for_frames(10)
    assert abs(orange(picture(tab))[1].mean() - orange(present)[1].mean()) < 2
    assert it.twin.clock.paused


def test_a_press_goes_on_from_there(driving):
    it, tab = driving
    before = it.twin.time
    scrub(it, tab, 1.2)
    assert it.twin.time >= before
    tab.get_by_role("button", name="Go on from 1.00 s").click()
    it.frames(lambda: not it.twin.clock.paused)
    assert it.twin.time < 1.5
    it.frames(lambda: tab.locator("#timeline.looking").count() == 0)
    assert "continues from 1.000 s" in tab.locator("#message-text").inner_text()


def test_play_goes_on_from_now(driving):
    it, tab = driving
    scrub(it, tab, 0.5)
    now = it.twin.time
    tab.get_by_role("button", name="Play", exact=True).click()
    it.frames(lambda: it.twin.time > now + 0.1)
    it.frames(lambda: tab.locator("#timeline.looking").count() == 0)


def test_the_keyboard_moves_the_slider(driving):
    it, tab = driving
    slider = tab.get_by_label("Time to look at")
    slider.focus()
    slider.press("Home")
    it.frames(lambda: tab.locator("#timeline.looking").count() == 1)
    assert it.cockpit._timeline._looked is it.cockpit._timeline._pictures[0]
    slider.press("End")
    it.frames(lambda: tab.locator("#timeline.looking").count() == 0)


def test_marks_stand_where_things_happened(driving):
    it, tab = driving
    it.twin.control.emergency_stop("robot_1")
    stopped = it.twin.time
    mark = tab.locator(".marks i[title*='emergency stop robot_1']")
    it.frames(lambda: mark.count() == 1)
    it.frames(lambda: it.twin.time > 2 * stopped)
    strip, box = tab.locator(".marks").bounding_box(), mark.bounding_box()
    assert (box["x"] - strip["x"]) / strip["width"] == pytest.approx(stopped / it.twin.time, abs=0.05)


@pytest.mark.parametrize(
    ("size", "scheme"), [((1280, 800), "light"), ((390, 844), "dark")], ids=["wide-light", "phone-dark"]
)
def test_its_texts_fit(driving, scheme, size):
    it, tab = driving
    it.twin.control.emergency_stop("robot_1")
    tab.emulate_media(color_scheme=scheme)
    tab.set_viewport_size({"width": size[0], "height": size[1]})
    it.for_frames(20)
    scrub(it, tab, 0.8)
    it.for_frames(10)
    bar = tab.locator("#timeline").bounding_box()
    for part in tab.locator("#timeline > *:visible").all():
        box = part.bounding_box()
        assert box["x"] >= bar["x"]
        assert box["x"] + box["width"] <= bar["x"] + bar["width"] + 1
        assert part.evaluate("element => element.scrollWidth <= element.clientWidth + 1 || !element.clientWidth")
