"""A package that a stranger wrote to do harm: it is contained, and what is wrong with it is said in a paragraph."""

import os

import pytest

from drake_twin.check import main as check
from drake_twin.run import main as run

SECRET = "the secret of another folder"
INERTIAL = '<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'
XACRO = 'xmlns:xacro="http://www.ros.org/wiki/xacro"'
LINK = f'<link name="a">{INERTIAL}</link>'
BOMB = "<!DOCTYPE x [<!ENTITY e0 'boom'>{levels}]>".format(
    levels="".join(f"<!ENTITY e{level} '{f'&e{level - 1};' * 20}'>" for level in range(1, 12))
)
OUTSIDE = "<!DOCTYPE x [<!ENTITY e SYSTEM 'file://{file}'>]>"

# What is checked or run, and its text; BODY stands for what the case puts there.
KINDS = {
    "r.urdf": f'<robot name="r">{LINK}<gazebo reference="a"><mu1>BODY</mu1></gazebo></robot>',
    "r.urdf.xacro": f'<robot name="r" {XACRO}>{LINK}<gazebo reference="a"><mu1>BODY</mu1></gazebo></robot>',
    "r.sdf": '<sdf version="1.9"><model name="m"><link name="BODY"/></model></sdf>',
    "r.xml": '<mujoco model="m"><custom><text name="a" data="BODY"/></custom><worldbody><body name="b"><freejoint/>'
    '<geom type="box" size="1 1 1"/></body></worldbody></mujoco>',
    "r.launch.xml": '<launch><let name="a" value="BODY"/></launch>',
}


@pytest.fixture
def package(tmp_path, monkeypatch):
    (tmp_path / "secret").write_text(SECRET)
    package = tmp_path / "ws" / "evil"
    package.mkdir(parents=True)
    (package / "package.xml").write_text("<package><name>evil</name></package>")
    monkeypatch.chdir(package)
    return package


def said(capsys, name):
    """What is said of a file; it ends in a robot or in one paragraph, and nothing outside was read or written."""
    code = run([name, "--headless", "--duration", "0.01"]) if "launch" in name else check([name])
    output = capsys.readouterr()
    text = output.out + output.err
    assert code in (0, 1, 2)
    assert "Traceback" not in text
    assert SECRET not in text
    assert not os.path.exists("pwned")
    return code, text


@pytest.mark.parametrize("name", KINDS)
def test_entities_that_multiply(package, capsys, name):
    (package / name).write_text(BOMB + KINDS[name].replace("BODY", "&e11;"))
    code, text = said(capsys, name)
    assert code != 0
    assert len(text) < 2_000


@pytest.mark.parametrize("name", KINDS)
def test_entities_that_read_other_files(package, capsys, name):
    outside = OUTSIDE.format(file=package.parents[1] / "secret")
    (package / name).write_text(outside + KINDS[name].replace('"BODY"', '"x"').replace("BODY", "&e;"))
    said(capsys, name)


@pytest.mark.parametrize("bad", ["<package>", BOMB + "<package><name>&e11;</name></package>"])
def test_a_package_description_that_is_a_bomb(package, capsys, bad):
    (package / "package.xml").write_text(bad)
    (package / "r.urdf").write_text(KINDS["r.urdf"].replace("BODY", "0.5"))
    assert said(capsys, "r.urdf")[0] == 0


@pytest.mark.parametrize(
    "name",
    ["$(touch pwned)", "`touch pwned`", "; touch pwned", "&lt;script&gt;alert(1)&lt;/script&gt;", "../../x", "%s%n"],
)
def test_names_that_are_scripts(package, capsys, name):
    (package / "r.urdf").write_text(f'<robot name="{name}"><link name="{name}">{INERTIAL}</link></robot>')
    said(capsys, "r.urdf")
    assert sorted(file.name for file in package.iterdir()) == ["package.xml", "r.urdf"]
    assert sorted(file.name for file in package.parents[1].iterdir()) == ["secret", "ws"]


def test_folders_that_contain_themselves(package, capsys):
    (package / "loop").symlink_to("..")
    (package / "meshes").symlink_to("meshes")
    mesh = '<visual><geometry><mesh filename="package://evil/{}/a.stl"/></geometry></visual>'
    shapes = "".join(mesh.format(folder) for folder in ("loop/evil/loop/evil", "meshes"))
    (package / "r.urdf").write_text(f'<robot name="r"><link name="a">{INERTIAL}{shapes}</link></robot>')
    assert "a.stl" in said(capsys, "r.urdf")[1]


@pytest.mark.parametrize("address", ["../../secret", "package://evil/../../secret", "file:///etc/passwd", "link.stl"])
def test_meshes_that_are_other_files(package, capsys, address):
    (package / "link.stl").symlink_to(package.parents[1] / "secret")
    mesh = f'<visual><geometry><mesh filename="{address}"/></geometry></visual>'
    (package / "r.urdf").write_text(f'<robot name="r"><link name="a">{INERTIAL}{mesh}</link></robot>')
    assert "root:" not in said(capsys, "r.urdf")[1]


@pytest.mark.parametrize("number", ["1e308", "9" * 400, "-1e300", "nan", "1e-320"])
def test_numbers_that_overflow(package, capsys, number):
    robot = f'<robot name="r"><link name="a">{INERTIAL}<collision><origin xyz="{number} 0 0"/><geometry>'
    (package / "r.urdf").write_text(f'{robot}<sphere radius="{number}"/></geometry></collision></link></robot>')
    said(capsys, "r.urdf")
