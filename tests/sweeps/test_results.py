"""The table of a sweep: written whole, read again, and continued where it was left."""

import fcntl
import json
import os
from math import isnan, nan

import pytest
from sweep_files import hinge_scenario

from drake_twin.errors import InputError, RunError
from drake_twin.sweep import main
from drake_twin.sweeps.episode import Sweep, failed
from drake_twin.sweeps.report import report, sensitivities
from drake_twin.sweeps.results import Results, check_format, read_table, write_table
from drake_twin.sweeps.variation import Design, Variation


@pytest.fixture
def sweep(tmp_path):
    vary = map(Variation.parse, ("hinge.arm.mass=1:4:4", "hinge.args.size=small,1"))
    return Sweep.of(hinge_scenario(tmp_path), Design(tuple(vary), seeds=(0, 3)), 1.0)


def done(sweep):
    """Made-up rows of all episodes, the last one an error."""
    *most, last = sweep.design.episodes()
    rows = [
        {**failed(sweep, episode, ""), "speed": episode.values["hinge.arm.mass"] ** 2 + episode.seed, "outcome": "done"}
        for episode in most
    ]
    rows[3]["speed"] = nan
    return [*rows, failed(sweep, last, "a reason, with a comma\nand a line")]


def comparable(rows):
    def value(item):
        return "nan" if isinstance(item, float) and isnan(item) else item

    return [{key: value(item) for key, item in row.items() if item is not None} for row in rows]


@pytest.mark.parametrize("suffix", ["parquet", "csv", "jsonl"])
def test_a_table_is_read_as_it_was_written_in_the_order_of_its_episodes(sweep, tmp_path, suffix):
    file = tmp_path / f"t.{suffix}"
    rows = done(sweep)
    for row in rows:
        row["hinge.args.size"] = str(row["hinge.args.size"])  # a column is text or numbers
    write_table(file, sweep.definition, reversed(rows))
    definition, read = read_table(file)
    assert definition == json.loads(json.dumps(sweep.definition))
    assert comparable(read) == comparable(rows)


def test_other_programs_read_it(sweep, tmp_path):
    pyarrow = pytest.importorskip("pyarrow.parquet")
    write_table(tmp_path / "t.parquet", sweep.definition, done(sweep))
    table = pyarrow.read_table(tmp_path / "t.parquet")
    assert table.schema.names == [
        *("episode", "id", "hinge.arm.mass", "hinge.args.size", "seed", "speed"),
        *("outcome", "reason", "simulated", "wall_time", "state_sha256", "version"),
    ]
    assert table.column("speed").null_count == 1  # of the episode that failed


def test_two_sweeps_do_not_write_one_file(sweep, tmp_path):
    first = Results(tmp_path / "t.csv", sweep)
    with pytest.raises(InputError, match="another sweep writes this file"):
        Results(tmp_path / "t.csv", sweep)
    first.close()
    assert Results(tmp_path / "t.csv", sweep).rows == {}


def test_a_process_that_was_killed_leaves_rows_to_continue_from(sweep, tmp_path):
    file, rows = tmp_path / "t.csv", done(sweep)
    journal = tmp_path / "t.csv.journal"
    lines = [json.dumps({"drake_twin_sweep": sweep.definition}), *map(json.dumps, rows[:5])]
    journal.write_text("\n".join(lines)[:-7])
    results = Results(file, sweep)
    assert comparable(results.rows.values()) == comparable(rows[:4])
    for row in (*rows, *rows):
        results.add(row)
    assert [json.loads(line).get("episode") for line in journal.read_text().splitlines()] == [None, *range(16)]
    results.close()
    assert not journal.exists()
    assert len(read_table(file)[1]) == len(rows) == 16
    assert len(Results(file, sweep).rows) == 16


def test_a_table_and_its_journal_are_one(sweep, tmp_path):
    """A kill between the writing of the table and the removal of the journal leaves both."""
    file, rows = tmp_path / "t.csv", done(sweep)
    write_table(file, sweep.definition, rows[:6])
    lines = [json.dumps({"drake_twin_sweep": sweep.definition}), *map(json.dumps, rows[4:9])]
    (tmp_path / "t.csv.journal").write_text("\n".join(lines) + "\n")
    assert sorted(row["episode"] for row in Results(file, sweep).rows.values()) == list(range(9))


def test_a_file_of_another_sweep_is_refused_and_replaced_by_force(sweep, tmp_path):
    file = tmp_path / "t.parquet"
    other = Sweep(sweep.yaml, sweep.design, 2.0, version="drake_twin 0")
    write_table(file, other.definition, [])
    with pytest.raises(InputError, match=r"of another sweep \(version, duration differ\)"):
        Results(file, sweep)
    assert Results(file, sweep, force=True).rows == {}


