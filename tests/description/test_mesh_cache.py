import multiprocessing
import os
import tempfile
from pathlib import Path

import pytest
import trimesh

from drake_twin.description import mesh_cache
from drake_twin.description.mesh_cache import cached, mesh_cache_folder, source_of
from drake_twin.description.meshes import collision_mesh
from drake_twin.errors import InputError, RunError


@pytest.fixture(autouse=True)
def cache(tmp_path, monkeypatch):
    """The folder of the cache; the temporary folder is empty, too."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    (tmp_path / "tmp").mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path / "tmp"))
    mesh_cache._temporary_base.cache_clear()
    yield tmp_path / "cache" / "drake_twin" / "meshes"
    mesh_cache._temporary_base.cache_clear()


@pytest.fixture
def source(tmp_path):
    def source(name: str, content: bytes | None = None) -> Path:
        file = tmp_path / name
        file.write_bytes(name.encode() if content is None else content)
        return file

    return source


def ten_bytes(_: Path) -> bytes:
    return b"0123456789"


def never(file: Path) -> bytes:
    raise AssertionError(f"{file} was converted again")


def age(file: Path, seconds: int) -> None:
    """Makes a file's last use so long ago."""
    then = file.stat().st_mtime - seconds
    os.utime(file, (then, then))


def test_what_was_converted_is_in_the_users_cache_folder(cache, source):
    kept = cached(source("a.stl"), ".hull.obj", ten_bytes)
    assert kept.parent == cache == mesh_cache_folder()
    assert kept.name.endswith(".hull.obj")
    assert kept.read_bytes() == b"0123456789"


def test_without_xdg_cache_home_the_cache_is_in_the_home_folder(tmp_path, monkeypatch):
    monkeypatch.delenv("XDG_CACHE_HOME")
    monkeypatch.setenv("HOME", str(tmp_path))
    assert mesh_cache_folder() == tmp_path / ".cache" / "drake_twin" / "meshes"


def test_the_second_time_nothing_is_converted(source):
    file = source("a.stl")
    assert cached(file, ".obj", ten_bytes) == cached(file, ".obj", never)


def test_the_same_content_at_another_place_is_not_converted_again(source):
    kept = cached(source("a.stl", b"same"), ".obj", ten_bytes)
    assert cached(source("b.stl", b"same"), ".obj", never) == kept


def test_another_content_another_format_and_another_conversion_are_kept_apart(source):
    files = {
        cached(source("a.stl", b"one"), ".obj", ten_bytes),
        cached(source("b.stl", b"two"), ".obj", ten_bytes),
        cached(source("a.ply", b"one"), ".obj", ten_bytes),
        cached(source("c.stl", b"one"), ".hull.obj", ten_bytes),
    }
    assert len(files) == 4


def test_a_newer_conversion_does_not_use_what_an_older_one_left(source, monkeypatch):
    before = cached(source("a.stl"), ".obj", ten_bytes)
    monkeypatch.setattr(mesh_cache, "_CONVERSION", "another")
    mesh_cache._digest_of_version.cache_clear()
    assert cached(source("a.stl"), ".obj", ten_bytes) != before
    mesh_cache._digest_of_version.cache_clear()


def test_a_conversion_that_fails_leaves_nothing_behind(cache, source):
    def fail(file: Path) -> bytes:
        raise InputError("the mesh holds no triangles", file=file)

    with pytest.raises(InputError):
        cached(source("a.stl"), ".obj", fail)
    assert list(cache.iterdir()) == []


def test_a_cache_above_its_bound_keeps_what_was_used_last(source, monkeypatch):
    kept = [cached(source(f"{name}.stl"), ".obj", ten_bytes) for name in "abcd"]
    for number, file in enumerate(kept):
        age(file, 1000 - number)
    cached(source("a.stl"), ".obj", never)  # used again: now the most recent
    monkeypatch.setattr(mesh_cache, "_MOST_BYTES", 40)
    newest = cached(source("e.stl"), ".obj", ten_bytes)
    assert [file.exists() for file in (*kept, newest)] == [True, False, False, True, True]


