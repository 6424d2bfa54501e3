"""What is required, and what is said where it is missing, old or broken."""

import json
import os
import pickle
import re
import shlex
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

import drake_twin
from drake_twin.errors import InputError
from drake_twin.requirements import BASE, DEVELOPMENT, DRAKE, EXTRAS, OPTIONAL, explanation, missing

PACKAGE = Path(drake_twin.__file__).parent
ROOT = Path(__file__).resolve().parent.parent
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
EXTRAS_OF_PROJECT = PROJECT["optional-dependencies"]
PAGES = [ROOT / "README.md", ROOT / ".github" / "CONTRIBUTING.md", *sorted((PACKAGE / "docs").glob("*.md"))]
INSTALL = re.compile(r"pip install ([^`&|\n]*)")

OLD = "1.50.0"
PROGRAMS = {
    "run": ["drake_twin.run", "--headless", "--duration", "0.1"],
    "drake-twin": ["drake_twin", "run", "--headless", "--duration", "0.1"],
    "check": ["drake_twin.check", str(ROOT / "models/rover_description/urdf/rover.urdf.xacro")],
    "sweep": ["drake_twin.sweep", str(ROOT / "diagrams/two_rovers.yaml"), "--vary", "friction=0.1", "--out", "t.csv"],
    "benchmarks": ["drake_twin.benchmarks", "--quick"],
}
REFUSAL = {
    "absent": r"drake_twin needs drake, which is not installed: `.*pip install 'drake>=1\.51\.1'`\.",
    "broken": r"drake_twin needs Drake, which .* cannot be imported \(ImportError: .*\): `.* 'drake>=1\.51\.1'`\.",
    "old": r"drake_twin needs Drake 1\.51\.1 or newer, and 1\.50\.0 is installed: `.*pip install 'drake>=1\.51\.1'`\.",
    "library": r"drake_twin needs Drake, .*libX\.so.*: install the system's package with that library \(http.*\)\.",
}


def requirements(extra):
    """The requirements of an extra, and of those that it names."""
    for requirement in EXTRAS_OF_PROJECT[extra]:
        if own := re.fullmatch(r"drake-twin\[(.*)\]", requirement):
            for other in own[1].split(","):
                yield from requirements(other)
        else:
            yield requirement.partition(";")[0]


def python(*arguments, folder, **environment):
    return subprocess.run(
        [sys.executable, *arguments],
        capture_output=True,
        text=True,
        cwd=folder,
        env=os.environ | environment,
        timeout=120,
        check=False,
    )


@pytest.fixture
def drake(tmp_path, monkeypatch, request):
    """Put a pydrake onto the path that is absent, broken or old."""
    package = tmp_path / "path" / "pydrake"
    package.mkdir(parents=True)
    if request.param == "absent":
        text = "raise ModuleNotFoundError(\"No module named 'pydrake'\", name='pydrake')"
        hidden = "import importlib.util as u; f = u.find_spec; u.find_spec = lambda n: None if n == 'pydrake' else f(n)"
        (package.parent / "sitecustomize.py").write_text(hidden)
    elif request.param == "old":
        text = ""
        info = package.parent / f"drake-{OLD}.dist-info"
        info.mkdir()
        (info / "METADATA").write_text(f"Metadata-Version: 2.1\nName: drake\nVersion: {OLD}\n")
    else:
        reason = "libX.so: cannot open shared object file" if request.param == "library" else "worn out"
        text = f"raise ImportError({reason!r})"
    (package / "__init__.py").write_text(text)
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join((str(package.parent), str(PACKAGE.parent))))
    return request.param


def test_the_base_is_that_of_the_project():
    assert sorted(BASE.values()) == sorted(text.partition(";")[0] for text in PROJECT["dependencies"])
    assert BASE["pydrake"] == "drake>=" + ".".join(map(str, DRAKE))


def test_the_extras_are_those_of_the_project():
    assert EXTRAS_OF_PROJECT.keys() == {*EXTRAS, *DEVELOPMENT}
    for name, extra in EXTRAS.items():
        assert sorted(OPTIONAL[module] for module in extra.modules) == sorted(set(requirements(name))), name


def test_all_is_all_but_what_developers_need():
    (names,) = EXTRAS_OF_PROJECT["all"]
    assert names == f"drake-twin[{','.join(sorted(EXTRAS.keys() - {'all'}))}]"


def test_the_page_lists_the_extras():
    page = (PACKAGE / "docs" / "start.md").read_text()
    for name, extra in EXTRAS.items():
        brings = ", ".join(OPTIONAL[module].partition(">")[0] for module in extra.modules)
        assert f"| `{name}` | {extra.purpose} | {'' if name == 'all' else brings + ' '}|\n" in page


