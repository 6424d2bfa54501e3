"""Expressions of setup.py files against what Python itself makes of them, and what is left out as unknown."""

import ast
import os
from glob import glob

import pytest

from drake_twin.description.setup_expressions import SetupReader, glob_in

FILES = ("launch/a.launch.py", "launch/b.launch.xml", "config/c.yaml", "config/deep/d.yaml", "config/.hidden")


@pytest.fixture
def package(tmp_path, monkeypatch):
    for name in FILES:
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).touch()
    monkeypatch.chdir(tmp_path)  # in which setup.py runs
    return tmp_path


def read(package, text):
    reader = SetupReader(package)
    reader.run(ast.parse(text).body)
    return reader


@pytest.mark.parametrize(
    ("before", "entries"),
    [
        ("", "[('share/p', sorted(os.listdir('launch')))]"),
        ("", "[(key, value) for key, value in {'a': ['b'], 'c': ['d']}.items()]"),
        ("files = {'share/a': ['x'], 'share/b': ['y']}", "[(place, files[place]) for place in files]"),
        ("pair = ('share/a', ['x'])\nplace, files = pair", "[(place, files)]"),
        ("found = {}\nfound.setdefault('share/a', []).append('x')", "[*found.items()]"),
        ("def of(place, files=['x'], end=''):\n    return (place + end, files)", "[of('a'), of('b', ['y'], end='c')]"),
        ("def of(place):\n    return [(place, ['x'])]", "of(place='share/a') + of('share/b')"),
        ("name = 'p'", "[('share/{0}/{1}'.format(name, 'a'), ['x'.replace('x', 'y')])]"),
        ("name = 'p'", "[('share/{}/{n}'.format(name, n='a'), [f'{name}.yaml'])]"),
        ("", "[('share/%s/%s' % ('p', 'a'), ['x'] if True else [])]"),
        ("entries = []\nfor name in ('a', 'b'):\n    entries.append(('share/' + name, ['x']))", "entries"),
        ("entries = []\nentries.extend([('share/a', ['x'])])\nentries += [('share/b', ['y'])]", "entries"),
        ("", "[(place, [name]) for place in ('a', 'b') for name in ('x', 'y')]"),
        ("", "[('share/p/' + path, files) for path, _, files in sorted(os.walk('launch'))]"),
        ("", "[('share/p', sorted(glob('launch/*.py') + glob('config/**/*.yaml', recursive=True)))]"),
        ("from pathlib import Path", "[(str('share' / Path('p')), ['x'])]"),
    ],
)
def test_what_is_understood_is_what_python_makes_of_it(package, before, entries):
    values = {"os": os, "glob": lambda *args, **options: sorted(glob(*args, **options))}
    exec(before, values)
    expected = [(place, sorted(files)) for place, files in eval(entries, values)]
    found = read(package, f"{before}\nsetup(data_files={entries})").data_files
    assert [(place, sorted(files)) for place, files in found] == expected


@pytest.mark.parametrize(
    "entries",
    [
        "unknown()",
        "[(unknown(), ['x'])]",
        "[(place, ['x']) for place in unknown]",
        "[('a', os.listdir('..'))]",
        "[('a', ['x'])][5]",
        "{'a': 1}['b']",
        "1 + 2",
        "__import__('os').getcwd()",
    ],
)
def test_what_is_not_understood_is_left_out(package, entries):
    assert read(package, f"setup(data_files={entries})").data_files == []


def test_entry_points_are_read_beside_files_that_are_unknown(package):
    text = "setup(data_files=unknown(), entry_points={'console_scripts': ['run = p.a:main']})"
    assert read(package, text).entry_points == {"console_scripts": ["run = p.a:main"]}


def test_a_function_that_calls_itself_comes_to_an_end(package):
    assert read(package, "def f(x):\n    return f(x)\nsetup(data_files=f([]))").data_files == []


def test_files_outside_of_the_package_and_hidden_ones_match_nothing(package):
    assert glob_in(package, "config/*", recursive=False) == ["config/c.yaml", "config/deep"]
    assert glob_in(package, f"{package}/launch/*.xml", recursive=False) == ["launch/b.launch.xml"]
    for pattern in ("../*", "/etc/*", ".", f"{package}/../*"):
        assert glob_in(package, pattern, recursive=True) == []
