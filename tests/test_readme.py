import re
from pathlib import Path

README = (Path(__file__).resolve().parent.parent / "README.md").read_text()


def test_the_python_of_the_readme_runs_and_its_assertions_hold(capsys):
    program = "\n".join(re.findall(r"```python\n(.*?)```", README, re.DOTALL))
    exec(compile(program, "README.md", "exec"), {})
    printed = capsys.readouterr().out
    assert printed.count("[") == 60  # ten joint states a second for five seconds
    assert re.search(r"^[0-9a-f]{64}$", printed, re.MULTILINE)


def test_every_file_and_folder_that_the_readme_names_is_there():
    root = Path(__file__).resolve().parent.parent
    names = re.findall(r"\]\(((?:drake_twin|diagrams)/[^)]+)\)|`((?:drake_twin|models|diagrams)/[\w/.]*)`", README)
    assert len(names) > 8
    for link, quoted in names:
        assert (root / (link or quoted)).exists(), link or quoted


def test_the_ci_calls_the_readmes_commands():
    ci = (Path(__file__).resolve().parent.parent / ".ci" / "run").read_text()
    first, second = re.findall(r"```sh\n(.*?)\n```", README, re.DOTALL)[:2]
    assert first.replace("install .", "install -q .") in ci
    assert second.replace("install '", "install -q '") in ci
