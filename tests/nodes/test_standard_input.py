"""Standard input for threads that belong to no node: as Python's own."""

import io

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
