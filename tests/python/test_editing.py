"""Edits: regions, layers, undo, and questions about the light."""

import pickle

import numpy as np
import pytest

import relumine

KEY = relumine.Layer("key", relumine.Disc((1, 1, 1), 20), relumine.Emit((4, 3, 2)))


def test_update_region_equals_a_new_environment(relighter, sky):
    changed = sky.cube.copy()
    changed[0, 3:7, 5:9] = 2.5
    update = relighter.update_region("+x", 5, 3, np.full((4, 4, 3), 2.5))
    assert 0 < update.clusters
    edited = relighter.radiance.copy()
    relighter.set_environment(relumine.Environment(changed))
    assert np.linalg.norm(relighter.radiance - edited) < 1e-5 * np.linalg.norm(edited)


def test_environment_of_layers(relighter, sky):
    relighter.set_layers([KEY])
    difference = relighter.environment - sky.cube
    assert difference.max() == pytest.approx(4.0, rel=1e-5)
    assert difference.min() == 0.0


def test_dictionaries_are_layers(relighter):
    relighter.set_layers([KEY])
    as_object = relighter.radiance.copy()
    relighter.set_layers([])
    relighter.set_layers(
        [
            {"name": "key", "type": "disc", "effect": "emit", "direction": np.array([1, 1, 1]),
             "radius_degrees": np.float32(20), "radiance": (4, 3, 2)}
        ]  # fmt: skip
    )
    assert (relighter.radiance == as_object).all()
    assert relighter.layers == [relumine.Layer.from_dict(KEY.to_dict())]


def test_a_drag_and_its_undo(relighter):
    relighter.set_layers([KEY])
    relighter.mark()
    before = relighter.radiance.copy()
    for x in np.linspace(1, -1, 8):
        relighter.set_layer("key", relumine.Layer("key", relumine.Disc((x, 1, 1), 20), KEY.effect))
    relighter.mark()
    after = relighter.radiance.copy()
    assert relighter.can_undo and not relighter.can_redo
    relighter.undo()
    assert (relighter.radiance == before).all()
    assert relighter.can_redo
    assert relighter.layers[0].region.direction == [1.0, 1.0, 1.0]
    relighter.redo()
    assert (relighter.radiance == after).all()
    relighter.undo()
    relighter.undo()
    assert relighter.layers == [] and not relighter.can_undo


def test_rotation_stays_for_other_environments(relighter, sky):
    relighter.set_environment(sky.turned(rotate=90))
    expected = np.array(relighter.radiance)
    relighter.set_environment(sky)
    relighter.set_rotation(90)
    assert np.allclose(relighter.radiance, expected, rtol=0.02, atol=0.01)
    relighter.set_environment(sky)
    assert np.allclose(relighter.radiance, expected, rtol=0.02, atol=0.01)
    relighter.set_rotation(0)
    with pytest.raises(ValueError, match="finite rotation"):
        relighter.set_rotation(float("nan"))


@pytest.mark.parametrize(
    "layer, message",
    [
        ({"name": "a"}, r"^layers\[1\]: expected .*type"),
        ({**KEY.to_dict(), "name": "a", "radus": 3}, r"^layers\[1\]: expected .*radus"),
        ({**KEY.to_dict(), "name": "a", "radius_degrees": -1}, r"^layers\[1\]: .*radius"),
        ({**KEY.to_dict(), "name": "a", "radius_degrees": np.nan}, r"^layers\[1\]: "),
        ({**KEY.to_dict(), "name": "a", "direction": object()}, r"^layers\[1\]: "),
        ({**KEY.to_dict()}, r"^layers\[1\]: expected layers of different names"),
    ],
)
def test_wrong_layers_are_named_and_change_nothing(relighter, layer, message):
    before = relighter.radiance.copy()
    with pytest.raises(ValueError, match=message):
        relighter.set_layers([KEY, layer])
    assert (relighter.radiance == before).all() and relighter.layers == []
    with pytest.raises(ValueError, match="^layers: expected a list"):
        relighter.set_layers(KEY)
    with pytest.raises(IndexError):
        relighter.set_layer(3, KEY)
    with pytest.raises(ValueError, match=r"index: expected one of the layers \[\], got 'rim'"):
        relighter.set_layer("rim", KEY)


