"""The server by itself: who is refused, what nonsense does, and that nobody waits for a slow browser."""

import asyncio
import json
import socket
import threading
import urllib.error
import urllib.request

import pytest
from aiohttp import ClientSession, WSMsgType, WSServerHandshakeError
from pydrake.geometry import Rgba, Sphere

from drake_twin.cockpit import protocol
from drake_twin.cockpit.listening import bind
from drake_twin.cockpit.scene import Scene
from drake_twin.cockpit.server import PageServer
from drake_twin.errors import InputError

MANY = 20_000


@pytest.fixture
def server():
    server = PageServer(bind(None, "127.0.0.1"), "127.0.0.1", Scene())
    yield server
    server.close()


def get(server, path, **headers):
    """Status and text of an answer."""
    request = urllib.request.Request(f"http://127.0.0.1:{server.access.port}{path}", headers=headers)
    try:
        with urllib.request.urlopen(request) as answer:
            return answer.status, answer.read().decode()
    except urllib.error.HTTPError as error:
        return error.code, error.read().decode()


def at(server, path=""):
    return f"/{server.tokens.new()}/{path}"


def page_of(server):
    """The address of a new page."""
    return f"http://127.0.0.1:{server.access.port}{at(server)}"


def talk(server, conversation, **headers):
    """Runs a conversation over a web socket."""
    headers = {"Origin": f"http://127.0.0.1:{server.access.port}"} | headers

    async def run():
        async with (
            ClientSession() as session,
            session.ws_connect(page_of(server) + "socket", headers=headers) as web_socket,
        ):
            return await conversation(web_socket)

    return asyncio.run(run())


def until(condition):
    """Lets the server's thread work until something holds."""
    for _ in range(MANY):
        if condition():
            return
        threading.Event().wait(0.001)
    raise AssertionError("it never held")


def requests_until(server, enough):
    """Takes requests until there are enough of them."""
    taken = []

    def take():
        taken.extend(request for _, request in server.requests())
        return enough(taken)

    until(take)
    return taken


@pytest.mark.parametrize("name", ["", "page.js", "page.css", "icon.svg", "scene.js"])
def test_the_pages_files_are_served_to_who_has_the_token(server, name):
    status, text = get(server, at(server, name))
    assert status == 200
    assert text


@pytest.mark.parametrize(
    "name",
    [
        "nothing.js",
        "x" * 300,
        f"{'x' * 300}.js",
        "..%2f..%2fserver.py",
        "%2e%2e/page.py",
        "__init__.py",
        "files/run.html",
    ],
)
def test_nothing_else_is_served(server, name):
    assert get(server, at(server, name))[0] == 404


@pytest.mark.parametrize(
    "path", ["/page.js", "/index.html", "//", "/wrong/", "/wrong/page.js", "/wrong/socket", "/wrong/scene/"]
)
def test_without_the_token_everything_is_refused(server, path):
    status, text = get(server, path)
    assert status == 403
    assert "refused: " in text
    assert server.access.key not in text


def post(server, body, **headers):
    """Status and text of the answer to a key."""
    request = urllib.request.Request(f"http://127.0.0.1:{server.access.port}/", body, headers)
    try:
        with urllib.request.urlopen(request) as answer:
            return answer.status, answer.read().decode()
    except urllib.error.HTTPError as error:
        return error.code, error.read().decode()


def test_for_the_key_there_is_a_token_of_each_page(server):
    own = {"Origin": f"http://127.0.0.1:{server.access.port}"}
    pages = [post(server, server.access.key.encode(), **own) for _ in range(2)]
    assert [status for status, _ in pages] == [200, 200]
    assert pages[0] != pages[1]
    for _, token in pages:
        assert get(server, f"/{token}/")[0] == 200
    assert get(server, "/")[0] == get(server, "/entry.js")[0] == 200


@pytest.mark.parametrize("body", [b"", b"wrong", b"\xff\xfe", b"x" * 60_000])
def test_for_anything_else_there_is_none(server, body):
    status, text = post(server, body, Origin=f"http://127.0.0.1:{server.access.port}")
    assert (status, text) == (403, "refused: the key is not that of this program\n")
    assert not server.tokens._pages


