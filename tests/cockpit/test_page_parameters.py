"""Parameters on the page, in a real browser: filtered and set."""

# ruff: noqa: F401, F811 (fixtures are imported, and named again as arguments)

from browser import BROWSER_TESTS, browser, open_tab, show
from conftest import ARM

from drake_twin import TwinBuilder

pytestmark = BROWSER_TESTS


def test_a_parameter_is_found_by_its_words_and_set(show):
    it, tab = show(TwinBuilder().robot("arm", ARM).scenario())
    open_tab(tab, "ROS")
    panel = tab.locator("[data-panel=parameters]")
    panel.locator("summary").click(force=True)
    it.frames(lambda: panel.locator("li").count() > 20)
    panel.get_by_label("Filter parameters").fill("publisher frequency")
    it.frames(lambda: panel.locator("li").count() == 1)
    panel.locator("li button").click(force=True)
    field = panel.get_by_label("Value")
    assert field.input_value() == "20.0"
    field.fill("fast")
    field.press("Enter")
    it.frames(lambda: panel.locator(".refusal").is_visible())
    assert "publish_frequency" in panel.locator(".refusal").inner_text()
    field.fill("50")
    field.press("Enter")
    it.frames(lambda: "50.0" in panel.locator("li small").inner_text())
    assert panel.locator(".refusal").is_hidden()
    assert it.twin.control.parameters("arm", "robot_state_publisher")["publish_frequency"].value == 50.0
