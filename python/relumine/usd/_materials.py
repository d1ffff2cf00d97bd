"""Materials of UsdShade as glTF's: UsdPreviewSurface, and standard_surface of MaterialX.

Each property that is not carried is named once.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Callable, Dict, List, Optional, Sequence, Set, Tuple

import numpy as np
from numpy.typing import NDArray
from pxr import Sdf, Usd, UsdShade  # type: ignore

from ._glb import Glb
from ._images import Image, Images, Input, Place
from ._notes import Notes

Array = NDArray[Any]
#: A chain of shading nodes is followed so far.
DEEPEST = 32


@dataclass
class Look:
    """A material of the scene, and what its vertices must have."""

    index: int
    #: The primvars of TEXCOORD_0 and TEXCOORD_1.
    uvs: List[str] = field(default_factory=list)
    #: The primvar that multiplies the colour.
    color: Optional[str] = None


class _Slots:
    """A material's primvars of uvs, and its textures."""

    def __init__(self, images: Images, glb: Glb, notes: Notes, path: Any) -> None:
        self._images, self._glb, self._notes, self._path = images, glb, notes, path
        self.uvs: List[str] = []

    def texture(
        self, channels: Sequence[Input], *, is_srgb: bool, alpha: Optional[Input] = None
    ) -> Tuple[Optional[Dict[str, Any]], float]:
        index, factor = self._images.texture(channels, is_srgb=is_srgb, alpha=alpha)
        if index is None:
            return None, 1.0
        place = next(c.place for c in [*channels, alpha] if isinstance(c, Image))
        if place.primvar not in self.uvs:
            self.uvs.append(place.primvar)
        info: Dict[str, Any] = {"index": index, "texCoord": self.uvs.index(place.primvar)}
        transform = place.transform()
        if transform:
            self._glb.use("KHR_texture_transform")
            info["extensions"] = {"KHR_texture_transform": transform}
        return info, factor


