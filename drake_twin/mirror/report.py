"""The report of a mirror: one HTML file without scripts, readable on a phone; the same run gives the same bytes."""

from html import escape
from math import asinh
from pathlib import Path

from drake_twin.mirror.mirror import Mirror
from drake_twin.mirror.robot_watch import Alarm
from drake_twin.mirror.traces import Trace, Traces
from drake_twin.versions import stamp
from drake_twin.whole_file import write_result

_WIDTH, _HEIGHT = 640, 90  # of a plot
_BAND = 3.0  # standard deviations that are drawn as the healthy robot's
_MOST_PLOTS = 60

_STYLE = """
body { font: 16px/1.45 system-ui, sans-serif; margin: 0 auto; max-width: 46rem; padding: 1rem; color: #1d2327; }
h1 { font-size: 1.4rem; } h2 { font-size: 1.1rem; margin-top: 2rem; }
.verdict { padding: .6rem .9rem; border-radius: .5rem; font-weight: 600; }
.healthy { background: #dff3e4; } .faulty { background: #fbdedb; }
table { border-collapse: collapse; width: 100%; }
td, th { text-align: left; padding: .3rem .5rem; vertical-align: top; }
tr + tr { border-top: 1px solid #d9dee3; } .scroll { overflow-x: auto; }
figure { margin: 1rem 0; } figcaption { font-size: .85rem; overflow-wrap: anywhere; }
svg { width: 100%; height: auto; }
.band { fill: #dff3e4; } .line { fill: none; stroke: #2563a8; stroke-width: 1.2; }
.alarm { fill: #e5484d; opacity: .25; }
.axis { font-size: 10px; fill: #555; }
@media (prefers-color-scheme: dark) { body { background: #15181b; color: #e5e8ea; }
.healthy, .band { background: #1d3b27; fill: #1d3b27; } .faulty { background: #4a2020; } .line { stroke: #7db4ea; }
tr + tr { border-color: #353b41; } .axis { fill: #aaa; } }
"""


def write_report(file: Path, mirror: Mirror, traces: Traces, title: str) -> None:
    """Write the report, whole.

    Raises:
        RunError: If it cannot be written.
    """
    write_result("report", file, report_text(mirror, traces, title))


def report_text(mirror: Mirror, traces: Traces, title: str) -> str:
    """Return the report's HTML."""
    alarms = mirror.alarms
    zero = mirror.zero or 0.0
    verdict = (
        f'<p class="verdict faulty">{len(alarms)} alarm{"s" if len(alarms) > 1 else ""}</p>'
        if alarms
        else '<p class="verdict healthy">The robot moved as its twin did: no alarm.</p>'
    )
    parts = [
        "<!doctype html>",
        '<html lang="en"><head><meta charset="utf-8">',
        '<meta name="viewport" content="width=device-width, initial-scale=1">',
        f'<meta name="generator" content="{escape(stamp())}">',
        f"<title>{escape(title)}</title><style>{_STYLE}</style></head><body>",
        f"<h1>{escape(title)}</h1>",
        verdict,
        _alarms(alarms),
        "<h2>Differences between the robot and its twin</h2>",
        "<p>In standard deviations of the healthy run, three of which the band has. Red: an alarm lasted.</p>",
        *_plots(traces, alarms, zero),
        "<h2>What was heard</h2>",
        _heard(mirror),
        _list("Notes", [*mirror.notes]),
        "</body></html>",
    ]
    return "\n".join(part for part in parts if part) + "\n"


def alarm_line(alarm: Alarm) -> str:
    """Return an alarm in one line."""
    until = "it lasts" if alarm.ended is None else f"until {alarm.ended:.2f} s"
    return f"{alarm.began:.2f} s ({until}): {alarm.robot}: {alarm.text} [{alarm.kind}]"


def _alarms(alarms: list[Alarm]) -> str:
    if not alarms:
        return ""
    rows = "".join(
        f"<tr><td>{alarm.began:.2f} s</td><td>{'' if alarm.ended is None else f'{alarm.ended:.2f} s'}</td>"
        f"<td>{escape(alarm.robot)}</td><td>{escape(alarm.text)}<br><small>{escape(alarm.kind)}, noticed after"
        f" {max(alarm.raised - alarm.began, 0.0):.2f} s</small></td></tr>"
        for alarm in alarms
    )
    head = "<tr><th>Began</th><th>Ended</th><th>Robot</th><th>It looks like</th></tr>"
    return f'<h2>Alarms</h2><div class="scroll"><table>{head}{rows}</table></div>'


