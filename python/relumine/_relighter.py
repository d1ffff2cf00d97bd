"""Scenes in light."""

from __future__ import annotations

import os
from typing import Any, Dict, Iterator, List, Mapping, NamedTuple, Optional, Sequence, Tuple, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core
from ._arrays import Floats, Indices, doubles, expect, floats, indices, real, view, whole
from ._blockers import BlockersFunction, asked
from ._environment import Environment, _options
from ._files import Path, errors
from ._layers import Layer, Region, naming_layers, parsed, region_text, text_of
from ._lights import LightList
from ._mesh import warn
from ._moves import Moving
from ._picture import Picture, with_picture_options
from ._scene import Color, Progress, Scene

#: Names of the cube's faces, in the order of `Environment.cube`.
FACES = ("+x", "-x", "+y", "-y", "+z", "-z")

# Environments that are in memory at once.
_BATCH = 32


class RelightTimes(NamedTuple):
    """What a relight took."""

    seconds_bin: float
    seconds_relight: float
    seconds_trace: float
    sharp_lights: int


class Update(NamedTuple):
    """What an edit changed, and what it took."""

    clusters: int
    receivers: int
    sharp_lights: int
    seconds: float
    seconds_trace: float
    #: All clusters were summed, because that was less work.
    resummed: bool


class Bounces(NamedTuple):
    """What bouncing light took."""

    bounces: int
    error: float
    seconds: float


class Verification(NamedTuple):
    """How far the radiance is from exact integration; errors are relative to the mean radiance."""

    relative_l2: float
    mean_abs: float
    max_abs: float
    bias: float
    mean_radiance: float
    worst_receiver: int
    #: The part of relative_l2 that is noise of the paths that bounces are compared with.
    noise: float
    #: The file's pixels were integrated, not the cube map's texels.
    of_file: bool
    #: The largest relative_l2: at the vertices, between them, or in a picture of the whole mesh.
    worst: float
    worst_place: str
    #: The receivers that were looked at.
    receivers: Indices


class Share(NamedTuple):
    """What a part of the environment gives."""

    #: (num_receivers, 3)
    radiance: Floats
    #: (6, R, R, 3): the environment, black outside of the region
    environment: Floats
    #: The part of all reflected light, 0 to 1.
    share: float


class FittedEnvironment(NamedTuple):
    """The environment under which a scene comes nearest to how it should look."""

    environment: Environment
    #: How far the scene's light then is from what is wanted: relative L2.
    distance: float


class FittedLights(NamedTuple):
    """The lights under which a scene comes nearest to how it should look."""

    lights: LightList
    #: How far the scene's light then is from what is wanted: relative L2.
    distance: float


class Frame(NamedTuple):
    """One frame of an animation."""

    number: int
    path: str
    #: (num_receivers, 3), a copy that stays as it is
    radiance: Floats


def _environment(value: Environment) -> _core.Environment:
    hint = ""
    if isinstance(value, np.ndarray):
        hint = ": relumine.Environment(array) makes one"
    elif isinstance(value, (str, os.PathLike)):
        hint = ": relumine.Environment.load() reads a file"
    expect("environment", value, Environment, hint)
    return value._core


