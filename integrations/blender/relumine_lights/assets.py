"""Assets: objects that were precomputed together, their scene file, and their light."""

import contextlib
import os
import threading
import warnings

import bpy
import numpy as np

import relumine

from . import geometry, lamps
from .following import Following, Way, listed
from .materials import ATTRIBUTE, LIGHTMAP, base_colors, write_colors, write_lightmap
from .worlds import WorldLight, forget, stamp

#: Keys of objects: the scene file, the vertices in it that are this object's, their digest there;
#: the object's mesh and place at the precompute, what stood around; whose ties they are; how it
#: was made, what is to be known of that, in lines, and its matrix then.
PATH, FIRST, COUNT, IN_FILE = ("relumine_prt", "relumine_first", "relumine_count",
                               "relumine_in_file")  # fmt: skip
SHAPE, PLACE, AROUND, OWNER = ("relumine_shape", "relumine_place", "relumine_around",
                               "relumine_owner")  # fmt: skip
TOLERANCE, BOUNCES, TEXELS = "relumine_tolerance", "relumine_bounces", "relumine_texels"
NOTES, MATRIX = "relumine_notes", "relumine_matrix"
TIES = (PATH, FIRST, COUNT, IN_FILE, SHAPE, PLACE, AROUND, OWNER, TOLERANCE, BOUNCES, TEXELS,
        NOTES, MATRIX)  # fmt: skip

#: Since Blender 4.5 a property of a path says that it may begin at the .blend.
RELATIVE = {"PATH_SUPPORTS_BLEND_RELATIVE"} if bpy.app.version >= (4, 5, 0) else set()


class LiveScene:
    """A scene file in the light of the world and of the lamps."""

    def __init__(self, path):
        self.stamp = stamp(path)
        self.scene = relumine.Scene.load(path)
        self.bounces = self.scene.settings["bounces"]
        self.world = relumine.Relighter(self.scene)
        self.suns = None
        self.keys = {}
        self.parts = {}
        self._digests = {}
        # Where objects stand in memory that do not stand where the file has them, and the places
        # that were refused: {first vertex: matrix}, {first vertex: (matrix, error)}.
        self._places, self._refused = {}, {}
        self.following, self.followed = None, ""
        self._is_stale = False  # the radiance is not that of its parts
        self.radiance = np.zeros((self.scene.num_receivers, 3), dtype=np.float32)

    def holds(self, thing):
        """Whether the file has this object's vertices where its ties say."""
        first, count, wanted = thing[FIRST], thing[COUNT], thing[IN_FILE]
        if (first, count) not in self._digests:
            own = self.scene.vertices[first : first + count]
            self._digests[first, count] = geometry.digest(own)
        return self._digests[first, count] == wanted

    def follow(self, things, wait, progress=None):
        """Lets the light follow what stands elsewhere than in memory, in memory alone: now, or
        beside the user's work, until it is called again."""
        if self.following is not None and (wait or not self.following.is_busy):
            self._take()
        if self.following is not None:
            return
        ways = self._ways(things)
        if ways:
            self.following = Following(self.world, ways)
            if not wait:
                self.following.start()
                return
            self._take(progress)

    def _ways(self, things):
        result = {}
        for thing in things:
            if thing[TEXELS] or MATRIX not in thing or str(thing[FIRST]) not in self.scene.groups:
                continue
            first, to = thing[FIRST], np.array(thing.matrix_world, dtype=np.float64)
            at = self._places.get(first, np.array(thing[MATRIX]).reshape(4, 4))
            if geometry.same_place(at, to) or self.refusal(thing):
                continue
            try:
                result[first] = Way(thing.name, geometry.way(at, to), to)
            except np.linalg.LinAlgError as error:
                self._refused[first] = to, str(error)
        return result

    def _take(self, progress=None):
        """Takes what has followed, when it is there."""
        followed, self.following = self.following, None
        followed.finish(progress)
        for first in followed.places:
            self._refused.pop(first, None)
        self._refused.update(followed.refused)
        self._places.update(followed.places)
        if followed.places:
            if np.ndim(self.parts.get("world", 0.0)):
                self.parts["world"] = self.world.radiance
            self.suns = None  # made anew of the scene as it stands
            for part in ("suns", "lamps"):
                self.keys.pop(part, None)
            self._is_stale = True
            names = listed(sorted(followed.names))
            self.followed = f"Light followed {names} in {followed.seconds:.1f} s"
        if followed.error is not None:
            raise followed.error

    def close(self):
        if self.following is not None:
            self.following.cancel()

    def refusal(self, thing):
        """Why it could not follow an object to where that is, or None."""
        refused = self._refused.get(thing[FIRST])
        if refused is None or not geometry.same_place(refused[0], thing.matrix_world):
            return None
        return refused[1]

    def follows(self, thing):
        """Whether the light is on its way to an object."""
        return self.following is not None and thing.name in self.following.names

    def stands(self, thing):
        """Whether the light is that of where an object stands."""
        at = self._places.get(thing[FIRST])
        return at is not None and geometry.same_place(at, thing.matrix_world)

    def light(self, world, lit_by, face_resolution, wait):
        """Returns whether the radiance changed. Lamps stay where a bake is under way, and all light
        does while it follows objects."""
        if self.following is not None:
            return False
        suns = [lamp for lamp in lit_by if lamp.type == "SUN"]
        near = [lamp for lamp in lit_by if lamp.type != "SUN"]
        turn = np.array(world.turn).tobytes()
        parts = (
            ("world", (world.key, turn, face_resolution),
             lambda: self._under_world(world.environment(face_resolution, wait))),
            ("suns", [sun.key() for sun in suns], lambda: self._under_suns(suns)),
            ("lamps", [lamp.key() for lamp in near], lambda: self._under_near(near)),
            ("strength", world.strength, lambda: np.float32(world.strength)),
        )  # fmt: skip
        if any([self._part(*part) for part in parts]) or self._is_stale:
            self._is_stale = False
            np.multiply(self.parts.get("world", 0.0), self.parts["strength"], out=self.radiance)
            self.radiance += self.parts["suns"]
            self.radiance += self.parts["lamps"]
            return True
        return False

    def _part(self, name, key, compute):
        if name in self.keys and self.keys[name] == key:
            return False
        part = compute()
        if part is None:
            return False
        self.keys[name], self.parts[name] = key, part
        return True

    def _under_world(self, environment):
        if environment is None:
            return None
        self.world.set_environment(environment)
        return self._bounced(self.world)

    def _bounced(self, relighter):
        if self.bounces:
            relighter.bounce(albedo="mesh")
        return relighter.radiance

    def _under_suns(self, suns):
        if not suns:
            return np.float32(0.0)
        if self.suns is None:
            self.suns = relumine.Relighter(self.world.scene)
        self.suns.set_lights(lamps.light_list(suns))
        return self._bounced(self.suns)

    def _under_near(self, near):
        return sum((lamps.radiance_of(lamp, self.world) for lamp in near), np.float32(0.0))