@pytest.mark.parametrize("suffix", ["parquet", "csv", "jsonl"])
def test_a_damaged_table_is_refused(sweep, tmp_path, suffix):
    file = tmp_path / f"t.{suffix}"
    write_table(file, sweep.definition, done(sweep))
    data = file.read_bytes()
    file.write_bytes(data[:20] + data[40 : len(data) // 2])
    with pytest.raises(InputError, match="not the table of a sweep, or it is damaged"):
        Results(file, sweep)


def test_a_damaged_journal_is_refused(sweep, tmp_path):
    lines = [json.dumps({"drake_twin_sweep": sweep.definition}), "{nonsense", json.dumps(done(sweep)[0])]
    (tmp_path / "t.csv.journal").write_text("\n".join(lines) + "\n")
    with pytest.raises(InputError, match="the journal is damaged"):
        Results(tmp_path / "t.csv", sweep)


@pytest.mark.parametrize(("definition", "row"), [("3", ""), ("{}", ""), (None, "3"), (None, '{"episode": 0}')])
def test_a_table_whose_lines_are_something_else_is_damaged(sweep, tmp_path, definition, row):
    text = json.dumps(sweep.definition) if definition is None else definition
    (tmp_path / "t.jsonl").write_text(f'{{"drake_twin_sweep": {text}}}\n{row}')
    with pytest.raises(InputError, match="this is not the table of a sweep, or it is damaged"):
        read_table(tmp_path / "t.jsonl")


def test_a_table_without_a_varied_column_is_damaged(sweep, tmp_path):
    write_table(tmp_path / "t.csv", sweep.definition, done(sweep))
    first, names, *rows = (tmp_path / "t.csv").read_text().splitlines()
    path = sweep.design.paths[0]
    (tmp_path / "t.csv").write_text("\n".join([first, names.replace(path, "other"), *rows]) + "\n")
    with pytest.raises(InputError, match=f"a row lacks {path}"):
        read_table(tmp_path / "t.csv")


def test_a_journal_that_another_sweep_has_removed_meanwhile_is_opened_again(sweep, tmp_path, monkeypatch):
    file, flock, removed = tmp_path / "t.csv.journal", fcntl.flock, []

    def ends_meanwhile(journal, how):
        if not removed:
            file.unlink()
            removed.append(file)
        return flock(journal, how)

    monkeypatch.setattr(fcntl, "flock", ends_meanwhile)
    results = Results(tmp_path / "t.csv", sweep)
    for row in done(sweep):
        results.add(row)
    results.close()
    assert len(read_table(tmp_path / "t.csv")[1]) == len(done(sweep))


def test_a_journal_that_cannot_be_cut_off_is_named(sweep, tmp_path, monkeypatch):
    def full(file, size):
        raise OSError(28, "No space left on device")

    file = tmp_path / "table.csv"
    (tmp_path / "table.csv.journal").write_text("half a line")
    monkeypatch.setattr(os, "truncate", full)
    for force in (False, True):
        with pytest.raises(RunError, match=r"table\.csv\.journal cannot be written \(No space left on device\)"):
            Results(file, sweep, force=force)
        (tmp_path / "table.csv.journal").write_text("half a line")


def test_a_folder_that_is_removed_meanwhile_loses_the_rows_and_says_so(sweep, tmp_path):
    folder = tmp_path / "out"
    folder.mkdir()
    results = Results(folder / "t.csv", sweep)
    results.add(done(sweep)[0])
    (folder / "t.csv.journal").unlink()
    folder.rmdir()
    with pytest.raises(RunError, match="its journal is gone, too: the rows are lost"):
        results.close()


def test_unknown_formats_and_folders_are_refused(tmp_path):
    with pytest.raises(InputError, match=r"unknown format. Did you mean '.parquet'"):
        check_format(tmp_path / "t.parqet")
    with pytest.raises(InputError, match="no file can be written there"):
        check_format(tmp_path / "nowhere" / "t.csv")


def test_without_pyarrow_parquet_is_refused_and_csv_is_not(tmp_path, monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "pyarrow", None)
    with pytest.raises(InputError, match=r"needs pyarrow.*pip install 'pyarrow>=17'`, or name a file \.csv or"):
        check_format(tmp_path / "t.parquet")
    check_format(tmp_path / "t.csv")


def test_sensitivities_are_rank_correlations(sweep):
    """Of y = x² + seed and values that are spread alike, by hand: the ranks of x and y agree up to ties."""
    rows = [{"x": x, "y": x**2, "z": -x, "w": 1.0, "episode": 0, "seed": 0} for x in (1.0, 2.0, 5.0, 9.0)]
    found = sensitivities({"vary": [["x", [1, 2]]]}, rows)
    assert found == {("x", "y"): pytest.approx(1.0), ("x", "z"): pytest.approx(-1.0)}
    shuffled = [{"x": x, "y": y} for x, y in ((1, 2), (2, 1), (3, 4), (4, 3), (5, 5))]
    assert sensitivities({"vary": [["x", []]]}, shuffled)["x", "y"] == pytest.approx(1 - 6 * 4 / (5 * 24))


def test_a_report_says_what_came_out_and_which_rows_are_best(sweep):
    text = report(json.loads(json.dumps(sweep.definition)), done(sweep))
    assert "16 rows: 15 done, 1 error" in text
    assert "largest 16           row 12: hinge.arm.mass=4, hinge.args.size=small, seed 0" in text
    assert "speed: least 1, median" in text
    assert "error in 1 rows: a reason" in text


def test_a_figure_that_cannot_be_written_does_not_prevent_the_next(tmp_path, capsys):
    vary = map(Variation.parse, ("hinge.arm.mass=1:4:4", "ground_friction=0.5,0.6"))
    sweep = Sweep.of(hinge_scenario(tmp_path), Design(tuple(vary)), 1.0)
    table = tmp_path / "table.csv"
    write_table(table, sweep.definition, done(sweep))
    (tmp_path / "a.svg").mkdir()
    assert main(["--show", str(table), "--plot", str(tmp_path / "a.svg"), "--pairs", str(tmp_path / "b.svg")]) == 1
    assert f"{tmp_path / 'a.svg'} cannot be written" in capsys.readouterr().err
    assert (tmp_path / "b.svg").is_file()
