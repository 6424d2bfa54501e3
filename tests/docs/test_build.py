"""The pages and the API reference are built without a warning, and show what docstrings say of systems."""

import re
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

import pytest
from chromium import CHROMIUM, OFFLINE, SOFTWARE_RENDERING

import drake_twin

DOCS = Path(__file__).resolve().parents[2] / "drake_twin" / "docs"
pytestmark = [
    pytest.mark.slow,  # it builds all pages
    pytest.mark.skipif(
        any(find_spec(name) is None for name in ("sphinx", "myst_parser", "furo")),
        reason="Sphinx is not installed: pip install '.[docs]'",
    ),
]


def build(source: Path, target: Path, *options: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "sphinx", "-W", "--keep-going", "-q", *options, str(source), str(target)]
    return subprocess.run(command, capture_output=True, text=True, timeout=300, check=False)


@pytest.fixture(scope="module")
def html(tmp_path_factory):
    folder = tmp_path_factory.mktemp("html")
    run = build(DOCS, folder)
    assert run.returncode == 0, run.stderr
    return folder


def test_it_has_every_page_and_class(html):
    for page in DOCS.rglob("*.md"):
        assert (html / page.relative_to(DOCS).with_suffix(".html")).is_file()
    text = (html / "api" / "twin.html").read_text()
    assert 'id="drake_twin.Twin.advance_to"' in text  # as users import it
    assert "Raises" in text


def test_names_stand_under_their_shortest_addresses(html):
    """A public name of a package is documented there, and what only its module has, under the module."""
    found = "".join(page.read_text() for page in (html / "api").glob("*.html"))
    addresses = {name: name for name in drake_twin.__all__ if name != "__version__"}
    addresses["show"] = "show.show"  # `drake_twin.show` is a module, too
    for name, address in addresses.items():
        assert f'id="drake_twin.{address}"' in found, name
    assert 'id="drake_twin.controllers.PeriodicController"' in found
    assert 'id="drake_twin.twin.controller_manager.ControllerManager"' in found


_WIDTHS = """() => [...document.querySelectorAll("article table")].map(table => {
  const frame = table.closest(".table-wrapper") || table.parentElement;
  return [table.offsetWidth, frame.clientWidth, table.querySelector("tr").innerText];
})"""


@pytest.mark.browser
@pytest.mark.skipif(CHROMIUM is None, reason="no Chromium here (on Debian: apt install chromium)")
def test_no_table_is_wider_than_its_page(html):
    from playwright.sync_api import sync_playwright

    count, wide = 0, []
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=SOFTWARE_RENDERING + OFFLINE)
        for width in (1280, 800):
            tab = browser.new_page(viewport={"width": width, "height": 800})
            for page in sorted(html.rglob("*.html")):
                tab.goto(page.as_uri())
                for table, frame, row in tab.evaluate(_WIDTHS):
                    count += 1
                    wide += [(width, page.name, row)] if table > frame + 1 else []  # + 1: widths are rounded
        browser.close()
    assert count > 300
    assert wide == []


def test_ports_of_systems_are_drawn(html):
    text = re.sub(r"<[^>]+>|\s+", " ", (html / "api" / "controllers.html").read_text().replace("<wbr>", ""))
    assert re.search(r"input ports +output ports +commands +ForwardCommandController +command_interfaces", text)
    assert "pydrake_system" not in text


@pytest.mark.parametrize(
    ("text", "warning"),
    [
        ("[a page](nowhere.md)", "nowhere.md"),
        ("```{eval-rst}\n.. pydrake_system::\n\n   inputs: [a]\n```", "pydrake_system: KeyError('name')"),
    ],
)
def test_a_broken_link_and_a_system_without_a_name_fail(tmp_path, text, warning):
    source = tmp_path / "source"
    source.mkdir()
    for name in ("conf.py", "pydrake_system.py"):
        (source / name).write_text((DOCS / name).read_text())
    (source / "index.md").write_text(f"# Index\n\n{text}\n")
    run = build(source, tmp_path / "html")
    assert run.returncode != 0
    assert warning in run.stderr


def test_the_names_are_listed():
    assert set(drake_twin.__all__) <= set(dir(drake_twin))
