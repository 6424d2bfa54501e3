"""Films of runs: as many pictures as were simulated, of the right moments, with no effect on the run."""

import re

import numpy as np
import pytest
from mesa import need_mesa
from PIL import Image, ImageSequence

from drake_twin.film import kinds
from drake_twin.film.film_process import pictures
from drake_twin.run import main

RUN = ["--robots", "2", "--headless", "--duration", "0.5"]
SMALL = ["--record-size", "192x108", "--record-rate", "10"]


@pytest.fixture(autouse=True)
def drawing():
    need_mesa()


def run(*arguments):
    return main([*RUN, *map(str, arguments)])


def state(capsys):
    return re.search(r"state (\w+)", capsys.readouterr().out)[1]


def orange(picture):
    """Where the rover's orange is in a picture: the mean row and column, and how many pixels."""
    red, green, blue = np.moveaxis(np.asarray(picture.convert("RGB")).astype(int), 2, 0)
    rows, columns = np.nonzero((red > 130) & (red - green > 50) & (green - blue > 20))
    return rows.mean(), columns.mean(), len(rows)


def lengths(film):
    """For how long a film shows each picture (ms)."""
    found = []
    for picture in ImageSequence.Iterator(film):
        picture.load()
        found.append(picture.info["duration"])
    return found


@pytest.fixture(scope="module")
def webp(tmp_path_factory):
    pytest.importorskip("av", reason="av is not installed: pip install '.[film]'")
    file = tmp_path_factory.mktemp("film") / "run.webp"
    assert main([*RUN, "--record", str(file), *SMALL]) == 0
    return file


def test_a_film_has_a_picture_for_each_point_of_the_grid_of_simulation_times(webp):
    film = Image.open(webp)  # Pillow reads it with another library than the one that has written it
    assert film.format == "WEBP"
    assert film.size == (192, 108)
    assert film.n_frames == 5
    assert lengths(film) == [100] * 5  # ms


def test_the_robot_moves_in_the_film_and_the_ground_does_not(webp):
    frames = [frame.convert("RGB") for frame in ImageSequence.Iterator(Image.open(webp))]
    first, last = orange(frames[0]), orange(frames[-1])
    assert first[2] > 100
    assert last[2] > 100
    assert np.hypot(last[0] - first[0], last[1] - first[1]) > 1.5
    corner = [np.asarray(frame).astype(int)[-20:, :30] for frame in (frames[0], frames[-1])]
    assert np.abs(corner[0] - corner[1]).mean() < 2


def test_a_film_is_the_same_in_every_run(webp, tmp_path):
    assert run("--record", tmp_path / "again.webp", *SMALL) == 0
    assert (tmp_path / "again.webp").read_bytes() == webp.read_bytes()


def test_players_read_the_length_of_an_mp4(tmp_path):
    av = pytest.importorskip("av", reason="av is not installed: pip install '.[film]'")
    assert run("--record", tmp_path / "run.mp4", "--record-size", "192x108", "--clock-rate", 4) == 0
    with av.open(str(tmp_path / "run.mp4")) as film:
        frames = list(film.decode(video=0))
        assert film.duration == 500_000  # µs
    assert [frame.time for frame in frames] == pytest.approx(np.arange(15) / 30)
    assert {(frame.width, frame.height) for frame in frames} == {(192, 108)}


def test_a_picture_of_the_end_needs_no_more_than_pillow_and_changes_nothing(tmp_path, capsys, monkeypatch):
    assert run() == 0
    without = state(capsys)
    monkeypatch.setattr(kinds, "find_spec", lambda name: None)
    assert run("--record", tmp_path / "end.PNG", "--record-size", "192x108") == 0
    assert state(capsys) == without
    assert Image.open(tmp_path / "end.PNG").size == (192, 108)
    assert orange(Image.open(tmp_path / "end.PNG"))[2] > 100


def test_a_film_changes_nothing_and_a_recording_may_be_made_beside_it(webp, tmp_path, capsys):
    capsys.readouterr()
    assert run() == 0
    without = state(capsys)
    assert run("--record", tmp_path / "a.webm", "--record", tmp_path / "a.json", *SMALL) == 0
    assert state(capsys) == without
    assert (tmp_path / "a.webm").read_bytes()[:4] == b"\x1aE\xdf\xa3"  # of Matroska
    assert main(["--replay", str(tmp_path / "a.json"), "--headless", "--end-with-recording"]) == 0
    assert state(capsys) == without


def test_a_full_disk_is_an_error_of_the_run_and_the_rest_is_kept(tmp_path, capsys):
    (tmp_path / "full.png").symlink_to("/dev/full")
    arguments = ("--record", tmp_path / "full.png", "--record-size", "64x36", "--summary", tmp_path / "run.json")
    assert run(*arguments) == 1
    error = capsys.readouterr().err
    assert "full.png cannot be written (No space left on device); a file that was there before is unchanged" in error
    assert (tmp_path / "run.json").exists()


def test_what_cannot_be_drawn_is_an_error_of_the_run_and_the_file_before_is_kept(tmp_path, capsys, monkeypatch):
    monkeypatch.setenv("__EGL_VENDOR_LIBRARY_FILENAMES", "/no/driver.json")
    (tmp_path / "a.png").write_text("before")
    assert run("--record", tmp_path / "a.png") == 1
    error = capsys.readouterr().err
    assert error.count("a.png cannot be written (") == 1
    assert "apt-get install libegl1 libegl-mesa0 libgl1-mesa-dri" in error
    assert (tmp_path / "a.png").read_text() == "before"
    assert list(tmp_path.iterdir()) == [tmp_path / "a.png"]


def test_a_recording_process_ends_with_who_has_started_it():
    class Closed:
        def recv(self):
            raise EOFError

    with pytest.raises(EOFError):
        next(pictures(Closed(), kinds.Format(), ".mp4"))
