"""Meshes as Relumine takes them, what stands around them, and keys that tell when they change."""

import hashlib

import numpy as np
from mathutils import kdtree

from .materials import base_colors
from .worlds import AXES

SURFACES = {"MESH", "CURVE", "SURFACE", "META", "FONT", "CURVES"}
#: A longer side of a triangle, in parts of the bounding box's diagonal, is coarse: `relumine
#: precompute` would add vertices.
COARSE = 1.0 / 40.0

#: The cosine up to which the normals of a face's corner and of its vertex are about the same.
LIKE = 0.9


def arrays_of(mesh):
    """Local vertices (N, 3) float32 and triangles (M, 3) of a mesh."""
    vertices = np.empty(3 * len(mesh.vertices), dtype=np.float32)
    mesh.vertices.foreach_get("co", vertices)
    mesh.calc_loop_triangles()
    triangles = np.empty(3 * len(mesh.loop_triangles), dtype=np.int32)
    mesh.loop_triangles.foreach_get("vertices", triangles)
    return vertices.reshape(-1, 3), triangles.reshape(-1, 3)


class Evaluated:
    """The mesh of an evaluated object, with its modifiers, as long as a `with` statement lasts."""

    def __init__(self, thing):
        self._thing = thing

    def __enter__(self):
        return self._thing.to_mesh()

    def __exit__(self, *details):
        self._thing.to_mesh_clear()


def placed(vertices, triangles, matrix):
    """In Relumine's axes and float32, with the outside outside."""
    matrix = np.array(matrix, dtype=np.float64)
    world = (vertices @ matrix[:3, :3].T + matrix[:3, 3]) @ AXES.T
    if np.linalg.det(matrix[:3, :3]) < 0:
        triangles = triangles[:, ::-1]
    return world.astype(np.float32), triangles


def same_place(one, other):
    """Whether two matrices are the same, but for roundings."""
    return np.allclose(np.array(one, dtype=np.float64), np.array(other, dtype=np.float64), atol=5e-6)


def way(at, to):
    """The matrix that leads from one place to another, in Relumine's axes."""
    axes = np.eye(4)
    axes[:3, :3] = AXES
    return axes @ to @ np.linalg.inv(at) @ axes.T


class Shape:
    """The longest side of the triangles whose vertices show an object's light; do flat faces or
    sharp edges share vertices, which have one light?"""

    def __init__(self, thing, depsgraph):
        self.name = thing.name
        with Evaluated(thing.evaluated_get(depsgraph)) as mesh:
            # Where a modifier makes vertices, the object's own have the light.
            shown = mesh if len(mesh.vertices) == len(thing.data.vertices) else thing.data
            own, corners = arrays_of(shown)
            self.is_flat = has_sharp_vertices(shown, corners)
            vertices, triangles = placed(own, corners, thing.matrix_world)
        corners = vertices[triangles]
        sides = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2)
        self.longest = float(sides.max(initial=0.0))


def coarse_notes(shapes, vertices):
    """What is to be known of shapes whose vertices are few for the size of them all."""
    size = float(np.linalg.norm(vertices.max(axis=0) - vertices.min(axis=0)))
    notes = set()
    coarse = sorted(shape.name for shape in shapes if shape.longest > COARSE * size)
    if coarse:
        which = "it" if len(coarse) == 1 else "them"
        notes.add(f"{some_of(coarse)}: coarse: subdivide {which}, or use Lightmap")
    flat = sorted(shape.name for shape in shapes if shape.is_flat)
    if flat:
        notes.add(f"{some_of(flat)}: faces are flat, but light is smooth over their vertices: "
                  "shade smooth, split the sharp edges, or use Lightmap")  # fmt: skip
    return notes


def some_of(names):
    """Three names, and how many more there are."""
    return ", ".join(names[:3]) + (f" and {len(names) - 3} more" if len(names) > 3 else "")


