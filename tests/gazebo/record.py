"""Record what libsdformat makes of the made-up files: ``cd tests; python -m gazebo.record``."""

import hashlib
import json
import sys
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory

from gazebo.gazebo_values import compile_reader, gazebo_models
from gazebo.made_files import MAKERS

RECORDED = Path(__file__).with_name("recorded.json")
SEEDS = {"urdf": range(30), "sdf": range(20), "world": range(12), "merged": range(8)}

# What `read_values.cc` prints beyond this is for people.
KEPT = ("name", "pose", "static", "links", "joints", "models", "collisions", "sensors", "mu", "mu2", "self_collide")
KEPT += ("type", "parent", "child", "axis", "limits", "damping", "friction", "topic", "rate")


def made(kind: str, seed: int, folder: Path) -> Path:
    """Write the files of a seed; return the one to read."""
    for name, text in MAKERS[kind](seed).items():
        file = folder / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text)
    return next(folder.glob("made.*"))


def digest(kind: str, seed: int) -> str:
    """Return by what a seed's files are recognised."""
    return hashlib.sha256(json.dumps(MAKERS[kind](seed)).encode()).hexdigest()[:16]


def compact(value: object) -> object:
    """Return values as they are recorded: with six decimals, without what is not compared."""
    if isinstance(value, dict):
        return {key: compact(item) for key, item in value.items() if key in KEPT and item != []}
    if isinstance(value, list):
        return [compact(item) for item in value]
    if isinstance(value, float) and abs(value) < 1e6:
        return round(value, 6) + 0.0
    return value


def main() -> int:
    """Write the file."""
    cases = {}
    with TemporaryDirectory() as scratch:
        reader = compile_reader(scratch)
        if reader is None:
            print("libsdformat 12, pkg-config and g++ are needed", file=sys.stderr)
            return 2
        read = partial(gazebo_models, reader)
        for kind, seeds in SEEDS.items():
            for seed in seeds:
                folder = Path(scratch) / f"{kind}_{seed}"
                models, said = read(made(kind, seed, folder), folders=[folder])
                assert models, said
                cases[f"{kind} {seed}"] = {"digest": digest(kind, seed), "models": compact(models)}
    lines = ",\n".join(f"{json.dumps(name)}: {json.dumps(case, separators=(',', ':'))}" for name, case in cases.items())
    RECORDED.write_text(f"{{\n{lines}\n}}\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
