"""How many connections a server has, and for how long one may say nothing that is accepted."""

import asyncio
import resource
from math import inf

from aiohttp import web

MOST_CONNECTIONS = 1200
PATIENCE = 10.0  # s of wall time


class BoundedConnections:
    """Makes the protocol of each connection, so that strangers cannot take all descriptors of the process.

    Of too many connections, new ones are closed at once. One without an accepted
    request for ten seconds is closed, too.

    Args:
        server: Makes the protocols.
    """

    def __init__(self, server: web.Server):
        self._server = server
        self._since: dict[asyncio.BaseProtocol, float] = {}  # s; infinite when a request was accepted
        self._most = min(MOST_CONNECTIONS, resource.getrlimit(resource.RLIMIT_NOFILE)[0] // 2)

    def __call__(self) -> asyncio.BaseProtocol:
        """Return the protocol of a new connection."""
        return _Refused() if len(self._server.connections) >= self._most else self._server()

    def accept(self, request: web.Request) -> None:
        """Keep the connection of a request."""
        self._since[request.protocol] = inf

    def close_strangers(self) -> None:
        """Close the connections that have said nothing for too long; call it repeatedly."""
        now = asyncio.get_running_loop().time()
        self._since = {each: self._since.get(each, now) for each in self._server.connections}
        for each in self._server.connections:
            if now - self._since[each] > PATIENCE:
                each.force_close()


class _Refused(asyncio.Protocol):
    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        assert isinstance(transport, asyncio.Transport)
        transport.abort()
