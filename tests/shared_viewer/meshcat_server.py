"""A real ``meshcat-server`` of the PyPI package, and what it has on its page, read as any client may."""

import base64
import re
import socket
import subprocess
import sys

import umsgpack
import zmq


def free_address(host="127.0.0.1"):
    with socket.socket() as probe:
        probe.bind((host, 0))
        return f"tcp://{host}:{probe.getsockname()[1]}"


class MeshcatServer:
    """A server process; the first one chooses its address, and one that is started again keeps it."""

    def __init__(self, host="127.0.0.1"):
        self.url = free_address(host)
        self.start()

    def start(self):
        program = [sys.executable, "-u", "-c", "from meshcat.servers.zmqserver import main; main()"]
        self.process = subprocess.Popen(
            [*program, "--zmq-url", self.url], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True
        )
        assert self.process.stdout.readline() == f"zmq_url={self.url}\n"
        self.page = self.process.stdout.readline().removeprefix("web_url=").strip()

    def kill(self):
        self.process.kill()
        self.process.wait()
        self.process.stdout.close()

    def ask(self, *frames):
        with zmq.Context() as context, context.socket(zmq.REQ) as client:
            client.linger, client.rcvtimeo = 0, 20_000
            client.connect(self.url)
            client.send_multipart(frames)
            return client.recv()

    def scene(self):
        """Path → the commands that stand there: ``set_object`` and ``set_transform``, the last of each."""
        found = re.findall(r'base64,([\w+/=]+)"\)', self.ask(b"get_scene").decode())
        commands = [umsgpack.unpackb(base64.b64decode(text)) for text in found]
        scene = {}
        for command in commands:
            scene.setdefault(command["path"], {})[command["type"]] = command
        return scene
