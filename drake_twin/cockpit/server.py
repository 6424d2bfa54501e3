"""The page's HTTP and WebSocket server, in a thread of its own; it knows nothing of the twin.

Requests of browsers wait in a queue until the twin's thread takes them. What the twin's thread publishes goes to every
browser that is connected, on named channels: the latest text of a channel wins, so a slow browser misses some and holds
nobody up.
"""

import asyncio
import queue
import socket
import threading
from collections.abc import Mapping
from importlib import resources
from pathlib import Path
from typing import Any

from aiohttp import WSMsgType, web

from drake_twin.cockpit.access import Access
from drake_twin.cockpit.protocol import Gone, Request, parse
from drake_twin.cockpit.scene import Commands, Scene
from drake_twin.errors import InputError
from drake_twin.shared_viewer.meshcat_protocol import Command

_FIRST_PORT, _LAST_PORT = 7000, 7099
_LONGEST_MESSAGE = 1 << 16  # bytes
_MOST_WAITING = 1000  # requests
_HEARTBEAT = 20.0  # s
_ALIVE = 0.5  # s
_LONGEST_NAME = 100  # of a file
_HEADERS = {
    "Cache-Control": "no-store",
    "Referrer-Policy": "no-referrer",
    "X-Content-Type-Options": "nosniff",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Resource-Policy": "same-origin",
}
_PAGE_POLICY = (
    "default-src 'self'; connect-src 'self' ws://{host}; img-src 'self' data:; frame-ancestors 'none'; base-uri 'none';"
    " form-action 'none'"
)
# Meshcat's script styles what it adds, and makes pictures of what it is sent.
_SCENE_POLICY = (
    "default-src 'self'; connect-src 'self' ws://{host} data: blob:; img-src 'self' data: blob:;"
    " style-src 'self' 'unsafe-inline'; worker-src blob:; frame-ancestors 'self'; base-uri 'none'; form-action 'none'"
)


def bind(port: int | None, host: str) -> socket.socket:
    """A listening socket for the page.

    Args:
        port: its port; by default the first free one from 7000 on.
        host: the address to listen at.

    Raises:
        InputError: the port is taken or may not be used, or the address is not this machine's.
    """
    try:
        family, _, _, _, _ = socket.getaddrinfo(host, None, type=socket.SOCK_STREAM)[0]
        with socket.socket(family) as probe:
            probe.bind((host, 0))
    except (OSError, UnicodeError):
        raise InputError(f"no page can be served at {host!r}: it is no address of this machine") from None
    for candidate in (port,) if port is not None else range(_FIRST_PORT, _LAST_PORT + 1):
        try:
            return socket.create_server((host, candidate), family=family)
        except OSError:
            continue
    if port is None:
        raise InputError(f"no page can be served at {host}: ports {_FIRST_PORT} to {_LAST_PORT} are all taken")
    raise InputError(
        f"port {port} of {host} cannot be used: another program has it, or it is not allowed. Choose another with"
        " --port, or leave --port out for the first free one"
    )


