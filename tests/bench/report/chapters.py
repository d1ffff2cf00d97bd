"""What the report measures: a bench each, and the sentence that says what came out."""

import re
from dataclasses import dataclass, field
from typing import Callable, List, Optional

from tables import data_rows, first, tables


@dataclass
class Chapter:
    name: str
    title: str
    #: Arguments of build/release/tests/bench/bench_NAME; `quick` where a run of some minutes differs.
    arguments: List[str]
    #: None: left out of quick reports.
    quick: Optional[List[str]]
    #: The finding, from what the bench printed; None where it cannot be read from it.
    finding: Callable[[str], Optional[str]]
    program: str = ""
    #: What fell short, and what the figures do not say.
    remarks: List[str] = field(default_factory=list)


def relight(text):
    full = first(r"full relight of a binned map \| ([\d.]+) ms", text)
    times = first(r"full relight of a binned map .*?, ([\d.]+) times as fast as the dense", text)
    edit = first(r"disc of 5 % of the map's width \| ([\d.]+) ms", text)
    vertices = first(r"Bunny, (\d+) vertices", text)
    if full and edit:
        return (
            f"The bunny's {vertices} vertices are relit in {full} ms, {times} times as "
            f"fast as from a dense table of bytes, and a small edit takes {edit} ms."
        )


def table1(text):
    rows = {row[0]: row for table in tables(text) for row in table}
    paper, own = rows.get("Bunny, paper"), rows.get("Bunny, Relumine")
    if paper and own:
        return (
            f"The bunny of Johan and Nishita's Table 1 takes {own[4]} to precompute, {own[3]} MB and {own[5]} to relight; "
            f"the paper had {paper[4]}, {paper[3]} MB and {paper[5]} on a Pentium 4."
        )


def edit(text):
    rows = [row for table in tables(text) for row in table if row[0].startswith("60 steps")]
    if rows:
        return "An edit step takes " + " and ".join(
            f"{row[1]} ({row[0].removeprefix('60 steps of ')}, {row[4]} faster than relighting all)" for row in rows
        ) + "."


def precompute(text):
    beams = first(r"^beams +([\d.]+) s", text) or first(r"\nbeams +([\d.]+) s", text)
    packets = first(r"Embree, packets +([\d.]+) s", text)
    if beams and packets:
        return f"Beams precompute the bunny in {beams} s, where Embree's packets take {packets} s."


def growth(text):
    exponents = first(r"Against vertices: precompute grows with exponent ([\d.]+)", text)
    relit = first(r"Against vertices: .*relighting with (\d+\.\d+)", text)
    if exponents:
        return f"With more vertices at the same clusters, precompute grows with exponent {exponents} and relighting with {relit}; 1 is in proportion."


def adjoint(text):
    rows = [row for row in data_rows(text) if "traced" not in row[0]]
    if rows:
        ratios = sorted(float(row[3]) for row in rows)
        batch = first(r"environments at .* ratio ([\d.]+)", text)
        return f"The derivative by every texel of the environment costs {ratios[0]} to {ratios[-1]} relights, and a batch of environments {batch} of single calls."


def harmonics(text):
    median = first(r"median ([\d.]+)", text)
    grid = first(r"relight ([\d.]+) ms", text)
    if median:
        return f"Nine coefficients give the irradiance of normals 30 degrees off the surface's within {median} (median of six lights); a grid of probes is relit in {grid} ms."


def video(text):
    sections = {}
    name = None
    for line in text.splitlines():
        if line.startswith("### "):
            name = line[4:]
        cells = [cell.strip() for cell in line.strip("|").split("|")]
        if name and cells[0] in ("clusters, followed", "prt"):
            sections.setdefault(name, {})[cells[0]] = cells
    if sections:
        name, rows = next(iter(sections.items()))
        if len(rows) == 2:
            return f"Under the sequence “{name}” lights that are followed from frame to frame flicker {rows['clusters, followed'][3]} as much as importance sampling, and precomputed transport {rows['prt'][3]}."


def light_lists(text):
    rows = data_rows(text)
    best = [(row[0], row[1], float(row[2])) for row in rows if row[1] == "64"]
    if best:
        best.sort(key=lambda row: row[2])
        return f"Of 64 distant lights, the best list is found by “{best[0][0]}”: relative L2 {best[0][2]}; the worst by “{best[-1][0]}”: {best[-1][2]}."


def layouts(text):
    rows = data_rows(text)
    powers = [float(row[2].rstrip(" %")) for row in rows if row[2].endswith("%")]
    if powers:
        return f"Of {len(rows)} ways through the layouts none changes the light's power by more than {max(powers):g} %."


