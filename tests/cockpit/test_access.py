import pytest

from drake_twin.cockpit.access import Access

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
    assert "does not go by that name" in OWN.refusal(host, None, "/secret/")


@pytest.mark.parametrize(
    "origin", ["http://evil.example", "null", "http://127.0.0.1", "http://127.0.0.1:8000", "https://127.0.0.1:7000"]
)
def test_another_origin_is_refused(origin):
    assert "comes from another site" in OWN.refusal("127.0.0.1:7000", origin, "/secret/socket")


def test_a_web_socket_must_say_where_it_comes_from():
    assert "does not say" in OWN.refusal("127.0.0.1:7000", None, "/secret/socket", needs_origin=True)


@pytest.mark.parametrize("path", ["/", "", "/secre/", "/secrett/", "/Secret/", "//secret/", "/x/secret/", "/sécret/"])
def test_without_the_token_nothing_passes(path):
    assert "lacks this run's token" in OWN.refusal("127.0.0.1:7000", None, path)


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