_live = {}  # path: LiveScene
_nearest = {}  # object: (numbers of vertices, nearest_vertices())
_fill = {}  # (path, time): fill_of()
_waiting = set()  # names of objects that could not be written in their mode
_at_work = False
#: What the panel says: {object: text}, and lines about the world and lamps.
states, remarks = {}, []


def forget_all():
    for live in _live.values():
        live.close()
    for each in (_live, _nearest, _fill, _waiting, states, remarks):
        each.clear()
    geometry.shape_changed()
    forget()


def lit_objects(scene):
    return [thing for thing in scene.objects if thing.type == "MESH" and PATH in thing]


def notes_of(thing):
    """What is to be known of an object's precompute."""
    return thing.get(NOTES, "").splitlines()


def path_of(thing):
    return os.path.normpath(bpy.path.abspath(thing[PATH]))


def partners(scene, thing):
    """All objects of an asset."""
    path = path_of(thing)
    return [each for each in lit_objects(scene)
            if path_of(each) == path and copied_from(scene, each) is None]  # fmt: skip


def copied_from(scene, thing):
    """The object that a tied object was copied from, or None where the ties are its own."""
    if thing[OWNER] == thing.name:
        return None
    owner = scene.objects.get(thing[OWNER])
    if owner is None or owner == thing or PATH not in owner:
        return None
    is_copy = (path_of(owner), owner[FIRST]) == (path_of(thing), thing[FIRST])
    return owner if is_copy else None


