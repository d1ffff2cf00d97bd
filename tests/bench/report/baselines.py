"""The chapter of other methods: plots, the table, pictures at equal bytes, and what came out."""

import base64
import html
import json
import re
import statistics
from pathlib import Path

from plots import log_plot
from tables import table_html

OWN = "relumine"
COMPONENTS = "clustered components (Sloan)"
#: Variants of a method share its curve: at each size the better one counts for it.
FAMILIES = {
    "relumine": "Relumine",
    "relumine, clusters alone": "Relumine without shadow rays",
    "clusters in bytes": "clusters in bytes (Johan and Nishita)",
    "dense bytes": "dense bytes",
    "wavelets": "Haar wavelets (Ng)",
    "wavelets, 200 of the light": "Haar wavelets (Ng)",
    "harmonics": "harmonics (Sloan)",
    "harmonics, windowed": "harmonics (Sloan)",
    "median cut, traced": "median cut, traced (Debevec)",
    "Cycles": "path tracing (Cycles)",
}
#: Of all curves, in the order of their colours.
NAMES = [*dict.fromkeys(FAMILIES.values()), COMPONENTS]

#: As many bytes, where sizes come in steps.
SLACK = 1.05


def family(method):
    return FAMILIES.get(method, COMPONENTS if method.startswith("CPCA") else method)


def mean_error(row):
    return statistics.fmean(row["relative_l2"].values())


def best_baseline(rows, own, environment=None):
    """Returns the baseline of the least error that stores no more than `own` but for SLACK, None where there is none.
    What stores nothing, traced lights, is no baseline at equal bytes."""
    error = mean_error if environment is None else lambda row: row["relative_l2"][environment]
    others = [
        row
        for row in rows
        if not row["method"].startswith(OWN) and 0 < row["stored_bytes"] <= SLACK * own["stored_bytes"]
    ]
    return min(others, key=error, default=None)


def best_rows(rows):
    """Returns {method: its row of the least error that stores no more than our default}, ours first."""
    own = own_default(rows)
    chosen = {FAMILIES[OWN]: own}
    for row in rows:
        name = family(row["method"])
        if row["method"] == OWN or row["stored_bytes"] > SLACK * own["stored_bytes"]:
            continue
        if name not in chosen or mean_error(row) < mean_error(chosen[name]):
            chosen[name] = row
    return chosen


def ratios(rows, own):
    """Returns {environment: error of the best baseline over ours} at equal bytes."""
    result = {}
    for environment, error in own["relative_l2"].items():
        other = best_baseline(rows, own, environment)
        if other is not None:
            result[environment] = other["relative_l2"][environment] / max(error, 1e-9)
    return result


def by_scene(rows):
    scenes = {}
    for row in rows:
        scenes.setdefault(row["scene"], []).append(row)
    return scenes


def own_default(rows):
    """The finest of our rows that relights as fast as people expect: the default tolerance."""
    own = [row for row in rows if row["method"] == OWN]
    default = [row for row in own if row["setting"] == "tolerance 0.0135"]
    return (default or own)[-1]


def finding(rows):
    sentences, lost = [], []
    for scene, of_scene in by_scene(rows).items():
        own = own_default(of_scene)
        factors = ratios(of_scene, own)
        if not factors:
            continue
        good = sum(factor >= 3 for factor in factors.values())
        sentences.append(
            f"For {scene}: {statistics.median(factors.values()):.1f} times (median; at least 3 times on {good} of {len(factors)} maps)"
        )
        lost += [f"{scene} under {name}" for name, factor in factors.items() if factor < 1]
    text = (
        "At the bytes of Relumine's default tolerance, the best other method that stores as little has a larger error. "
        + ". ".join(sentences)
        + "."
    )
    if lost:
        text += " A baseline wins for " + ", ".join(lost) + "."
    faster = []
    for scene, of_scene in by_scene(rows).items():
        own = own_default(of_scene)
        other = best_baseline(of_scene, own)
        if other and other["milliseconds_relight"] < own["milliseconds_relight"]:
            faster.append(f"for {scene} {other['milliseconds_relight']:.1f} against {own['milliseconds_relight']:.1f} ms")
    if faster:
        text += " That method relights faster: " + ", ".join(faster) + "."
    return text + path_tracing(rows)