class Network:
    """Follows the connections of a material's inputs."""

    def __init__(self, shader: UsdShade.Shader, time: Usd.TimeCode, images: Images, notes: Notes):
        self._shader, self._time, self._images, self._notes = shader, time, images, notes
        self.path = shader.GetPath()
        #: The primvar that the diffuse colour reads from vertices.
        self.color_primvar: Optional[str] = None

    def given(self) -> Set[str]:
        return {i.GetBaseName() for i in self._shader.GetInputs() if self._is_given(i)}

    @staticmethod
    def _is_given(i: UsdShade.Input) -> bool:
        return bool(i.HasConnectedSource() or i.GetAttr().HasAuthoredValue())

    def input(self, name: str, fallback: Any) -> Any:
        """A number, a tuple, an Image, or the fallback."""
        found = self._shader.GetInput(name)
        if not found:
            return fallback
        return self._followed(found, fallback, 0)

    def number(self, name: str, fallback: float) -> float:
        value = self.input(name, fallback)
        if isinstance(value, (int, float)):
            return float(value)
        self._notes.add(f"a texture of {name} is left out: one number counts", self.path)
        return fallback

    def _followed(self, i: UsdShade.Input, fallback: Any, depth: int) -> Any:
        if depth > DEEPEST:
            self._notes.add("nodes in a circle, or too many in a row: left out", self.path)
            return fallback
        try:
            sources = UsdShade.Utils.GetValueProducingAttributes(i)
        except Exception:
            sources = []
        if not sources:
            value = i.Get(self._time)
            return fallback if value is None else _plain(value)
        source = sources[0]
        kind = UsdShade.Utils.GetType(source.GetName())
        if kind == UsdShade.AttributeType.Input:
            value = source.Get(self._time)
            return fallback if value is None else _plain(value)
        node = UsdShade.Shader(source.GetPrim())
        output = UsdShade.Utils.GetBaseNameAndType(source.GetName())[0]
        return self._node(node, output, fallback, depth + 1)

    def _node(self, node: UsdShade.Shader, output: str, fallback: Any, depth: int) -> Any:
        name = node.GetIdAttr().Get(self._time) or ""
        if name == "UsdUVTexture":
            return self._uv_texture(node, output, fallback, depth)
        if name.startswith("UsdPrimvarReader_"):
            variable = self._of(node, "varname", "", depth)
            if name.endswith(("float3", "color")) or variable in ("displayColor",):
                self.color_primvar = str(variable)
                return (1.0, 1.0, 1.0)
            value = self._of(node, "fallback", fallback, depth)
            self._notes.add(f"the primvar {variable} of a material is left out", self.path)
            return value
        if name.startswith(("ND_image_", "ND_tiledimage_", "ND_gltf_image", "ND_gltf_colorimage")):
            return self._mtlx_image(node, name, fallback, depth)
        if name.startswith("ND_constant_"):
            return self._of(node, "value", fallback, depth)
        if name.startswith(("ND_geomcolor", "ND_geompropvalue_color3")):
            self.color_primvar = str(self._of(node, "geomprop", "displayColor", depth))
            return (1.0, 1.0, 1.0)
        if name.startswith(
            ("ND_normalmap", "ND_convert_", "ND_dot_", "ND_extract_", "ND_swizzle_")
        ):
            value = self._of(node, "in", fallback, depth)
            if isinstance(value, Image) and name.startswith(("ND_extract_", "ND_swizzle_")):
                index = self._of(node, "index", 0, depth)
                letters = self._of(node, "channels", "rgba"[int(index)], depth)
                letter = {"x": "r", "y": "g", "z": "b", "w": "a"}.get(letters[0], letters[0])
                return _replaced(value, channels=letter)
            return value
        if name.startswith("ND_separate"):
            value = self._of(node, "in", fallback, depth)
            letter = {"outx": "r", "outy": "g", "outz": "b"}.get(output, output[-1:])
            return _replaced(value, channels=letter) if isinstance(value, Image) else value
        if name.startswith("ND_multiply_"):
            return self._product(node, fallback, depth)
        self._notes.add(f"the node {name or node.GetPath().name} is left out", self.path)
        return fallback

    def _of(self, node: UsdShade.Shader, name: str, fallback: Any, depth: int) -> Any:
        found = node.GetInput(name)
        return self._followed(found, fallback, depth) if found else fallback

    def _product(self, node: UsdShade.Shader, fallback: Any, depth: int) -> Any:
        a, b = (self._of(node, n, 1.0, depth) for n in ("in1", "in2"))
        if isinstance(b, Image):
            a, b = b, a
        if isinstance(b, Image):
            self._notes.add("a product of textures is left out: the first counts", self.path)
            return a
        if isinstance(a, Image):
            by = list(b)[:3] if isinstance(b, tuple) else [float(b)] * 3
            return _replaced(
                a,
                scale=tuple(x * y for x, y in zip(a.scale, [*by, 1.0])),
                bias=tuple(x * y for x, y in zip(a.bias, [*by, 1.0])),
            )
        product = np.asarray(a, float) * np.asarray(b, float)
        return tuple(product.tolist()) if product.ndim else float(product)

    def _asset(self, node: UsdShade.Shader, depth: int) -> Optional[str]:
        found = node.GetInput("file")
        if not found:
            return None
        sources = UsdShade.Utils.GetValueProducingAttributes(found)
        value = (sources[0] if sources else found.GetAttr()).Get(self._time)
        if value is None or not isinstance(value, Sdf.AssetPath) or not value.path:
            return None
        path = value.resolvedPath
        if "<UDIM>" in value.path:
            self._notes.add(
                "textures in tiles (UDIM) are left out: the first tile counts", self.path
            )
            tile = value.path.replace("<UDIM>", "1001")
            attribute = sources[0] if sources else found.GetAttr()
            stack = attribute.GetPropertyStack(self._time)
            path = stack[0].layer.ComputeAbsolutePath(tile) if stack else tile
        if not path:
            self._notes.add(
                "a texture is left out: expected a file, got none of its name", value.path
            )
            return None
        return str(path)

    def _uv_texture(self, node: UsdShade.Shader, output: str, fallback: Any, depth: int) -> Any:
        path = self._asset(node, depth)
        rest = self._of(node, "fallback", (0.0, 0.0, 0.0, 1.0), depth)
        if path is not None:
            image = Image(
                path,
                output if output in ("rgb", "r", "g", "b", "a") else "rgb",
                self._place(node, depth),
                str(self._of(node, "sourceColorSpace", "auto", depth)),
                _four(self._of(node, "scale", (1.0, 1.0, 1.0, 1.0), depth), 1.0),
                _four(self._of(node, "bias", (0.0, 0.0, 0.0, 0.0), depth), 0.0),
                _four(rest, 1.0),
            )
            if self._images.exists(image):
                return image
        rest = _four(rest, 1.0)
        has_fallback = (
            node.GetInput("fallback") and node.GetInput("fallback").GetAttr().HasAuthoredValue()
        )
        if not has_fallback:
            return fallback
        return rest[:3] if output == "rgb" else rest["rgba".index(output[0])]

    def _place(self, node: UsdShade.Shader, depth: int) -> Place:
        wraps = []
        for name in ("wrapS", "wrapT"):
            wrap = str(self._of(node, name, "useMetadata", depth))
            wraps.append("repeat" if wrap == "useMetadata" else wrap)
        found = node.GetInput("st")
        scale, rotation, translation = (1.0, 1.0), 0.0, (0.0, 0.0)
        primvar = "st"
        seen = 0
        while found and found.HasConnectedSource() and seen < DEEPEST:
            seen += 1
            sources = UsdShade.Utils.GetValueProducingAttributes(found)
            if (
                not sources
                or UsdShade.Utils.GetType(sources[0].GetName()) != UsdShade.AttributeType.Output
            ):
                break
            reader = UsdShade.Shader(sources[0].GetPrim())
            name = reader.GetIdAttr().Get(self._time) or ""
            if name.startswith("UsdPrimvarReader_"):
                primvar = str(self._of(reader, "varname", "st", depth)) or "st"
                break
            if name == "UsdTransform2d":
                if (scale, rotation, translation) != ((1.0, 1.0), 0.0, (0.0, 0.0)):
                    self._notes.add("transforms of uvs in a row: the last one counts", self.path)
                    found = reader.GetInput("in")
                    continue
                s = self._of(reader, "scale", (1.0, 1.0), depth)
                t = self._of(reader, "translation", (0.0, 0.0), depth)
                scale, translation = (float(s[0]), float(s[1])), (float(t[0]), float(t[1]))
                rotation = float(self._of(reader, "rotation", 0.0, depth))
                found = reader.GetInput("in")
                continue
            self._notes.add(f"the node {name} is left out", self.path)
            break
        return Place(primvar, scale, rotation, translation, (wraps[0], wraps[1]))

    def _mtlx_image(self, node: UsdShade.Shader, name: str, fallback: Any, depth: int) -> Any:
        path = self._asset(node, depth)
        default = self._of(node, "default", fallback, depth)
        if path is None:
            return default
        width = name.rsplit("_", 1)[-1]
        channels = "r" if width == "float" else "rgb"
        found = node.GetInput("file")
        sources = UsdShade.Utils.GetValueProducingAttributes(found)
        attribute = sources[0] if sources else found.GetAttr()
        space = attribute.GetColorSpace() if attribute.HasColorSpace() else "raw"
        tiling = self._of(node, "uvtiling", (1.0, 1.0), depth)
        offset = self._of(node, "uvoffset", (0.0, 0.0), depth)
        primvar = "st"
        coordinate = node.GetInput("texcoord")
        if coordinate and coordinate.HasConnectedSource():
            source = UsdShade.Utils.GetValueProducingAttributes(coordinate)
            reader = UsdShade.Shader(source[0].GetPrim()) if source else None
            reader_name = (reader.GetIdAttr().Get(self._time) or "") if reader else ""
            if reader_name.startswith(("ND_geompropvalue", "UsdPrimvarReader_")):
                key = "geomprop" if reader_name.startswith("ND_") else "varname"
                primvar = str(self._of(reader, key, "st", depth))
            elif not reader_name.startswith("ND_texcoord"):
                self._notes.add(f"the node {reader_name} is left out", self.path)
        wraps = [
            str(self._of(node, n, "periodic", depth)) for n in ("uaddressmode", "vaddressmode")
        ]
        place = Place(
            primvar,
            (float(tiling[0]), float(tiling[1])),
            0.0,
            (-float(offset[0]), -float(offset[1])),
            (
                {"constant": "clamp"}.get(wraps[0], wraps[0]),
                {"constant": "clamp"}.get(wraps[1], wraps[1]),
            ),
        )
        image = Image(path, channels, place, space)
        return image if self._images.exists(image) else default


