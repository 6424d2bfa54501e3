from pathlib import Path

import pytest

from drake_twin.description.package_index import PackageIndex
from drake_twin.description.share_layout import installed_layout


@pytest.fixture
def package(tmp_path) -> Path:
    folder = tmp_path / "ws" / "src" / "my_robot"
    (folder / "description" / "urdf").mkdir(parents=True)
    (folder / "description" / "urdf" / "arm.urdf").write_text("<robot name='arm'/>")
    (folder / "package.xml").write_text("<package><name>my_robot</name></package>")
    return folder


def test_a_package_that_is_installed_as_it_stands_is_used_as_it_stands(package):
    (package / "CMakeLists.txt").write_text("install(DIRECTORY description DESTINATION share/${PROJECT_NAME})")
    assert installed_layout(package) == package


@pytest.mark.parametrize(
    "rule",
    [
        "install(DIRECTORY description/urdf DESTINATION share/${PROJECT_NAME})",
        "install(\n  DIRECTORY\n    description/urdf\n  DESTINATION share/${PROJECT_NAME}/\n)",
        "install(DIRECTORY description/ DESTINATION share/my_robot)",
        "install(DIRECTORY description/urdf/ DESTINATION share/${PROJECT_NAME}/urdf)",
        "ament_auto_package(INSTALL_TO_SHARE description/urdf)",
    ],
)
def test_a_folder_is_found_where_cmake_installs_it(package, rule):
    (package / "CMakeLists.txt").write_text(f"project(my_robot)\n# install(DIRECTORY nothing)\n{rule}\n")
    assert (installed_layout(package) / "urdf" / "arm.urdf").read_text() == "<robot name='arm'/>"
    assert (installed_layout(package) / "package.xml").is_file()


def test_without_build_files_the_usual_folders_are_found_at_the_top(package):
    found = PackageIndex((package.parent,), {}).resolve("package://my_robot/urdf/arm.urdf")
    assert found.read_text() == "<robot name='arm'/>"


def test_what_stands_at_the_top_already_is_not_hidden(package):
    (package / "urdf").mkdir()
    (package / "urdf" / "arm.urdf").write_text("the one at the top")
    assert (installed_layout(package) / "urdf" / "arm.urdf").read_text() == "the one at the top"
