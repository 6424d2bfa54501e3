"""``rosidl_runtime_py.utilities`` beside what that of ROS 2 Jazzy returned and raised, of which this is the record."""

import pytest
from node_scripts import run_script

NAMES = (
    *("std_msgs/msg/String", "std_msgs/String", "String", "std_msgs/msg/Nope", "nope/msg/String", "std_srvs/srv/Empty"),
    *("std_srvs/Empty", "example_interfaces/action/Fibonacci", "/std_msgs/msg/String"),
)
ABSENT, NONE, OTHER = "AttributeError", "ModuleNotFoundError", "ValueError"
FOUND = {
    "interface": ["String", ABSENT, "ValueError", ABSENT, NONE, "Empty", ABSENT, "Fibonacci", "TypeError"],
    "message": ["String", "String", "ValueError", ABSENT, NONE, OTHER, NONE, OTHER, "TypeError"],
    "service": [OTHER, NONE, "ValueError", ABSENT, NONE, "Empty", "Empty", OTHER, "TypeError"],
    "action": [OTHER, NONE, "ValueError", ABSENT, NONE, OTHER, NONE, "Fibonacci", "TypeError"],
}


@pytest.mark.parametrize("kind", FOUND)
def test_a_name_is_found_or_refused_as_in_ros(kind, tmp_path, capsys):
    text = f"""
from rosidl_runtime_py.utilities import get_{kind}
for name in {NAMES}:
    try:
        print(get_{kind}(name).__name__)
    except Exception as error:
        print(type(error).__name__)
"""
    assert run_script(tmp_path, text) == ""
    assert capsys.readouterr().out.split() == FOUND[kind]


def test_a_namespaced_type(tmp_path, capsys):
    text = """
from rosidl_parser.definition import NamespacedType
from rosidl_runtime_py import import_message_from_namespaced_type
from rosidl_runtime_py.utilities import get_message_namespaced_type, get_namespaced_type, get_service_namespaced_type
found = get_message_namespaced_type("std_msgs/String")
print(found.namespaces, found.name, found.namespaced_name(), found == get_namespaced_type("std_msgs/msg/String"))
print(found == get_service_namespaced_type("std_msgs/String"), import_message_from_namespaced_type(found).__name__)
feedback = NamespacedType(["example_interfaces", "action"], "Fibonacci_FeedbackMessage")
print(sorted(import_message_from_namespaced_type(feedback).get_fields_and_field_types()))
"""
    assert run_script(tmp_path, text) == ""
    assert capsys.readouterr().out.splitlines() == [
        "['std_msgs', 'msg'] String ('std_msgs', 'msg', 'String') True",
        "False String",
        "['feedback', 'goal_id']",
    ]
