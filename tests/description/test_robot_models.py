"""Models that robots share, held against the same file read for one robot alone."""

import pytest

from drake_twin.description import robot_models
from drake_twin.description.package_index import PackageIndex
from drake_twin.description.robot_model import load_robot_model
from drake_twin.description.robot_models import RobotModels

URDF = """<robot name="own" xmlns:xacro="http://www.ros.org/wiki/xacro"><xacro:arg name="mass" default="1"/>
<link name="base"><inertial><mass value="$(arg mass)"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/>
</inertial><collision name="a &lt; b"><geometry><box size="1 1 1"/></geometry></collision></link></robot>"""
SDF = """<sdf version="1.9"><!-- <model name="no"> --><model name="own"><link name="base"><collision name="c"><geometry>
<box><size>1 1 1</size></box></geometry></collision></link></model></sdf>"""
MJCF = """<mujoco model="own"><worldbody><body name="base"><freejoint/><geom type="box" size="1 1 1"/>
</body></worldbody></mujoco>"""


@pytest.fixture
def reads(monkeypatch):
    names = []

    def counting(*arguments, **named):
        names.append(named["name"])
        return load_robot_model(*arguments, **named)

    monkeypatch.setattr(robot_models, "load_robot_model", counting)
    return names


def loaded(models, file, name, **changes):
    usual = {"xacro_args": {}, "without_repairs": (), "collision": "hull"}
    return models.load(str(file), name=name, **(usual | changes))


@pytest.mark.parametrize(("text", "suffix"), [(URDF, "urdf"), (SDF, "sdf"), (MJCF, "xml")])
def test_a_further_robot_of_a_file_is_as_if_it_were_read_for_it_alone(tmp_path, reads, text, suffix):
    file = tmp_path / f"r.{suffix}"
    file.write_text(text)
    packages = PackageIndex((), {})
    models = RobotModels(packages)
    loaded(models, file, "robot_1")
    shared = loaded(models, file, "robot_2")
    assert reads == ["robot_1"]
    alone = load_robot_model(str(file), packages, name="robot_2", xacro_args={})
    assert shared == alone
    assert 'robot_2"' in shared.drake_text


@pytest.mark.parametrize(
    "changes", [{"xacro_args": {"mass": "2"}}, {"without_repairs": ("missing_mesh",)}, {"collision": "decomposition"}]
)
def test_other_arguments_are_another_model(tmp_path, reads, changes):
    file = tmp_path / "r.urdf"
    file.write_text(URDF)
    models = RobotModels(PackageIndex((), {}))
    loaded(models, file, "robot_1")
    loaded(models, file, "robot_2", **changes)
    assert reads == ["robot_1", "robot_2"]