def test_pages_install_extras_that_exist_from_the_checkout():
    for page in PAGES:
        for arguments in INSTALL.findall(page.read_text()):
            for name, extras in re.findall(r"([\w.-]+)\[([\w,]+)\]", arguments):
                assert name == ".", f"{page.name}: {arguments}"
                assert set(extras.split(",")) <= EXTRAS_OF_PROJECT.keys(), f"{page.name}: {arguments}"


@pytest.mark.parametrize("folder", ["drake_twin", "diagrams", "tests"])
def test_no_text_installs_from_an_index_where_it_is_not(folder):
    own = Path(__file__).name
    files = [file for file in sorted((ROOT / folder).rglob("*")) if file.suffix in (".py", ".md", ".ipynb")]
    found = [file.name for file in files if file.name != own and re.search(r"install.*drake-twin\[", file.read_text())]
    assert found == []


def test_reasons_of_skipped_tests_name_extras_that_exist():
    for file in sorted((ROOT / "tests").rglob("*.py")):
        for extra in re.findall(r"pip install '\.\[(\w+)\]'", file.read_text()):
            assert extra in EXTRAS_OF_PROJECT, file.name


def test_each_module_that_a_feature_asks_for_is_in_the_table():
    for file in sorted(PACKAGE.rglob("*.py")):
        for arguments in re.findall(r'\bmissing\(\s*f?"[^"]*"((?:, "\w+")+)', file.read_text()):
            assert set(re.findall(r"\w+", arguments)) <= {*BASE, *OPTIONAL}, file.name


def test_what_is_missing_is_named_with_the_command_that_installs_it(monkeypatch):
    for module in ("zenoh", "xxhash"):
        monkeypatch.setitem(sys.modules, module, None)
    text = str(missing("the ROS 2 graph needs", "zenoh", "numpy", "xxhash"))
    start, command, end = text.split("`")
    assert (start, end) == ("the ROS 2 graph needs eclipse-zenoh and xxhash, which are not installed: ", ".")
    interpreter, *rest = shlex.split(command)
    assert rest == ["-m", "pip", "install", "eclipse-zenoh>=1.6.1", "xxhash>=3"]
    assert Path(shutil.which(interpreter)).samefile(sys.executable)


def test_what_is_there_but_broken_is_told_from_what_is_missing():
    try:
        raise ImportError("libembree.so: wrong architecture")
    except ImportError:
        text = str(missing("lidars need", "numpy"))
    assert text.startswith("lidars need numpy, which cannot be imported (libembree.so: wrong architecture): `")
    assert text.endswith(" install --force-reinstall 'numpy>=1.26'`.")


def test_the_interpreter_is_named_as_the_shell_finds_it(tmp_path, monkeypatch):
    bin_folder = tmp_path / "my env" / "bin"
    bin_folder.mkdir(parents=True)
    for name in ("python", "python3"):
        (bin_folder / name).symlink_to(sys.executable)
    monkeypatch.setattr(sys, "executable", str(bin_folder / "python3"))
    monkeypatch.setenv("PATH", "/nowhere")
    assert f"`'{bin_folder}/python3' -m pip install " in str(missing("x needs", "ray"))
    monkeypatch.chdir(tmp_path)
    assert "`'my env/bin/python3' -m pip install " in str(missing("x needs", "ray"))
    monkeypatch.setenv("PATH", str(bin_folder))
    assert "`python -m pip install " in str(missing("x needs", "ray"))


def test_the_error_is_bad_input_and_a_failed_import_and_survives_a_process():
    error = missing("x needs", "ray")
    assert isinstance(error, InputError)
    assert isinstance(error, ImportError)
    assert error.exit_code == 2
    assert str(pickle.loads(pickle.dumps(error))) == str(error)


@pytest.mark.parametrize("kind", [ValueError, OSError, InputError, KeyboardInterrupt, ImportError])
def test_other_errors_are_not_explained(kind):
    assert explanation(kind("x")) is None


def test_an_import_of_the_user_that_drake_does_not_have_is_not_explained(tmp_path, monkeypatch):
    (tmp_path / "of_the_user.py").write_text("from pydrake.math import no_such_name\n")
    monkeypatch.syspath_prepend(tmp_path)
    with pytest.raises(ImportError) as caught:
        __import__("of_the_user")
    assert explanation(caught.value) is None


