"""What a film may be."""

from pathlib import Path

import pytest

from drake_twin.cli.options import check, parser
from drake_twin.errors import InputError
from drake_twin.film import kinds

SIZES = {
    "8x8": "both sides must be from 16 to 4096",
    "5000x100": "both sides must be from 16 to 4096",
    "101x100": "both sides of a film must be even",
}


@pytest.fixture(autouse=True)
def installed(monkeypatch):
    monkeypatch.setattr(kinds, "find_spec", lambda name: object())


def options(folder, *arguments):
    found = parser().parse_args([text.replace("DIR", str(folder)) for text in arguments])
    check(found)
    return found


def test_the_name_tells_a_film_from_a_recording(tmp_path):
    found = options(tmp_path, "--record", "DIR/a.MP4", "--record", "DIR/a.json")
    assert (found.film, found.record) == (tmp_path / "a.MP4", tmp_path / "a.json")
    assert (options(tmp_path).film, options(tmp_path).record) == (None, None)


@pytest.mark.parametrize("size", SIZES)
def test_a_size_that_no_film_has_is_refused(tmp_path, size):
    with pytest.raises(InputError, match=SIZES[size]):
        options(tmp_path, "--record", "DIR/a.mp4", "--record-size", size)


def test_a_picture_may_have_odd_sides(tmp_path):
    assert options(tmp_path, "--record", "DIR/a.png", "--record-size", "101x99").record_size == (101, 99)


@pytest.mark.parametrize("rate", ["0", "-1", "nan", "1e9"])
def test_a_rate_that_no_film_has_is_refused(tmp_path, rate):
    with pytest.raises(InputError, match="there must be 1 to 240"):
        options(tmp_path, "--record", "DIR/a.mp4", "--record-rate", rate)


@pytest.mark.parametrize("option", [("--record-size", "64x64"), ("--record-rate", "10")])
def test_options_of_a_film_without_one_are_refused(tmp_path, option):
    with pytest.raises(InputError, match=rf"{option[0]} is about a film: it needs --record FILE with a name in \.mp4"):
        options(tmp_path, "--record", "DIR/a.json", *option)


def test_a_film_in_no_folder_is_refused(tmp_path):
    with pytest.raises(InputError, match=r"--record .*a\.mp4: no file can be written there"):
        options(tmp_path, "--record", "DIR/no/a.mp4")


def test_the_extra_that_is_missing_is_named(tmp_path, monkeypatch):
    monkeypatch.setattr(kinds, "find_spec", lambda name: None)
    expected = r"--record a\.mp4 needs av, .*: `.*pip install .*'av>=14'`, or name a file \.png"
    with pytest.raises(InputError, match=expected):
        kinds.check_film("--record", Path("a.mp4"), kinds.Format())
