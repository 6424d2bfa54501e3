from pathlib import Path

import pytest

from drake_twin.description.package_index import PackageIndex, containing_package, share_folder, workspace_folders
from drake_twin.errors import InputError


def package(folder: Path, name: str | None = None) -> Path:
    folder.mkdir(parents=True)
    (folder / "package.xml").write_text(f"<package><name>{name or folder.name}</name></package>")
    return folder


def index(*folders: Path, **environment: Path) -> PackageIndex:
    return PackageIndex(folders, {name: str(value) for name, value in environment.items()})


def test_a_package_is_found_by_its_folder(tmp_path):
    rover = package(tmp_path / "rover")
    assert index(tmp_path).find("rover") == rover


def test_a_package_is_found_by_the_name_in_its_package_xml_when_its_folder_is_called_otherwise(tmp_path):
    rover = package(tmp_path / "stack" / "folder_7", "rover")
    assert index(tmp_path).find("rover") == rover


def test_the_name_in_package_xml_counts_more_than_the_name_of_the_folder(tmp_path):
    package(tmp_path / "rover", "another")
    rover = package(tmp_path / "folder_7", "rover")
    assert index(tmp_path).find("rover") == rover


def test_a_folder_given_may_be_the_package_itself(tmp_path):
    rover = package(tmp_path / "checkout", "rover")
    assert index(rover).find("rover") == rover


def test_a_folder_without_package_xml_is_found_by_its_name(tmp_path):
    (tmp_path / "rover").mkdir()
    assert index(tmp_path).find("rover") == tmp_path / "rover"


def test_packages_are_looked_for_in_the_order_of_the_documentation(tmp_path):
    given = package(tmp_path / "given" / "rover")
    arm = package(tmp_path / "ws" / "src" / "arm")
    neighbour = package(tmp_path / "ws" / "src" / "rover")
    installed = package(tmp_path / "ament" / "share" / "rover")
    colcon = package(tmp_path / "colcon" / "share" / "rover")
    ros = package(tmp_path / "ros" / "rover")
    gazebo = package(tmp_path / "gz" / "rover")
    environment = {
        "AMENT_PREFIX_PATH": tmp_path / "ament",
        "COLCON_PREFIX_PATH": tmp_path / "colcon",
        "ROS_PACKAGE_PATH": tmp_path / "ros",
        "GZ_SIM_RESOURCE_PATH": tmp_path / "gz",
    }
    near = arm / "urdf" / "arm.urdf"
    assert index(given.parent, **environment).find("rover", near) == given
    assert index(**environment).find("rover", near) == neighbour
    for variable, expected in zip(list(environment), [installed, colcon, ros, gazebo], strict=True):
        assert index(**environment).find("rover") == expected
        del environment[variable]


def test_every_folder_of_a_search_path_is_looked_in(tmp_path):
    package(tmp_path / "a" / "arm")
    rover = package(tmp_path / "b" / "rover")
    assert index(ROS_PACKAGE_PATH=f"{tmp_path / 'a'}:{tmp_path / 'b'}").find("rover") == rover


def test_the_environment_of_the_process_is_the_default(tmp_path, monkeypatch):
    rover = package(tmp_path / "share" / "rover")
    monkeypatch.setenv("AMENT_PREFIX_PATH", str(tmp_path))
    assert PackageIndex().find("rover") == rover


def test_the_twins_own_models_are_found_last():
    assert index().find("rover_description") == share_folder("models") / "rover_description"


def test_a_package_finds_itself_and_neighbours_anywhere_below_its_workspaces_src(tmp_path):
    arm = package(tmp_path / "src" / "stack_1" / "arm")
    rover = package(tmp_path / "src" / "stack_2" / "rover")
    assert index().find("rover", arm / "urdf" / "arm.urdf") == rover
    assert index().find("arm", arm / "urdf" / "arm.urdf") == arm


@pytest.mark.parametrize("place", ["rover", "stack/rover"])
def test_a_package_under_colcon_ignore_is_not_seen(tmp_path, place):
    ignored = package(tmp_path / place)
    (ignored / "COLCON_IGNORE").touch()
    with pytest.raises(InputError, match="package 'rover' was not found in"):
        index(tmp_path).find("rover")


