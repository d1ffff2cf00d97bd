"""What the world's nodes say, and the environment that they make."""

import os
import zlib

import bpy
import numpy as np
from mathutils import Euler, Matrix

import relumine

from .bake import baker
from .bake_worker import all_trees

#: Relumine's (x, y, z) from Blender's: (x, z, -y).
AXES = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]])
#: Skies with a sun of their own, which no mapping turns: Blender 5 has two in place of Nishita's.
SUNNY_SKIES = {"NISHITA", "SINGLE_SCATTERING", "MULTIPLE_SCATTERING"}
#: Names of linear colour spaces with Rec.709 primaries in Blender 3 and 4.
LINEAR = {"Linear", "Linear Rec.709", "Non-Color", "Raw"}
#: Coordinates that only a camera has.
OF_CAMERA = {"Camera", "Window", "Reflection"}
#: What nodes look like in their editor.
LOOKS = {"location", "width", "width_hidden", "height", "dimensions", "label", "select", "parent",
         "color", "use_custom_color", "hide", "show_options", "show_preview", "show_texture",
         "bl_idname", "rna_type", "is_active_output", "internal_links", "interface", "inputs",
         "outputs", "name_property"}  # fmt: skip


def source_of(socket):
    """The socket that a socket gets its value from, or None. Reroutes are passed."""
    while socket.is_linked:
        link = socket.links[0]
        if link.from_node.type != "REROUTE":
            return link.from_socket
        socket = link.from_node.inputs[0]
    return None


def node_before(socket, kind):
    source = source_of(socket)
    node = source.node if source is not None else None
    return node if node is not None and node.type == kind and not node.mute else None


def rotation_of(mapping):
    """The (3, 3) matrix by which a mapping turns directions; None where it does more."""
    if mapping.mute or any(each.is_linked for each in mapping.inputs if each.name != "Vector"):
        return None
    source = source_of(mapping.inputs["Vector"])
    if source is None or source.node.type != "TEX_COORD" or source.name != "Generated":
        return None
    if "Location" in mapping.inputs and any(mapping.inputs["Location"].default_value):
        if mapping.vector_type in ("POINT", "TEXTURE"):
            return None
    if any(abs(each - 1.0) > 1e-6 for each in mapping.inputs["Scale"].default_value):
        return None
    matrix = Euler(mapping.inputs["Rotation"].default_value, "XYZ").to_matrix()
    return matrix.transposed() if mapping.vector_type == "TEXTURE" else matrix


def turning_node(tree):
    """The one mapping through which all of a tree's textures look, if there is one."""
    mappings = [node for node in tree.nodes if node.type == "MAPPING"]
    if len(mappings) != 1 or rotation_of(mappings[0]) is None:
        return None
    for node in tree.nodes:
        if node.type in ("GROUP", "SCRIPT", "NEW_GEOMETRY", "CAMERA", "ATTRIBUTE", "TANGENT",
                         "LAYER_WEIGHT", "FRESNEL", "NORMAL", "BUMP"):  # fmt: skip
            return None
        if node.type == "TEX_COORD":
            targets = [link.to_node for output in node.outputs for link in output.links]
            if any(target != mappings[0] for target in targets):
                return None
        if node.type == "TEX_SKY" and node.sky_type in SUNNY_SKIES:
            return None
        if node.type.startswith("TEX_") and node.type != "TEX_COORD":
            if "Vector" not in node.inputs or source_of(node.inputs["Vector"]) is None:
                return None
    return mappings[0]


def states_colors(path):
    """Whether a file's header says of colours what Relumine follows, and Blender perhaps does not."""
    with open(path, "rb") as file:
        head = file.read(1 << 16)
    return any(word in head for word in (b"chromaticities\0", b"colorInteropID\0", b"\nPRIMARIES="))


