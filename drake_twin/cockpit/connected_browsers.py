"""The browsers that are connected to the page's server, each with what it is still to be sent."""

import asyncio

from aiohttp import web

from drake_twin.cockpit.scene import Commands
from drake_twin.shared_viewer.meshcat_protocol import Command


class Client:
    """A connected browser and its unsent texts.

    Args:
        web_socket: Its connection.
        texts: What it is sent first, by channel.
    """

    def __init__(self, web_socket: web.WebSocketResponse, texts: dict[str, str]):
        self.socket = web_socket
        self._pending = texts
        self._pending_bytes: dict[str, bytes] = {}
        self._news = asyncio.Event()
        self._news.set()

    def add(self, texts: dict[str, str]) -> None:
        """Send texts by channel soon."""
        self._pending |= texts
        self._news.set()

    def add_bytes(self, key: str, data: bytes) -> None:
        """Send bytes soon, in place of unsent ones of the same key."""
        self._pending_bytes[key] = data
        self._news.set()

    async def send(self) -> None:
        """Send what is pending until the connection ends; a slow browser delays only this."""
        while not self.socket.closed:
            await self._news.wait()
            self._news.clear()
            texts, self._pending = self._pending, {}
            many_bytes, self._pending_bytes = self._pending_bytes, {}
            try:
                for channel, text in texts.items():
                    await self.socket.send_str(f'{{"channel":"{channel}","data":{text}}}')
                for data in many_bytes.values():
                    await self.socket.send_bytes(data)
            except ConnectionError:
                return


class Viewer:
    """A browser that draws the scene and its unsent commands: the newest of each kind and path.

    Args:
        web_socket: Its connection.
        everything: What it is sent first.
    """

    def __init__(self, web_socket: web.WebSocketResponse, everything: Commands):
        self.socket = web_socket
        self._pending = everything
        self._news = asyncio.Event()
        self._news.set()

    def add(self, commands: list[Command]) -> None:
        """Send commands soon."""
        self._pending.add(commands, keep_deletions=True)
        self._news.set()

    async def send(self) -> None:
        """Send what is pending until the connection ends; a slow browser delays only this."""
        while not self.socket.closed:
            await self._news.wait()
            self._news.clear()
            pending, self._pending = self._pending, Commands()
            try:
                await self.socket.send_bytes(pending.packed())
            except ConnectionError:
                return
