"""The report's tables, plots and findings, on small inputs of known answers."""

import json
import sys
import tempfile
import unittest
import xml.etree.ElementTree as xml
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))

import baselines
import chapters
import khronos
import page
import plots
import tables
from report import main

PRINTED = """Memory is read at 24.2 GB/s. Bunny, 73196 vertices, 12879 clusters; beach at R = 1024.

| step | median | remark |
|---|---|---|
| full relight of a binned map | 8.255 ms | 76 MB, 6.7 times as fast as the dense table |
| an edit, disc of 5 % of the map's width | 0.162 ms | 52 times as fast as a full relight |
"""

COMPARED = """scenario                precompute relight  relumine model-vie  filament   babylon gltf-samp blender-c three-gpu      vray   stellar
duck                         4.1 s    0.3 s       2.4       4.3       4.6       5.0       4.8       1.0       1.1         -       1.2
helmet                      44.1 s    1.3 s      12.4      14.3      11.6      15.0      14.8       3.0       3.1       2.9       3.2
median                                            7.4       9.3       8.1      10.0       9.8       2.0       2.1       2.9       2.2
"""


def row(method, stored, error, setting="x", relight=1.0):
    return {
        "scene": "bunny",
        "receivers": 10,
        "method": method,
        "setting": setting,
        "bytes": 2 * stored,
        "stored_bytes": stored,
        "seconds_precompute": 1.0,
        "milliseconds_relight": relight,
        "relative_l2": {"grace": error, "sky": 2 * error},
    }


class Tables(unittest.TestCase):
    def test_blocks_are_read_in_order(self):
        kinds = [kind for kind, _ in tables.blocks(PRINTED)]
        self.assertEqual(kinds, ["text", "table"])
        self.assertEqual(tables.tables(PRINTED)[0][1][1], "8.255 ms")

    def test_cells_are_escaped(self):
        text = tables.markdown_html("| a | b |\n|---|---|\n| <T e, w> | 1.5 ms |\n")
        self.assertIn("&lt;T e, w&gt;", text)
        self.assertIn("<td class=number>1.5 ms</td>", text)


class Plots(unittest.TestCase):
    def test_axes_hold_all_values(self):
        for low, high in ((0.003, 0.9), (2e5, 3e7), (1.0, 1.0), (0.1, 1000.0)):
            start, end, ticks = plots.decades(low, high)
            self.assertLessEqual(start, low * (1 + 1e-9))
            self.assertGreaterEqual(end, high * (1 - 1e-9))
            self.assertGreaterEqual(len(ticks), 2)

    def test_a_plot_is_well_formed_and_has_all_points(self):
        svg = plots.log_plot({"a <b>": [(1.0, 0.1, "first"), (10.0, 0.01, "second")], "c": [(3.0, 0.5, "third")]}, "x", "y")
        figure = xml.fromstring(svg)
        titles = [element.text for element in figure.iter() if element.tag.endswith("title")]
        for title in ("a <b>, first", "a <b>, second", "c, third"):
            self.assertIn(title, titles)

    def test_plots_of_growth_stand_alone(self):
        rows = [{"receivers": n, "triangles": 2 * n, "clusters": 384, "precompute": n / 1e4, "relight": n / 1e7} for n in (1000, 10000)]
        with tempfile.TemporaryDirectory() as folder:
            plots.growth_plots({"vertices": rows}, Path(folder))
            plot = xml.parse(Path(folder) / "growth_vertices.svg").getroot()
        self.assertEqual(plot.tag, "{http://www.w3.org/2000/svg}svg")
        titles = [element.text for element in plot.iter() if element.tag.endswith("title")]
        self.assertIn("relight, 0.001 s", titles)


class Baselines(unittest.TestCase):
    ROWS = [
        row("relumine", 100, 0.01, "tolerance 0.0135"),
        row("dense bytes", 80, 0.04),
        row("dense bytes", 300, 0.001),
        row("wavelets", 90, 0.05, relight=0.5),
        row("median cut, traced", 0, 0.0001),
    ]

    def test_baselines_have_no_more_bytes(self):
        best = baselines.best_baseline(self.ROWS, self.ROWS[0])
        self.assertEqual((best["method"], best["stored_bytes"]), ("dense bytes", 80))
        for factor in baselines.ratios(self.ROWS, self.ROWS[0]).values():
            self.assertAlmostEqual(factor, 4.0)

    def test_the_finding_says_where_a_baseline_wins(self):
        self.assertIn("4.0 times (median; at least 3 times on 2 of 2 maps)", baselines.finding(self.ROWS))
        self.assertNotIn("wins", baselines.finding(self.ROWS))
        self.assertIn("A baseline wins for bunny under grace", baselines.finding(self.ROWS + [row("harmonics", 50, 0.001)]))

    def test_the_finding_says_what_path_tracing_costs(self):
        traced = [row("Cycles", 0, 0.4, "16 samples"), row("Cycles", 0, 0.2, "64 samples", relight=5500.0)]
        self.assertIn("bunny: 64 samples a vertex, 5.5 s, 20 times the error", baselines.finding(self.ROWS + traced))
        self.assertNotIn("Cycles", baselines.finding(self.ROWS))

    def test_curves_leave_out_what_is_worse_in_both(self):
        series = baselines.curves(self.ROWS + [row("dense bytes", 200, 0.5)], "stored_bytes")
        self.assertEqual([point[0] for point in series["dense bytes"]], [80, 300])


