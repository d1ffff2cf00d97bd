"""Lights of UsdLux.

Those of a place become surfaces that glow, in the scene; those from afar the environment and the
layers over it. A light without a size, or with a cone, becomes one of glTF's points and spots.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any, Dict, List, Optional, Tuple

import numpy as np
from numpy.typing import NDArray
from pxr import Usd, UsdGeom, UsdLux  # type: ignore

from .._environment import Environment
from .._layers import SHAPES, Emit, Layer
from ._glb import Glb
from ._ies import Shape, shaped
from ._images import read_asset
from ._notes import Notes

Array = NDArray[Any]
#: A light without an angle: a direction.
SMALLEST_RADIUS = 0.01
#: Sides of circles. A sphere of so many has the light of a round one to 0.1 %.
SIDES = 48


@dataclass
class Dome:
    """A dome of one colour, or a picture of the sphere times it.

    `turn` takes directions of the picture to the world's.
    """

    name: str
    path: str
    color: Array
    texture: Any
    format: str
    turn: Array


@dataclass
class Lights:
    domes: List[Dome] = field(default_factory=list)
    layers: List[Layer] = field(default_factory=list)
    #: Names of lamps in the scene, as `emission` has them.
    lamps: List[str] = field(default_factory=list)
    #: The prim of each layer and lamp.
    paths: Dict[str, str] = field(default_factory=dict)


def color_of(prim: Usd.Prim, time: Usd.TimeCode) -> Array:
    """What LightAPI's intensity, exposure, colour and colour temperature say, without the size."""
    light = UsdLux.LightAPI(prim)
    color = np.asarray(light.GetColorAttr().Get(time) or (1.0, 1.0, 1.0), float)
    if light.GetEnableColorTemperatureAttr().Get(time):
        kelvin = light.GetColorTemperatureAttr().Get(time)
        color = color * np.asarray(UsdLux.BlackbodyTemperatureAsRgb(kelvin), float)
    intensity = light.GetIntensityAttr().Get(time)
    exposure = light.GetExposureAttr().Get(time) or 0.0
    strength = float(1.0 if intensity is None else intensity) * 2.0 ** float(exposure)
    result: Array = color * strength
    return result


#: Lights whose IES profile counts.
_PROFILED = (UsdLux.RectLight, UsdLux.DiskLight, UsdLux.SphereLight)
#: Inputs of lights that change nothing here, and what they are when they say nothing.
_LEFT_OUT = {
    "inputs:diffuse": (1.0, "a factor on diffuse light"),
    "inputs:specular": (1.0, "a factor on highlights"),
    "inputs:shadow:enable": (True, "light without shadows"),
    "inputs:shaping:focus": (0.0, "a focus"),
}


def _name_left_out(prim: Usd.Prim, time: Usd.TimeCode, notes: Notes) -> None:
    for name, (nothing, words) in _LEFT_OUT.items():
        attribute = prim.GetAttribute(name)
        if not attribute or not attribute.HasAuthoredValue():
            continue
        value = attribute.Get(time)
        if value != nothing:
            notes.add(f"{name} is left out: {words}", prim.GetPath())
    for relationship, words in (
        ("light:filters", "filters of lights are left out"),
        ("collection:lightLink:includes", "light links are left out: it lights all surfaces"),
        ("collection:lightLink:excludes", "light links are left out: it lights all surfaces"),
        ("collection:shadowLink:excludes", "shadow links are left out: all surfaces shade it"),
    ):
        links = prim.GetRelationship(relationship)
        if links and links.HasAuthoredTargets() and links.GetTargets():
            notes.add(words, prim.GetPath())


def _rotation(matrix: Array) -> Array:
    """The nearest rotation, or mirrored rotation, to a (3, 3) matrix."""
    u, _, v = np.linalg.svd(matrix)
    result: Array = u @ v
    return result


def _disk(sides: int = SIDES) -> Tuple[Array, Array]:
    """A disk of area pi that looks along -Z."""
    angle = 2.0 * np.pi * np.arange(sides) / sides
    r = math.sqrt(2.0 * np.pi / (sides * math.sin(2.0 * np.pi / sides)))
    rim = np.stack([r * np.cos(angle), r * np.sin(angle), np.zeros(sides)], 1)
    i = np.arange(sides)
    j = (i + 1) % sides
    points = np.concatenate([np.zeros((1, 3)), rim])
    return points, np.stack([np.zeros(sides, int), 1 + j, 1 + i], 1)


