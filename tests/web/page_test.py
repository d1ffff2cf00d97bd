"""The page of `relumine export web` in a real browser: page_test.py PROGRAM SCENE.prt FOLDER [TEST...].

FOLDER gets the exported pages and screenshots.
"""
import array
import base64
import json
import math
import pathlib
import shutil
import statistics
import struct
import subprocess
import sys
import unittest

from browser import Browser, QuietHandler, serve
from png import Picture

program, scene, folder = sys.argv[1], pathlib.Path(sys.argv[2]), pathlib.Path(sys.argv[3])
names = sys.argv[4:]
RADIANCE = "await settled(); return btoa(new Uint8Array(v.radiance.buffer).reduce((t, b) => t + String.fromCharCode(b), ''));"
LIGHT_RESOLUTION = 128


def relumine(*arguments, expect=0):
    done = subprocess.run([program, *map(str, arguments)], capture_output=True, text=True, cwd=folder)
    assert done.returncode == expect, f"{arguments}: {done.returncode}\n{done.stdout}{done.stderr}"
    return done


def floats(text):
    return array.array("f", base64.b64decode(text))


def npy(path):
    bytes_ = path.read_bytes()
    size = struct.unpack_from("<H", bytes_, 8)[0]
    return array.array("f", bytes_[10 + size:])


def largest_error(got, expected):
    """Over the largest value"""
    assert len(got) == len(expected)
    scale = max(expected)
    assert scale > 0.01
    return max(abs(a - b) for a, b in zip(got, expected)) / scale


class Exported(unittest.TestCase):
    """One page in one browser, for all tests of a class."""
    size = (1280, 800)
    options = ()

    @classmethod
    def setUpClass(cls):
        cls.site = folder / cls.__name__
        shutil.rmtree(cls.site, ignore_errors=True)
        relumine("export", "web", scene, "-o", cls.site, "--samples", 100, "--tolerance", 0.06, *cls.options)
        cls.browser = Browser(*cls.size)
        cls.url = serve(cls.site)
        QuietHandler.asked.clear()

    @classmethod
    def tearDownClass(cls):
        cls.browser.close()

    def setUp(self):
        self.browser.open(self.url)
        self.browser.run("await settled();")

    def radiance(self):
        return floats(self.browser.run(RADIANCE))

    def saved(self):
        """The environment that the page saves"""
        text = self.browser.run("await settled(); return btoa(v.environmentFile().reduce((t, b) => t + String.fromCharCode(b), ''));")
        (folder / "saved.hdr").write_bytes(base64.b64decode(text))
        return folder / "saved.hdr"

    def native(self, environment, *options):
        relumine("coarsen", scene, "--tolerance", 0.06, "-o", "coarse.prt")
        relumine("relight", "coarse.prt", environment, "--clusters-only", "--face-resolution", LIGHT_RESOLUTION,
                 "-o", "light.npy", *options)
        return npy(folder / "light.npy")


class Light(Exported):
    options = ["--bounces", "all"]

    def test_of_bounces_is_the_native_one(self):
        expected = self.native(self.site / "environments/1.hdr", "--bounces", "all")
        albedo = self.native(self.site / "environments/1.hdr", "--bounces", 0)
        self.assertGreater(largest_error(expected, albedo), 0.01, "bounces count")
        self.browser.run("v.state = {bounces: true}; await settled();")
        self.assertLess(largest_error(self.radiance(), expected), 2e-3, "both stop at a tolerance of 0.001")

    def test_is_the_native_one(self):
        first = self.site / "environments/1.hdr"
        self.browser.run("v.state = {bounces: false}; await settled();")
        self.assertLess(largest_error(self.radiance(), self.native(first, "--bounces", 0)), 1e-5)
        self.browser.run("v.state = {turn: 90}; await settled();")
        turned = self.native(first, "--bounces", 0, "--rotate", 90)
        self.assertLess(largest_error(self.radiance(), turned), 1e-5)
        self.browser.run("v.state = {turn: 33}; await settled();")
        turned = self.native(self.saved(), "--bounces", 0)
        self.assertLess(largest_error(self.radiance(), turned), 1e-5)
        second = self.site / "environments/2.hdr"
        self.browser.run("v.state = {environment: 'environment-2', turn: 0}; await settled();")
        self.assertLess(largest_error(self.radiance(), self.native(second, "--bounces", 0)), 1e-5)

    def test_asks_for_nothing_but_its_folder(self):
        self.assertEqual([url for url in self.browser.requests() if not url.startswith((self.url, "data:", "blob:"))], [])
        self.assertEqual(self.browser.errors(), [])

    def test_is_seen(self):
        self.browser.picture(folder / "page.png")
        picture = self.browser.driver.get_screenshot_as_png()
        self.assertGreater(len(picture), 50_000, "a picture with details")
        self.assertIn("of exact integration", self.browser.run("return $('.error-line').textContent;"))


