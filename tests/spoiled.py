"""What becomes of a twin whose files have one slip: equal, found, refused, or different in silence.

python tests/spoiled.py SEED COUNT FOLDER "ENTRY …" FILE …
"""

import contextlib
import io
import logging
import re
import signal
import sys
import traceback
from collections import Counter
from pathlib import Path
from random import Random

from fingerprint import difference, fingerprint
from spoiling import Slip, sample, slips

from drake_twin.cli.options import parser
from drake_twin.cli.target import build_twin, find_target
from drake_twin.errors import TwinError
from drake_twin.findings import Kind

LONGEST = 60  # s for one twin
EQUAL, FOUND, REFUSED, SILENT, FAULT = "equal", "found", "refused", "silent", "fault"


class Spoiled:
    """A folder of packages, what is run of it and the twin that it makes as it is.

    Args:
        folder: The packages; files are changed in it and changed back.
        entry: What is run, as on the command line of ``drake_twin.run``, with arguments.
    """

    def __init__(self, folder: Path, entry: list[str]):
        self.folder = folder
        is_scenario = entry[0].endswith((".yaml", ".yml")) and ".launch." not in entry[0]
        known = [] if is_scenario else ["--package-path", str(folder)]  # a scenario names its own
        words = [str(folder / word) if (folder / word).is_file() else word for word in entry]
        self._options = [*words, "--headless", *known]
        self._before, self._said = self._load()

    def _load(self):
        with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
            target = find_target(parser().parse_args(self._options))
            twin = build_twin(target)
            prints = fingerprint(twin)
            said = {finding for finding in twin.findings if finding.kind is not Kind.WINDOW}
            twin.close()
        return prints, said

    def outcome(self, file: Path, slip: Slip) -> tuple[str, str]:
        """What becomes of a slip in one file, and how that is told or seen."""
        original = file.read_bytes()
        file.write_text(slip.text, encoding="utf-8")
        if hasattr(signal, "alarm"):
            signal.alarm(LONGEST)
        try:
            prints, said = self._load()
        except TwinError as error:
            return (REFUSED if _is_paragraph(error, file) else FAULT), str(error)
        except BaseException as error:
            if isinstance(error, KeyboardInterrupt):
                raise
            return FAULT, "".join(traceback.format_exception(error)[-3:])
        finally:
            signal.alarm(0)
            file.write_bytes(original)
        new = [str(finding) for finding in said - self._said]
        changed = list(difference(self._before, prints))
        if new:
            return FOUND, ("" if changed else "(no difference) ") + " | ".join(new)
        return (SILENT, " | ".join(changed)) if changed else (EQUAL, "")


def _is_paragraph(error: TwinError, file: Path) -> bool:
    """One paragraph with a file and a line; of Python code that fails, its traceback, which has both."""
    text = str(error).strip()
    own = "the launch file's code fails" in text and f'{file.name}", line ' in text
    return error.exit_code == 2 and (own or ("\n" not in text and re.search(r":\d+\b", text) is not None))


def report(folder: Path, entry: list[str], files: list[str], seed: str, count: int):
    """The outcome of as many slips of each file."""
    target = Spoiled(folder, entry)
    for name in files:
        random = Random(f"{seed} {name}")
        text = (folder / name).read_text(encoding="utf-8")
        for slip in sample(slips(text, name, random), count, random):
            yield name, slip, *target.outcome(folder / name, slip)


def main(arguments: list[str]) -> None:
    logging.disable(logging.CRITICAL)
    seed, count, folder, words, *files = arguments
    entry = words.split()
    counts: Counter = Counter()
    for name, slip, outcome, how in report(Path(folder), entry, files or entry[:1], seed, int(count)):
        counts[slip.kind, outcome] += 1
        print(f"{outcome}\t{slip.kind}\t{name}:{slip.line}\t{slip.what}\t{how}".replace("\n", "\\n"), flush=True)
    print(counts)


if __name__ == "__main__":
    main(sys.argv[1:])