def _cylinder() -> Tuple[Array, Array]:
    """Along X, of radius and length 1, without caps; its area is 2 pi."""
    angle = 2.0 * np.pi * np.arange(SIDES) / SIDES
    r = np.pi / (SIDES * math.sin(np.pi / SIDES))
    steps = 9
    x = np.linspace(-0.5, 0.5, steps)
    points = np.stack(
        [
            np.repeat(x, SIDES),
            np.tile(r * np.cos(angle), steps),
            np.tile(r * np.sin(angle), steps),
        ],
        1,
    )
    a = (np.arange(steps - 1)[:, None] * SIDES + np.arange(SIDES)).reshape(-1)
    b = (np.arange(steps - 1)[:, None] * SIDES + (np.arange(SIDES) + 1) % SIDES).reshape(-1)
    quads = np.stack([a, b, b + SIDES, a, b + SIDES, a + SIDES], 1)
    return points, quads.reshape(-1, 3)


def _sphere() -> Tuple[Array, Array]:
    """Of radius 1; its area is 4 pi."""
    rings = SIDES // 2
    v = np.pi * np.arange(rings + 1) / rings
    angle = 2.0 * np.pi * np.arange(SIDES) / SIDES
    points = np.stack(
        [
            np.outer(np.sin(v), np.cos(angle)),
            np.repeat(np.cos(v)[:, None], SIDES, 1),
            np.outer(np.sin(v), np.sin(angle)),
        ],
        -1,
    ).reshape(-1, 3)
    a = (np.arange(rings)[:, None] * SIDES + np.arange(SIDES)).reshape(-1)
    b = (np.arange(rings)[:, None] * SIDES + (np.arange(SIDES) + 1) % SIDES).reshape(-1)
    triangles = np.stack([a, b, b + SIDES, a, b + SIDES, a + SIDES], 1).reshape(-1, 3)
    p = points[triangles]
    area = np.linalg.norm(np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]), axis=1)
    keep = area > 1e-9
    return points * math.sqrt(4.0 * np.pi / (0.5 * area.sum())), triangles[keep]


def _rectangle() -> Tuple[Array, Array]:
    points = np.array([[-0.5, -0.5, 0], [0.5, -0.5, 0], [0.5, 0.5, 0], [-0.5, 0.5, 0]], float)
    return points, np.array([[0, 2, 1], [0, 3, 2]])


def _area(points: Array, triangles: Array) -> float:
    p = points[triangles]
    cross = np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0])
    return 0.5 * float(np.linalg.norm(cross, axis=1).sum())


def _get(prim: Usd.Prim, name: str, time: Usd.TimeCode) -> float:
    value = prim.GetAttribute(name).Get(time)
    return 0.0 if value is None else float(value)