def test_a_package_below_an_ignored_folder_is_not_seen(tmp_path):
    package(tmp_path / "old" / "rover")
    (tmp_path / "old" / "COLCON_IGNORE").touch()
    with pytest.raises(InputError):
        index(tmp_path).find("rover")


@pytest.mark.parametrize("folder", ["build", "log", ".git"])
def test_copies_in_build_folders_are_not_seen(tmp_path, folder):
    package(tmp_path / folder / "rover")
    with pytest.raises(InputError):
        index(tmp_path).find("rover")


def test_a_package_with_a_broken_package_xml_goes_by_its_folders_name(tmp_path):
    (tmp_path / "stack" / "rover").mkdir(parents=True)
    (tmp_path / "stack" / "rover" / "package.xml").write_text("<package><name>")
    assert index(tmp_path).find("rover") == tmp_path / "stack" / "rover"


def test_a_name_that_no_folder_can_have_is_that_of_a_missing_package(tmp_path):
    with pytest.raises(InputError, match=r"package 'aaaa.*…' was not found in: any folder: the name is too long"):
        index(tmp_path).find("a" * 256)


def test_a_missing_package_lists_where_it_was_looked_for(tmp_path):
    given, arm = tmp_path / "given", package(tmp_path / "ws" / "src" / "arm")
    given.mkdir()
    packages = index(given, AMENT_PREFIX_PATH=tmp_path / "ament", ROS_PACKAGE_PATH=tmp_path / "ros")
    with pytest.raises(InputError) as raised:
        packages.find("rover", arm / "arm.urdf")
    text = str(raised.value)
    assert "package 'rover'" in text
    for folder in (given, arm.parent, tmp_path / "ament" / "share", tmp_path / "ros", share_folder("models")):
        assert str(folder) in text
    assert "--package-path" in text


def test_a_package_folder_that_does_not_exist_is_refused_at_once(tmp_path):
    with pytest.raises(InputError, match=rf"{tmp_path}/gone: the package folder does not exist"):
        PackageIndex([tmp_path / "gone"])


@pytest.mark.parametrize("scheme", ["package", "model"])
def test_package_and_model_addresses_name_files_inside_packages(tmp_path, scheme):
    mesh = package(tmp_path / "rover") / "wheel.stl"
    mesh.touch()
    assert index(tmp_path).resolve(f"{scheme}://rover/wheel.stl") == mesh


def test_a_file_address_is_an_absolute_path(tmp_path):
    (tmp_path / "wheel.stl").touch()
    assert index().resolve(f"file://{tmp_path}/wheel.stl") == tmp_path / "wheel.stl"


def test_a_relative_address_starts_at_the_file_that_holds_it(tmp_path):
    (tmp_path / "meshes").mkdir()
    (tmp_path / "urdf").mkdir()
    (tmp_path / "meshes" / "wheel.stl").touch()
    resolved = index().resolve("../meshes/wheel.stl", tmp_path / "urdf" / "rover.urdf")
    assert resolved == tmp_path / "meshes" / "wheel.stl"


def test_a_relative_address_from_the_command_line_starts_at_the_working_folder(tmp_path, monkeypatch):
    (tmp_path / "rover.urdf").touch()
    monkeypatch.chdir(tmp_path)
    assert index().resolve("rover.urdf") == tmp_path / "rover.urdf"


def test_an_unknown_scheme_is_refused_with_those_that_are_known():
    with pytest.raises(InputError) as raised:
        index().resolve("https://example.org/rover.urdf")
    assert "'https://example.org/rover.urdf'" in str(raised.value)
    assert "Valid: package://, model://, file://." in str(raised.value)


def test_a_missing_file_in_a_package_is_named_with_its_full_path(tmp_path):
    rover = package(tmp_path / "rover")
    with pytest.raises(InputError, match=rf"{rover}/wheel\.stl: the file does not exist"):
        index(tmp_path).resolve("package://rover/wheel.stl")


def test_the_package_of_a_file_is_the_innermost_one(tmp_path):
    package(tmp_path / "outer")
    inner = package(tmp_path / "outer" / "inner")
    assert containing_package(inner / "urdf" / "rover.urdf") == inner
    assert containing_package(tmp_path / "rover.urdf") is None