def _replaced(image: Image, **changes: Any) -> Image:
    from dataclasses import replace

    return replace(image, **changes)


def _plain(value: Any) -> Any:
    if isinstance(value, (bool, int, float, str)):
        return value
    if isinstance(value, Sdf.AssetPath):
        return value
    try:
        return tuple(float(x) for x in value)
    except TypeError:
        return value


def _four(value: Any, last: float) -> Tuple[float, ...]:
    if not isinstance(value, tuple):
        return (float(value),) * 3 + (last,)
    return tuple((*value, *([last] * 4))[:4])


def _color(value: Any) -> Tuple[float, float, float]:
    r, g, b = (
        (value * 3 if len(value) == 1 else value[:3]) if isinstance(value, tuple) else [value] * 3
    )
    return float(r), float(g), float(b)


def _clamped(values: Sequence[float]) -> List[float]:
    return [min(max(float(v), 0.0), 1.0) for v in values]


class Materials:
    """Materials of a stage, each once."""

    def __init__(self, glb: Glb, notes: Notes, meters: float) -> None:
        self._glb, self._notes, self._meters = glb, notes, meters
        self.images = Images(glb, notes)
        self._looks: Dict[Any, Look] = {}

    def _add(self, material: Dict[str, Any]) -> int:
        for extension in material.get("extensions", {}):
            self._glb.use(extension)
        self._glb.materials.append(material)
        return len(self._glb.materials) - 1

    def lamp(self, name: str, radiance: Array, texture: Any, prim: Usd.Prim) -> int:
        """A surface that glows on its front and reflects nothing."""
        material: Dict[str, Any] = {
            "name": name,
            "pbrMetallicRoughness": {"baseColorFactor": [0, 0, 0, 1], "metallicFactor": 0},
            "extensions": {"KHR_materials_specular": {"specularFactor": 0}},
        }
        if texture is not None:
            path = texture.resolvedPath
            if not path:
                self._notes.add("a light's texture is left out: no such file", texture.path)
            else:
                image = Image(path, "rgb", Place(wrap=("clamp", "clamp")))
                index, factor = self.images.texture([image], is_srgb=True)
                if index is not None:
                    material["emissiveTexture"] = {"index": index}
                    radiance = radiance * factor
        self._emit(material, [float(x) for x in radiance])
        return self._add(material)

    @staticmethod
    def _emit(material: Dict[str, Any], radiance: Sequence[float]) -> None:
        strength = max(max(radiance), 1.0)
        material["emissiveFactor"] = [x / strength for x in radiance]
        if strength > 1.0:
            material.setdefault("extensions", {})["KHR_materials_emissive_strength"] = {
                "emissiveStrength": strength
            }

    def plain(self, double_sided: bool, has_color: bool) -> Look:
        """A surface without a material: displayColor, or the grey of UsdPreviewSurface."""
        key = ("plain", double_sided, has_color)
        if key not in self._looks:
            color = 1.0 if has_color else 0.18
            index = self._add(
                {
                    "name": "displayColor" if has_color else "no material",
                    "pbrMetallicRoughness": {
                        "baseColorFactor": [color] * 3 + [1.0],
                        "metallicFactor": 0.0,
                        "roughnessFactor": 1.0,
                    },
                    "extensions": {"KHR_materials_specular": {"specularFactor": 0.0}},
                    "doubleSided": double_sided,
                }
            )
            self._looks[key] = Look(index, [], "displayColor" if has_color else None)
        return self._looks[key]

    def look(
        self, material: UsdShade.Material, double_sided: bool, time: Usd.TimeCode
    ) -> Optional[Look]:
        """The look of a material; None where it has no surface that is known."""
        key = (material.GetPath(), double_sided)
        if key in self._looks:
            return self._looks[key]
        found = self._made(material, double_sided, time)
        if found is not None:
            self._looks[key] = found
        return found

    def _made(self, material: UsdShade.Material, two: bool, time: Usd.TimeCode) -> Optional[Look]:
        path = material.GetPath()
        names = []
        for context in ("", "mtlx"):
            shader = material.ComputeSurfaceSource(context)[0]
            if not shader:
                continue
            name = shader.GetIdAttr().Get(time) or ""
            names.append(name or shader.GetPath().name)
            convert: Dict[str, Callable[..., Any]] = {
                "UsdPreviewSurface": self._preview_surface,
                "ND_UsdPreviewSurface_surfaceshader": self._preview_surface,
                "ND_standard_surface_surfaceshader": self._standard_surface,
                "ND_open_pbr_surface_surfaceshader": self._open_pbr,
                "ND_gltf_pbr_surfaceshader": self._gltf_pbr,
            }
            if name not in convert:
                continue
            network = Network(shader, time, self.images, self._notes)
            slots = _Slots(self.images, self._glb, self._notes, path)
            result: Dict[str, Any] = {"name": material.GetPrim().GetName()}
            if two:
                result["doubleSided"] = True
            convert[name](network, slots, result)
            if material.ComputeDisplacementSource()[0] and "displacement" in network.given():
                self._notes.add("displacement is left out", path)
            return Look(self._add(result), slots.uvs, network.color_primvar)
        if names:
            self._notes.add(
                f"the surface {' and '.join(names)} is left out: grey stands for it", path
            )
        else:
            self._notes.add("a material without a surface: grey stands for it", path)
        return None

    # Inputs as glTF's.

    def _base(
        self, slots: _Slots, pbr: Dict[str, Any], color: Input, alpha: Input, key: str = "baseColor"
    ) -> None:
        factor = [1.0, 1.0, 1.0, 1.0]
        texture_key = "diffuseTexture" if key == "diffuse" else f"{key}Texture"
        if not isinstance(alpha, Image):
            factor[3] = min(
                max(float(alpha if not isinstance(alpha, tuple) else alpha[0]), 0.0), 1.0
            )
        if isinstance(color, Image) or isinstance(alpha, Image):
            with_alpha = alpha if isinstance(alpha, Image) else None
            channels: List[Input] = [color] if isinstance(color, Image) else [_color(color)]
            info, strength = slots.texture(channels, is_srgb=True, alpha=with_alpha)
            if info is not None:
                pbr[texture_key] = info
                if strength > 1.0:
                    self._notes.add("colours above 1 are 1", slots._path)
            elif not isinstance(color, Image):
                factor[:3] = _clamped(_color(color))
        else:
            factor[:3] = _clamped(_color(color))
        pbr[f"{key}Factor"] = factor

    def _alpha(self, material: Dict[str, Any], alpha: Input, threshold: float) -> None:
        if threshold > 0.0:
            material.update(alphaMode="MASK", alphaCutoff=threshold)
        elif (
            isinstance(alpha, Image)
            or float(alpha if not isinstance(alpha, tuple) else alpha[0]) < 1.0
        ):
            material["alphaMode"] = "BLEND"

    @staticmethod
    def _fraction(value: Input) -> float:
        number: Any = value[0] if isinstance(value, tuple) else value
        return _clamped([number])[0]

    def _roughness(self, slots: _Slots, pbr: Dict[str, Any], metallic: Input, rough: Input) -> None:
        pbr["metallicFactor"] = 1.0 if isinstance(metallic, Image) else self._fraction(metallic)
        pbr["roughnessFactor"] = 1.0 if isinstance(rough, Image) else self._fraction(rough)
        if isinstance(metallic, Image) or isinstance(rough, Image):
            channels: List[Input] = [1.0, _single(rough), _single(metallic)]
            if not isinstance(rough, Image):
                channels[1] = 1.0
            if not isinstance(metallic, Image):
                channels[2] = 1.0
            info, _ = slots.texture(channels, is_srgb=False)
            if info is not None:
                pbr["metallicRoughnessTexture"] = info

    def _factor_and_texture(
        self, slots: _Slots, into: Dict[str, Any], name: str, value: Input, channel: int
    ) -> None:
        """A number of 0 to 1, which glTF has in one channel of a texture."""
        if isinstance(value, Image):
            channels: List[Input] = [0.0, 0.0, 0.0]
            channels[channel] = _single(value)
            info, _ = slots.texture(channels, is_srgb=False)
            if info is not None:
                into[f"{name}Factor"] = 1.0
                into[f"{name}Texture"] = info
        else:
            into[f"{name}Factor"] = self._fraction(value)

    def _normal(self, slots: _Slots, material: Dict[str, Any], normal: Any, path: Any) -> None:
        if not isinstance(normal, Image):
            return
        # UsdPreviewSurface scales by 2 and moves by -1, glTF does so by itself.
        scale = tuple(0.5 * s for s in normal.scale)
        bias = tuple(0.5 * b + 0.5 for b in normal.bias)
        plain = _replaced(normal, scale=scale, bias=bias, channels="rgb")
        if normal.scale[:3] == (1.0, 1.0, 1.0) and normal.bias[:3] == (0.0, 0.0, 0.0):
            self._notes.add(
                "a normal map without scale 2 and bias -1 is taken as if it had them", path
            )
            plain = _replaced(normal, channels="rgb")
        if self.images._is_srgb(plain) and plain.space == "auto":
            plain = _replaced(plain, space="raw")
            self._notes.add("a normal map of colour space auto is taken as raw", path)
        info, _ = slots.texture([plain], is_srgb=False)
        if info is not None:
            material["normalTexture"] = info

    def _emission(
        self, slots: _Slots, material: Dict[str, Any], color: Input, weight: float = 1.0
    ) -> None:
        if isinstance(color, Image):
            info, factor = slots.texture([color], is_srgb=True)
            if info is not None:
                material["emissiveTexture"] = info
                self._emit(material, [factor * weight] * 3)
            return
        radiance = [max(x, 0.0) * weight for x in _color(color)]
        if any(radiance):
            self._emit(material, radiance)

    def _preview_surface(self, n: Network, slots: _Slots, material: Dict[str, Any]) -> None:
        extensions: Dict[str, Any] = material.setdefault("extensions", {})
        color = n.input("diffuseColor", (0.18, 0.18, 0.18))
        alpha = n.input("opacity", 1.0)
        threshold = n.number("opacityThreshold", 0.0)
        rough = n.input("roughness", 0.5)
        if int(n.number("useSpecularWorkflow", 0)):
            gloss: Dict[str, Any] = {}
            self._base(slots, gloss, color, alpha, "diffuse")
            specular = n.input("specularColor", (0.0, 0.0, 0.0))
            gloss["glossinessFactor"] = (
                1.0 if isinstance(rough, Image) else 1.0 - self._fraction(rough)
            )
            gloss["specularFactor"] = (
                [1.0] * 3 if isinstance(specular, Image) else _clamped(_color(specular))
            )
            if isinstance(specular, Image) or isinstance(rough, Image):
                shiny: Input = 1.0
                if isinstance(rough, Image):
                    scale = tuple(-x for x in rough.scale)
                    bias = tuple(1.0 - x for x in rough.bias)
                    shiny = _single(_replaced(rough, scale=scale, bias=bias))
                colors: List[Input] = [specular if isinstance(specular, Image) else (1.0, 1.0, 1.0)]
                info, _ = slots.texture(colors, is_srgb=True, alpha=shiny)
                if info is not None:
                    gloss["specularGlossinessTexture"] = info
            extensions["KHR_materials_pbrSpecularGlossiness"] = gloss
            if n.number("clearcoat", 0.0) > 0.0:
                self._notes.add("the clear coat of a specular workflow is left out", n.path)
        else:
            pbr: Dict[str, Any] = {}
            self._base(slots, pbr, color, alpha)
            self._roughness(slots, pbr, n.input("metallic", 0.0), rough)
            material["pbrMetallicRoughness"] = pbr
            ior = n.number("ior", 1.5)
            if ior != 1.5:
                extensions["KHR_materials_ior"] = {"ior": max(ior, 1.0)}
            coat = n.input("clearcoat", 0.0)
            if isinstance(coat, Image) or coat > 0.0:
                clear: Dict[str, Any] = {}
                self._factor_and_texture(slots, clear, "clearcoat", coat, 0)
                coat_rough = n.input("clearcoatRoughness", 0.01)
                self._factor_and_texture(slots, clear, "clearcoatRoughness", coat_rough, 1)
                extensions["KHR_materials_clearcoat"] = clear
        self._alpha(material, alpha, threshold)
        self._emission(slots, material, n.input("emissiveColor", (0.0, 0.0, 0.0)))
        self._normal(slots, material, n.input("normal", None), n.path)
        if "occlusion" in n.given():
            self._notes.add("occlusion is left out: shadows are computed", n.path)
        displacement = n.input("displacement", 0.0)
        if isinstance(displacement, Image) or displacement:
            self._notes.add("displacement is left out", n.path)
        if not extensions:
            del material["extensions"]

    def _layered(
        self, n: Network, slots: _Slots, material: Dict[str, Any], names: Dict[str, Any]
    ) -> None:
        """standard_surface and what came of it: glTF's names to theirs, with the fallback."""
        extensions: Dict[str, Any] = material.setdefault("extensions", {})

        def of(key: str) -> Any:
            name, fallback = names[key]
            return fallback if name is None else n.input(name, fallback)

        weight = of("base")
        if isinstance(weight, Image):
            self._notes.add(f"a texture of {names['base'][0]} is left out", n.path)
            weight = 1.0
        color = of("color")
        if isinstance(color, Image):
            by = (weight, weight, weight, 1.0)
            color = _replaced(
                color,
                scale=tuple(x * w for x, w in zip(color.scale, by)),
                bias=tuple(x * w for x, w in zip(color.bias, by)),
            )
        else:
            color = tuple(x * weight for x in _color(color))
        alpha = of("opacity")
        if isinstance(alpha, Image) and len(alpha.channels) > 1:
            alpha = _replaced(alpha, channels="r")
        elif isinstance(alpha, tuple):
            alpha = sum(alpha[:3]) / 3.0
        color, of_thin_walls = self._thin_wall(n, slots, extensions, color, names)
        pbr: Dict[str, Any] = {}
        self._base(slots, pbr, color, alpha)
        metal = of("metal")
        self._roughness(slots, pbr, metal, of("roughness"))
        material["pbrMetallicRoughness"] = pbr
        self._alpha(material, alpha, 0.0)
        ior = of("ior")
        if not isinstance(ior, Image) and ior != 1.5:
            extensions["KHR_materials_ior"] = {"ior": max(float(ior), 1.0)}
        specular: Dict[str, Any] = {}
        strength, tint = of("specular"), of("specular_color")
        if isinstance(strength, Image):
            self._notes.add(f"a texture of {names['specular'][0]} is left out", n.path)
            strength = 1.0
        if float(strength) < 1.0:
            specular["specularFactor"] = self._fraction(strength)
        if isinstance(tint, Image):
            info, _ = slots.texture([tint], is_srgb=True)
            if info is not None:
                specular["specularColorTexture"] = info
        elif _color(tint) != (1.0, 1.0, 1.0):
            specular["specularColorFactor"] = [max(x, 0.0) for x in _color(tint)]
        if specular:
            extensions["KHR_materials_specular"] = specular
        coat = of("coat")
        if isinstance(coat, Image) or coat > 0.0:
            clear: Dict[str, Any] = {}
            self._factor_and_texture(slots, clear, "clearcoat", coat, 0)
            self._factor_and_texture(slots, clear, "clearcoatRoughness", of("coat_roughness"), 1)
            extensions["KHR_materials_clearcoat"] = clear
        sheen = of("sheen")
        if not isinstance(sheen, Image) and sheen > 0.0:
            cloth = of("sheen_color")
            if isinstance(cloth, Image):
                self._notes.add("a texture of sheen is left out", n.path)
                cloth = (1.0, 1.0, 1.0)
            sheen_rough = of("sheen_roughness")
            extensions["KHR_materials_sheen"] = {
                "sheenColorFactor": _clamped([x * sheen for x in _color(cloth)]),
                "sheenRoughnessFactor": (
                    0.3 if isinstance(sheen_rough, Image) else self._fraction(sheen_rough)
                ),
            }
        self._film(n, extensions, names)
        passing = of("transmission")
        if isinstance(passing, Image) or passing > 0.0:
            glass: Dict[str, Any] = {}
            self._factor_and_texture(slots, glass, "transmission", passing, 0)
            extensions["KHR_materials_transmission"] = glass
            through = of("transmission_color")
            tint = (1.0, 1.0, 1.0) if isinstance(through, Image) else _color(through)
            extensions.update(self._body(n, names, tint))
            takes = "attenuationDistance" in extensions.get("KHR_materials_volume", {})
            if (
                names["transmission_color"][0]
                and not isinstance(through, Image)
                and not isinstance(passing, Image)
                and passing == 1.0
            ):
                surface = (1.0, 1.0, 1.0) if takes else tint
                pbr["baseColorFactor"] = [*_clamped(surface), pbr["baseColorFactor"][3]]
                pbr.pop("baseColorTexture", None)
        glow = of("emission")
        if isinstance(glow, Image):
            self._notes.add("a texture of emission's strength is left out", n.path)
            glow = 1.0
        if glow > 0.0:
            self._emission(slots, material, of("emission_color"), float(glow))
        self._normal(slots, material, _map_of(of("normal")), n.path)
        pairs = [pair for pair in names.values() if isinstance(pair, tuple)]
        known = {name for name, _ in pairs if name} | set(names["silent"][1]) | of_thin_walls
        known |= set(names["glass"])
        for name in sorted(n.given() - known):
            value = n.input(name, None)
            if value in (0, 0.0, False, None, (0.0, 0.0, 0.0)) or name.endswith(("_IOR", "_ior")):
                continue
            self._notes.add(f"{name} is left out", n.path)
        if not extensions:
            del material["extensions"]

    def _thin_wall(
        self,
        n: Network,
        slots: _Slots,
        extensions: Dict[str, Any],
        base: Input,
        names: Dict[str, Any],
    ) -> Tuple[Input, Set[str]]:
        """Subsurface of a leaf or of paper: light that goes to the other side.

        Returns the colour of what is reflected, and the names of the inputs.
        """
        thin, scatter, fallback = names.get("thin_wall", ("", "", 0.0))
        part = n.input("subsurface_weight" if scatter else "subsurface", 0.0) if thin else 0.0
        if not thin or isinstance(part, Image) or part <= 0.0:
            return base, set()
        part = self._fraction(part)
        color = n.input("subsurface_color", fallback)
        if not n.number(thin, 0.0):
            # Of a thick body light comes out in that colour, here where it goes in.
            if part == 1.0:
                return color, set()
            if isinstance(base, Image) or isinstance(color, Image):
                return base, set()
            return tuple((1.0 - part) * b + part * c for b, c in zip(_color(base), _color(color))), set()
        # standard_surface passes all of it on, OpenPBR a half, or more towards where it scatters.
        ahead = n.number(scatter, 0.0) if scatter else 1.0
        passed = part * min(max(0.5 * (1.0 + ahead), 0.0), 1.0)
        leaf: Dict[str, Any] = {"diffuseTransmissionFactor": passed}
        if isinstance(color, Image):
            info, _ = slots.texture([color], is_srgb=True)
            if info is not None:
                leaf["diffuseTransmissionColorTexture"] = info
        else:
            leaf["diffuseTransmissionColorFactor"] = _clamped(_color(color))
        extensions["KHR_materials_diffuse_transmission"] = leaf
        used = {thin, scatter, "subsurface", "subsurface_weight", "subsurface_color"}
        used |= {"subsurface_radius", "subsurface_radius_scale", "subsurface_scale"}
        if passed == part or passed == 1.0:
            return base, used
        if part == 1.0:
            return color, used
        if isinstance(base, Image) or isinstance(color, Image):
            self._notes.add(
                "of a thin wall with textures the base colour alone is reflected", n.path
            )
            return base, used
        mixed = [
            ((1.0 - part) * b + (part - passed) * c) / (1.0 - passed)
            for b, c in zip(_color(base), _color(color))
        ]
        return tuple(mixed), used

    def _body(self, n: Network, names: Dict[str, Any], tint: Tuple[float, ...]) -> Dict[str, Any]:
        """Glass that is no thin wall: what it takes on the way, and how it parts colours."""
        thin = names["thin_wall"][0] if "thin_wall" in names else ""
        if thin and n.number(thin, 0.0):
            return {}
        volume: Dict[str, Any] = {"thicknessFactor": 1.0}
        if names["depth"] is None:  # glTF's own
            volume["thicknessFactor"] = n.number("thickness", 0.0) * self._meters
            if volume["thicknessFactor"] <= 0.0:
                return {}
            depth, tint = n.number("attenuation_distance", 0.0), _color(n.input("attenuation_color", tint))
        else:
            depth = n.number(names["depth"], 0.0)
        if depth > 0.0:
            volume["attenuationDistance"] = depth * self._meters
            volume["attenuationColor"] = _clamped(tint)
            if names["depth"] is not None:
                volume["thicknessFactor"] = depth * self._meters
        body = {"KHR_materials_volume": volume}
        # glTF has 20 over Abbe's number.
        abbe, scale, own = names["dispersion"]
        value = n.number(own, 0.0) if own else 0.0
        if abbe is not None and n.number(*abbe) > 0.0:
            part = n.number(*scale) if scale[0] else scale[1]
            value = 20.0 / n.number(*abbe) * part
        if value > 0.0:
            body["KHR_materials_dispersion"] = {"dispersion": value}
        return body

    def _film(self, n: Network, extensions: Dict[str, Any], names: Dict[str, Any]) -> None:
        """A thin film of one thickness; glTF has it in nanometres."""
        weight, thickness, ior = (
            fallback if name is None else n.input(name, fallback)
            for name, fallback in (names["film"], names["film_thickness"], names["film_ior"])
        )
        if any(isinstance(value, Image) for value in (weight, thickness, ior)):
            self._notes.add("a textured thin film is left out", n.path)
        elif weight > 0.0 and thickness > 0.0:
            extensions["KHR_materials_iridescence"] = {
                "iridescenceFactor": self._fraction(weight),
                "iridescenceIor": max(float(ior), 1.0),
                "iridescenceThicknessMaximum": float(thickness) * names["nanometres"],
            }

    def _standard_surface(self, n: Network, slots: _Slots, material: Dict[str, Any]) -> None:
        one = (1.0, 1.0, 1.0)
        self._layered(n, slots, material, {
            "base": ("base", 0.8), "color": ("base_color", one), "opacity": ("opacity", one),
            "metal": ("metalness", 0.0), "roughness": ("specular_roughness", 0.2),
            "ior": ("specular_IOR", 1.5), "specular": ("specular", 1.0),
            "specular_color": ("specular_color", one), "coat": ("coat", 0.0),
            "coat_roughness": ("coat_roughness", 0.1), "sheen": ("sheen", 0.0),
            "sheen_color": ("sheen_color", one), "sheen_roughness": ("sheen_roughness", 0.3),
            "transmission": ("transmission", 0.0), "transmission_color": ("transmission_color", one),
            "emission": ("emission", 0.0), "emission_color": ("emission_color", one),
            "normal": ("normal", None), "film": (None, 1.0),
            "film_thickness": ("thin_film_thickness", 0.0), "film_ior": ("thin_film_IOR", 1.5),
            "nanometres": 1.0, "thin_wall": ["thin_walled", "", one],
            "depth": "transmission_depth",
            "dispersion": [("transmission_dispersion", 0.0), (None, 1.0), None],
            "glass": ["thin_walled", "transmission_depth", "transmission_dispersion"],
            "silent": (None, ("tangent",)),
        })  # fmt: skip

    def _open_pbr(self, n: Network, slots: _Slots, material: Dict[str, Any]) -> None:
        one = (1.0, 1.0, 1.0)
        self._layered(n, slots, material, {
            "base": ("base_weight", 1.0), "color": ("base_color", (0.8, 0.8, 0.8)),
            "opacity": ("geometry_opacity", 1.0), "metal": ("base_metalness", 0.0),
            "roughness": ("specular_roughness", 0.3), "ior": ("specular_ior", 1.5),
            "specular": ("specular_weight", 1.0), "specular_color": ("specular_color", one),
            "coat": ("coat_weight", 0.0), "coat_roughness": ("coat_roughness", 0.0),
            "sheen": ("fuzz_weight", 0.0), "sheen_color": ("fuzz_color", one),
            "sheen_roughness": ("fuzz_roughness", 0.5), "transmission": ("transmission_weight", 0.0),
            "transmission_color": ("transmission_color", one),
            "emission": ("emission_luminance", 0.0), "emission_color": ("emission_color", one),
            "normal": ("geometry_normal", None), "film": ("thin_film_weight", 0.0),
            "film_thickness": ("thin_film_thickness", 0.5), "film_ior": ("thin_film_ior", 1.4),
            "nanometres": 1000.0,
            "thin_wall": ["geometry_thin_walled", "subsurface_scatter_anisotropy", (0.8, 0.8, 0.8)],
            "depth": "transmission_depth",
            "dispersion": [("transmission_dispersion_abbe_number", 20.0),
                           ("transmission_dispersion_scale", 0.0), None],
            "glass": ["geometry_thin_walled", "transmission_depth",
                      "transmission_dispersion_abbe_number", "transmission_dispersion_scale"],
            "silent": (None, ("geometry_tangent",)),
        })  # fmt: skip

    def _gltf_pbr(self, n: Network, slots: _Slots, material: Dict[str, Any]) -> None:
        one = (1.0, 1.0, 1.0)
        self._layered(n, slots, material, {
            "base": (None, 1.0), "color": ("base_color", one), "opacity": ("alpha", 1.0),
            "metal": ("metallic", 1.0), "roughness": ("roughness", 1.0), "ior": ("ior", 1.5),
            "specular": ("specular", 1.0), "specular_color": ("specular_color", one),
            "coat": ("clearcoat", 0.0), "coat_roughness": ("clearcoat_roughness", 0.0),
            "sheen": (None, 1.0), "sheen_color": ("sheen_color", (0.0, 0.0, 0.0)),
            "sheen_roughness": ("sheen_roughness", 0.0), "transmission": ("transmission", 0.0),
            "transmission_color": (None, one), "emission": ("emissive_strength", 1.0),
            "emission_color": ("emissive", (0.0, 0.0, 0.0)), "normal": ("normal", None),
            "film": ("iridescence", 0.0), "film_thickness": ("iridescence_thickness", 100.0),
            "film_ior": ("iridescence_ior", 1.3), "nanometres": 1.0, "depth": None,
            "dispersion": [None, None, "dispersion"],
            "glass": ["thickness", "attenuation_distance", "attenuation_color", "dispersion"],
            "silent": (None, ("alpha_mode", "alpha_cutoff", "occlusion", "tangent")),
        })  # fmt: skip

    def punctual(self, name: str, intensity: Array, cone: Any, matrix: Array) -> None:
        strength = float(max(intensity.max(), 1e-30))
        light: Dict[str, Any] = {
            "type": "spot" if cone else "point",
            "color": [float(x) / strength for x in intensity],
            "intensity": strength,
            "name": name,
        }
        if cone:
            inner, outer = (float(np.radians(x)) for x in cone)
            light["spot"] = {
                "innerConeAngle": min(inner, outer - 1e-4),
                "outerConeAngle": min(outer, float(np.pi / 2)),
            }
        self._glb.punctual(light, name, matrix)


def _single(value: Input) -> Input:
    """One channel of a texture: the first one."""
    if isinstance(value, Image) and len(value.channels) > 1:
        return _replaced(value, channels=value.channels[0])
    return value


def _map_of(normal: Any) -> Any:
    """A normal map of MaterialX, as UsdPreviewSurface has it."""
    if not isinstance(normal, Image):
        return None
    return _replaced(normal, scale=(2.0,) * 3 + (1.0,), bias=(-1.0,) * 3 + (0.0,), space="raw")
