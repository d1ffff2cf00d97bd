"""Blender's lamps: suns are the engine's distant lights; lamps near the scene are points whose
shadows the engine traces."""

import bpy
import numpy as np
from mathutils import Vector

import relumine

from .worlds import AXES

#: Suns that stand for the world do not light on top of it.
PULLED = "relumine_pulled"
#: Suns wider than this, in radians, are several directions, and so are wide lamps.
SHARP = np.radians(1.0)
POINTS = 16
#: An area lamp of P watts has the intensity P / pi towards its axis; before Blender 4 it was P / 4.
#: Times 4 pi / P. Measured with 3.4, 4.2, 4.5 and 5.0.
AREA_GAIN = 4.0 if bpy.app.version >= (4, 0, 0) else np.pi


class Lamp:
    """What lights as an evaluated light object in its place does, in Blender's axes."""

    def __init__(self, thing, matrix):
        data = thing.data
        self.name, self.type = thing.original.name, data.type
        self.matrix = np.array(matrix, dtype=np.float64)
        self.power = data.energy * color_of(data)
        self.size = {"SUN": lambda: (data.angle,), "POINT": lambda: (data.shadow_soft_size,),
                     "SPOT": lambda: (data.shadow_soft_size, data.spot_size, data.spot_blend),
                     "AREA": lambda: (data.shape, data.size, data.size_y, spread_of(data)),
                     }[data.type]()  # fmt: skip
        self.has_nodes = bool(data.use_nodes and data.node_tree and not plain_nodes(data))
        self.blocks = getattr(data, "use_shadow", True)

    def key(self):
        return (self.type, self.size, self.matrix.tobytes(), self.power.tobytes())

    def remarks(self):
        if self.has_nodes:
            yield f"{self.name}: nodes of lamps are not followed"
        if not self.blocks:
            yield f"{self.name}: its shadow stays"
        if self.type == "AREA" and self.size[3] < np.pi - 1e-3:
            yield f"{self.name}: the spread of area lamps is not followed"


def color_of(data):
    """A lamp's colour, with the temperature and the exposure that Blender 4.5 gave it."""
    color = np.array(data.color, dtype=np.float64)
    if getattr(data, "use_temperature", False):
        color *= np.array(data.temperature_color)
    gain = 2.0 ** getattr(data, "exposure", 0.0)
    return color * (gain if getattr(data, "normalize", True) else gain * area_of(data))


def area_of(data):
    """What Cycles 4.5 multiplies a lamp's strength with where it is not normalized (measured)."""
    if data.type == "SUN":
        return np.pi * np.sin(data.angle / 2) ** 2 if data.angle > 0.0 else 1.0
    if data.type == "AREA":
        size_y = data.size if data.shape in ("SQUARE", "DISK") else data.size_y
        return data.size * size_y * (np.pi / 4 if data.shape in ("DISK", "ELLIPSE") else 1.0)
    return 4.0 * np.pi * data.shadow_soft_size**2 if data.shadow_soft_size > 0.0 else 4.0


def spread_of(data):
    return getattr(data, "spread", np.pi)


def plain_nodes(data):
    """Whether a lamp's nodes are an emission of strength 1 and white, as new ones are."""
    nodes = [node for node in data.node_tree.nodes if node.type != "OUTPUT_LIGHT"]
    if len(nodes) != 1 or nodes[0].type != "EMISSION":
        return not nodes
    strength, color = nodes[0].inputs["Strength"], nodes[0].inputs["Color"]
    return (not strength.is_linked and not color.is_linked and strength.default_value == 1.0
            and tuple(color.default_value)[:3] == (1.0, 1.0, 1.0))  # fmt: skip


def lamps_of(depsgraph):
    """All lamps that are seen here and render, those of instances too."""
    result = []
    for instance in depsgraph.object_instances:
        thing = instance.object
        if thing.type != "LIGHT" or thing.original.hide_render or thing.original.get(PULLED):
            continue
        if thing.data.energy > 0:
            result.append(Lamp(thing, instance.matrix_world))
    return result


def disc(count):
    """Points spread evenly over the unit disc."""
    i = np.arange(count)
    radius, angle = np.sqrt((i + 0.5) / count), i * np.pi * (3.0 - np.sqrt(5.0))
    return np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=1)