# --- install trees and workspaces


@pytest.mark.parametrize("layout", ["install/share/{}", "install/{}/share/{}"])
def test_a_package_is_found_in_a_merged_and_in_an_isolated_install_tree(tmp_path, layout):
    rover = package(tmp_path / layout.format("rover", "rover"))
    arm = package(tmp_path / layout.format("arm", "arm"))
    assert index(COLCON_PREFIX_PATH=tmp_path / "install").find("rover") == rover
    assert index().find("rover", near=arm / "urdf" / "arm.urdf") == rover  # a neighbour of the file at hand
    assert index(*workspace_folders(tmp_path)).find("rover") == rover
    assert index(*workspace_folders(tmp_path / "install")).find("rover") == rover


def test_a_workspaces_sources_go_before_what_is_built(tmp_path):
    built = package(tmp_path / "install" / "rover" / "share" / "rover")
    source = package(tmp_path / "src" / "stack" / "rover")
    arm = package(tmp_path / "install" / "arm" / "share" / "arm")
    folders = workspace_folders(tmp_path)
    assert folders == (tmp_path / "src", arm.parent, built.parent)
    assert index(*folders).find("rover") == source
    assert index(*folders).find("arm") == arm


@pytest.mark.parametrize("given", ["src", "src/rover", "."])
def test_a_workspace_may_be_a_folder_of_packages_or_one_package(tmp_path, given):
    rover = package(tmp_path / "src" / "rover")
    assert index(*workspace_folders(tmp_path / given)).find("rover") == rover


def test_a_workspace_without_packages_or_that_is_not_there_is_refused(tmp_path):
    with pytest.raises(InputError, match="the workspace holds no ROS package"):
        workspace_folders(tmp_path)
    with pytest.raises(InputError, match="the workspace does not exist"):
        workspace_folders(tmp_path / "gone")


def test_a_package_is_found_by_the_name_that_its_setup_py_registers(tmp_path):
    """The name in the package.xml may be another one: ament's index has the file in resource/."""
    package = tmp_path / "src" / "any"
    (package / "resource").mkdir(parents=True)
    (package / "package.xml").write_text("<package format='3'><name>short</name></package>")
    (package / "resource" / "short_gz_sim").touch()
    index = PackageIndex([tmp_path / "src"], environment={})
    assert index.find("short_gz_sim") == index.find("short")


@pytest.mark.parametrize("address", ["./rover/config/c.yaml", "rover/config/c.yaml", "src/rover/config/c.yaml"])
def test_a_path_from_where_the_simulator_is_started_is_found_by_its_package(tmp_path, address):
    rover = package(tmp_path / "checkout", "rover")
    (rover / "config").mkdir()
    (rover / "config" / "c.yaml").touch()
    found = index(tmp_path).resolve_as_started(address, tmp_path / "cache" / "robot.urdf")
    assert found == rover / "config" / "c.yaml"


def test_a_path_of_another_machine_is_found_by_its_package(tmp_path):
    rover = package(tmp_path / "checkout", "rover")
    (rover / "config").mkdir()
    (rover / "config" / "c.yaml").touch()
    address = "/home/someone/ws/src/rover/config/c.yaml"
    assert index(tmp_path).resolve_as_started(address, tmp_path / "robot.urdf") == rover / "config" / "c.yaml"
    with pytest.raises(InputError, match=r"/home/someone/rover/none\.yaml: the file does not exist"):
        index(tmp_path).resolve_as_started("/home/someone/rover/none.yaml", tmp_path / "robot.urdf")


def test_a_path_from_the_working_directory_is_found(tmp_path, monkeypatch):
    (tmp_path / "c.yaml").touch()
    monkeypatch.chdir(tmp_path)
    assert index().resolve_as_started("c.yaml", tmp_path / "cache" / "robot.urdf") == tmp_path / "c.yaml"


def test_a_path_that_is_nowhere_is_refused_as_any_other(tmp_path):
    with pytest.raises(InputError, match="the file does not exist"):
        index(package(tmp_path / "rover")).resolve_as_started("./rover/none.yaml", tmp_path / "robot.urdf")
