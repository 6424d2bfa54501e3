"""The page in a real browser: fixtures and helpers of the tests that operate its controls and check the twin's state.

The browser is Chromium; ``-m "browser and slow"`` runs the same tests in Firefox. The scene is drawn from the moment on
that a test looks at it; after a failure a screenshot of each tab is in the test's ``tmp_path``.
"""

import contextlib
import io

import firefox
import numpy as np
import pytest
from chromium import CHROMIUM, OFFLINE, SOFTWARE_RENDERING
from conftest import FAILED, rovers
from PIL import Image

from drake_twin import Twin
from drake_twin.cockpit import server
from drake_twin.cockpit.served_page import ServedPage

PIXELS = 0.5  # of a screen for each of the page, both ways: the processor draws each of them

# The processor draws the scene, which takes longer than all else on the page.
DRAWN_ON_DEMAND = """
Object.defineProperty(window, "MeshCat", { configurable: true, set(library) {
  Object.defineProperty(window, "MeshCat", { value: library });
  const render = library.Viewer.prototype.render;
  library.Viewer.prototype.render = function () {
    window.shownViewer = this;
    if (window.isDrawn) return render.call(this);
    this.needs_render = false;
    this.camera.updateProjectionMatrix();
    this.camera.updateMatrixWorld();
    this.scene.updateMatrixWorld();
  };
} });
"""

READ_BACK = ("GL Driver Message", "ReadPixels", "willReadFrequently")  # tests look at what was drawn

_ALSO_PLAYWRIGHT = "; script-src 'self' 'unsafe-eval'; style-src 'self' 'unsafe-inline'"

_SHORT, _LONG = 1000, 30_000  # ms that a look at the page waits for its element: between two frames, and else

BROWSER_TESTS = [
    pytest.mark.browser,
    pytest.mark.skipif(CHROMIUM is None, reason="no Chromium here (on Debian: apt install chromium)"),
]


NO_FIREFOX = pytest.mark.skipif(firefox.FIREFOX is None or firefox.XVFB is None, reason=firefox.REASON)


@contextlib.contextmanager
def started(name, folder):
    """Start a browser by its name."""
    from playwright.sync_api import Locator, sync_playwright

    with sync_playwright() as playwright:
        if name == "firefox":
            with pytest.MonkeyPatch.context() as patch:
                patch.setattr(Locator, "fill", firefox.typed)
                for policy in ("_PAGE_POLICY", "_SCENE_POLICY"):  # Playwright evaluates its own code in the page
                    patch.setattr(server, policy, getattr(server, policy) + _ALSO_PLAYWRIGHT)
                with firefox.launched(playwright, folder) as browser:
                    yield browser
            return
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=SOFTWARE_RENDERING + OFFLINE)
        yield browser
        browser.close()


@pytest.fixture(scope="module", params=["chromium", pytest.param("firefox", marks=[pytest.mark.slow, NO_FIREFOX])])
def browser(request, tmp_path_factory):
    with started(request.param, tmp_path_factory.mktemp("browser")) as browser:
        yield browser


def opened(browser):
    """A new tab."""
    tab = browser.new_page(viewport={"width": 1280, "height": 800}, device_scale_factor=PIXELS)
    tab.add_init_script(DRAWN_ON_DEMAND)
    return tab


def heard(tab, faults=None):
    """The list that each error and each line of the console comes to, but for those that a test itself causes."""
    faults = [] if faults is None else faults
    tab.on("pageerror", lambda error: faults.append(str(error)))
    tab.on("console", lambda line: any(text in line.text for text in READ_BACK) or faults.append(line.text))
    return faults