def test_contribution_is_the_transpose(relighter):
    receiver = relighter.scene.nearest_receiver((0, 1, 0))
    who = relighter.contribution_map(receiver)
    n = who.shape[1]
    s = 2 * (np.arange(n) + 0.5) / n - 1
    angle = (2 / n) ** 2 / (1 + s[:, None] ** 2 + s**2) ** 1.5  # of texels, nearly
    total = (who * angle[None, :, :, None]).sum(axis=(0, 1, 2))
    assert total == pytest.approx(relighter.radiance[receiver], rel=0.01)


def test_parts_add_up(relighter):
    up = relighter.lit_by(relumine.Disc((0, 1, 0), 90))
    down = relighter.lit_by({"type": "disc", "direction": [0, -1, 0], "radius_degrees": 90})
    assert up.share + down.share == pytest.approx(1.0, abs=2e-3)
    total = up.radiance + down.radiance
    assert np.linalg.norm(total - relighter.radiance) < 2e-3 * np.linalg.norm(total)
    assert up.environment[3].max() == 0.0


def test_verify(relighter):
    found = relighter.verify(40, surface=30, seed=2)
    assert found.relative_l2 < 0.05 and found.of_file and len(found.receivers) == 40
    again = relighter.verify(40, surface=0, seed=2)
    assert found.worst >= again.worst == again.relative_l2
    assert (again.receivers == found.receivers).all()
    assert again.relative_l2 == found.relative_l2


def test_animate(relighter, sky, folder):
    for number in range(3):
        sky.turned(rotate=30 * number).save(f"sky.{number:04}.exr")
    frames = list(relighter.animate("sky.%04d.exr"))
    assert [frame.number for frame in frames] == [0, 1, 2]
    for frame in frames:
        relighter.set_environment(relumine.Environment.load(frame.path))
        error = np.linalg.norm(relighter.radiance - frame.radiance)
        assert error < 1e-5 * np.linalg.norm(frame.radiance)
    assert [frame.number for frame in relighter.animate("sky.%04d.exr", frames="1-2")] == [1, 2]
    (folder / "sky.0001.exr").write_bytes(b"damaged")
    frames = relighter.animate("sky.%04d.exr")
    with pytest.raises(OSError) as error:
        list(frames)
    assert "sky.0001.exr" in error.value.filename or "sky.0001.exr" in str(error.value)


def test_undo_says_what_it_does(scene):
    relighter = relumine.Relighter(scene)
    for asked in (
        lambda: relighter.set_rotation(90),
        relighter.mark,
        lambda: relighter.set_layers([]),
        lambda: relighter.update_region(0, 0, 0, np.ones((1, 1, 3))),
    ):
        with pytest.raises(RuntimeError, match="set_environment"):
            asked()
    relighter.set_environment(relumine.Environment(np.ones((6, 8, 8, 3))))
    relighter.set_layers([])
    assert not relighter.can_undo
    lamp = relumine.Layer("key", relumine.Disc((1, 1, 1), 20), relumine.Emit((9, 9, 9)))
    relighter.set_layers([lamp])
    assert relighter.can_undo, "an edit without a mark"
    relighter.undo()
    assert not relighter.can_undo
    assert relighter.layers == []


@pytest.fixture(scope="module")
def names(arrays):
    return np.array(["plate" if each[0] >= 2 * 48 * 48 else "ball" for each in arrays[1]])


@pytest.fixture(scope="module")
def movable(arrays, names):
    mesh = relumine.Mesh(*arrays, groups=list(names))
    assert sorted(mesh.groups) == ["ball", "plate"]
    return relumine.precompute(
        mesh, tolerance=0.05, refine=False, bounces=True, movable=True, min_depth=2
    )


def shift(x, y, z):
    matrix = np.eye(4)
    matrix[:3, 3] = x, y, z
    return matrix


def lit_by(sky, scene, bounces=True):
    relighter = relumine.Relighter(scene)
    relighter.set_environment(sky)
    if bounces:
        relighter.bounce()
    return relighter