def drag(browser, selector, dx, dy):
    """As a mouse does it, in ten steps; returns what the worker took for each."""
    return browser.run("""
        const element = $(given[0]), box = element.getBoundingClientRect();
        const [x, y] = [box.left + box.width / 2, box.top + box.height / 2];
        const tell = (name, i) => element.dispatchEvent(new PointerEvent(name, {
            clientX: x + given[1] * i / 10, clientY: y + given[2] * i / 10, pointerId: 1, bubbles: true, button: 0}));
        element.setPointerCapture = () => {};
        tell('pointerdown', 0);
        const times = [];
        for (let i = 1; i <= 10; ++i) {
            const light = new Promise((resolve) => v.addEventListener('light', resolve, {once: true}));
            tell('pointermove', i);
            await light;
            times.push(v.times);
        }
        tell('pointerup', 10);
        await settled();
        return times;""", selector, dx, dy)


class Lights(Exported):
    options = ["--bounces", 0]

    def test_are_dragged_undone_and_saved(self):
        plain = self.radiance()
        self.browser.run("$('[data-add=box]').click(); await settled();")
        with_light = self.radiance()
        self.assertGreater(sum(with_light), 1.1 * sum(plain))
        before = self.browser.run("return v.state.lights[0].direction;")
        times = drag(self.browser, ".handle", 160, 60)
        self.assertTrue(all(step["isDragged"] and step["isStep"] for step in times))
        after = self.browser.run("return v.state.lights[0].direction;")
        self.assertGreater(sum((a - b) ** 2 for a, b in zip(before, after)), 0.01)
        dragged = self.radiance()
        self.assertGreater(largest_error(dragged, with_light), 0.05)
        # A second browser's page, brought to the same state at once, has the same light.
        state = self.browser.run("return v.state;")
        self.setUp()
        self.browser.run("v.state = given[0]; await settled();", state)
        self.assertLess(largest_error(self.radiance(), dragged), 1e-5)
        # What is saved lights the scene as the page does: its lights have soft edges, and pixels of another size.
        self.assertLess(largest_error(self.radiance(), self.native(self.saved(), "--bounces", 0)), 0.02)

    def test_undo_goes_back_step_by_step(self):
        plain = self.radiance()
        self.browser.run("$('[data-add=disc]').click(); await settled();")
        one = self.radiance()
        drag(self.browser, ".handle", -80, 40)
        moved = self.radiance()
        self.browser.run("v.shadowRoot.querySelector('[data-do=undo]').click(); await settled();")
        self.assertLess(largest_error(self.radiance(), one), 1e-6)
        self.browser.run("v.dispatchEvent(new KeyboardEvent('keydown', {key: 'z', ctrlKey: true})); await settled();")
        self.assertLess(largest_error(self.radiance(), plain), 1e-6)
        self.browser.run("v.redo(); v.redo(); await settled();")
        self.assertLess(largest_error(self.radiance(), moved), 1e-5)

    def test_turn_follows_the_slider(self):
        self.browser.run("const slider = $('[data-set=turn]'); for (let i = 1; i <= 10; ++i) { slider.value = 9 * i;"
                         " slider.dispatchEvent(new Event('input', {bubbles: true})); await new Promise((r) => setTimeout(r, 20)); }"
                         " slider.dispatchEvent(new Event('change', {bubbles: true})); await settled();")
        turned = self.native(self.site / "environments/1.hdr", "--bounces", 0, "--rotate", 90)
        self.assertLess(largest_error(self.radiance(), turned), 1e-5)

    def test_keys_move_a_light(self):
        self.browser.run("v.addLight('disc', [0, 0.5, 1]); await settled(); $('.handle').focus();"
                         "$('.handle').dispatchEvent(new KeyboardEvent('keydown', {key: 'ArrowRight', bubbles: true})); await settled();")
        x, _, z = self.browser.run("return v.state.lights[0].direction;")
        self.assertAlmostEqual(math.degrees(math.atan2(x, z)), 3, places=3)


