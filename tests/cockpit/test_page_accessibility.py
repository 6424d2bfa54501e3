"""WCAG 2.1 AA by axe-core, which nobody here wrote."""

# ruff: noqa: F401, F811 (fixtures are imported, and named again as arguments)

import pytest
from browser import BROWSER_TESTS, browser, open_tab, show
from conftest import rovers
from seeing_robot import seeing
from wires.foxglove_peer import npm_modules

pytestmark = BROWSER_TESTS

RUN = """async () => {
  const found = await axe.run(document, { iframes: false, runOnly: ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa"] });
  return found.violations.map(({ id, nodes }) => [id, nodes.map((node) => node.html.slice(0, 160))]);
}"""


@pytest.fixture(scope="module")
def axe():
    return (npm_modules("axe-core@4.10") / "axe-core" / "axe.min.js").read_text()


SIZES = {"wide": (1280, 800), "large": (1920, 1080), "phone": (390, 844)}


def looks(*quick):
    """Each size with each scheme; those that are not named are slow."""
    every = [(size, scheme) for size in SIZES for scheme in ("light", "dark")]
    cases = [
        pytest.param(
            SIZES[size], scheme, id=f"{size}-{scheme}", marks=() if (size, scheme) in quick else pytest.mark.slow
        )
        for size, scheme in every
    ]
    return pytest.mark.parametrize(("size", "scheme"), cases)


@looks(("wide", "light"), ("phone", "dark"))
def test_the_page_breaks_none_of_its_rules(show, axe, tmp_path, scheme, size):
    it, tab = show(seeing(tmp_path).scenario())
    tab.emulate_media(color_scheme=scheme, reduced_motion="reduce")
    tab.set_viewport_size({"width": size[0], "height": size[1]})
    for summary in tab.locator("#panel summary").all():
        summary.evaluate("element => { element.parentElement.open = true; }")
    tab.locator("#messages-toggle").click(force=True)
    for name in ("lidar", "imu"):
        it.cockpit.sensors.show(f"box_0/box/{name}", True)
    open_tab(tab, "Sensors")
    bar, plot = tab.locator(".color-bar:visible"), tab.locator("#sensors .plot canvas")
    it.frames(lambda: bar.count() == 1 and plot.count() == 3)
    tab.evaluate(axe)
    names = tab.locator("[role=tab]:visible").all_inner_texts()
    assert len(names) == 6
    for name in names:
        open_tab(tab, name)
        it.for_frames(5)
        assert tab.evaluate(RUN) == [], name


@looks(("wide", "dark"))
def test_topics_plots_and_diagram_break_none_of_its_rules(show, axe, scheme, size):
    it, tab = show(rovers(1).scenario())
    tab.emulate_media(color_scheme=scheme, reduced_motion="reduce")
    tab.set_viewport_size({"width": size[0], "height": size[1]})
    tab.evaluate(axe)
    open_tab(tab, "ROS")
    tab.locator(".topics-panel summary", has_text="Frames").press("Enter")
    tab.locator(".topics-panel summary", has_text="Topics").press("Enter")
    it.frames(lambda: tab.locator(".topics button").count() > 5 and tab.locator(".frames li").count() > 3)
    for topic, shown in (("forward_velocity_controller", "form.publish:visible"), ("joint_states", ".echo button")):
        tab.locator(".topics button", has_text=topic).first.press("Enter")
        it.frames(lambda shown=shown: tab.locator(shown).count() > 0)
        assert tab.evaluate(RUN) == []
    tab.locator(".echo button").first.press("Enter")
    it.frames(lambda: tab.locator("#plots canvas").count() == 1)
    it.for_frames(20)
    tab.evaluate("async () => { (await import('./plots.js')).plots.add('/nothing.x'); }")
    it.frames(lambda: tab.locator("#plots .refusal:visible").count() == 1)
    assert tab.evaluate(RUN) == []
    tab.get_by_role("button", name="Diagram…").press("Enter")
    it.frames(lambda: tab.locator("dialog.drawing svg").count() == 1)
    assert tab.evaluate(RUN) == []


def test_the_dialog_breaks_none_of_its_rules(show, axe):
    it, tab = show(rovers(1).scenario())
    tab.locator("#spawn").click(force=True)
    it.for_frames(3)
    tab.evaluate(axe)
    assert tab.evaluate(RUN) == []