class Findings(unittest.TestCase):
    def test_relighting(self):
        sentence = chapters.relight(PRINTED)
        for figure in ("73196", "8.255 ms", "6.7 times", "0.162 ms"):
            self.assertIn(figure, sentence)

    def test_batches_are_not_taken_for_harmonics(self):
        printed = """| light | relight | adjoint | ratio | error |
|---|---|---|---|---|
| beach | 12.11 ms | 27.68 ms | 2.29 | 1.4e-10 |

nine coefficients, processor time: relight 55.1 ms, adjoint 155.8 ms, ratio 2.83; difference 4.9e-10
64 environments at R = 64: 1194 ms of processors one by one, 687 ms at once, ratio 0.58
"""
        self.assertIn("a batch of environments 0.58 of", chapters.adjoint(printed))

    def test_growth_ends_without_a_full_stop_of_the_bench(self):
        printed = "Against vertices: precompute grows with exponent 1.50, relighting with 1.03.\n"
        self.assertIn("relighting with 1.03; 1 is", chapters.growth(printed))

    def test_coarse_pictures_have_a_median_and_a_farthest(self):
        printed = """| mesh | vertices | refined | precompute | sun | studio |
|---|---|---|---|---|---|
| lamp | 769 | 43343 | 1.6 s | 0.06 | 0.36 |
| house | 2008 | 54154 | 3.5 s | 0.94 | 0.85 |
| castle | 4220 | 56235 | 4.3 s | 8.73 | 11.88 |
"""
        sentence = chapters.coarse(printed)
        self.assertIn("lie 0.94 of 255", sentence)
        self.assertIn("castle, 11.88.", sentence)

    def test_pictures_have_specks_and_a_distance(self):
        printed = """| asset | map | pixels | specks | distance | grain | processor s |
|---|---|---|---|---|---|---|
| glass | church | 29239 | 6 | 0.40 | 0.46 | 4.3 |
| duck | dawn | 24032 | 0 | 0.21 | 0.23 | 0.6 |
| all | | 53271 | 6 | 0.40 | 0.46 | 4.9 |

112.6 specks in a million pixels; distance and grain are medians, of 255
"""
        self.assertIn("of 2 assets have 112.6 specks", chapters.pictures(printed))
        self.assertIn("lie 0.40 of 255", chapters.pictures(printed))

    def test_nothing_is_found_in_nothing(self):
        for chapter in chapters.CHAPTERS:
            self.assertIsNone(chapter.finding("no figures here\n"), chapter.name)

    def test_khronos(self):
        names, rows, medians = khronos.parse(COMPARED)
        self.assertEqual(rows["duck"]["relumine"], 2.4)
        self.assertNotIn("vray", rows["duck"])
        self.assertEqual((names[0], medians["filament"]), ("relumine", 8.1))
        sentence = khronos.finding(COMPARED)
        self.assertIn("lie 7.4 of 255", sentence)
        self.assertIn("nearer than all of them on 1: duck", sentence)


class Report(unittest.TestCase):
    def test_the_page_needs_nothing_else(self):
        chapter = {"name": "a", "title": "A & B", "finding": "found", "command": "./dev bench a", "seconds": 1.0, "load": 0.5, "body": "<p>x</p>"}
        text = page.page_html({"processor": "p"}, [chapter], ["khronos"])
        self.assertIn("A &amp; B", text)
        for outside in ("http:", "https:", "src=/", "@import"):
            self.assertNotIn(outside, text)

    def test_unknown_chapters_are_refused(self):
        with tempfile.TemporaryDirectory() as folder, self.assertRaisesRegex(SystemExit, "got nothing_such"):
            main(["--only", "nothing_such", "-o", folder])

    def test_failures_are_said_and_nothing_is_lost(self):
        with tempfile.TemporaryDirectory() as folder:
            bench = Path(folder) / "tests" / "bench"
            bench.mkdir(parents=True)
            for name, lines in (("bench_layouts", "exit 3"), ("bench_scale", "echo '| a |'; echo '|---|'")):
                (bench / name).write_text(f"#!/bin/sh\n{lines}\n")
                (bench / name).chmod(0o755)
            status = main(["--build", folder, "--only", "layouts,scale", "-o", f"{folder}/out"])
            self.assertEqual(status, 1)
            self.assertIn("layouts: exit 3", Path(folder, "out", "index.html").read_text())
            self.assertEqual(json.loads(Path(folder, "out", "figures.json").read_text())["chapters"], [])

    def test_chapters_of_the_same_commit_are_kept(self):
        with tempfile.TemporaryDirectory() as folder:
            bench = Path(folder) / "tests" / "bench" / "bench_layouts"
            bench.parent.mkdir(parents=True)
            out = Path(folder) / "out"
            arguments = ["--build", folder, "--only", "layouts", "-o", str(out)]
            for lines in ("echo '| way | error | power |'; echo '|---|---|---|'; echo '| a to b | 0.1 | 0.5 % |'", "exit 3"):
                bench.write_text(f"#!/bin/sh\n{lines}\n")
                bench.chmod(0o755)
                self.assertEqual(main([*arguments, "--resume"]), 0)
                figures = json.loads((out / "figures.json").read_text())
                self.assertIn("0.5 %", figures["chapters"][0]["finding"])
                self.assertIn("a to b", (out / "index.html").read_text())
            self.assertEqual(main(arguments), 1, "without --resume it runs again")


if __name__ == "__main__":
    unittest.main()