def frame_of(direction):
    """Two unit vectors across a direction."""
    across = np.cross(direction, [1.0, 0.0, 0.0] if abs(direction[0]) < 0.7 else [0.0, 1.0, 0.0])
    across /= np.linalg.norm(across)
    return across, np.cross(direction, across)


def light_list(suns):
    """The suns as a relumine.LightList; wide ones are several lights."""
    directions, irradiances = [], []
    for sun in suns:
        axis = sun.matrix[:3, 2] / np.linalg.norm(sun.matrix[:3, 2])
        places = [axis]
        if sun.size[0] > SHARP:
            u, v = frame_of(axis)
            radius = np.sin(min(sun.size[0], np.pi * 0.99) / 2)
            count = POINTS if sun.size[0] < np.radians(6) else 4 * POINTS
            flat = radius * disc(count)
            height = np.sqrt(1.0 - (flat**2).sum(axis=1))
            places = flat[:, :1] * u + flat[:, 1:] * v + height[:, None] * axis
        directions.extend(places)
        # A sun's strength is the irradiance of a surface that faces it.
        whole = sum(float(place @ axis) for place in places)
        irradiances.extend([sun.power / whole] * len(places))
    return relumine.LightList(np.array(directions) @ AXES.T, np.array(irradiances))


def points_of(lamp, centre):
    """Points (K, 3) of a lamp, its axis, and each point's part of the power."""
    place, axis = lamp.matrix[:3, 3], -lamp.matrix[:3, 2]
    axis = axis / np.linalg.norm(axis)
    if lamp.type == "AREA":
        shape, size, size_y, _ = lamp.size
        if shape in ("SQUARE", "DISK"):
            size_y = size
        if shape in ("DISK", "ELLIPSE"):
            flat = 0.5 * disc(POINTS)
        else:
            i = np.arange(4)
            flat = np.stack(np.meshgrid(i, i), axis=-1).reshape(-1, 2) / 4.0 - 0.375
        points = place + flat[:, :1] * size * lamp.matrix[:3, 0]
        return points + flat[:, 1:] * size_y * lamp.matrix[:3, 1], axis
    radius = lamp.size[0]
    away = centre - place
    distance = float(np.linalg.norm(away))
    if radius <= 0.005 * distance or distance == 0.0:
        return place[None], axis
    u, v = frame_of(away / distance)
    flat = radius * disc(POINTS)
    return place + flat[:, :1] * u + flat[:, 1:] * v, axis


def spot_factor(lamp, cosine):
    """How Cycles lets a spot's light fall towards its edge."""
    _, angle, blend = lamp.size
    edge = np.cos(0.5 * angle)
    x = np.clip((cosine - edge) / max((1.0 - edge) * blend, 1e-9), 0.0, 1.0)
    fall = x * x * (3.0 - 2.0 * x)
    # Before Blender 4 the cosine counted, too.
    return np.where(cosine > edge, fall * (cosine if bpy.app.version < (4, 0, 0) else 1.0), 0.0)


def radiance_of(lamp, relighter):
    """(N, 3) outgoing radiance for albedo 1 under a point, spot or area lamp, with shadows."""
    scene = relighter.scene
    positions = np.asarray(scene.positions, dtype=np.float64) @ AXES
    normals = np.asarray(scene.normals, dtype=np.float64) @ AXES
    points, axis = points_of(lamp, positions.mean(axis=0))
    seen = relighter.sees(points @ AXES.T)
    gain = np.zeros(len(positions))
    for point, is_seen in zip(points, seen.T):
        way = point - positions
        square = np.maximum((way**2).sum(axis=1), 1e-12)
        way /= np.sqrt(square)[:, None]
        part = np.maximum((way * normals).sum(axis=1), 0.0) / square * is_seen
        if lamp.type == "AREA":
            part *= np.maximum(-(way @ axis), 0.0) * AREA_GAIN
        elif lamp.type == "SPOT":
            part *= spot_factor(lamp, -(way @ axis))
        gain += part
    # A lamp of P watts has the intensity P / 4 pi.
    gain *= 1.0 / (4.0 * np.pi * np.pi * len(points))
    return (gain[:, None] * lamp.power).astype(np.float32)


def towards(direction):
    """The rotation of a sun that a direction (Blender's axes) leads to."""
    return Vector(direction).to_track_quat("Z", "Y")
