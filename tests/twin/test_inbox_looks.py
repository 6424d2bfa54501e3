"""How often the twin looks whether anybody asks for something, in simulation time."""

import numpy as np
import pytest
from conftest import rovers

from drake_twin.twin.inbox import Inbox


@pytest.fixture
def looks(monkeypatch):
    """The times (s) of the looks into any inbox."""
    times = []
    has_request = Inbox.has_request

    def noted(inbox):
        times.append(inbox.now())
        return has_request(inbox)

    monkeypatch.setattr(Inbox, "has_request", noted)
    return times


def test_an_inbox_in_which_nobody_asks_is_looked_into_less_often(looks):
    """Each 5 ms at first and after a request, each 50 ms after 200 looks without one; the states are the same."""
    with rovers(1).build() as twin, rovers(1).build() as alone:
        twin.inbox.open()
        twin.inbox.now = lambda: twin.context.get_time()
        done = []
        for end in (3.0, 6.0):
            twin.advance_to(end)
            apart = np.diff(looks)
            assert apart[:199].min() == pytest.approx(0.005, abs=1e-6)
            assert apart[:199].max() < 0.0151  # where the advance stops anyhow nobody has to look
            assert apart[200:].min() == pytest.approx(0.05, abs=1e-6)
            looks.clear()
            twin.inbox.put(lambda: done.append(twin.time))
        twin.advance_to(6.5)
        assert done == [3.0, 6.0]
        alone.advance_to(6.5)
        assert twin.state_sha256() == alone.state_sha256()
