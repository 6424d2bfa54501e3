"""``rosidl_runtime_py``: messages from and as dictionaries."""

from node_scripts import run_script

# The texts are what rosidl_runtime_py 0.13.1 of Jazzy returns (its test_convert.py and test_set_message.py).
PROGRAM = """
from builtin_interfaces.msg import Time
from geometry_msgs.msg import PoseArray, PoseStamped, PoseWithCovariance
from rosidl_runtime_py import message_to_csv, message_to_ordereddict, message_to_yaml, set_message_fields
from rosidl_runtime_py.convert import message_to_yaml as same
from sensor_msgs.msg import JointState
from std_msgs.msg import Bool, String

assert same is message_to_yaml
pose = PoseStamped()
stamps = set_message_fields(pose, {"header": "auto", "pose": {"position": {"x": 2, "y": 1.5}}}, expand_header_auto=True)
for stamp in stamps:
    stamp(Time(sec=3))
print(pose.pose.position.x, pose.pose.position.y, pose.header.stamp.sec)
state = JointState()
set_message_fields(state, {"name": ["a", "b"], "position": [1, 2.5]})
print(state.name, state.position.tolist())
both = PoseArray()
set_message_fields(both, {"poses": [{"position": {"z": 1.0}}, {}]})
print([each.position.z for each in both.poses])
broad = PoseWithCovariance()
set_message_fields(broad, {"covariance": [1.0] * 36})
print(broad.covariance.sum())
time = Time()
for wrong in ({"sec": {}}, {"no": 1}, 5):
    try:
        set_message_fields(time, wrong)
    except (AttributeError, TypeError) as error:
        print(type(error).__name__)
print(message_to_yaml(state), end="")
print(message_to_csv(state))
print(message_to_yaml(Bool(data=True), flow_style=True).strip())
print(message_to_yaml(String(data="a long word"), truncate_length=6).strip(), message_to_yaml(state, no_arr=True))
print(dict(message_to_ordereddict(time)))
"""
PRINTED = """\
2.0 1.5 3
['a', 'b'] [1.0, 2.5]
[1.0, 0.0]
36.0
TypeError
AttributeError
TypeError
header:
  stamp:
    sec: 0
    nanosec: 0
  frame_id: ''
name:
- a
- b
position:
- 1.0
- 2.5
velocity: []
effort: []
0,0,,a,b,1.0,2.5,,
{data: true}
data: a long... header:
  stamp:
    sec: 0
    nanosec: 0
  frame_id: ''
name: '<sequence type: string, length: 2>'
position: '<sequence type: double, length: 2>'
velocity: '<sequence type: double, length: 0>'
effort: '<sequence type: double, length: 0>'

{'sec': 0, 'nanosec': 0}
"""


def test_messages_from_and_as_dictionaries(tmp_path, capsys):
    assert run_script(tmp_path, PROGRAM) == ""
    assert capsys.readouterr().out == PRINTED


def test_the_modules_inside_tf2_geometry_msgs(tmp_path, capsys):
    text = "from tf2_geometry_msgs import tf2_geometry_msgs\nimport tf2_geometry_msgs.tf2_geometry_msgs as same\n"
    text += "print(tf2_geometry_msgs.do_transform_pose is same.do_transform_pose)\n"
    assert run_script(tmp_path, text) == ""
    assert capsys.readouterr().out == "True\n"
