#!/usr/bin/env python3
"""Writes docs/comparison.md from docs/figures.json, or tells whether it is what would be written.

    document.py [--check] [FIGURES]

FIGURES is the figures.json of a report, which becomes docs/figures.json."""

import argparse
import json
import sys
import textwrap
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))

import baselines

ROOT = Path(__file__).resolve().parents[3]
#: Chapters that the page quotes; others have pages of their own.
QUOTED = ("baselines", "khronos")

INTRODUCTION = """# Beside other methods

This page has methods that relight with precomputed transport, or with few lights, at the same bytes
and on the same data. It has Relumine's pictures beside those of Khronos' reference renderers. The
whole comparison, with plots and pictures, is one page that one command makes:

```
./dev bench report -o report/          # 85 minutes on two cores; --quick leaves much out
```

This page is written from `docs/figures.json`, which such a run wrote. `tests/bench/baselines/` has
the other methods, with tests of their own. Path tracers and Radiance, with what they do better, are
in [peers.md](peers.md). The report leaves them out, since `./dev bench peers` installs 2 GB.
"""

METHODS = """Errors are relative L2 of radiance at receivers drawn at random, against exact integration of maps of
256 x 256 texels a face. They are the mean over five probes, sun and sky, and a studio. "Stored" is a
file, through zstd. "Relight" goes from an environment in the method's own basis to all radiance, on all
cores. Ours holds the shadow rays of small lights. "Without shadow rays" has none. Traced lights and Cycles
store nothing. Blender bakes direct light to the same vertices with the same normals, and its time is that of
the bake alone. All others compress the same transport, traced for every texel of a cube map. A row is the
best setting of each method that stores no more than Relumine's default, or 5 % more.
"""


def wrapped(text):
    """The text in lines of a document's width."""
    return textwrap.fill(" ".join(text.split()), 100, break_long_words=False, break_on_hyphens=False)


def baselines_markdown(chapter):
    parts = ["## At equal bytes", wrapped(baselines.finding(chapter["figures"])), wrapped(METHODS)]
    for scene, rows in baselines.by_scene(chapter["figures"]).items():
        lines = [
            f"{scene}, {rows[0]['receivers']} receivers:",
            "",
            "| method | setting | MB stored | MB in memory | precompute, s | relight, ms | error |",
            "|---|---|---|---|---|---|---|",
        ]
        for name, row in baselines.best_rows(rows).items():
            lines.append(
                f"| {name} | {row['setting']} | {row['stored_bytes'] / 1e6:.2f} | {row['bytes'] / 1e6:.1f} | "
                f"{row['seconds_precompute']:.1f} | {row['milliseconds_relight']:.2f} | {baselines.mean_error(row):.4f} |"
            )
        parts.append("\n".join(lines))
    return parts


def khronos_markdown(chapter):
    rows = chapter["figures"]
    names = list(next(iter(rows.values())))
    lines = ["| asset | " + " | ".join(names) + " |", "|---" * (len(names) + 1) + "|"]
    for asset, row in rows.items():
        lines.append(f"| {asset} | " + " | ".join(f"{row[name]:.1f}" if name in row else "-" for name in names) + " |")
    return ["## Beside reference renderers", wrapped(chapter["finding"]), "\n".join(lines)]


def document(figures):
    chapters = {chapter["name"]: chapter for chapter in figures["chapters"]}
    parts = [INTRODUCTION.rstrip()]
    for name, markdown in (("baselines", baselines_markdown), ("khronos", khronos_markdown)):
        if name in chapters:
            chapter = chapters[name]
            parts += markdown(chapter)
            parts.append(wrapped(f"`{chapter['command']}`, {chapter['seconds'] / 60:.0f} minutes, load {chapter['load']:.1f} when it began."))
    machine = figures["machine"]
    parts.append("The machine: " + "; ".join(f"{key} {machine[key]}" for key in ("processor", "memory", "date")) + ".")
    return "\n\n".join(parts) + "\n"


def quoted(figures):
    """What the page needs of a report's figures."""
    return {
        "machine": figures["machine"],
        "chapters": [chapter for chapter in figures["chapters"] if chapter["name"] in QUOTED],
    }


def main(argv):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--check", action="store_true")
    parser.add_argument("figures", nargs="?", type=Path)
    arguments = parser.parse_args(argv)
    kept, page = ROOT / "docs" / "figures.json", ROOT / "docs" / "comparison.md"
    if arguments.figures:
        figures = quoted(json.loads(arguments.figures.read_text()))
        kept.write_text(json.dumps(figures, indent=1) + "\n")
    text = document(json.loads(kept.read_text()))
    if arguments.check:
        if page.read_text() != text:
            print(f"{page}: expected what document.py makes of {kept}; run it", file=sys.stderr)
            return 1
    else:
        page.write_text(text)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
