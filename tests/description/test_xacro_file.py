import contextlib
import errno
import os
from pathlib import Path

import pytest
from lxml import etree
from xacro import substitution_args

from drake_twin.description import xacro_cache, xacro_file
from drake_twin.description.package_index import PackageIndex
from drake_twin.description.xacro_file import expand_xacro, installed_xacro, places_of_expanded, xacro_arguments
from drake_twin.errors import InputError

BOMB = (
    "<!DOCTYPE robot [<!ENTITY e0 'aaaaaaaaaa'>"
    + "".join(f"<!ENTITY e{i + 1} '{f'&e{i};' * 10}'>" for i in range(9))
    + "]>"
)


OPTIONAL = (
    '<xacro:property name="name" value="before"/><xacro:include filename="later.xacro" optional="1"/>'
    '<link name="${name}"/>'
)


def write_xacro(file: Path, body: str, before: str = "") -> Path:
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(f'{before}<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">{body}</robot>')
    return file


def link_of(file: Path, *folders: Path, **arguments: str) -> str:
    text = expand_xacro(file, arguments, PackageIndex(folders, {})).text
    return etree.fromstring(text.encode()).find("link").get("name")


def refusal(file: Path, *folders: Path, **arguments: str) -> str:
    with pytest.raises(InputError) as raised:
        expand_xacro(file, arguments, PackageIndex(folders, {}))
    return str(raised.value)


def test_an_argument_replaces_its_default(tmp_path):
    file = write_xacro(tmp_path / "r.xacro", '<xacro:arg name="of" default="left"/><link name="$(arg of)_wheel"/>')
    assert link_of(file) == "left_wheel"
    assert link_of(file, of="right") == "right_wheel"


def test_find_is_answered_by_the_package_index_without_ros(tmp_path):
    (tmp_path / "wheels").mkdir()
    file = write_xacro(tmp_path / "r.xacro", '<link name="$(find wheels)/wheel.stl"/>')
    assert link_of(file, tmp_path) == f"{tmp_path}/wheels/wheel.stl"


def test_find_sees_the_neighbours_of_the_files_own_package(tmp_path):
    for name in ("rover", "wheels"):
        (tmp_path / "src" / name).mkdir(parents=True)
        (tmp_path / "src" / name / "package.xml").write_text(f"<package><name>{name}</name></package>")
    file = write_xacro(tmp_path / "src" / "rover" / "urdf" / "r.xacro", '<link name="$(find wheels)"/>')
    assert link_of(file) == str(tmp_path / "src" / "wheels")


def test_an_unknown_package_in_find_names_the_file_and_where_it_was_looked_for_once(tmp_path):
    file = write_xacro(tmp_path / "r.xacro", '<link name="$(find wheels)"/>')
    text = refusal(file, tmp_path)
    assert text.startswith(f"{file}:1: xacro: package 'wheels' was not found in: {tmp_path}")
    assert text.count("package 'wheels'") == 1


def test_a_file_that_is_not_well_formed_gives_the_line(tmp_path):
    file = write_xacro(tmp_path / "r.xacro", "\n<link>\n")
    assert refusal(file).startswith(f"{file}:3: this is not well-formed XML: mismatched tag: line 3")


def test_an_expression_that_fails_names_itself_and_pythons_reason(tmp_path):
    file = write_xacro(tmp_path / "r.xacro", '<link name="${1 / 0}"/>')
    assert refusal(file) == f"{file}:1: xacro: division by zero when evaluating expression '1 / 0'."


def test_an_argument_without_a_value_is_named(tmp_path):
    file = write_xacro(tmp_path / "r.xacro", '<link name="$(arg side)"/>')
    assert refusal(file) == f"{file}:1: xacro: Undefined substitution argument side."


def test_an_included_file_that_is_missing_is_named_once(tmp_path):
    file = write_xacro(tmp_path / "r.xacro", '<xacro:include filename="wheel.xacro"/>')
    assert refusal(file) == f"{file}:1: xacro: No such file or directory: {tmp_path}/wheel.xacro."


def test_an_error_in_an_included_file_names_that_file_and_its_includer(tmp_path):
    wheel = write_xacro(tmp_path / "wheel.xacro", '<link name="${radius}"/>')
    file = write_xacro(tmp_path / "r.xacro", '<xacro:include filename="wheel.xacro"/>')
    text = refusal(file)
    assert text.startswith(f"{wheel}:1: xacro: name 'radius' is not defined")
    assert text.endswith(f"(included from {file}).")


def test_a_file_that_includes_itself_is_refused_and_named_once(tmp_path):
    file = write_xacro(tmp_path / "r.xacro", '<xacro:include filename="r.xacro"/>')
    text = refusal(file)
    assert "recursion" in text
    assert text.count("r.xacro") == 2  # as the place, and as its includer


def test_a_missing_file_is_named(tmp_path):
    assert refusal(tmp_path / "r.xacro").startswith(f"{tmp_path}/r.xacro: xacro: No such file or directory")


def test_an_entity_bomb_is_refused(tmp_path):
    file = write_xacro(tmp_path / "r.xacro", '<link name="&e9;"/>', before=BOMB)
    assert "amplification" in refusal(file)