def with_uvs(mesh, vertices, triangles):
    """Vertices are split where the active UV map is and at sharp edges: (vertices, triangles, uvs,
    normals, old vertex)."""
    uvs = uvs_of(mesh)
    if not len(uvs):
        return None
    corners = loops_of_triangles(mesh)
    uv = uvs.reshape(-1, 2)[corners]
    normals = corner_normals(mesh)[corners]
    rows = np.column_stack([triangles.reshape(-1).astype(np.float64), uv, np.round(normals, 4)])
    _, first, inverse = np.unique(rows, axis=0, return_index=True, return_inverse=True)
    old = triangles.reshape(-1)[first]
    return vertices[old], inverse.reshape(-1, 3), uv[first], normals[first], old


def loops_of_triangles(mesh):
    """(3 M,): the loop of each corner of its triangles, which are there."""
    loops = np.empty(3 * len(mesh.loop_triangles), dtype=np.int32)
    mesh.loop_triangles.foreach_get("loops", loops)
    return loops


def has_sharp_vertices(mesh, triangles):
    """Whether a face has another normal at a vertex than the mesh has there."""
    normals = np.empty(3 * len(mesh.vertices), dtype=np.float32)
    mesh.vertices.foreach_get("normal", normals)
    of_vertices = normals.reshape(-1, 3)[triangles.reshape(-1)]
    of_corners = corner_normals(mesh)[loops_of_triangles(mesh)]
    return bool((np.sum(of_corners * of_vertices, axis=1) < LIKE).any())


def corner_normals(mesh):
    """(N, 3), those of the faces where they are flat."""
    normals = np.empty(3 * len(mesh.loops), dtype=np.float32)
    if hasattr(mesh, "corner_normals"):  # Blender 4.1
        mesh.corner_normals.foreach_get("vector", normals)
    else:
        mesh.calc_normals_split()
        mesh.loops.foreach_get("normal", normals)
    return normals.reshape(-1, 3)


def placed_normals(normals, matrix):
    """In Relumine's axes."""
    inverse = np.linalg.inv(np.array(matrix, dtype=np.float64)[:3, :3])
    world = normals @ inverse @ AXES.T
    return world / np.maximum(np.linalg.norm(world, axis=1, keepdims=True), 1e-30)


def rendered_names(view_layer):
    """Names of objects in collections that render."""
    names = set()

    def walk(layer):
        if layer.exclude or layer.collection.hide_render:
            return
        names.update(thing.name for thing in layer.collection.objects)
        for child in layer.children:
            walk(child)

    walk(view_layer.layer_collection)
    return names


def blocks(thing):
    """Whether an object keeps light from others when it renders."""
    return (thing.type in SURFACES and not thing.hide_render
            and getattr(thing, "visible_shadow", True)
            and not getattr(thing, "is_holdout", False))  # fmt: skip


def surroundings(depsgraph, names, rendered):
    """(evaluated object, matrix) of all that blocks light but the objects `names`."""
    for instance in depsgraph.object_instances:
        original = instance.object.original
        if not instance.show_self or not blocks(original):
            continue
        if not instance.is_instance and (original.name in names or original.name not in rendered):
            continue
        if instance.is_instance and instance.parent.original.name not in rendered:
            continue
        yield instance.object, instance.matrix_world.copy()


def unseen(scene, depsgraph, names, rendered):
    """Names of objects that would render, but are hidden in the viewport."""
    shown = {instance.object.original.name for instance in depsgraph.object_instances
             if not instance.is_instance}  # fmt: skip
    return sorted(
        thing.name for thing in scene.objects
        if thing.name in rendered - shown - names and blocks(thing)
        and thing.type == "MESH" and len(thing.data.polygons)
    )  # fmt: skip


