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
        "install(DIRECTORY description/urdf DESTINATION ${CMAKE_INSTALL_PREFIX}/share/${PROJECT_NAME})",
        'set(DEST "share/${PROJECT_NAME}")\ninstall(DIRECTORY description/urdf DESTINATION ${DEST})',
        "set(DIRS description/urdf launch)\ninstall(DIRECTORY ${DIRS} DESTINATION share/${PROJECT_NAME}/)",
        "foreach(d urdf meshes)\ninstall(DIRECTORY description/${d} DESTINATION share/${PROJECT_NAME})\nendforeach()",
        "set(D urdf)\nforeach(d IN LISTS D)\nINSTALL(DIRECTORY description/${d}/ DESTINATION share/my_robot/${d})",
        "install(FILES description/urdf/arm.urdf DESTINATION share/${PROJECT_NAME}/urdf)",
        "install(PROGRAMS description/urdf/arm.urdf DESTINATION share/${PROJECT_NAME}/urdf)",
        "install(FILES description/urdf/arm.urdf DESTINATION share/${PROJECT_NAME}/urdf RENAME arm.urdf)",
        "file(GLOB FILES description/urdf/*.urdf)\ninstall(FILES ${FILES} DESTINATION share/${PROJECT_NAME}/urdf)",
        "if(X)\nendif()\ninstall(DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR}/description/urdf DESTINATION share/my_robot)",
    ],
)
def test_a_folder_is_found_where_cmake_installs_it(package, rule):
    (package / "CMakeLists.txt").write_text(f"project(my_robot)\n# install(DIRECTORY nothing)\n{rule}\n")
    assert (installed_layout(package) / "urdf" / "arm.urdf").read_text() == "<robot name='arm'/>"
    assert (installed_layout(package) / "package.xml").is_file()


def test_files_are_found_from_the_top_of_the_share_folder_as_when_installed(package):
    """Path.rglob does not enter links to folders; colcon makes folders with links to files, or copies."""
    (package / "CMakeLists.txt").write_text("install(DIRECTORY description/urdf DESTINATION share/my_robot)")
    (package / "launch" / "parts").mkdir(parents=True)
    (package / "launch" / "parts" / "arm.launch.py").touch()
    share = installed_layout(package)
    found = {path.relative_to(share).as_posix() for path in share.rglob("*arm*")}
    assert found == {"description/urdf/arm.urdf", "launch/parts/arm.launch.py", "urdf/arm.urdf"}
    assert {path.resolve() for path in share.rglob("*.urdf")} == {package / "description" / "urdf" / "arm.urdf"}


def test_without_build_files_the_usual_folders_are_found_at_the_top(package):
    found = PackageIndex((package.parent,), {}).resolve("package://my_robot/urdf/arm.urdf")
    assert found.read_text() == "<robot name='arm'/>"


def test_what_stands_at_the_top_already_is_not_hidden(package):
    (package / "urdf").mkdir()
    (package / "urdf" / "arm.urdf").write_text("the one at the top")
    assert (installed_layout(package) / "urdf" / "arm.urdf").read_text() == "the one at the top"


@pytest.mark.parametrize(
    "rule",
    [
        "install(DIRECTORY description/urdf DESTINATION lib/${PROJECT_NAME})",
        "install(DIRECTORY description/urdf DESTINATION share/another)",
        "install(DIRECTORY description/urdf DESTINATION share/${PROJECT_NAME}/../..)",
        "install(DIRECTORY gone DESTINATION share/${PROJECT_NAME})",
        "install(TARGETS node DESTINATION share/${PROJECT_NAME})",
        "set(A ${A}x)\nforeach(i ${A})\ninstall(DIRECTORY ${A}",
    ],
)
def test_what_is_installed_elsewhere_or_not_understood_changes_nothing(package, rule):
    (package / "CMakeLists.txt").write_text(f"project(my_robot)\n{rule}\n")
    assert installed_layout(package) == package


def test_a_folder_of_cmake_lists_of_its_own_is_gone_into(package):
    (package / "CMakeLists.txt").write_text("project(my_robot)\nadd_subdirectory(description)\n")
    (package / "description" / "CMakeLists.txt").write_text("install(DIRECTORY urdf DESTINATION share/${PROJECT_NAME})")
    assert (installed_layout(package) / "urdf" / "arm.urdf").is_file()