@pytest.mark.parametrize(
    "headers", [{}, {"Origin": "null"}, {"Origin": "http://127.0.0.1:1"}, {"Host": "evil.example"}]
)
def test_the_key_counts_only_on_the_page_itself(server, headers):
    assert post(server, server.access.key.encode(), **headers)[0] == 403
    assert not server.tokens._pages


def test_a_long_text_is_not_read(server):
    assert post(server, b"x" * 1_000_000, Origin=f"http://127.0.0.1:{server.access.port}")[0] == 413


def connected(server):
    return socket.create_connection(("127.0.0.1", server.access.port), timeout=20)


def is_closed(client):
    try:
        return client.recv(1) == b""
    except ConnectionError:
        return True


def test_connections_that_say_nothing_are_closed_and_those_of_pages_are_not(server, monkeypatch):
    monkeypatch.setattr("drake_twin.cockpit.bounded_connections.PATIENCE", 0.0)

    async def stay(web_socket):
        with connected(server) as silent, connected(server) as half:
            half.sendall(b"GET / HTTP/1.1\r\nHost: ")
            await asyncio.to_thread(lambda: [is_closed(silent), is_closed(half)])
        await web_socket.send_str('{"do": "Pause"}')

    talk(server, stay)
    assert requests_until(server, lambda taken: len(taken) >= 2) == [protocol.Pause(), protocol.Gone()]


def test_of_too_many_connections_new_ones_are_closed_and_a_page_stays(server):
    assert get(server, "/")[0] == 200  # it has started
    server._connections._most = 5

    async def stay(web_socket):
        strangers = [connected(server) for _ in range(5)]
        assert await asyncio.to_thread(is_closed, strangers[-1])
        await web_socket.send_str('{"do": "Pause"}')
        for stranger in strangers:
            stranger.close()

    talk(server, stay)
    assert requests_until(server, lambda taken: len(taken) >= 2) == [protocol.Pause(), protocol.Gone()]


def test_a_wrong_host_is_refused(server):
    assert get(server, at(server), Host=f"evil.example:{server.access.port}")[0] == 403


def test_another_origin_is_refused(server):
    assert get(server, at(server), Origin="http://evil.example")[0] == 403


@pytest.mark.parametrize("headers", [{"Origin": "http://evil.example"}, {"Origin": "null"}, {"Host": "evil.example"}])
def test_a_web_socket_from_elsewhere_is_refused(server, headers):
    with pytest.raises(WSServerHandshakeError) as refusal:
        talk(server, lambda web_socket: web_socket.send_str('{"do": "Play"}'), **headers)
    assert refusal.value.status == 403
    assert server.requests() == []


def test_a_browser_is_sent_the_scene_and_what_changes_in_it():
    scene = Scene()
    server = PageServer(bind(None, "127.0.0.1"), "127.0.0.1", scene)
    scene.set_object("/first", Sphere(1.0), Rgba(1, 0, 0))

    async def watch():
        headers = {"Origin": f"http://127.0.0.1:{server.access.port}"}
        async with (
            ClientSession() as session,
            session.ws_connect(page_of(server) + "scene/socket", headers=headers) as web_socket,
        ):
            heard = (await web_socket.receive(10.0)).data
            while b"first" not in heard:
                heard += (await web_socket.receive(10.0)).data
            scene.set_object("/second", Sphere(1.0), Rgba(0, 1, 0))
            while b"second" not in heard:
                heard += (await web_socket.receive(10.0)).data
        return heard

    try:
        assert b"second" in asyncio.run(watch())
    finally:
        server.close()


def test_no_page_may_put_this_one_into_a_frame(server):
    for url in (server.url, page_of(server)):
        with urllib.request.urlopen(url) as answer:
            assert "frame-ancestors 'none'" in answer.headers["Content-Security-Policy"]
            assert answer.headers["Referrer-Policy"] == "no-referrer"


def test_a_thousand_malformed_messages_do_nothing(server):
    async def nonsense(web_socket):
        for index in range(1000):
            await web_socket.send_str(["", "{", "[]", '{"do": "Fly"}', '{"do": "Step", "count": -1}'][index % 5])
        await web_socket.send_bytes(b"\x00\xff" * 100)
        await web_socket.send_str('{"do": "Pause"}')

    talk(server, nonsense)
    assert requests_until(server, lambda taken: len(taken) >= 2) == [protocol.Pause(), protocol.Gone()]


