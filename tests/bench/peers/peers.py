#!/usr/bin/env python3
"""Relumine beside Mitsuba, Cycles, LuxCore, Radiance and three-gpu-pathtracer: `./dev bench peers`.

    peers.py [--quick] [--only truth,time,gradients,skies] [--peers Mitsuba,Cycles] [--scenes bunny,room] [--folder DIR]

The peers are Python packages of the versions below, in virtual environments in --folder, which the
first run makes (2 GB). Each runs in a process of its own. three-gpu-pathtracer runs where it is
named, by npm and Debian's chromium, chromium-driver and python3-selenium. Prints tables.
"""
import argparse
import os
import pickle
import subprocess
import shutil
import sys
import time
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[2]
#: Peer: its module, and the packages of its environment. Blender 5.2 asks for Python 3.13, 5.0 for 3.11.
PEERS = {
    "Relumine": ("relumine_peer", []),
    "Mitsuba": ("mitsuba_peer", ["mitsuba==3.9.1", "numpy==1.26.4"]),
    "Cycles": ("cycles_peer", {"python3.13": ["bpy==5.2.3", "OpenEXR==3.5.3"], "python3.11": ["bpy==5.0.1", "OpenEXR==3.5.3"]}),
    "LuxCore": ("luxcore_peer", ["pyluxcore==2.11.2", "numpy==1.26.4"]),
    "Radiance": ("radiance_peer", ["pyradiance==1.3.1", "numpy==1.26.4"]),
    # Of packages/web-test.txt and of npm; for truth alone.
    "three-gpu-pathtracer": ("three_peer", []),
}


def python_of(name, folder):
    """The Python that has a peer's packages; they are installed where they are not yet."""
    packages = PEERS[name][1]
    if not packages:
        return "/usr/bin/python3"
    base = sys.executable
    if isinstance(packages, dict):
        base = next((found for each in packages if (found := shutil.which(each)) and works(found)), None)
        if base is None:
            raise SystemExit(f"peers: expected one of {', '.join(packages)} for {name}, found none")
        packages = next(rows for each, rows in packages.items() if os.path.basename(base) == each)
    made = folder / "-".join(packages[0].split("=="))
    python = made / "bin" / "python"
    if not (made / "ready").exists():
        print(f"installing {' '.join(packages)}", file=sys.stderr)
        subprocess.run([base, "-m", "venv", "--clear", str(made)], check=True)
        subprocess.run([str(python), "-m", "pip", "install", "-q", *packages], check=True)
        (made / "ready").touch()
    return str(python)


def works(python):
    """Whether it starts: a name on the PATH may be a stub."""
    return subprocess.run([python, "-c", "import venv"], capture_output=True).returncode == 0


class Peer:
    """A peer in its process. Its functions are calls: peer.picture(64)."""

    def __init__(self, name, folder):
        self.name = name
        python = python_of(name, folder)
        paths = [str(HERE), os.environ.get("PYTHONPATH") or str(ROOT / "build" / "release" / "python")]
        self._log = open(folder / f"{name}.log", "w")
        self._process = subprocess.Popen(
            [python, str(HERE / "worker.py"), PEERS[name][0]], stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=self._log,
            env={**os.environ, "PYTHONPATH": os.pathsep.join(paths)}, cwd=folder,
        )  # fmt: skip
        #: What the last call took.
        self.processor = self.seconds = self.peak = 0.0
        #: Processor seconds of all calls.
        self.spent = 0.0

    def __getattr__(self, function):
        def call(*arguments):
            pickle.dump((function, arguments), self._process.stdin, protocol=4)
            self._process.stdin.flush()
            result, self.processor, self.seconds, self.peak = pickle.load(self._process.stdout)
            self.spent += self.processor
            if isinstance(result, Exception):
                raise result
            return result

        return call

    def close(self):
        self._process.stdin.close()
        self._process.wait()
        self._log.close()


def main():
    import equal_error
    import gradients
    import skies
    import truth

    judges = {"truth": truth.run, "time": lambda *both: equal_error.run(*both, given.scenes.split(",")), "gradients": gradients.run, "skies": skies.run}
    parser = argparse.ArgumentParser(prog="./dev bench peers", description=__doc__.splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="fewer rows and samples: ten minutes")
    parser.add_argument("--only", default=",".join(judges), help="judges, with commas between them")
    parser.add_argument("--peers", default=",".join(name for name in PEERS if PEERS[name][1] or name == "Relumine"), help="those to run, with commas between them")
    parser.add_argument("--scenes", default=",".join(equal_error.SCENES), help="those of time, with commas between them")
    parser.add_argument("--folder", type=Path, default=ROOT / "build" / "peers", help="where environments and logs go (build/peers)")
    given = parser.parse_args()
    for wanted, known in ((given.only, judges), (given.peers, PEERS), (given.scenes, equal_error.SCENES)):
        for name in wanted.split(","):
            if name not in known:
                raise SystemExit(f"peers: expected {', '.join(known)}, got {name}")
    folder = given.folder.resolve()
    folder.mkdir(parents=True, exist_ok=True)
    peers = [Peer(name, folder) for name in given.peers.split(",")]
    print(", ".join(f"{peer.name} {peer.version()}" for peer in peers), flush=True)
    for name in given.only.split(","):
        start, used = time.perf_counter(), sum(peer.spent for peer in peers)
        judges[name](peers, given.quick)
        print(f"\n{name}: {time.perf_counter() - start:.0f} s, {sum(peer.spent for peer in peers) - used:.0f} processor seconds", flush=True)
    for peer in peers:
        peer.close()


if __name__ == "__main__":
    main()