class PageServer:
    """Serves the page's files and its web socket.

    Args:
        listening: the socket, see `bind`.
        host: the address that it listens at.
        scene: what is drawn on it.
        access: what requests must carry; by default a token that is new.

    Attributes:
        access: what requests must carry.
    """

    def __init__(self, listening: socket.socket, host: str, scene: Scene, access: Access | None = None):
        self.access = access or Access(host, listening.getsockname()[1])
        self._scene = scene
        self._socket = listening
        self._requests: queue.Queue[tuple[int, Request]] = queue.Queue(_MOST_WAITING)
        self._clients: dict[int, _Client] = {}
        self._viewers: set[_Viewer] = set()
        self._latest: dict[str, str] = {}
        self._files: dict[str, bytes] = {}
        self._count = 0
        self._loop = asyncio.new_event_loop()
        self._heard = self._loop.time()
        self._ended = asyncio.Event()
        self._thread = threading.Thread(target=self._run, name="page server", daemon=True)
        self._thread.start()
        scene.listen(self._show)

    @property
    def is_watched(self) -> bool:
        """Whether a browser draws the scene."""
        return bool(self._viewers)

    @property
    def url(self) -> str:
        """The page's address, token included."""
        return self.access.url

    @property
    def clients(self) -> tuple[int, ...]:
        """The browsers that are connected, each by a number of its own."""
        return tuple(self._clients)

    def requests(self) -> list[tuple[int, Request]]:
        """Takes what browsers have asked for since the last call: each client and its request, in order."""
        taken = []
        while True:
            try:
                taken.append(self._requests.get_nowait())
            except queue.Empty:
                return taken

    def publish(self, texts: Mapping[str, str]) -> None:
        """Sends channel → text to every browser, and never waits."""
        if self._thread.is_alive():
            self._loop.call_soon_threadsafe(self._distribute, dict(texts))

    def offer(self, name: str, content: bytes) -> None:
        """Offers a file for download below the page's address; one of the same name is replaced."""
        self._files = {**self._files, name: content}

    def close(self) -> None:
        """Ends all connections and the thread."""
        if self._thread.is_alive():
            self._loop.call_soon_threadsafe(self._ended.set)
            self._thread.join(timeout=5.0)

    def _run(self) -> None:
        asyncio.set_event_loop(self._loop)
        try:
            self._loop.run_until_complete(self._serve())
        finally:
            self._loop.close()

    async def _serve(self) -> None:
        application = web.Application(middlewares=[self._guard])
        application.add_routes(
            [
                web.get("/{token}", self._to_index),
                web.get("/{token}/", self._index),
                web.get("/{token}/socket", self._web_socket),
                web.get("/{token}/scene/", self._scene_page),
                web.get("/{token}/scene/meshcat.js", self._meshcat_script),
                web.get("/{token}/scene/socket", self._scene_socket),
                web.get("/{token}/files/{name}", self._file),
                web.get("/{token}/{name}", self._static),
            ]
        )
        runner = web.AppRunner(application, access_log=None, handle_signals=False, shutdown_timeout=0.5)
        await runner.setup()
        await web.SockSite(runner, self._socket).start()
        alive = asyncio.ensure_future(self._say_alive())
        await self._ended.wait()
        alive.cancel()
        sockets = [client.socket for client in self._clients.values()] + [viewer.socket for viewer in self._viewers]
        for web_socket in sockets:
            await web_socket.close()
        await runner.cleanup()

    @web.middleware
    async def _guard(self, request: web.Request, handler: Any) -> web.StreamResponse:
        refusal = self.access.refusal(
            request.headers.get("Host"),
            request.headers.get("Origin"),
            request.path,
            needs_origin=request.path.endswith("/socket"),
        )
        if refusal is not None:
            return web.Response(status=403, text=f"refused: {refusal}\n", headers=_HEADERS)
        response: web.StreamResponse = await handler(request)
        return response

    async def _to_index(self, _request: web.Request) -> web.Response:
        raise web.HTTPFound(f"/{self.access.token}/")

    async def _index(self, request: web.Request) -> web.Response:
        return _static_response("index.html", request.host)

    async def _static(self, request: web.Request) -> web.Response:
        return _static_response(request.match_info["name"], request.host)

    async def _file(self, request: web.Request) -> web.Response:
        name = request.match_info["name"]
        content = self._files.get(name)
        if content is None:
            raise web.HTTPNotFound
        disposition = f'attachment; filename="{name}"'
        return web.Response(
            body=content, content_type="text/html", headers={**_HEADERS, "Content-Disposition": disposition}
        )

    async def _scene_page(self, request: web.Request) -> web.Response:
        return _static_response("scene.html", request.host, _SCENE_POLICY)

    async def _meshcat_script(self, _request: web.Request) -> web.Response:
        return web.Response(body=meshcat_script(), content_type="text/javascript", charset="utf-8", headers=_HEADERS)

    async def _scene_socket(self, request: web.Request) -> web.WebSocketResponse:
        """The scene's commands go out; what comes in is not looked at."""
        web_socket = web.WebSocketResponse(max_msg_size=_LONGEST_MESSAGE, heartbeat=_HEARTBEAT, compress=False)
        await web_socket.prepare(request)
        viewer = _Viewer(web_socket, self._scene.everything())
        self._viewers.add(viewer)
        sender = asyncio.ensure_future(viewer.send())
        try:
            async for _ in web_socket:
                pass
        finally:
            self._viewers.discard(viewer)
            sender.cancel()
        return web_socket

    def _show(self, commands: list[Command]) -> None:
        """Sends what changed in the scene to every browser that draws it, and never waits."""
        if self._viewers and self._thread.is_alive():
            self._loop.call_soon_threadsafe(self._give, commands)

    def _give(self, commands: list[Command]) -> None:
        for viewer in self._viewers:
            viewer.give(commands)

    async def _web_socket(self, request: web.Request) -> web.WebSocketResponse:
        web_socket = web.WebSocketResponse(max_msg_size=_LONGEST_MESSAGE, heartbeat=_HEARTBEAT, compress=False)
        await web_socket.prepare(request)
        self._count += 1
        number, client = self._count, _Client(web_socket, dict(self._latest))
        self._clients[number] = client
        sender = asyncio.ensure_future(client.send())
        try:
            async for message in web_socket:
                understood = parse(message.data) if message.type == WSMsgType.TEXT else None
                if understood is not None:
                    self._enqueue(number, understood)
        finally:
            del self._clients[number]
            sender.cancel()
            self._enqueue(number, Gone())
        return web_socket

    def _enqueue(self, client: int, request: Request) -> None:
        try:
            self._requests.put_nowait((client, request))
        except queue.Full:  # nobody moves that many sliders: it is lost, and the twin is not
            if isinstance(request, Gone):
                self._requests.get_nowait()
                self._requests.put_nowait((client, request))

    async def _say_alive(self) -> None:
        """Tells browsers again and again how long the twin's thread has been busy with something (s)."""
        while True:
            await asyncio.sleep(_ALIVE)
            for client in self._clients.values():
                client.give({"alive": f"{self._loop.time() - self._heard:.1f}"})

    def _distribute(self, texts: dict[str, str]) -> None:
        self._heard = self._loop.time()
        self._latest |= texts
        for client in self._clients.values():
            client.give(texts)


