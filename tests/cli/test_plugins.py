"""``--plugin``: modules of others are imported before anything is planned."""

import sys

import pytest
from conftest import ARM

from drake_twin.check import main as check
from drake_twin.cli.plugins import load_plugins
from drake_twin.cockpit.page_panel import PAGE_PANELS
from drake_twin.errors import InputError
from drake_twin.run import main as run


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A folder that Python imports modules from; they are forgotten at the end."""
    before = set(sys.modules)
    monkeypatch.syspath_prepend(tmp_path)
    yield tmp_path
    for name in set(sys.modules) - before:
        if str(getattr(sys.modules[name], "__file__", "")).startswith(str(tmp_path)):
            del sys.modules[name]


@pytest.mark.parametrize("program", [run, check])
@pytest.mark.parametrize("name", ["my_kinds", "{folder}/my_kinds.py"])
def test_a_module_is_imported_before_files_are_read(folder, capsys, program, name):
    (folder / "my_kinds.py").write_text("print('registers its kinds')\n")
    assert program(["/nowhere.urdf", "--plugin", name.format(folder=folder)]) in (1, 2)
    assert capsys.readouterr().out.startswith("registers its kinds\n")


def test_a_run_with_plugins_runs(folder, capsys):
    for name in ("one", "other"):
        (folder / f"{name}.py").write_text(f"print('{name}')\n")
    assert run([ARM, "--plugin", "one", "--plugin", f"{folder}/other.py", "--headless", "--duration", "0.01"]) == 0
    assert capsys.readouterr().out.startswith("one\nother\n")


def test_each_is_imported_once(folder, capsys):
    (folder / "once.py").write_text("print('here')\n")
    load_plugins([f"{folder}/once.py", f"{folder}/../{folder.name}/once.py"])
    assert capsys.readouterr().out == "here\n"


def test_files_of_the_same_name_are_different_modules(folder, capsys):
    for name in ("a", "b"):
        (folder / name).mkdir()
        (folder / name / "json.py").write_text(f"print('{name}')\n")
    load_plugins([f"{folder}/a/json.py", f"{folder}/b/json.py"])
    assert capsys.readouterr().out == "a\nb\n"
    import json

    assert json.dumps(1) == "1"


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("no_such_package.kinds", "--plugin no_such_package.kinds: no module named 'no_such_package'; a file is named"),
        ("json.no_such_module", "--plugin json.no_such_module: no module named 'json.no_such_module'"),
        ("{folder}/gone.py", "--plugin {folder}/gone.py: no such file."),
        ("{folder}/wrong.py", "{folder}/wrong.py:2: --plugin {folder}/wrong.py: ZeroDivisionError: division by zero."),
        ("wrong", "{folder}/wrong.py:2: --plugin wrong: ZeroDivisionError: division by zero."),
        ("{folder}/broken.py", "{folder}/broken.py:1: --plugin {folder}/broken.py: SyntaxError: "),
        ("needy", "{folder}/needy.py:1: --plugin needy: ModuleNotFoundError: No module named 'no_such_package'."),
        ("leaving", "{folder}/leaving.py:1: --plugin leaving: SystemExit: 3."),
    ],
)
def test_a_plugin_that_cannot_be_imported_is_one_paragraph(folder, capsys, name, message):
    (folder / "wrong.py").write_text("x = 1\ny = x / 0\n")
    (folder / "broken.py").write_text("def (\n")
    (folder / "needy.py").write_text("import no_such_package\n")
    (folder / "leaving.py").write_text("raise SystemExit(3)\n")
    name, message = name.format(folder=folder), message.format(folder=folder)
    assert run([ARM, "--headless", "--duration", "0.01", "--plugin", name]) == 2
    error = capsys.readouterr().err
    assert error.startswith(f"error: {message}")
    assert error.count("\n") == 1
    with pytest.raises(InputError) as raised:
        run([ARM, "--headless", "--duration", "0.01", "--plugin", name, "--debug"])
    assert raised.value.__cause__ is not None or "gone.py" in name


PANEL = """
from drake_twin.cockpit.page_panel import page_panel

@page_panel({title!r})
def fill(panel, twin):
    panel.button("Press")
"""


def test_a_file_with_a_panel_is_imported_and_one_without_is_refused(folder, capsys, monkeypatch):
    monkeypatch.setattr(PAGE_PANELS, "_kinds", PAGE_PANELS._kinds.new_child())
    (folder / "mine.py").write_text(PANEL.format(title="My panel"))
    (folder / "none.py").write_text("print('no panel')\n")
    (folder / "long.py").write_text(PANEL.format(title="x" * 200))
    (folder / "twice.py").write_text(PANEL.format(title="My panel"))
    command = [ARM, "--headless", "--duration", "0.01", "--panel"]
    assert run([*command, f"{folder}/mine.py"]) == 0
    assert "My panel" in PAGE_PANELS
    capsys.readouterr()
    for name, why in (
        ("none", f"--panel {folder}/none.py: it adds no panel to the page. A function with @page_panel('TITLE')"),
        ("nowhere", f"--panel {folder}/nowhere.py: no such file"),
        ("long", "cannot be a name on the page: a text of 1 to 100 characters is needed"),
        ("twice", "panel of the page 'My panel' is registered by mine"),
    ):
        assert run([*command, f"{folder}/{name}.py"]) == 2
        assert why in capsys.readouterr().err
