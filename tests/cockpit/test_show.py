"""The page of a twin that a Python program made."""

# ruff: noqa: F401, F811 (fixtures are imported, and named again as arguments)

import asyncio
import gc
import subprocess
import sys
import threading
import urllib.error
import urllib.request
from http.server import BaseHTTPRequestHandler, HTTPServer
from itertools import count

import pytest
from browser import BROWSER_TESTS, browser, opened, orange_bodies, picture
from conftest import rovers
from robots_to_steer import WHEELS_1
from wires.zenoh_peer import free_port

import drake_twin
from drake_twin.cockpit import protocol
from drake_twin.errors import InputError


@pytest.fixture
def twin():
    return rovers(1, time_step=0.01).build()


@pytest.fixture
def page(twin, capsys):
    page = drake_twin.show(twin)
    yield page
    page.close()


def ask(page, *requests):
    """Puts requests where the server puts those of a browser."""
    for request in requests:
        page._page.server._enqueue(1, request)


def test_it_prints_an_address_of_this_machine_with_a_key(twin, capsys):
    with drake_twin.show(twin, port=free_port()) as page:
        assert capsys.readouterr().out == f"page: {page.url}\n"
        assert page.url.startswith("http://127.0.0.1:")
        assert repr(page) == f"TwinPage('{page.url}')"
        with urllib.request.urlopen(page.url) as answer:
            assert "<title>drake_twin" in answer.read().decode()
        with pytest.raises(urllib.error.HTTPError, match="403"):
            urllib.request.urlopen(page.url.replace("#", "page.js?"))
    assert not page.is_open
    with pytest.raises(urllib.error.URLError):
        urllib.request.urlopen(page.url)
    page.close()  # a second time does nothing
    page.process_requests()


def test_run_processes_requests_without_an_each_frame(twin, page):
    ask(page, protocol.MoveJoint(WHEELS_1, 0, 3.0))
    twin.run(0.1)
    assert twin.graph.command(WHEELS_1).data[0] == 3.0
    ask(page, protocol.Reset())
    twin.run(0.05)
    assert twin.time == pytest.approx(0.05)
    assert twin.graph.command(WHEELS_1) is None


def test_an_each_frame_of_the_programs_own_is_called_too(twin, page):
    calls = []
    ask(page, protocol.MoveJoint(WHEELS_1, 0, 3.0))
    twin.run(0.1, each_frame=lambda: calls.append(twin.time))
    assert calls
    assert twin.graph.command(WHEELS_1).data[0] == 3.0


@pytest.fixture
def frames_are_due(monkeypatch):
    """Each reading of the clock is a frame and more after the last one."""
    monkeypatch.setattr("drake_twin.show.perf_counter", count(step=0.05).__next__)


def test_an_advance_of_the_programs_own_processes_what_a_callback_can(twin, frames_are_due, page):
    ask(page, protocol.MoveJoint(WHEELS_1, 0, 3.0))
    twin.advance_to(0.1)
    assert twin.graph.command(WHEELS_1).data[0] == 3.0
    for request in (protocol.Reset(), protocol.Step(1), protocol.RunTo(9.0), protocol.Delete("robot_1")):
        ask(page, request)
        time = twin.time + 0.1
        assert twin.advance_to(time) == pytest.approx(time)
        (*_, last) = page._cockpit._log.as_plain()
        assert last["text"].startswith(
            f"{type(request).__name__} is refused while the program advances the twin itself"
        )


def test_a_pause_on_the_page_holds_an_advance_of_the_programs_own_until_play(twin, frames_are_due, page, monkeypatch):
    ask(page, protocol.Pause())
    seen = []

    def sleep(duration):
        seen.append((twin.time, twin.clock.paused))
        if len(seen) == 3:
            ask(page, protocol.Play())

    monkeypatch.setattr("drake_twin.show.sleep", sleep)
    assert twin.advance_to(0.5) == pytest.approx(0.5)
    assert seen[:3] == [(0, True)] * 3
    assert not twin.clock.paused


def test_a_pause_of_the_programs_own_ends_its_advance(twin, frames_are_due, page):
    twin.subscribe("/clock", lambda _: twin.time >= 0.2 and twin.pause(), rate=100)
    assert twin.advance_to(0.5) == pytest.approx(0.2)


