"""Base colours of Blender's materials, and materials that show the light."""

import bpy
import numpy as np

ATTRIBUTE = "Relumine"
#: Keys: of a material, the name of the one that it was made from; of an object, its lightmap.
MADE_FROM, LIGHTMAP = "relumine_made_from", "relumine_lightmap"
COLORS = {"BSDF_PRINCIPLED": "Base Color", "BSDF_DIFFUSE": "Color", "BSDF_GLOSSY": "Color",
          "BSDF_TOON": "Color", "BSDF_VELVET": "Color"}  # fmt: skip


def color_socket(material):
    """The base colour's socket of a material's first surface, or None."""
    if material is None or not material.use_nodes or material.node_tree is None:
        return None
    waiting = [node for node in material.node_tree.nodes
               if node.type == "OUTPUT_MATERIAL" and node.is_active_output]  # fmt: skip
    seen = set()
    while waiting:
        node = waiting.pop(0)
        if node.name in seen:
            continue
        seen.add(node.name)
        if node.type in COLORS:
            return node.inputs[COLORS[node.type]]
        waiting += [link.from_node for each in node.inputs for link in each.links]
    return None


def srgb_to_linear(values):
    return np.where(values <= 0.04045, values / 12.92, ((values + 0.055) / 1.055) ** 2.4)


def image_colors(image, uv):
    """(N, 3) linear colours of an image at uvs (N, 2)."""
    width, height = image.size
    pixels = np.empty(width * height * 4, dtype=np.float32)
    image.pixels.foreach_get(pixels)
    x = np.floor(uv[:, 0] * width).astype(np.int64) % width
    y = np.floor(uv[:, 1] * height).astype(np.int64) % height
    colors = pixels.reshape(height, width, 4)[y, x, :3].astype(np.float64)
    is_srgb = not image.is_float and image.colorspace_settings.name == "sRGB"
    return srgb_to_linear(colors) if is_srgb else colors


def base_colors(thing, mesh, notes):
    """(N, 3) base colours of an evaluated object's vertices: the mean of their corners'."""
    count = len(mesh.loop_triangles) or (mesh.calc_loop_triangles() or len(mesh.loop_triangles))
    vertex = np.empty(3 * count, dtype=np.int32)
    mesh.loop_triangles.foreach_get("vertices", vertex)
    slot = np.empty(count, dtype=np.int32)
    mesh.loop_triangles.foreach_get("material_index", slot)
    slot = np.repeat(slot, 3)
    colors = np.full((3 * count, 3), 0.8)
    for index, each in enumerate(thing.material_slots):
        of_slot = slot == index
        if each.material is not None and of_slot.any():
            colors[of_slot] = _colors_of(each.material, mesh, count, of_slot, notes)
    sums = np.zeros((len(mesh.vertices), 3))
    np.add.at(sums, vertex, colors)
    number = np.bincount(vertex, minlength=len(mesh.vertices))[:, None]
    return np.clip(np.where(number > 0, sums / np.maximum(number, 1), 0.8), 0.0, 1.0)


def _colors_of(material, mesh, count, of_slot, notes):
    original = bpy.data.materials.get(material.get(MADE_FROM, ""))
    socket = color_socket(original or material)
    if socket is not None and not socket.is_linked:
        return np.array(socket.default_value[:3])
    node = socket.links[0].from_node if socket is not None else None
    layer = mesh.uv_layers.active
    if node is not None and node.type == "TEX_IMAGE" and node.image is not None and layer:
        if node.image.size[0] > 0 and not node.inputs["Vector"].is_linked:
            uvs = np.empty(2 * len(mesh.loops), dtype=np.float32)
            layer.data.foreach_get("uv", uvs)
            corners = np.empty(3 * count, dtype=np.int32)
            mesh.loop_triangles.foreach_get("loops", corners)
            return image_colors(node.image, uvs.reshape(-1, 2)[corners[of_slot]])
    notes.add(f"{material.name}: its base colour is made by nodes; the viewport's colour bounces")
    return np.array(material.diffuse_color[:3])