@pytest.mark.parametrize("drake", REFUSAL, indirect=True)
@pytest.mark.parametrize("program", PROGRAMS)
def test_a_program_refuses_a_drake_that_it_cannot_use(drake, program, tmp_path):
    if program == "benchmarks":
        pytest.importorskip("mujoco", reason="mujoco is not installed: pip install '.[benchmarks]'")
    run = python("-m", *PROGRAMS[program], folder=tmp_path)
    assert run.returncode == 2, run.stderr
    assert re.fullmatch(f"error: {REFUSAL[drake]}\n", run.stderr)
    assert run.stdout == ""


@pytest.mark.parametrize("drake", REFUSAL, indirect=True)
@pytest.mark.parametrize(
    "program",
    [
        "from drake_twin import Twin",
        f"import drake_twin; drake_twin.TwinBuilder().robot('a', {PROGRAMS['check'][1]!r}).build()",
    ],
)
def test_python_raises_a_drake_that_it_cannot_use(drake, program, tmp_path):
    run = python("-c", program, folder=tmp_path)
    assert run.returncode == 1
    assert re.fullmatch(rf"drake_twin\.requirements\.RequirementError: {REFUSAL[drake]}", run.stderr.splitlines()[-1])


@pytest.mark.parametrize("drake", ["broken"], indirect=True)
def test_debug_shows_the_traceback(drake, tmp_path):
    run = python("-m", *PROGRAMS["run"], "--debug", folder=tmp_path)
    assert "Traceback" in run.stderr
    assert "ImportError: worn out" in run.stderr


def test_a_package_that_a_program_imports_while_it_starts_is_named(tmp_path):
    """In an environment without any: what is there of the base does not matter to the sentence's form."""
    (tmp_path / "path").mkdir()
    (tmp_path / "path" / "sitecustomize.py").write_text(
        "import sys; sys.modules['yaml'] = sys.modules['lxml'] = None\n"
    )
    path = os.pathsep.join((str(tmp_path / "path"), str(PACKAGE.parent)))
    run = python("-m", "drake_twin.run", folder=tmp_path, PYTHONPATH=path)
    assert run.returncode == 2, run.stderr
    start = r"error: drake_twin needs lxml and pyyaml, which are not installed: `"
    assert re.fullmatch(rf"{start}.* -m pip install 'lxml>=5' 'pyyaml>=6'`\.\n", run.stderr)


def old_python():
    """A Python before 3.11 that starts, on the path or of pyenv."""
    found = [shutil.which(f"python3.{minor}") for minor in (10, 9, 8)]
    found += sorted(map(str, Path(os.environ.get("PYENV_ROOT", "/nowhere")).glob("versions/3.10*/bin/python")))
    starts = (name for name in filter(None, found) if not subprocess.run([name, "-V"], capture_output=True).returncode)
    return next(starts, None)


@pytest.mark.skipif(old_python() is None, reason="there is no Python before 3.11")
@pytest.mark.parametrize("module", ["drake_twin", "drake_twin.run", "drake_twin.check", "drake_twin.tools.topic"])
def test_a_python_that_is_too_old_is_refused(module, tmp_path):
    environment = {"PATH": os.environ["PATH"], "PYTHONPATH": str(PACKAGE.parent)}
    command = [old_python(), "-m", module]
    run = subprocess.run(command, capture_output=True, text=True, cwd=tmp_path, env=environment, check=False)
    assert run.returncode == 2
    assert re.fullmatch(r"error: drake_twin needs Python 3\.11 or newer, and .* is 3\.\d+\.\d+: `.*`\.\n", run.stderr)


def test_the_refusal_of_an_older_python_is_the_projects_and_an_import_error(tmp_path):
    """With the version replaced, where there is no older Python."""
    assert PROJECT["requires-python"] == ">=3.11"
    change = "import sys; sys.version_info = (3, 10, 13, 'final', 0)"
    program = f"{change}\ntry:\n    import drake_twin\nexcept ImportError as error:\n    print(error)"
    run = python("-c", program, folder=tmp_path, PYTHONPATH=str(PACKAGE.parent))
    assert run.stdout.startswith("drake_twin needs Python 3.11 or newer, and ")
    assert shlex.quote(str(PACKAGE.parent)) in run.stdout


def test_a_start_imports_nothing_for_the_checks(tmp_path):
    program = (
        "import json, sys; import drake_twin.program, drake_twin.requirements;"
        " print(json.dumps([name for name in ('shlex', 'importlib.metadata', 'zenoh', 'xxhash', 'rich', 'foxglove')"
        " if name in sys.modules]))"
    )
    run = python("-c", program, folder=tmp_path, PYTHONPATH=str(PACKAGE.parent))
    assert json.loads(run.stdout) == []
