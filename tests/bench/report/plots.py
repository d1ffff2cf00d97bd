"""Plots as SVG: lines through points on logarithmic axes, in colours that colour-blind readers tell
apart (Okabe and Ito), with the page's own ink and paper."""

import html
import json
import math
import sys
from pathlib import Path

# Black stands for the page's ink, so the palette fits dark pages, too.
PALETTE = ["#0072b2", "#e69f00", "#009e73", "#d55e00", "#cc79a7", "#56b4e9", "#b8a800", "#888888", "#9467bd"]
MARKS = ["circle", "square", "diamond", "up", "down", "cross", "circle", "square", "up"]

WIDTH, HEIGHT = 640, 400
LEFT, RIGHT, TOP, BOTTOM = 70, 14, 14, 52


def decades(low, high):
    """Returns (from, to, ticks): powers of ten around the values, with 2 and 5 where there are few."""
    first, last = math.floor(math.log10(low) + 1e-9), math.ceil(math.log10(high) - 1e-9)
    last = max(last, first + 1)
    steps = (1, 2, 5) if last - first <= 2 else (1,)
    ticks = [step * 10.0**power for power in range(first, last + 1) for step in steps]
    # Cut to the ticks next to the values, so that a plot is not half empty.
    start = max([tick for tick in ticks if tick <= low * (1 + 1e-9)] or [ticks[0]])
    end = min([tick for tick in ticks if tick >= high * (1 - 1e-9)] or [ticks[-1]])
    if start == end:
        end = 10 * start
    return start, end, [tick for tick in ticks if start <= tick <= end]


def number(value):
    if value >= 1e6 or value < 1e-4:
        return f"{value:.0e}".replace("e+0", "e").replace("e-0", "e-")
    return f"{value:g}"


def mark(shape, x, y, colour, title):
    r = 4
    tip = f"<title>{html.escape(title)}</title>"
    if shape == "circle":
        return f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{r}" fill="{colour}">{tip}</circle>'
    if shape == "cross":
        path = f"M{x - r:.1f} {y - r:.1f}l{2 * r} {2 * r}m0 {-2 * r}l{-2 * r} {2 * r}"
        return f'<path d="{path}" stroke="{colour}" stroke-width="2.5" fill="none">{tip}</path>'
    corners = {
        "square": [(-r, -r), (r, -r), (r, r), (-r, r)],
        "diamond": [(0, -r - 1), (r + 1, 0), (0, r + 1), (-r - 1, 0)],
        "up": [(0, -r - 1), (r + 1, r), (-r - 1, r)],
        "down": [(0, r + 1), (r + 1, -r), (-r - 1, -r)],
    }[shape]
    points = " ".join(f"{x + dx:.1f},{y + dy:.1f}" for dx, dy in corners)
    return f'<polygon points="{points}" fill="{colour}">{tip}</polygon>'


def log_plot(series, x_label, y_label, emphasised=(), names=()):
    """series: {name: [(x, y, what it is)]} with positive numbers; names in `emphasised` get thick
    lines. `names` are those of all plots of a page: each has one colour in all. Returns SVG with a
    legend under it."""
    series = {name: sorted(points) for name, points in series.items() if points}
    values = [point for points in series.values() for point in points]
    x0, x1, x_ticks = decades(min(p[0] for p in values), max(p[0] for p in values))
    y0, y1, y_ticks = decades(min(p[1] for p in values), max(p[1] for p in values))

    def place_x(x):
        return LEFT + (WIDTH - LEFT - RIGHT) * math.log(x / x0) / math.log(x1 / x0)

    def place_y(y):
        return HEIGHT - BOTTOM - (HEIGHT - TOP - BOTTOM) * math.log(y / y0) / math.log(y1 / y0)

    out = [f'<svg viewBox="0 0 {WIDTH} {HEIGHT}" role="img" aria-label="{html.escape(y_label)} against {html.escape(x_label)}">']
    for tick in x_ticks:
        x = place_x(tick)
        out.append(f'<path class="grid" d="M{x:.1f} {TOP}V{HEIGHT - BOTTOM}"/>')
        out.append(f'<text x="{x:.1f}" y="{HEIGHT - BOTTOM + 18}" text-anchor="middle">{number(tick)}</text>')
    for tick in y_ticks:
        y = place_y(tick)
        out.append(f'<path class="grid" d="M{LEFT} {y:.1f}H{WIDTH - RIGHT}"/>')
        out.append(f'<text x="{LEFT - 8}" y="{y + 4:.1f}" text-anchor="end">{number(tick)}</text>')
    middle_x, middle_y = (LEFT + WIDTH - RIGHT) / 2, (TOP + HEIGHT - BOTTOM) / 2
    out.append(f'<text class="label" x="{middle_x}" y="{HEIGHT - 10}" text-anchor="middle">{html.escape(x_label)}</text>')
    out.append(
        f'<text class="label" x="16" y="{middle_y}" text-anchor="middle" transform="rotate(-90 16 {middle_y})">{html.escape(y_label)}</text>'
    )
    legend = []
    names = list(names) or list(series)
    for name, points in series.items():
        index = names.index(name)
        colour, shape = PALETTE[index % len(PALETTE)], MARKS[index % len(MARKS)]
        line = "M" + "L".join(f"{place_x(p[0]):.1f} {place_y(p[1]):.1f}" for p in points)
        width = 3 if name in emphasised else 1.5
        out.append(f'<path d="{line}" fill="none" stroke="{colour}" stroke-width="{width}" stroke-linejoin="round"/>')
        out += [mark(shape, place_x(p[0]), place_y(p[1]), colour, f"{name}, {p[2]}") for p in points]
        key = f'<svg viewBox="0 0 24 12" class="key"><path d="M0 6H24" stroke="{colour}" stroke-width="{width}"/>{mark(shape, 12, 6, colour, name)}</svg>'
        legend.append(f"<span>{key}{html.escape(name)}</span>")
    out.append("</svg>")
    return f'<figure class="plot">{"".join(out)}<figcaption class="legend">{"".join(legend)}</figcaption></figure>'


STYLE = "<style>text{font:12px sans-serif;fill:#222}.grid{stroke:#ddd;fill:none}</style>"


def growth_plots(growth, folder):
    """Writes growth_NAME.svg for each table of growth.json, which `./dev bench growth` writes."""
    x_of = {"vertices": "receivers", "mesh_size": "receivers", "clusters": "clusters", "triangles": "triangles"}
    curves = {"precompute (processor)": "precompute", "relight": "relight"}
    for name, rows in growth.items():
        points = {curve: [(row[x_of[name]], row[key], f"{row[key]:.3g} s") for row in rows if row[key] > 0] for curve, key in curves.items()}
        figure = log_plot(points, x_of[name], "seconds")
        start = figure.index("<svg ") + len("<svg ")
        svg = figure[start : figure.index("</svg>") + len("</svg>")]
        head, rest = svg.split(">", 1)
        (folder / f"growth_{name}.svg").write_text(f'<svg xmlns="http://www.w3.org/2000/svg" {head}>{STYLE}{rest}\n')


if __name__ == "__main__":
    growth_plots(json.loads(Path(sys.argv[1]).read_text()), Path(sys.argv[2]))
