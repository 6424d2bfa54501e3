"""A pipe, a device or a folder in place of a file that a package names: it is refused, and not waited for."""

import os

import pytest

from drake_twin.check import main as check
from drake_twin.description.source_file import file_bytes, file_text, regular_open
from drake_twin.run import main as run

XACRO = 'xmlns:xacro="http://www.ros.org/wiki/xacro"'
ROBOTS = {
    "include": '<xacro:include filename="x"/><link name="l"/>',
    "load_yaml": "<link name=\"${xacro.load_yaml('x')}\"/>",
}
LAUNCH = {
    "a.launch.xml": '<launch><include file="x"/></launch>',
    "b.launch.xml": '<launch><let name="a" value="$(file-content x)"/></launch>',
    "c.launch.xml": '<launch><node pkg="p" exec="e"><param from="x"/></node></launch>',
    "d.launch.yaml": "launch:\n- include: {file: x}\n",
}


@pytest.fixture(params=["pipe", "device", "folder", "link to itself"])
def x(request, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    match request.param:
        case "pipe":
            os.mkfifo("x")
        case "device":
            os.symlink("/dev/zero", "x")
        case "folder":
            os.mkdir("x")
        case "link to itself":
            os.symlink("x", "x")
    return tmp_path / "x"


@pytest.mark.parametrize("read", [file_bytes, file_text, regular_open])
def test_the_one_opener_refuses_it(x, read):
    with pytest.raises(OSError):
        read(x)


def test_the_one_opener_reads_what_is_a_file(tmp_path):
    (tmp_path / "x").write_bytes(b"a\r\nb\rc\n")
    assert file_bytes(tmp_path / "x") == b"a\r\nb\rc\n"
    assert file_text(tmp_path / "x") == (tmp_path / "x").read_text() == "a\nb\nc\n"
    with regular_open(tmp_path / "x") as stream:
        assert stream.read() == "a\nb\nc\n"


@pytest.mark.parametrize("kind", ROBOTS)
def test_what_xacro_reads(x, kind, capsys):
    (x.parent / "r.urdf").write_text(f'<robot name="r" {XACRO}>{ROBOTS[kind]}</robot>')
    assert check(["r.urdf"]) == 1
    said = capsys.readouterr()
    assert "error: " in said.out + said.err
    assert "Traceback" not in said.out + said.err


@pytest.mark.parametrize("name", LAUNCH)
def test_what_a_launch_file_reads(x, name, capsys):
    (x.parent / name).write_text(LAUNCH[name])
    assert run([name, "--headless", "--duration", "0.01"]) == 2
    said = capsys.readouterr().err
    assert "error: " in said
    assert "Traceback" not in said


@pytest.mark.parametrize(
    "words", [["x"], ["x.yaml"], ["--load-state", "x"], ["--replay", "x"], ["--launch-file", "x"], ["--world", "x"]]
)
def test_what_the_command_line_names(x, words, capsys):
    (x.parent / "x.yaml").symlink_to("x")
    assert run([*words, "--headless", "--duration", "0.01"]) == 2
    assert "Traceback" not in capsys.readouterr().err


def test_the_files_of_a_packages_build(x):
    package = x.parent / "p"
    (package / "urdf").mkdir(parents=True)
    for name in ("package.xml", "CMakeLists.txt", "setup.py", "setup.cfg"):
        (package / name).symlink_to(x)
    (package / "urdf" / "r.urdf").write_text('<robot name="r"><link name="l"/></robot>')
    assert check([str(package / "urdf" / "r.urdf")]) in (0, 1)
