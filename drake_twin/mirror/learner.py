"""Finds values of the twin from what the robot did last, in a process of its own, and offers them as a scenario.

The last seconds of the robot are written as a bag, and ``python -m drake_twin.calibrate`` searches the values with
which the twin moves as the bag says. What it finds is offered as a file with the values and their errors; nothing of it
is taken over by itself.
"""

import io
import json
import shutil
import subprocess
from collections import deque
from collections.abc import Collection, Sequence
from pathlib import Path

from drake_twin.messages.interface_types import definition, serialize, type_hash
from drake_twin.mirror.heard import Heard
from drake_twin.python_process import python_command
from drake_twin.scenario import Scenario
from drake_twin.scenario.scenario_file import scenario_to_yaml
from drake_twin.scratch_folder import scratch_folder
from drake_twin.whole_file import write_result
from drake_twin.wires.bag_writer import HEAD, MESSAGE, TOPIC, write_bag

WINDOW = 20.0  # s of the robot that are learned from
_QUALITY = {"latched": False, "depth": 10, "is_best_effort": False, "is_manual": False}
_SPANS = {"lifespan": None, "deadline": None, "lease": None}


class Learner:
    """Learns from the last seconds of a robot.

    Args:
        scenario: The twin.
        fitted: What to find: ``PATH=LOW:HIGH``, as for `drake_twin.calibrate`.
        patch: The file that is offered: a scenario (.yaml).
        renamed: ``ROBOT=TWIN``: topics of other names.
        window: How many seconds are learned from.
    """

    def __init__(
        self,
        scenario: Scenario,
        fitted: Sequence[str],
        patch: Path,
        renamed: Sequence[str] = (),
        window: float = WINDOW,
    ):
        self._scenario, self._fitted, self._patch, self._renamed = scenario, fitted, patch, renamed
        self._window = window
        self._kept: deque[Heard] = deque()
        self._process: subprocess.Popen[str] | None = None
        self._begun = float("-inf")

    def hear(self, heard: Heard) -> None:
        """Keep a message for a while."""
        self._kept.append(heard)
        while heard.received - self._kept[0].received > self._window:
            self._kept.popleft()

    @property
    def is_due(self) -> bool:
        """Whether a whole window is there that was not learned from, and nothing is being learned."""
        kept = self._kept
        return (
            self._process is None
            and len(kept) > 1
            and kept[-1].received - kept[0].received > 0.9 * self._window
            and kept[0].received >= self._begun
        )

    def begin(self, topics: Collection[str]) -> None:
        """Begin to learn from what is kept, in another process.

        Args:
            topics: The topics that count.

        Raises:
            RunError: If the bag cannot be written.
        """
        folder = scratch_folder() / "mirror"
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir()
        write_bag(str(folder / "window"), io.BytesIO(_records([item for item in self._kept if item.topic in topics])))
        write_result("scenario", folder / "twin.yaml", scenario_to_yaml(self._scenario))
        words = [*python_command("drake_twin.calibrate"), "twin.yaml", "--log", "window", "--out", "patch.yaml"]
        words += [word for item in self._fitted for word in ("--fit", item)]
        words += [word for item in self._renamed for word in ("--map", item)]
        self._begun = self._kept[-1].received
        self._process = subprocess.Popen(
            words, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, stdin=subprocess.DEVNULL
        )

    def outcome(self, *, wait: bool = False) -> str | None:
        """Return what was learned, once; None while there is nothing new.

        Args:
            wait: Whether to wait for it.

        Raises:
            RunError: If the patch cannot be written.
        """
        process = self._process
        if process is None or (process.poll() is None and not wait):
            return None
        said = process.communicate()[0].strip()
        self._process = None
        found = scratch_folder() / "mirror" / "patch.yaml"
        if process.returncode == 0 and found.is_file():
            write_result("patch", self._patch, found.read_text(encoding="utf-8"))
            known = [line[2:] for line in found.read_text(encoding="utf-8").splitlines() if line.startswith("# ")]
            return f"offered: {self._patch}: {'; '.join(known[1:])} (it is used where it is named as the target)"
        last = said.splitlines()[-1] if said else "it was stopped"
        problem = next((line for line in said.splitlines() if line.startswith("problem")), last)
        return f"nothing is offered: {problem}"

    def close(self) -> None:
        """End the process."""
        if self._process is not None:
            self._process.kill()
            self._process.communicate()
            self._process = None


def _records(messages: Sequence[Heard]) -> bytes:
    """Return messages as the bag's writer reads them."""
    records: list[bytes] = []
    numbers: dict[str, int] = {}
    for item in messages:
        if item.topic not in numbers:
            numbers[item.topic] = len(numbers)
            described = {"name": item.topic, "type": item.type, "hash": type_hash(item.type)}
            described["definition"] = definition(item.type)
            content = json.dumps({**described, "quality": _QUALITY | _SPANS}).encode()
            records.append(HEAD.pack(TOPIC, numbers[item.topic], 0, len(content)) + content)
        data = bytes(serialize(item.message))
        time = max(round(item.received * 1e9), 0)
        records.append(HEAD.pack(MESSAGE, numbers[item.topic], time, len(data)) + data)
    return b"".join(records)
