"""WCAG 2.1 AA by axe-core, which nobody here wrote, and the keyboard, in each state of the page."""

# ruff: noqa: F401, F811 (fixtures are imported, and named again as arguments)

import pytest
from browser import BROWSER_TESTS, browser, show
from page_states import STATES, bags, reach
from wires.foxglove_peer import npm_modules

pytestmark = BROWSER_TESTS

RUN = """async () => {
  const found = await axe.run(document, { iframes: false, runOnly: ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa"] });
  return found.violations.map(({ id, nodes }) => [id, nodes.map((node) => node.html.slice(0, 160))]);
}"""
CUT = "document.documentElement.scrollWidth > innerWidth ? ['wider than the screen'] : []"
SIZES = ((1280, 800), (390, 844))
EACH_STATE = pytest.mark.parametrize("name", STATES)
IS_DARK = "matchMedia('(prefers-color-scheme: dark)').matches"


@pytest.fixture(scope="module")
def axe():
    return (npm_modules("axe-core@4.10") / "axe-core" / "axe.min.js").read_text()


def broken(_, tab, axe):
    """The rules that are broken, by size and scheme."""
    tab.evaluate(axe)
    found = {}
    for scheme in ("light", "dark"):
        tab.emulate_media(color_scheme=scheme, reduced_motion="reduce")
        if tab.evaluate(IS_DARK) != (scheme == "dark"):  # Firefox cannot be told
            continue
        for width, height in SIZES:
            tab.set_viewport_size({"width": width, "height": height})
            tab.evaluate("() => new Promise(requestAnimationFrame)")
            found[f"{width}×{height}, {scheme}"] = tab.evaluate(RUN) + tab.evaluate(CUT)
    assert found
    return {look: rules for look, rules in found.items() if rules}


@EACH_STATE
def test_no_rule_is_broken(reach, axe, name):
    assert broken(*reach(name), axe) == {}


# What is visible and operable, and whether the tabulator came to it, or to one of the widget whose arrow keys go to it.
OPERABLE = "button, a[href], input, select, textarea, summary, [tabindex], [role=button], [role=switch], [role=slider]"
ROVING = "[role=tablist], [role=tree], [role=listbox]"
UNREACHED = """([operable, roving]) => {
  const top = [...document.querySelectorAll("dialog[open]")].at(-1) ?? document;
  const isUsable = (node) =>
    node.checkVisibility({ visibilityProperty: true }) && !node.disabled && !node.closest("[inert]");
  const isReached = (node) => {
    const widget = node.closest(roving);
    if (window.walked.has(node)) return true;
    if (!widget) return node.tabIndex < 0 && !node.matches("button, a, input, select, textarea, summary, [role]");
    const owner = document.querySelector(`[aria-controls="${widget.id}"][aria-activedescendant]`);
    return [...window.walked].some((each) => widget.contains(each)) || (owner && window.walked.has(owner));
  };
  const unreached = [...top.querySelectorAll(operable)].filter((node) => isUsable(node) && !isReached(node));
  return unreached.map((node) => node.outerHTML.slice(0, 160));
}"""
STEP = """() => {
  window.walked ??= new Set();
  const node = document.activeElement;
  const isNew = !window.walked.has(node);
  window.walked.add(node);
  return isNew || node.localName === "iframe";
}"""


def walk(tab):
    """Press the tabulator until it comes to nothing new."""
    tab.evaluate("() => { window.walked = new Set(); }")
    known = 0
    while known < 3:  # the browser's own bar, and the scene's frame, come between
        tab.keyboard.press("Tab")
        known = 0 if tab.evaluate(STEP) else known + 1
    return tab.evaluate(UNREACHED, [OPERABLE, ROVING])


@EACH_STATE
def test_the_tabulator_comes_to_every_control(reach, name):
    _, tab = reach(name)
    for width, height in SIZES:
        tab.set_viewport_size({"width": width, "height": height})
        assert walk(tab) == []
