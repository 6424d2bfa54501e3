"""Outside of node programs nothing advances the simulation, so that nothing waits."""

from drake_twin.nodes.tf2_ros.waiting import wait


def test_outside_of_node_programs_it_does_not_wait():
    asked = []
    for timeout in (0, 10**12):
        wait(lambda: asked.append(1), timeout)
    assert asked == []
