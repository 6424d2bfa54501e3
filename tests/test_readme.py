import re
import subprocess
from pathlib import Path

import pytest

import drake_twin

ROOT = Path(__file__).resolve().parent.parent
PACKAGE = Path(drake_twin.__file__).parent  # in the checkout, or installed beside it
README = (ROOT / "README.md").read_text(encoding="utf-8")
PAGES = [
    ROOT / "README.md",
    *sorted((ROOT / ".github").glob("*.md")),
    *sorted((ROOT / "drake_twin" / "docs").rglob("*.md")),
]


def test_it_is_short():
    assert len(README.splitlines()) <= 150


def test_the_python_of_the_readme_runs_and_its_assertions_hold(capsys):
    program = "\n".join(re.findall(r"```python\n(.*?)```", README, re.DOTALL))
    exec(compile(program, "README.md", "exec"), {})
    printed = capsys.readouterr().out
    assert printed.count("[") == 50  # ten joint states a second for five seconds
    assert re.search(r"^[0-9a-f]{64}$", printed, re.MULTILINE)


def named_paths(page: Path) -> set[Path]:
    """The files and folders that a page names: targets of its links, and quoted paths from the top of the tree."""
    text = page.read_text(encoding="utf-8")
    links = {page.parent / link for link in re.findall(r"\]\((?!https?:)([^)#\s]+)[^)]*\)", text)}
    quoted = re.findall(r"`((?:drake_twin|models|diagrams|tests|\.github|\.ci)/(?:[\w/.-]*/|[\w/.-]+\.\w+)?)`", text)
    return links | {PACKAGE.parent / path if path.startswith("drake_twin/") else ROOT / path for path in quoted}


# A controller type that looks like a path; and a page that shows how a file is added names it before it is there.
ADDED = {f"{path}/{name}" for path, name in (("drake_twin/controllers", "approach_controller.py"),)} | {
    "tests/controllers/test_approach_controller.py",
    "drake_twin/VectorCommandController",
}


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_every_file_and_folder_that_a_page_names_is_there(page):
    for path in named_paths(page) - {root / name for name in ADDED for root in (ROOT, PACKAGE.parent)}:
        assert path.exists(), f"{page.name} names {path.relative_to(ROOT)}"


def test_the_readme_links_to_every_page():
    linked = {path.resolve() for path in named_paths(ROOT / "README.md")}
    pages = {page for page in PAGES if page.parent.name == "docs" and page.name != "index.md"}
    assert pages <= linked


def test_the_ci_calls_the_readmes_commands():
    ci = (ROOT / ".ci" / "run").read_text()
    first, second = re.findall(r"```sh\n(.*?)\n```", README, re.DOTALL)[:2]
    assert first.replace("python3 -m", '"$python" -m').replace("install .", 'install -q "$what"') in ci
    assert second.replace("install '.[test]'", 'install -q "${what}[test]"') in ci
    assert 'readme "$oldest" .\n' in ci
    assert 'readme "$newest" "$wheel"' in ci


def test_the_top_level_is_what_it_is_meant_to_be():
    tracked = subprocess.run(["git", "ls-files"], cwd=ROOT, capture_output=True, text=True, check=False)
    if tracked.returncode != 0:
        pytest.skip("this is not a git checkout")
    top = {path.partition("/")[0] for path in tracked.stdout.splitlines()}
    assert {name for name in top if not name.startswith(".")} == {
        "LICENSE", "README.md", "diagrams", "drake_twin", "models", "pyproject.toml", "tests"
    }  # fmt: skip


def test_mujoco_adds_and_deletes_robots_and_keeps_the_state_of_the_others():
    """The row of the table: equal to the bit at the edit; their motion afterwards differs by rounding."""
    mujoco = pytest.importorskip("mujoco")
    spec = mujoco.MjSpec()
    spec.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_PLANE, size=[10, 10, 0.1])

    def add(name, x):
        body = spec.worldbody.add_body(name=name, pos=[x, 0, 0.3])
        body.add_freejoint()
        body.add_geom(type=mujoco.mjtGeom.mjGEOM_BOX, size=[0.2, 0.1, 0.05], mass=1)

    add("a", 0.0)
    add("b", 2.0)
    model = spec.compile()
    data = mujoco.MjData(model)
    data.qvel[4] = 1.0
    for _ in range(300):
        mujoco.mj_step(model, data)
    before = data.qpos.copy(), data.qvel.copy(), data.qacc_warmstart.copy(), data.time
    add("c", 4.0)
    model, data = spec.recompile(model, data)
    assert (data.qpos[:14] == before[0]).all()
    assert (data.qvel[:12] == before[1]).all()
    assert (data.qacc_warmstart[:12] == before[2]).all()
    assert data.time == before[3]
    spec.delete(spec.body("b"))
    model, data = spec.recompile(model, data)
    assert (data.qpos[:7] == before[0][:7]).all()
    assert (data.qpos[7:10] == [4.0, 0.0, 0.3]).all()