def test_a_group_moves(arrays, names, movable, sky):
    triangles, scene = arrays[1], movable
    shifted = shift(0.5, 0.25, 0.0)
    moved = scene.move("ball", shifted)
    assert 0 < moved.report["pairs_changed"] <= moved.report["pairs"] < moved.report["pairs_all"]
    ball = np.unique(triangles[names == "ball"])
    assert np.allclose(moved.vertices[ball], scene.vertices[ball] + [0.5, 0.25, 0.0], atol=1e-6)
    plate = np.unique(triangles[names == "plate"])
    assert (moved.vertices[plate] == scene.vertices[plate]).all()
    lights = [relumine.Relighter(each) for each in (scene, moved)]
    for each in lights:
        each.set_environment(sky)
    assert (lights[0].radiance[plate] != lights[1].radiance[plate]).any()
    back = moved.move("ball", shift(-0.5, -0.25, 0.0))
    assert (back.move("ball", shifted).vertices[plate] == scene.vertices[plate]).all()


def test_the_light_of_a_relighter_follows(movable, sky):
    relighter = lit_by(sky, movable)
    before, vertices = relighter.radiance.copy(), movable.vertices.copy()
    shifted = shift(0.5, 0.25, 0.0)
    assert 0 < relighter.move("ball", shifted).pairs_changed
    moved = movable.move("ball", shifted)
    expected = lit_by(sky, moved).radiance
    assert (relighter.radiance == expected).all()
    assert (relighter.scene.vertices == moved.vertices).all()
    assert (movable.vertices == vertices).all()
    copy = pickle.loads(pickle.dumps(relighter))
    assert (copy.radiance == expected).all()
    assert relighter.undo_move() and (relighter.radiance == before).all()
    assert not relighter.undo_move()
    assert relighter.redo_move() and (relighter.radiance == expected).all()
    assert not relighter.redo_move()


def test_several_groups_move_at_once(movable, sky):
    relighter = lit_by(sky, movable)
    before = relighter.radiance.copy()
    ways = {"ball": shift(0.5, 0.25, 0.0), "plate": shift(-0.2, 0.0, 0.1)}
    together = movable.move(ways)
    in_turn = movable
    for name, way in ways.items():
        in_turn = in_turn.move(name, way)
    assert (together.vertices == in_turn.vertices).all()
    assert (lit_by(sky, together).radiance == lit_by(sky, in_turn).radiance).all()
    assert relighter.move(ways).receivers == len(movable.vertices)
    assert (relighter.radiance == lit_by(sky, together).radiance).all()
    assert relighter.undo_move() and (relighter.radiance == before).all()
    assert not relighter.undo_move()
    with pytest.raises(ValueError, match=r"matrix of ball: expected shape \(4, 4\)"):
        relighter.move({"ball": np.eye(3)})
    with pytest.raises(ValueError, match="expected groups to move, got none"):
        movable.move({})
    with pytest.raises(TypeError, match="matrix: expected none beside"):
        movable.move(ways, np.eye(4))
    with pytest.raises(TypeError, match=r"matrix: expected shape \(4, 4\), got None"):
        movable.move("ball")
    with pytest.raises(ValueError, match="did you mean ball"):
        relighter.move({"bal": np.eye(4)})


def test_a_drag_shows_the_group_and_a_drop_moves_it(movable, sky):
    relighter = lit_by(sky, movable)
    before = relighter.radiance.copy()
    for x in (0.1, 0.3, 0.5):
        report = relighter.drag("ball", shift(x, 0.25, 0.0))
        assert report.receivers > 0
        assert (relighter.radiance != before).any()
    with pytest.raises(RuntimeError, match=r"drop\(\) or undo_move\(\)"):
        relighter.scene
    quick = relighter.radiance.copy()
    moved = lit_by(sky, movable.move("ball", shift(0.5, 0.25, 0.0)))
    relighter.drop()
    assert (relighter.radiance == moved.radiance).all()
    assert np.linalg.norm(quick - moved.radiance) < 0.1 * np.linalg.norm(quick)
    with pytest.raises(RuntimeError, match="expected a group that is dragged"):
        relighter.drop()
    relighter.drag("ball", shift(1.0, 0.0, 0.0))
    assert relighter.undo_move() and (relighter.radiance == moved.radiance).all()
    assert relighter.undo_move() and (relighter.radiance == before).all()
    with pytest.raises(ValueError, match="did you mean ball"):
        relighter.drag("bal", shift(1.0, 0.0, 0.0))
    with pytest.raises(ValueError, match="matrix: expected shape"):
        relighter.drag("ball", np.eye(3))
    with pytest.raises(ValueError, match="singular"):
        relighter.drag("ball", np.diag([1.0, 0.0, 1.0, 1.0]))
    assert (relighter.radiance == before).all()
    with pytest.raises(RuntimeError, match="set_environment"):
        relumine.Relighter(movable).drag("ball", np.eye(4))