def test_more_pages_than_there_is_room_for_are_sent_away(server, monkeypatch):
    monkeypatch.setattr("drake_twin.cockpit.server._MOST_CLIENTS", 0)
    with pytest.raises(WSServerHandshakeError) as refused:
        talk(server, lambda web_socket: web_socket.receive())
    assert refused.value.status == 503


def test_a_message_that_is_too_long_ends_that_connection_only(server):
    async def long(web_socket):
        await web_socket.send_str("x" * 100_000)
        return (await web_socket.receive()).type

    assert talk(server, long) in (WSMsgType.CLOSE, WSMsgType.CLOSED, WSMsgType.ERROR)
    assert requests_until(server, len) == [protocol.Gone()]
    assert get(server, at(server))[0] == 200


def test_more_requests_than_anybody_takes_are_dropped_and_the_leaving_is_not(server):
    async def flood(web_socket):
        for _ in range(1500):
            await web_socket.send_str('{"do": "Pause"}')

    talk(server, flood)
    until(lambda: not server.clients)
    taken = [request for _, request in server.requests()]
    assert len(taken) <= 1000
    assert taken[-1] == protocol.Gone()


def test_what_is_published_reaches_every_browser_and_who_comes_later_gets_the_latest(server):
    server.publish({"state": "1"})
    server.publish({"state": "2", "robots": '"r"'})

    async def listen(web_socket):
        return [json.loads((await web_socket.receive()).data) for _ in range(2)]

    assert talk(server, listen) == [{"channel": "state", "data": 2}, {"channel": "robots", "data": "r"}]


def test_a_browser_that_does_not_read_holds_nobody_up_and_the_latest_wins(server):
    """One browser never reads; megabytes are published; another one sees the last of them."""
    with socket.create_connection(("127.0.0.1", server.access.port)) as slow:
        slow.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
        slow.sendall(
            f"GET {at(server, 'socket')} HTTP/1.1\r\nHost: 127.0.0.1:{server.access.port}\r\n"
            f"Origin: http://127.0.0.1:{server.access.port}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
            "Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\n\r\n".encode()
        )
        until(lambda: server.clients)
        (neglected,) = server._clients.values()

        async def listen(web_socket):
            for number in range(300):
                server.publish({"state": json.dumps([number, "x" * 100_000])})
                server.send_bytes("/camera", bytes([number % 256]) * 100_000)
                while True:
                    received = await web_socket.receive()
                    message = json.loads(received.data) if received.type is WSMsgType.TEXT else {"channel": "bytes"}
                    if message["channel"] == "state" and message["data"][0] >= number:
                        break

        talk(server, listen)  # sixty megabytes, each seen at once
        assert neglected._pending_bytes == {"/camera": bytes([299 % 256]) * 100_000}
        assert neglected._pending.keys() <= {"state", "alive"}
        assert json.loads(neglected._pending["state"])[0] == 299
        assert neglected.socket._req.transport.get_write_buffer_size() < 1_000_000


def test_a_file_that_is_offered_is_downloaded(server):
    server.offer("run.html", b"<p>hello")
    assert get(server, at(server, "files/run.html")) == (200, "<p>hello")


def test_a_port_that_is_taken_is_left_for_the_next_one_or_refused_when_it_was_asked_for():
    with bind(None, "127.0.0.1") as one, bind(None, "127.0.0.1") as other:
        port = one.getsockname()[1]
        assert other.getsockname()[1] != port
        with pytest.raises(InputError, match=f"port {port} of 127.0.0.1 cannot be used"):
            bind(port, "127.0.0.1")


def test_an_address_of_another_machine_is_refused():
    with pytest.raises(
        InputError, match=r"no page can be served at '192.0.2.1': the address does not belong to this machine"
    ):
        bind(None, "192.0.2.1")


def test_closing_ends_the_thread(server):
    server.close()
    assert not any(thread.name == "page server" and thread is server._thread for thread in threading.enumerate())
    server.publish({"state": "1"})  # to nobody
