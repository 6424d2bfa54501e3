"""Draws the picture of the page and the film that the README shows.

``python tests/docs/draw_page.py drake_twin/docs/two_rovers.png``: two rovers drive for 9 s; the camera follows one, a
wheel's position is in a plot, and time stands still at the end.

``python tests/docs/draw_page.py drake_twin/docs/rovers_and_arm.webp``: ten seconds of
`diagrams/rovers_and_arm.yaml`, filmed as anyone can film it.
"""

import io
import sys
from collections.abc import Callable
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))  # of the tests' own modules

from chromium import CHROMIUM, OFFLINE, SOFTWARE_RENDERING
from PIL import Image

from drake_twin import Twin, show
from drake_twin.description.package_index import share_folder
from drake_twin.run import main
from drake_twin.scenario.scenario_file import ScenarioFile

SIZE = {"width": 1280, "height": 800}
COLORS = 128  # the file is a third of what it is with all
END = 8.9  # s of simulation
FILM = ("--headless", "--duration", "10", "--record-size", "640x360", "--record-rate", "15")
WHEEL = "robot_1_front_left_wheel_joint"


def draw(file: Path) -> None:
    """Draw the page of two rovers into a PNG."""
    from playwright.sync_api import sync_playwright

    twin = Twin(ScenarioFile.read(share_folder("diagrams") / "two_rovers.yaml").scenario)
    with sync_playwright() as playwright, show(twin) as page:
        options = [item for item in SOFTWARE_RENDERING + OFFLINE if "antialiasing" not in item]
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=options)
        tab = browser.new_page(viewport=SIZE)
        tab.goto(page.url)
        _run(twin, lambda: tab.locator("body.ready").count() == 1)
        robot = tab.locator(".robot[data-robot=robot_1]")
        states = robot.locator("summary", has_text="Joint states")
        states.click()
        _run(twin, lambda: robot.get_by_title(f"Plot {WHEEL}").count() == 1)
        robot.get_by_title(f"Plot {WHEEL}").click()
        states.click()
        tab.get_by_role("tab", name="View").click()
        tab.get_by_label("Camera follows").select_option("robot_1")
        tab.get_by_role("tab", name="Robots").click()
        tab.evaluate("for (const item of document.querySelectorAll('*')) item.scrollTop = 0")
        _run(twin, lambda: twin.time >= END)
        tab.locator("#play").click()
        _run(twin, lambda: twin.clock.paused)
        _run(twin, lambda: tab.get_by_text("paused").count() >= 1)
        tab.mouse.move(0, SIZE["height"] - 1)
        shot = Image.open(io.BytesIO(tab.screenshot())).convert("RGB")
        browser.close()
    shot.quantize(COLORS, dither=Image.Dither.NONE).save(file, optimize=True)


def film(file: Path) -> None:
    """Film two rovers and an arm."""
    if main([str(share_folder("diagrams") / "rovers_and_arm.yaml"), *FILM, "--record", str(file)]):
        raise SystemExit(1)


def _run(twin: Twin, until: Callable[[], bool]) -> None:
    twin.run(each_frame=lambda: not until())


if __name__ == "__main__":
    for name in map(Path, sys.argv[1:]):
        (film if name.suffix == ".webp" else draw)(name)