def _plots(traces: Traces, alarms: list[Alarm], zero: float) -> list[str]:
    every = list(traces)
    if not every:
        return ["<p>Nothing was compared: the run is shorter than what is learned from.</p>"]
    end = max((max(trace.bins) + 1) * trace.width for _, trace in every)
    parts = {part for alarm in alarms for part in alarm.parts}
    order = sorted(every, key=lambda item: (item[0][2].rpartition(".")[0] not in parts, -_extent(item[1]), item[0]))
    drawn = order[:_MOST_PLOTS]
    plots = [
        f"<figure>{_plot(trace, [a for a in alarms if a.robot == robot], zero, end)}"
        f"<figcaption>{escape(robot)}: {escape(name)} <small>({escape(topic)})</small></figcaption></figure>"
        for (robot, topic, name), trace in drawn
    ]
    if len(every) > len(drawn):
        plots.append(f"<p>{len(every) - len(drawn)} numbers with smaller differences are not drawn.</p>")
    return plots


def _extent(trace: Trace) -> float:
    return round(max(max(abs(low), abs(high)) for low, high in trace.bins.values()), 6)


def _plot(trace: Trace, alarms: list[Alarm], zero: float, end: float) -> str:
    most = max(_BAND * 1.5, _extent(trace))

    def x(time: float) -> float:
        return round(_WIDTH * min(max(time / end, 0.0), 1.0), 1)

    def y(value: float) -> float:
        return round(_HEIGHT / 2 * (1 - asinh(value / _BAND) / asinh(most / _BAND)), 1)

    points = []
    for index, (low, high) in sorted(trace.bins.items()):
        at = x((index + 0.5) * trace.width)
        points += [f"{at},{y(low)}", f"{at},{y(high)}"]
    red = ""
    for alarm in alarms:
        begin, stop = x(alarm.began - zero), x((zero + end if alarm.ended is None else alarm.ended) - zero)
        red += f'<rect class="alarm" x="{begin}" y="0" height="{_HEIGHT}" width="{round(max(stop - begin, 1.0), 1)}"/>'
    return (
        f'<svg viewBox="0 0 {_WIDTH} {_HEIGHT}" role="img">'
        f'<rect class="band" x="0" width="{_WIDTH}" y="{y(_BAND)}" height="{round(y(-_BAND) - y(_BAND), 1)}"/>{red}'
        f'<polyline class="line" points="{" ".join(points)}"/>'
        f'<text class="axis" x="2" y="10">{most:.0f} σ</text>'
        f'<text class="axis" x="{_WIDTH - 2}" y="{_HEIGHT - 3}" text-anchor="end">{end:.0f} s</text></svg>'
    )


def _heard(mirror: Mirror) -> str:
    rows = []
    for topic, own in sorted(mirror.arrivals.items()):
        rate = f"{1 / own.period:.1f} Hz" if own.period else ""
        ours = mirror.topics.commands.get(topic) or mirror.topics.measured[topic].twin_topic
        same = "" if ours == topic else f"<br><small>as {escape(ours)}</small>"
        rows.append(
            f"<tr><td>{escape(topic)}{same}</td><td>{own.count}</td><td>{rate}</td><td>{own.gaps}</td>"
            f"<td>{own.longest_gap:.2f} s</td><td>{own.late}</td></tr>"
        )
    head = "<tr><th>Topic</th><th>Messages</th><th>Rate</th><th>Gaps</th><th>Longest</th><th>Out of order</th></tr>"
    profile = mirror.profile
    ahead = " ".join(
        f"The clock of {escape(robot)} is {-1e3 * clock.offset:.1f} ms ahead of the listener's and drifts by"
        f" {-1e6 * clock.drift:.0f} ppm."
        for robot, clock in sorted(mirror.clocks.items())
    )
    learned = (
        "Nothing was learned"
        if profile is None
        else f"The twin was compared with {profile.duration:.0f} s of a healthy run"
    )
    catches = f"The twin was set where the robot is {mirror.catches} times"
    text = f"<p>{ahead} {learned}. {catches}.</p>"
    return f'<div class="scroll"><table>{head}{"".join(rows)}</table></div>{text}'


def _list(title: str, lines: list[str]) -> str:
    if not lines:
        return ""
    return f"<h2>{title}</h2><ul>{''.join(f'<li>{escape(line)}</li>' for line in lines)}</ul>"