def test_xacros_warnings_are_returned_with_their_file_and_not_printed(tmp_path, capsys):
    properties = "".join(f'<xacro:property name="{name}" value="1" unit="m"/>' for name in ("radius", "length"))
    file = write_xacro(tmp_path / "r.xacro", properties + '<link name="a"/>')
    warnings = expand_xacro(file, {}, PackageIndex((), {})).warnings
    assert warnings == (f"xacro:property: unknown attribute(s): unit, when processing file: {file}",) * 2
    assert capsys.readouterr().err == ""


@pytest.mark.parametrize("body", ['<link name="$(find nowhere)"/>', '<link name="a"/>'])
def test_xacros_own_package_lookup_is_restored(tmp_path, body):
    original = substitution_args._eval_find
    file = write_xacro(tmp_path / "r.xacro", body)
    with contextlib.suppress(InputError):
        expand_xacro(file, {}, PackageIndex((), {}))
    assert substitution_args._eval_find is original


def test_a_file_is_expanded_the_same_after_one_that_failed(tmp_path):
    good = write_xacro(tmp_path / "good.xacro", '<link name="a"/>')
    refusal(write_xacro(tmp_path / "bad.xacro", "<xacro:nonsense/>"))
    assert link_of(good) == "a"


def test_arguments_are_collected_over_all_includes(tmp_path):
    (tmp_path / "parts").mkdir()
    write_xacro(tmp_path / "parts" / "arm.xacro", '<xacro:arg name="reach"/>')
    write_xacro(tmp_path / "wheel.xacro", '<xacro:arg name="radius" default="0.1"/><xacro:include filename="r.xacro"/>')
    body = (
        '<xacro:arg name="prefix" default=""/><xacro:include filename="wheel.xacro"/>'
        '<xacro:include filename="$(find parts)/arm.xacro"/>'
    )
    file = write_xacro(tmp_path / "r.xacro", body)
    assert xacro_arguments(file, PackageIndex([tmp_path], {})) == {
        "prefix": "",
        "radius": "0.1",
        "reach": "",
    }


def test_includes_that_cannot_be_followed_do_not_hide_the_other_arguments(tmp_path):
    includes = "".join(
        f'<xacro:include filename="{name}"/>' for name in ("${part}.xacro", "gone.xacro", "$(find nowhere)/a.xacro")
    )
    file = write_xacro(tmp_path / "r.xacro", f'{includes}<xacro:arg name="prefix"/>')
    assert xacro_arguments(file, PackageIndex((), {})) == {"prefix": ""}


