"""Draws the picture of a user's own panel: ``python tests/docs/draw_panel.py drake_twin/docs/panels.png``.

The panel is the one that the page of the documentation shows; it drives the rover for 4 s, and time stands still then.
"""

import io
import sys
from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))  # of the tests' own modules

from chromium import CHROMIUM, OFFLINE, SOFTWARE_RENDERING
from docs import run_page
from PIL import Image

from drake_twin import Twin, TwinBuilder, show
from drake_twin.cli.plugins import load_panels

PAGE = Path(__file__).resolve().parents[2] / "drake_twin" / "docs" / "panels.md"
SIZE = {"width": 1080, "height": 660}
COLORS = 64
END = 4.4  # s of simulation


def saved(folder: Path) -> str:
    """Save the panel of the page in a folder; return the file's name."""
    (block,) = (block for block in run_page.blocks(PAGE) if block.file == "rover_panel.py")
    file = folder / "rover_panel.py"
    file.write_text(block.text, encoding="utf-8")
    return str(file)


def draw(file: Path) -> None:
    """Draw the page of a rover, with the panel, into a PNG."""
    from playwright.sync_api import sync_playwright

    with TemporaryDirectory() as folder:
        load_panels([saved(Path(folder))])
    rover = "package://rover_description/urdf/rover.urdf.xacro"
    twin = TwinBuilder(time_step=0.002).robot("robot_1", rover, xyz=(0, 0, 0.13)).build()
    with sync_playwright() as playwright, show(twin) as page:
        options = [item for item in SOFTWARE_RENDERING + OFFLINE if "antialiasing" not in item]
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=options)
        tab = browser.new_page(viewport=SIZE)
        tab.goto(page.url)
        speed = tab.get_by_label("speed, number")
        _run(twin, lambda: speed.count() == 1)
        for name, value in (("speed", "4"), ("turn", "1")):
            number = tab.get_by_label(f"{name}, number")
            number.fill(value)
            number.press("Enter")
        _run(twin, lambda: twin.time >= END)
        tab.locator("#play").click()
        _run(twin, lambda: twin.clock.paused)
        _run(twin, lambda: tab.get_by_text("paused").count() >= 1 and tab.locator(".own img:visible").count() == 1)
        tab.mouse.move(0, SIZE["height"] - 1)
        shot = Image.open(io.BytesIO(tab.screenshot())).convert("RGB")
        browser.close()
    shot.quantize(COLORS, dither=Image.Dither.NONE).save(file, optimize=True)


def _run(twin: Twin, until: Callable[[], bool]) -> None:
    twin.run(each_frame=lambda: not until())


if __name__ == "__main__":
    draw(Path(sys.argv[1]))
