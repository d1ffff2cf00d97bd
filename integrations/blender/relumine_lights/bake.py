"""Bakes worlds in a Blender beside this one, so that nothing here waits or changes."""

import atexit
import json
import os
import queue
import subprocess
import sys
import tempfile
import threading

import bpy
import numpy as np

from .bake_worker import ANSWER

#: Seconds that a bake may take.
PATIENCE = 120.0


class Baker:
    """One process, started with the first bake. The newest wish replaces one that waits."""

    def __init__(self):
        self._process = None
        self._answers = queue.Queue()
        self._folder = None
        self._number = 0
        self._busy = None  # key that is being baked
        self._next = None  # (key, job)
        self._error = None
        self.baked = {}  # key: (height, width, 3); the newest few

    def ask(self, key, world, images, **job):
        """Wants a world baked, which uses images; take() or wait() gives the picture."""
        if key in (self._busy, self._next and self._next[0]):
            return
        self._start()
        self._number += 1
        blend = os.path.join(self._folder.name, f"{self._number}.blend")
        bpy.data.libraries.write(blend, {world}, path_remap="ABSOLUTE", fake_user=True)
        pixels = {}
        for image in images:
            if image.is_dirty and image.size[0] > 0:
                pixels[image.name] = f"{blend}.{len(pixels)}.npy"
                values = np.empty(len(image.pixels), dtype=np.float32)
                image.pixels.foreach_get(values)
                np.save(pixels[image.name], values)
        if self._next is not None:
            remove(self._next[1])
        self._next = key, {"blend": blend, "world": world.name, "pixels": pixels,
                           "output": blend + ".world.npy", **job}  # fmt: skip
        self._send()

    def take(self, key):
        """The picture of a world, or None while it is not there. Raises RuntimeError."""
        while not self._answers.empty():
            self._got(self._answers.get())
        if self._error:
            error, self._error = self._error, None
            raise RuntimeError(f"world: expected a bake, got: {error}")
        return self.baked.get(key)

    def wait(self, key):
        """take() after the bake."""
        while self.take(key) is None:
            if self._busy is None:
                raise RuntimeError("world: expected a bake, got none")
            try:
                self._got(self._answers.get(timeout=PATIENCE))
            except queue.Empty:
                self.close()
                raise RuntimeError(f"world: expected a bake within {PATIENCE:g} s") from None
        return self.baked[key]

    @property
    def is_busy(self):
        return self._busy is not None

    def close(self):
        process, self._process, self._busy, self._next = self._process, None, None, None
        if process is not None:
            process.stdin.close()
            process.kill()
            process.wait()
        if self._folder is not None:
            self._folder.cleanup()
            self._folder = None

    def _start(self):
        if self._process is not None and self._process.poll() is None:
            return
        self.close()
        self._folder = tempfile.TemporaryDirectory(prefix="relumine-")
        worker = os.path.join(os.path.dirname(os.path.abspath(__file__)), "bake_worker.py")
        if bpy.app.binary_path:
            blender = [bpy.app.binary_path, "-b", "--factory-startup", "-noaudio", "--python", worker]
        else:  # Blender is Python's module
            blender = [sys.executable, worker]
        self._process = subprocess.Popen(
            blender, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True,
        )  # fmt: skip
        threading.Thread(target=self._read, args=(self._process,), daemon=True).start()

    def _read(self, process):
        for line in process.stdout:
            if line.startswith(ANSWER):
                self._answers.put(line[len(ANSWER) :].strip())
        if process is self._process:
            self._answers.put("error Blender's process that bakes has ended")

    def _send(self):
        if self._busy is None and self._next is not None:
            self._busy, self._job = self._next
            self._next = None
            self._process.stdin.write(json.dumps(self._job) + "\n")
            self._process.stdin.flush()

    def _got(self, answer):
        key, self._busy = self._busy, None
        if answer == "done" and key is not None:
            while len(self.baked) >= 4:
                self.baked.pop(next(iter(self.baked)))
            self.baked[key] = np.load(self._job["output"])
            remove(self._job)
        elif answer != "done":
            self._error = answer[len("error ") :]
        self._send()


def remove(job):
    """Removes a job's files."""
    for path in (job["blend"], job["output"], *job["pixels"].values()):
        if os.path.exists(path):
            os.remove(path)


baker = Baker()
atexit.register(baker.close)
