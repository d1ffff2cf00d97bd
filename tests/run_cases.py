"""Runs the cases of one test program, or of a share of its suites, in one process.

run_cases.py PROGRAM NAME SHARE OF TIMEOUT RESULTS

SHARE of OF: suites are dealt to so many shares, so that several processors have work.
A case that crashes fails; so does one that is silent while its processes work for TIMEOUT seconds of a processor, or
while they do nothing for as long. The remaining cases run in a new process. A busy machine fails no case.
RELUMINE_CASES: a regular expression; only cases whose NAME/Suite.Case has it run.
RESULTS: a file to write, with a line for each case: passed, failed or skipped, milliseconds, and its name.
Prints the output of cases that fail, why cases are skipped, and the sums. Exit code 1 when a case fails.
"""

import os
import pathlib
import re
import selectors
import signal
import subprocess
import sys
import time

STEP = re.compile(r"\[( RUN      |       OK |  FAILED  |  SKIPPED )\] ([\w/]+\.[\w/]+)(?:.* \((\d+) ms\))?")


def cases_of(program):
    """Returns the cases of each suite, in order."""
    listed = subprocess.run([program, "--gtest_list_tests"], check=True, stdout=subprocess.PIPE, text=True)
    suites = []
    for line in listed.stdout.splitlines():
        name = line.split("#")[0].rstrip()
        if name.endswith(".") and not line.startswith(" "):
            suites.append([])
            suite = name
        elif line.startswith("  ") and not re.search(r"(^|/)DISABLED_", name.strip()):
            suites[-1].append(suite + name.strip())
    return suites


def work_of(session):
    """Returns the processor seconds of a session's processes, those that have ended included."""
    ticks = 0
    for path in pathlib.Path("/proc").glob("[0-9]*/stat"):
        try:
            fields = path.read_text().rpartition(")")[2].split()
        except OSError:  # it has ended
            continue
        if int(fields[3]) == session:
            ticks += sum(map(int, fields[11:15]))
    return ticks / os.sysconf("SC_CLK_TCK")


def lines_of(process, timeout):
    """Yields lines, and None once when work or rest without a line has taken too long."""
    selector = selectors.DefaultSelector()
    selector.register(process.stdout, selectors.EVENT_READ)
    rest = b""
    at_line = work = work_of(process.pid)
    rests_since = measured = time.monotonic()
    while True:
        if not selector.select(timeout / 10):
            before, work = work, work_of(process.pid)
            if work != before:
                rests_since = time.monotonic()
            if work - at_line >= timeout or time.monotonic() - rests_since >= timeout:
                yield None
                return
            continue
        rests_since = time.monotonic()
        if rests_since - measured > timeout / 100:  # asked at every line, it costs seconds
            at_line = work = work_of(process.pid)
            measured = rests_since
        chunk = os.read(process.stdout.fileno(), 1 << 16)
        if not chunk:
            if rest:
                yield rest.decode(errors="replace")
            return
        *lines, rest = (rest + chunk).split(b"\n")
        for line in lines:
            yield line.decode(errors="replace")


class Run:
    """What has been found of all cases."""

    def __init__(self):
        self.results = {}
        self.milliseconds = {}

    def set(self, case, result, milliseconds=0):
        self.results[case] = result
        self.milliseconds[case] = int(milliseconds)

    def count(self, result):
        return sum(1 for each in self.results.values() if each == result)

    def process(self, program, cases, timeout):
        """Runs the cases in one process, up to the first that ends it."""
        environment = dict(os.environ, GTEST_FILTER=":".join(cases), GTEST_COLOR="no")
        process = subprocess.Popen([program], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, env=environment,
                                   start_new_session=True)
        current, output, is_silent = None, [], False
        for line in lines_of(process, timeout):
            if line is None:
                is_silent = True
                os.killpg(process.pid, signal.SIGKILL)
                break
            step = STEP.match(line)
            if step and step[1] == " RUN      ":
                current, output = step[2], []
            elif step and step[2] == current:
                if step[1] == "  FAILED  ":
                    print("\n".join([*output, line]), flush=True)
                elif step[1] == "  SKIPPED ":
                    print("skipped: " + current + ": " + " ".join(each.strip() for each in output[1:] or output))
                self.set(current, {"OK": "passed", "FAILED": "failed", "SKIPPED": "skipped"}[step[1].strip()],
                         step[3] or 0)
                current, output = None, []
            else:
                output.append(line)
        code = process.wait()
        left = [case for case in cases if case not in self.results]
        if left:
            ended = current or left[0]
            how = f"silent for {timeout:.0f} s" if is_silent else f"the process ended with {code}"
            print("\n".join([*output[-200:], f"[  FAILED  ] {ended} ({how})"]), flush=True)
            self.set(ended, "failed")
        elif code != 0 and not any(self.results[case] == "failed" for case in cases):
            print("\n".join([*output[-200:], f"[  FAILED  ] {cases[-1]} (the process ended with {code} after it)"]))
            self.set(cases[-1], "failed")


def main():
    program, name, share, of, timeout, results = sys.argv[1:]
    wanted = re.compile(os.environ.get("RELUMINE_CASES", ""))
    suites = cases_of(program)[int(share) - 1::int(of)]
    cases = [case for suite in suites for case in suite if wanted.search(f"{name}/{case}")]
    run = Run()
    while left := [case for case in cases if case not in run.results]:
        run.process(program, left, float(timeout))
    with open(results, "w", encoding="utf-8") as file:
        for case in cases:
            file.write(f"{run.results[case]} {run.milliseconds[case]} {name}/{case}\n")
    print(f"{run.count('passed')} passed, {run.count('failed')} failed, {run.count('skipped')} skipped")
    return 1 if run.count("failed") else 0


sys.exit(main())
