"""The light of objects that have moved, on its way to where they stand now."""

import threading
import time
from collections import namedtuple

#: Of an object: its name, the matrix in Relumine's axes that leads there from where its light is
#: that of, and where it stands.
Way = namedtuple("Way", "name matrix place")


def listed(names):
    """A few names, and how many others."""
    return ", ".join(names) if len(names) <= 3 else f"{names[0]} and {len(names) - 1} others"


class Following:
    """Moves groups of a scene in light, all in one go, beside the user's work or while the caller
    waits. `relighter` is that scene, which nobody else may use meanwhile; `ways` are {first vertex
    of the object: Way}."""

    def __init__(self, relighter, ways):
        self.fraction, self.seconds, self.error = 0.0, 0.0, None
        #: What came about: {first vertex: place}, and {first vertex: (place, why it stayed)}.
        self.places, self.refused = {}, {}
        self._relighter, self._ways, self._told = relighter, ways, None
        self._is_cancelled = False
        self._thread = threading.Thread(target=self._run, daemon=True)

    def __str__(self):
        names = listed([way.name for way in self._ways.values()])
        return f"Light follows {names}: {100 * self.fraction:.0f} %"

    @property
    def names(self):
        return {way.name for way in self._ways.values()}

    @property
    def is_busy(self):
        return self._thread.is_alive()

    def start(self):
        self._thread.start()

    def finish(self, progress=None):
        """Waits for it, or does it now. `progress` is told the fraction then."""
        if self._thread.ident is not None:
            self._thread.join()
        else:
            self._told = progress
            self._run()

    def cancel(self):
        self._is_cancelled = True

    def _run(self):
        start = time.monotonic()
        try:
            try:
                self._move(self._ways)
            except ValueError:  # of one of them, which does not keep the others
                for first, way in self._ways.items():
                    try:
                        self._move({first: way})
                    except ValueError as error:
                        self.refused[first] = way.place, str(error)
        except Exception as error:  # told by finish()'s caller
            self.error = None if self._is_cancelled else error
        self.seconds = time.monotonic() - start

    def _move(self, ways):
        matrices = {str(first): way.matrix for first, way in ways.items()}
        self._relighter.move(matrices, progress=self._tell)
        self.places.update({first: way.place for first, way in ways.items()})

    def _tell(self, fraction):
        self.fraction = fraction
        if self._told is not None:
            self._told(fraction)
        if self._is_cancelled:
            raise RuntimeError("cancelled")