SETUP = """import os
from glob import glob
from setuptools import find_packages, setup

package_name = 'my_robot'
{before}
setup(
    name=package_name,
    packages=find_packages(exclude=['test']),
    data_files=[
        ('share/ament_index/resource_index/packages', ['resource/' + package_name]),
        ('share/' + package_name, ['package.xml']),
        {entry}
    ]{more},
)
"""


WALK = """
def package_files(where):
    found = []
    for path, _, files in os.walk(where):
        found.append(('share/my_robot/urdf', [os.path.join(path, f) for f in files]))
    return found
"""


@pytest.mark.parametrize(
    ("before", "entry", "more"),
    [
        ("", "(os.path.join('share', package_name, 'urdf'), glob('description/urdf/*.urdf')),", ""),
        ("", "(os.path.join('share', package_name, 'urdf'), glob(os.path.join('description', 'urdf', '*'))),", ""),
        ("", "('share/' + package_name + '/urdf', ['description/urdf/arm.urdf']),", ""),
        ("", "(f'share/{package_name}/urdf', ['description/urdf/arm.urdf']),", ""),
        ("", "('share/{}/urdf'.format(package_name), ['description/urdf/arm.urdf']),", ""),
        ("", "('share/%s/urdf' % package_name, glob('description/**/*.urdf', recursive=True)),", ""),
        ("SHARE = os.path.join('share', package_name)", "(SHARE + '/urdf', ['description/urdf/arm.urdf']),", ""),
        ("", "", " + [('share/my_robot/urdf', [f for f in glob('description/urdf/*') if os.path.isfile(f)])]"),
        ("more = []\nmore.append(('share/my_robot/urdf', glob('description/urdf/*')))", "*more,", ""),
        (
            WALK,
            "",
            " + package_files('description/urdf')",
        ),
        (
            "extra = []\nfor name in ['urdf']:\n    extra += [('share/my_robot/urdf', glob(f'description/{name}/*'))]",
            "",
            " + extra",
        ),
    ],
)
def test_a_file_is_found_where_setup_py_installs_it(package, before, entry, more):
    (package / "setup.py").write_text(SETUP.format(before=before, entry=entry, more=more))
    assert (installed_layout(package) / "urdf" / "arm.urdf").read_text() == "<robot name='arm'/>"


def test_setup_py_is_never_run(package):
    mark = package / "ran"
    text = SETUP.format(before=f"open({str(mark)!r}, 'w').write('x')", entry="(os.system('x'), [1]),", more="")
    (package / "setup.py").write_text(text + "\nwhile True: pass\n")
    assert installed_layout(package) == package
    assert not mark.exists()


def test_a_setup_py_with_a_loop_without_end_is_given_up(package):
    grow = "a = ['x' * 9]\nfor i in a:\n    a.append(i)\n"
    grow += "for i in a:\n    for j in a:\n        for k in a:\n            b = i + j\n"
    (package / "setup.py").write_text(SETUP.format(before=grow, entry="", more=""))
    assert installed_layout(package) == package


def test_what_setup_py_does_not_say_plainly_leaves_the_folder_as_it_stands(package):
    (package / "setup.py").write_text(SETUP.format(before="", entry="(place(), files()),", more=" + unknown()"))
    assert installed_layout(package) == package


def test_setup_cfg_says_it_too(package):
    text = "[metadata]\nname = my_robot\n[options.data_files]\nshare/my_robot/urdf =\n    description/urdf/*.urdf\n"
    (package / "setup.cfg").write_text(text)
    assert (installed_layout(package) / "urdf" / "arm.urdf").is_file()


def test_one_place_takes_files_of_several_folders_beside_its_own(package):
    (package / "urdf").mkdir()
    (package / "urdf" / "own.urdf").write_text("own")
    (package / "more").mkdir()
    (package / "more" / "leg.urdf").write_text("leg")
    entry = "('share/my_robot/urdf', glob('description/urdf/*') + ['more/leg.urdf']),"
    (package / "setup.py").write_text(SETUP.format(before="", entry=entry, more=""))
    found = installed_layout(package) / "urdf"
    assert sorted(path.name for path in found.iterdir()) == ["arm.urdf", "leg.urdf", "own.urdf"]
    assert sorted(path.name for path in (package / "urdf").iterdir()) == ["own.urdf"]


def test_an_installed_package_is_left_alone(tmp_path):
    share = tmp_path / "install" / "share" / "my_robot"
    (share / "description" / "urdf").mkdir(parents=True)
    (share / "package.xml").write_text("<package><name>my_robot</name></package>")
    assert installed_layout(share) == share
