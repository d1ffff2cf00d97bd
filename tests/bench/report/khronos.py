"""The chapter beside Khronos' references: compare.py's table, and the pictures themselves."""

import base64
import html
from pathlib import Path

from tables import table_html

PATH_TRACERS = ("blender-cycles", "three-gpu-pathtracer", "vray", "stellar")


def parse(text):
    """Returns (names of renderers, {scene: {renderer: distance}}, {renderer: median}) of compare.py's table."""
    lines = [line for line in text.splitlines() if line.strip()]
    header = next(line for line in lines if line.startswith("scenario"))
    names = header.split()[3:]
    rows, medians = {}, {}
    for line in lines[lines.index(header) + 1 :]:
        words = line.split()
        values = [None if word == "-" else float(word) for word in words[-len(names) :]]
        row = {name: value for name, value in zip(names, values) if value is not None}
        if words[0] == "median":
            medians = row
        elif len(words) > len(names):
            rows[words[0]] = row
    return names, rows, medians


def finding(text):
    _, rows, medians = parse(text)
    if "relumine" not in medians:
        return None
    others = {name: value for name, value in medians.items() if name in ("model-vie", "filament", "babylon", "gltf-samp")}
    best = min(others, key=others.get, default=None)
    sentence = f"Over {len(rows)} assets Relumine's pictures lie {medians['relumine']} of 255 from the mean of the path tracers (median)"
    if best:
        sentence += f"; the nearest real-time renderer, {best}, {others[best]}"
    nearer = [
        name for name, row in rows.items() if "relumine" in row and all(row["relumine"] <= row[other] for other in others if other in row)
    ]
    return sentence + f". It is nearer than all of them on {len(nearer)}: {', '.join(nearer) or 'none'}."


def mime(path):
    return {"png": "image/png", "webp": "image/webp"}[path.suffix[1:]]


def embedded(path):
    return f"data:{mime(path)};base64,{base64.b64encode(path.read_bytes()).decode()}"


def body(text, data, pictures):
    names, rows, medians = parse(text)
    table = [["asset", *names]]
    for scene, row in rows.items():
        table.append([scene, *(f"{row[name]:.1f}" if name in row else "-" for name in names)])
    table.append(["median", *(f"{medians[name]:.1f}" if name in medians else "-" for name in names)])
    parts = [
        "<p>Mean absolute difference of sRGB values, 0 to 255, where a reference shows the object, against the mean of the path tracers; "
        "for a path tracer against the mean of the others. Cameras, environments and references are those of Khronos' glTF Render Fidelity comparison.</p>",
        table_html(table),
        "<div class=pairs>",
    ]
    for scene in rows:
        own = Path(pictures) / f"{scene}.png"
        if not own.exists():
            continue
        cells = [(own, "Relumine")]
        for renderer in ("blender-cycles", "filament", "model-viewer"):
            reference = Path(data) / "khronos" / "references" / scene / f"{renderer}.webp"
            if reference.exists():
                cells.append((reference, renderer))
        images = "".join(
            f"<figure><img loading=lazy src='{embedded(path)}' alt='{html.escape(scene)}, {name}'><figcaption>{name}</figcaption></figure>"
            for path, name in cells
        )
        parts.append(f"<section class=row><h4>{html.escape(scene)}</h4><div class=strip>{images}</div></section>")
    return "\n".join(parts) + "</div>"