def show_light(thing):
    """Gives an object materials that show its light times its base colour."""
    if not thing.material_slots:
        thing.data.materials.append(None)
    for slot in thing.material_slots:
        old = slot.material
        if old is not None and MADE_FROM in old:
            bind(old, thing)
            continue
        name = f"{old.name if old else thing.name} in Relumine's light"
        new = old.copy() if old is not None else bpy.data.materials.new(name)
        new.name, new.use_nodes = name, True
        new[MADE_FROM] = old.name if old is not None else ""
        if old is not None:
            old.use_fake_user = True
        _build(new)
        bind(new, thing)
        slot.material = new


def hide_light(thing):
    """Gives an object its own materials back."""
    for slot in thing.material_slots:
        if slot.material is not None and MADE_FROM in slot.material:
            slot.material = bpy.data.materials.get(slot.material[MADE_FROM])


def _build(material):
    tree = material.node_tree
    socket = color_socket(material)
    emission = tree.nodes.new("ShaderNodeEmission")
    product = tree.nodes.new("ShaderNodeVectorMath")
    product.operation = "MULTIPLY"
    light = tree.nodes.new("ShaderNodeAttribute")
    light.name, light.attribute_name = "relumine light", ATTRIBUTE
    picture = tree.nodes.new("ShaderNodeTexImage")
    picture.name = "relumine lightmap"
    output = tree.nodes.new("ShaderNodeOutputMaterial")
    for other in tree.nodes:
        if other.type == "OUTPUT_MATERIAL":
            other.is_active_output = other == output
    product.name = "relumine product"
    if socket is not None and socket.is_linked:
        tree.links.new(socket.links[0].from_socket, product.inputs[1])
    else:
        color = socket.default_value[:3] if socket is not None else material.diffuse_color[:3]
        product.inputs[1].default_value = color
    tree.links.new(product.outputs[0], emission.inputs["Color"])
    tree.links.new(emission.outputs[0], output.inputs["Surface"])
    for place, node in enumerate((light, picture, product, emission, output)):
        node.location = (200.0 * place, 700.0)


def bind(material, thing):
    """The light comes from the lightmap where the object has one, else from its attribute."""
    nodes, links = material.node_tree.nodes, material.node_tree.links
    picture = nodes.get("relumine lightmap")
    if picture is None or "relumine product" not in nodes:
        return
    picture.image = thing.get(LIGHTMAP)
    light = nodes["relumine light"] if picture.image is None else picture
    links.new(light.outputs["Color"], nodes["relumine product"].inputs[0])


def write_colors(thing, radiance):
    """Puts (N, 3) into the object's colour attribute, which is made where it is missing."""
    attributes = thing.data.color_attributes
    attribute = attributes.get(ATTRIBUTE)
    if attribute is None:
        attribute = attributes.new(ATTRIBUTE, "FLOAT_COLOR", "POINT")
        attributes.active_color = attribute
    rgba = np.ones((len(radiance), 4), dtype=np.float32)
    rgba[:, :3] = radiance
    attribute.data.foreach_set("color", rgba.ravel())
    thing.data.update_tag()


def write_lightmap(thing, radiance):
    """Puts (H, W, 3), the top row first, into the object's lightmap, a linear float image."""
    height, width, _ = radiance.shape
    image = thing.get(LIGHTMAP)
    if image is None or tuple(image.size) != (width, height):
        image = bpy.data.images.new(f"{thing.name} lightmap", width, height, float_buffer=True)
        thing[LIGHTMAP] = image
    rgba = np.ones((height, width, 4), dtype=np.float32)
    rgba[:, :, :3] = radiance[::-1]
    image.pixels.foreach_set(rgba.ravel())
    image.update()
    for slot in thing.material_slots:
        if slot.material is not None and MADE_FROM in slot.material:
            bind(slot.material, thing)