def test_a_shown_twin_ends_in_the_same_bits(twin, page):
    plain = rovers(1, time_step=0.01).build()
    ask(page, protocol.Show("contacts", True))
    for it in (plain, twin):
        it.publish(WHEELS_1, [2, 2, 2, 2])
        it.advance_to(0.3)
        it.run(0.5)
    assert twin.state_sha256() == plain.state_sha256()


def test_the_second_show_of_a_twin_returns_the_same_page(twin, page):
    assert drake_twin.show(twin) is page
    page.close()
    with drake_twin.show(twin) as other:
        assert other is not page


def test_two_twins_have_pages_of_their_own(twin, page):
    with drake_twin.show(rovers(1).build()) as other:
        assert other.url != page.url


def test_a_deleted_twin_takes_its_page_with_it(capsys):
    url = drake_twin.show(rovers(1).build(), port=free_port()).url  # no other test's page takes it meanwhile
    gc.collect()
    with pytest.raises(urllib.error.URLError):
        urllib.request.urlopen(url)


def test_an_idle_asyncio_loop_processes_requests(twin, capsys, monkeypatch):
    monkeypatch.setattr("drake_twin.show._FRAME", 1e-9)  # so that it does so whenever the cells give way to it

    async def give_way():
        for _ in range(20):
            await asyncio.sleep(0)

    async def cells():
        page = drake_twin.show(twin)
        ask(page, protocol.Step(3))
        await give_way()
        page.close()
        await give_way()

    asyncio.run(cells())
    assert twin.clock.step_count == 3


def test_what_is_not_a_twin_is_refused():
    with pytest.raises(InputError, match=r"'rover' is not a twin: TwinBuilder\(...\).build\(\) makes one"):
        drake_twin.show("rover")


def test_the_name_stays_callable_after_its_module_is_imported():
    program = (
        "import drake_twin.show, drake_twin\n"
        "assert drake_twin.show.TwinPage is drake_twin.TwinPage\n"
        "try: drake_twin.show(1)\n"
        "except drake_twin.InputError as error: print(error)\n"
        "from drake_twin import show\n"
        "assert callable(show)\n"
    )
    result = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert "1 is not a twin" in result.stdout


class Notebook(HTTPServer):
    """A server of another port, whose page holds the output of a cell."""

    def __init__(self, output):
        class Handler(BaseHTTPRequestHandler):
            def do_GET(self):
                self.send_response(200)
                self.send_header("Content-Type", "text/html")
                self.end_headers()
                self.wfile.write(f"<!doctype html><title>notebook</title>{output}".encode())

            def log_message(self, *_):
                pass

        super().__init__(("127.0.0.1", 0), Handler)
        threading.Thread(target=self.serve_forever, daemon=True).start()


class TestInBrowser:
    """The page as a person uses it, in a real Chromium."""

    pytestmark = BROWSER_TESTS

    @pytest.fixture
    def tab(self, browser):
        tab = opened(browser)
        yield tab
        tab.close()

    def test_it_shows_and_steers_a_twin_that_runs(self, twin, page, tab):
        tab.goto(page.url)
        until = lambda condition: twin.run(each_frame=lambda: not condition())  # noqa: E731
        until(lambda: tab.locator("body.ready").count() == 1)
        number = tab.get_by_label("rear_left_wheel_joint velocity, number")
        number.fill("3")
        number.press("Enter")
        until(lambda: twin.graph.command(WHEELS_1) is not None)
        assert twin.graph.command(WHEELS_1).data[2] == 3.0
        tab.get_by_role("button", name="Pause").click()
        until(lambda: twin.clock.paused)
        until(lambda: orange_bodies(picture(tab)) == 1)

    def test_a_cell_of_a_notebook_shows_it_before_anything_runs_and_then_steers_it(self, twin, page, tab):
        notebook = Notebook(page._repr_html_())
        tab.goto(f"http://127.0.0.1:{notebook.server_port}/")
        cell = tab.frame_locator("iframe")
        cell.locator("body.ready").wait_for()
        assert cell.locator("#time").inner_text() == "0.000 s"
        assert cell.frame_locator("#scene").locator("#meshcat-pane canvas").count() == 1
        cell.get_by_role("button", name="Pause").click()
        twin.run(each_frame=lambda: not twin.clock.paused)
        notebook.shutdown()
        notebook.server_close()
