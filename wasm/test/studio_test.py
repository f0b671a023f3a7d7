"""Drops a scan on the studio's static page in headless Chromium and waits for its mesh, made in the page; then cancels,
fits a function, for which the larger program is loaded, and follows a disc through frames.

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


def disc(t, n=24):
    """A frame of a disc that moves, as .mha."""
    head = f"ObjectType = Image\nNDims = 2\nDimSize = {n} {n}\nElementType = MET_UCHAR\nElementDataFile = LOCAL\n"
    inside = (math.dist((x, y), (7 + 2 * t, 12)) < 4.5 for y in range(n) for x in range(n))
    return head.encode() + bytes(100 if each else 10 + i % 3 for i, each in enumerate(inside))


DROP = """
const transfer = new DataTransfer();
for (const [name, text] of arguments[0])
  transfer.items.add(new File([Uint8Array.from(atob(text), (c) => c.charCodeAt(0))], name));
document.body.dispatchEvent(new DragEvent("drop", {bubbles: true, cancelable: true, dataTransfer: transfer}));
"""
MESHES = """const done = arguments[0];
studio.engine.files().then((files) => done(files.filter(({kind, made}) => made && kind === "mesh").map(({name}) => name)));"""
CANCEL = """const done = arguments[0], stop = new AbortController();
const asked = {command: "reconstruct", args: ["scan.ply", "-o", "late.ply", "--resolution", "900"]};
studio.engine.run(asked, () => stop.abort(), stop.signal).then(() => done("ended"), (error) => done(error.name));"""
REPORT = """const done = arguments[0];
const {name} = studio.files.items.find(({name}) => name.endsWith(".html"));
studio.engine.download(name).then((blob) => blob.text()).then((page) => done([page.includes("/* csrbf_viewer.js */"), page.length]));"""
FIT = """const done = arguments[0];
const rows = Array.from({length: 40}, (_, i) => [Math.sin(i), Math.cos(2.3 * i), Math.sin(i) + i % 3].join(","));
studio.engine.open(new File([["x,y,v", ...rows].join("\\n")], "table.csv"), "table.csv")
  .then(() => studio.engine.run({command: "fit", args: ["table.csv", "-o", "table.csrbf"]}))
  .then(({items}) => done(items.map(({name, kind}) => `${name} ${kind}`)), (error) => done(error.message));"""


LABELS = """const slices = studio.stage.slices, at = 12 * 24 + 7;
return slices && slices.labels && [0, 2, 4].map((t) => slices.labels.values[at + 2 * t]);"""
FRAME = """const frame = document.querySelector("[name=frame]");
frame.value = arguments[0];
frame.dispatchEvent(new Event("input", {bubbles: true}));"""


def drop(browser, *files):
    """Drops files on the page: their names and bytes."""
    browser.execute_script(DROP, [(name, base64.b64encode(data).decode()) for name, data in files])


def follow(browser, wait):
    drop(browser, *((f"beat_{t}.mha", disc(t)) for t in range(5)))
    wait.until(lambda b: b.execute_script("return studio.task.command === 'track' && studio.stage.slices.frames === 5"))
    wait.until(lambda b: b.execute_script("const run = document.querySelector('[name=run]'); return run && !run.disabled"))
    browser.execute_script("document.querySelector('[name=run]').click()")
    wait.until(lambda b: b.execute_script(LABELS) == [1, 1, 0])  # radius 4.5: its centre moves by 2, the last is outside
    browser.execute_script(FRAME, 4)
    wait.until(lambda b: b.execute_script(LABELS) == [0, 1, 1])
    text = browser.execute_script("return document.querySelector('[name=download-frames]').textContent")
    assert "5 label images" in text, text


def loaded(browser):
    """Names of the files that the page has asked for, and other hosts."""
    names = browser.execute_script("return performance.getEntriesByType('resource').map(({name}) => name)")
    return {name.rsplit("/", 1)[1] if name.startswith("http://127.0.0.1") else name for name in names}


def work(browser, address):
    browser.set_script_timeout(60)
    browser.get(address + "index.html")
    wait = WebDriverWait(browser, 60)
    wait.until(lambda b: b.execute_script("return Boolean(window.studio && document.querySelector('[type=file]'))"))
    drop(browser, ("scan.ply", scan(1500)))
    wait.until(lambda b: b.execute_script("const run = document.querySelector('[name=run]'); return run && !run.disabled"))
    browser.execute_script("document.querySelector('[name=run]').click()")
    wait.until(lambda b: b.execute_async_script(MESHES))
    wait.until(lambda b: b.execute_script("return !studio.running && studio.history.length"))
    assert loaded(browser) <= {"csrbf_viewer.js", "csrbf_worker.js", "csrbf_surfaces.wasm.lzma"}, loaded(browser)
    is_bare, length = browser.execute_async_script(REPORT)
    assert not is_bare and length > 500000, (is_bare, length)
    assert browser.execute_async_script(CANCEL) == "AbortError"
    assert browser.execute_async_script(FIT) == ["table.csrbf function"]
    assert "csrbf_program.wasm.lzma" in loaded(browser)
    follow(browser, wait)


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
