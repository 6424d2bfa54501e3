"""The page's HTTP and WebSocket server, in a thread of its own; it does not know the twin.

Requests of browsers are queued until the twin's thread takes them, and a listener is told that there are some. What the
twin's thread publishes is sent to every connected browser on named channels. The latest text of a channel replaces an
unsent one, so that a slow browser misses some texts and delays no other browser.
"""

import asyncio
import queue
import socket
import threading
from collections import deque
from collections.abc import Callable, Collection, Iterator, Mapping
from contextlib import contextmanager
from importlib import resources
from typing import Any

from aiohttp import WSMsgType, web
from aiohttp.typedefs import Handler

from drake_twin.cockpit.access import Access
from drake_twin.cockpit.bounded_connections import BoundedConnections
from drake_twin.cockpit.connected_browsers import Client, Viewer
from drake_twin.cockpit.page_tokens import PageTokens
from drake_twin.cockpit.protocol import EmergencyStop, Gone, Request, parse
from drake_twin.cockpit.scene import Scene, meshcat_script
from drake_twin.shared_viewer.meshcat_protocol import Command

_LONGEST_MESSAGE = 1 << 16  # bytes
_MOST_PENDING = 1000  # requests
_MOST_CLIENTS = 500  # web sockets of pages, and as many of their scenes
_HEARTBEAT = 20.0  # s
_LOADING = 5.0  # s that a page may take from its first request to its scene's connection
_ALIVE = 0.5  # s between two messages that the server is alive
_ENTRY = {"/": "entry.html", "/entry.js": "entry.js"}  # what needs no token, and its files
_LONGEST_NAME = 100  # of a static file
_STATIC_TYPES = {"html": "text/html", "css": "text/css", "js": "text/javascript", "svg": "image/svg+xml"}
_HEADERS = {
    "Cache-Control": "no-store",
    "Referrer-Policy": "no-referrer",
    "X-Content-Type-Options": "nosniff",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Resource-Policy": "same-origin",
}
_PAGE_POLICY = (
    "default-src 'self'; connect-src 'self' ws://{host}; img-src 'self' data:; frame-ancestors {ancestors};"
    " base-uri 'none'; form-action 'none'"
)
# Meshcat's script adds inline styles, and creates images from the data that it receives.
_SCENE_POLICY = (
    "default-src 'self'; connect-src 'self' ws://{host} data: blob:; img-src 'self' data: blob:;"
    " style-src 'self' 'unsafe-inline'; worker-src blob:; frame-ancestors {ancestors}; base-uri 'none';"
    " form-action 'none'"
)
_ANCESTORS, _SCENE_ANCESTORS = "'none'", "'self'"
_OF_THIS_MACHINE = "http://127.0.0.1:* http://localhost:* https://127.0.0.1:* https://localhost:*"


