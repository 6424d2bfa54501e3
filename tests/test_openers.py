"""Files that strangers write go through the one opener, which waits for no pipe and reads nothing without a bound."""

import ast
import json
import os
import re
from pathlib import Path

import pytest
from playback.recorded_bags import cart_messages, write
from rosbags.rosbag2 import StoragePlugin

import drake_twin
from drake_twin.cockpit.robot_files import robot_files
from drake_twin.description import source_file
from drake_twin.description.package_index import PackageIndex
from drake_twin.description.python_programs import python_programs
from drake_twin.errors import InputError
from drake_twin.nodes.rosbag2_py import _info
from drake_twin.playback.bag import Bag
from drake_twin.sweeps import results
from drake_twin.sweeps.results import read_table

ROOT = Path(drake_twin.__file__).parent
READERS = {"read_bytes", "read_text"}

# Modules that read files by themselves, and why they may.
ALLOWED = {
    "benchmarks/report.py": "the machine's /proc",
    "benchmarks/sensors.py": "the machine's /proc",
    "cockpit/access.py": "the user's own files, written without following links",
    "cockpit/html_recording.py": "the page's own files",
    "cockpit/page_tokens.py": "the user's tokens, opened without following links and without waiting",
    "cockpit/panel.py": "the script of a panel's own package, whose Python runs already",
    "cockpit/scene.py": "Drake's own file",
    "cockpit/server.py": "the page's own files",
    "description/lasting_files.py": "what the twin wrote",
    "description/mesh_cache.py": "checked by check_regular, or what the twin wrote",
    "description/mesh_file.py": "checked by check_regular",
    "description/meshes.py": "checked by check_mesh_file, or what the twin wrote",
    "description/gltf_file.py": "checked by check_regular",
    "description/solid_mesh.py": "what the twin wrote",
    "description/xacro_cache.py": "what the twin wrote, with its digest",
    "description/source_file.py": "the one opener",
    "extensions.py": "the twin's own modules and what is installed beside them",
    "messages/store.py": "the installed package rosbags",
    "messages/interface_texts.py": "the twin's own texts",
    "description/docs.py": "the twin's own tests",
    "mirror/learner.py": "what drake_twin.calibrate wrote",
    "nodes/docs.py": "the twin's own texts",
    "nodes/ros_members.py": "the twin's own modules",
    "nodes/stand_ins.py": "the twin's own texts",
    "nodes/task.py": "the machine's /proc",
    "ros2/lazy_exports.py": "the twin's own modules",
    "ros2/python_file.py": "the open() of a launch file's own code",
    "sweeps/listening.py": "the machine's /proc",
    "wires/bag_writer.py": "what the twin wrote",
}


def opens(file: Path) -> bool:
    """Tell whether a module reads files by themselves: open(), read_bytes(), read_text(), FILE.open("r…")."""
    for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
        if not isinstance(node, ast.Call):
            continue
        called = node.func
        if isinstance(called, ast.Name) and called.id == "open":
            return True
        if isinstance(called, ast.Attribute) and called.attr in READERS:
            return True
        modes = [item.value for item in node.args if isinstance(item, ast.Constant) and isinstance(item.value, str)]
        if isinstance(called, ast.Attribute) and called.attr == "open" and any(mode[:1] == "r" for mode in modes[:1]):
            return True
        if isinstance(called, ast.Attribute) and ast.unparse(called) == "builtins.open":
            return True
    return False


def test_nobody_else_opens_files():
    found = {file.relative_to(ROOT).as_posix() for file in ROOT.rglob("*.py") if "docs" not in file.parts}
    found = {name for name in found if opens(ROOT / name)}
    assert found - set(ALLOWED) == set(), "use drake_twin.description.source_file"
    assert set(ALLOWED) - found == set(), "they need no permission"


@pytest.fixture
def bag(tmp_path):
    return write(tmp_path / "bag", cart_messages(), StoragePlugin.MCAP)


