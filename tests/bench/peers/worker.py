"""One peer in a process of its own: reads calls from stdin, writes what they return to stdout.

    python worker.py MODULE

A call is a pickled (name, arguments); the answer (result or error, processor seconds of this process
and its children, wall seconds, peak bytes). What libraries print goes to stderr.
"""
import copyreg
import importlib
import os
import pickle
import resource
import sys
import time
import traceback

import numpy as np

import scenes


def processor():
    return sum(
        usage.ru_utime + usage.ru_stime
        for usage in (resource.getrusage(resource.RUSAGE_SELF), resource.getrusage(resource.RUSAGE_CHILDREN))
    )


def main():
    # Peers have their own versions of numpy, which do not read each other's pickles.
    copyreg.pickle(np.ndarray, lambda array: (scenes.array, (array.tobytes(), array.dtype.str, array.shape)))
    answers = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)
    peer = importlib.import_module(sys.argv[1])
    state = None
    while True:
        try:
            name, arguments = pickle.load(sys.stdin.buffer)
        except EOFError:
            os._exit(0)  # pyluxcore logs while Python ends, and aborts
        start, used = time.perf_counter(), processor()
        try:
            result = getattr(peer, name)(*([] if name in ("version", "build") else [state]), *arguments)
            if name == "build":
                state, result = result, None
        except Exception:  # the other side says where it came from
            result = RuntimeError(traceback.format_exc())
        peak = 1024 * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        pickle.dump((result, processor() - used, time.perf_counter() - start, peak), answers, protocol=4)
        answers.flush()


main()
