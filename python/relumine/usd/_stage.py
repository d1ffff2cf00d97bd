"""Walks through a stage and puts a glTF scene together."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Dict, List, Optional, Sequence, Tuple

import numpy as np
from numpy.typing import NDArray
from pxr import Gf, Tf, Usd, UsdGeom, UsdLux, UsdShade, UsdSkel  # type: ignore

from . import _mesh
from ._glb import Glb
from ._lights import Placer, color_of
from ._materials import Look, Materials
from ._notes import Notes
from ._shapes import shape

Array = NDArray[Any]
#: Instances of a stage, and triangles of all of them.
MOST_INSTANCES = 1_000_000
MOST_TRIANGLES = 100_000_000
#: Instancers in instancers.
DEEPEST = 16


@dataclass
class Shown:
    """Vertices of one material of a mesh.

    of_file  of a refined mesh: (size,) the file's point that each is, or -1; of any other: (corners
             of the file,) the vertex of each, or -1
    """

    size: int
    of_file: Array


@dataclass
class Drawn:
    """Vertices of the scene that show a prim."""

    path: str
    #: Where in Mesh.vertices they begin.
    first: int
    shown: Shown
    is_refined: bool
    num_points: int
    #: False for instances of a point instancer.
    is_own: bool


@dataclass
class _Part:
    """A mesh of the glTF file, which several places may show."""

    mesh: int
    num_triangles: int
    shown: List[Shown]
    is_refined: bool
    num_points: int


class Reader:
    def __init__(
        self,
        stage: Usd.Stage,
        time: Usd.TimeCode,
        purposes: Sequence[str],
        subdivision: int,
        camera: Optional[str],
        lights: bool,
    ) -> None:
        self.stage, self.time = stage, time
        self._purposes, self._level, self._camera, self._with_lights = (
            purposes,
            subdivision,
            camera,
            lights,
        )
        self.glb, self.notes = Glb(), Notes()
        self.up = str(UsdGeom.GetStageUpAxis(stage))
        meters = _meters(stage)
        if not 0.0 < meters < 1e12:
            self.notes.add(f"metersPerUnit {meters:g} is taken as 1", "")
            meters = 1.0
        self.materials = Materials(self.glb, self.notes, meters)
        axes = np.eye(3) if self.up == "Y" else np.array([[1.0, 0, 0], [0, 0, -1.0], [0, 1.0, 0]])
        self.world = np.eye(4)
        self.world[:3, :3] = meters * axes
        self.placer = Placer(self.glb, self.materials, self.notes, self.world, self.up)
        self.drawn: List[Drawn] = []
        self.camera: Optional[str] = None
        self._num_triangles = 0
        self._parts: Dict[Any, Optional[_Part]] = {}
        self._leaves: Dict[Any, List[Tuple[Usd.Prim, Array, bool]]] = {}
        self._num_leaves = 0

    def run(self) -> None:
        root = self.stage.GetPseudoRoot()
        for prim, matrix, is_own in self._below(root, np.eye(4), "default", True, 0):
            self._draw(prim, matrix, is_own)
        if self._camera is not None and self.camera is None:
            raise ValueError(f"camera: expected a camera's path, got {self._camera}")

    # The prims that show something, and their places.

    def _below(
        self, prim: Usd.Prim, matrix: Array, purpose: str, is_own: bool, depth: int
    ) -> List[Tuple[Usd.Prim, Array, bool]]:
        result: List[Tuple[Usd.Prim, Array, bool]] = []
        stack = [(child, matrix, purpose, is_own) for child in self._children(prim)]
        stack.reverse()
        while stack:
            prim, above, purpose, is_own = stack.pop()
            placed, purpose = self._placed(prim, above, purpose)
            if placed is None:
                continue
            if prim.IsA(UsdGeom.PointInstancer):
                result += self._instances(prim, placed, purpose, depth)
                continue
            self._keep(result, [(prim, placed, is_own)], purpose)
            below = [(child, placed, purpose, is_own) for child in self._children(prim)]
            stack += reversed(below)
        return result

    def _keep(self, result: List[Any], more: List[Any], purpose: str) -> None:
        if purpose in self._purposes:
            self._num_leaves += len(more)
            if self._num_leaves > MOST_INSTANCES:
                raise ValueError(
                    f"expected at most {MOST_INSTANCES} prims with their instances, got more"
                )
            result += more

    def _children(self, prim: Usd.Prim) -> List[Usd.Prim]:
        predicate = Usd.TraverseInstanceProxies(Usd.PrimDefaultPredicate)
        return list(prim.GetFilteredChildren(predicate))

    def _placed(self, prim: Usd.Prim, above: Array, purpose: str) -> Tuple[Optional[Array], str]:
        """The place of a prim; None where it is not to be seen."""
        imageable = UsdGeom.Imageable(prim)
        if imageable:
            if imageable.GetVisibilityAttr().Get(self.time) == UsdGeom.Tokens.invisible:
                return None, purpose
            own = imageable.GetPurposeAttr()
            if own.HasAuthoredValue():
                purpose = own.Get()
        xformable = UsdGeom.Xformable(prim)
        if xformable:
            local = np.array(xformable.GetLocalTransformation(self.time))
            if not np.isfinite(local).all():
                self.notes.add("a place that is not finite: left out", prim.GetPath())
                return None, purpose
            above = local if xformable.GetResetXformStack() else local @ above
        return above, purpose

    def _instances(
        self, prim: Usd.Prim, matrix: Array, purpose: str, depth: int
    ) -> List[Tuple[Usd.Prim, Array, bool]]:
        instancer = UsdGeom.PointInstancer(prim)
        path = prim.GetPath()
        indices = instancer.GetProtoIndicesAttr().Get(self.time)
        targets = instancer.GetPrototypesRel().GetForwardedTargets()
        if not indices or not targets:
            self.notes.add("a point instancer without instances", path)
            return []
        if depth >= DEEPEST:
            raise ValueError(
                f"{path}: expected at most {DEEPEST} instancers within each other, got more"
            )
        indices = np.asarray(indices)
        if len(indices) > MOST_INSTANCES:
            raise ValueError(
                f"{path}: expected at most {MOST_INSTANCES} instances, got {len(indices)}"
            )
        try:
            matrices = instancer.ComputeInstanceTransformsAtTime(
                self.time, self.time, UsdGeom.PointInstancer.ExcludeProtoXform,
                UsdGeom.PointInstancer.IgnoreMask,
            )  # fmt: skip
        except Tf.ErrorException:
            matrices = []
        if len(matrices) != len(indices):
            self.notes.add("a point instancer whose arrays do not fit each other is left out", path)
            return []
        mask = instancer.ComputeMaskAtTime(self.time)
        shown = np.ones(len(indices), bool) if not mask else np.asarray(mask, bool)
        bad = (indices < 0) | (indices >= len(targets))
        if bad.any():
            self.notes.add("instances of prototypes that are not there are left out", path)
            shown &= ~bad
        places = np.array(matrices).reshape(-1, 4, 4)
        bad = ~np.isfinite(places).all((1, 2))
        if bad.any():
            self.notes.add("instances whose place is not finite are left out", path)
            shown &= ~bad
        result: List[Tuple[Usd.Prim, Array, bool]] = []
        protos = [self._prototype(t, purpose, depth) for t in targets]
        sizes = np.array([len(p) for p in protos])
        count = int(sizes[indices[shown]].sum())
        if self._num_leaves + count > MOST_INSTANCES:
            raise ValueError(
                f"{path}: expected at most {MOST_INSTANCES} prims with their instances, "
                f"got {self._num_leaves + count}"
            )
        self._num_leaves += count
        for i in np.flatnonzero(shown):
            at = places[i] @ matrix
            result += [(leaf, own @ at, False) for leaf, own, _ in protos[indices[i]]]
        return result

    def _prototype(self, path: Any, purpose: str, depth: int) -> List[Tuple[Usd.Prim, Array, bool]]:
        key = (path, purpose)
        if key not in self._leaves:
            prim = self.stage.GetPrimAtPath(path)
            found: List[Tuple[Usd.Prim, Array, bool]] = []
            before = self._num_leaves
            if not prim:
                self.notes.add("a prototype of instances is not there", path)
            else:
                self._leaves[key] = []  # an instancer of itself shows nothing
                placed, own_purpose = self._placed(prim, np.eye(4), purpose)
                if placed is not None:
                    if prim.IsA(UsdGeom.PointInstancer):
                        found += self._instances(prim, placed, own_purpose, depth + 1)
                    else:
                        self._keep(found, [(prim, placed, False)], own_purpose)
                        found += self._below(prim, placed, own_purpose, False, depth + 1)
            self._num_leaves = before  # counted where they are shown
            self._leaves[key] = found
        return self._leaves[key]

    # What they show.

    def _draw(self, prim: Usd.Prim, matrix: Array, is_own: bool) -> None:
        if prim.IsA(UsdGeom.Camera):
            self._add_camera(prim, matrix)
        elif self._with_lights and self.placer.add(prim, matrix, self.time):
            pass
        elif prim.IsA(UsdGeom.Gprim):
            self._add_mesh(prim, matrix, is_own)

    def _add_camera(self, prim: Usd.Prim, matrix: Array) -> None:
        wanted = (
            self.camera is None if self._camera is None else str(prim.GetPath()) == self._camera
        )
        if not wanted:
            return
        camera = UsdGeom.Camera(prim).GetCamera(self.time)
        place = matrix @ self.world
        # A camera has no size.
        axes = place[:3, :3]
        lengths = np.linalg.norm(axes, axis=1, keepdims=True)
        if not (lengths > 0.0).all():
            self.notes.add("a camera without a direction is left out", prim.GetPath())
            return
        meters = float(np.linalg.norm(self.world[0, :3]))
        frame = np.eye(4)
        frame[:3, :3], frame[3, :3] = axes / lengths, place[3, :3]
        tall = camera.verticalAperture
        far = max(float(camera.clippingRange.max) * meters, 1e-6)
        near = min(max(float(camera.clippingRange.min) * meters, 1e-9), 0.5 * far)
        if camera.projection == Gf.Camera.Orthographic:
            half = 0.5 * tall * Gf.Camera.APERTURE_UNIT * meters * float(lengths[1])
            wide = half * camera.horizontalAperture / max(tall, 1e-9)
            made = {"type": "orthographic",
                    "orthographic": {"xmag": wide, "ymag": half, "znear": near, "zfar": far}}  # fmt: skip
        else:
            fov = np.radians(camera.GetFieldOfView(Gf.Camera.FOVVertical))
            if not 0.0 < fov < np.pi:
                self.notes.add("a camera without a field of view is left out", prim.GetPath())
                return
            made = {"type": "perspective", "perspective": {
                "yfov": float(fov), "aspectRatio": float(camera.horizontalAperture / tall),
                "znear": near, "zfar": far}}  # fmt: skip
        if camera.horizontalApertureOffset or camera.verticalApertureOffset:
            self.notes.add("a camera's aperture offset is left out", prim.GetPath())
        self.camera = str(prim.GetPath())
        self.glb.node(prim.GetName(), frame, camera=self.glb.camera(made))

    def _add_mesh(self, prim: Usd.Prim, matrix: Array, is_own: bool) -> None:
        own = prim.GetPrimInPrototype() if prim.IsInstanceProxy() else prim
        bound = self._bound(prim)
        is_light = prim.HasAPI(UsdLux.MeshLightAPI) and self._with_lights
        key = (
            own.GetPath(), bound.GetPath() if bound else None, prim.GetPath() if is_light else None
        )  # fmt: skip
        if key not in self._parts:
            try:
                self._parts[key] = self._part(prim, bound, matrix if is_light else None)
            except _mesh.Unfit as reason:
                self.notes.add(f"{reason}: left out", prim.GetPath())
                self._parts[key] = None
        part = self._parts[key]
        if part is None:
            return
        self._num_triangles += part.num_triangles
        if self._num_triangles > MOST_TRIANGLES:
            raise ValueError(
                f"expected at most {MOST_TRIANGLES} triangles with their instances, got more"
            )
        placed = matrix @ self.world
        if not np.isfinite(placed).all():
            self.notes.add("a place that is not finite: left out", prim.GetPath())
            return
        first = self.glb.num_vertices
        self.glb.node(prim.GetName(), placed, mesh=part.mesh)
        for shown in part.shown:
            self.drawn.append(
                Drawn(
                    str(prim.GetPath()), first, shown, part.is_refined, part.num_points, is_own
                )
            )  # fmt: skip
            first += shown.size

    def _bound(self, prim: Usd.Prim) -> Optional[UsdShade.Material]:
        material = UsdShade.MaterialBindingAPI(prim).ComputeBoundMaterial()[0]
        return material if material else None

    def _look(self, material: Optional[UsdShade.Material], prim: Usd.Prim, has_color: bool) -> Look:
        two = bool(UsdGeom.Gprim(prim).GetDoubleSidedAttr().Get(self.time))
        found = None if material is None else self.materials.look(material, two, self.time)
        return self.materials.plain(two, has_color) if found is None else found

    def _part(self, prim: Usd.Prim, bound: Any, lamp_at: Optional[Array]) -> _Part:
        path = prim.GetPath()
        color = UsdGeom.PrimvarsAPI(prim).FindPrimvarWithInheritance("displayColor")
        has_color = bool(color) and color.HasValue()
        subsets: List[Tuple[Array, Look]] = []
        whole = self._look(bound, prim, has_color)
        if prim.IsA(UsdGeom.Mesh):
            for subset in UsdShade.MaterialBindingAPI(prim).GetMaterialBindSubsets():
                faces = subset.GetIndicesAttr().Get(self.time)
                if subset.GetElementTypeAttr().Get() != UsdGeom.Tokens.face or not faces:
                    continue
                material = self._bound(subset.GetPrim())
                look = self._look(material, prim, has_color) if material else whole
                subsets.append((np.asarray(faces, np.int64), look))
        looks = [whole, *(look for _, look in subsets)]
        wanted = {name: 2 for look in looks for name in look.uvs}
        wanted.update({look.color: 3 for look in looks if look.color})
        polygons = self._polygons(prim, list(wanted.items()))
        triangles, faces = _mesh.triangulated(polygons)
        of_face = np.zeros(int(polygons.source.max()) + 1, np.int64)
        for number, (given, _) in enumerate(subsets):
            of_face[given[(given >= 0) & (given < len(of_face))]] = number + 1
        of_triangle = of_face[polygons.source[faces]]
        if lamp_at is not None:
            looks = [self._lamp(prim, polygons, triangles, lamp_at)] * len(looks)
        primitives: List[Dict[str, Any]] = []
        shown: List[Shown] = []
        for number, look in enumerate(looks):
            chosen = triangles[of_triangle == number]
            if not len(chosen):
                continue
            names = [*look.uvs, *([look.color] if look.color else [])]
            split = _mesh.split(polygons, chosen, names)
            points = polygons.points[polygons.corners[split.corner]]
            assert polygons.normals is not None
            attributes = {"POSITION": points, "NORMAL": _unit(polygons.normals.at(split.corner))}
            for place, name in enumerate(look.uvs):
                attributes[f"TEXCOORD_{place}"] = self._uvs(polygons, name, split.corner, path)
            if look.color:
                values = polygons.primvars.get(look.color)
                if values is None:
                    self.notes.add(f"primvars:{look.color} is not there: white stands for it", path)
                else:
                    attributes["COLOR_0"] = np.clip(values.at(split.corner), 0.0, 1.0)
            primitives.append(self.glb.primitive(attributes, split.triangles, look.index))
            if polygons.is_refined:
                point = polygons.corners[split.corner]
                of_file = np.where(point < polygons.num_points, point, -1)
            else:
                of_file = np.full(polygons.num_file_corners, -1)
                of_file[polygons.file_corner[split.used]] = split.vertex
            shown.append(Shown(len(split.corner), of_file))
        if not primitives:
            raise _mesh.Unfit("has no faces")
        return _Part(
            self.glb.mesh(primitives),
            len(triangles),
            shown,
            polygons.is_refined,
            polygons.num_points,
        )

    def _polygons(self, prim: Usd.Prim, wanted: List[Tuple[str, int]]) -> _mesh.Polygons:
        if prim.IsA(UsdGeom.Mesh):
            return _mesh.polygons(prim, self.time, wanted, self._level, self.notes)
        polygons = shape(prim, self.time)
        if polygons is None:
            raise _mesh.Unfit(f"is of type {prim.GetTypeName()}")
        for name, width in wanted:
            found = UsdGeom.PrimvarsAPI(prim).FindPrimvarWithInheritance(name)
            values = _mesh._array(found.GetAttr(), self.time, width) if found else None
            if values is not None and len(values) >= 1 and values.shape[1] == width:
                zeros = np.zeros(len(polygons.corners), np.int64)
                polygons.primvars[name] = _mesh.Values(values[:1], zeros, "constant")
        return polygons

    def _uvs(self, polygons: _mesh.Polygons, name: str, corners: Array, path: Any) -> Array:
        values = polygons.primvars.get(name)
        if values is None:
            self.notes.add(f"primvars:{name} is not there: its texture is one colour", path)
            return np.zeros((len(corners), 2))
        return values.at(corners) * [1.0, -1.0] + [0.0, 1.0]

    def _lamp(
        self, prim: Usd.Prim, polygons: _mesh.Polygons, triangles: Array, matrix: Array
    ) -> Look:
        color = color_of(prim, self.time)
        if UsdLux.LightAPI(prim).GetNormalizeAttr().Get(self.time):
            p = (polygons.points @ matrix[:3, :3])[polygons.corners[triangles]]
            area = (
                0.5 * np.linalg.norm(np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]), axis=1).sum()
            )
            color = color / max(float(area), 1e-30)
        name = prim.GetName()
        self.placer.lights.lamps.append(name)
        return Look(self.materials.lamp(name, np.maximum(color, 0.0), None, prim))


def _meters(stage: Usd.Stage) -> float:
    try:
        return float(UsdGeom.GetStageMetersPerUnit(stage))
    except Tf.ErrorException:  # a float where the schema wants a double
        return float(stage.GetRootLayer().pseudoRoot.GetInfo("metersPerUnit"))


def _unit(normals: Array) -> Array:
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    return np.where(lengths > 0.0, normals / np.where(lengths > 0.0, lengths, 1.0), [0.0, 1.0, 0.0])


def _normals_as_attribute(mesh: UsdGeom.Mesh, moment: float) -> None:
    """Moves primvars:normals to `normals`: OpenUSD's baking turns these alone."""
    primvar = UsdGeom.PrimvarsAPI(mesh).GetPrimvar("normals")
    if not primvar or not primvar.HasAuthoredValue():
        return
    values = primvar.ComputeFlattened(moment)
    if values is not None:
        mesh.GetNormalsAttr().Set(values)
        mesh.SetNormalsInterpolation(primvar.GetInterpolation())
        primvar.GetAttr().Block()


def bake_skeletons(stage: Usd.Stage, time: Usd.TimeCode, notes: Notes) -> None:
    """Puts skinned meshes and blend shapes into their pose, in the session layer."""
    roots = [prim for prim in stage.Traverse() if prim.IsA(UsdSkel.Root)]
    if not roots:
        return
    moment = 0.0 if time.IsDefault() or time.IsEarliestTime() else time.GetValue()
    with Usd.EditContext(stage, stage.GetSessionLayer()):
        for prim in stage.Traverse():
            if not prim.IsA(UsdSkel.Animation):
                continue
            # Samples are baked where there are some: this makes one of the moment.
            for name in ("translations", "rotations", "scales", "blendShapeWeights"):
                attribute = prim.GetAttribute(name)
                value = attribute.Get(moment)
                if value is not None:
                    attribute.Set(value, moment)
        for root in roots:
            for prim in Usd.PrimRange(root):
                if prim.IsA(UsdGeom.Mesh):
                    _normals_as_attribute(UsdGeom.Mesh(prim), moment)
            if not UsdSkel.BakeSkinning(UsdSkel.Root(root), Gf.Interval(moment, moment)):
                notes.add("a skeleton that cannot be posed: it is at rest", root.GetPath())
