"""The page of `relumine export web` in a real browser: page_test.py PROGRAM SCENE.prt FOLDER [TEST...].

FOLDER gets the exported pages and screenshots.
"""
import array
import base64
import pathlib
import shutil
import struct
import subprocess
import sys
import unittest

from browser import Browser, QuietHandler, serve

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


if __name__ == "__main__":
    folder.mkdir(parents=True, exist_ok=True)
    unittest.main(argv=[sys.argv[0], *names], verbosity=2)
