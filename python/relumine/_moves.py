"""Groups of a scene in light that move."""

from __future__ import annotations

from typing import Mapping, NamedTuple, Optional, Union

from numpy.typing import ArrayLike

from . import _core
from ._arrays import doubles, expect, word
from ._files import errors
from ._mesh import Mesh
from ._scene import Moves, Progress, moves_of


class Move(NamedTuple):
    """What a move of a group changed, and what it took."""

    #: That went along.
    receivers: int
    #: Of blocks of 16 receivers and clusters: counted anew, with other counts, all that there are.
    pairs: int
    pairs_changed: int
    pairs_all: int
    rays: int
    #: Something is now outside of the box that held the scene.
    leaves_box: bool
    seconds_bounces: float
    seconds: float


class Moving:
    """What a Relighter does with groups of its scene."""

    # Whether the scene that is lit may be another one by now: groups have moved.
    _has_moved = False

    @property
    def _core(self) -> _core.Relighter:
        raise NotImplementedError

    def _require_light(self) -> None:
        raise NotImplementedError

    def move(
        self,
        name: Union[str, Mapping[str, ArrayLike]],
        matrix: Optional[ArrayLike] = None,
        *,
        progress: Optional[Progress] = None,
    ) -> Move:
        """Moves a group of the scene, as Scene.move(), and lights the scene again by its light.

        name    a group of a scene that was precomputed with movable=True, or several at once, in
                less time than one after the other: {name: matrix, ...} without `matrix`. They are
                one step of undo_move()
        matrix  (4, 4): from its present place to the next one, for columns (x, y, z, 1), in the
                coordinates of the mesh's file with Y up

        `radiance` is that of another Relighter of the moved scene, bit by bit, bounces included.
        The Scene that was given stays as it is: `relighter.scene` is the moved one.

        Raises ValueError as Scene.move(), RuntimeError where a blockers_function blocks the light.
        """
        return self._move(moves_of(name, matrix), progress)

    def pose(self, name: str, mesh: Mesh, *, progress: Optional[Progress] = None) -> Move:
        """Lets a group take another pose, as Scene.pose()."""
        expect("mesh", mesh, Mesh)
        return self._move({word("name", name): mesh._core}, progress)

    def remove(self, name: str, *, progress: Optional[Progress] = None) -> Move:
        """Takes a group away, as Scene.remove()."""
        return self._move({word("name", name): "away"}, progress)

    def restore(self, name: str, *, progress: Optional[Progress] = None) -> Move:
        """Brings a group back that was taken away, to where it stood."""
        return self._move({word("name", name): "back"}, progress)

    def drag(self, name: str, matrix: ArrayLike) -> Move:
        """Shows a group on its way, some ten times a second: `radiance` for the eye, until drop().

        matrix  (4, 4): as move(), from where the group stood when the drag began

        The first call takes as long as a move. Clusters with little light are sampled in their
        middle alone, and bounced light stays as it was. A drag of another group, move() and
        undo_move() take the drag back first.

        >>> mesh = relumine.Mesh.load("boulder.ply", floor=20)
        >>> scene = relumine.precompute(mesh, tolerance=0.05, bounces=False, movable=True)
        >>> lit = relumine.Relighter(scene)
        >>> _ = lit.set_environment(environment)
        >>> shifted = np.eye(4)
        >>> for x in (0.1, 0.2, 0.3):
        ...     shifted[0, 3] = x
        ...     _ = lit.drag("mesh", shifted)
        >>> lit.drop().receivers > 0
        True
        """
        rows = doubles("matrix", matrix, 4, 4)
        self._require_light()
        with errors():
            result = Move(**self._core.drag(word("name", name), rows))
        self._has_moved = True
        return result

    def drop(self, *, progress: Optional[Progress] = None) -> Move:
        """Moves the group that is dragged to where it is, as move(). One step of undo_move().

        Raises RuntimeError where nothing is dragged.
        """
        self._has_moved = True
        with errors():
            return Move(**self._core.drop(progress))

    def undo_move(self) -> bool:
        """Takes a drag back, or undoes the last move. Whether there was one; the last 32 are kept."""
        self._has_moved = True
        with errors():
            return self._core.exchange_move(True)

    def redo_move(self) -> bool:
        """Makes the last move again that was undone. Whether there was one."""
        self._has_moved = True
        with errors():
            return self._core.exchange_move(False)

    def _move(self, moves: Moves, progress: Optional[Progress]) -> Move:
        with errors():
            result = Move(**self._core.move(moves, progress))
        self._has_moved = True
        return result