class Files(Exported):
    options = ["--bounces", 0]

    def drop(self, path, name=None):
        self.browser.run("""
            const bytes = Uint8Array.from(atob(given[0]), (c) => c.charCodeAt(0));
            const data = new DataTransfer();
            data.items.add(new File([bytes], given[1]));
            v.dispatchEvent(new DragEvent('drop', {dataTransfer: data, bubbles: true, cancelable: true}));
            await new Promise((r) => setTimeout(r, 300));
            await settled();""", base64.b64encode(path.read_bytes()).decode(), name or path.name)

    def test_hdr_and_exr_are_dropped(self):
        relumine("generate", "soft_boxes", "-o", ".", "--face-resolution", 128)
        relumine("env", "convert", "soft_boxes_latlong.exr", "-o", "dropped.hdr")
        relumine("env", "convert", "soft_boxes_latlong.exr", "-o", "dropped.exr")
        for name in ("dropped.hdr", "dropped.exr"):
            self.drop(folder / name)
            self.assertEqual(self.browser.run("return $('.strip [aria-selected=true]').title;"), "dropped")
            expected = self.native(folder / name, "--bounces", 0)
            self.assertLess(largest_error(self.radiance(), expected), 1e-5 if name.endswith("hdr") else 0.01, name)

    def test_what_is_none_is_said_in_one_sentence(self):
        before = self.radiance()
        bad = folder / "bad.hdr"
        bad.write_bytes(b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 64 +X 128\n1234")
        self.drop(bad)
        self.assertEqual(self.browser.run("return $('.message p').textContent;"), "bad.hdr cannot be read: expected whole rows.")
        square = folder / "square.hdr"
        square.write_bytes(b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 4 +X 4\n" + bytes([128, 128, 128, 128] * 16))
        self.drop(square)
        self.assertEqual(self.browser.run("return $('.message p').textContent;"),
                         "square.hdr: expected a lat-long, twice as wide as high, got 4 x 4.")
        self.drop(bad, "bad.exr")
        self.assertEqual(self.browser.run("return $('.message p').textContent;"),
                         "bad.exr cannot be read: Provided file doesn't appear to be in OpenEXR format.")
        self.drop(bad, "picture.png")
        self.assertEqual(self.browser.run("return $('.message p').textContent;"), "picture.png: expected a .hdr or .exr file.")
        self.assertEqual(self.radiance(), before)


class Phone(Exported):
    size = (390, 844)
    options = ["--bounces", 0]

    def test_is_readable_in_both_themes(self):
        for theme in ("dark", "light"):
            self.browser.run("v.setAttribute('theme', given[0]); await settled();", theme)
            self.browser.picture(folder / f"phone-{theme}.png")
            self.assertTrue(self.browser.run("return $('aside').classList.contains('closed');"), "the picture comes first")
            self.browser.run("$('[data-do=panel]').click(); await settled();")
            self.browser.picture(folder / f"phone-{theme}-controls.png")
            # Nothing sticks out, text has eleven pixels or more, and what is touched has 34.
            self.assertEqual(self.browser.run("""
                const faults = [];
                for (const element of v.shadowRoot.querySelectorAll('button, input, select, h1, h2, p, span, output')) {
                    const box = element.getBoundingClientRect();
                    if (box.width === 0 || element.closest('.strip, .loading, .handles'))
                        continue;
                    if (box.left < -1 || box.right > innerWidth + 1)
                        faults.push(`${element.className || element.tagName} sticks out: ${box.left} to ${box.right}`);
                    if (element.matches('p, span, output, h2') && parseFloat(getComputedStyle(element).fontSize) < 10.5)
                        faults.push(`${element.textContent} is small`);
                    if (element.matches('.icon') && !element.closest('h2') && box.height < 34)
                        faults.push(`${element.dataset.do} is hard to hit`);
                }
                return faults;"""), [])
            self.browser.run("$('[data-do=panel]').click(); await settled();")

    def test_a_finger_drags_a_light(self):
        self.browser.run("$('[data-do=panel]').click(); $('[data-add=box]').click(); await settled(); $('[data-do=panel]').click();")
        before = self.browser.run("await settled(); return v.state.lights[0].direction;")
        box = self.browser.run("const b = $('.handle').getBoundingClientRect(); return [b.left + b.width / 2, b.top + b.height / 2];")
        tell = lambda kind, x, y: self.browser.driver.execute_cdp_cmd("Input.dispatchTouchEvent", {
            "type": kind, "touchPoints": [] if kind == "touchEnd" else [{"x": x, "y": y}]})
        tell("touchStart", *box)
        for i in range(1, 6):
            tell("touchMove", box[0] + 12 * i, box[1] + 8 * i)
        tell("touchEnd", *box)
        after = self.browser.run("await settled(); return v.state.lights[0].direction;")
        self.assertGreater(sum((a - b) ** 2 for a, b in zip(before, after)), 0.01)


class Questions(Exported):
    def test_a_click_tells_what_lights_the_point(self):
        self.browser.run("v.addLight('box', [1, 1, 1]); await settled();")
        answer = self.browser.run("const box = $('canvas').getBoundingClientRect();"
                                  "const answer = await v.ask(0.39 * box.width, 0.45 * box.height); await settled(); return answer;")
        radiance = self.radiance()
        i = 3 * answer["receiver"]
        expected = 0.2126 * radiance[i] + 0.7152 * radiance[i + 1] + 0.0722 * radiance[i + 2]
        self.assertAlmostEqual(answer["total"] / expected, 1, delta=2e-3, msg="the sum of all that lights it is its light")
        self.assertLessEqual(sum(share["share"] for share in answer["shares"]), 1.001)
        self.assertIn("Soft box", [share["name"] for share in answer["shares"]])
        self.assertFalse(self.browser.run("return $('.who').hidden;"))
        self.browser.picture(folder / "question.png")
        self.browser.run("v.dispatchEvent(new KeyboardEvent('keydown', {key: 'Escape'}));")
        self.assertTrue(self.browser.run("return $('.who').hidden && $('.pin').hidden;"))


class Lamps(unittest.TestCase):
    def test_are_dimmed(self):
        # A lamp over a grey box; the box's vertices come first.
        (folder / "lamp.mtl").write_text("newmtl grey\nKd 0.5 0.5 0.5\nnewmtl bulb\nKd 0.5 0.5 0.5\nKe 8 6 3\n")
        corners = [(x, y, z) for x in (-1, 1) for y in (0, 1) for z in (-1, 1)]
        text = "mtllib lamp.mtl\n" + "".join(f"v {x} {y} {z}\n" for x, y, z in corners)
        text += "o box\nusemtl grey\nf 3 4 8 7\nf 1 2 4 3\nf 5 7 8 6\nf 2 6 8 4\nf 1 3 7 5\n"
        text += "v -1 2 -1\nv 1 2 -1\nv 1 2 1\nv -1 2 1\no lamp\nusemtl bulb\nf 9 10 11 12\n"
        (folder / "lamp.obj").write_text(text)
        relumine("precompute", "lamp.obj", "-o", "lamp.prt", "--tolerance", 0.06, "--bounces", "--refine", "off", "--floor", 9)
        relumine("export", "web", "lamp.prt", "-o", "lamp", "--samples", 0, "--tolerance", 0.06)
        light = {}
        for gain, bounces in ((0, "all"), (1, "all"), (0, 0), (1, 0)):
            relumine("relight", "lamp.prt", "lamp/environments/1.hdr", "--clusters-only", "--bounces", bounces,
                     "--emission", gain, "-o", "lamp.npy")
            light[gain, bounces] = npy(folder / "lamp.npy")
        browser = Browser()
        try:
            browser.open(serve(folder / "lamp"))
            shown = {(gain, bounces): floats(browser.run(
                         f"await v.ready; v.state = {{lamps: [{gain}], bounces: {bounces}}}; {RADIANCE}"))
                     for gain in (0, 1, 2) for bounces in ("true", "false")}
            self.assertEqual(browser.run("return $('.lamps .slider span').textContent;"), "lamp")
            browser.picture(folder / "lamp.png")
        finally:
            browser.close()
        box = range(24)
        native = {}
        for bounces, switch in (("all", "true"), (0, "false")):
            native[bounces] = [(light[1, bounces][i] - light[0, bounces][i]) / 0.5 for i in box]
            for gain in (1, 2):
                lamp = [shown[gain, switch][i] - shown[0, switch][i] for i in box]
                self.assertLess(largest_error(lamp, [gain * value for value in native[bounces]]), 2e-3, "half floats")
        self.assertGreater(largest_error(native["all"], native[0]), 0.01, "bounces count")


SIZE = (640, 480)


def camera_options(site):
    camera = json.loads((site / "scene.json").read_text())["camera"]
    return ["--eye", ",".join(map(str, camera["eye"])), "--target", ",".join(map(str, camera["target"])),
            "--fov", camera["fov"], "--size", f"{SIZE[0]}x{SIZE[1]}"]


class Shown:
    """A page's picture in the program's pixels: controls move the page's middle."""

    def __init__(self, site, path, body=""):
        browser = Browser(*SIZE)
        try:
            browser.open(serve(site))
            browser.run(f"await settled(); {body}; v.state = {{background: 'plain'}};"
                        "if (!$('aside').classList.contains('closed')) $('[data-do=panel]').click(); await settled();")
            self.down = round(browser.run("return ($('footer').offsetHeight - 30) / 2;"))
            browser.picture(path)
            self.errors = browser.errors()
        finally:
            browser.close()
        self.picture = Picture(path)

    def luminance(self, x, y, reach=0):
        return self.picture.luminance(x, y - self.down, reach)


def correlation(a, b):
    mean_a, mean_b = statistics.fmean(a), statistics.fmean(b)
    spread = lambda values, mean: math.sqrt(sum((value - mean) ** 2 for value in values))
    return sum((x - mean_a) * (y - mean_b) for x, y in zip(a, b)) / (spread(a, mean_a) * spread(b, mean_b))


class Highlights(unittest.TestCase):
    def test_are_where_the_program_has_them(self):
        relumine("precompute", scene.with_suffix(".ply"), "-o", "shiny.prt", "--floor", 20, "--tolerance", 0.03, "--bounces", 0,
                 "--material", "ggx:roughness=0.3,albedo=0.15,f0=0.6")
        site = folder / "shiny"
        text = relumine("export", "web", "shiny.prt", "-o", site, "--samples", 0).stderr
        self.assertNotIn("left out", text)
        relumine("relight", "shiny.prt", site / "environments/1.hdr", *camera_options(site), "--bounces", 0,
                 "--background", "none", "--floor", "grey", "-o", "shiny_native.png")
        native = Picture(folder / "shiny_native.png")
        # The same page, whose materials have lost their highlights.
        matte = folder / "matte"
        shutil.rmtree(matte, ignore_errors=True)
        shutil.copytree(site, matte)
        manifest = json.loads((site / "scene.json").read_text())
        for material in manifest["look"]["materials"]:
            material.pop("highlight", None)
        (matte / "scene.json").write_text(json.dumps(manifest))
        relumine("relight", "shiny.prt", site / "environments/1.hdr", *camera_options(site), "--bounces", 0,
                 "--background", "none", "--floor", "grey", "--highlight-rays", 0, "-o", "matte_native.png")
        matte_native = Picture(folder / "matte_native.png")
        # The upper part of the blob, where highlights make a difference; edges aside.
        places = [(x, y) for y in range(100, 250, 2) for x in range(235, 450, 2)
                  if all(abs(native.luminance(x + dx, y + dy) - matte_native.luminance(x + dx, y + dy)) > 0.004
                         for dx, dy in ((0, 0), (4, 0), (-4, 0), (0, 4), (0, -4)))]
        self.assertGreater(len(places), 1000)
        expected = [native.luminance(x, y, 1) for x, y in places]
        likeness = {}
        for name in (site, matte):
            shown = Shown(name, folder / f"{name.name}_page.png")
            self.assertEqual(shown.errors, [])
            likeness[name] = correlation([shown.luminance(x, y, 1) for x, y in places], expected)
        # What they mirror of the floor and of the blob itself is only about as bright.
        self.assertGreater(likeness[site], 0.7, likeness)
        self.assertGreater(likeness[site], likeness[matte] + 0.3, likeness)

    def test_are_dark_where_something_is_in_the_way(self):
        # A metal table before a black wall, under an even sky.
        (folder / "wall.mtl").write_text("newmtl metal\nKd 0.8 0.8 0.8\nPr 0.2\nPm 1\nnewmtl black\nKd 0 0 0\nPr 1\nPm 0\n")
        count = 40
        lines = ["mtllib wall.mtl"]
        lines += [f"v {4 * i / count - 2} 0 {3 * j / count - 1}" for j in range(count + 1) for i in range(count + 1)]
        lines += ["usemtl metal"]
        lines += [f"f {k} {k + count + 1} {k + count + 2} {k + 1}" for j in range(count) for i in range(count)
                  for k in [j * (count + 1) + i + 1]]
        n = (count + 1) ** 2
        lines += ["v -3 0 -1", "v 3 0 -1", "v 3 0.6 -1", "v -3 0.6 -1", "usemtl black", f"f {n + 1} {n + 2} {n + 3} {n + 4}"]
        (folder / "wall.obj").write_text("\n".join(lines) + "\n")
        (folder / "even.hdr").write_bytes(b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 32 +X 64\n" + bytes([128, 128, 128, 129] * 2048))
        relumine("precompute", "wall.obj", "-o", "wall.prt", "--tolerance", 0.015, "--bounces", 0)
        site = folder / "wall"
        relumine("export", "web", "wall.prt", "even.hdr", "-o", site, "--samples", 0, "--tolerance", 0.015)
        relumine("relight", "wall.prt", "even.hdr", *camera_options(site), "--bounces", 0, "-o", "wall_native.png")
        native, shown = Picture(folder / "wall_native.png"), Shown(site, folder / "wall_page.png")
        camera = json.loads((site / "scene.json").read_text())["camera"]
        near, far = [pixel_of(camera, point) for point in ((0, 0, -0.8), (0.3, 0, 1.6))]
        # What hides the sky is taken to be as light as usual surfaces, so the page's is not black.
        for picture, most in ((native, 0.2), (shown, 0.8)):
            self.assertLess(picture.luminance(*near, 2), most * picture.luminance(*far, 2))
            self.assertGreater(picture.luminance(*far, 2), 0.6)


def pixel_of(camera, point):
    """Where a picture shows a point."""
    minus = lambda a, b: [x - y for x, y in zip(a, b)]
    dot = lambda a, b: sum(x * y for x, y in zip(a, b))
    unit = lambda a: [x / math.sqrt(dot(a, a)) for x in a]
    cross = lambda a, b: [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    forward = unit(minus(camera["target"], camera["eye"]))
    right = unit(cross(forward, [0, 1, 0]))
    to = minus(point, camera["eye"])
    scale = SIZE[1] / 2 / math.tan(math.radians(camera["fov"]) / 2) / dot(to, forward)
    return (round(SIZE[0] / 2 + scale * dot(to, right)), round(SIZE[1] / 2 - scale * dot(to, cross(right, forward))))


class Failing(unittest.TestCase):
    """Pages that cannot be shown say so in one sentence."""

    @classmethod
    def setUpClass(cls):
        cls.site = folder / "failing"
        shutil.rmtree(cls.site, ignore_errors=True)
        relumine("export", "web", scene, "-o", cls.site, "--samples", 0, "--tolerance", 0.06, "--bounces", 0)

    def sentence(self, url, prelude=""):
        browser = Browser()
        try:
            if prelude:
                browser.driver.execute_cdp_cmd("Page.addScriptToEvaluateOnNewDocument", {"source": prelude})
            browser.open(url)
            return browser.run("await v.ready.catch(() => {}); return $('.loading.failed p').textContent;")
        finally:
            browser.close()

    def test_a_broken_scene(self):
        bytes_ = bytearray((self.site / "scene.relight").read_bytes())
        bytes_[len(bytes_) // 2] ^= 16
        broken = folder / "broken"
        shutil.rmtree(broken, ignore_errors=True)
        shutil.copytree(self.site, broken)
        (broken / "scene.relight").write_bytes(bytes_)
        self.assertRegex(self.sentence(serve(broken)), r"^The scene cannot be opened: memory: .*$")
        (broken / "scene.relight").unlink()
        self.assertEqual(self.sentence(serve(broken)), "scene.relight cannot be loaded: 404 File not found.")

    def test_a_browser_without_simd(self):
        # As such a browser does: it refuses to compile the module.
        prelude = "WebAssembly.compile = () => Promise.reject(new WebAssembly.CompileError('invalid value type 0x7b'));"
        worker = ("const W = Worker; Worker = class extends W { constructor(url) { const r = new XMLHttpRequest();"
                  "r.open('GET', url, false); r.send();"
                  f"super(URL.createObjectURL(new Blob([{prelude!r} + r.responseText]))); }} }};")
        self.assertRegex(self.sentence(serve(self.site), worker), r"^The scene cannot be opened: this browser needs WebAssembly with SIMD")
        self.assertEqual(self.sentence(serve(self.site), "delete window.WebAssembly;"),
                         "This browser cannot run the scene's light: it needs WebAssembly.")

    def test_a_folder_without_a_server(self):
        browser = Browser()
        try:
            browser.open((self.site / "index.html").as_uri())
            self.assertEqual(browser.run("await new Promise((r) => setTimeout(r, 500)); return v.textContent;"),
                             "A browser does not let a page read other files of this computer. Put the folder on a web "
                             "server, or export one file: -o page.html.")
        finally:
            browser.close()


class SingleFile(unittest.TestCase):
    def test_opens_from_a_file(self):
        relumine("export", "web", scene, "-o", "single.html", "--samples", 0, "--tolerance", 0.06)
        browser = Browser()
        try:
            browser.open((folder / "single.html").as_uri())
            light = floats(browser.run(RADIANCE))
            self.assertGreater(max(light), 0.1)
            self.assertEqual([url for url in browser.requests() if url.startswith("http")], [])
            self.assertEqual(browser.run("await v.ready; return [...v.shadowRoot.querySelectorAll('.strip img')].every((i) => i.naturalWidth > 0);"), True)
            browser.picture(folder / "single.png")
        finally:
            browser.close()

    def test_is_an_element_of_other_pages(self):
        site = folder / "element"
        shutil.rmtree(site, ignore_errors=True)
        relumine("export", "web", scene, "-o", site / "bunny", "--samples", 0, "--tolerance", 0.06, "--bounces", 0)
        (site / "index.html").write_text(
            "<!doctype html><style>relumine-viewer { height: 360px; width: 640px; }</style><h1>Mine</h1>"
            "<script type=module src=bunny/relumine-viewer.js></script><relumine-viewer src=bunny theme=light></relumine-viewer>")
        browser = Browser()
        try:
            browser.open(serve(site))
            self.assertEqual(browser.run("await settled(); return [$('canvas').clientWidth, $('canvas').clientHeight];"), [640, 360])
            browser.picture(folder / "element.png")
        finally:
            browser.close()


if __name__ == "__main__":
    folder.mkdir(parents=True, exist_ok=True)
    unittest.main(argv=[sys.argv[0], *names], verbosity=2)
