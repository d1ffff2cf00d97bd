"""Prints the slowest cases, those that were skipped, and "N passed, N failed, N skipped" for all of a run of ctest.

closing.py BUILD JUNIT: BUILD has tests/cases_*.txt of run_cases.py; JUNIT is what ctest --output-junit wrote.
Exit code 1 when nothing ran.
"""

import pathlib
import sys
import xml.etree.ElementTree as xml

build, junit = map(pathlib.Path, sys.argv[1:])
counts = {"passed": 0, "failed": 0, "skipped": 0}
seconds = {}


def count(result, name):
    counts[result] += 1
    if result != "passed":
        print(f"{result}: {name}")


for test in xml.parse(junit).getroot().iter("testcase"):
    name, status = test.get("name"), test.get("status")
    if name.startswith("cases/"):
        cases = build / "tests" / (name.replace("/", "_") + ".txt")
        lines = cases.read_text().splitlines() if cases.exists() else []
        for line in lines:
            result, milliseconds, case = line.split(" ", 2)
            seconds[case] = int(milliseconds) / 1000
            count(result, case)
        if status == "fail" and not any(line.startswith("failed ") for line in lines):
            count("failed", name)
    else:
        seconds[name] = float(test.get("time"))
        count({"run": "passed", "fail": "failed"}.get(status, "skipped"), name)
for name in sorted(seconds, key=seconds.get, reverse=True)[:10]:
    print(f"{seconds[name]:6.1f} s: {name}")
print("{passed} passed, {failed} failed, {skipped} skipped".format(**counts))
sys.exit(0 if sum(counts.values()) else 1)
