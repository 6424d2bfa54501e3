"""What a node's action says of itself, before and after it has been executed."""

import pytest
from launch_files import launch_python

from drake_twin.errors import InputError

PRINTED = "OpaqueFunction(function=lambda context: [LogInfo(msg=f'{NODE.node_name} {NODE.expanded_node_namespace}')])"
NODE = "node = Node(package='p', executable='e', name='n', namespace=['a', LaunchConfiguration('i')])"


def test_its_full_name_and_namespace_are_known_after_it_has_been_executed(tmp_path):
    entities = f"PushRosNamespace('fleet'), node, {PRINTED.replace('NODE', 'node')}"
    assert launch_python(tmp_path, entities, NODE, i="1").log == ("/fleet/a1/n /fleet/a1",)


@pytest.mark.parametrize("name", ["node_name", "expanded_node_namespace"])
def test_before_that_it_has_none_as_in_ros(tmp_path, name):
    with pytest.raises(InputError, match=f"cannot access '{name}' before executing action"):
        launch_python(tmp_path, "node", f"{NODE}\nnode.{name}", i="1")
