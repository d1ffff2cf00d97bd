"""Files in and out, and the errors that name them."""

import errno
import json
import os
import pickle
import subprocess
import sys

import numpy as np
import pytest

import relumine


def test_scenes_come_back(scene, sky, folder):
    size = scene.save("boulder.prt")
    assert size == os.path.getsize("boulder.prt")
    again = relumine.Scene.load(folder / "boulder.prt")
    assert again.num_clusters == scene.num_clusters
    assert again.settings == scene.settings
    one, other = relumine.Relighter(scene), relumine.Relighter(again)
    one.set_environment(sky)
    other.set_environment(sky)
    assert (one.radiance == other.radiance).all()


def test_precompute_writes_its_output(arrays, folder):
    scene = relumine.precompute(*arrays, tolerance=0.1, output="boulder.prt")
    assert relumine.Scene.load("boulder.prt").num_clusters == scene.num_clusters
    assert scene.report["file_bytes"] == os.path.getsize("boulder.prt")
    assert not os.path.exists("boulder.prt.checkpoint")


def test_meshes_come_from_files(relighter, folder, arrays):
    relighter.save("boulder.ply", exposure=0, albedo=1)
    mesh = relumine.Mesh.load("boulder.ply", floor=10)
    assert mesh.floor == 10
    assert (mesh.vertices[:-100] == arrays[0].astype(np.float32)).all()
    assert (mesh.triangles[: len(arrays[1])] == arrays[1]).all()
    assert mesh.colors[:-100] == pytest.approx(relighter.radiance, abs=1e-6)


def test_empty_names_are_told_as_such(relighter, scene, arrays):
    loads = (relumine.Mesh.load, relumine.Environment.load, relumine.Scene.load, relumine.load_layers)
    saves = (scene.save, relighter.save, relighter.picture(size=(8, 8)).save)
    for call in (*loads, *saves, lambda path: relumine.precompute(*arrays, output=path)):
        with pytest.raises(FileNotFoundError, match="expected the name of a file, got an empty one"):
            call("")


def missing(path):
    return pytest.raises(FileNotFoundError, match=f"No such file.*{path}")


def test_materials_of_a_mesh(folder):
    (folder / "a.mtl").write_text("newmtl metal\nPr 0.25\nPm 1\n")
    (folder / "a.obj").write_text(
        "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl metal\nf 1 2 3\n"
    )
    (material,) = relumine.Mesh.load(folder / "a.obj").materials
    assert material["name"] == "metal"
    assert material["model"] == "metallic-roughness"
    assert material["roughness"] == 0.25
    assert material["base_color"] == [1, 1, 1]
    assert "coat" not in material


