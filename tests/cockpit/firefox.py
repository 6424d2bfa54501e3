"""Debian's Firefox for Playwright, which speaks a newer WebDriver BiDi than the extended release knows.

Playwright starts this program as the browser. It starts Firefox, on a display of its own (without one Firefox draws no
WebGL), and stands between the two: what Firefox does not know (to collect network bodies, to emulate media) it answers
as done.
"""

import asyncio
import contextlib
import json
import os
import shutil
import signal
import subprocess
import sys

import aiohttp
from aiohttp import web

FIREFOX = next(filter(None, map(shutil.which, ("firefox-esr", "firefox"))), None)
XVFB = shutil.which("Xvfb")
REASON = "no Firefox or no Xvfb here (on Debian: apt install firefox-esr xvfb)"
SOFTWARE_RENDERING = {"webgl.force-enabled": True}
_LISTENS = "WebDriver BiDi listening on "


@contextlib.contextmanager
def launched(playwright, folder, **preferences):
    """Start Firefox, as a browser of Playwright's."""
    program = folder / "firefox"
    program.write_text(f'#!/bin/sh\nexec "{sys.executable}" "{__file__}" "$@"\n')
    program.chmod(0o755)
    with _display() as display:
        browser = playwright.firefox.launch(
            channel="moz-firefox",
            executable_path=program,
            headless=False,
            env=os.environ | {"DISPLAY": display, "LIBGL_ALWAYS_SOFTWARE": "1"},
            firefox_user_prefs=SOFTWARE_RENDERING | preferences,
        )
        try:
            yield browser
        finally:
            browser.close()


def typed(field, text):
    """Stands for Playwright's ``fill``, which puts the text beside what a number's field holds."""
    field.press("Control+a")
    field.press("Delete")
    field.press_sequentially(text)


@contextlib.contextmanager
def _display():
    read, write = os.pipe()
    options = ("-screen", "0", "1920x1200x24", "-nolisten", "tcp")
    server = subprocess.Popen(
        [XVFB, "-displayfd", str(write), *options],
        pass_fds=[write],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    os.close(write)
    try:
        with os.fdopen(read) as number:
            yield f":{number.readline().strip()}"
    finally:
        server.terminate()
        server.wait()


async def _between(request, firefox):
    playwright = web.WebSocketResponse(max_msg_size=0)
    await playwright.prepare(request)
    async with (
        aiohttp.ClientSession() as session,
        session.ws_connect(firefox + request.path, max_msg_size=0) as browser,
    ):

        async def there():
            async for message in playwright:
                await browser.send_str(message.data)
            await browser.close()

        async def back():
            async for message in browser:
                answer = json.loads(message.data)
                if answer.get("error") == "unknown command":
                    answer = {"type": "success", "id": answer["id"], "result": {"collector": "none"}}
                await playwright.send_str(json.dumps(answer))
            await playwright.close()

        await asyncio.gather(there(), back())
    return playwright


async def _main():
    process = await asyncio.create_subprocess_exec(FIREFOX, *sys.argv[1:], stderr=asyncio.subprocess.PIPE)
    for number in (signal.SIGTERM, signal.SIGINT):
        asyncio.get_running_loop().add_signal_handler(number, process.terminate)
    async for line in process.stderr:
        text = line.decode(errors="replace").rstrip()
        if text.startswith(_LISTENS):
            text = f"{_LISTENS}ws://127.0.0.1:{await _listen(text.removeprefix(_LISTENS))}"
        print(text, file=sys.stderr, flush=True)
    return await process.wait()


async def _listen(firefox):
    app = web.Application()
    app.router.add_get("/{path:.*}", lambda request: _between(request, firefox))
    runner = web.AppRunner(app)
    await runner.setup()
    site = web.TCPSite(runner, "127.0.0.1", 0)
    await site.start()
    return runner.addresses[0][1]


if __name__ == "__main__":
    sys.exit(asyncio.run(_main()))
