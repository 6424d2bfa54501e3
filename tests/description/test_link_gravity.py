"""Robots without weight, and links that have it against their file."""

import pytest

from drake_twin import TwinBuilder, World

INERTIAL = '<inertial><mass value="1"/><inertia ixx=".1" iyy=".1" izz=".1"/></inertial>'
LINK = f'<link name="{{}}">{INERTIAL}</link>'
JOINT = """<joint name="{1}_j" type="{0}"><parent link="base"/><child link="{1}"/><axis xyz="0 0 1"/>
<limit lower="-9" upper="9"/></joint>"""
TREE = (
    "".join(map(LINK.format, ("base", "fix", "arm"))) + JOINT.format("fixed", "fix") + JOINT.format("prismatic", "arm")
)

SDF_INERTIAL = "<inertial><mass>1</mass><inertia><ixx>.1</ixx><iyy>.1</iyy><izz>.1</izz></inertia></inertial>"
SLIDE = '<joint name="j" type="prismatic"><parent>base</parent><child>arm</child><axis><xyz>0 0 1</xyz></axis></joint>'


def urdf(tags):
    return f'<robot name="r">{tags}\n{TREE}</robot>'


def told(link, tag):
    return f'<gazebo reference="{link}">{tag}</gazebo>'


def sdf(base, arm):
    links = f'<link name="arm">{SDF_INERTIAL}{arm}</link><link name="base">{SDF_INERTIAL}{base}</link>'
    return f'<sdf version="1.9"><model name="r">{links}{SLIDE}</model></sdf>'


OFF, ON = "<turnGravityOff>true</turnGravityOff>", "<turnGravityOff>false</turnGravityOff>"
OFF_IN_SDF = "<gravity>false</gravity>"

# Gazebo folds `fix` into `base` and gives that the flag of either: libsdformat 12 writes <gravity>false</gravity>.
CASES = {
    "nothing": ("urdf", urdf(""), True, []),
    "all have weight": ("urdf", urdf(told("base", ON) + told("arm", "<gravity>1</gravity>")), True, []),
    "all are off": ("urdf", urdf(told("base", OFF) + told("arm", "<gravity>0</gravity>")), False, []),
    "a folded one counts": ("urdf", urdf(told("fix", OFF) + told("arm", OFF)), False, []),
    "an attribute": ("urdf", urdf(told("fix", '<gravity value="false"/>') + told("arm", OFF)), False, []),
    "one is off": ("urdf", urdf(told("arm", OFF)), True, ["gravity of arm"]),
    "one is off, folded": ("urdf", urdf(told("fix", OFF)), True, ["gravity of base"]),
    "sdf, on": ("sdf", sdf("", "<gravity>true</gravity>"), True, []),
    "sdf, off": ("sdf", sdf(OFF_IN_SDF, "<gravity>0</gravity>"), False, []),
    "sdf, empty": ("sdf", sdf("<gravity/>", ""), True, []),
    "sdf, one is off": ("sdf", sdf("", OFF_IN_SDF), True, ["gravity of arm"]),
}


@pytest.mark.parametrize(("suffix", "text", "falls", "findings"), CASES.values(), ids=CASES)
@pytest.mark.parametrize("engine", ["discrete", "cenic"])
def test_a_robot_is_without_weight_where_all_its_links_are(tmp_path, suffix, text, falls, findings, engine):
    file = tmp_path / f"r.{suffix}"
    file.write_text(text)
    twin = TwinBuilder(world=World(ground=False), engine=engine, time_step=0.001).robot("r", file).build()
    said = [finding for finding in twin.findings if "falls through the ground" not in finding.what]
    assert [finding.what.partition(":")[0] for finding in said] == findings
    assert all(finding.lines == (1,) for finding in said)
    twin.advance_to(1.0)
    height = twin.robot_state("r").base_pose[2]
    assert height == (pytest.approx(-9.81 / 2, rel=2e-3) if falls else 0.0)
    assert twin.robot_state("r").positions == (pytest.approx(0.0, abs=1e-9),)