def test_variants_of_a_mesh(folder):
    corners = np.eye(3, dtype=np.float32)
    (folder / "a.bin").write_bytes(corners.tobytes())
    mapping = {"mappings": [{"material": 1, "variants": [0]}]}
    document = {
        "asset": {"version": "2.0"},
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [
            {
                "primitives": [
                    {
                        "attributes": {"POSITION": 0},
                        "material": 0,
                        "extensions": {"KHR_materials_variants": mapping},
                    }
                ]
            }
        ],
        "materials": [
            {"pbrMetallicRoughness": {"baseColorFactor": [0, 0, 0, 1], "metallicFactor": 0}},
            {"pbrMetallicRoughness": {"baseColorFactor": [1, 1, 1, 1], "metallicFactor": 0}},
        ],
        "extensions": {"KHR_materials_variants": {"variants": [{"name": "winter"}]}},
        "buffers": [{"uri": "a.bin", "byteLength": 36}],
        "bufferViews": [{"buffer": 0, "byteLength": 36}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
    }
    (folder / "a.gltf").write_text(json.dumps(document))
    with pytest.warns(UserWarning, match="1 variant of materials"):
        plain = relumine.Mesh.load(folder / "a.gltf")
    winter = relumine.Mesh.load(folder / "a.gltf", variant="winter")
    white = relumine.Environment(np.ones((8, 16, 3), np.float32))
    for mesh, least, most in ((plain, 0, 0.05), (winter, 0.5, 1.05), (pickle.loads(pickle.dumps(winter)), 0.5, 1.05)):
        relighter = relumine.Relighter(relumine.precompute(mesh, refine=False))
        relighter.set_environment(white)
        relighter.save("lit.npy")
        assert least <= np.load("lit.npy").max() <= most
    with pytest.raises(OSError, match="'winter'.*got 'summer'"):
        relumine.Mesh.load(folder / "a.gltf", variant="summer")


def test_missing_textures(folder):
    (folder / "a.mtl").write_text("newmtl paint\nmap_Kd nowhere.png\n")
    (folder / "a.obj").write_text("mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nusemtl paint\nf 1/1 2/1 3/1\n")
    with pytest.warns(UserWarning, match="no nowhere.png is found"):
        relumine.Mesh.load(folder / "a.obj")


def test_missing_files(folder):
    calls = {
        "a.ply": relumine.Mesh.load,
        "a.prt": relumine.Scene.load,
        "a.exr": relumine.Environment.load,
        "a.json": relumine.LightList.load,
        "b.json": relumine.load_layers,
    }
    for path, call in calls.items():
        with missing(path) as error:
            call(path)
        assert error.value.filename == path
        assert error.value.errno == errno.ENOENT


def test_files_of_other_content(folder):
    (folder / "text").write_text("not what it should be\n")
    for suffix, call in {
        "ply": relumine.Mesh.load,
        "prt": relumine.Scene.load,
        "exr": relumine.Environment.load,
        "json": relumine.LightList.load,
    }.items():
        path = folder / f"text.{suffix}"
        path.write_text("not what it should be\n")
        with pytest.raises(relumine.FileError) as error:
            call(path)
        assert error.value.filename == str(path)
        assert isinstance(error.value, OSError)
        assert str(error.value).count(str(path)) == 1
        assert "expected" in str(error.value) and "\n" not in str(error.value)


def test_places_that_cannot_be_written(relighter, folder):
    for path in ("nowhere/out.png", "nowhere/out.npy"):
        with pytest.raises(FileNotFoundError):
            relighter.save(path, size=(8, 8))
    with pytest.raises(FileNotFoundError):
        relighter.scene.save("nowhere/out.prt")
    with pytest.raises(FileNotFoundError):
        relighter.picture(size=(8, 8)).save("nowhere/out.png")
    with pytest.raises(ValueError, match="extension|ends in|expected"):
        relighter.save("out.jpeg")
    assert os.listdir() == []


def test_layer_files(folder, relighter):
    layers = [
        relumine.Layer("key", relumine.Disc((1, 1, 1), 8, 0.2), relumine.Emit((40, 38, 35))),
        relumine.Layer("dim", relumine.Lasso([(-1, 0.2, 0.3), (-1, 0.9, 0.3), (-1, 0.9, -0.4)]),
                       relumine.Gain(0.25, (1, 0.9, 0.8)), gain_ev=-1.0, on=False),
        relumine.Layer("box", relumine.Rectangle((-1, 0.5, 0.2), 50, 30, 10, 0.3),
                       relumine.Emit((6, 6, 6.5)), kelvin=5600, solo=True,
                       camera=False),
        relumine.Layer("glow", relumine.Stroke([(-1, 0, -1), (0, 0.1, -1)], 3),
                       relumine.Emit((2, 1, 0.5))),
    ]  # fmt: skip
    relumine.save_layers("layers.json", layers)
    again = relumine.load_layers("layers.json")
    assert [layer.name for layer in again] == ["key", "dim", "box", "glow"]
    assert [a.to_dict() for a in again] == [relumine.Layer.from_dict(b.to_dict()).to_dict()
                                            for b in layers]  # fmt: skip
    once = relighter.set_layers(layers)
    assert once.clusters > 0
    assert relighter.set_layers(again).clusters == 0


def test_pictures_in_layers(folder, relighter):
    os.mkdir("looks")
    relumine.Picture(np.full((4, 4, 3), 3.0)).save("looks/window.exr")
    layer = relumine.Layer(
        "window", relumine.Rectangle((1, 0.3, 0), 40, 40), relumine.Image("looks/window.exr")
    )
    dark = relighter.radiance.mean()
    relighter.set_layers([layer])
    assert relighter.radiance.mean() > dark
    (folder / "looks/layers.json").write_text(
        '{"version": 1, "layers": [{"name": "w", "type": "rectangle", "effect": "image", '
        '"direction": [1, 0.3, 0], "width_degrees": 40, "height_degrees": 40, '
        '"path": "window.exr"}]}'
    )
    bright = relighter.radiance.mean()
    relighter.set_layers(relumine.load_layers("looks/layers.json"))
    assert relighter.radiance.mean() == pytest.approx(bright)


def test_key_frames(folder):
    (folder / "layers.json").write_text(
        '{"version": 1, "layers": [{"name": "k", "type": "disc", "effect": "emit", '
        '"direction": [1, 0, 0], "radius_degrees": 5, "radiance": [1, 1, 1]}], "frames": ['
        '{"frame": 0, "layers": {"k": {"gain_ev": 0}}}, '
        '{"frame": 10, "layers": {"k": {"gain_ev": 4}}}]}'
    )
    (layer,) = relumine.load_layers("layers.json", frame=5)
    assert layer.gain_ev == 2.0


def test_parts_of_a_plan_make_one_scene_whatever_their_number(folder, arrays):
    relumine.plan(relumine.Mesh(*arrays), "a.plan", tolerance=0.05)
    for count in (1, 3):
        for part in reversed(range(count)):
            relumine.precompute_part("a.plan", part, count, f"{count}.{part}")
        names = [f"{count}.{part}" for part in range(count)]
        assert relumine.join(names, f"{count}.prt") == os.path.getsize(f"{count}.prt")
    assert open("1.prt", "rb").read() == open("3.prt", "rb").read()
    with pytest.raises(RuntimeError, match="part"):
        relumine.join(["3.0", "3.2"], "none.prt")
    assert not os.path.exists("none.prt")
    with pytest.raises(ValueError, match="part"):
        relumine.precompute_part("a.plan", 3, 3, "none")
    with pytest.raises(OSError):
        relumine.precompute_part("missing.plan", 0, 1, "none")


def test_meshes_are_refined_and_simplified(arrays):
    mesh = relumine.Mesh(*arrays)
    fine = mesh.refined(tolerance=0.004, vertices=len(mesh.vertices) + 500)
    assert len(fine.vertices) == len(mesh.vertices) + 500
    assert (fine.vertices[: len(mesh.vertices)] == mesh.vertices).all()
    assert fine.report["rounds"] > 0 and mesh.report == {}
    assert len(mesh.simplified(1000).vertices) == 1000
    # Both are lit under the shadows of the mesh they come from.
    assert relumine.precompute(fine, tolerance=0.2).num_receivers == len(fine.vertices)
    with pytest.raises(ValueError, match="max_edge"):
        mesh.refined(max_edge=-1.0)
    with pytest.raises(ValueError, match="num_vertices"):
        mesh.simplified(0)


def test_a_stage_of_usd_names_what_would_read_it(folder, command_line):
    (folder / "a.usda").write_text("#usda 1.0\n")
    text = (
        "import runpy, sys; sys.modules['pxr'] = None; "
        "sys.argv[1:] = ['relight', 'a.usda', '-o', 'a.png']; "
        "runpy.run_module('relumine', run_name='__main__')"
    )
    program = os.path.dirname(os.environ["RELUMINE_PROGRAM"])
    environment = {**os.environ, "PATH": f"{program}:{os.environ['PATH']}"}
    run = subprocess.run(
        [sys.executable, "-c", text], env=environment, capture_output=True, text=True
    )
    assert run.returncode == 1 and "pip install relumine[usd]" in run.stderr
    assert run.stderr.count("\n") == 1
