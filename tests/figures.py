"""The figures behind the physics tests: what each measured, as a table at the end of a run."""

from collections import defaultdict

import pytest

_ENGINES = ("1ms", "10ms", "cenic")


@pytest.fixture
def figure(request, record_property):
    """Keeps a measured value for the table: ``figure(what, value)``."""
    engine = request.node.callspec.params.get("engine", "") if hasattr(request.node, "callspec") else ""

    def keep(what: str, value: float) -> float:
        record_property("figure", (what, engine, float(value)))
        return value

    return keep


def pytest_terminal_summary(terminalreporter):
    found = defaultdict(lambda: defaultdict(list))
    for reports in terminalreporter.stats.values():
        for report in reports:
            for name, value in getattr(report, "user_properties", ()):
                if name == "figure":
                    what, engine, number = value
                    found[what][engine].append(number)
    if not found:
        return
    terminalreporter.write_sep("=", "what the physics tests measured, least … largest")
    terminalreporter.write_line(f"| | {' | '.join(_ENGINES)} |")
    terminalreporter.write_line("|---|" + "---|" * len(_ENGINES))
    for what, by_engine in sorted(found.items()):
        terminalreporter.write_line(f"| {what} | {' | '.join(_range(by_engine[engine]) for engine in _ENGINES)} |")


def _range(values: list[float]) -> str:
    low, high = (f"{value:.4g}" for value in (min(values), max(values))) if values else ("–", "–")
    return low if low == high else f"{low} … {high}"