def untie_copies(scene):
    """A copy has no light of its own: it loses the original's, and the panel says so."""
    for thing in lit_objects(scene):
        owner = copied_from(scene, thing)
        if owner is None:
            thing[OWNER] = thing.name  # renamed
            continue
        for key in TIES:
            if key in thing:
                del thing[key]
        thing["relumine_copy_of"] = owner.name
        if thing.data != owner.data and ATTRIBUTE in thing.data.color_attributes:
            thing.data.color_attributes.remove(thing.data.color_attributes[ATTRIBUTE])
        if LIGHTMAP in thing:
            del thing[LIGHTMAP]
        thing.relumine.file = ""


def live_scene(path):
    live = _live.get(path)
    if live is None or live.stamp != stamp(path):
        if live is not None:
            live.close()
        live = _live[path] = LiveScene(path)
    return live


def followings():
    """What the light follows at present."""
    return [live.following for live in _live.values() if live.following is not None]


def followed(thing):
    """What the light of an object's asset followed last, in words; empty where it follows now."""
    live = _live.get(path_of(thing))
    return live.followed if live is not None and live.following is None else ""


def relight(scene, depsgraph=None, *, force=False, wait=False, progress=None):
    """Brings all objects of the scene up to date. Returns how many changed. Bakes and moves of
    objects are waited for, or are taken by a later call; `progress` is told of such moves."""
    things = lit_objects(scene)
    if not things:
        return 0
    depsgraph = depsgraph or bpy.context.evaluated_depsgraph_get()
    world, lit_by = WorldLight(scene, depsgraph), lamps.lamps_of(depsgraph)
    changed, count, errors = {}, 0, []
    for thing in things:
        try:
            path = path_of(thing)
            if path not in changed:
                changed[path] = False
                if not os.path.exists(path):
                    raise FileNotFoundError(f"{path}: cannot read: no such file")
                live_scene(path).follow(partners(scene, thing), wait, progress)
                changed[path] = live_scene(path).light(
                    world, lit_by, scene.relumine.face_resolution, wait
                )
            if path not in _live or not os.path.exists(path):
                continue
            if changed[path] or force or thing.name in _waiting or not has_light(thing):
                count += write(thing, _live[path], depsgraph)
        except (OSError, ValueError, RuntimeError, MemoryError) as error:
            errors.append(str(error))
    remarks[:] = [*world.remarks, *(each for lamp in lit_by for each in lamp.remarks())]
    if any(lamp.type != "SUN" for lamp in lit_by) and any(live.bounces for live in _live.values()):
        remarks.append("light of point, spot and area lamps does not bounce")
    if errors:
        raise RuntimeError("; ".join(dict.fromkeys(errors)))
    return count


def has_light(thing):
    return LIGHTMAP in thing if thing[TEXELS] else ATTRIBUTE in thing.data.color_attributes


def write(thing, live, depsgraph):
    """Writes an object's light. Returns whether it could."""
    if not live.holds(thing):
        raise ValueError(
            f"{path_of(thing)}: expected the light of {thing.name}, got another mesh's"
        )
    if thing[TEXELS]:
        size = thing[TEXELS]
        key = (path_of(thing), live.stamp)
        if key not in _fill:
            _fill[key] = geometry.fill_of(live.scene.places, size, size)
        write_lightmap(thing, live.radiance[_fill[key]])
        return True
    if thing.mode == "EDIT":
        _waiting.add(thing.name)  # its attributes cannot be written now
        return False
    own = live.radiance[thing[FIRST] : thing[FIRST] + thing[COUNT]]
    evaluated = thing.evaluated_get(depsgraph)
    numbers = (len(thing.data.vertices), len(evaluated.data.vertices), thing[COUNT])
    if _nearest.get(thing.name, (None,))[0] != numbers:
        _nearest[thing.name] = numbers, geometry.nearest_vertices(thing, evaluated)
    nearest = np.minimum(_nearest[thing.name][1], len(own) - 1)
    write_colors(thing, own if len(nearest) == len(own) else own[nearest])
    _waiting.discard(thing.name)
    return True


def relight_quietly(scene, depsgraph=None, force=False, wait=None):
    """For handlers, which must not raise: an error is shown in the panel. Where nobody looks,
    bakes and moves are waited for."""
    global _at_work
    if _at_work or not scene.relumine.live:
        return
    _at_work = True
    try:
        untie_copies(scene)
        relight(scene, depsgraph, force=force, wait=bpy.app.background if wait is None else wait)
        scene.relumine.error = ""
    except (OSError, ValueError, RuntimeError, MemoryError) as error:
        scene.relumine.error = str(error)
    finally:
        _at_work = False


