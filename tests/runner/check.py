"""Checks that run_cases.py reports every case of a program, whatever the others do."""

import os
import pathlib
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).parent


def run(cases=""):
    with tempfile.TemporaryDirectory() as folder:
        results = pathlib.Path(folder) / "results"
        done = subprocess.run(
            [sys.executable, HERE.parent / "run_cases.py", HERE / "fake_program.py", "fake", "1", "1", "1", results],
            stdout=subprocess.PIPE, text=True, env=dict(os.environ, RELUMINE_CASES=cases), check=False)
        lines = [line.split() for line in results.read_text().splitlines()]
        assert all(int(milliseconds) >= 0 for _, milliseconds, _ in lines), lines
        return done.returncode, done.stdout, [f"{result} {case}" for result, _, case in lines]


code, output, lines = run()
assert code == 1, code
assert lines == ["passed fake/First.Passes", "failed fake/First.Fails", "failed fake/First.Crashes",
                 "passed fake/First.PassesBehindACrash", "skipped fake/Second.IsSkipped", "failed fake/Second.Hangs",
                 "failed fake/Second.Spins", "passed fake/Kinds/Third.Passes/one"], lines
assert output.endswith("3 passed, 4 failed, 1 skipped\n"), output
for part in ["what was expected", "First.Crashes (the process ended with -11)", "Second.Hangs (silent for 1 s)", "Second.Spins (silent for 1 s)",
             "skipped: Second.IsSkipped: what is absent"]:
    assert part in output, (part, output)
code, output, lines = run("fake/First.Pass|Third")
assert code == 0 and output == "3 passed, 0 failed, 0 skipped\n", output
