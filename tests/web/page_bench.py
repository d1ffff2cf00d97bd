"""What docs/web.md says of a page's size and speed: page_bench.py PROGRAM SCENE.prt FOLDER ENV...

Exports the scene with these environments, opens the page in headless Chromium, drags a light and turns the
environment.
"""
import math
import pathlib
import shutil
import statistics
import subprocess
import sys
import os

from browser import Browser, serve

program, scene, folder, environments = sys.argv[1], sys.argv[2], pathlib.Path(sys.argv[3]), sys.argv[4:]
DRAG = """
    await settled();
    v.addLight('disc', [0.5, 0.6, 0.7]);
    await settled();
    const times = [];
    for (let i = 0; i < 200; ++i) {
        const light = new Promise((resolve) => v.addEventListener('light', resolve, {once: true}));
        const angle = i * 0.05, start = performance.now();
        v.drag({...v.state.lights[0], direction: [Math.sin(angle), 0.7, Math.cos(angle)]});
        await light;
        times.push([v.times.milliseconds, performance.now() - start]);
    }
    await settled();
    return times;"""
TURN = """
    await settled();
    const times = [];
    for (let i = 0; i < 60; ++i) {
        const light = new Promise((resolve) => v.addEventListener('light', resolve, {once: true}));
        const asked = performance.now();
        v.turn(4 * i + 1);
        await light;
        times.push([v.times.milliseconds, performance.now() - asked]);
    }
    return times;"""


def percentile(values, part):
    return sorted(values)[math.ceil(part * len(values)) - 1]


def main():
    shutil.rmtree(folder, ignore_errors=True)
    options = ["--samples", "300"]
    for name, more in (("page", []), ("without bounces", ["--bounces", 0]), ("full tolerance", ["--tolerance", "1e-6"])):
        shutil.rmtree(folder, ignore_errors=True)
        subprocess.run([program, "export", "web", scene, *environments, "-o", folder, *options, *more, "-q"], check=True)
        size = sum(file.stat().st_size for file in folder.rglob("*") if file.is_file() and file.parent.name != "environments")
        print(f"{name}: {size / 1e6:.2f} MB besides environments")
        browser = Browser()
        url = serve(folder)
        loads = []
        for _ in range(5):
            browser.open(url)
            browser.run("await v.ready;")
            loads.append(browser.run("await settled(); return v.firstMilliseconds;"))
        print(f"  first picture {min(loads):.0f} ms at best, median {statistics.median(loads):.0f} ms of 5")
        for what, body in (("drag", DRAG), ("turn", TURN)):
            answers = browser.run(body)
            times = [worker for worker, _ in answers]
            # On a slow machine a step waits until the last picture is there.
            between = statistics.median(whole for _, whole in answers)
            median = statistics.median(times)
            print(f"  {what}: worker {median:.1f} ms median, {percentile(times, 0.99):.1f} ms 99th percentile, "
                  f"{min(times):.1f} ms at best: {1000 / median:.0f} a second; with the picture {between:.0f} ms")
        print(f"  {browser.run('return $(`.error-line`).textContent;')}")
        browser.close()
    print("load average", *os.getloadavg())


main()