class WorldLight:
    """How a world lights: a colour, a picture file or a bake; a turn, a strength.

    turn      (3, 3), takes directions of the picture to those of Blender's world
    key       what changes with the picture
    remarks   what is not followed
    missing   those of them about images that are not there
    """

    def __init__(self, scene, depsgraph=None):
        evaluated = scene if depsgraph is None else scene.evaluated_get(depsgraph)
        world = evaluated.world
        self.kind, self.color, self.path = "color", (0.0, 0.0, 0.0), None
        self.strength, self.turn = 1.0, Matrix.Identity(3)
        self.remarks, self.missing = [], []
        self.frame, self._images = scene.frame_current, []
        self.world, self._turned_by, self._strength_of = world and world.original, "", ""
        if world is None:
            pass
        elif not world.use_nodes or world.node_tree is None:
            self.color = tuple(world.color)
        else:
            self._read(world)
        content = {"color": self.color, "image": self.path and (self.path, stamp(self.path))}
        self.key = (self.kind, self._signature(world) if self.kind == "baked"
                    else content[self.kind])  # fmt: skip

    def _read(self, world):
        output = next((node for node in world.node_tree.nodes
                       if node.type == "OUTPUT_WORLD" and node.is_active_output), None)  # fmt: skip
        if output is None:
            return
        if output.inputs["Volume"].is_linked:
            self.remarks.append("the world's volume is not followed")
        if not output.inputs["Surface"].is_linked:
            return
        lights = not hasattr(world, "cycles_visibility") or world.cycles_visibility.diffuse
        background = node_before(output.inputs["Surface"], "BACKGROUND")
        if background is not None and not background.inputs["Strength"].is_linked:
            self.strength = background.inputs["Strength"].default_value
            self._strength_of = background.name
            color = background.inputs["Color"]
            if source_of(color) is None and lights:
                self.color = tuple(color.default_value)[:3]
                return
            if lights and self._read_image(node_before(color, "TEX_ENVIRONMENT")):
                return
        self.kind = "baked"
        mapping = turning_node(world.node_tree)
        if mapping is not None:
            self.turn, self._turned_by = rotation_of(mapping).transposed(), mapping.name
        for tree in all_trees(world.node_tree):
            self._remark(tree)
            images = [getattr(node, "image", None) for node in tree.nodes]
            self._images += [image for image in images if image is not None]

    def _read_image(self, texture):
        """Whether a texture is a file that Relumine reads as Blender does."""
        image = texture.image if texture is not None else None
        if image is None or image.source != "FILE" or image.packed_file or image.is_dirty:
            return False
        path = os.path.normpath(bpy.path.abspath(image.filepath, library=image.library))
        if (
            texture.projection != "EQUIRECTANGULAR"
            or not path.lower().endswith((".exr", ".hdr"))
            or image.colorspace_settings.name not in LINEAR
            or not os.path.exists(path)
            or states_colors(path)
        ):
            return False
        if source_of(texture.inputs["Vector"]) is not None:
            mapping = node_before(texture.inputs["Vector"], "MAPPING")
            rotation = rotation_of(mapping) if mapping is not None else None
            if rotation is None:
                return False
            self.turn = rotation.transposed()
        self.kind, self.path = "image", path
        return True

    def _remark(self, tree):
        for node in tree.nodes:
            if node.type == "TEX_COORD":
                names = [each.name for each in node.outputs if each.is_linked]
                if OF_CAMERA & set(names):
                    self.remarks.append(f"{node.name}: coordinates of a camera are not followed")
            if node.type == "SCRIPT":
                self.remarks.append(f"{node.name}: scripts are not followed")
            image = getattr(node, "image", None)
            if image is not None and image.source in ("FILE", "MOVIE") and not image.packed_file:
                path = bpy.path.abspath(image.filepath, library=image.library)
                if not os.path.exists(path):
                    self.missing.append(f"image {image.name}: cannot read {path}: no such file")
                    self.remarks.append(self.missing[-1])

    def _signature(self, world):
        skipped = {(self._turned_by, "Rotation"), (self._strength_of, "Strength")}
        visibility = getattr(world, "cycles_visibility", None)
        parts = [visibility.diffuse if visibility else True, world.original.name_full]
        for tree in all_trees(world.node_tree):
            top = tree.name == world.node_tree.name
            parts.append([described_node(node, skipped if top else ()) for node in tree.nodes])
            parts.append([(link.from_node.name, link.from_socket.identifier, link.to_node.name,
                           link.to_socket.identifier) for link in tree.links])  # fmt: skip
            if any(getattr(getattr(node, "image", None), "source", "") in ("MOVIE", "SEQUENCE")
                   for node in tree.nodes):  # fmt: skip
                parts.append(self.frame)
        return repr(parts)

    @property
    def is_turned_live(self):
        """Whether a bake is turned after it was made."""
        return self._turned_by != ""

    def environment(self, face_resolution, wait):
        """The relumine.Environment, turned; None while a bake is under way."""
        if self.kind == "color":
            return relumine.Environment(np.full((6, 8, 8, 3), self.color))
        key = (*self.key, face_resolution)
        if key not in _pictures:
            made = self._picture(key, face_resolution, wait)
            if made is None:
                return None
            _pictures.clear()
            _pictures[key] = made
        turn = AXES @ np.array(self.turn, dtype=np.float64) @ AXES.T
        return _pictures[key].turned(turn=orthonormal(turn), face_resolution=face_resolution)

    def _picture(self, key, face_resolution, wait):
        options = {"convention": "blender", "face_resolution": face_resolution}
        if self.kind == "image":
            return relumine.Environment.load(self.path, **options)
        if baker.take(key) is None:
            width = int(np.clip(8 * face_resolution, 256, 8192)) // 32 * 32
            baker.ask(key, self.world, self._images, frame=self.frame, width=width,
                      turned_by=self._turned_by, strength_of=self._strength_of)  # fmt: skip
        pixels = baker.wait(key) if wait else baker.take(key)
        return None if pixels is None else relumine.Environment(pixels, fix_env=True, **options)