class _Client:
    """A connected browser and what it has yet to be sent."""

    def __init__(self, web_socket: web.WebSocketResponse, texts: dict[str, str]):
        self.socket = web_socket
        self._pending = texts
        self._news = asyncio.Event()
        self._news.set()

    def give(self, texts: dict[str, str]) -> None:
        self._pending |= texts
        self._news.set()

    async def send(self) -> None:
        """Sends what is pending, again and again; waits for a slow browser, and nobody waits for this."""
        while not self.socket.closed:
            await self._news.wait()
            self._news.clear()
            texts, self._pending = self._pending, {}
            for channel, text in texts.items():
                try:
                    await self.socket.send_str(f'{{"channel":"{channel}","data":{text}}}')
                except ConnectionError:
                    return


class _Viewer:
    """A browser that draws the scene, and the commands that it has yet to be sent: the newest of each kind and path."""

    def __init__(self, web_socket: web.WebSocketResponse, everything: Commands):
        self.socket = web_socket
        self._pending = everything
        self._news = asyncio.Event()
        self._news.set()

    def give(self, commands: list[Command]) -> None:
        self._pending.add(commands, keep_deletions=True)
        self._news.set()

    async def send(self) -> None:
        """Sends what is pending, again and again; waits for a slow browser, and nobody waits for this."""
        while not self.socket.closed:
            await self._news.wait()
            self._news.clear()
            pending, self._pending = self._pending, Commands()
            try:
                await self.socket.send_bytes(pending.packed())
            except ConnectionError:
                return


_STATIC_TYPES = {"html": "text/html", "css": "text/css", "js": "text/javascript", "svg": "image/svg+xml"}


def meshcat_script() -> bytes:
    """Meshcat's JavaScript, as it comes with Drake."""
    from pydrake.common import FindResourceOrThrow

    return Path(FindResourceOrThrow("drake/geometry/meshcat.js")).read_bytes()


def _static_response(name: str, host: str, policy: str = _PAGE_POLICY) -> web.Response:
    kind = _STATIC_TYPES.get(name.rpartition(".")[2])
    file = resources.files("drake_twin.cockpit").joinpath("static", name)
    if kind is None or "/" in name or len(name) > _LONGEST_NAME or not file.is_file():
        raise web.HTTPNotFound
    headers = {**_HEADERS, "Content-Security-Policy": policy.format(host=host)}
    return web.Response(body=file.read_bytes(), content_type=kind, charset="utf-8", headers=headers)