def test_a_scene_tells_what_a_precompute_would_choose(movable, scene):
    own = movable.num_clusters
    assert movable.fresh_clusters() == pytest.approx(own, rel=0.1)
    moved = movable.move("ball", shift(0.0, 5.0, 0.0))
    assert moved.num_clusters == own and moved.fresh_clusters() != own
    with pytest.raises(ValueError, match="precomputed with movable"):
        scene.fresh_clusters()


def test_a_group_takes_another_pose(arrays, names, movable, sky):
    vertices, triangles = arrays
    ball = np.unique(triangles[names == "ball"])
    flat = vertices.copy()
    flat[ball, 1] = 0.5 * flat[ball, 1] + 0.2
    pose = relumine.Mesh(flat, triangles, groups=list(names))
    posed = movable.pose("ball", pose)
    assert np.allclose(posed.vertices, flat, atol=1e-6)
    assert posed.report["receivers"] == len(ball)
    relighter = lit_by(sky, movable)
    before = relighter.radiance.copy()
    assert relighter.pose("ball", pose).pairs_changed > 0
    assert (relighter.radiance == lit_by(sky, posed).radiance).all()
    assert relighter.undo_move() and (relighter.radiance == before).all()
    # A mesh without groups is the group as a whole.
    own = np.searchsorted(ball, triangles[names == "ball"])
    alone = movable.pose("ball", relumine.Mesh(flat[ball], own))
    assert np.allclose(alone.vertices, flat, atol=1e-6)
    with pytest.raises(ValueError, match="did you mean ball"):
        movable.pose("bal", pose)
    plate = triangles[names == "plate"]
    with pytest.raises(ValueError, match="expected one of 1 groups, got 'ball'"):
        movable.pose("ball", relumine.Mesh(vertices, plate, groups=["plate"] * len(plate)))
    few = triangles[names == "ball"][:4]
    with pytest.raises(ValueError, match="vertices of ball, got"):
        movable.pose("ball", relumine.Mesh(vertices, few, groups=["ball"] * len(few)))
    with pytest.raises(TypeError, match="mesh: expected"):
        movable.pose("ball", vertices)


def test_a_group_is_removed_and_restored(movable, sky, folder):
    before = lit_by(sky, movable).radiance.copy()
    without = movable.remove("ball")
    without.save(folder / "without.prt")
    relighter = lit_by(sky, movable)
    assert relighter.remove("ball").receivers == 0
    expected = lit_by(sky, relumine.Scene.load(folder / "without.prt")).radiance
    assert (expected != before).any() and (relighter.radiance == expected).all()
    with pytest.raises(ValueError, match="got ball, which was taken away"):
        relighter.drag("ball", np.eye(4))
    relighter.restore("ball")
    assert (relighter.radiance == before).all()
    again = relumine.Scene.load(folder / "without.prt").restore("ball")
    assert (lit_by(sky, again).radiance == before).all()
    with pytest.raises(ValueError, match="expected a group that was taken away"):
        again.restore("ball")


def test_what_cannot_move_is_refused(arrays, scene):
    vertices, triangles = arrays
    with pytest.raises(ValueError, match="movable"):
        scene.move("ball", np.eye(4))
    with pytest.raises(ValueError, match="groups: expected a name for each"):
        relumine.Mesh(vertices, triangles, groups=["ball"])
    with pytest.raises(ValueError, match="a mesh with groups"):
        relumine.precompute(relumine.Mesh(vertices, triangles), movable=True)
    with pytest.raises(ValueError, match="matrix: expected shape"):
        scene.move("ball", np.eye(3))
    with pytest.raises(ValueError, match="matrix: expected finite"):
        scene.move("ball", np.full((4, 4), np.nan))
    with pytest.raises(ValueError, match="movable"):
        relumine.Relighter(scene).move("ball", np.eye(4))
    with pytest.raises(ValueError, match="movable"):
        relumine.Relighter(scene).undo_move()