class Shown:
    """A twin, its page's server side, and browsers' tabs with the page."""

    def __init__(self, browser, scenario, **options):
        self._browser = browser
        self.served = ServedPage()
        self.scene = self.served.scene
        self.twin = Twin(scenario)
        self.cockpit = self.served.show(self.twin, **options)
        self.tabs = []
        self.faults = []
        self.late = "nothing was missing on the page"

    def tab(self):
        """Opens the page in a new tab and waits until it shows something."""
        tab = opened(self._browser)
        heard(tab, self.faults)
        self.tabs.append(tab)
        tab.goto(self.served.url)
        self.frames(lambda: len(self.served.server.clients) == len(self.tabs))
        self.frames(lambda: len(self.served.server._viewers) == len(self.tabs))
        self.frames(lambda: tab.locator("body.ready").count() == 1)
        return tab

    def frames(self, until, most=900):
        """Run frame by frame, as the program does, until something holds; what is not on the page yet does not."""
        from playwright.sync_api import TimeoutError as NotThereError

        count = 0

        def holds():
            try:
                return until()
            except NotThereError as error:  # it may need a further frame
                self.late = error
                return False

        def each_frame():
            nonlocal count
            count += 1
            self.cockpit.process_requests()
            return not holds() and count < most

        for tab in self.tabs:
            tab.set_default_timeout(_SHORT)
        try:
            self.twin.run(each_frame=each_frame)
            assert holds(), f"not within {most} frames ({self.late})"
        finally:
            for tab in self.tabs:
                tab.set_default_timeout(_LONG)

    def seen(self, locator, text):
        """Runs until an element reads as wanted."""
        self.frames(lambda: locator.inner_text() == text)

    def for_frames(self, count):
        """Runs so many frames."""
        left = iter(range(count))
        self.frames(lambda: next(left, None) is None, most=count + 2)

    def close(self):
        for tab in self.tabs:
            tab.close()
        self.served.close()


@pytest.fixture
def show(browser, request, tmp_path):
    """Shows a scenario in a tab; screenshots are taken when the test has failed."""
    shown = []

    def show_(scenario, **options):
        it = Shown(browser, scenario, **options)
        shown.append(it)
        return it, it.tab()

    yield show_
    for it in shown:
        for number, tab in enumerate(it.tabs if request.node.stash[FAILED] else []):
            draw(tab)
            tab.screenshot(path=tmp_path / f"after_{number}.png")
        it.close()
        assert it.faults == [], it.faults


@pytest.fixture
def page(show):
    """Two rovers that stand still."""
    return show(rovers(2).scenario())


def folder(tab, robot="robot_1"):
    return tab.locator(f".robot[data-robot={robot}]")


def open_tab(tab, name):
    """Choose a tab of the side panel."""
    tab.get_by_role("tab", name=name, exact=True).click(force=True)


def draw(tab):
    """Draws the scene from now on, each pixel of it."""
    tab.locator("#scene").evaluate(
        "({ contentWindow: scene }) => { if (!scene.isDrawn) scene.shownViewer.drawWhole(); scene.isDrawn = true;"
        " scene.shownViewer.set_dirty(); }"
    )


def picture(tab):
    """The scene's pixels, once two pictures in a row are alike; without the banner that no frame runs meanwhile."""
    draw(tab)
    banner = tab.locator("#connection")
    banner.evaluate("element => { element.style.visibility = 'hidden'; }")
    last = None
    for _ in range(40):
        shot = tab.locator("#scene").screenshot(scale="css")
        if shot == last:
            break
        last = shot
    banner.evaluate("element => { element.style.visibility = ''; }")
    return np.asarray(Image.open(io.BytesIO(last)).convert("RGB")).astype(int)


def changed(before, after):
    """How many pixels differ clearly."""
    return int((np.abs(after - before).sum(axis=2) > 60).sum())


def orange(shot):
    """Where the orange of a rover's body is: rows and columns."""
    red, green, blue = shot[..., 0], shot[..., 1], shot[..., 2]
    return np.nonzero((red > 130) & (red > 1.6 * green) & (green > 1.5 * blue))


def orange_bodies(shot):
    """How many groups of columns, 30 pixels or more apart, hold the orange of a rover's body."""
    _, columns = orange(shot)
    columns = np.unique(columns)
    return 1 + int((np.diff(columns) >= 30).sum()) if len(columns) else 0