def is_at_work():
    return _at_work


def is_waiting(scene):
    """Whether an object has left the mode in which its light could not be written."""
    return any(scene.objects[name].mode != "EDIT" for name in _waiting if name in scene.objects)


# Keys


def look_for_changes(scene, depsgraph=None):
    """Fills `states`: what of each tied object has changed since its precompute."""
    depsgraph = depsgraph or bpy.context.evaluated_depsgraph_get()
    states.clear()
    rendered = geometry.rendered_names(bpy.context.view_layer)
    around, stale = {}, {}
    for thing in scene.objects:
        if "relumine_copy_of" in thing and PATH not in thing:
            states[thing.name] = f"a copy of {thing['relumine_copy_of']}: precompute it"
    for thing in lit_objects(scene):
        path = path_of(thing)
        if path not in around:
            names = frozenset(each.name for each in partners(scene, thing))
            around[path] = geometry.surroundings_key(depsgraph, names, rendered)
        has_lightmap = bool(thing[TEXELS])
        shape, place = geometry.key_of(
            thing.evaluated_get(depsgraph), thing.matrix_world, has_lightmap
        )
        live = _live.get(path)
        if live is not None and live.stands(thing):
            place = thing[PLACE]  # the light followed
        changed = [word for word, old, new in (
            ("mesh, UV map or modifiers" if has_lightmap else "mesh or modifiers", thing[SHAPE],
             shape), ("place", thing[PLACE], place),
            ("what is around", thing[AROUND], around[path])) if old != new]  # fmt: skip
        if geometry.is_shared(thing):
            states[thing.name] = "shares its mesh with another object"
        elif changed == ["place"] and live is not None and live.follows(thing):
            continue
        elif changed:
            states[thing.name] = f"stale: {', '.join(changed)} changed"
            if live is not None and live.refusal(thing):
                states[thing.name] += f" ({live.refusal(thing)})"
            stale.setdefault(path, thing.name)
    for thing in lit_objects(scene):  # what moved has left its shadow on the others
        if path_of(thing) in stale:
            states.setdefault(thing.name, f"stale: {stale[path_of(thing)]} changed")
    return states


# Precompute


def check(thing):
    if thing.mode == "EDIT":
        raise ValueError(f"{thing.name}: expected Object Mode, got Edit Mode")
    if geometry.is_shared(thing):
        raise ValueError(f"{thing.name}: expected a mesh of its own, got one that others share: "
                         "press Make meshes single-user")  # fmt: skip


@contextlib.contextmanager
def heard(notes):
    """Adds the warnings of the engine to notes, those of this thread alone."""
    thread = threading.get_ident()
    with warnings.catch_warnings():
        show = warnings.showwarning

        def hear(message, category, *details, **more):
            if issubclass(category, relumine.RelumineWarning) and threading.get_ident() == thread:
                notes.add(str(message))
            else:
                show(message, category, *details, **more)

        warnings.simplefilter("always", relumine.RelumineWarning)
        warnings.showwarning = hear
        yield


