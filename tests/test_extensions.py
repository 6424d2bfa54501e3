import sys

import pytest

from drake_twin import extensions
from drake_twin.errors import InputError
from drake_twin.extensions import load_extensions

GROUP = "drake_twin.tests"


@pytest.fixture
def installed(tmp_path, monkeypatch):
    """A function that installs a package with an entry point of the group."""

    def install(module: str, text: str) -> None:
        (tmp_path / f"{module}.py").write_text(text)
        info = tmp_path / f"{module}-1.0.dist-info"
        info.mkdir()
        (info / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {module}\nVersion: 1.0\n")
        (info / "entry_points.txt").write_text(f"[{GROUP}]\nmine = {module}\n")

    monkeypatch.syspath_prepend(tmp_path)
    _forget()
    yield install
    _forget()


def _forget() -> None:
    extensions._named_groups.cache_clear()
    load_extensions.cache_clear()


def test_a_module_that_an_entry_point_names_is_imported_once(installed):
    installed("an_extension", "loads = []\nloads.append(1)\n")
    load_extensions(GROUP)
    load_extensions(GROUP)
    assert sys.modules.pop("an_extension").loads == [1]


def test_a_module_of_another_group_is_not_imported(installed):
    installed("an_extension", "")
    load_extensions("drake_twin.other")
    assert "an_extension" not in sys.modules


def test_a_module_that_cannot_be_imported_is_named(installed):
    installed("a_broken_extension", "raise RuntimeError('no licence')")
    what = r"entry point mine = a_broken_extension of drake_twin\.tests cannot be loaded \(RuntimeError: no licence\)"
    with pytest.raises(InputError, match=what):
        load_extensions(GROUP)
