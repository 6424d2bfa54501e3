"""Which files of a robot's packages a program may read, and that no others are given away."""

import shutil
from pathlib import Path

import pytest
from conftest import ARM, rovers

from drake_twin import TwinBuilder
from drake_twin.services.assets import Assets

MODELS = Path(__file__).parents[2] / "models"
TURRET = "package://arduinobot_description/meshes/turret.stl"
URDF = """<robot name="one"><link name="base"><visual><geometry><mesh filename="{mesh}"/></geometry></visual>
<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link></robot>"""


def package(folder, name):
    """A package with a mesh, a robot that uses it, and files that are nobody's business."""
    place = folder / name
    (place / "meshes").mkdir(parents=True)
    (place / "package.xml").write_text(f"<package><name>{name}</name></package>")
    shutil.copy(MODELS / "arduinobot_description/meshes/turret.stl", place / "meshes/a b.stl")
    (place / "robot.urdf").write_text(URDF.format(mesh=f"package://{name}/meshes/a b.stl"))
    (place / ".git").mkdir()
    (place / ".git" / "config").write_text("secret")
    (folder / "secret.txt").write_text("secret")
    return place


@pytest.fixture
def own(tmp_path):
    """A robot of a package of its own, and the package."""
    place = package(tmp_path / "src", "own_robot")
    with TwinBuilder().robot("one", str(place / "robot.urdf")).build() as twin:
        yield twin, place


def robot_file(twin, address):
    return Assets(twin)(address)


def test_meshes_and_other_files_of_the_packages():
    with rovers(1).robot("arm", ARM, xyz=(0, -3, 0)).build() as twin:
        mesh = MODELS / "arduinobot_description/meshes/turret.stl"
        assert robot_file(twin, TURRET) == robot_file(twin, f"file://{mesh}") == mesh.read_bytes()
        assert robot_file(twin, "package://rover_description/package.xml").startswith(b"<?xml")
    with rovers(1).build() as twin:  # without the arm, its package is none of the robots'
        assert robot_file(twin, TURRET) is None


@pytest.mark.parametrize(("spare", "is_given"), [(0, True), (-1, False)])
def test_a_file_is_given_up_to_a_size(own, monkeypatch, spare, is_given):
    twin, place = own
    monkeypatch.setattr("drake_twin.services.assets._LARGEST", (place / "meshes/a b.stl").stat().st_size + spare)
    assert (robot_file(twin, "package://own_robot/meshes/a b.stl") is not None) is is_given


def test_an_address_with_a_blank(own):
    twin, place = own
    content = (place / "meshes/a b.stl").read_bytes()
    for address in ("package://own_robot/meshes/a b.stl", "package://own_robot/meshes/a%20b.stl"):
        assert robot_file(twin, address) == content


@pytest.mark.parametrize(
    "address",
    [
        "file:///etc/passwd",
        "/etc/passwd",
        "etc/passwd",
        "http://127.0.0.1/x",
        "package://",
        "package://own_robot",
        "package://own_robot/",
        "package://own_robot/meshes",
        "package://own_robot/missing.stl",
        "package://own_robot/../secret.txt",
        "package://own_robot/%2e%2e/secret.txt",
        "package://own_robot/meshes/../../secret.txt",
        "package://own_robot//etc/passwd",
        "package://other/package.xml",
        "package://../secret.txt",
        "package://own_robot/.git/config",
        "package://own_robot/meshes/../.git/config",
        "file://{place}/../secret.txt",
        "file://{place}/.git/config",
        "package://own_robot/\0",
        "package://own_robot/" + "x" * 5000,
        "",
    ],
)
def test_what_is_refused(own, address):
    twin, place = own
    assert robot_file(twin, address.format(place=place)) is None


def test_links_that_lead_out_are_refused(own):
    twin, place = own
    other = package(place.parents[1] / "elsewhere", "other_robot")
    for name, target in {
        "out.stl": place.parent / "secret.txt",
        "passwd": Path("/etc/passwd"),
        "other.stl": other / "meshes/a b.stl",
        "hidden.stl": place / ".git/config",
        "loop.stl": place / "meshes/loop.stl",
    }.items():
        (place / "meshes" / name).symlink_to(target)
        assert robot_file(twin, f"package://own_robot/meshes/{name}") is None
        assert robot_file(twin, f"file://{place}/meshes/{name}") is None
    (place / "meshes/inside.stl").symlink_to(place / "meshes/a b.stl")
    assert robot_file(twin, "package://own_robot/meshes/inside.stl")
    (place / "folder").symlink_to(place.parent)
    assert robot_file(twin, "package://own_robot/folder/secret.txt") is None


def test_a_workspace_whose_install_folder_links_to_its_sources(tmp_path):
    source = package(tmp_path / "src", "own_robot")
    share = tmp_path / "install/own_robot/share/own_robot"
    share.mkdir(parents=True)
    for name in ("package.xml", "robot.urdf", "meshes"):
        (share / name).symlink_to(source / name)
    with TwinBuilder().robot("one", str(share / "robot.urdf")).build() as twin:
        assert robot_file(twin, "package://own_robot/meshes/a b.stl") == (source / "meshes/a b.stl").read_bytes()


def test_a_source_package_that_is_installed_to_another_place(tmp_path):
    """The twin sees it as it would be installed, through links that it keeps in its cache."""
    place = package(tmp_path / "src", "own_robot")
    (place / "description").mkdir()
    (place / "meshes").rename(place / "description/meshes")
    (place / "CMakeLists.txt").write_text(
        "project(own_robot)\ninstall(DIRECTORY description/meshes DESTINATION share/${PROJECT_NAME})\n"
    )
    with TwinBuilder().robot("one", str(place / "robot.urdf")).build() as twin:
        content = (place / "description/meshes/a b.stl").read_bytes()
        assert robot_file(twin, "package://own_robot/meshes/a b.stl") == content
        assert robot_file(twin, "package://own_robot/.git/config") is None


def test_a_robot_without_a_package(tmp_path):
    shutil.copy(MODELS / "arduinobot_description/meshes/turret.stl", tmp_path / "a.stl")
    (tmp_path / "robot.urdf").write_text(URDF.format(mesh="a.stl"))
    with TwinBuilder().robot("one", str(tmp_path / "robot.urdf")).build() as twin:
        assert robot_file(twin, f"file://{tmp_path}/a.stl") is None
