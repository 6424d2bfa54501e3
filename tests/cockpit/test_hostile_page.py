"""A page of another site, in the browser that shows the twin's page: it reads nothing of the twin, and moves nothing.

The site is another port of this machine, another host, and another host whose name has come to mean this machine (DNS
rebinding). It knows what a stranger cannot know: the ports, the program's key, and the token of the page that is open.
"""

import asyncio
import socket
import threading
from pathlib import Path
from subprocess import PIPE, Popen, TimeoutExpired
from sys import executable
from urllib.parse import urlsplit

import pytest
from aiohttp import web
from browser import DRAWN_ON_DEMAND
from chromium import CHROMIUM, OFFLINE, SOFTWARE_RENDERING

from drake_twin import Recording

ATTACK = (Path(__file__).parent / "hostile.js").read_text(encoding="utf-8")
PAGE = f"<!doctype html><title>evil</title><body><script>{ATTACK}</script>"
FOXGLOVE = "foxglove.sdk.v1"
HOSTS = ("127.0.0.1", "localhost", "evil.example")

pytestmark = [
    pytest.mark.browser,
    pytest.mark.skipif(CHROMIUM is None, reason="no Chromium here (on Debian: apt install chromium)"),
]


def free():
    with socket.create_server(("127.0.0.1", 0)) as taken:
        return taken.getsockname()[1]


class Site:
    """A server of its own in a thread: pages of another site, and one that lets everybody do everything."""

    def __init__(self):
        self._loop = asyncio.new_event_loop()
        self._started = threading.Event()
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()
        self._started.wait()

    def _run(self):
        self._loop.run_until_complete(self._serve())

    async def _serve(self):
        application = web.Application()
        application.router.add_route("*", "/{path:.*}", self._answer)
        runner = web.AppRunner(application)
        await runner.setup()
        await web.TCPSite(runner, "127.0.0.1", 0).start()
        self.port = runner.addresses[0][1]
        self._ended = asyncio.Event()
        self._started.set()
        await self._ended.wait()
        await runner.cleanup()

    async def _answer(self, request):
        path = request.match_info["path"]
        if path == "evil":
            return web.Response(text=PAGE, content_type="text/html")
        if request.headers.get("Upgrade"):
            open_to_all = web.WebSocketResponse(protocols=[FOXGLOVE])
            await open_to_all.prepare(request)
            await open_to_all.send_str("secret")
            return open_to_all
        kinds = {"js": "text/javascript", "css": "text/css", "svg": "image/svg+xml", "socket": "text/event-stream"}
        kind = kinds.get(path.rpartition(".")[2], kinds["socket"] if path.endswith("socket") else "text/html")
        text = "<p>open" if kind == "text/html" else ""
        if kind == "image/svg+xml":
            text = '<svg xmlns="http://www.w3.org/2000/svg" width="1" height="1"/>'
        if kind == "text/javascript":
            text = "self.onconnect = ({ports}) => ports[0].postMessage(1); if (!self.document) self.postMessage?.(1);"
        allowed = {
            "Access-Control-Allow-Origin": request.headers.get("Origin", "*"),
            "Access-Control-Allow-Credentials": "true",
        }
        return web.Response(text=text, content_type=kind, headers=allowed)

    def close(self):
        self._loop.call_soon_threadsafe(self._ended.set)
        self._thread.join()


@pytest.fixture(scope="module")
def site():
    site = Site()
    yield site
    site.close()


@pytest.fixture(scope="module")
def browser():
    from playwright.sync_api import sync_playwright

    rules = ["--host-resolver-rules=MAP *.example 127.0.0.1", "--disable-features=LocalNetworkAccessChecks"]
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=[*SOFTWARE_RENDERING, *OFFLINE, *rules])
        context = browser.new_context()
        context.add_init_script(DRAWN_ON_DEMAND)
        yield context
        browser.close()