class Relighter(Moving):
    """A scene under light, which may change.

    clusters_only  lights the sun through its cluster too, without shadow rays: faster, softer
    harmonics      2 or 3: keeps the arriving light as `harmonics` of this order; 0: none
    highlight_rays  of a pixel whose highlights are not stored: rays that find them; 0: none, as the
                   adjoint asks
    blockers_function  what keeps sharp lights away, as in precompute(); None: the scene's own
    surface_albedo, surface_specular, surface_roughness  as Scene.recolored()

    Calls release Python's lock, so that threads relight at the same time; two threads on one
    Relighter take turns. A pickle holds the scene and its light as it is, without marks.

    >>> relighter = relumine.Relighter(scene)
    >>> relighter.set_environment(environment).seconds_relight < 1
    True
    >>> relighter.radiance.shape
    (6912, 3)
    """

    def __init__(
        self,
        scene: Scene,
        *,
        clusters_only: bool = False,
        harmonics: int = 0,
        highlight_rays: int = _core.HIGHLIGHT_RAYS,
        blockers_function: Optional[BlockersFunction] = None,
        surface_albedo: Optional[Color] = None,
        surface_specular: Optional[Color] = None,
        surface_roughness: Optional[float] = None,
    ) -> None:
        hint = ": relumine.precompute() makes one of a mesh, Scene.load() reads a .prt file"
        expect("scene", scene, Scene, hint)
        if (surface_albedo, surface_specular, surface_roughness) != (None, None, None):
            scene = scene.recolored(
                surface_albedo=surface_albedo,
                surface_specular=surface_specular,
                surface_roughness=surface_roughness,
            )
        self._scene = scene
        self._clusters_only = clusters_only
        self._highlight_rays = highlight_rays
        # What lights it, where it is more than a map: an environment, or a list.
        self._given: Union[Environment, LightList, None] = None
        # The last bounce() of the present light.
        self._bouncing: Optional[Dict[str, Any]] = None
        if harmonics not in (0, 2, 3):
            raise ValueError(f"harmonics: expected 0, 2 or 3, got {harmonics!r}")
        self._order = harmonics
        self._blockers = scene.blockers_function
        if blockers_function is not None:
            self._blockers = blockers_function
        self._lit: Optional[_core.Relighter] = _core.Relighter(
            scene._core,
            clusters_only,
            harmonics,
            whole("highlight_rays", highlight_rays),
            asked(self._blockers),
        )

    @property
    def scene(self) -> Scene:
        """The scene that is lit. After a move it is a copy of the scene as it stands then."""
        if self._has_moved:
            self._scene, self._has_moved = Scene._of(self._core.scene()), False
        return self._scene

    @property
    def _core(self) -> _core.Relighter:
        if self._lit is None:
            raise RuntimeError("expected a relighter that is open, got one that was closed")
        return self._lit

    def _require_light(self) -> None:
        if not self._core.is_lit:
            raise RuntimeError(
                "expected a scene that is lit, got one without light: set_environment() comes first"
            )

    def _require_triangles(self) -> None:
        if self._blockers is not None:
            raise RuntimeError("expected a scene without a blockers_function: triangles are asked")

    def close(self) -> None:
        """Frees the memory. A `with` statement does so at its end."""
        self._lit = None

    def _options(self) -> Dict[str, Any]:
        """What another relighter of the scene is made with to be like this one."""
        return {
            "clusters_only": self._clusters_only,
            "harmonics": self._order,
            "highlight_rays": self._highlight_rays,
            "blockers_function": self._blockers,
        }

    def __reduce__(self) -> Any:
        options = self._options()
        light, layers, degrees = self._given, "[]", 0.0
        if self._core.is_lit and not isinstance(light, LightList):
            base, degrees = self._core.base()
            cube: Floats = view(base)
            light = light or Environment(cube, face_resolution=cube.shape[1])
            layers = self._core.layers()
        return _relighter_from, (self.scene, options, light, layers, degrees, self._bouncing)

    def __enter__(self) -> "Relighter":
        return self

    def __exit__(self, *details: object) -> None:
        self.close()

    # Light

    def set_environment(self, environment: Environment) -> RelightTimes:
        """Lights the scene with an environment. Layers stay over it."""
        times = RelightTimes(*self._core.set_environment(_environment(environment)))
        self._given, self._bouncing = environment, None
        return times

    def update_environment(self, environment: Environment) -> Update:
        """Replaces the environment and updates what differs; all where the resolution does."""
        update = Update(*self._core.update_environment(_environment(environment)))
        self._given = environment
        return update

    def set_lights(self, lights: LightList) -> RelightTimes:
        """Lights the scene with distant lights alone, each with a shadow ray per receiver."""
        expect("lights", lights, LightList)
        times = RelightTimes(*self._core.set_lights(*lights._arrays()))
        self._given, self._bouncing = lights, None
        return times

    def update_region(
        self, face: Union[int, str], x: int, y: int, radiance: ArrayLike
    ) -> Update:
        """Replaces a rectangle of the environment's texels, and updates what depends on it.

        face      0 to 5, or "+x", "-x", "+y", "-y", "+z", "-z"
        x, y      column and row of the first texel
        radiance  (height, width, 3)

        >>> relighter.update_region("+x", 4, 4, np.full((2, 3, 3), 5.0)).clusters > 0
        True
        """
        self._require_light()
        if isinstance(face, str):
            if face not in FACES:
                raise ValueError(f"face: expected {', '.join(FACES)}, got {face!r}")
            face = FACES.index(face)
        values = floats("radiance", radiance, None, None, 3)
        height, width, _ = values.shape
        face, x, y = whole("face", face, most=5), whole("x", x), whole("y", y)
        update = Update(*self._core.update_region(face, x, y, width, height, values))
        self._given = None
        return update

    @property
    def radiance(self) -> Floats:
        """(num_receivers, 3) float32: outgoing radiance, for albedo 1 unless there are materials.

        A read-only view without a copy: it shows the light of the present, after the next change
        too. radiance.copy() keeps it.
        """
        self._require_light()
        result: Floats = view(self._core.radiance)
        return result

    @property
    def environment(self) -> Floats:
        """(6, R, R, 3) float32: what lights the scene, layers included. A copy."""
        result: Floats = view(self._core.environment())
        return result

    def bounce(
        self,
        bounces: Optional[int] = None,
        *,
        albedo: Union[Color, str, None] = None,
        floor_albedo: Optional[Color] = None,
    ) -> Bounces:
        """Adds the light that surfaces send to each other, for the present light.

        bounces  how often light goes on; None: until the rest is below 0.1 %
        albedo   of the surfaces, as in picture()

        The command line adds all bounces where the scene was made for them; here they are asked
        for. A new environment or list takes them away again. Layers show their direct light with
        the bounces of the light before, until the next call.

        Raises ValueError for a scene that was made without `bounces`.
        """
        options = {"albedo": albedo, "floor_albedo": floor_albedo}
        if bounces is not None:
            bounces = whole("bounces", bounces)
        with errors():
            result = Bounces(*self._core.bounce(bounces, options))
        self._bouncing = {"bounces": bounces, **options}
        return result

    @property
    def bounced(self) -> Floats:
        """(num_receivers, 3) float32: the part of `radiance` that bounce() added. A copy.

        (0, 3) where no bounces were added to the present light.
        """
        result: Floats = view(self._core.bounced())
        return result

    def towards(self, eye: Sequence[float], *, tolerance: float = 0.01) -> Floats:
        """(num_receivers, 3) float32: `radiance` with the highlights that an eye sees. A copy.

        For vertices with glossy materials that were precomputed without `view`: nothing is stored
        for the eye, so it may go anywhere, in milliseconds. Receivers that face away from the eye
        have no highlight. It shows the present light, bounces of bounce() included.

        eye        x, y, z, as in the mesh's file
        tolerance  relative L2 error, as a part of what a white matt surface sends

        Raises ValueError for a scene without such highlights.
        """
        self._require_light()
        x, y, z = (float(each) for each in doubles("eye", eye, 3))
        tolerance = real("tolerance", tolerance)
        if not 1e-5 <= tolerance <= 1.0:
            raise ValueError(f"tolerance: expected 1e-5 to 1, got {tolerance}")
        with errors():
            result: Floats = view(self._core.towards((x, y, z), tolerance))
        return result

    @property
    def harmonics(self) -> Floats:
        """(num_receivers, 4 or 9, 3) float32: the light that arrives, for any normal. A copy.

        Spherical harmonics of radiance: real, orthonormal, y z x for the first band. irradiance()
        makes the light of normals from them.

        >>> with relumine.Relighter(scene, harmonics=3) as lit:
        ...     _ = lit.set_environment(environment)
        ...     lit.harmonics.shape
        (6912, 9, 3)
        """
        if self._order == 0:
            raise RuntimeError(
                "expected a relighter with harmonics, got one without: Relighter(scene, harmonics=3)"
            )
        self._require_light()
        result: Floats = view(self._core.harmonics())
        return result

    def save_harmonics(self, path: Path) -> None:
        """Writes `harmonics`: .npy, .exr (layers; not of vertices), .json (points: three.js)."""
        with errors(path):
            self._core.save_harmonics(os.fspath(path))

    # Layers

    @property
    def layers(self) -> List[Layer]:
        """The light layers over the environment, the lowest first. Copies."""
        return parsed(self._core.layers())

    def set_layers(self, layers: Sequence[Union[Layer, Mapping[str, Any]]]) -> Update:
        """Replaces all layers; only what differs is relit.

        >>> key = relumine.Layer("key", relumine.Disc((1, 1, 1), 20), relumine.Emit((4, 4, 4)))
        >>> relighter.set_layers([key]).clusters > 0
        True
        """
        self._require_light()
        with naming_layers():
            return Update(*self._core.set_layers(text_of(layers)))

    def set_layer(
        self, index: Union[int, str], layer: Union[Layer, Mapping[str, Any]]
    ) -> Update:
        """Replaces one layer, given by its place or its name, as while it is dragged."""
        if isinstance(index, str):
            names = [layer.name for layer in self.layers]
            if index not in names:
                raise ValueError(f"index: expected one of the layers {names}, got {index!r}")
            index = names.index(index)
        if whole("index", index, -(2**31)) < 0:
            raise IndexError(f"index: expected the place of a layer, got {index}")
        with naming_layers():
            return Update(*self._core.set_layer(index, text_of([layer])))

    def set_rotation(self, degrees: float, moving: bool = False) -> Update:
        """Turns the environment and its layers about +Y: light from +Z comes from +X at 90.

        It stays for environments that are set later. `moving`, for a slider while it moves, turns a
        map of at most 128 texels along a face's edge: some fifteen times as quick for fine maps, within
        1 %. Any other edit, mark() included, brings the whole map back.
        """
        self._require_light()
        return Update(*self._core.set_rotation(real("degrees", degrees), bool(moving)))

    def mark(self) -> None:
        """Marks the present layers and environment as a state that undo() comes back to."""
        self._require_light()
        self._core.mark()

    def undo(self) -> Update:
        """Goes back to the mark before. The radiance is what it was, bit by bit."""
        self._given = None
        return Update(*self._core.undo())

    def redo(self) -> Update:
        """Goes to the mark after."""
        self._given = None
        return Update(*self._core.redo())

    @property
    def can_undo(self) -> bool:
        """Whether undo() goes back: there is an edit without a mark, or a mark before."""
        return self._core.history()[0]

    @property
    def can_redo(self) -> bool:
        """Whether there is a mark after the present one."""
        return self._core.history()[1]

    # Questions

    def verify(
        self,
        samples: int = 2000,
        *,
        surface: int = 500,
        seed: int = 1,
        paths: int = 256,
        progress: Optional[Progress] = None,
    ) -> Verification:
        """Compares the radiance with exact integration, every shadow ray traced.

        samples  receivers chosen at random; 0: all
        surface  points between the vertices, and as many of a picture, for `worst`; 0: none

        >>> relighter.verify(20, surface=20).relative_l2 < 0.2
        True
        """
        self._require_triangles()
        found = self._core.verify(
            whole("samples", samples),
            whole("surface", surface),
            whole("seed", seed, most=2**64 - 1),
            whole("paths", paths),
            progress,
        )
        found["receivers"] = view(found["receivers"])
        return Verification(**found)

    def contribution_map(self, receivers: ArrayLike) -> Floats:
        """What lights these receivers: (6, R, R, 3), radiance per sr.

        The environment, each texel weighted by how much of it they reflect. Its integral over the
        sphere is the mean of their radiance.

        >>> relighter.contribution_map(scene.nearest_receiver((0, 1, 0))).ndim
        4
        """
        chosen = np.atleast_1d(np.asarray(receivers))
        places = indices("receivers", chosen, self._scene.num_receivers, None)
        result: Floats = view(self._core.contribution_map(places))
        return result

    def relight_batch(
        self, environments: ArrayLike, out: Optional[NDArray[Any]] = None
    ) -> NDArray[Any]:
        """The radiance under many environments: (B, num_receivers, 3) float32.

        environments  (B, 6, R, R, 3): cube faces as Environment.cube has them
        out           an array of that shape to write to, float32, float16 or any other float

        The relighter's own light stays as it is, and layers do not count. Direct light alone.

        >>> relighter.relight_batch(np.ones((2, 6, 8, 8, 3))).shape
        (2, 6912, 3)
        """
        count, resolution = _batch_of(environments)
        out = _output_array(out, (count, self._scene.num_receivers, 3))
        for first in range(0, count, _BATCH):
            part = np.asarray(environments)[first : first + _BATCH]
            cubes = floats("environments", part, None, 6, resolution, resolution, 3)
            with errors():
                core = self._core.relight_batch(cubes, len(cubes), resolution)
            out[first : first + _BATCH] = view(core)
        return out

    @with_picture_options
    def picture_batch(
        self,
        environments: ArrayLike,
        out: Optional[NDArray[Any]] = None,
        *,
        bounces: Optional[int] = 0,
        **options: Any,
    ) -> NDArray[Any]:
        """The pictures under many environments: (B, H, W, 3 or 4) float32, as picture() gives them.

        environments  (B, 6, R, R, 3): cube faces as Environment.cube has them
        out           an array of that shape to write to, float32, float16 or any other float
        bounces       as bounce() takes them; 0: direct light

        The relighter's own light stays as it is, and layers do not count.

        >>> relighter.picture_batch(np.ones((2, 6, 8, 8, 3)), size=(32, 24)).shape
        (2, 24, 32, 3)
        """
        count, resolution = _batch_of(environments)
        with Relighter(self._scene, **self._options()) as own:
            for i in range(count):
                cube = np.asarray(environments[i])  # type: ignore[index]
                own.set_environment(Environment(cube, face_resolution=resolution))
                if bounces != 0:
                    own.bounce(
                        bounces,
                        albedo=options.get("albedo"),
                        floor_albedo=options.get("floor_albedo"),
                    )
                picture = np.asarray(own.picture(**options))
                if i == 0:
                    out = _output_array(out, (count, *picture.shape))
                out[i] = picture  # type: ignore[index]
        assert out is not None
        return out

    def adjoint(self, weights: ArrayLike, *, size: Optional[Tuple[int, int]] = None) -> Floats:
        """The transpose of a relight: (6, R, R, 3), the derivative of a loss by each texel.

        weights  (num_receivers, 3), or (num_receivers,) for all channels alike: the derivative of
                 the loss by `radiance`
        size     (width, height): the derivative by the pixels of a lat-long in the world's axes,
                 (height, width, 3). Give its Environment a face_resolution: it keeps R

        It takes two to three relights. After bounce() light that bounces counts. For the
        present environment, (environment * adjoint(w)).sum() is (radiance * w).sum().

        >>> gradient = relighter.adjoint(np.ones(scene.num_receivers))
        >>> total = (relighter.environment * gradient).sum(dtype=float)
        >>> bool(np.isclose(total, relighter.radiance.sum(dtype=float), rtol=1e-4))
        True
        """
        count = self._scene.num_receivers
        if np.ndim(weights) == 1:
            weights = np.repeat(np.asarray(weights)[:, None], 3, axis=1)
        values = floats("weights", weights, count, 3)
        self._require_light()
        with errors():
            gradient = self._core.adjoint(values)
        result: Floats = view(gradient)
        if size is None:
            return result
        width, height = (whole("size", side, 1, 2**15) for side in size)
        pixels: Floats = view(_core.lat_long_adjoint(gradient, result.shape[1], width, height))
        return pixels

    @with_picture_options
    def picture_adjoint(self, weights: ArrayLike, **options: Any) -> Floats:
        """The same for picture(background="none") of a scene of pixels: (6, R, R, 3).

        weights  (height, width, 3): the derivative of the loss by the picture's linear pixels

        Receivers light the picture, with the albedo of the options.
        """
        values = floats("weights", weights, None, None, 3)
        height, width, _ = values.shape
        self._require_light()
        with errors():
            result: Floats = view(
                self._core.picture_adjoint(
                    values.reshape(-1, 3), height, width, _output(options)
                )
            )
        return result

    def harmonics_adjoint(self, weights: ArrayLike) -> Floats:
        """The same for `harmonics`: (6, R, R, 3), the derivative of a loss by each texel.

        weights  (num_receivers, 4 or 9, 3): the derivative of the loss by `harmonics`

        >>> with relumine.Relighter(scene, harmonics=2) as lit:
        ...     _ = lit.set_environment(environment)
        ...     gradient = lit.harmonics_adjoint(np.ones((scene.num_receivers, 4, 3)))
        ...     total = (lit.environment * gradient).sum(dtype=float)
        ...     bool(np.isclose(total, lit.harmonics.sum(dtype=float), rtol=1e-4))
        True
        """
        if self._order == 0:
            raise RuntimeError("expected a relighter with harmonics, got one without")
        count = self._scene.num_receivers
        values = floats("weights", weights, count, self._order**2, 3)
        self._require_light()
        with errors():
            result: Floats = view(self._core.harmonics_adjoint(values))
        return result

    @with_picture_options
    def fit_environment(
        self,
        wanted: ArrayLike,
        *,
        face_resolution: int = 16,
        smoothness: float = 1e-3,
        sparsity: float = 0.0,
        iterations: int = 300,
        progress: Optional[Progress] = None,
        **options: Any,
    ) -> FittedEnvironment:
        """Finds the environment whose light comes nearest to what is wanted; it lights the scene.

        wanted           (num_receivers, 3): the `radiance` that receivers should have; or a picture
                         (height, width, 3) of linear pixels, made with the picture's options
        face_resolution  R of the environment
        smoothness       how much neighbouring texels resist to differ; 0: not at all
        sparsity         how much each texel resists to shine
        iterations       at most

        Nothing shines below zero. A relighter with clusters_only=True suits it best.

        >>> with relumine.Relighter(scene, clusters_only=True) as lit:
        ...     _ = lit.set_environment(environment)
        ...     lit.fit_environment(lit.radiance.copy(), face_resolution=8).distance < 0.1
        True
        """
        numbers, width, height, shown = self._wanted(wanted, options)
        self._given = None
        with errors():
            cube, distance = self._core.fit_environment(
                numbers,
                width,
                height,
                shown,
                whole("face_resolution", face_resolution, 1, 2**12),
                real("smoothness", smoothness),
                real("sparsity", sparsity),
                whole("iterations", iterations),
                progress,
            )
        environment = Environment(view(cube), face_resolution=face_resolution)
        return FittedEnvironment(environment, distance)

    @with_picture_options
    def fit_lights(
        self,
        wanted: ArrayLike,
        number: int,
        *,
        progress: Optional[Progress] = None,
        **options: Any,
    ) -> FittedLights:
        """Finds so many distant lights, or fewer, as fit_environment() finds an environment.

        Not with clusters_only: lights cast shadows of their own.
        """
        numbers, width, height, shown = self._wanted(wanted, options)
        number = whole("number", number, 1)
        with errors():
            arrays, distance = self._core.fit_lights(
                numbers, width, height, shown, number, progress
            )
        lights = LightList(*(view(each) for each in arrays), method="fit")
        self._given, self._bouncing = lights, None
        return FittedLights(lights, distance)

    def _wanted(self, wanted: ArrayLike, options: Dict[str, Any]) -> Tuple[Floats, int, int, Dict[str, Any]]:
        """Its numbers, a picture's width and height or 0, and its options."""
        if np.ndim(wanted) == 3:
            pixels = floats("wanted", wanted, None, None, 3)
            height, width, _ = pixels.shape
            return pixels.reshape(-1, 3), width, height, _output(options)
        return floats("wanted", wanted, self._scene.num_receivers, 3), 0, 0, {}

    def sees(self, points: ArrayLike) -> NDArray[np.bool_]:
        """Whether the way from each receiver to points in space is free: (num_receivers, K).

        points  (K, 3), as of a lamp near the scene; a point behind the receiver is not seen

        >>> relighter.sees([[0, 5, 0], [0, -5, 0]]).shape
        (6912, 2)
        """
        self._require_triangles()
        result: NDArray[np.bool_] = view(
            self._core.sees(floats("points", points, None, 3))
        ).astype(bool)
        return result

    def lit_by(self, region: Union[Region, Mapping[str, Any]]) -> Share:
        """What a region gives to the scene, as if the rest of the environment were black.

        >>> 0 < relighter.lit_by(relumine.Disc((0, 1, 0), 60)).share < 1
        True
        """
        with naming_layers():
            radiance, environment, share = self._core.lit_by(region_text(region))
        return Share(view(radiance), view(environment), share)

    def transfer_lights(
        self, number: int = 64, *, progress: Optional[Progress] = None
    ) -> LightList:
        """Lights chosen for this scene: they light it nearly as the whole environment does.

        Takes about a minute for 64 lights; fewer come back where more would not help.
        """
        w, e, a = self._core.transfer_lights(whole("number", number, 1), progress)
        return LightList(view(w), view(e), view(a), method="transfer")

    # Outputs

    @with_picture_options
    def picture(self, **options: Any) -> Picture:
        """The lit scene as an array of linear radiance, which notebooks show.

        size        (width, height); scenes of pixels and texels have their own
        albedo      a number, (r, g, b) or "mesh"; by default the mesh's own, else 0.5
        exposure    stops that png() and save() apply; by default what suits what is seen
        camera      (azimuth, elevation[, distance[, fov]]) in degrees; or eye and target (x, y, z)
        floor       "photo" (the environment's ground with shadows), "studio", "grey"; by default
                    what suits the environment
        emission    factors on the scene's own lamps: a number, (r, g, b), "NAME=GAIN[,R,G,B]",
                    "NAME=PROFILE.ies" or a list of these. `radiance` keeps the factors of the last
                    picture
        background  "sharp" (the environment), "none" (alpha), a number or (r, g, b)
        blur        the environment out of focus, by so many degrees
        """
        with errors():
            pixels, suitable = self._core.draw(_output(options))
        exposure = options.get("exposure")
        chosen = suitable if exposure is None or exposure == "auto" else float(exposure)
        return Picture(
            view(pixels), exposure=chosen, tone_map=options.get("tone_map") or "neutral"
        )

    @with_picture_options
    def save(self, path: Path, **options: Any) -> None:
        """Writes the lit scene, whole or not at all, with the options of picture().

        .png and .exr: a picture. .ply and .glb: the mesh with vertex colours. .npy: numbers.
        """
        with errors(path):
            self._core.save(os.fspath(path), _output(options))

    def _repr_png_(self) -> Optional[bytes]:
        return self.picture(size=(640, 480)).png() if self._core.is_lit else None

    def animate(
        self,
        environments: str,
        *,
        frames: Optional[str] = None,
        layout: Optional[str] = None,
        convention: str = "openexr",
        face_resolution: int = 0,
        fix_env: bool = False,
        flip: Optional[str] = None,
        tilt: float = 0.0,
        rotate: float = 0.0,
    ) -> Iterator[Frame]:
        """Lights the scene with one environment after the other, the next one read ahead.

        environments  sky.%04d.exr, sky.####.exr or a glob
        frames        "10-200" or "10-200x5"; by default all

        After each frame the relighter is in its light, so that save() and picture() show it.

        >>> [frame.number for frame in relighter.animate("sky.%d.exr")]
        [1, 2, 3]
        """
        options = _options(layout, convention, face_resolution, fix_env, flip, tilt, rotate)
        with errors(environments):
            sequence = _core.Frames(os.fspath(environments), frames, options)
        for index in range(len(sequence)):
            path = os.fspath(sequence.path(index))
            with errors(path):
                environment = sequence.load(index)
            warn(environment.warnings)
            self._core.set_frame(environment)
            self._given, self._bouncing = None, None
            yield Frame(sequence.number(index), path, self.radiance.copy())

    def __repr__(self) -> str:
        if self._lit is None:
            return "<relumine.Relighter: closed>"
        return (
            f"<relumine.Relighter: {self._scene.num_receivers} receivers, "
            f"{self._scene.num_clusters} clusters, {'lit' if self._core.is_lit else 'no light'}>"
        )


