import sys

import pytest

from drake_twin import extensions
from drake_twin.controllers.registry import CONTROLLERS
from drake_twin.errors import InputError
from drake_twin.extensions import Registry, load_extensions
from drake_twin.ros2.launch.frontend.expose import ACTIONS, SUBSTITUTIONS
from drake_twin.sensors.registry import SENSORS

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
    modules = {*sys.modules}
    _forget()
    yield install
    _forget()
    for module in {*sys.modules} - modules:
        if getattr(sys.modules[module], "__file__", None) and str(tmp_path) in sys.modules[module].__file__:
            del sys.modules[module]


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


@pytest.fixture
def kinds(tmp_path, installed, monkeypatch):
    """A registry of animals, with a package ``zoo`` of three modules in the place of the twin's own."""
    zoo = tmp_path / "zoo"
    zoo.mkdir()
    (zoo / "__init__.py").write_text("")
    text = "from test_extensions import animal\n@animal({names})\nclass Kind:\n    pass\n"
    (zoo / "bear.py").write_text(text.format(names='"bear", "polar bear"'))
    (zoo / "cat.py").write_text('"""Of the type ``cat``."""\nCAT = "c" "at"\n' + text.format(names="CAT"))
    (zoo / "dog.py").write_text(text.format(names='"dog"'))
    (zoo / "keeper.py").write_text('raise RuntimeError("registers nothing, and names \\"bear\\"")\n')
    registry = Registry("animal", "animal", GROUP, ["zoo"], first=["dog"])
    monkeypatch.setattr(sys.modules[__name__], "REGISTRY", registry)
    monkeypatch.setitem(sys.modules, "test_extensions", sys.modules[__name__])
    monkeypatch.setattr(extensions._Entry, "is_own", property(lambda entry: entry.module.startswith("zoo.")))
    return registry


REGISTRY: Registry | None = None
MORE = "from test_extensions import animal\n@animal({!r})\nclass Kind:\n    pass\n"


def animal(*names):
    """The decorator of the registry at hand."""

    def register(kind):
        for name in names:
            REGISTRY.add(name, kind, kind)
        return kind

    return register


def loaded():
    return {name for name in ("bear", "cat", "dog", "keeper") if f"zoo.{name}" in sys.modules}


def test_a_lookup_imports_the_module_that_names_the_kind(kinds):
    assert kinds["polar bear"].__module__ == "zoo.bear"
    assert loaded() == {"bear"}
    assert kinds["cat"].__module__ == "zoo.cat"  # registered by a constant, and named in the text
    assert loaded() == {"bear", "cat"}


def test_an_unknown_name_is_looked_for_everywhere_and_refused_with_those_there_are(kinds, installed):
    installed("a_farm", MORE.format("cow"))
    assert kinds.get("zebra") is None
    assert loaded() == {"bear", "cat", "dog"}
    assert "a_farm" in sys.modules
    with pytest.raises(
        InputError, match=r"unknown animal 'bea'\. Did you mean 'bear'\? Valid: bear, cat, cow, dog, polar"
    ):
        raise kinds.unknown("bea")


def test_the_first_modules_come_first_then_the_others_by_name_then_those_of_packages(kinds, installed):
    installed("a_farm", MORE.format("cow"))
    assert kinds["cow"].__module__ == "a_farm"
    assert [*kinds] == ["dog", "bear", "polar bear", "cat", "cow"]


@pytest.mark.parametrize("looked_up", [True, False])
def test_a_package_cannot_take_a_name_of_the_twins_own(kinds, installed, looked_up):
    assert not looked_up or kinds["dog"]
    installed("a_farm", MORE.format("dog"))
    with pytest.raises(InputError, match=r"animal 'dog' is registered by zoo\.dog and by a_farm"):
        load_extensions(GROUP)
    assert kinds["dog"].__module__ == "zoo.dog"


def test_a_module_that_is_imported_again_replaces_its_own_kind(kinds):
    first = kinds["dog"]
    del sys.modules["zoo.dog"]
    __import__("zoo.dog")
    assert kinds["dog"] is not first


def test_what_passes_goes_with_its_module_and_the_twins_own_stay(kinds, installed):
    installed("a_farm", MORE.format("cow"))
    with kinds.passing():
        assert {"dog", "cow"} <= {*kinds}
        del sys.modules["a_farm"]
    assert [*kinds] == ["dog", "bear", "polar bear", "cat"]
    _forget()
    with kinds.passing():
        assert "cow" in kinds
    assert "cow" in kinds


@pytest.mark.parametrize("registry", [CONTROLLERS, SENSORS, ACTIONS, SUBSTITUTIONS], ids=lambda item: item.noun)
def test_each_module_of_the_twin_names_its_kinds(registry):
    """Else a lookup would import all of them."""
    for name in registry:
        entry = registry._kinds[name]
        assert (
            not entry.is_own
            or f'"{name}"' in registry._own[entry.module]
            or f"``{name}``" in registry._own[entry.module]
        )
