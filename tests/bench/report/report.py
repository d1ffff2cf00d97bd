#!/usr/bin/env python3
"""Runs the benches and writes what they show: OUT/index.html, one page that needs nothing else, and
OUT/figures.json with every figure, the machine, the load and the commands."""

import argparse
import json
import os
import subprocess
import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))

import baselines
import khronos
from chapters import CHAPTERS
from page import page_html
from tables import markdown_html, tables

ROOT = Path(__file__).resolve().parents[3]


def machine(commit):
    def value_of(path, key):
        lines = Path(path).read_text().splitlines()
        return next((line.split(":", 1)[1].strip() for line in lines if line.startswith(key)), "")

    cpu, flags = value_of("/proc/cpuinfo", "model name"), value_of("/proc/cpuinfo", "flags").split()
    memory = int(value_of("/proc/meminfo", "MemTotal").split()[0])
    vectors = "AVX-512" if "avx512f" in flags else "AVX2" if "avx2" in flags else "SSE"
    return {
        "processor": f"{cpu}, {os.cpu_count()} threads, {vectors}",
        "memory": f"{memory / 1048576:.0f} GiB",
        "commit": commit,
        "date": time.strftime("%Y-%m-%d"),
    }


def commit_of(root):
    done = subprocess.run(["git", "-C", root, "rev-parse", "--short", "HEAD"], capture_output=True, text=True)
    return done.stdout.strip() or "unknown"


class Run:
    """Runs programs one after the other and keeps what they print."""

    def __init__(self, arguments, work, commit):
        self.arguments = arguments
        self.commit = commit
        self.work = work
        self.chapters = []
        self.skipped = []
        self.failed = []

    def capture(self, command, name):
        """Returns (what it printed, seconds, load before), or None where it has nothing to say."""
        print(f"{name} ...", file=sys.stderr, flush=True)
        load = os.getloadavg()[0]
        start = time.monotonic()
        done = subprocess.run(command, capture_output=True, text=True, cwd=self.work)
        seconds = time.monotonic() - start
        if done.returncode != 0:
            last = (done.stderr.strip().splitlines() or ["it said nothing"])[-1]
            self.fail(f"{name}: exit {done.returncode}: {last}")
            return None
        if "no " in done.stdout and "set RELUMINE_DATA" in done.stdout:
            self.skipped.append(f"{name} ({done.stdout.strip()})")
            return None
        return done.stdout, seconds, load

    def take_kept(self, name):
        """Takes a chapter from an earlier run of the same commit; False where there is none."""
        kept = self.kept(name)
        if not (self.arguments.resume and kept.exists()):
            return False
        chapter = json.loads(kept.read_text())
        if chapter.pop("commit") != self.commit:
            return False
        self.chapters.append(chapter)
        return True

    def kept(self, name):
        return self.work / f"{name}.chapter.json"

    def fail(self, reason):
        """The other chapters go on."""
        print(f"report: {reason}", file=sys.stderr, flush=True)
        self.failed.append(reason)
        self.skipped.append(reason)

    def add(self, name, title, command, captured, finding, body, remarks=(), figures=None):
        text, seconds, load = captured
        chapter = {
            "name": name,
            "title": title,
            "command": command,
            "seconds": seconds,
            "load": load,
            "finding": finding,
            "remarks": list(remarks),
            "body": body,
            "figures": tables(text) if figures is None else figures,
        }
        self.chapters.append(chapter)
        self.kept(name).write_text(json.dumps({**chapter, "commit": self.commit}))

    def bench(self, name):
        return str(self.arguments.build / "tests" / "bench" / name)

    def baselines(self):
        program, out = self.bench("bench_baselines"), self.work / "baselines.json"
        pictures = self.work / "baselines"
        # Every setting of every method takes a quarter of an hour for a scene, and Cycles more than all others.
        runs = [["--quick", "--scenes", "bunny,colonnade"]]
        if not self.arguments.quick:
            runs = [["--scenes", "bunny", "--cycles", "64"], ["--quick", "--scenes", "dragon,colonnade,room"]]
        rows, seconds, loads = [], 0.0, []
        for options in runs:
            captured = self.capture([program, "--json", str(out), "--pictures", str(pictures), *options], "baselines")
            if captured is None:
                return
            rows += baselines.load(out)
            seconds += captured[1]
            loads.append(captured[2])
        command = "; ".join(" ".join(["./dev bench baselines", *options]) for options in runs)
        self.add("baselines", "Beside other methods, at equal bytes", command, ("", seconds, loads[0]), baselines.finding(rows), baselines.body(rows, pictures), figures=rows)

    def khronos(self):
        script = self.arguments.data / "khronos" / "compare.py" if self.arguments.data else None
        if script is None or not script.exists():
            self.skipped.append("pictures beside Khronos' references (no khronos/compare.py in the data)")
            return
        pictures = self.work / "khronos"
        options = ["--relumine", str(self.arguments.build / "app" / "relumine"), "--way", "vertices", "--bounces", "--width", "384", "--out", str(pictures)]
        scenes = ["Duck", "DamagedHelmet", "ToyCar"] if self.arguments.quick else []
        captured = self.capture(["/usr/bin/python3", str(script), *options, *self.named(script, scenes)], "khronos")
        if captured is not None:
            text = captured[0]
            self.add("khronos", "Beside Khronos' references", "compare.py --way vertices --bounces --width 384", captured, khronos.finding(text), khronos.body(text, self.arguments.data, pictures), figures=khronos.parse(text)[1])

    @staticmethod
    def named(script, words):
        """The scenarios whose names hold one of the words."""
        names = json.loads((script.parent / "scenarios.json").read_text())
        return [name for name in names if any(word in name for word in words)]

    def chapter(self, chapter):
        chosen = chapter.quick if self.arguments.quick else chapter.arguments
        if chosen is None:
            self.skipped.append(f"{chapter.title} (takes minutes)")
            return
        if "{bunny}" in " ".join(chosen) and not self.bunny():
            self.skipped.append(f"{chapter.title} (no bunny in the data)")
            return
        filled = [word.format(bunny=self.work / "bunny.prt", work=self.work) for word in chosen]
        captured = self.capture([self.bench(f"bench_{chapter.name}"), *filled], chapter.name)
        if captured is None:
            return
        finding = chapter.finding(captured[0])
        if finding is None:
            self.fail(f"{chapter.name}: printed nothing that its chapter can tell of")
            return
        command = " ".join(["./dev bench", chapter.name, *(word.replace(str(self.work) + "/", "") for word in filled)])
        self.add(chapter.name, chapter.title, command, captured, finding, markdown_html(captured[0]), chapter.remarks)

    def bunny(self):
        """Precomputes the bunny that several benches share; False without the mesh."""
        scene = self.work / "bunny.prt"
        mesh = self.arguments.data / "meshes" / "stanford" / "bun_zipper.ply" if self.arguments.data else None
        if mesh is None or not mesh.exists():
            return False
        if not scene.exists():
            program = self.arguments.build / "app" / "relumine"
            self.capture([str(program), "precompute", str(mesh), "--floor", "193", "-o", str(scene), "-q"], "bunny.prt")
        return True


