"""What is not in MuJoCo's schema is told; MuJoCo's own list of its elements and attributes is the reference."""

import re

import pytest

from drake_twin.description import mjcf_names
from drake_twin.description.mjcf_names import unknown_mjcf_names
from drake_twin.description.xml_reader import XmlReader
from drake_twin.errors import InputError

mujoco = pytest.importorskip("mujoco", reason="the extra 'test' is not installed whole")

ARM = """<mujoco model="arm">
<compiler angle="degree"/>
<default><joint damping="0.1"/><geom friction="1"/></default>
<worldbody>
<body name="base" pos="0 0 0.5">
<inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>
<joint name="j" type="hinge" axis="0 1 0" range="-90 90"/>
<geom type="capsule" fromto="0 0 0 .3 0 .5" size=".02"/>
</body>
</worldbody>
<actuator>
<position joint="j" kp="3" gear="2" ctrlrange="-1 1"/>
</actuator></mujoco>"""


def told(text, file=None):
    return [(item.what, item.lines) for item in unknown_mjcf_names(XmlReader(text, file))]


def test_a_whole_robot_has_no_finding():
    assert told(ARM) == []


@pytest.mark.parametrize(
    ("right", "wrong", "line", "what"),
    [
        ("<geom friction", "<gemo friction", 3, "<gemo> in <default>. Did you mean 'geom'?"),
        ("<inertial", "<inertia", 6, "<inertia> in <body>. Did you mean 'inertial'?"),
        ("<position", "<positon", 12, "<positon> in <actuator>. Did you mean 'position'?"),
        ("damping", "dampng", 3, "the attribute dampng of <joint>. Did you mean 'damping'?"),
        ("angle", "angel", 2, "the attribute angel of <compiler>. Did you mean 'angle'?"),
        ("kp", "kpp", 12, "the attribute kpp of <position>. Did you mean 'kp'?"),
    ],
)
def test_a_name_that_mujoco_does_not_have_is_a_finding_with_its_line(right, wrong, line, what):
    assert told(ARM.replace(right, wrong)) == [(what, (line,))]


@pytest.mark.parametrize(
    ("right", "wrong", "line", "what"),
    [
        ('pos="0 0 0.5"', 'pos="0 0 0,5"', 5, "<body name='base'>: pos is '0,5', which is not a number"),
        ('pos="0 0 0.5"', 'pos="0 0"', 5, "<body name='base'>: pos is '0 0', where three numbers are needed"),
        ('mass="1"', 'mass="nan"', 6, "<inertial> of <body name='base'>: mass is 'nan', which is not finite"),
        ('gear="2"', 'gear=""', 12, "<position> of <actuator>: gear is '', where 1 to 6 numbers are needed"),
        ('size=".02"', 'size=""', 8, "<geom> of <body name='base'>: size is '', where 1 to 3"),
        ('fromto="0 0 0 .3 0 .5"', "", 8, "<geom> of <body name='base'>: size is '.02', but a capsule needs 2 of them"),
        (
            'fromto="0 0 0 .3 0 .5"',
            'pos="0 0 0" mass="-1"',
            8,
            "<geom> of <body name='base'>: mass is '-1', and it cannot be negative",
        ),
        ("</body>", '<body name="base"/></body>', 9, "<body name='base'>: another body has this name"),
        ('"hinge"', '"hing"', 7, "<joint name='j'>: unknown type 'hing'. Did you mean 'hinge'? Valid: free, ball"),
    ],
)
def test_a_value_that_mujoco_refuses_is_refused_with_its_line(right, wrong, line, what):
    with pytest.raises(InputError) as refused:
        told(ARM.replace(right, wrong), "r.xml")
    assert str(refused.value).replace('"', "'").startswith(f"r.xml:{line}: {what}")


def schema():
    """MuJoCo's elements with what they are in, and their attributes."""
    path, attributes = [], []
    for line in mujoco.mj_printSchema(False, False).splitlines():
        start = re.match(r"( *)\(?(\w+)\)?(?:body)? \(.\)\s*(.*)", line)
        if start is None:
            attributes += line.split()
            continue
        path = [*path[: len(start[1]) // 3], start[2]]
        attributes = start[3].split()
        yield tuple(path), attributes


def test_no_name_of_mujocos_own_schema_is_a_finding():
    missing = []
    for path, attributes in schema():
        above, tag = (path[-2] if len(path) > 1 else "", path[-1])  # a body is (world)body there
        above, tag = ("worldbody", "body") if tag == "world" else (above, tag)
        if above in mjcf_names._CHILDREN and tag not in (*mjcf_names._CHILDREN[above], *mjcf_names._ANYWHERE):
            missing.append((above, tag))
        known = mjcf_names._ATTRIBUTES.get(tag)
        if known is not None and above in ("mujoco", "world", "worldbody", "asset", "actuator", "contact"):
            missing += [(tag, name) for name in attributes if name not in known]
    assert missing == []
