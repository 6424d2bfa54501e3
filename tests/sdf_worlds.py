"""SDF worlds and models written for a test."""

import pytest

from drake_twin.description.package_index import PackageIndex
from drake_twin.description.world_file import read_world
from drake_twin.errors import InputError

BOX = '<link name="link"><collision name="c"><geometry><box><size>1 1 1</size></box></geometry></collision></link>'


def write(folder, name, body, version="1.9"):
    file = folder / name
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(f'<?xml version="1.0"?>\n<sdf version="{version}">\n{body}\n</sdf>\n')
    return file


def world_of(tmp_path, body, *, version="1.9", **environment):
    file = write(tmp_path, "test.world", f'<world name="w">\n{body}\n</world>', version)
    return read_world(str(file), PackageIndex((), {name: str(value) for name, value in environment.items()}))


def model_file(folder, name, body=BOX, version="1.9"):
    write(folder / name, "model.sdf", f'<model name="{name}">{body}</model>', version)
    (folder / name / "model.config").write_text(f'<model><sdf version="{version}">model.sdf</sdf></model>')
    return folder


def refusal(call, *arguments, **named):
    with pytest.raises(InputError) as raised:
        call(*arguments, **named)
    return str(raised.value)


def findings(world):
    """What is said of a world, without the places."""
    return tuple(finding.what for finding in world.findings)
