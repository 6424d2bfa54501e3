"""``topic_tools/mux``, against its source: ros-tooling/topic_tools, branch jazzy, src/mux_node.cpp."""

import pytest
from conftest import rovers
from node_runs import script

from drake_twin.nodes.nodes import Nodes
from drake_twin.scenario import NodeProgram

USER = """
import sys
import time
import rclpy
from rclpy.node import Node
from std_msgs.msg import String
from topic_tools_interfaces.srv import MuxAdd, MuxDelete, MuxList, MuxSelect

KINDS = {"add": MuxAdd, "delete": MuxDelete, "list": MuxList, "select": MuxSelect}


class User(Node):
    '''Publishes on /a, /b and /c every tenth of a second, hears /out, and asks what its arguments say, each 0.5 s.'''

    def __init__(self):
        super().__init__("user")
        for name in "abc":
            publisher = self.create_publisher(String, f"/{name}", 10)
            self.create_timer(0.1, lambda publisher=publisher, name=name: publisher.publish(String(data=name)))
        self.create_subscription(String, "/out", lambda message: self.heard.add(message.data), 10)
        self.mux = {name: self.create_client(kind, f"/mux/{name}") for name, kind in KINDS.items()}
        self.heard, self.wishes = set(), sys.argv[1:]
        time.sleep(0.05)  # so that it asks between two messages
        self.create_timer(0.5, self.ask)

    def ask(self):
        print("".join(sorted(self.heard)), flush=True)
        self.heard.clear()
        if self.wishes:
            name, _, topic = self.wishes.pop(0).partition(" ")
            request = KINDS[name].Request(**({} if name == "list" else {"topic": topic}))
            self.mux[name].call_async(request).add_done_callback(lambda future: self.told(name, future.result()))

    def told(self, name, answer):
        fields = [getattr(answer, field) for field in answer.get_fields_and_field_types()]
        print(name, *fields, flush=True)


rclpy.init()
rclpy.spin(User())
"""


@pytest.fixture
def run(tmp_path, capfd):
    def run_(*wishes):
        user = script(tmp_path, "user.py", USER)
        programs = [NodeProgram(str(user), arguments=wishes), NodeProgram("mux", "topic_tools", ("/out", "/a", "b"))]
        with rovers(1, time_step=0.01).build() as twin:
            nodes = Nodes(twin, programs)
            twin.advance_to(0.5 * len(wishes) + 0.6)
            nodes.close()
            assert twin.more_findings == []
        return capfd.readouterr().out.splitlines()

    return run_


def test_the_first_input_goes_on_until_another_is_selected(run):
    """Lines 37 (the first one), 149 (select): the names are resolved, so that /b is b."""
    assert run("select /b", "select __none", "select a") == [
        *("a", "select /a True"),
        *("b", "select /b True"),
        *("", "select  True"),
        "a",
    ]


def test_an_unknown_topic_is_not_selected(run):
    assert run("select /nowhere") == ["a", "select /a False", "a"]


def test_inputs_are_added_and_deleted(run):
    """Lines 75 (add) and 107 (delete): neither one that is there already, nor the one that is selected."""
    lines = run("add /c", "add b", "add __none", "delete /a", "delete /b", "delete /b", "list", "select /c")
    answers = [line for line in lines if line != "a"]
    assert answers == [
        *("add True", "add False", "add False", "delete False", "delete True", "delete False"),
        *("list ['/a', '/c']", "select /a True", "c"),
    ]


def test_it_needs_topics():
    with rovers(1, time_step=0.01).build() as twin:
        nodes = Nodes(twin, [NodeProgram("mux", "topic_tools", ("/out",))])
        twin.advance_to(0.1)
        nodes.close()
        (finding,) = twin.more_findings
    assert "mux needs the output's topic" in finding.what
