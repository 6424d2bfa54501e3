"""A page that outlives its twin, as with ``--watch``."""

import pytest
from conftest import rovers

from drake_twin import Twin
from drake_twin.cockpit import protocol
from drake_twin.cockpit.scene import OVERLAYS
from drake_twin.cockpit.served_page import ServedPage


@pytest.fixture
def served():
    page = ServedPage()
    yield page
    page.close()


def test_a_new_twin_takes_the_place_of_the_one_before(served):
    first, second = Twin(rovers(1).scenario()), Twin(rovers(2).scenario())
    before = served.show(first)
    served.server._enqueue(1, protocol.Show("collision", True))
    before.process_requests()
    assert served.scene.has_path(f"{OVERLAYS}/collision")
    after = served.show(second)
    assert not served.scene.has_path(f"{OVERLAYS}/collision")
    served.server._enqueue(1, protocol.Step(3))
    after.process_requests()
    assert (first.clock.step_count, second.clock.step_count) == (0, 3)


def test_a_twin_that_is_only_displayed_stands_still(served):
    twin = Twin(rovers(1).scenario())
    served.show(twin, only_displayed=True)
    assert twin.clock.paused


def test_two_programs_have_pages_of_their_own(served):
    other = ServedPage()
    assert served.server.access.port != other.server.access.port
    other.close()
