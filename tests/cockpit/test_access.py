import os

import pytest

from drake_twin.cockpit.access import Access, door, kept_token

OWN = Access("127.0.0.1", 7000, "secret")
EVERYWHERE = Access("0.0.0.0", 7000, "secret")


def test_the_page_itself_may_pass():
    assert OWN.refusal("127.0.0.1:7000", None, "/secret/") is None
    assert OWN.refusal("localhost:7000", "http://localhost:7000", "/secret/socket", needs_origin=True) is None


@pytest.mark.parametrize(
    "host",
    [None, "", "127.0.0.1", "127.0.0.1:7001", "evil.example:7000", "127.0.0.1.evil.example:7000", "10.0.0.1:7000"],
)
def test_another_host_is_refused(host):
    assert "does not name this server" in OWN.refusal(host, None, "/secret/")


@pytest.mark.parametrize(
    "origin", ["http://evil.example", "null", "http://127.0.0.1", "http://127.0.0.1:8000", "https://127.0.0.1:7000"]
)
def test_another_origin_is_refused(origin):
    assert "comes from another site" in OWN.refusal("127.0.0.1:7000", origin, "/secret/socket")


def test_a_web_socket_must_say_where_it_comes_from():
    assert "has no Origin header" in OWN.refusal("127.0.0.1:7000", None, "/secret/socket", needs_origin=True)


@pytest.mark.parametrize("path", ["/", "", "/secre/", "/secrett/", "/Secret/", "//secret/", "/x/secret/", "/sécret/"])
def test_without_the_token_nothing_passes(path):
    assert "has no valid token" in OWN.refusal("127.0.0.1:7000", None, path)


def test_on_every_interface_numbers_pass_and_names_do_not():
    assert EVERYWHERE.refusal("192.168.1.5:7000", None, "/secret/") is None
    assert EVERYWHERE.refusal("[fe80::1]:7000", None, "/secret/") is None
    assert EVERYWHERE.refusal("rebound.example:7000", None, "/secret/") is not None


def test_each_run_has_a_token_of_its_own_that_is_part_of_the_address():
    one, other = Access("127.0.0.1", 7000), Access("127.0.0.1", 7000)
    assert one.token != other.token
    assert len(one.token) >= 24
    assert one.url == f"http://127.0.0.1:7000/{one.token}/"
    assert Access("::1", 7000, "t").url == "http://[::1]:7000/t/"


def test_a_program_that_starts_again_has_the_token_of_the_one_before(tmp_path):
    token = kept_token(tmp_path, 7000)
    assert kept_token(tmp_path, 7000) == token
    assert kept_token(tmp_path, 7001) != token
    assert (tmp_path / "token-7000").stat().st_mode & 0o777 == 0o600


def test_a_token_that_is_a_day_old_is_not_used_again(tmp_path):
    token, file = kept_token(tmp_path, 7000), tmp_path / "token-7000"
    now = file.stat().st_mtime
    os.utime(file, (now, now - 23 * 3600))
    assert kept_token(tmp_path, 7000) == token
    os.utime(file, (now, now - 25 * 3600))
    newer = kept_token(tmp_path, 7000)
    assert newer != token
    os.utime(file, (now, now + 3600))  # the clock was set back
    assert kept_token(tmp_path, 7000) != newer


def test_the_file_that_leads_a_browser_to_the_page_is_the_users_alone(tmp_path):
    own = Access("127.0.0.1", 7000, "secret")
    (tmp_path / "open-7000.html").symlink_to(tmp_path / "elsewhere")  # which another may have put there
    file = door(tmp_path, own)
    assert file.name == "open-7000.html"
    assert not file.is_symlink()
    assert file.stat().st_mode & 0o777 == 0o600
    assert f"url={own.url}" in file.read_text()


@pytest.mark.parametrize("damage", ["open to others", "short", "link", "folder", "binary"])
def test_a_kept_token_that_others_may_know_is_not_used(tmp_path, damage):
    token, file = kept_token(tmp_path, 7000), tmp_path / "token-7000"
    match damage:
        case "open to others":
            file.chmod(0o644)
        case "short":
            file.write_text("a")
        case "binary":
            file.write_bytes(b"\xff" * 24)
        case "link":
            file.rename(tmp_path / "elsewhere")
            file.symlink_to(tmp_path / "elsewhere")
        case "folder":
            file.unlink()
            file.mkdir()
    assert kept_token(tmp_path, 7000) not in (token, "a")


def test_without_a_place_to_keep_it_a_token_is_new(tmp_path):
    assert kept_token(tmp_path / "nowhere", 7000) != kept_token(tmp_path / "nowhere", 7000)


@pytest.mark.parametrize(
    ("host", "is_local"), [("127.0.0.1", True), ("::1", True), ("localhost", True), ("0.0.0.0", False)]
)
def test_only_this_machine_reaches_a_local_page(host, is_local):
    assert Access(host, 7000).is_local == is_local
