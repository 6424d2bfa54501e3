import pytest

from drake_twin.cockpit.access import Access, door

OWN = Access("127.0.0.1", 7000, "secret")
EVERYWHERE = Access("0.0.0.0", 7000, "secret")


def test_the_page_itself_may_pass():
    assert OWN.refusal("127.0.0.1:7000", None) is None
    assert OWN.refusal("localhost:7000", "http://localhost:7000", needs_origin=True) is None


@pytest.mark.parametrize(
    "host",
    [None, "", "127.0.0.1", "127.0.0.1:7001", "evil.example:7000", "127.0.0.1.evil.example:7000", "10.0.0.1:7000"],
)
def test_another_host_is_refused(host):
    assert "does not name this server" in OWN.refusal(host, None)


@pytest.mark.parametrize(
    "origin", ["http://evil.example", "null", "http://127.0.0.1", "http://127.0.0.1:8000", "https://127.0.0.1:7000"]
)
def test_another_origin_is_refused(origin):
    assert "comes from another site" in OWN.refusal("127.0.0.1:7000", origin)


def test_a_web_socket_must_say_where_it_comes_from():
    assert "has no Origin header" in OWN.refusal("127.0.0.1:7000", None, needs_origin=True)


def test_on_every_interface_numbers_pass_and_names_do_not():
    assert EVERYWHERE.refusal("192.168.1.5:7000", None) is None
    assert EVERYWHERE.refusal("[fe80::1]:7000", None) is None
    assert EVERYWHERE.refusal("rebound.example:7000", None) is not None


def test_each_run_has_a_key_of_its_own_in_the_part_of_the_address_that_is_sent_nowhere():
    one, other = Access("127.0.0.1", 7000), Access("127.0.0.1", 7000)
    assert one.key != other.key
    assert len(one.key) >= 24
    assert one.url == f"http://127.0.0.1:7000/#{one.key}"
    assert Access("::1", 7000, "t").url == "http://[::1]:7000/#t"


@pytest.mark.parametrize("given", [b"", b"secre", b"secrett", b"Secret", b" secret", b"\xff"])
def test_nothing_but_the_key_is_the_key(given):
    assert not OWN.is_key(given)
    assert OWN.is_key(b"secret")


def test_the_file_that_leads_a_browser_to_the_page_is_the_users_alone(tmp_path):
    own = Access("127.0.0.1", 7000, "secret")
    (tmp_path / "open-7000.html").symlink_to(tmp_path / "elsewhere")  # which another may have put there
    file = door(tmp_path, own)
    assert file.name == "open-7000.html"
    assert not file.is_symlink()
    assert file.stat().st_mode & 0o777 == 0o600
    assert f"url={own.url}" in file.read_text()


@pytest.mark.parametrize(
    ("host", "is_local"), [("127.0.0.1", True), ("::1", True), ("localhost", True), ("0.0.0.0", False)]
)
def test_only_this_machine_reaches_a_local_page(host, is_local):
    assert Access(host, 7000).is_local == is_local
