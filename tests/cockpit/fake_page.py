"""A page without a browser: what it asks for is put into a list, and what it is told is kept."""

import json
from contextlib import nullcontext

from drake_twin.cockpit.cockpit import Cockpit
from drake_twin.cockpit.scene import Scene


class FakeServer:
    def __init__(self):
        self.clients = (1,)
        self.is_watched = True
        self.told = {}
        self.files = {}
        self.pictures = {}
        self._asked = []

    def together(self):
        return nullcontext()

    def ask(self, request, client=1):
        self._asked.append((client, request))
        self.heard()

    def listen(self, heard):
        self.heard = heard

    def requests(self):
        asked, self._asked = self._asked, []
        return asked

    def publish(self, texts):
        self.told |= {channel: json.loads(text) for channel, text in texts.items()}

    def send_bytes(self, key, data):
        self.pictures[key] = data

    def offer(self, name, content):
        self.files[name] = content


class FakePage:
    """A cockpit and the page in front of it."""

    def __init__(self, twin, scene=None, **options):
        self.twin = twin
        self.server = FakeServer()
        self.cockpit = Cockpit(self.server, scene or Scene(), twin, **options)

    def ask(self, *requests, client=1):
        """Asks, and lets the twin's thread obey."""
        for request in requests:
            self.server.ask(request, client)
        self.cockpit.process_requests()

    def frames(self, until, most=600):
        """Runs frame by frame, as the program does, until something holds."""
        count = 0

        def each_frame():
            nonlocal count
            count += 1
            self.cockpit.process_requests()
            return not until() and count < most

        self.twin.run(each_frame=each_frame, as_fast_as_possible=not self.twin.clock.paused)
        assert until(), f"not within {most} frames"

    @property
    def state(self):
        """The last snapshot; two frames make sure of one."""
        self.cockpit.process_requests()
        self.cockpit.process_requests()
        return self.server.told["state"]

    @property
    def robots(self):
        return {robot["name"]: robot for robot in self.server.told["robots"]["robots"]}

    @property
    def messages(self):
        return [(line["level"], line["text"]) for line in self.server.told["messages"]]
