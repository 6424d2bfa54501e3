"""Nodes that call services of the twin: with their own type, and with another one."""

from node_runs import lines, running, script

TEXT = """
import rclpy
from rclpy.node import Node
from simulation_interfaces.srv import GetSimulationState
from std_srvs.srv import Empty
rclpy.init()
node = Node("asker")

def ask(kind):
    client = node.create_client(kind, "/drake_twin/get_simulation_state")
    future = client.call_async(kind.Request())
    rclpy.spin_until_future_complete(node, future, timeout_sec=0.3)
    return future.result() if future.done() else None

print(ask(GetSimulationState).state.state)
print(ask(Empty))
"""


def test_a_service_answers_those_who_know_its_type(tmp_path, capsys):
    with running(script(tmp_path, "asker.py", TEXT)) as twin:
        twin.advance_to(1.0)
    assert lines(capsys) == ["1", "None"]  # playing
