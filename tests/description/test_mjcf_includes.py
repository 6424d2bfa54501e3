"""Includes of MJCF files and their sections in several places: what MuJoCo makes of the same files."""

import pytest

from drake_twin import TwinBuilder
from drake_twin.errors import InputError

mujoco = pytest.importorskip("mujoco")

# A scene that includes its robot, as many public ones do; the robot has parts of its own, from two folders.
FILES = {
    "scene.xml": """<mujoco model="scene"><include file="robot/arm.xml"/>
<default><geom friction="0.7"/><joint armature="0.02"/></default>
<worldbody><light pos="0 0 3"/><geom type="plane" size="1 1 .1"/></worldbody>
<actuator><position joint="elbow" kp="30" kv="3"/></actuator></mujoco>""",
    "robot/arm.xml": """<mujoco model="arm"><compiler angle="radian"/><include file="parts/defaults.xml"/>
<worldbody><body name="base" pos="0 0 0.5"><geom type="box" size=".1 .1 .1"/>
<include file="robot/parts/links.xml"/></body></worldbody>
<actuator><include file="motors.xml"/></actuator></mujoco>""",
    "robot/parts/defaults.xml": """<mujocoinclude><default><geom density="500"/><joint damping="0.3"/></default>
</mujocoinclude>""",
    "robot/parts/links.xml": """<mujocoinclude>
<body name="upper" pos="0 0 .1"><joint name="shoulder" axis="0 1 0" range="-1.2 1.5"/>
<geom type="box" size=".02 .02 .1"/><body name="lower" pos="0 0 .2"><joint name="elbow" axis="0 1 0"/>
<geom type="box" size=".02 .02 .1"/></body></body>
</mujocoinclude>""",
    "robot/motors.xml": '<x><motor name="m" joint="shoulder" ctrlrange="-2 2" ctrllimited="true"/></x>',
}


@pytest.fixture
def written(tmp_path):
    """Writes the files, some of them in other words, and gives the scene's."""

    def write(**changed):
        for name, text in FILES.items():
            (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
            (tmp_path / name).write_text(changed.get(name.rpartition("/")[2].removesuffix(".xml"), text))
        return tmp_path / "scene.xml"

    return write


def test_a_robot_of_several_files_is_mujocos(written, monkeypatch, tmp_path_factory):
    monkeypatch.chdir(tmp_path_factory.mktemp("elsewhere"))
    file = written()
    theirs = mujoco.MjModel.from_xml_path(str(file))
    twin = TwinBuilder().robot("r", file).build()
    (plan,) = twin.built.plans
    joints = plan.description.joints_by_name
    assert twin.robot_state("r").joints == ("shoulder", "elbow")
    for number, name in enumerate(("shoulder", "elbow")):
        assert joints[name].damping == pytest.approx(theirs.dof_damping[number])
        assert joints[name].armature == pytest.approx(theirs.dof_armature[number])
    assert (joints["shoulder"].limits.lower, joints["shoulder"].limits.upper) == pytest.approx(theirs.jnt_range[0])
    masses = [twin.plant.GetBodyByName(name).default_mass() for name in ("base", "upper", "lower")]
    assert masses == pytest.approx(theirs.body_mass[1:])
    assert [joint.name for joint in plan.description.actuated_joints] == ["shoulder", "elbow"]


def test_findings_are_where_they_are_written(written):
    links = FILES["robot/parts/links.xml"].replace("<geom type", '<site name="s"/>\n<geom type', 1)
    file = written(links=links, motors='<x>\n<motor joint="shoulder"/>\n<cylinder joint="elbow"/></x>')
    lost = [str(finding) for finding in TwinBuilder().robot("r", file).build().findings]
    assert any("<cylinder> of <actuator>" in text and "motors.xml:3" in text for text in lost)
    assert any("<geom> of the world" in text and "scene.xml:3" in text for text in lost)


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"motors": "<x/>"}, "robot/arm.xml:4: the included file 'motors.xml' is empty"),
        (
            {"scene": '<mujoco>\n<include file="gone.xml"/></mujoco>'},
            "scene.xml:2: the included file 'gone.xml' does not",
        ),
        ({"scene": "<mujoco>\n\n<include/></mujoco>"}, "scene.xml:3: <include> needs a file"),
        (
            {"scene": '<mujoco><include file="robot/arm.xml"/>\n<include file="robot/arm.xml"/></mujoco>'},
            "scene.xml:2: the file 'robot/arm.xml' is included twice",
        ),
        ({"motors": "<x>"}, "robot/motors.xml:1: this is not well-formed XML"),
    ],
)
def test_what_mujoco_refuses_is_refused_with_its_line(written, changed, message):
    file = written(**changed)
    with pytest.raises(ValueError, match=r"."):
        mujoco.MjModel.from_xml_path(str(file))
    with pytest.raises(InputError) as caught:
        TwinBuilder().robot("r", file).build()
    assert message in str(caught.value)
