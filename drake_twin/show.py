"""The page of a twin that a Python program made; `drake_twin.show` serves it."""

import asyncio
import sys
import weakref
from time import perf_counter, sleep
from types import ModuleType
from typing import cast

from drake_twin.cockpit.own_panels import OwnPanels
from drake_twin.cockpit.page_panel import PagePanel
from drake_twin.cockpit.served_page import ServedPage
from drake_twin.errors import InputError
from drake_twin.messages import shortened
from drake_twin.twin.owner import Owned, any_thread
from drake_twin.twin.twin import Twin

_FRAME = 1 / 30  # s


def show(twin: Twin, *, port: int | None = None, open_browser: bool = False) -> "TwinPage":
    """Serve a page that shows and steers a twin, and print its address; in a notebook's cell, show it there.

    The page listens on 127.0.0.1 only, and its address holds a key. It processes requests and draws:

    - in each frame of `Twin.run`;
    - while the program calls `Twin.advance_to` or `Twin.step`, where a pause on the page holds the program until the
      page continues, and requests that move the twin in time, spawn or delete are refused;
    - while an asyncio loop that runs in this thread is idle, as between the cells of a notebook;
    - whenever the program calls `TwinPage.process_requests`.

    Args:
        twin: The twin. A second call for the same twin returns the same page.
        port: The page's port; by default the first free one from 7000 on.
        open_browser: Whether to open the page in a browser, too.

    Returns:
        The page. It is served until it is closed or the twin is deleted; the caller need not keep it.

    Raises:
        InputError: If ``twin`` is not a twin, or the port cannot be used.
    """
    if not isinstance(twin, Twin):
        raise InputError(f"{shortened(twin)} is not a twin: TwinBuilder(...).build() makes one")
    pages = (getattr(callback, "__self__", None) for callback in twin.frames.callbacks)
    page = next((item for item in pages if isinstance(item, TwinPage)), None) or TwinPage(twin, port)
    page._page.announce(open_browser=open_browser)
    return page


class TwinPage(Owned, path="page"):
    """A page that shows and steers a twin. `show` makes one; it is a context manager that closes the page at its end.

    Args:
        twin: The twin.
        port: The page's port; by default the first free one from 7000 on.

    Raises:
        InputError: If the port cannot be used.
    """

    def __init__(self, twin: Twin, port: int | None = None):
        self._owner = twin.owner
        self._twin = twin
        self._page = ServedPage(port, in_frames=True)
        self._cockpit = self._page.show(twin)
        self._cockpit.draw()  # for a browser that connects before the first request is processed
        self._cockpit.publish()
        self._processed = perf_counter()
        twin.frames.callbacks.append(self.process_requests)
        self._end_subscription = twin.subscribe("/clock", self._on_clock, rate=1 / _FRAME)
        self._end_server = weakref.finalize(twin, self._page.server.close)
        self._end_server.atexit = False
        try:
            loop = asyncio.get_running_loop()
        except RuntimeError:
            return
        loop.call_soon(_process_when_idle, weakref.ref(self), loop)

    @property
    @any_thread
    def url(self) -> str:
        """The address that opens the page, with the program's key."""
        return self._page.url

    @property
    @any_thread
    def is_open(self) -> bool:
        """Whether the page is served."""
        return self._end_server.alive

    def process_requests(self) -> None:
        """Process the page's requests, draw the present state and publish it; call it between steps."""
        if self.is_open:
            self._process()

    def panel(self, title: str) -> PagePanel:
        """Return a new panel of the page, to be filled with sliders, buttons, plots, …; it replaces one of its title.

        Raises:
            InputError: If the title is not a short text of one line.
        """
        return cast(OwnPanels, self._cockpit.panels["own"]).add(title)

    def close(self) -> None:
        """End the page. The twin is not changed."""
        if self.is_open:
            self._end_server.detach()
            self._twin.frames.callbacks.remove(self.process_requests)
            self._end_subscription()
            self._page.close()

    def _process(self, *, in_callback: bool = False) -> None:
        self._cockpit.process_requests(in_callback=in_callback)
        self._processed = perf_counter()

    def _on_clock(self, _message: object) -> None:
        """Process requests inside an advance of the program's own, 30 times a second of wall time at most."""
        if self._twin.frames.are_running or perf_counter() - self._processed < _FRAME:
            return
        was_paused = self._twin.clock.paused
        self._process(in_callback=True)
        while self._twin.clock.paused and not was_paused:
            sleep(_FRAME)
            self._process(in_callback=True)

    def __enter__(self) -> "TwinPage":
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __repr__(self) -> str:
        return f"TwinPage({self.url!r})"

    def _repr_html_(self) -> str:
        """Return an iframe with the page, which notebooks show below a cell."""
        return f'<iframe src="{self.url}" title="drake_twin" style="width: 100%; height: 640px; border: 0"></iframe>'


def _process_when_idle(page: "weakref.ref[TwinPage]", loop: asyncio.AbstractEventLoop) -> None:
    """Process a page's requests from an asyncio loop, which runs this between its other tasks."""
    known = page()
    if known is not None and known.is_open:
        if known._owner.is_here:  # else the thread that runs it processes them
            known.process_requests()
        loop.call_later(_FRAME, _process_when_idle, page, loop)


class _CallableModule(ModuleType):
    """Keeps ``drake_twin.show(twin)`` callable: importing this module binds the name to the module itself."""

    def __call__(self, twin: Twin, *, port: int | None = None, open_browser: bool = False) -> TwinPage:
        return show(twin, port=port, open_browser=open_browser)


sys.modules[__name__].__class__ = _CallableModule