def test_a_cache_within_its_bound_keeps_everything(cache, source, monkeypatch):
    monkeypatch.setattr(mesh_cache, "_MOST_BYTES", 40)
    for name in "abcd":
        cached(source(f"{name}.stl"), ".obj", ten_bytes)
    assert len(list(cache.iterdir())) == 4


def test_what_was_trimmed_is_converted_again(source, monkeypatch):
    first = cached(source("a.stl"), ".obj", ten_bytes)
    first.unlink()
    assert cached(source("a.stl"), ".obj", ten_bytes) == first
    assert first.exists()


def test_a_cache_folder_that_cannot_be_made_falls_back_to_a_temporary_one(tmp_path, cache, source):
    (tmp_path / "cache").write_text("a file where the folder should be")
    kept = cached(source("a.stl"), ".obj", ten_bytes)
    assert kept.read_bytes() == b"0123456789"
    assert cache not in kept.parents
    assert cached(source("a.stl"), ".obj", never) == kept


def test_a_cache_folder_that_cannot_be_written_falls_back_to_a_temporary_one(cache, source, monkeypatch):
    cache.mkdir(parents=True)
    monkeypatch.setattr(os, "access", lambda path, mode: False)  # file modes do not bind root, who may run the tests
    assert cache not in cached(source("a.stl"), ".obj", ten_bytes).parents


@pytest.fixture
def no_cache(tmp_path, cache):
    """A cache folder that cannot be made; the temporary folder."""
    (tmp_path / "cache").write_text("a file where the folder should be")
    return tmp_path / "tmp"


def test_the_temporary_folder_is_the_users_own_and_the_same_in_every_run(no_cache):
    folder = mesh_cache.cache_folder("meshes")
    assert folder == no_cache / f"drake_twin_{os.getuid()}" / "meshes"
    assert folder.parent.stat().st_mode & 0o777 == 0o700
    mesh_cache._temporary_base.cache_clear()  # as in another process
    assert mesh_cache.cache_folder("meshes") == folder


@pytest.mark.parametrize("place", ["link", "open to others", "file"])
def test_a_temporary_folder_that_others_may_have_made_is_not_used(no_cache, place):
    shared = no_cache / f"drake_twin_{os.getuid()}"
    match place:
        case "link":
            (no_cache / "of_another").mkdir(mode=0o700)
            shared.symlink_to(no_cache / "of_another")
        case "open to others":
            shared.mkdir()
            shared.chmod(0o770)
        case "file":
            shared.touch()
    folder = mesh_cache.cache_folder("meshes")
    assert folder.parent.name.startswith("drake_twin_")
    assert folder.parent != shared
    assert folder.parent.stat().st_mode & 0o777 == 0o700


def test_a_disk_that_is_full_is_named_and_no_part_is_left(cache, source, monkeypatch):
    def full(*_) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "replace", full)
    with pytest.raises(
        RunError, match=rf"^the cache {cache} cannot be written \(No space left on device\): name a place"
    ):
        cached(source("a.stl"), ".obj", ten_bytes)
    assert list(cache.iterdir()) == []


def test_where_the_cache_is_full_the_temporary_folder_keeps_what_is_converted_once(
    cache, source, tmp_path, monkeypatch
):
    conversions = []

    def convert(file):
        conversions.append(file)
        return b"0123456789"

    def full_cache(part, file, replace=os.replace):
        if cache in Path(file).parents:
            raise OSError(28, "No space left on device")
        replace(part, file)

    monkeypatch.setattr(os, "replace", full_cache)
    kept = cached(source("a.stl"), ".obj", convert)
    assert tmp_path / "tmp" in kept.parents
    assert kept.read_bytes() == b"0123456789"
    assert len(conversions) == 1


