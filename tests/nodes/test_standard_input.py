"""Standard input for nodes, and for threads that belong to none: as Python's own."""

import io
import os
import sys

from node_runs import lines, running, script

from drake_twin.nodes.standard_input import StandardInput

TEXT = "one\ntwo\nthree"


def stream():
    return StandardInput(io.StringIO(TEXT))


def test_it_reads_as_python_does():
    assert stream().read() == stream().read(None) == TEXT
    found = stream()
    assert [found.read(2), found.readline(), found.readline(2), found.read()] == ["on", "e\n", "tw", "o\nthree"]
    assert found.read() == found.readline() == ""
    assert stream().readlines() == list(stream()) == ["one\n", "two\n", "three"]


def test_all_else_is_that_of_the_real_one():
    real = io.StringIO(TEXT)
    found = StandardInput(real)
    assert found.getvalue() == TEXT
    found.close()
    assert real.closed


def test_nodes_read_lines_as_pythons_text_files_do(tmp_path, capsys, monkeypatch):
    """Whatever ends them; byte by byte from a pipe, while the twin advances."""
    data = "one\r\ntwo\rthree\n\r\rfünf\r\n\nlast".encode()
    read, write = os.pipe()
    os.write(write, data)
    os.close(write)
    with open(read, encoding="utf-8") as real:
        monkeypatch.setattr(sys, "stdin", real)
        with running(script(tmp_path, "my.py", "import sys\nfor line in sys.stdin:\n    print(repr(line))\n")) as twin:
            twin.advance_to(1.0)
            assert twin.findings == ()
    assert lines(capsys) == [repr(line) for line in io.TextIOWrapper(io.BytesIO(data), encoding="utf-8")]
