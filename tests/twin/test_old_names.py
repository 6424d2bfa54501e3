"""What `Twin` had before its methods were grouped works, and warns with the name of today."""

import pytest
from conftest import rovers

from drake_twin.twin.old_names import Moved, OldNames

OLD = {name: moved._path for name, moved in vars(OldNames).items() if isinstance(moved, Moved)}


@pytest.fixture(scope="module")
def twin():
    return rovers(1).build()


@pytest.mark.parametrize("name", OLD)
def test_an_older_name_is_what_its_new_one_is_and_the_warning_names_that(twin, name):
    value = twin
    for part in OLD[name].split("."):
        value = getattr(value, part)
    with pytest.warns(DeprecationWarning, match=rf"^Twin\.{name} is an older name of Twin\.{OLD[name]}$") as warned:
        assert getattr(twin, name) == value
    assert [warning.filename for warning in warned] == [__file__]


def test_a_value_that_is_set_by_its_older_name_is_set():
    twin = rovers(1).build()
    with pytest.warns(DeprecationWarning, match="is an older name of Twin.clock.paused"):
        twin.paused = True
    with pytest.warns(DeprecationWarning, match="is an older name of Twin.clock.real_time_rate"):
        twin.real_time_rate = 2.0
    assert (twin.clock.paused, twin.clock.real_time_rate) == (True, 2.0)


def test_the_class_knows_its_older_names_without_a_warning():
    assert {name for name in dir(OldNames) if isinstance(getattr(OldNames, name), Moved)} == set(OLD)