class Pieces:
    """Meshes that are put together."""

    def __init__(self):
        self.vertices, self.triangles, self.colors, self.count = [], [], [], 0

    def add(self, vertices, triangles, colors=None):
        self.vertices.append(vertices)
        self.triangles.append(triangles)
        self.colors.append(colors)
        self.count += len(vertices)

    def extend(self, other):
        for piece in zip(other.vertices, other.triangles, other.colors):
            self.add(*piece)

    def arrays(self):
        firsts = np.cumsum([0, *map(len, self.vertices)])
        triangles = [each + first for each, first in zip(self.triangles, firsts)]
        return np.concatenate(self.vertices), np.concatenate(triangles)


def surroundings_of(depsgraph, names, rendered, with_colors):
    """Pieces of all that blocks light around objects, and remarks about its colours."""
    pieces, notes = Pieces(), set()
    for thing, matrix in surroundings(depsgraph, names, rendered):
        with Evaluated(thing) as mesh:
            if mesh is None or not len(mesh.polygons):
                continue
            colors = base_colors(thing, mesh, notes) if with_colors else None
            pieces.add(*placed(*arrays_of(mesh), matrix), colors)
    return pieces, notes


# Keys


def digest(*parts):
    made = hashlib.blake2b(digest_size=12)
    for part in parts:
        made.update(part if isinstance(part, bytes) else np.ascontiguousarray(part).tobytes())
    return made.hexdigest()


_shapes = {}  # object: digest of its evaluated mesh


def shape_changed(name=None):
    """Forgets the digest of an object, or of all."""
    if name is None:
        _shapes.clear()
    else:
        _shapes.pop(name, None)


def uvs_of(mesh):
    """The active UV map, corner by corner; nothing without one."""
    layer = mesh.uv_layers.active
    uvs = np.empty(0 if layer is None else 2 * len(mesh.loops), dtype=np.float32)
    if layer is not None:
        layer.data.foreach_get("uv", uvs)
    return uvs


def key_of(thing, matrix, has_lightmap=False):
    """Tells an evaluated object's mesh and place from any other; a lightmap's UV map, too."""
    name = thing.original.name_full
    if name not in _shapes or thing.original.mode == "EDIT":
        with Evaluated(thing) as mesh:
            _shapes[name] = ("", "") if mesh is None else (
                digest(*arrays_of(mesh)), digest(uvs_of(mesh)))  # fmt: skip
    place = np.round(np.array(matrix, dtype=np.float64), 5) + 0.0
    shape, uvs = _shapes[name]
    return f"{shape} {uvs}" if has_lightmap else shape, digest(place)


def surroundings_key(depsgraph, names, rendered):
    keys = [".".join(key_of(thing, matrix))
            for thing, matrix in surroundings(depsgraph, names, rendered)]  # fmt: skip
    return digest("".join(sorted(keys)).encode())


def nearest_vertices(thing, evaluated):
    """For each vertex of an object's own mesh, the vertex of its evaluated mesh that it became.

    Most modifiers keep the number of vertices; then they are the same. Others (subdivision, mirror,
    array) are asked for the nearest vertex; Blender spreads the colours over the rest.
    """
    own = thing.data.vertices
    if len(own) == len(evaluated.data.vertices):
        return np.arange(len(own))
    tree = kdtree.KDTree(len(evaluated.data.vertices))
    for index, vertex in enumerate(evaluated.data.vertices):
        tree.insert(vertex.co, index)
    tree.balance()
    return np.array([tree.find(vertex.co)[1] for vertex in own])


def fill_of(places, width, height):
    """For each texel of a lightmap, the receiver that it shows: empty ones take a neighbour's."""
    index = np.full(width * height, -1, dtype=np.int64)
    index[places] = np.arange(len(places))
    index = index.reshape(height, width)
    for _ in range(max(width, height)):
        if (index >= 0).all():
            break
        wide = np.pad(index, 1, constant_values=-1)
        for dy, dx in ((0, 1), (2, 1), (1, 0), (1, 2)):
            near = wide[dy : dy + height, dx : dx + width]
            index = np.where(index < 0, near, index)
    return index


def is_shared(thing):
    """Whether other objects of the file have the same mesh."""
    return thing.data.users - thing.data.use_fake_user > 1
