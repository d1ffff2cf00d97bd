"""Figures of the Python package: measure.py SCENE.prt ENVIRONMENT [SECONDS]

What Python adds to a relight, and how two threads relight two scenes. Best of several rounds, as
other programs can only take time."""

import sys
import threading
import time

import numpy as np

import relumine

scene = relumine.Scene.load(sys.argv[1])
seconds = float(sys.argv[3]) if len(sys.argv) > 3 else 2.0
environment = relumine.Environment.load(sys.argv[2], face_resolution=64)

relighter = relumine.Relighter(scene, clusters_only=True)
added, taken = [], []
end = time.perf_counter() + seconds
while time.perf_counter() < end:
    start = time.perf_counter()
    times = relighter.set_environment(environment)
    relighter.radiance
    taken.append(time.perf_counter() - start)
    added.append(taken[-1] - times.seconds_bin - times.seconds_relight - times.seconds_trace)
print(f"{scene}: a relight takes {1e3 * min(taken):.2f} ms; "
      f"Python adds {1e3 * min(added):.3f} ms")  # fmt: skip

relumine.set_threads(1)
relighters = [relumine.Relighter(scene, clusters_only=True) for _ in range(2)]


def rate(count):
    """Relights a second of so many threads."""
    done = [0] * count
    stop = time.perf_counter() + seconds / 2

    def work(index):
        while time.perf_counter() < stop:
            relighters[index].set_environment(environment)
            done[index] += 1

    threads = [threading.Thread(target=work, args=(index,)) for index in range(count)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    return sum(done) / (seconds / 2)


rounds = [(rate(1), rate(2)) for _ in range(5)]
one, two = max(r[0] for r in rounds), max(r[1] for r in rounds)
print(f"one thread {one:.0f} relights a second, two threads on two scenes {two:.0f}: "
      f"{two / one:.2f} times")  # fmt: skip