def _batch_of(environments: ArrayLike) -> Tuple[int, int]:
    """How many environments there are, and R."""
    shape = np.shape(environments)
    if len(shape) != 5 or shape[0] == 0 or shape[1] != 6 or shape[2] != shape[3] or shape[4] != 3:
        raise ValueError(f"environments: expected shape (B, 6, R, R, 3), got {shape}")
    return shape[0], shape[2]


def _output_array(out: Optional[NDArray[Any]], shape: Tuple[int, ...]) -> NDArray[Any]:
    if out is None:
        return np.empty(shape, np.float32)
    if not isinstance(out, np.ndarray) or out.dtype.kind != "f":
        raise ValueError(f"out: expected an array of floats, got {type(out).__name__}")
    if out.shape != shape:
        raise ValueError(f"out: expected shape {shape}, got {out.shape}")
    return out


def _output(options: Dict[str, Any]) -> Dict[str, Any]:
    """The options as the compiled part has them: `blur` is a background there."""
    others = {name: value for name, value in options.items() if name != "blur"}
    if options.get("blur") is not None:
        others["background"] = f"blur={options['blur']}"
    return others


def _relighter_from(
    scene: Scene,
    options: Dict[str, Any],
    light: Union[Environment, LightList, None],
    layers: str,
    degrees: float,
    bouncing: Optional[Dict[str, Any]],
) -> Relighter:
    """The relighter in its light: what pickles call."""
    relighter = Relighter(scene, **options)
    if isinstance(light, LightList):
        relighter.set_lights(light)
    elif light is not None:
        relighter.set_environment(light)
        if layers != "[]":
            relighter.set_layers(parsed(layers))
        if degrees != 0.0:
            relighter.set_rotation(degrees)
    if bouncing is not None:
        relighter.bounce(**bouncing)
    return relighter
