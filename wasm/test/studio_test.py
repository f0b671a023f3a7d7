"""Drops a scan on the studio's static page in headless Chromium and waits for its mesh, made in the page; then cancels, and
fits a function, for which the larger program is loaded.

usage: studio_test.py FOLDER-OF-THE-PAGE; exit status 77: Chromium, its driver or selenium are absent
"""

import base64
import functools
import http.server
import math
import struct
import sys
import threading

try:
    from selenium import webdriver
    from selenium.common.exceptions import WebDriverException
    from selenium.webdriver.support.ui import WebDriverWait
except ImportError:
    print("skipped: selenium is not installed")
    sys.exit(77)


class Handler(http.server.SimpleHTTPRequestHandler):
    def log_message(self, *_):
        pass


def scan(count):
    rows = bytearray()
    for i in range(count):
        z = 1 - (2 * i + 1) / count
        r = math.sqrt(1 - z * z)
        rows += struct.pack("<3f", r * math.cos(2.4 * i), r * math.sin(2.4 * i), z)
    head = f"ply\nformat binary_little_endian 1.0\nelement vertex {count}\n"
    return (head + "property float x\nproperty float y\nproperty float z\nend_header\n").encode() + bytes(rows)


DROP = """
const bytes = Uint8Array.from(atob(arguments[0]), (c) => c.charCodeAt(0));
const transfer = new DataTransfer();
transfer.items.add(new File([bytes], "scan.ply"));
document.body.dispatchEvent(new DragEvent("drop", {bubbles: true, cancelable: true, dataTransfer: transfer}));
"""
MESHES = """const done = arguments[0];
studio.engine.files().then((files) => done(files.filter(({kind, made}) => made && kind === "mesh").map(({name}) => name)));"""
CANCEL = """const done = arguments[0], stop = new AbortController();
const asked = {command: "reconstruct", args: ["scan.ply", "-o", "late.ply", "--resolution", "900"]};
studio.engine.run(asked, () => stop.abort(), stop.signal).then(() => done("ended"), (error) => done(error.name));"""
REPORT = """const done = arguments[0];
const {name} = studio.items.find(({name}) => name.endsWith(".html"));
studio.engine.download(name).then((blob) => blob.text()).then((page) => done([page.includes("/* csrbf_viewer.js */"), page.length]));"""
FIT = """const done = arguments[0];
const rows = Array.from({length: 40}, (_, i) => [Math.sin(i), Math.cos(2.3 * i), Math.sin(i) + i % 3].join(","));
studio.engine.open(new File([["x,y,v", ...rows].join("\\n")], "table.csv"), "table.csv")
  .then(() => studio.engine.run({command: "fit", args: ["table.csv", "-o", "table.csrbf"]}))
  .then(({items}) => done(items.map(({name, kind}) => `${name} ${kind}`)), (error) => done(error.message));"""


def loaded(browser):
    """Names of the files that the page has asked for, and other hosts."""
    names = browser.execute_script("return performance.getEntriesByType('resource').map(({name}) => name)")
    return {name.rsplit("/", 1)[1] if name.startswith("http://127.0.0.1") else name for name in names}


def work(browser, address):
    browser.set_script_timeout(60)
    browser.get(address + "index.html")
    wait = WebDriverWait(browser, 60)
    wait.until(lambda b: b.execute_script("return Boolean(window.studio && document.querySelector('[type=file]'))"))
    browser.execute_script(DROP, base64.b64encode(scan(1500)).decode())
    wait.until(lambda b: b.execute_script("const run = document.querySelector('[name=run]'); return run && !run.disabled"))
    browser.execute_script("document.querySelector('[name=run]').click()")
    wait.until(lambda b: b.execute_async_script(MESHES))
    wait.until(lambda b: b.execute_script("return !studio.running && studio.history.length"))
    assert loaded(browser) <= {"csrbf_viewer.js", "csrbf_worker.js", "csrbf_surfaces.wasm"}, loaded(browser)
    is_bare, length = browser.execute_async_script(REPORT)
    assert not is_bare and length > 500000, (is_bare, length)
    assert browser.execute_async_script(CANCEL) == "AbortError"
    assert browser.execute_async_script(FIT) == ["table.csrbf function"]
    assert "csrbf_program.wasm" in loaded(browser)


def run(folder, work):
    """Serves the folder and calls work(browser, address); the exit status."""
    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), functools.partial(Handler, directory=folder))
    threading.Thread(target=server.serve_forever, daemon=True).start()
    options = webdriver.ChromeOptions()
    for flag in ("--headless=new", "--no-sandbox", "--disable-dev-shm-usage", "--window-size=1200,800"):
        options.add_argument(flag)
    try:
        browser = webdriver.Chrome(options=options)
    except WebDriverException as error:
        print("skipped: no Chromium with its driver:", error.msg)
        return 77
    try:
        work(browser, f"http://127.0.0.1:{server.server_port}/")
    finally:
        browser.quit()
    return 0


if __name__ == "__main__":
    sys.exit(run(sys.argv[1], work))