class Placer:
    """Adds lights, one prim after the other."""

    def __init__(self, glb: Glb, materials: Any, notes: Notes, world: Array, up: str) -> None:
        self._glb, self._materials, self._notes = glb, materials, notes
        #: (4, 4), rows: the world's axes and metres of the stage's.
        self._world = world
        self._up = up
        self.lights = Lights()

    def add(self, prim: Usd.Prim, matrix: Array, time: Usd.TimeCode) -> bool:
        """Returns whether the prim is a light. `matrix` (4, 4) takes its points to the stage."""
        kinds = {
            UsdLux.DomeLight: self._dome,
            UsdLux.DomeLight_1: self._dome,
            UsdLux.DistantLight: self._distant,
            UsdLux.RectLight: self._surface,
            UsdLux.DiskLight: self._surface,
            UsdLux.SphereLight: self._surface,
            UsdLux.CylinderLight: self._surface,
        }
        for kind, add in kinds.items():
            if prim.IsA(kind):
                break
        else:
            if prim.HasAPI(UsdLux.LightAPI) and not prim.IsA(UsdGeom.Mesh):
                self._notes.add(f"the light {prim.GetTypeName()} is left out", prim.GetPath())
                return True
            return False
        _name_left_out(prim, time, self._notes)
        if _profile(prim, time) and not any(prim.IsA(kind) for kind in _PROFILED):
            self._notes.add("an IES profile of such a light is left out", prim.GetPath())
        color = color_of(prim, time)
        if not np.isfinite(color).all() or not np.isfinite(matrix).all():
            self._notes.add("a light that is not finite is left out", prim.GetPath())
            return True
        if (color < 0.0).any():
            self._notes.add("negative light is 0", prim.GetPath())
            color = np.maximum(color, 0.0)
        add(prim, matrix, time, color)
        return True

    def _named(self, prim: Usd.Prim) -> str:
        name: str = prim.GetName()
        if name in self.lights.paths:
            name = str(prim.GetPath())
        count, first = 1, name
        while name in self.lights.paths:  # of instances
            count += 1
            name = f"{first} {count}"
        self.lights.paths[name] = str(prim.GetPath())
        return name

    def _dome(self, prim: Usd.Prim, matrix: Array, time: Usd.TimeCode, color: Array) -> None:
        turn = _rotation((matrix @ self._world)[:3, :3].T)
        axis = "Y"
        if prim.IsA(UsdLux.DomeLight_1):
            axis = UsdLux.DomeLight_1(prim).GetPoleAxisAttr().Get(time)
            axis = self._up if axis == UsdLux.Tokens.scene else axis
        if axis == "Z":
            # The top is +Z, the middle -Y.
            turn = turn @ np.array([[1.0, 0, 0], [0, 0, -1.0], [0, 1.0, 0]])
        texture = prim.GetAttribute("inputs:texture:file").Get(time)
        format = prim.GetAttribute("inputs:texture:format").Get(time) or "automatic"
        portals = prim.GetRelationship("portals")
        if portals and portals.GetTargets():
            self._notes.add("portals are left out: the dome lights from all sides", prim.GetPath())
        has_texture = texture is not None and texture.path
        name = self._named(prim)
        self.lights.domes.append(
            Dome(name, str(prim.GetPath()), color, texture if has_texture else None, format, turn)
        )

    def _distant(self, prim: Usd.Prim, matrix: Array, time: Usd.TimeCode, color: Array) -> None:
        direction = np.array([0.0, 0.0, 1.0]) @ (matrix @ self._world)[:3, :3]
        if not np.linalg.norm(direction) > 0.0:
            self._notes.add("a light without a direction is left out", prim.GetPath())
            return
        radius = 0.5 * min(max(_get(prim, "inputs:angle", time), 0.0), 360.0)
        half = math.radians(radius)
        # UsdLux: the size of a light from afar is its projected solid angle, or 1 without one.
        size = math.pi * (math.sin(half) ** 2 if radius <= 90.0 else 2.0 - math.sin(half) ** 2)
        normalize = UsdLux.LightAPI(prim).GetNormalizeAttr().Get(time)
        if normalize and radius > 0.0:
            color = color / size
        if radius < SMALLEST_RADIUS:
            smallest = math.pi * math.sin(math.radians(SMALLEST_RADIUS)) ** 2
            color = color * ((size if radius > 0.0 else 1.0) / smallest)
            radius = SMALLEST_RADIUS
        name = self._named(prim)
        region = SHAPES["Disc"](tuple(float(x) for x in direction), radius)
        radiance = tuple(float(x) for x in color)
        self.lights.layers.append(Layer(name, region, Emit(radiance)))

    def _surface(self, prim: Usd.Prim, matrix: Array, time: Usd.TimeCode, color: Array) -> None:
        normalize = bool(UsdLux.LightAPI(prim).GetNormalizeAttr().Get(time))
        cone = _cone(prim, time)
        texture = None
        if _profile(prim, time) and self._profiled(prim, matrix, time, color, cone, normalize):
            return
        if prim.IsA(UsdLux.RectLight):
            points, triangles = _rectangle()
            size = [_get(prim, "inputs:width", time), _get(prim, "inputs:height", time), 1.0]
            texture = prim.GetAttribute("inputs:texture:file").Get(time)
        elif prim.IsA(UsdLux.DiskLight):
            points, triangles = _disk()
            size = [_get(prim, "inputs:radius", time)] * 2 + [1.0]
        elif prim.IsA(UsdLux.SphereLight):
            points, triangles = _sphere()
            radius = _get(prim, "inputs:radius", time)
            is_point = bool(prim.GetAttribute("treatAsPoint").Get(time)) or radius == 0.0
            if is_point or cone:
                self._point(
                    prim, matrix, color, 0.0 if is_point and normalize else radius, cone, normalize
                )
                return
            size = [radius] * 3
        else:
            points, triangles = _cylinder()
            radius = _get(prim, "inputs:radius", time)
            if prim.GetAttribute("treatAsLine").Get(time):
                self._notes.add(
                    "treatAsLine is left out: the cylinder has its radius", prim.GetPath()
                )
            size = [_get(prim, "inputs:length", time), radius, radius]
        if cone:
            self._notes.add("a cone of a light with a surface is left out", prim.GetPath())
        in_stage = points * size @ matrix[:3, :3] + matrix[3, :3]
        area = _area(in_stage, triangles)
        if not area > 0.0 or not math.isfinite(area):
            self._notes.add("a light without an area is left out", prim.GetPath())
            return
        name = self._named(prim)
        self.lights.lamps.append(name)
        if not color.any():
            return
        if normalize:
            color = color / area
        placed = in_stage @ self._world[:3, :3] + self._world[3, :3]
        if np.linalg.det(matrix[:3, :3]) < 0.0:
            triangles = triangles[:, [0, 2, 1]]
        uvs = None
        if texture is not None and texture.path:
            # Seen from where it shines to, as hdPrman and Karma show it: left is +X.
            uvs = np.stack([points[:, 0] + 0.5, 0.5 - points[:, 1]], 1)
        material = self._materials.lamp(name, color, texture if uvs is not None else None, prim)
        self._add_surface(name, placed, triangles, uvs, material)

    def _profiled(
        self,
        prim: Usd.Prim,
        matrix: Array,
        time: Usd.TimeCode,
        color: Array,
        cone: Optional[Tuple[float, float]],
        normalize: bool,
    ) -> bool:
        """A light with an IES profile as a point. Returns whether it has one that can be read."""
        if not any(prim.IsA(kind) for kind in _PROFILED):
            return False
        asset = _profile(prim, time)
        is_flat = not prim.IsA(UsdLux.SphereLight)
        shape = Shape(
            angle_scale=_get(prim, "inputs:shaping:ies:angleScale", time),
            normalize=bool(prim.GetAttribute("inputs:shaping:ies:normalize").Get(time)),
            is_flat=is_flat,
            cone=cone,
        )
        try:
            if not asset.resolvedPath:
                raise OSError("no such file")
            file, left_out = shaped(read_asset(asset.resolvedPath), shape)
        except (OSError, RuntimeError) as error:
            self._notes.add(f"its IES profile is left out: {error}", prim.GetPath())
            return False
        for line in left_out:
            self._notes.add(f"its IES profile is read without {line}", prim.GetPath())
        of_plane = float(np.linalg.norm(np.cross(matrix[0, :3], matrix[1, :3])))
        if prim.IsA(UsdLux.RectLight):
            area = _get(prim, "inputs:width", time) * _get(prim, "inputs:height", time) * of_plane
            if prim.GetAttribute("inputs:texture:file").Get(time):
                self._notes.add("a texture beside an IES profile is left out", prim.GetPath())
        elif prim.IsA(UsdLux.DiskLight):
            area = math.pi * _get(prim, "inputs:radius", time) ** 2 * of_plane
        else:
            area = math.pi * (_get(prim, "inputs:radius", time) * _scale(matrix)) ** 2
        # What a normalized light has, it has at any size: a sphere a quarter of it to each side.
        intensity = color * (area if not normalize else 1.0 if is_flat else 0.25)
        name = self._named(prim)
        self.lights.lamps.append(name)
        meters = float(np.linalg.norm(self._world[0, :3]))
        strength = float((intensity * meters**2).max())
        if not strength > 0.0 or not math.isfinite(strength):
            self._notes.add("a light without power is left out", prim.GetPath())
            return True
        self._notes.add(
            "an IES profile makes the light a point: its shadows are sharp", prim.GetPath()
        )
        self._glb.profiled(
            {
                "light": self._glb.profile(file),
                "multiplier": strength,
                "color": [float(x) for x in intensity * meters**2 / strength],
            },
            name,
            matrix @ self._world,
        )
        return True

    def _add_surface(
        self, name: str, points: Array, triangles: Array, uvs: Optional[Array], material: int
    ) -> None:
        p = points[triangles]
        normals = np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0])
        sums = np.zeros_like(points)
        np.add.at(sums, triangles.reshape(-1), np.repeat(normals, 3, axis=0))
        lengths = np.linalg.norm(sums, axis=1, keepdims=True)
        sums = np.where(lengths > 0.0, sums / np.where(lengths > 0.0, lengths, 1.0), [0, 1, 0])
        attributes = {"POSITION": points, "NORMAL": sums}
        if uvs is not None:
            attributes["TEXCOORD_0"] = uvs
        mesh = self._glb.mesh([self._glb.primitive(attributes, triangles, material)])
        self._glb.node(name, np.eye(4), mesh=mesh)

    def _point(
        self,
        prim: Usd.Prim,
        matrix: Array,
        color: Array,
        radius: float,
        cone: Optional[Tuple[float, float]],
        normalize: bool,
    ) -> None:
        """A sphere as seen from afar. `color` is its radiance, times its area where `normalize`."""
        meters = float(np.linalg.norm(self._world[0, :3]))
        intensity = color / 4.0 if normalize else color * math.pi * (radius * _scale(matrix)) ** 2
        name = self._named(prim)
        self.lights.lamps.append(name)
        if not intensity.any():
            if radius == 0.0 and color.any():
                self._notes.add(
                    "a sphere of radius 0 gives no light without normalize", prim.GetPath()
                )
            return
        if cone:
            self._notes.add("a cone makes the sphere a spot: its shadows are sharp", prim.GetPath())
        # Candela of glTF falls with metres, the stage's light with its own unit.
        self._materials.punctual(name, intensity * meters**2, cone, matrix @ self._world)


