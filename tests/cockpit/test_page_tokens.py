"""Tokens of pages: each ends when its page has been closed for an hour, and a restarted program knows them."""

import os

import pytest

from drake_twin.cockpit import page_tokens
from drake_twin.cockpit.page_tokens import LONGEST_CLOSED, MOST_PAGES, PageTokens


@pytest.fixture
def clock(monkeypatch):
    """The wall clock, which the test sets."""

    class Clock:
        now = 1e9

        def time(self):
            return self.now

    clock = Clock()
    monkeypatch.setattr(page_tokens, "time", clock)
    return clock


def test_each_page_has_a_token_of_its_own():
    tokens = PageTokens()
    one, other = tokens.new(), tokens.new()
    assert one != other
    assert len(one) >= 24
    assert one in tokens
    assert other in tokens
    for wrong in ("", one[:-1], one + "a", one.swapcase(), "\ud800"):
        assert wrong not in tokens
    assert one not in PageTokens()


def test_a_page_that_is_closed_for_an_hour_ends(clock):
    tokens = PageTokens()
    token = tokens.new()
    clock.now += LONGEST_CLOSED - 1
    assert token in tokens
    with tokens.connected(token):
        clock.now += 100 * LONGEST_CLOSED
        assert token in tokens
    clock.now += LONGEST_CLOSED - 1
    assert token in tokens
    clock.now += 1
    assert token not in tokens
    clock.now -= LONGEST_CLOSED  # the clock is set back: it has not ended only when nothing is known of its end
    tokens.new()
    clock.now -= 1
    assert token not in tokens


def test_a_restarted_program_knows_the_pages_of_the_one_before_and_their_ends(tmp_path, clock):
    file = tmp_path / "pages-7000"
    before = PageTokens(file)
    token = before.new()
    with before.connected(token):
        clock.now += 10
        assert token in PageTokens(file)  # the one before was killed
        other = before.new()
    assert token in PageTokens(file)
    assert other in PageTokens(file)
    clock.now += LONGEST_CLOSED - 1
    assert token in PageTokens(file)
    clock.now += 1
    assert token not in PageTokens(file)


def test_the_file_is_the_users_alone_and_has_no_token(tmp_path):
    file = tmp_path / "pages-7000"
    file.symlink_to(tmp_path / "elsewhere")  # which another may have put there
    token = PageTokens(file).new()
    assert not file.is_symlink()
    assert file.stat().st_mode & 0o777 == 0o600
    assert token not in file.read_text()


@pytest.mark.parametrize("damage", ["open to others", "link", "folder", "binary", "huge", "words", "pipe"])
def test_a_file_that_others_may_know_or_that_is_damaged_is_not_used(tmp_path, damage):
    file = tmp_path / "pages-7000"
    token = PageTokens(file).new()
    match damage:
        case "open to others":
            file.chmod(0o644)
        case "words":
            file.write_text(file.read_text().replace(" ", " about "))
        case "huge":
            file.write_text("x" * 10_000_000 + "\n" + file.read_text())
        case "binary":
            file.write_bytes(b"\xff" * 24 + file.read_bytes())
        case "link":
            file.rename(tmp_path / "elsewhere")
            file.symlink_to(tmp_path / "elsewhere")
        case "folder":
            file.unlink()
            file.mkdir()
        case "pipe":
            file.unlink()
            os.mkfifo(file, 0o600)
    assert token not in PageTokens(file)
    assert PageTokens(file).new()


def test_without_a_place_for_the_file_the_pages_end_with_the_program(tmp_path):
    file = tmp_path / "nowhere" / "pages-7000"
    tokens = PageTokens(file)
    token = tokens.new()
    assert token in tokens
    assert token not in PageTokens(file)


def test_of_too_many_pages_the_one_that_is_closed_longest_ends(clock):
    tokens = PageTokens()
    first = tokens.new()
    clock.now += 1
    second = tokens.new()
    clock.now += 1
    with tokens.connected(first):
        for _ in range(MOST_PAGES - 1):
            tokens.new()
        assert first in tokens
        assert second not in tokens
        assert len(tokens._pages) == MOST_PAGES
