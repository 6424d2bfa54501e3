"""The table of a sweep: a journal while it runs, then Parquet, CSV or JSON lines.

The journal is a file beside the table with one line of JSON for each finished episode. A line that was cut off by a
kill or a full disk is dropped when the sweep continues, so that each episode stands there once. The table is written
whole at the end, in the order of the episodes, and the journal is removed then.
"""

import contextlib
import csv
import fcntl
import io
import json
import os
import time
from collections.abc import Iterable, Mapping
from errno import ENOSPC
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from drake_twin.description.source_file import MOST_BYTES, check_regular, file_bytes
from drake_twin.errors import InputError, RunError
from drake_twin.requirements import RequirementError, missing
from drake_twin.sweeps.episode import COLUMNS, Row, Sweep
from drake_twin.versions import SWEEP
from drake_twin.whole_file import write_whole

_KEY = "drake_twin_sweep"
_SYNC = 0.5  # s between two calls of fsync
_FORMATS = (".parquet", ".csv", ".jsonl")
_LAST = ("outcome", "reason", "simulated", "wall_time", "state_sha256", "version")
_TEXTS = ("id", "outcome", "reason", "state_sha256", "version")
_WHOLE = ("episode", "seed")


def check_format(file: Path) -> None:
    """Check that a table can be written to a file of this name.

    Raises:
        InputError: If its suffix is unknown, its folder does not exist, or pyarrow is missing.
    """
    if file.suffix not in _FORMATS:
        raise InputError(f"--out {file}: unknown format", value=file.suffix, valid=_FORMATS)
    try:
        is_possible = file.absolute().parent.is_dir() and not file.is_dir()
        file.with_name(f"{file.name}.journal").exists()
    except OSError as error:
        raise InputError(f"--out {file}: no file can be written there ({error.strerror})") from None
    if not is_possible:
        raise InputError(f"--out {file}: no file can be written there")
    if file.suffix == ".parquet" and find_spec("pyarrow") is None:  # which is imported when there are rows
        raise _without_pyarrow()


class Results:
    """The rows of a sweep, in its journal and its table.

    Args:
        file: The table.
        sweep: The sweep.
        force: Whether to drop the rows that are there.

    Attributes:
        rows: Episode's id → its row.

    Raises:
        InputError: If the file holds another sweep or is damaged, or another process writes it.
    """

    def __init__(self, file: Path, sweep: Sweep, *, force: bool = False):
        self._file, self._sweep = file, sweep
        self._journal_file = file.with_name(f"{file.name}.journal")
        self.rows: dict[str, Row] = {}
        self._journal = self._locked()
        if force:
            os.truncate(self._journal, 0)
        elif file.exists() and file.stat().st_size:
            try:
                definition, rows = read_table(file)
                self._check(definition, file)
            except InputError:
                self._drop_new_journal()
                raise
            self.rows = {row["id"]: row for row in rows}
        self._continue()
        self._synced = time.monotonic()

    def add(self, row: Row) -> None:
        """Add the row of an episode; a row that is there already stays.

        Raises:
            RunError: If it cannot be written, for example on a full disk; the rows before it are safe.
        """
        if row["id"] in self.rows:
            return
        self._write(row)
        self.rows[row["id"]] = row
        if time.monotonic() - self._synced > _SYNC:
            self._sync()

    def close(self) -> None:
        """Write the table and remove the journal.

        Raises:
            RunError: If the table cannot be written; the journal stays then.
        """
        self._sync()
        try:
            write_table(self._file, self._sweep.definition, self.rows.values())
        except OSError as error:
            kept = "the rows are in its journal" if self._is_there() else "its journal is gone, too: the rows are lost"
            raise RunError(f"{self._file} cannot be written ({error.strerror}): {kept}") from None
        self._journal_file.unlink(missing_ok=True)
        os.close(self._journal)

    def discard_empty(self) -> None:
        """Remove the journal if no episode is in it."""
        if not self.rows:
            self._journal_file.unlink()

    def _locked(self) -> int:
        """Open the journal, which nobody else may have open."""
        try:
            while True:
                journal = os.open(self._journal_file, os.O_RDWR | os.O_CREAT | os.O_APPEND, 0o666)
                fcntl.flock(journal, fcntl.LOCK_EX | fcntl.LOCK_NB)
                if self._is_there(journal):
                    return journal
                os.close(journal)  # another sweep has ended meanwhile, and removed it
        except BlockingIOError:
            raise InputError("another sweep writes this file", file=self._file) from None
        except OSError as error:
            raise InputError(f"the journal cannot be written ({error.strerror})", file=self._journal_file) from None

    def _is_there(self, journal: int | None = None) -> bool:
        """Tell whether the open journal is the file of its name."""
        try:
            return os.path.samestat(os.fstat(self._journal if journal is None else journal), self._journal_file.stat())
        except OSError:
            return False

    def _drop_new_journal(self) -> None:
        """Remove the journal if nothing is in it yet."""
        if not os.fstat(self._journal).st_size:
            self._journal_file.unlink()
        os.close(self._journal)

    def _continue(self) -> None:
        """Read the journal, and cut off a line that was not finished."""
        good = 0
        for number, line in enumerate(file_bytes(self._journal_file).splitlines(keepends=True)):
            if not line.endswith(b"\n"):
                break
            try:
                entry = json.loads(line)
                definition, name = (entry[_KEY], "") if number == 0 else ({}, entry["id"])
            except (ValueError, LookupError, TypeError):
                raise InputError("the journal is damaged: --force begins again", file=self._journal_file) from None
            if number == 0:
                self._check(definition, self._journal_file)
            else:
                self.rows[name] = entry
            good += len(line)
        os.truncate(self._journal, good)
        if not good:
            self._write({_KEY: self._sweep.definition})

    def _check(self, definition: Mapping[str, Any], file: Path) -> None:
        own, definition = json.loads(json.dumps(self._sweep.definition)), {"format": 1, **definition}
        SWEEP.check(definition["format"], file)
        if definition == own:
            return
        other = [key for key in own if definition.get(key) != own[key]]
        what = f"the file is of another sweep ({', '.join(other)} differ): name another file, or use --force"
        raise InputError(what, file=file)

    def _write(self, entry: Mapping[str, Any]) -> None:
        line = json.dumps(entry).encode() + b"\n"
        end = os.fstat(self._journal).st_size
        try:
            if os.write(self._journal, line) < len(line):
                raise OSError(ENOSPC, os.strerror(ENOSPC))
        except OSError as error:
            with contextlib.suppress(OSError):  # without it, a line is half: it is dropped when the sweep continues
                os.truncate(self._journal, end)
            what = f"{self._journal_file} cannot be written ({error.strerror}): its {len(self.rows)} rows are safe"
            raise RunError(what) from None

    def _sync(self) -> None:
        try:
            os.fsync(self._journal)
        except OSError as error:
            raise RunError(f"{self._journal_file} cannot be written ({error.strerror}): rows may be lost") from None
        self._synced = time.monotonic()


