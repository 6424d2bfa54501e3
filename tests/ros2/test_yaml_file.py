import pytest
from launch_files import launch_xml, write

from drake_twin.errors import InputError
from drake_twin.ros2.evaluate import evaluate

FULL = """\
launch:
- arg: {name: i, default: "1", description: which}
- let: {name: v, value: "$(var i)x"}
- set_env: {name: E, value: "1"}
- group:
    scoped: true
    children:
    - push_ros_namespace: {namespace: r}
    - node:
        pkg: p
        exec: e
        name: n$(var v)
        args: -a $(var i)
        if: "true"
        param:
        - name: number
          value: 5
        - name: text
          value: "5"
          type: str
        - name: flag
          value: true
        - name: list
          value: [1.5, 2]
        - name: outer
          param:
          - {name: inner, value: $(var i)}
        - from: /a.yaml
        remap:
        - {from: a, to: b}
        env:
        - {name: A, value: "2"}
- group:
  - log: {message: in a list}
- include:
    file: $(dirname)/inner.launch.yaml
    arg:
    - {name: who, value: you}
- executable: {cmd: echo hello}
- timer:
    period: 2.0
    children:
    - node: {pkg: p, exec: late}
"""


def test_a_yaml_file_with_everything(tmp_path):
    write(tmp_path / "inner.launch.yaml", "launch:\n- log: {message: for $(var who)}\n")
    launched = evaluate(write(tmp_path / "x.launch.yaml", FULL))
    node, command, late = launched.processes
    assert (node.full_name, node.arguments, node.remappings) == ("/r/n1x", ("-a", "1"), (("a", "b"),))
    values = [entry for entry in node.parameters if isinstance(entry, dict)]
    assert values == [{"number": 5}, {"text": "5"}, {"flag": True}, {"list": (1.5, 2.0)}, {"outer.inner": 1}]
    assert str(node.parameters[-1]) == "/a.yaml"
    assert node.environment == {"E": "1", "A": "2"}
    assert str(node.place) == f"{tmp_path}/x.launch.yaml:9"
    assert command.arguments == ("hello",)
    assert late.start_time == 2.0
    assert launched.log == ("in a list", "for you")


def test_xml_includes_yaml(tmp_path):
    write(tmp_path / "inner.launch.yaml", "launch:\n- log: {message: for $(var who)}\n")
    elements = '<include file="$(dirname)/inner.launch.yaml"><let name="who" value="you"/></include>'
    assert launch_xml(tmp_path, elements).log == ("for you",)


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("launch:\n- nod: {}\n", r"yaml:2: <nod>: unknown element. Did you mean 'node'"),
        ("launch:\n- node: {pkg: p}\n", r"yaml:2: <node>: the attribute 'exec' is missing"),
        ("launch:\n- node\n", r"yaml:2: launch.0: an action is a mapping with one entry"),
        ("launch:\n- node: p\n", r"yaml:2: launch.0.node: 'p' is not a mapping"),
        ("lunch: []\n", "has one entry, launch"),
        ("", "has one entry, launch"),
        ("launch: [", "this is not valid YAML"),
        (
            "a: &a [x,x,x,x,x,x,x,x,x]\n"
            + "".join(f"{chr(98 + i)}: &{chr(98 + i)} [{','.join(9 * [f'*{chr(97 + i)}'])}]\n" for i in range(8))
            + "launch: *i\n",
            "holds more than 200000 values",
        ),
    ],
)
def test_what_is_wrong_is_refused_with_its_line(tmp_path, text, reason):
    with pytest.raises(InputError, match=reason):
        evaluate(write(tmp_path / "x.launch.yaml", text))