def path_tracing(rows):
    """What Cycles reaches with the most samples that it was given."""
    reached = []
    for scene, of_scene in by_scene(rows).items():
        traced = [row for row in of_scene if row["method"] == "Cycles"]
        if traced:
            best = min(traced, key=mean_error)
            factor = mean_error(best) / max(mean_error(own_default(of_scene)), 1e-9)
            reached.append(f"For {scene}: {best['setting']} a vertex, {best['milliseconds_relight'] / 1e3:.1f} s, {factor:.0f} times the error")
    return " Cycles stores nothing and traces each light anew. " + ". ".join(reached) + "." if reached else ""


def curves(rows, x):
    series = {}
    for row in rows:
        value = row[x]
        if value > 0:
            series.setdefault(family(row["method"]), []).append(
                (value, max(mean_error(row), 1e-5), f"{row['method']}, {row['setting']}: {mean_error(row):.4f}")
            )
    return {name: lower_hull(points) for name, points in series.items()}


def lower_hull(points):
    """The points that no other one of the same method beats in both ways."""
    kept = []
    for point in sorted(points):
        if not kept or point[1] < kept[-1][1]:
            kept.append(point)
    return kept


def image(path):
    return "data:image/png;base64," + base64.b64encode(Path(path).read_bytes()).decode()


def picture_file(folder, row):
    name = f"{row['scene']} {row['method']} {row['setting']}"
    return Path(folder) / (re.sub(r"[^0-9A-Za-z.]", "_", name) + ".png")


def pictures(rows, folder, scene):
    """A picture for each method, of the row nearest to our default's bytes, beside the exact one."""
    exact = Path(folder) / f"{scene}_exact.png"
    if not exact.exists():
        return ""
    chosen = best_rows(rows)
    limit = chosen[FAMILIES[OWN]]["stored_bytes"]
    cards = []
    reference = image(exact)
    for name, row in chosen.items():
        own = image(picture_file(folder, row))
        cards.append(
            f"<figure class=pair><div class=slide><img src='{reference}' alt='exact'><img class=over src='{own}' alt='{html.escape(name)}'>"
            "<input type=range min=0 max=100 value=50 aria-label='how much of each picture is seen'></div>"
            f"<div class=difference><img src='{reference}' alt=''><img src='{own}' alt='difference, eight times'></div>"
            f"<figcaption><b>{html.escape(name)}</b>, {html.escape(row['setting'])}: {row['stored_bytes'] / 1e6:.1f} MB, error {row['relative_l2'].get('stpeters_cross.hdr', mean_error(row)):.4f}</figcaption></figure>"
        )
    return (
        f"<p>{html.escape(scene)} under St. Peter's, at no more bytes than Relumine's default ({limit / 1e6:.1f} MB): left of the handle the exact picture, "
        f"right of it the method's; under it the difference, eight times as bright.</p><div class=pairs>{''.join(cards)}</div>"
    )


def body(rows, folder):
    parts = [
        "<p>Error: relative L2 of the radiance of receivers drawn at random against exact integration of maps with 256 x 256 texels a face, the mean over five probes, "
        "sun and sky, and a studio. Bytes: as a file, through zstd. Time: from the environment in the method's own basis to all radiance, on all cores; "
        "ours holds the shadow rays of small lights. Others compress transport that was traced for every texel of a cube map, nine rays each.</p>"
    ]
    for scene, of_scene in by_scene(rows).items():
        parts.append(f"<h3>{html.escape(scene)}, {of_scene[0]['receivers']} receivers</h3><div class=plots>")
        for x, label in (
            ("stored_bytes", "bytes stored"),
            ("milliseconds_relight", "relight, ms"),
            ("seconds_precompute", "precompute, s"),
        ):
            parts.append(log_plot(curves(of_scene, x), label, "relative L2 error", ("Relumine",), NAMES))
        parts.append("</div>" + pictures(of_scene, folder, scene))
        names = list(of_scene[0]["relative_l2"])
        short = [name.removesuffix("_cross.hdr") for name in names]
        table = [["method", "setting", "MB", "MB stored", "precompute, s", "relight, ms", *short]]
        for row in of_scene:
            table.append(
                [
                    row["method"],
                    row["setting"],
                    f"{row['bytes'] / 1e6:.2f}",
                    f"{row['stored_bytes'] / 1e6:.2f}",
                    f"{row['seconds_precompute']:.1f}",
                    f"{row['milliseconds_relight']:.2f}",
                    *(f"{row['relative_l2'][name]:.4f}" for name in names),
                ]
            )
        parts.append(f"<details><summary>All rows</summary>{table_html(table)}</details>")
    return "\n".join(parts)


def load(path):
    return json.loads(Path(path).read_text())