def refusal(folder):
    with pytest.raises(InputError) as played:
        Bag(folder).close()
    with pytest.raises(RuntimeError, match="No storage could be initialized"):
        _info.open_bag(str(folder))
    return str(played.value)


def test_a_bag_whose_file_is_a_pipe_is_refused(bag):
    (file,) = bag.glob("*.mcap")
    file.unlink()
    os.mkfifo(file)
    assert "a device or a pipe" in refusal(bag)


def test_a_bag_whose_description_is_a_pipe_is_refused(bag):
    (bag / "metadata.yaml").unlink()
    (bag / "metadata.yaml").symlink_to("/dev/zero")
    with pytest.raises(InputError, match=r"no metadata\.yaml"):
        Bag(bag)
    with pytest.raises(RuntimeError, match="No storage could be initialized"):
        _info.open_bag(str(bag))


def test_a_bag_whose_files_are_no_list_is_refused(bag):
    text = (bag / "metadata.yaml").read_text()
    assert "  files:" in text
    (bag / "metadata.yaml").write_text(re.sub(r"  files:\n(  [ -].*\n)*", "  files: none\n", text))
    assert "its files are no list, but 'none'" in refusal(bag)


@pytest.mark.parametrize("way", ["path", "link"])
def test_a_bag_that_leads_out_of_its_folder_is_refused(bag, tmp_path, way):
    (file,) = bag.glob("*.mcap")
    file.rename(tmp_path / "outside.mcap")
    if way == "link":
        file.symlink_to(tmp_path / "outside.mcap")
    else:
        text = (bag / "metadata.yaml").read_text()
        (bag / "metadata.yaml").write_text(text.replace(file.name, "../outside.mcap"))
    assert "is outside of its folder" in refusal(bag)


def test_a_bag_whose_description_nests_without_end_is_refused(bag):
    (bag / "metadata.yaml").write_text("a: " + "[" * 5000)
    assert "nest more than" in refusal(bag)


@pytest.mark.parametrize("suffix", [".csv", ".jsonl", ".parquet"])
def test_a_table_that_is_a_pipe_is_refused(tmp_path, suffix):
    os.mkfifo(tmp_path / f"t{suffix}")
    with pytest.raises(InputError, match="a device or a pipe"):
        read_table(tmp_path / f"t{suffix}")


def test_a_table_that_unpacks_to_more_than_is_read_is_refused(tmp_path, monkeypatch):
    import pyarrow as pa
    import pyarrow.parquet

    table = pa.table({"id": ["x" * 1000] * 1000}).replace_schema_metadata({"drake_twin_sweep": json.dumps({})})
    pa.parquet.write_table(table, tmp_path / "t.parquet", use_dictionary=False, compression="zstd")
    monkeypatch.setattr(results, "MOST_BYTES", 100_000)
    with pytest.raises(InputError, match=r"the table unpacks to 1 MB; at most 0 MB are read"):
        read_table(tmp_path / "t.parquet")


def test_a_pipe_among_a_packages_files_holds_nobody_up(tmp_path):
    package = tmp_path / "p"
    (package / "scripts").mkdir(parents=True)
    (package / "package.xml").write_text("<package><name>p</name></package>")
    (package / "CMakeLists.txt").write_text("install(PROGRAMS scripts/tool DESTINATION lib/${PROJECT_NAME})")
    os.mkfifo(package / "scripts" / "tool")
    os.mkfifo(package / "robot.urdf")
    assert "package://p/robot.urdf" not in robot_files(PackageIndex([str(tmp_path)]))
    assert python_programs(package) == {}


def test_a_text_that_is_too_long_to_parse_is_refused(tmp_path, monkeypatch):
    monkeypatch.setattr(source_file, "MOST_TEXT", 1 << 20)
    (tmp_path / "r.urdf").write_text("<robot>" + " " * 2_000_000 + "</robot>")
    with pytest.raises(InputError, match=r"the file has 2 MB; at most 1 MB are read"):
        source_file.read_xml(tmp_path / "r.urdf", "robot file")