def arguments_of(argv):
    parser = argparse.ArgumentParser(prog="./dev bench report", description=__doc__)
    parser.add_argument("--build", type=Path, default=ROOT / "build" / "release", help=argparse.SUPPRESS)
    data = os.environ.get("RELUMINE_DATA")
    parser.add_argument("--data", type=Path, default=Path(data) if data else None, help="folder with meshes, envs and khronos")
    parser.add_argument("--quick", action="store_true", help="smaller meshes, fewer rows: some minutes")
    parser.add_argument("--resume", action="store_true", help="keep the chapters that the folder has of the same commit")
    parser.add_argument("--only", help="these chapters, with commas between them")
    parser.add_argument("-o", "--out", type=Path, default=Path("report"), help="folder to write (report)")
    return parser.parse_args(argv)


def main(argv):
    arguments = arguments_of(argv)
    arguments.build = arguments.build.resolve()
    if arguments.data:
        arguments.data = arguments.data.resolve()
        os.environ["RELUMINE_DATA"] = str(arguments.data)
    arguments.out.mkdir(parents=True, exist_ok=True)
    work = (arguments.out / "work").resolve()
    work.mkdir(exist_ok=True)
    wanted = arguments.only.split(",") if arguments.only else None
    known = ["baselines", "khronos", *(chapter.name for chapter in CHAPTERS)]
    for name in wanted or []:
        if name not in known:
            raise SystemExit(f"report: expected chapters of {', '.join(known)}, got {name}")
    about = machine(commit_of(ROOT))
    run = Run(arguments, work, about["commit"])
    for name in known:
        if wanted is not None and name not in wanted:
            continue
        if run.take_kept(name):
            continue
        if name == "baselines":
            run.baselines()
        elif name == "khronos":
            run.khronos()
        else:
            run.chapter(next(chapter for chapter in CHAPTERS if chapter.name == name))
        # After each chapter: what takes an hour is not lost when it is stopped.
        write(arguments.out, about, run)
    write(arguments.out, about, run)
    print(arguments.out / "index.html")
    return 1 if run.failed else 0


def write(out, about, run):
    (out / "index.html").write_text(page_html(about, run.chapters, run.skipped))
    chapters = [{key: value for key, value in chapter.items() if key != "body"} for chapter in run.chapters]
    (out / "figures.json").write_text(json.dumps({"machine": about, "chapters": chapters}, indent=1) + "\n")


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