class Precompute:
    """Precomputes objects together, so that they shadow each other, and ties them to a file."""

    def __init__(self, context, things, path, *, tolerance, bounces=False, texels=0):
        self.scene, self.path, self.texels = context.scene, path, texels
        self.absolute = os.path.normpath(bpy.path.abspath(path))
        if not os.path.isdir(os.path.dirname(self.absolute) or "."):
            raise FileNotFoundError(f"{self.absolute}: cannot write: no such folder")
        self.tolerance, self.bounces, self.notes = tolerance, bounces, set()
        if texels and len(things) > 1:
            raise ValueError(f"lightmap: expected one object, got {len(things)}")
        for thing in things:
            check(thing)
        self.names = frozenset(thing.name for thing in things)
        self._refuse_other_assets()
        depsgraph = context.evaluated_depsgraph_get()
        rendered = geometry.rendered_names(context.view_layer)
        own, extra, self.places = geometry.Pieces(), {}, []
        groups = []  # the number of its first vertex names each object's
        shapes = []
        for thing in things:
            first = own.count
            self._add(thing, thing.evaluated_get(depsgraph), own, extra)
            groups += [str(first)] * len(own.triangles[-1])
            if not texels:
                shapes.append(geometry.Shape(thing, depsgraph))
        if shapes:
            self.notes |= geometry.coarse_notes(shapes, np.concatenate(own.vertices))
        others, notes = geometry.surroundings_of(depsgraph, self.names, rendered, bounces)
        self.notes |= notes
        hidden = geometry.unseen(self.scene, depsgraph, self.names, rendered)
        self.notes |= {f"{name} renders but is hidden here: it blocks no light" for name in hidden}
        self.around = geometry.surroundings_key(depsgraph, self.names, rendered)
        if bounces and others.count and not texels:  # what is around sends light, too
            own.extend(others)
            groups += ["around"] * sum(map(len, others.triangles))
        elif others.count:
            extra["blockers"] = others.arrays()
        if bounces:
            extra["colors"] = np.concatenate(own.colors)
        with heard(self.notes):
            self.mesh = relumine.Mesh(*own.arrays(), groups=groups, **extra)

    def _refuse_other_assets(self):
        for thing in lit_objects(self.scene):
            if path_of(thing) == self.absolute and thing.name not in self.names:
                if copied_from(self.scene, thing) is None:
                    raise ValueError(f"{self.path}: expected a file of its own, got that of "
                                     f"{thing.name}: choose another in the panel, or select "
                                     f"{thing.name}, too")  # fmt: skip

    def _add(self, thing, evaluated, own, extra):
        with geometry.Evaluated(evaluated) as mesh:
            vertices, triangles = geometry.arrays_of(mesh)
            if not len(triangles):
                raise ValueError(f"{thing.name}: expected a mesh with faces, got none")
            colors = base_colors(evaluated, mesh, self.notes) if self.bounces else None
            if self.texels:
                split = geometry.with_uvs(mesh, vertices, triangles)
                if split is None:
                    raise ValueError(f"{thing.name}: expected a UV map for its lightmap, got none")
                vertices, triangles, extra["uvs"], normals, old = split
                extra["normals"] = geometry.placed_normals(normals, thing.matrix_world)
                colors = colors[old] if colors is not None else None
        vertices, triangles = geometry.placed(vertices, triangles, thing.matrix_world)
        keys = geometry.key_of(evaluated, thing.matrix_world, bool(self.texels))
        self.places.append((thing.name, own.count, len(vertices), geometry.digest(vertices), keys,
                            np.array(thing.matrix_world, dtype=np.float64).ravel().tolist()))  # fmt: skip
        own.add(vertices, triangles, colors)

    def work(self, progress=None):
        """The long part, which touches nothing of Blender's."""
        receivers = f"texels:{self.texels}x{self.texels}" if self.texels else "vertices"
        with heard(self.notes):
            relumine.precompute(
                self.mesh, tolerance=self.tolerance, output=self.absolute, receivers=receivers,
                bounces=bool(self.bounces), progress=progress,
                movable=not self.texels,
                refine=bool(self.bounces),  # Blender shows its own vertices; bounces gain from more
            )  # fmt: skip

    def tie(self):
        for name, first, count, in_file, (shape, place), matrix in self.places:
            thing = self.scene.objects.get(name)
            if thing is None:
                continue
            values = (self.path, first, count, in_file, shape, place, self.around, name,
                      self.tolerance, bool(self.bounces), self.texels,
                      "\n".join(sorted(self.notes)), matrix)  # fmt: skip
            for key, value in zip(TIES, values):
                thing[key] = value
            for key in ("relumine_copy_of", *(() if self.texels else (LIGHTMAP,))):
                if key in thing:
                    del thing[key]
            thing.relumine.file = self.path
        _nearest.clear()
        _fill.clear()
        if self.absolute in _live:
            _live.pop(self.absolute).close()
        self.scene.relumine.error = ""
        relight_quietly(self.scene, force=True)
        look_for_changes(self.scene)


def default_path(context):
    """The file that the panel chose, or one named after the active object."""
    thing = context.object
    if thing is not None and thing.relumine.file:
        return thing.relumine.file
    name = bpy.path.clean_name(thing.name if thing is not None else "scene")
    taken = {path_of(each) for each in lit_objects(context.scene)
             if thing is None or each.name != thing.name}  # fmt: skip
    path, number = f"//{name}.prt", 1
    while os.path.normpath(bpy.path.abspath(path)) in taken:
        number += 1
        path = f"//{name}_{number}.prt"
    return path

