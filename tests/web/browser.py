"""A headless Chromium that looks at an exported page, and the server of its folder."""
import functools
import http.server
import json
import threading
import time

from selenium import webdriver
from selenium.webdriver.chrome.service import Service

ARGUMENTS = ["--headless=new", "--no-sandbox", "--enable-unsafe-swiftshader", "--disable-background-networking",
             "--disable-component-update", "--disable-sync", "--no-first-run", "--force-color-profile=srgb"]


class QuietHandler(http.server.SimpleHTTPRequestHandler):
    """Plain files without any header of its own, and a list of what was asked for."""
    asked = []

    def log_message(self, *_):
        pass

    def do_GET(self):
        QuietHandler.asked.append(self.path)
        super().do_GET()


def serve(folder):
    handler = functools.partial(QuietHandler, directory=str(folder))
    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), handler)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    return f"http://127.0.0.1:{server.server_port}/"


class Browser:
    def __init__(self, width=1280, height=800, arguments=()):
        options = webdriver.ChromeOptions()
        for argument in [*ARGUMENTS, f"--window-size={width},{height}", *arguments]:
            options.add_argument(argument)
        options.binary_location = "/usr/bin/chromium"
        options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
        self.driver = webdriver.Chrome(service=Service("/usr/bin/chromedriver"), options=options)
        self.driver.set_script_timeout(120)
        self.driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", {
            "width": width, "height": height, "deviceScaleFactor": 1, "mobile": width < 600})

    def open(self, url):
        self.driver.get(url)

    def run(self, body, *arguments):
        """Runs the body of an async function; `v` is the viewer, `$` finds within it."""
        result = self.driver.execute_async_script(
            "const done = arguments[arguments.length - 1], given = arguments;"
            "const v = document.querySelector('relumine-viewer');"
            "const $ = (selector) => v.shadowRoot.querySelector(selector);"
            "const settled = async () => { await v.ready; do { await new Promise((r) => setTimeout(r, 40)); }"
            " while (!v.isSettled); await new Promise((r) => requestAnimationFrame(() => requestAnimationFrame(r))); };"
            f"Promise.race([customElements.whenDefined('relumine-viewer'), new Promise((r) => setTimeout(r, 5000))]).then(async () => {{ {body} }}).then((value) => done({{value}}), (error) => done({{error: String(error)}}));",
            *arguments)
        if "error" in result:
            raise AssertionError(result["error"])
        return result.get("value")

    def requests(self):
        """URLs that the page asked for."""
        urls = []
        for entry in self.driver.get_log("performance"):
            message = json.loads(entry["message"])["message"]
            if message["method"] == "Network.requestWillBeSent":
                urls.append(message["params"]["request"]["url"])
        return urls

    def errors(self):
        return [entry["message"] for entry in self.driver.get_log("browser") if entry["level"] == "SEVERE"]

    def picture(self, path):
        time.sleep(0.5)
        self.driver.save_screenshot(str(path))

    def close(self):
        self.driver.quit()
