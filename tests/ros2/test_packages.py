from pathlib import Path

from launch_files import write, write_package

from drake_twin.description.package_index import PackageIndex
from drake_twin.ros2.packages import LaunchPackages, absent_package_in


def test_an_absent_package_is_a_path_that_names_it_and_is_remembered_once(tmp_path):
    packages = LaunchPackages(PackageIndex([tmp_path], {}))
    path = packages.find("gone") / "urdf" / "x.xacro"
    packages.find("gone")
    assert not path.exists()
    assert absent_package_in(f"cannot read '{path}'") == "gone"
    assert list(packages.absent) == ["gone"]


def test_a_package_of_the_same_checkout_is_found_wherever_it_stands(tmp_path):
    (tmp_path / ".git").mkdir()
    near = write(write_package(tmp_path / "simulation", "sim") / "launch" / "x.launch.py", "")
    other = write_package(tmp_path / "robot" / "descriptions", "arm")
    assert LaunchPackages(PackageIndex(environment={})).find("arm", near) == other


def test_what_the_top_files_workspace_has_is_found_from_files_elsewhere(tmp_path):
    here = write_package(tmp_path / "a" / "src", "here")
    there = write_package(tmp_path / "b" / "src", "there")
    packages = LaunchPackages(PackageIndex(environment={}))
    packages.find("here", here / "x.launch.py")
    assert packages.find("here", there / "x.launch.py") == here


def test_asking_whether_a_package_is_present_does_not_make_it_absent(tmp_path):
    packages = LaunchPackages(PackageIndex([tmp_path], {}), frozenset({"ros_gz_sim"}))
    assert not packages.is_present("gone")
    assert packages.is_present("ros_gz_sim")
    assert not packages.absent
    packages.find("gone")
    assert list(packages.absent) == ["gone"]


def test_an_authors_own_path_is_matched_by_its_tail(tmp_path):
    file = write(write_package(tmp_path, "arm") / "urdf" / "arm.xacro", "")
    packages = LaunchPackages(PackageIndex([tmp_path], {}))
    assert packages.locate("/home/someone/ws/src/arm/urdf/arm.xacro") == file
    assert packages.locate("/home/someone/ws/install/arm/share/arm/urdf/arm.xacro") == file
    assert packages.locate("/home/someone/none.xacro") == Path("/home/someone/none.xacro")
    assert packages.locate("relative/arm/urdf/arm.xacro") == Path("relative/arm/urdf/arm.xacro")
    assert not packages.absent


def test_the_prefix_of_an_installed_package_is_above_share(tmp_path):
    write_package(tmp_path / "install" / "share", "arm")
    packages = LaunchPackages(PackageIndex([], {"AMENT_PREFIX_PATH": str(tmp_path / "install")}))
    assert packages.prefix("arm") == tmp_path / "install"
