#!/usr/bin/env python3
"""A test program as run_cases.py sees one: a case of each kind."""

import os
import signal
import sys
import time

CASES = ["First.Passes", "First.Fails", "First.Crashes", "First.PassesBehindACrash", "Second.IsSkipped",
         "Second.Hangs", "Second.Spins", "Kinds/Third.Passes/one"]

if "--gtest_list_tests" in sys.argv:
    print("First.\n  Passes\n  Fails\n  Crashes\n  PassesBehindACrash\n  DISABLED_Never\nSecond.\n  IsSkipped\n  Hangs\n"
          "  Spins\n"
          "Kinds/Third.\n  Passes/one  # GetParam() = one")
    sys.exit(0)
wanted = os.environ["GTEST_FILTER"].split(":")
for case in [each for each in CASES if each in wanted]:
    print(f"[ RUN      ] {case}", flush=True)
    result = "      OK"
    if case.endswith("Fails"):
        print("what was expected")
        result = " FAILED "
    elif case.endswith("Crashes"):
        os.kill(os.getpid(), signal.SIGSEGV)
    elif case.endswith("Hangs"):
        time.sleep(60)
    elif case.endswith("Spins"):
        while True:
            pass
    elif case.endswith("IsSkipped"):
        print("file.cpp:1: Skipped\nwhat is absent")
        result = " SKIPPED"
    print(f"[ {result} ] {case} (0 ms)", flush=True)