class PageServer:
    """Serves the page's files and its web socket.

    Args:
        listening: The socket, see `drake_twin.cockpit.listening.bind`.
        host: The address that it listens on.
        scene: The scene to draw.
        access: What requests must carry; by default with a new key.
        tokens: The tokens of the pages that it knows; by default none.
        in_frames: Whether pages of other servers on this machine may show the page in an iframe.

    Attributes:
        access: What requests must carry.
        tokens: The tokens of its pages.
    """

    def __init__(
        self,
        listening: socket.socket,
        host: str,
        scene: Scene,
        access: Access | None = None,
        tokens: PageTokens | None = None,
        *,
        in_frames: bool = False,
    ):
        self.access = access or Access(host, listening.getsockname()[1])
        self.tokens = PageTokens() if tokens is None else tokens
        self._in_frames = in_frames
        self._scene = scene
        self._socket = listening
        self._requests: queue.Queue[tuple[int, Request]] = queue.Queue(_MOST_PENDING)
        self._heard: Callable[[], object] = lambda: None
        self._clients: dict[int, Client] = {}
        self._viewers: set[Viewer] = set()
        self._latest: dict[str, str] = {}
        self._files: dict[str, bytes] = {}
        self._count = 0
        self._calls: deque[tuple[Callable[..., None], tuple[Any, ...]]] = deque()
        self._is_held = False
        self._loop = asyncio.new_event_loop()
        self._published = self._loop.time()
        self._expected = 0.0  # until when the scene of a page that loads may connect (s)
        self._ended = asyncio.Event()
        self._thread = threading.Thread(target=self._run, name="page server", daemon=True)
        self._thread.start()
        scene.listen(self._show)
        scene.write_in(self._call)

    @property
    def is_watched(self) -> bool:
        """Whether a connected browser draws the scene, or will: what it draws is read while it loads the page."""
        return bool(self._viewers) or self._loop.time() < self._expected

    @property
    def url(self) -> str:
        """The address that opens a page, with the key."""
        return self.access.url

    @property
    def clients(self) -> tuple[int, ...]:
        """The numbers of the connected browsers."""
        return tuple(self._clients)

    def listen(self, heard: Callable[[], object]) -> None:
        """Call a function in the server's thread after each request, in place of the one before."""
        self._heard = heard

    def requests(self) -> list[tuple[int, Request]]:
        """Return the requests since the last call, in order, each with its client's number."""
        taken: list[tuple[int, Request]] = []
        if self._requests.empty():  # an exception in each frame would cost more
            return taken
        while True:
            try:
                taken.append(self._requests.get_nowait())
            except queue.Empty:
                return taken

    @contextmanager
    def together(self) -> Iterator[None]:
        """Send what the twin's thread sends inside of this at its end: to wake the server's thread costs the most."""
        self._is_held = True
        try:
            yield
        finally:
            self._is_held = False
            if self._calls and self._thread.is_alive():
                self._loop.call_soon_threadsafe(self._do_calls)

    def publish(self, texts: Mapping[str, str]) -> None:
        """Send texts to every browser, by channel; return at once."""
        self._call(self._distribute, dict(texts))

    def send_bytes(self, key: str, data: bytes) -> None:
        """Send bytes to every browser, in place of unsent ones of the same key; return at once."""
        if self._clients:
            self._call(self._distribute_bytes, key, data)

    def offer(self, name: str, content: bytes) -> None:
        """Serve a file below ``files/`` of the page's address, in place of one of the same name."""
        self._files = {**self._files, name: content}

    def close(self) -> None:
        """End all connections and the thread."""
        if self._thread.is_alive():
            self._loop.call_soon_threadsafe(self._ended.set)
            if threading.current_thread() is not self._thread:  # where the garbage collector may call this
                self._thread.join(timeout=5.0)

    def _run(self) -> None:
        asyncio.set_event_loop(self._loop)
        try:
            self._loop.run_until_complete(self._serve())
        finally:
            self._loop.close()

    async def _serve(self) -> None:
        application = web.Application(middlewares=[self._guard], client_max_size=_LONGEST_MESSAGE)
        application.add_routes(
            [
                web.get("/", self._entry),
                web.post("/", self._new_page),
                web.get("/entry.js", self._entry),
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
        assert runner.server is not None
        self._connections = BoundedConnections(runner.server)
        listening = await self._loop.create_server(self._connections, sock=self._socket)
        alive = asyncio.ensure_future(self._report_alive())
        await self._ended.wait()
        alive.cancel()
        listening.close()
        sockets = [client.socket for client in self._clients.values()] + [viewer.socket for viewer in self._viewers]
        for web_socket in sockets:
            await web_socket.close()
        await runner.cleanup()

    @web.middleware
    async def _guard(self, request: web.Request, handler: Handler) -> web.StreamResponse:
        token = request.path.removeprefix("/").partition("/")[0]
        refusal = self.access.refusal(
            request.headers.get("Host"),
            request.headers.get("Origin"),
            needs_origin=request.method == "POST" or request.path.endswith("/socket"),
        )
        if refusal is None and request.path not in _ENTRY and token not in self.tokens:
            refusal = "the address has no token of an open page: use the address that the program printed"
        if refusal is not None:
            return web.Response(status=403, text=f"refused: {refusal}\n", headers=_HEADERS)
        if request.path not in _ENTRY:
            self._connections.accept(request)
        return await handler(request)

    async def _entry(self, request: web.Request) -> web.Response:
        """Return the page that exchanges the key for a token."""
        return self._static_response(_ENTRY[request.path], request, _PAGE_POLICY, _ANCESTORS)

    async def _new_page(self, request: web.Request) -> web.Response:
        """Return the token of a new page, if the request has the key."""
        if not self.access.is_key(await request.read()):
            return web.Response(status=403, text="refused: the key is not that of this program\n", headers=_HEADERS)
        return web.Response(text=self.tokens.new(), headers=_HEADERS)

    async def _index(self, request: web.Request) -> web.Response:
        self._expected = self._loop.time() + _LOADING
        return self._static_response("index.html", request, _PAGE_POLICY, _ANCESTORS)

    async def _static(self, request: web.Request) -> web.Response:
        return self._static_response(request.match_info["name"], request, _PAGE_POLICY, _ANCESTORS)

    async def _file(self, request: web.Request) -> web.Response:
        name = request.match_info["name"]
        content = self._files.get(name)
        if content is None:
            raise web.HTTPNotFound
        disposition = f'attachment; filename="{name}"'
        return web.Response(
            body=content,
            content_type=_STATIC_TYPES[name.rpartition(".")[2]],
            headers={**_HEADERS, "Content-Disposition": disposition},
        )

    async def _scene_page(self, request: web.Request) -> web.Response:
        return self._static_response("scene.html", request, _SCENE_POLICY, _SCENE_ANCESTORS)

    def _static_response(self, name: str, request: web.Request, policy: str, ancestors: str) -> web.Response:
        """Return one of the page's own files.

        Args:
            name: The file's name.
            request: The request.
            policy: Its content security policy.
            ancestors: The pages that may show it in a frame, besides those of this machine where that is allowed.
        """
        kind = _STATIC_TYPES.get(name.rpartition(".")[2])
        file = resources.files("drake_twin.cockpit").joinpath("static", name)
        if kind is None or "/" in name or len(name) > _LONGEST_NAME or not file.is_file():
            raise web.HTTPNotFound
        if self._in_frames:
            ancestors = f"{_SCENE_ANCESTORS} {_OF_THIS_MACHINE}"
        headers = {**_HEADERS, "Content-Security-Policy": policy.format(host=request.host, ancestors=ancestors)}
        return web.Response(body=file.read_bytes(), content_type=kind, charset="utf-8", headers=headers)

    async def _meshcat_script(self, _request: web.Request) -> web.Response:
        return web.Response(body=meshcat_script(), content_type="text/javascript", charset="utf-8", headers=_HEADERS)

    async def _scene_socket(self, request: web.Request) -> web.WebSocketResponse:
        """Send the scene's commands; messages of the browser are ignored."""
        _check_room(self._viewers)
        web_socket = web.WebSocketResponse(max_msg_size=_LONGEST_MESSAGE, heartbeat=_HEARTBEAT, compress=False)
        await web_socket.prepare(request)
        viewer = Viewer(web_socket, self._scene.everything())
        self._viewers.add(viewer)
        self._expected = 0.0
        sender = asyncio.ensure_future(viewer.send())
        try:
            with self.tokens.connected(request.match_info["token"]):
                async for _ in web_socket:
                    pass
        finally:
            self._viewers.discard(viewer)
            sender.cancel()
        return web_socket

    def _show(self, commands: list[Command]) -> None:
        """Send changes of the scene to every browser that draws it; return at once."""
        if self._viewers:
            self._call(self._add, commands)

    def _call(self, function: Callable[..., None], *arguments: Any) -> None:
        """Have a function called in the server's thread, unless that has ended; return at once."""
        if not self._thread.is_alive():
            return
        self._calls.append((function, arguments))
        if threading.current_thread() is self._thread:
            self._loop.call_soon(self._do_calls)
        elif not self._is_held:
            self._loop.call_soon_threadsafe(self._do_calls)

    def _do_calls(self) -> None:
        while self._calls:
            function, arguments = self._calls.popleft()
            self._loop.call_soon(function, *arguments)

    def _add(self, commands: list[Command]) -> None:
        for viewer in self._viewers:
            viewer.add(commands)

    async def _web_socket(self, request: web.Request) -> web.WebSocketResponse:
        _check_room(self._clients)
        web_socket = web.WebSocketResponse(max_msg_size=_LONGEST_MESSAGE, heartbeat=_HEARTBEAT, compress=False)
        await web_socket.prepare(request)
        self._count += 1
        number, client = self._count, Client(web_socket, dict(self._latest))
        self._clients[number] = client
        sender = asyncio.ensure_future(client.send())
        try:
            with self.tokens.connected(request.match_info["token"]):
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
        except queue.Full:  # more than a person can cause: the request is dropped
            if isinstance(request, Gone | EmergencyStop):
                self._requests.get_nowait()
                self._requests.put_nowait((client, request))
        self._heard()

    async def _report_alive(self) -> None:
        """Send repeatedly how long ago the twin's thread has published (s)."""
        while True:
            await asyncio.sleep(_ALIVE)
            self._connections.close_strangers()
            for client in self._clients.values():
                client.add({"alive": f"{self._loop.time() - self._published:.1f}"})

    def _distribute_bytes(self, key: str, data: bytes) -> None:
        for client in self._clients.values():
            client.add_bytes(key, data)

    def _distribute(self, texts: dict[str, str]) -> None:
        self._published = self._loop.time()
        self._latest |= texts
        for client in self._clients.values():
            client.add(texts)


def _check_room(connected: Collection[object]) -> None:
    if len(connected) >= _MOST_CLIENTS:
        raise web.HTTPServiceUnavailable(text=f"{_MOST_CLIENTS} pages are open, which is the most\n")