def _scale(matrix: Array) -> float:
    """How much larger a matrix makes a ball, of the same volume."""
    return float(abs(np.linalg.det(matrix[:3, :3])) ** (1.0 / 3.0))


def _profile(prim: Usd.Prim, time: Usd.TimeCode) -> Any:
    """The asset path of an IES profile, or None."""
    attribute = prim.GetAttribute("inputs:shaping:ies:file")
    asset = attribute.Get(time) if attribute else None
    return asset if asset is not None and asset.path else None


def _cone(prim: Usd.Prim, time: Usd.TimeCode) -> Optional[Tuple[float, float]]:
    """The inner and the outer half angle in degrees; None for a light to all sides."""
    attribute = prim.GetAttribute("inputs:shaping:cone:angle")
    if not attribute or not attribute.HasAuthoredValue():
        return None
    angle = float(attribute.Get(time))
    if angle >= 90.0 and (not prim.IsA(UsdLux.SphereLight) or angle >= 180.0):
        return None
    softness = (
        _get(prim, "inputs:shaping:cone:softness", time)
        if prim.GetAttribute("inputs:shaping:cone:softness")
        else 0.0
    )
    outer = min(angle, 90.0)
    return outer * (1.0 - min(max(softness, 0.0), 1.0)), outer


#: Texels along the edge of a face, so that layers over it lie where they should.
LEAST_RESOLUTION = 256


def environment_of(domes: List[Dome], load: Any, least: int) -> Optional[Environment]:
    """The sum of domes; None where there are none. `load(dome)` reads a picture, or returns None.

    least  texels along a face's edge
    """
    if not domes:
        return None
    parts: List[Environment] = []
    constant: Array = np.zeros(3)
    for dome in domes:
        picture = None if dome.texture is None else load(dome)
        if picture is None:
            constant = constant + dome.color
            continue
        resolution = max(picture.face_resolution, least)
        environment = picture.turned(turn=dome.turn, face_resolution=resolution)
        if not np.allclose(dome.color, 1.0, rtol=1e-6):
            cube = np.asarray(environment.cube) * dome.color
            environment = Environment(cube, face_resolution=cube.shape[1])
        parts.append(environment)
    if len(parts) == 1 and not constant.any():
        return parts[0]
    r = max([16, least, *(part.face_resolution for part in parts)])
    total = np.zeros((6, r, r, 3)) + constant
    for part in parts:
        own: Array = np.asarray(part.cube)
        if own.shape[1] != r:
            own = part.convert(layout="cube", face_resolution=r).reshape(6, r, r, 3)
        total += own
    return Environment(total.astype(np.float32), face_resolution=r)