_pictures = {}  # the newest picture, unturned


def forget():
    _pictures.clear()
    baker.baked.clear()


def stamp(path):
    return os.path.getmtime(path) if os.path.exists(path) else 0


def orthonormal(matrix):
    """The rotation next to a matrix of single precision."""
    u, _, v = np.linalg.svd(matrix)
    return u @ v


def described_node(node, skipped):
    """All that a node's picture depends on, as plain values."""
    inputs = [
        (each.identifier, plain(each.default_value)) for each in node.inputs
        if hasattr(each, "default_value") and (node.name, each.name) not in skipped
    ]  # fmt: skip
    outputs = [plain(each.default_value) for each in node.outputs
               if node.type in ("VALUE", "RGB", "NORMAL")]  # fmt: skip
    return [inputs, outputs, described(node, 0)]


def described(struct, depth):
    result = [struct.bl_rna.identifier]
    for name in struct.bl_rna.properties.keys():
        if name in LOOKS:
            continue
        value = getattr(struct, name)
        if isinstance(value, bpy.types.Image):
            result.append((name, described_image(value)))
        elif isinstance(value, bpy.types.Object):
            result.append((name, value.name, plain(value.matrix_world)))
        elif isinstance(value, bpy.types.ID):
            result.append((name, value.name))
        elif isinstance(value, bpy.types.bpy_struct):
            if depth < 3 and not isinstance(value, bpy.types.Node):
                result.append((name, described(value, depth + 1)))
        elif isinstance(value, bpy.types.bpy_prop_collection):
            result.append((name, [described(each, depth + 1) for each in value]))
        else:
            result.append((name, plain(value)))
    return result


def plain(value):
    if isinstance(value, Matrix):
        return [plain(row) for row in value]
    if isinstance(value, (str, bytes, int, float, bool)) or value is None:
        return value
    try:
        return [round(each, 7) if isinstance(each, float) else each for each in value]
    except TypeError:
        return str(value)


def described_image(image):
    path = bpy.path.abspath(image.filepath, library=image.library)
    result = [image.name_full, path, stamp(path), image.source, image.colorspace_settings.name,
              image.alpha_mode, image.packed_file.size if image.packed_file else 0,
              image.generated_type, plain(image.generated_color), plain(image.size)]  # fmt: skip
    if image.is_dirty and image.size[0] > 0:
        pixels = np.empty(len(image.pixels), dtype=np.float32)
        image.pixels.foreach_get(pixels)
        result.append(zlib.crc32(pixels))
    return result
