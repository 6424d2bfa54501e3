"""Three hundred tabs, three hundred half requests and a flood of messages: the twin runs as if nobody were there."""

import subprocess
import sys

import pytest
from conftest import rovers

from drake_twin.cockpit import server as page_server
from drake_twin.cockpit.served_page import ServedPage

MANY = 300

CROWD = """
import asyncio, sys
import aiohttp

url, many = sys.argv[1], int(sys.argv[2])
origin = url.rsplit("/", 2)[0]
port = int(origin.rpartition(":")[2])


async def flood(socket):
    while True:
        for _ in range(100):
            await socket.send_str('{"do": "SetRate", "rate": -1}')
        await asyncio.sleep(0.01)  # ten thousand a second


async def main():
    halves = [await asyncio.open_connection("127.0.0.1", port) for _ in range(many)]
    for _, writer in halves:
        writer.write(b"GET / HTTP/1.1\\r\\nHost: ")
    async with aiohttp.ClientSession(connector=aiohttp.TCPConnector(limit=0)) as session:
        tabs = [await session.ws_connect(url + "socket", origin=origin, max_msg_size=0) for _ in range(many)]
        scenes = [await session.ws_connect(url + "scene/socket", origin=origin, max_msg_size=0) for _ in range(many)]
        print("there", flush=True)
        await flood(tabs[0])  # nobody reads


asyncio.run(main())
"""


@pytest.fixture
def served():
    served = ServedPage()
    yield served
    served.close()


def test_a_crowd_changes_nothing_in_the_twin(served):
    commands = "/robot_1/forward_velocity_controller/commands"
    alone = rovers(2).command(commands, [2.0, 2.0, 2.0, 2.0]).build()
    alone.advance_to(1.0)
    twin = rovers(2).command(commands, [2.0, 2.0, 2.0, 2.0]).build()
    cockpit = served.show(twin)
    url = f"http://127.0.0.1:{served.server.access.port}/{served.server.tokens.new()}/"
    crowd = subprocess.Popen([sys.executable, "-c", CROWD, url, str(MANY)], stdout=subprocess.PIPE, text=True)
    try:
        assert crowd.stdout.readline() == "there\n"
        frames = 0

        def each_frame():
            nonlocal frames
            frames += 1
            cockpit.process_requests()

        while len(served.server.clients) < MANY:
            cockpit.process_requests()
        twin.run(until=1.0, each_frame=each_frame)
        assert twin.time == pytest.approx(1.0)
        assert twin.state_sha256() == alone.state_sha256()
        assert frames > 20
        assert len(served.server.clients) == MANY
        assert served.server._requests.qsize() <= page_server._MOST_PENDING
        refused = [line for line in cockpit._log.as_plain() if "speed" in line["text"] or "rate" in line["text"]]
        assert len(refused) == 1  # counted, not listed again and again
        for client in served.server._clients.values():
            assert client.socket._req.transport.get_write_buffer_size() < 5_000_000
    finally:
        crowd.kill()
        crowd.wait()