def write_table(file: Path, definition: Mapping[str, Any], rows: Iterable[Row]) -> None:
    """Write a table whole, its rows in the order of the episodes.

    Raises:
        OSError: If it cannot be written.
    """
    ordered = sorted(rows, key=lambda row: int(row["episode"]))
    names = _columns(ordered)
    said = json.dumps({_KEY: definition})
    if file.suffix == ".jsonl":
        lines = [said, *(json.dumps({name: row.get(name) for name in names}) for row in ordered)]
        write_whole(file, "".join(f"{line}\n" for line in lines))
    elif file.suffix == ".csv":
        text = io.StringIO()
        text.write(f"# {said}\n")
        writer = csv.DictWriter(text, names, lineterminator="\n")
        writer.writeheader()
        writer.writerows(ordered)
        write_whole(file, text.getvalue())
    else:
        pa = _pyarrow()
        arrays = [pa.array(*_column(pa, name, [row.get(name) for row in ordered])) for name in names]
        table = pa.table(arrays, names=names).replace_schema_metadata({_KEY: json.dumps(definition)})
        buffer = pa.BufferOutputStream()
        pa.parquet.write_table(table, buffer, row_group_size=10_000)
        write_whole(file, buffer.getvalue().to_pybytes())


def read_table(file: Path) -> tuple[dict[str, Any], list[Row]]:
    """Read a table: the sweep's definition and its rows.

    Raises:
        InputError: If the file cannot be read, or is not a sweep's.
    """
    try:
        definition, rows = _read(file)
        SWEEP.check(definition.get("format", 1), file)
        for row in rows:
            if missing := [name for name in (*COLUMNS, *(path for path, _ in definition["vary"])) if name not in row]:
                raise ValueError(f"a row lacks {', '.join(missing)}")
        if not isinstance(definition["scenario"], str):
            raise ValueError("its scenario is missing")
        return definition, rows
    except InputError:
        raise
    except FileNotFoundError:
        raise InputError("the file does not exist", file=file) from None
    except Exception as error:
        reason = " ".join(str(error).split())
        raise InputError(f"this is not the table of a sweep, or it is damaged ({reason[:200]})", file=file) from None


def _read(file: Path) -> tuple[dict[str, Any], list[Row]]:
    if file.suffix == ".parquet":
        pa = _pyarrow()
        check_regular(file)
        stored = pa.parquet.ParquetFile(file, memory_map=False)
        size = sum(stored.metadata.row_group(index).total_byte_size for index in range(stored.num_row_groups))
        if size > MOST_BYTES:
            raise InputError(
                f"the table unpacks to {size / 1e6:.0f} MB; at most {MOST_BYTES >> 20} MB are read", file=file
            )
        table = stored.read()
        return json.loads(table.schema.metadata[_KEY.encode()]), table.to_pylist()
    first, _, rest = file_bytes(file).decode().partition("\n")
    definition = json.loads(first.removeprefix("# "))[_KEY]
    if file.suffix == ".csv":
        return definition, [_of_text(row, definition) for row in csv.DictReader(io.StringIO(rest, newline=""))]
    return definition, [json.loads(line) for line in rest.splitlines()]


def _columns(rows: Iterable[Row]) -> list[str]:
    """Return the names of the columns: what varies, then what was measured, then what became of it."""
    found = dict.fromkeys(name for row in rows for name in row)
    return [*(name for name in found if name not in _LAST), *_LAST]


def _column(pa: Any, name: str, values: list[Any]) -> tuple[list[Any], Any]:
    if name in _WHOLE:
        return values, pa.int64()
    if name in _TEXTS or any(isinstance(value, str) for value in values):
        return [value if value is None else str(value) for value in values], pa.string()
    return values, pa.float64()


def _of_text(row: Mapping[str, str], definition: Mapping[str, Any]) -> Row:
    texts = {path for path, values in definition["vary"] if any(isinstance(item, str) for item in values)}
    found: Row = {}
    for name, text in row.items():
        if name in _TEXTS or name in texts:
            found[name] = text
        elif text != "":
            found[name] = int(text) if name in _WHOLE else float(text)
    return found


def _pyarrow() -> Any:
    try:
        import pyarrow
        import pyarrow.parquet
    except ImportError:
        raise _without_pyarrow() from None
    return pyarrow


def _without_pyarrow() -> RequirementError:
    return missing("Parquet needs", "pyarrow", otherwise=", or name a file .csv or .jsonl")
