"""Names and messages with markup are texts on the page, in a real browser."""

# ruff: noqa: F401, F811 (fixtures are imported, and named again as arguments)

import logging
from html import escape

from browser import BROWSER_TESTS, browser, folder, open_tab, show
from show_menu import press

from drake_twin import TwinBuilder
from drake_twin.cockpit.overlay import OVERLAY_KINDS

pytestmark = BROWSER_TESTS

EVIL = "<img src=x onerror=document.body.dataset.evil=1>"
FILE = f"""<robot name="made">
  <link name="world"/>
  <link name="base {escape(EVIL)}"><inertial><mass value="5"/>
    <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <link name="arm {escape(EVIL)}"><inertial><mass value="1"/>
    <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
    <visual><geometry><box size="0.6 0.05 0.05"/></geometry></visual></link>
  <joint name="fixed" type="fixed"><parent link="world"/><child link="base {escape(EVIL)}"/></joint>
  <joint name="hinge {escape(EVIL)}" type="continuous"><parent link="base {escape(EVIL)}"/>
    <child link="arm {escape(EVIL)}"/><axis xyz="0 0 1"/></joint>
</robot>"""


def test_markup_in_names_is_not_interpreted(show, tmp_path):
    file = tmp_path / "made.urdf"
    file.write_text(FILE)
    it, tab = show(TwinBuilder().robot("made", file).scenario())
    logging.getLogger("drake_twin.test").warning("a message %s", EVIL)
    tab.locator("#messages-toggle").click()
    for summary in tab.locator("#panel summary").all():
        summary.evaluate("element => { element.parentElement.open = true; }")
    it.frames(lambda: tab.locator("#messages li", has_text=EVIL).count() >= 1)
    open_tab(tab, "ROS")
    it.frames(lambda: tab.locator(".topics button").count() > 2)
    open_tab(tab, "World")
    rows = tab.locator("[role=treeitem]")
    it.frames(lambda: rows.count() >= 1)
    for key in ("ArrowRight", "ArrowDown", "ArrowRight", "ArrowDown", "ArrowRight", "ArrowDown"):
        rows.first.press(key) if key == "ArrowRight" else tab.keyboard.press(key)
        it.for_frames(3)
    for label in ("Names", *(kind.label for kind in OVERLAY_KINDS.values())):
        press(tab, label)
    it.for_frames(5)
    open_tab(tab, "Robots")
    folder(tab, "made").get_by_title(f"Plot {'hinge ' + EVIL}").first.click()
    it.for_frames(20)
    tab.locator("#spawn").press("Enter")
    tab.get_by_label("Robot file").fill(EVIL)
    tab.get_by_label("Name", exact=True).fill(EVIL)
    tab.get_by_role("button", name="Spawn", exact=True).press("Enter")
    it.frames(lambda: EVIL in tab.locator("#spawn-message").inner_text())
    tab.keyboard.press("Escape")
    tab.keyboard.press("Control+k")
    tab.keyboard.type("onerror")
    it.frames(lambda: tab.locator("#palette li", has_text=EVIL).count() > 1)
    tab.keyboard.press("Escape")
    assert EVIL in tab.locator("#panel").inner_text()
    assert tab.locator("img[src='x'], img[onerror]").count() == 0
    assert tab.locator("body").get_attribute("data-evil") is None
    assert tab.frame_locator("#scene").locator("body").get_attribute("data-evil") is None