class Program:
    """``drake_twin.run`` with all that a browser can reach."""

    def __init__(self, folder):
        self.recording = folder / "run.json"
        options = ["--robots", "1", "--no-browser", "--foxglove", "--foxglove-control"]
        ports = [free(), free()]
        options += ["--port", str(ports[0]), "--foxglove-port", str(ports[1]), "--record", str(self.recording)]
        command = [executable, "-m", "drake_twin.run", *options]
        self.process = Popen(command, stdout=PIPE, stderr=PIPE, text=True)
        self.foxglove = f"http://127.0.0.1:{ports[1]}"
        self.url = (
            next(line for line in self.process.stdout if line.startswith("page: ")).removeprefix("page: ").strip()
        )
        self.origin, _, self.key = self.url.partition("/#")

    def end(self):
        self.process.terminate()
        try:
            return self.process.communicate(timeout=60)
        except TimeoutExpired:
            self.process.kill()
            raise


@pytest.fixture(scope="module")
def program(tmp_path_factory):
    program = Program(tmp_path_factory.mktemp("program"))
    yield program
    if program.process.poll() is None:
        program.end()


@pytest.fixture(scope="module")
def shown(program, browser):
    """The twin's page in a tab of the same browser."""
    tab = browser.new_page()
    tab.goto(program.url)
    tab.locator("body.ready").wait_for()
    return tab


def attacked(browser, evil, base, paths, key):
    """What a page of an address has got from a server, by what it tried."""
    tab = browser.new_page()
    tab.route(evil, lambda route: route.fulfill(body=PAGE, content_type="text/html"))
    tab.goto(evil)
    found = tab.evaluate("(given) => attack(...given)", [base, paths, FOXGLOVE if paths == ["/"] else [], key])
    tab.close()
    return found


def test_the_attacks_are_some(site, browser):
    """Against a server that lets everybody do everything: each of them works, from another site or from the same."""
    base = f"http://127.0.0.1:{site.port}"
    other = attacked(browser, f"http://evil.example:{site.port}/evil", base, ["/"], "key")
    same = attacked(browser, f"{base}/evil", base, ["/"], "key")
    reach = {what.removesuffix(" /") for what, found in other.items() if found}
    assert {"fetch cors", "post cors", "file", "script", "module", "style", "picture", "events"} <= reach
    assert {"socket", "scene's socket", "port's socket"} <= reach
    assert [what for what, found in same.items() if not found] == []


@pytest.mark.parametrize("host", HOSTS)
def test_a_page_of_another_site_reads_nothing(program, shown, browser, site, host):
    token = urlsplit(shown.url).path
    for base, paths in ((program.origin, ["/", token]), (program.foxglove, ["/"])):
        found = attacked(browser, f"http://{host}:{site.port}/evil", base, paths, program.key)
        assert {what: text for what, text in found.items() if text} == {}


def test_a_name_that_comes_to_mean_this_machine_reads_refusals(program, shown, browser):
    token = urlsplit(shown.url).path
    for base, paths in ((program.origin, ["/", token]), (program.foxglove, ["/"])):
        evil = base.replace("127.0.0.1", "rebound.example")
        found = attacked(browser, f"{evil}/evil", evil, paths, program.key)
        assert found["fetch cors /"].startswith("refused: the Host header ")
        assert {what: text for what, text in found.items() if text and "refused: the Host header" not in text} == {}


def test_the_page_is_shown_in_no_frame_and_works_in_a_window_that_the_site_cannot_touch(program, shown, browser, site):
    tab = browser.new_page()
    tab.goto(f"http://127.0.0.1:{site.port}/evil")
    assert tab.evaluate("address => framed(address)", shown.url) == ""
    assert [frame.url for frame in tab.frames if frame.url.startswith(program.origin)] == []
    with browser.expect_page() as opening:
        tab.evaluate("address => { window.other = window.open(address); }", shown.url)
    opening.value.locator("body.ready").wait_for()  # as if the user had opened it again
    assert tab.evaluate("[window.other.closed, window.other.length]") == [True, 0]
    assert opening.value.evaluate("window.opener") is None
    opening.value.close()
    tab.close()


def test_nothing_has_moved_the_twin(program, shown):
    """After all of the above: what changes a twin is recorded, and that is one press on the twin's own page."""
    shown.get_by_role("button", name="Stop all").first.click()
    shown.locator(".robot").first.get_by_text("stopped").first.wait_for()
    assert shown.locator("#connection").is_hidden()
    _, err = program.end()
    assert program.process.returncode == 0, err
    assert "Traceback" not in err
    calls = Recording.load(program.recording).calls
    assert [call.name for call in calls] == ["emergency_stop"]