def bounces(text):
    all_of = first(r"all bounces ([\d.]+) ms", text)
    error = first(r"bounces (0\.\d+);", text)
    if all_of:
        return f"All bounces of a new environment take {all_of} ms on top of the direct light, and are within {error} of a path tracer's (relative L2)."


def moving_eye(text):
    head = first(r"roughness ([\d.]+):", text)
    looks = [float(x) for x in re.findall(r"cpu ms, ([\d.]+) ms", text)]
    if looks:
        return f"At roughness {head} highlights follow a moving eye at {1000 / max(looks):.0f} to {1000 / min(looks):.0f} looks a second."


def drift(text):
    growth = first(r"at the end \(([^)]*)\)", text)
    rows = data_rows(text)
    if rows and growth:
        return f"After {rows[0][0]} and {rows[1][0]} memory has grown by {growth.lstrip('+')}, and the worst edit took {rows[0][3]}."


def scale(text):
    rows = data_rows(text)
    if rows:
        last = [row for row in rows if row[0] == "1000 M" and row[1] == "256"]
        if last:
            return f"A thousand million receivers on 256 cores would take {last[0][3]} for the parts and {last[0][4]} to join them, as extrapolated from this machine."


def coarse(text):
    rows = data_rows(text)
    if rows:
        off = sorted((max(map(float, row[4:])), row[0]) for row in rows)
        return f"First pictures of {len(rows)} coarse meshes lie {off[len(off) // 2][0]} of 255 from receivers in every pixel (median over the meshes, the worse of the lights); the farthest, {off[-1][1]}, {off[-1][0]}."


def pictures(text):
    found = re.search(r"([\d.]+) specks in a million pixels", text)
    rows = data_rows(text)
    if found and len(rows) > 1:
        return f"Pictures of {len(rows) - 1} assets have {found.group(1)} specks in a million pixels, and lie {rows[-1][4]} of 255 from converged ones (median)."


def refinement(text):
    rows = [row for row in data_rows(text) if "refined" in row[0]]
    if rows:
        return f"Refined where light needs it, {rows[0][0].split(',')[0]} has {rows[0][2]} as much error as with as many vertices spread evenly (in brackets)."


def frames(text):
    rows = data_rows(text)
    if rows:
        slow = min(rows, key=lambda row: float(row[-1]))
        return f"Of the sequences, “{slow[0]}” is the slowest: {slow[-1]} frames a second."


def glossy(text):
    rows = data_rows(text)
    if rows:
        return f"Highlights of roughness {rows[0][0]} from a fixed eye are relit with the rest in {rows[0][8]}."


BUNNY = ["--scene", "{bunny}"]

CHAPTERS = [
    Chapter("relight", "Relighting", BUNNY, BUNNY + ["--samples", "500"], relight),
    Chapter("table1", "Johan and Nishita's table", [], None, table1),
    Chapter("edit", "Editing", BUNNY, BUNNY, edit),
    Chapter("precompute", "Precompute", ["--threads"], ["--threads"], precompute),
    Chapter("growth", "Growth and memory", ["--folder", "{work}", "--vertices", "700000"], ["--folder", "{work}", "--vertices", "100000", "--triangles", "200000", "--only", "vertices"], growth),
    Chapter("coarse", "First pictures of coarse meshes", ["--direct", "--width", "160", "--height", "120"], None, coarse),
    Chapter("pictures", "Specks and grain", [], None, pictures),
    Chapter("refinement", "Refinement", [], None, refinement),
    Chapter("bounces", "Bounces", [], None, bounces),
    Chapter("glossy", "Highlights from a fixed eye", [], None, glossy),
    Chapter("moving_eye", "Highlights for an eye that moves", [], ["--eyes", "4", "--roughness", "0.3"], moving_eye),
    Chapter("frames", "Environments that change", BUNNY, None, frames),
    Chapter("video", "Video without flicker", BUNNY, None, video),
    Chapter("light_lists", "Light lists", BUNNY, BUNNY + ["--receivers", "300", "--env", "grace_cross.hdr,sun_sky", "--numbers", "64"], light_lists),
    Chapter("layouts", "Layouts of environments", [], ["--tiny"], layouts),
    Chapter("harmonics", "Points and harmonics", BUNNY, BUNNY + ["--points", "300", "--parts", "grid,normals"], harmonics),
    Chapter("adjoint", "Backwards and in batches", BUNNY, BUNNY, adjoint),
    Chapter("drift", "A day of edits", [], ["--edits", "2000", "--environments", "200"], drift),
    Chapter("scale", "Many machines", [], ["--tiny"], scale),
]