@pytest.fixture(autouse=True)
def kept(tmp_path, monkeypatch):
    """The folder of kept expansions."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    return tmp_path / "cache" / "drake_twin" / "xacro"


def next_process():
    """Forget what this process has expanded."""
    xacro_file._known_expansions.clear()


@pytest.fixture
def expansions(monkeypatch):
    """The files that xacro itself is asked to expand."""
    xacro = installed_xacro()
    files = []
    original = xacro.process_file
    monkeypatch.setattr(xacro, "process_file", lambda name, **more: files.append(name) or original(name, **more))
    return files


def test_the_same_command_is_expanded_once(tmp_path, expansions):
    body = '<xacro:arg name="of" default="left"/><link name="$(arg of)"/>'
    file = write_xacro(tmp_path / "r.xacro", body)
    once, again = (expand_xacro(file, {"of": "right"}, PackageIndex((), {})) for _ in range(2))
    assert once == again
    assert len(expansions) == 1
    assert link_of(file) == "left"
    assert len(expansions) == 2


def test_warnings_of_an_expansion_that_is_known_are_the_same(tmp_path, expansions):
    file = write_xacro(tmp_path / "r.xacro", '<xacro:property name="r" value="1" unit="m"/><link name="a"/>')
    once, again = (expand_xacro(file, {}, PackageIndex((), {})).warnings for _ in range(2))
    assert once == again != ()
    assert len(expansions) == 1


def test_the_next_process_does_not_expand_the_same_command(tmp_path, expansions):
    write_xacro(tmp_path / "part.xacro", '<xacro:arg name="of" default="left"/><link name="$(arg of)"/>')
    body = '<xacro:include filename="part.xacro"/><xacro:property name="r" value="1" unit="m"/>'
    file = write_xacro(tmp_path / "r.xacro", body)
    once = expand_xacro(file, {"of": "right"}, PackageIndex((), {}))
    assert {Path(place.file).name for place in once.places} == {"r.xacro", "part.xacro"}
    assert once.warnings
    next_process()
    assert expand_xacro(file, {"of": "right"}, PackageIndex((), {})) == once
    assert places_of_expanded(once.text) == once.places
    assert len(expansions) == 1


def of_other_arguments(file, _):
    return expand_xacro(file, {"of": "other"}, PackageIndex((), {}))


def in_another_folder(file, monkeypatch):
    (file.parent / "elsewhere").mkdir()
    monkeypatch.chdir(file.parent / "elsewhere")
    return expand_xacro(file, {}, PackageIndex((), {}))


def of_another_version(file, monkeypatch):
    monkeypatch.setattr("drake_twin.__version__", "another")
    return expand_xacro(file, {}, PackageIndex((), {}))


def by_another_xacro(file, monkeypatch):
    monkeypatch.setattr(xacro_file, "_version_of_xacro", lambda: "another")
    return expand_xacro(file, {}, PackageIndex((), {}))


def of_what_is_broken(file, _):
    for kept in (file.parent / "cache" / "drake_twin" / "xacro").iterdir():
        kept.write_text(kept.read_text().replace("robot", "rowboat"))
    return expand_xacro(file, {}, PackageIndex((), {}))


def of_what_was_cut_off(file, _):
    for kept in (file.parent / "cache" / "drake_twin" / "xacro").iterdir():
        kept.write_text("")
    return expand_xacro(file, {}, PackageIndex((), {}))


@pytest.mark.parametrize(
    "expand",
    [
        of_other_arguments,
        in_another_folder,
        of_another_version,
        by_another_xacro,
        of_what_is_broken,
        of_what_was_cut_off,
    ],
)
def test_the_next_process_expands_what_may_be_different(tmp_path, monkeypatch, expansions, expand):
    file = write_xacro(tmp_path / "r.xacro", '<xacro:arg name="of" default="left"/><link name="a"/>')
    once = expand_xacro(file, {}, PackageIndex((), {}))
    next_process()
    assert expand(file, monkeypatch) == once
    assert len(expansions) == 2


def test_a_file_is_expanded_where_nothing_can_be_kept(tmp_path, monkeypatch, expansions):
    def full(*_):
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(xacro_cache, "write_whole", full)
    file = write_xacro(tmp_path / "r.xacro", '<link name="a"/>')
    assert link_of(file) == "a"
    next_process()
    assert link_of(file) == "a"
    assert len(expansions) == 2


def test_expansions_that_were_used_longest_ago_are_removed(tmp_path, monkeypatch, kept, expansions):
    files = [write_xacro(tmp_path / f"{name}.xacro", f'<link name="{name}"/>') for name in "abc"]
    for file, time in zip(files[:2], (2, 1), strict=True):
        known = set(kept.glob("*"))
        link_of(file)
        (new,) = set(kept.glob("*")) - known
        os.utime(new, (time, time))
    size = sum(file.stat().st_size for file in kept.iterdir())
    monkeypatch.setattr(xacro_cache, "_MOST_BYTES", 1.4 * size)  # of two; it is trimmed to three quarters
    link_of(files[2])
    next_process()
    expansions.clear()
    assert [link_of(files[number]) for number in (0, 2, 1)] == ["a", "c", "b"]
    assert expansions == [str(files[1])]


def changed_file(folder, _):
    write_xacro(folder / "r.xacro", '<link name="after"/>')


def changed_include(folder, _):
    write_xacro(folder / "part.xacro", '<link name="after"/>')


def created_include(folder, _):
    write_xacro(folder / "later.xacro", '<xacro:property name="name" value="after"/>')


def changed_yaml(folder, _):
    (folder / "names.yaml").write_text("link: after")


def changed_variable(_, monkeypatch):
    monkeypatch.setenv("LINK", "after")


def further_file(folder, _):
    write_xacro(folder / "parts" / "a.xacro", '<link name="after"/>')


def deleted_package(folder, _):
    (folder / "first" / "after").rmdir()
    (folder / "second" / "after").mkdir()


@pytest.mark.parametrize("forget", [lambda: None, next_process], ids=["same_process", "next_process"])
@pytest.mark.parametrize(
    ("body", "change"),
    [
        ('<link name="before"/>', changed_file),
        ('<xacro:include filename="part.xacro"/>', changed_include),
        (OPTIONAL, created_include),
        ("<link name=\"${xacro.load_yaml('names.yaml')['link']}\"/>", changed_yaml),
        ('<link name="$(optenv LINK before)"/>', changed_variable),
        ('<link name="$(env LINK)"/>', changed_variable),
        ('<xacro:include filename="parts/*.xacro"/>', further_file),
        ('<link name="$(find after)"/>', deleted_package),
    ],
)
def test_what_has_changed_is_expanded_again(tmp_path, monkeypatch, body, change, forget):
    monkeypatch.setenv("LINK", "before")
    if "optenv" in body:
        monkeypatch.delenv("LINK")
    write_xacro(tmp_path / "part.xacro", '<link name="before"/>')
    write_xacro(tmp_path / "parts" / "b.xacro", '<link name="before"/>')
    (tmp_path / "names.yaml").write_text("link: before")
    (tmp_path / "first" / "after").mkdir(parents=True)
    (tmp_path / "second").mkdir()
    file = write_xacro(tmp_path / "r.xacro", body)
    folders = (tmp_path / "first", tmp_path / "second")
    before = link_of(file, *folders)
    assert link_of(file, *folders) == before
    change(tmp_path, monkeypatch)
    forget()
    after = link_of(file, *folders)
    assert after != before
    assert after.endswith("after")