def test_a_full_cache_changes_no_robot_and_fails_where_nothing_can_be_kept(monkeypatch):
    """A file that cannot be written is no fault of the mesh, which a repair would leave out."""
    from conftest import ARM

    from drake_twin import TwinBuilder

    def full(file, content):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(mesh_cache, "write_whole", full)
    with pytest.raises(RunError, match="No space left on device"):
        TwinBuilder().robot("arm", ARM).build()


def test_a_missing_source_is_named(tmp_path):
    with pytest.raises(InputError, match=r"gone\.stl: the mesh cannot be read \(No such file or directory\)\."):
        cached(tmp_path / "gone.stl", ".obj", never)


def _convert(file: Path, barrier, results) -> None:
    barrier.wait()
    results.put(trimesh.load_mesh(collision_mesh(file)).extents.tolist())


def test_two_processes_that_fill_the_cache_at_once_leave_one_readable_file(tmp_path, cache):
    file = tmp_path / "ball.stl"
    file.write_bytes(trimesh.creation.icosphere(subdivisions=4).export(file_type="stl"))
    spawn = multiprocessing.get_context("spawn")
    barrier, results = spawn.Barrier(2), spawn.Queue()
    processes = [spawn.Process(target=_convert, args=(file, barrier, results)) for _ in range(2)]
    for process in processes:
        process.start()
    sizes = [results.get(timeout=60) for _ in processes]
    for process in processes:
        process.join()
    assert sizes == [pytest.approx([2.0, 2.0, 2.0], abs=0.01)] * 2
    faults, hull = sorted(cache.iterdir())
    assert hull == collision_mesh(file)
    assert faults.name == hull.name.replace(".hull.obj", ".faults.json")


def test_a_changed_picture_beside_a_mesh_makes_a_new_conversion(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    targets = []
    for paint in (b"red", b"blue", b"red"):
        folder = tmp_path / f"copy_{len(targets)}"  # elsewhere each time: only the content counts
        folder.mkdir()
        (folder / "part.obj").write_text("mtllib part.mtl\n")
        (folder / "part.mtl").write_text("newmtl a\nmap_Kd -s 1 1 1 paint.png\n")
        (folder / "paint.png").write_bytes(paint)
        targets.append(cached(folder / "part.obj", ".x", lambda source: b"converted"))
    assert targets[0] == targets[2] != targets[1]


@pytest.mark.parametrize("damage", [b"", b"01234", b"garbage", b"0123456780"])
def test_a_damaged_file_is_made_anew(source, damage):
    kept = cached(source("a.stl"), ".obj", ten_bytes)
    kept.write_bytes(damage)
    assert cached(source("a.stl"), ".obj", ten_bytes).read_bytes() == b"0123456789"


def test_a_file_without_its_checksum_is_made_anew(source, cache):
    kept = cached(source("a.stl"), ".obj", ten_bytes)
    (cache.parent / "mesh_checksums" / f"{kept.name}.sha256").unlink()
    mesh_cache._is_version_sound.cache_clear()
    made = []
    cached(source("a.stl"), ".obj", lambda file: made.append(file) or b"0123456789")
    assert made


@pytest.mark.parametrize("error", [OSError(28, "No space left on device"), KeyboardInterrupt()])
def test_what_cannot_be_finished_leaves_nothing_in_the_cache(source, cache, monkeypatch, error):
    def stopped(descriptor):
        raise error

    monkeypatch.setattr("os.fsync", stopped)
    with pytest.raises((RunError, KeyboardInterrupt)):
        cached(source("a.stl"), ".obj", ten_bytes)
    assert list(cache.iterdir()) == []


def test_the_source_of_a_cached_file_is_known_until_it_changes(tmp_path):
    source = tmp_path / "part.stl"
    source.write_bytes(trimesh.creation.box((1, 2, 3)).export(file_type="stl"))
    hull = collision_mesh(source)
    assert source_of(hull) == source
    assert source_of(hull.with_name("other.hull.obj")) is None
    source.write_bytes(trimesh.creation.box((1, 2, 4)).export(file_type="stl"))
    assert source_of(hull) is None
    source.unlink()
    assert source_of(hull) is None
