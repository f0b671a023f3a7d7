"""Works in the studio in headless Chromium: a scan dropped, reconstructed, cut, measured and exported; a table with columns
chosen; a volume with painted seeds; a command cancelled; the page loaded again; dark, narrow, touch. No request leaves
the machine.

usage: studio_browser_test.py PROGRAM [unittest options]

With the variable CSRBF_SCREENSHOTS set to a folder, pictures of the page go there. Ends with 77 (skipped) when
Chromium, its driver, selenium or the studio is missing.
"""

import base64
import math
import os
import random
import re
import signal
import struct
import subprocess
import sys
import time
import unittest

# Background jobs ignore Ctrl-C, and so do the programs they start.
signal.signal(signal.SIGINT, signal.default_int_handler)

PROGRAM = ""
PATIENCE = 180  # seconds, on a busy machine

sys.dont_write_bytecode = True  # leave no files in the folder of the sources
from chromium import SKIPPED, missing_browser, set_window, start_browser

try:
    from selenium.common.exceptions import StaleElementReferenceException
    from selenium.webdriver.common.action_chains import ActionChains
    from selenium.webdriver.common.by import By
    from selenium.webdriver.support.ui import Select, WebDriverWait
except ImportError:
    ActionChains = None


def ball(n, z_scale=0.8):
    golden = math.pi * (3 - math.sqrt(5))
    for i in range(n):
        z = 1 - (2 * i + 1) / n
        r = math.sqrt(1 - z * z)
        yield 3 * r * math.cos(golden * i), 3 * r * math.sin(golden * i), 3 * z_scale * z


def volume(n=20):
    """A bright ball in a dark volume, as .mha."""
    values = [100 if math.dist((x, y, z), (9, 10, 10)) < 6 else 20 for z in range(n) for y in range(n) for x in range(n)]
    head = f"ObjectType = Image\nNDims = 3\nDimSize = {n} {n} {n}\nElementSpacing = 0.5 0.5 0.5\n"
    head += "ElementType = MET_SHORT\nElementDataFile = LOCAL\n"
    return head.encode() + struct.pack("<%dh" % len(values), *values)


def start(*arguments):
    studio = subprocess.Popen([PROGRAM, "studio", "--no-browser", "--threads", "2", *arguments], stdout=subprocess.PIPE,
                              stderr=subprocess.PIPE, text=True)
    found = re.search(r"http://\S+", studio.stdout.readline())
    return studio, found and found.group(0)


class Studio(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        start_browser(cls, PATIENCE)
        cls.studio, cls.address = start()
        cls.addClassCleanup(cls.end)

    @classmethod
    def end(cls):
        cls.studio.send_signal(signal.SIGINT)
        cls.studio.communicate(timeout=60)

    def setUp(self):
        self.open()

    def open(self, width=1280, height=860, dark=False, fragment=""):
        set_window(self.browser, width, height, dark)
        self.browser.get("about:blank")
        self.browser.get_log("browser")
        self.browser.get(self.address + fragment)
        self.until("window.studio && studio.commands instanceof Map")

    def tearDown(self):
        messages = [entry["message"] for entry in self.browser.get_log("browser")]
        self.assertEqual([m for m in messages if "Download" not in m], [])
        loaded = self.browser.execute_script("return performance.getEntriesByType('resource').map((e) => e.name)")
        self.assertEqual([n for n in loaded if not n.startswith((self.address, "data:", "blob:"))], [])

    def js(self, script, *arguments):
        return self.browser.execute_script("return " + script, *arguments)

    def until(self, condition):
        WebDriverWait(self.browser, PATIENCE, 0.1).until(
            lambda browser: browser.execute_script("return Boolean(%s)" % condition), condition)

    def drop(self, name, data):
        """Drops a file on the page, as a mouse does."""
        self.browser.execute_script("""
            const bytes = Uint8Array.from(atob(arguments[1]), (c) => c.charCodeAt(0));
            const transfer = new DataTransfer();
            transfer.items.add(new File([bytes], arguments[0]));
            document.body.dispatchEvent(new DragEvent("dragenter", {bubbles: true, cancelable: true, dataTransfer: transfer}));
            document.body.dispatchEvent(new DragEvent("drop", {bubbles: true, cancelable: true, dataTransfer: transfer}));
            """, name, base64.b64encode(data).decode())
        self.until("studio.task.item && studio.task.item.name.startsWith('%s') && "
                   "studio.page.commandLine.textContent.includes(studio.task.item.name)" % name.split(".")[0])

    def drop_all(self, files):
        """Drops several files at once: pairs of name and data."""
        self.browser.execute_script("""
            const transfer = new DataTransfer();
            for (const [name, text] of arguments[0])
              transfer.items.add(new File([Uint8Array.from(atob(text), (c) => c.charCodeAt(0))], name));
            document.body.dispatchEvent(new DragEvent("drop", {bubbles: true, cancelable: true, dataTransfer: transfer}));
            """, [(name, base64.b64encode(data).decode()) for name, data in files])

    def find(self, selector):
        return self.browser.find_element(By.CSS_SELECTOR, selector)

    def click(self, name):
        self.find(f"[name='{name}']").click()

    def choose(self, name, value):
        for _ in range(50):
            try:
                return Select(self.find(f"[name='{name}']")).select_by_value(value)
            except StaleElementReferenceException:  # the page made its controls again
                time.sleep(0.1)
        self.fail(f"the control {name} does not stay")

    def slide(self, name, value, event="input"):
        self.browser.execute_script(
            "arguments[0].value = arguments[1]; arguments[0].dispatchEvent(new Event(arguments[2], {bubbles: true}))",
            self.find(f"[name='{name}']"), value, event)

    def run_command(self):
        before = self.js("studio.history.length")
        self.click("run")
        self.until(f"!studio.running && (studio.history.length > {before} || studio.page.message.classList.contains('error'))")
        self.assertEqual(self.js("studio.page.message.classList.contains('error') && studio.page.message.textContent"), False)

    def python_writes(self, inputs, lines, *names):
        """Whether these lines write the same files as the studio; `inputs`: data of files by name."""
        folder = os.path.join(self.folder.name, "python")
        os.makedirs(folder, exist_ok=True)
        for name, data in inputs.items():
            with open(os.path.join(folder, name), "wb") as file:
                file.write(data)
        subprocess.run([sys.executable, "-c", lines], cwd=folder, check=True, timeout=PATIENCE)
        for name in names:
            with open(os.path.join(folder, name), "rb") as file:
                self.assertEqual(file.read(), self.fetched(name), name)

    def fetched(self, name):
        """A file of the studio, as the page saves it."""
        text = self.browser.execute_async_script("""
            const done = arguments[arguments.length - 1];
            studio.engine.download(arguments[0]).then((blob) => blob.arrayBuffer()).then((data) => {
              let text = "";
              for (const byte of new Uint8Array(data)) text += String.fromCharCode(byte);
              done(btoa(text));
            }, (error) => done("!" + error.message));""", name)
        self.assertFalse(text.startswith("!"), text)
        return base64.b64decode(text)

    def screenshot(self, name):
        folder = os.environ.get("CSRBF_SCREENSHOTS")
        if folder:
            os.makedirs(folder, exist_ok=True)
            time.sleep(0.4)
            self.browser.save_screenshot(os.path.join(folder, name + ".png"))


class Scan(Studio):
    def test_a_scan_is_dropped_reconstructed_cut_measured_and_exported(self):
        self.drop("scan.xyz", "".join("%.6g %.6g %.6g\n" % p for p in ball(1500)).encode())
        self.assertIn("1,500 points", self.find(".title").text)
        self.assertEqual(Select(self.find("[name='command']")).first_selected_option.text, "reconstruct")
        self.screenshot("points")

        # A slider shows a preview before anything was run.
        self.choose("--resolution", "=value")
        self.slide("--resolution-slider", 400)
        self.until("studio.stage.view.picture?.mesh")
        self.assertIn("--resolution", self.find(".command-line").text)
        self.until("!studio.previews.running")

        self.run_command()
        self.screenshot("surface")
        line = self.find(".command-line").text
        self.assertTrue(line.startswith("csrbf reconstruct scan.xyz -o scan-surface-2.ply"), line)
        ran = self.js("studio.history.current.line")
        facts = self.find(".result .facts").text
        self.assertIn("closed", facts)
        view = "studio.stage.view"
        triangles = self.js(f"{view}.picture.mesh.triangles.length / 3")
        self.assertGreater(triangles, 500)
        self.assertEqual(self.js(f"{view}.picture.scales.map((s) => s.name)"), ["distance of the points", "mean curvature"])

        # Cut through the middle: an ellipse with half axes 3 and 2.4, or a disc.
        self.choose("cut", "z")
        self.slide("depth", 50)
        self.assertAlmostEqual(self.js(f"{view}.cutArea()"), math.pi * 9, delta=0.4)
        self.screenshot("cut")
        self.choose("color", "0")
        self.assertEqual(self.js(f"{view}.legends.length"), 2)  # of the surface, and of the cut
        self.assertIn("On the cut: f", self.js(f"{view}.legends[1].title"))
        self.choose("color", "plain")
        self.choose("cut", "none")

        # The distance between the ends of the ball along x.
        self.choose("measure", "distance")
        for axis in ("x", "-x"):
            self.browser.execute_script(f"""
                {view}.lookFrom("{axis}"); {view}.draw();
                const p = {view}.scene.project([0, 0, 0]); {view}.clicked(p.x, p.y);""")
        self.assertAlmostEqual(float(self.js(f"{view}.measure.text")), 6, delta=0.1)
        self.screenshot("measured")
        self.choose("measure", "none")

        names = [b.get_attribute("data-name") for b in self.browser.find_elements(By.NAME, "download")]
        self.assertEqual(sorted(names), ["scan-reconstruct.html", "scan-surface.ply", "scan.csrbf"])
        mesh = self.fetched("scan-surface.ply")
        self.assertIn(b"element face %d" % triangles, mesh[:600])
        size = self.browser.execute_async_script(f"""
            const done = arguments[0];
            {view}.takePicture(900).then((blob) => createImageBitmap(blob)).then((image) => done(image.width));""")
        self.assertEqual(size, 900)

        # What the page showed gives the same file.
        with open(os.path.join(self.folder.name, "scan.xyz"), "w") as file:
            file.writelines("%.6g %.6g %.6g\n" % p for p in ball(1500))
        subprocess.run([PROGRAM, *ran.split()[1:], "-q"], cwd=self.folder.name, check=True, timeout=PATIENCE)
        with open(os.path.join(self.folder.name, "scan-surface.ply"), "rb") as file:
            self.assertEqual(file.read(), mesh)

        # Before and after, undo and redo.
        self.click("before")
        self.until(f"!{view}.picture.mesh")
        self.click("before")
        self.until(f"{view}.picture.mesh")
        self.click("undo")
        self.until(f"!{view}.picture.mesh")
        self.click("redo")
        self.until(f"{view}.picture.mesh")

        # The model is drawn, and cut at another level.
        self.browser.execute_script("studio.select('scan.csrbf')")
        self.until("studio.item.name === 'scan.csrbf' && studio.stage.view.picture?.mesh && studio.task.command === 'polygonize'")

    def test_a_run_by_the_keyboard_shows_its_picture_and_knows_files_of_other_tabs(self):
        self.drop("keys.xyz", "".join("%.6g %.6g %.6g\n" % p for p in ball(300)).encode())
        self.choose("command", "info")
        self.run_command()
        self.assertEqual(self.js("studio.page.tab"), "report")
        self.assertIn("300", self.find(".result .summary-lines").text)
        self.choose("command", "reconstruct")
        self.browser.execute_async_script("studio.engine.write('keys-surface.ply', 'of another tab').then(arguments[0])")
        self.browser.execute_script("window.dispatchEvent(new Event('focus'))")
        self.until("studio.page.commandLine.textContent.includes('-o keys-surface-2.ply')")
        self.find("[name='run']").send_keys("\n")
        self.until("!studio.running && studio.history.current.command === 'reconstruct'")
        self.until("studio.page.tab === 'space'")
        self.assertEqual(self.js("document.activeElement.name"), "run")
        self.assertEqual(self.fetched("keys-surface.ply"), b"of another tab")
        self.browser.execute_script("sessionStorage.clear()")  # other tests begin without runs

    def test_a_rendered_picture_has_the_axis_upwards_that_the_page_shows(self):
        # A cone on a flat base across y.
        n = 120
        rim = [(math.cos(t), 0, math.sin(t)) for t in (2 * math.pi * i / n for i in range(n))]
        vertices = [*rim, (0, 0, 0), (0, 2, 0)]
        faces = [f for i in range(n) for f in ((i + 1, (i + 1) % n + 1, n + 1), ((i + 1) % n + 1, i + 1, n + 2))]
        text = "".join("v %.6g %.6g %.6g\n" % v for v in vertices) + "".join("f %d %d %d\n" % f for f in faces)
        self.drop("cone.obj", text.encode())
        self.until("studio.item?.name === 'cone.obj' && studio.stage.view.picture?.mesh")
        self.assertEqual(self.js("studio.stage.view.orbit.up"), "y")
        self.until("studio.page.commandLine.textContent.includes('render cone.obj')")
        self.assertIn("--up y", self.find(".command-line").text)
        self.drop("flat.obj", "".join("v %.6g %.6g %.6g\n" % (x, z, y) for x, y, z in vertices).encode() +
                  "".join("f %d %d %d\n" % f for f in faces).encode())
        self.until("studio.page.commandLine.textContent.includes('render flat.obj')")
        self.assertNotIn("--up", self.find(".command-line").text)

    def test_what_is_told_of_a_place_goes_when_the_picture_turns(self):
        self.drop("told.xyz", "".join("%.6g %.6g %.6g\n" % p for p in ball(200)).encode())
        self.until("studio.stage.view.picture")
        readout = "studio.stage.view.readout"
        for turn in ("moved()", "show(studio.stage.view.picture)"):
            self.browser.execute_script("studio.stage.view.tell({kind: 'point', index: 0, place: [0, 0, 0]})")
            self.assertIn("x ", self.js(f"{readout}.innerText"))
            self.browser.execute_script(f"studio.stage.view.{turn}")
            self.until(f"{readout}.hidden")

    def test_the_page_survives_a_reload(self):
        self.drop("again.xyz", "".join("%.6g %.6g %.6g\n" % p for p in ball(300)).encode())
        self.open(fragment="#show=again.xyz")
        self.until("studio.item && studio.item.name === 'again.xyz' && studio.stage.view.picture?.points")

    def test_what_was_run_can_be_undone_after_a_reload(self):
        self.browser.execute_script("sessionStorage.clear()")  # what other tests ran
        self.open()
        self.drop("undone.xyz", "".join("%.6g %.6g %.6g\n" % p for p in ball(300)).encode())
        self.run_command()
        self.browser.refresh()
        self.until("window.studio && studio.stage.view.picture && studio.stage.view.picture?.mesh")
        self.assertEqual(self.js("[studio.item.name, studio.history.at]"), ["undone.xyz", 0])
        self.assertIn("closed", self.find(".result .facts").text)
        self.click("undo")
        self.until("!studio.stage.view.picture?.mesh")
        self.click("redo")
        self.until("studio.stage.view.picture?.mesh")

    def test_a_reload_and_a_link_show_the_same_file_and_view(self):
        for name in ("kept.xyz", "later.xyz"):
            self.drop(name, "".join("%.6g %.6g %.6g\n" % p for p in ball(300)).encode())
        self.browser.execute_async_script("studio.select('kept.xyz').then(arguments[0])")
        self.browser.refresh()
        self.until("window.studio && studio.item && studio.stage.view.picture?.points")
        self.assertEqual(self.js("studio.item.name"), "kept.xyz")
        self.browser.execute_script("studio.stage.view.lookFrom('x'); studio.stage.view.set({exaggeration: 2})")
        link = self.js("studio.stage.view.link()")
        self.open(fragment="#" + link.split("#")[1])
        self.until("studio.item && studio.stage.view.picture?.points")
        self.assertEqual(self.js("[studio.item.name, studio.stage.view.state.exaggeration, studio.stage.view.link()]"),
                         ["kept.xyz", 2, link])


@unittest.skipUnless(os.environ.get("PYTHONPATH"), "the Python module was not built")
class PythonLines(Studio):
    def test_python_lines_read_tables_as_the_program_does(self):
        rows = [(math.sin(i), math.cos(2.3 * i), math.sin(i) * math.cos(0.7 * i)) for i in range(60)]

        def text(head, separator):
            return (head + "".join(separator.join("%.5g" % v for v in row) + "\n" for row in rows)).encode()

        inputs = {"semicolons.csv": text("lat;lon;depth\n", ";"), "remarks.csv": text("# by hand\nx, y,\"v, m\"\n", ","),
                  "tabs.txt": text("x\ty\tv\n", "\t"), "bare.csv": text("", ";"), "behind.dat": text("# taken in May\n# x y v\n", " ")}
        for name, data in inputs.copy().items():
            with self.subTest(name=name):
                self.drop(name, data)
                self.choose("--method", "interpolate")
                lines = self.js("studio.page.python.textContent")
                self.run_command()
                made = self.js("studio.history.current.made.items[0].name")
                self.python_writes(inputs, lines, made)

    def test_python_lines_write_the_same_files(self):
        scan = "".join("%.6g %.6g %.6g\n" % p for p in ball(400)).encode()
        table = "x,y,depth\n" + "".join("%.5g,%.5g,%.5g\n" % (math.sin(i), math.cos(2.3 * i), math.sin(i) * math.cos(0.7 * i))
                                       for i in range(80))
        heights = "ply\nformat ascii 1.0\nelement vertex 80\n" + "".join(f"property float {c}\n" for c in ("x", "y", "z", "depth"))
        heights += "end_header\n" + "".join("%.5g %.5g %.5g %.5g\n" % (math.sin(i), math.cos(2.3 * i), math.sin(i), i % 7)
                                            for i in range(80))
        echo = "x,y,z,intensity\n" + "".join("%.5g,%.5g,%.5g,%d\n" % (math.sin(i), math.cos(2.3 * i), math.sin(1.7 * i), i % 9)
                                              for i in range(80))
        inputs = {"cloud.xyz": scan, "samples.csv": table.encode(), "heights.ply": heights.encode(), "echo.csv": echo.encode(), "head.mha": volume(16)}
        work = [("cloud.xyz", "reconstruct", {"--resolution": "30"}, ["cloud-surface.ply", "cloud.csrbf"]),
                ("cloud.xyz", "reconstruct", {"--sharp": "off", "--normals": "estimate"}, ["cloud-surface-2.ply"]),
                ("cloud.xyz", "estimate-normals", {}, ["cloud-normals.ply"]),
                ("cloud.csrbf", "polygonize", {"--level": "0.01"}, ["cloud-mesh.ply"]),
                ("cloud.csrbf", "curvature", {"--resolution": "24"}, ["cloud-curvature.ply", "cloud-ridges.ply"]),
                ("cloud.csrbf", "render", {"--size": "160x120", "--color": "normal"}, ["cloud.png"]),
                ("samples.csv", "fit", {}, ["samples.csrbf"]),
                ("heights.ply", "fit", {}, ["heights.csrbf"]),
                ("echo.csv", "fit", {}, ["echo.csrbf"]),
                ("echo.csv", "fit", {"--coordinates": "2,1", "--values": "intensity"}, ["echo-2.csrbf"]),
                ("heights.ply", "fit", {"--coordinates": "y,x", "--values": "depth"}, ["heights-2.csrbf"]),
                ("samples.csrbf", "evaluate", {"--grid": "20,30"}, ["samples-values.npy"]),
                ("head.mha", "segment", {}, ["head-labels.mha", "head-contour.ply"]),
                ("head.mha", "segment", {"--objects": True}, ["head-labels-2.mha"]),
                ("head.mha", "inpaint", {"--missing": "20"}, ["head-filled.mha"])]
        for name, data in inputs.items():
            self.drop(name, data)
        for name, command, flags, names in work:
            with self.subTest(command=command, flags=flags):
                self.browser.execute_async_script("studio.select(arguments[0]).then(arguments[1])", name)
                self.choose("command", command)
                self.browser.execute_script(
                    "for (const [flag, value] of Object.entries(arguments[0])) studio.task.values[studio.task.command].set(flag, value);"
                    "studio.task.update();", flags)
                lines = self.js("studio.page.python.textContent")
                self.run_command()
                for made in names:
                    inputs[made] = self.fetched(made)
                self.python_writes(inputs, lines, *names)


class Table(Studio):
    def test_columns_are_chosen_and_a_function_is_fitted(self):
        source = random.Random(3)
        rows = ["id,east,north,depth,sigma"]
        for i in range(250):
            x, y = source.uniform(0, 4), source.uniform(0, 3)
            rows.append("%d,%.5g,%.5g,%.5g,1" % (i, x, y, math.sin(x) * math.cos(y) + source.gauss(0, 0.02)))
        self.drop("soundings.csv", "\n".join(rows).encode())
        self.until("studio.task.roles")
        # Names tell what is what; another choice is possible.
        self.assertIn("--coordinates east,north --values depth", self.find(".command-line").text)
        self.choose("role-0", "coordinate")
        self.assertIn("--coordinates id,east,north --values depth", self.find(".command-line").text)
        self.choose("role-0", "")
        self.assertIn("--coordinates east,north --values depth", self.find(".command-line").text)
        self.screenshot("table")
        self.run_command()
        self.assertEqual(self.js("studio.stage.view.picture.axes"), ["east", "north", "depth"])
        self.assertIn("standard deviation", self.js("studio.stage.view.picture.scales.map((s) => s.name)"))
        self.screenshot("function")
        self.click("tab-report")
        told = [p.text for p in self.browser.find_elements(By.CSS_SELECTOR, ".pane.report .summary *")]
        self.assertEqual(len(told), len(set(told)))
        titles = [h.text for h in self.browser.find_elements(By.CSS_SELECTOR, ".pane.report .panel h2")]
        self.assertIn("Predicted against left-out values", titles)
        self.assertIn("Errors at the samples", titles)
        self.screenshot("report")
        python = self.js("studio.page.python.textContent")
        self.assertIn('table = pd.read_csv("soundings.csv"', python)
        self.assertIn('csrbf.fit(table, "depth", coordinates=["east", "north"])', python)


class Volume(Studio):
    def test_seeds_are_painted_on_slices_and_the_volume_is_divided(self):
        self.drop("body.mha", volume())
        self.until("studio.stage.slices.image")
        for label, place in (("1", (2, 2)), ("2", (9, 10))):
            self.choose("brush", label)
            x, y = self.js("(() => { const at = studio.stage.slices.placement(); return [at.toX(%d), at.toY(%d)]; })()" % place)
            canvas = self.find("canvas.slice")
            box = canvas.rect
            ActionChains(self.browser).move_to_element_with_offset(
                canvas, round(x - box["width"] / 2), round(y - box["height"] / 2)).click_and_hold().move_by_offset(4, 3).release().perform()
        self.assertGreater(self.js("studio.stage.slices.seeds.size"), 10)
        self.until("studio.files.items.some((i) => i.name === 'body-seeds.csv')")
        self.assertIn(b"x,y,z,label", self.fetched("body-seeds.csv"))
        self.assertIn("--seeds body-seeds.csv", self.find(".command-line").text)
        self.until("studio.stage.slices.labels")  # the preview
        self.run_command()
        self.until("studio.stage.slices.labels")
        self.assertEqual(self.js("[studio.stage.slices.labels.values[10 * 20 + 9], studio.stage.slices.labels.values[2 * 20 + 2]]"),
                         [1, 0])
        self.assertGreater(self.js("studio.stage.slices.lines.length"), 20)
        # A slice without the contour gives way to one that has it, once the contour is new.
        self.slide("slice", 0)
        self.until("studio.stage.slices.state.index === 0 && studio.stage.slices.lines.length === 0")
        self.browser.execute_async_script("studio.stage.slices.goToContour().then(arguments[0])")
        self.assertEqual(self.js("studio.stage.slices.state.index"), 10)
        self.assertGreater(self.js("studio.stage.slices.lines.length"), 20)
        self.slide("slice", 6)
        self.until("studio.stage.slices.state.index === 6 && studio.stage.slices.image")
        self.screenshot("volume")
        self.click("tab-space")
        self.until("studio.stage.view.picture?.mesh.triangles.length > 300")
        self.assertEqual(self.fetched("body-labels.mha")[:10], b"ObjectType")

    def test_seeds_at_the_border_are_in_the_coarse_image_of_a_preview(self):
        n = 40  # every second voxel of it; the last one is between them
        values = [100 if math.dist((x, y, z), (19, 20, 20)) < 12 else 20 for z in range(n) for y in range(n) for x in range(n)]
        head = f"ObjectType = Image\nNDims = 3\nDimSize = {n} {n} {n}\nElementType = MET_SHORT\nElementDataFile = LOCAL\n"
        self.drop("border.mha", head.encode() + struct.pack("<%dh" % len(values), *values))
        # The page began with another volume.
        self.until("studio.page.commandLine.textContent.includes('segment border.mha') && studio.stage.slices.image.width === 40")
        self.browser.execute_script("""const {seeds} = studio.stage.slices;
            seeds.set("39,39,39", 1).set("19,20,20", 2); studio.seedsPainted();""")
        self.until("studio.stage.slices.labels || studio.page.message.classList.contains('error')")
        self.assertEqual(self.js("studio.page.message.classList.contains('error') && studio.page.message.textContent"), False)

    def test_seeds_in_patient_space_are_previewed_and_stay_while_other_images_are_looked_at(self):
        n = 24
        values = [100 if math.dist((x, y, z), (9, 10, 10)) < 6 else 20 for z in range(n) for y in range(n) for x in range(n)]
        head = f"NRRD0004\ntype: short\ndimension: 3\nspace: right-anterior-superior\nsizes: {n} {n} {n}\n"
        head += "space directions: (2,0,0) (0,2,0) (0,0,2)\nspace origin: (100,30,50)\nendian: little\nencoding: raw\n\n"
        self.drop("patient.nrrd", head.encode() + struct.pack("<%dh" % len(values), *values))
        self.until("studio.page.commandLine.textContent.includes('segment patient.nrrd') && studio.stage.slices.image.width === 24")
        self.browser.execute_script("""const {seeds} = studio.stage.slices;
            seeds.set("2,2,12", 1).set("9,10,12", 2); studio.seedsPainted();""")
        self.until("studio.stage.slices.labels || studio.page.message.classList.contains('error')")
        self.assertEqual(self.js("studio.page.message.classList.contains('error') && studio.page.message.textContent"), False)
        self.drop("another.mha", volume())
        self.assertNotIn("--seeds", self.find(".command-line").text)
        self.assertEqual(self.js("studio.stage.slices.seeds.size"), 0)
        self.browser.execute_async_script("studio.select('patient.nrrd').then(arguments[0])")
        self.assertEqual(self.js("studio.stage.slices.seeds.size"), 2)
        self.assertIn("--seeds patient-seeds.csv", self.find(".command-line").text)

    def test_a_few_extreme_values_do_not_make_an_image_grey(self):
        n = 32
        values = [30000 if (x, y) == (3, 3) else 100 + x + y for y in range(n) for x in range(n)]
        head = f"ObjectType = Image\nNDims = 2\nDimSize = {n} {n}\nElementType = MET_SHORT\nElementDataFile = LOCAL\n"
        self.drop("metal.mha", head.encode() + struct.pack("<%dh" % len(values), *values))
        self.until("studio.item?.name === 'metal.mha' && studio.stage.slices.image?.width === 32 && studio.stage.slices.hasWindow")
        slices = "studio.stage.slices"
        self.assertLess(self.js(f"{slices}.valueAt({slices}.state.high)"), 200)
        # Black and white are told as values.
        self.slide("white", 100)
        self.assertIn("30", self.js("document.querySelector('[name=white]').parentElement.querySelector('output').textContent"))
        self.click("reset-slice")
        self.assertLess(self.js(f"{slices}.valueAt({slices}.state.high)"), 200)

    def test_holes_are_painted_and_filled(self):
        n = 32
        values = bytes(250 if 14 <= x < 18 and 4 <= y < 28 else 60 + 2 * x + y for y in range(n) for x in range(n))
        image = b"P5 %d %d 255\n" % (n, n) + values
        self.drop("scratch.pgm", image)
        self.until("studio.task.item.name === 'scratch.pgm' && studio.stage.slices.image?.width === 32")
        self.choose("command", "inpaint")
        self.until("studio.stage.slices.seeds.areHoles")
        self.assertNotIn("--mask", self.find(".command-line").text)
        self.choose("brush", "2")
        actions = ActionChains(self.browser)
        pointer = actions.w3c_actions.pointer_action
        pointer.move_to_location(*map(round, self.voxel_on_page(16, 3)))
        pointer.pointer_down()
        pointer.move_to_location(*map(round, self.voxel_on_page(16, 28)))
        pointer.release()
        self.slide("brush-size", 6)
        actions.perform()
        self.until("studio.files.items.some((i) => i.name === 'scratch-holes.nrrd')")
        self.assertIn("--mask scratch-holes.nrrd", self.find(".command-line").text)
        # They are there again after a reload, and no seeds of segment.
        count = self.js("studio.stage.slices.seeds.size")
        self.assertGreater(count, 100)
        self.browser.refresh()
        self.until("window.studio && studio.item?.name === 'scratch.pgm' && studio.stage.slices.image")
        self.assertEqual(self.js("studio.stage.slices.seeds.size"), 0)
        self.choose("command", "inpaint")
        self.until(f"studio.stage.slices.seeds.size === {count}")
        lines = self.js("studio.page.python.textContent")
        self.run_command()
        filled = self.fetched("scratch-filled.pgm")[-n * n:]
        self.assertLess(max(abs(filled[y * n + 16] - (60 + 32 + y)) for y in range(n)), 3)
        self.python_writes({"scratch.pgm": image, "scratch-holes.nrrd": self.fetched("scratch-holes.nrrd")}, lines, "scratch-filled.pgm")

    def voxel_on_page(self, x, y):
        """Where a voxel of the slice is in the window."""
        return self.js("""(() => { const at = studio.stage.slices.placement(), box = studio.stage.slices.canvas.getBoundingClientRect();
            return [box.left + at.toX(%d), box.top + at.toY(%d)]; })()""" % (x, y))

    def touch(self, *paths):
        """Fingers that go along paths of places in the window, all at once."""
        def send(kind, step):
            points = [{"x": path[step][0], "y": path[step][1], "id": i} for i, path in enumerate(paths)]
            self.browser.execute_cdp_cmd("Input.dispatchTouchEvent", {"type": kind, "touchPoints": points if kind != "touchEnd" else []})

        send("touchStart", 0)
        for step in range(1, len(paths[0])):
            send("touchMove", step)
        send("touchEnd", -1)

    def test_seeds_stay_when_the_page_is_loaded_again_and_strokes_are_taken_back(self):
        self.drop("kept.mha", volume())
        self.until("studio.task.item.name === 'kept.mha' && studio.stage.slices.image")
        count = "studio.stage.slices.seeds.size"
        sizes = [0]
        for label, place in (("1", (2, 2)), ("2", (9, 10))):
            self.choose("brush", label)
            actions = ActionChains(self.browser)
            actions.w3c_actions.pointer_action.move_to_location(*map(round, self.voxel_on_page(*place)))
            actions.click().perform()
            sizes.append(self.js(count))
        self.assertLess(sizes[1], sizes[2])
        self.until("studio.stage.slices.labels")  # the preview
        self.click("undo")
        self.assertEqual(self.js(count), sizes[1])
        self.click("redo")
        self.until(f"{count} === {sizes[2]} && studio.stage.slices.labels")
        self.until("studio.files.items.some((i) => i.name === 'kept-seeds.csv')")
        seeds = "[...studio.stage.slices.seeds].sort().join(' ')"
        before = self.js(seeds)
        self.browser.refresh()
        self.until("window.studio && studio.item?.name === 'kept.mha' && studio.stage.slices.image")
        self.assertEqual(self.js(seeds), before)
        self.assertIn("--seeds kept-seeds.csv", self.find(".command-line").text)

        # Without seeds no table of them is left.
        self.click("clear-seeds")
        self.until("studio.files.items.every((i) => i.name !== 'kept-seeds.csv')")
        self.assertNotIn("--seeds", self.find(".command-line").text)

    def test_a_finger_paints_and_two_move_the_slice(self):
        self.browser.execute_cdp_cmd("Emulation.setTouchEmulationEnabled", {"enabled": True, "maxTouchPoints": 2})
        self.addCleanup(lambda: self.browser.execute_cdp_cmd("Emulation.setTouchEmulationEnabled", {"enabled": False}))
        self.open(width=390, height=844)
        self.drop("finger.mha", volume())
        self.until("studio.task.item.name === 'finger.mha' && studio.stage.slices.image")
        self.choose("brush", "2")
        self.browser.execute_script("window.scrollTo(0, 0)")
        x, y = self.voxel_on_page(10, 6)
        self.touch([(x, y + i) for i in range(0, 90, 10)])
        painted = self.js("new Set([...studio.stage.slices.seeds.keys()].map((k) => k.split(',')[1])).size")
        self.assertGreater(painted, 4)  # rows: the page did not take the finger to scroll
        self.assertEqual(self.js("window.scrollY"), 0)
        self.touch([(x - i, y) for i in range(10, 90, 10)], [(x + i, y + 20) for i in range(10, 90, 10)])
        self.assertGreater(self.js("studio.stage.slices.state.zoom"), 2)
        self.assertEqual(self.js("new Set([...studio.stage.slices.seeds.keys()].map((k) => k.split(',')[1])).size"), painted)
        # Without a brush one finger scrolls the page, in space too.
        self.choose("brush", "0")
        self.assertEqual(self.js("[studio.stage.slices, studio.stage.view].map((view) => view.canvas.style.touchAction)"), ["pan-y", "pan-y"])

    def test_the_value_under_the_mouse_is_told_and_seeds_are_erased(self):
        self.drop("probe.mha", volume())
        self.until("studio.stage.slices.image")
        canvas = self.find("canvas.slice")

        def at(x, y):
            place = self.js("(() => { const at = studio.stage.slices.placement(); return [at.toX(%d), at.toY(%d)]; })()" % (x, y))
            box = canvas.rect
            return round(place[0] - box["width"] / 2), round(place[1] - box["height"] / 2)

        ActionChains(self.browser).move_to_element_with_offset(canvas, *at(9, 10)).perform()
        readout = self.find(".pane.slices .readout").text
        self.assertIn("voxel 9, 10, 10", readout)
        self.assertIn("at 4.5, 5, 5", readout)
        self.assertIn("value 100", readout)
        self.slide("slice", 19)  # the mouse stays where it is
        self.until("studio.stage.slices.state.index === 19 && studio.stage.slices.readout.textContent.includes('voxel 9, 10, 19')")
        self.assertIn("value 20", self.find(".pane.slices .readout").text)
        self.choose("brush", "2")
        for index in (10, 12):
            self.slide("slice", index)
            self.until("studio.stage.slices.state.index === %d" % index)
            ActionChains(self.browser).move_to_element_with_offset(canvas, *at(9, 10)).click().perform()
        self.assertEqual(self.js("[...new Set([...studio.stage.slices.seeds.keys()].map((k) => k.split(',')[2]))].sort()"),
                         ["10", "12"])
        self.choose("brush", "-1")
        ActionChains(self.browser).move_to_element_with_offset(canvas, *at(9, 10)).click().perform()
        self.assertEqual(self.js("[...new Set([...studio.stage.slices.seeds.keys()].map((k) => k.split(',')[2]))]"), ["10"])
        self.click("clear-seeds")
        self.assertEqual(self.js("studio.stage.slices.seeds.size"), 0)


def disc(t, n=24):
    """A frame of a disc that moves, as .mha."""
    head = f"ObjectType = Image\nNDims = 2\nDimSize = {n} {n}\nElementType = MET_SHORT\nElementDataFile = LOCAL\n"
    values = [100 if math.dist((x, y), (7 + 2 * t, 12)) < 4.5 else 10 + (x * y) % 3 for y in range(n) for x in range(n)]
    return head.encode() + struct.pack("<%dh" % len(values), *values)


class Frames(Studio):
    def test_a_series_is_dropped_and_its_contour_followed(self):
        frames = 5
        self.drop_all([("beat_%d.mha" % t, disc(t)) for t in range(frames)])
        self.until("studio.task.command === 'track' && studio.stage.slices.image && studio.stage.slices.frames === 5")
        self.assertTrue(self.find("[name='frame']").is_displayed())
        line = self.find(".command-line").text
        self.assertIn("csrbf track beat_0.mha beat_1.mha beat_2.mha beat_3.mha beat_4.mha -o beat-track", line)
        self.run_command()
        self.until("studio.stage.slices.labels")
        for t in (0, 3, 4):
            self.slide("frame", t)
            # Labels arrive after the frame is shown.
            inside, outside = 12 * 24 + 7 + 2 * t, 12 * 24 + (7 + 2 * t - 6 if t else 20)
            self.until(f"studio.stage.slices.state.frame === {t} && studio.stage.slices.labels.values[{inside}] === 1 && "
                       f"studio.stage.slices.labels.values[{outside}] === 0")
            self.assertEqual(self.js("studio.stage.slices.image.values[12 * 24 + %d]" % (7 + 2 * t)), 100)
            # The contour is that of the frame, finer than pixels: lines in pieces of less than one.
            low, high = self.js("[Math.min, Math.max].map((end) => end(...studio.stage.slices.lines.filter((_, i) => i % 2 === 0)))")
            self.assertAlmostEqual((low + high) / 2, 7 + 2 * t, delta=0.3)
            self.assertNotEqual(low % 0.5, 0)
        self.screenshot("track")
        self.click("play")
        self.until("studio.stage.slices.state.frame === 2")
        self.click("play")
        names = [b.get_attribute("data-name") for b in self.browser.find_elements(By.NAME, "download")]
        self.assertEqual(sorted(names), ["beat-track.html", "beat-track/measures.csv"])
        self.assertIn("5 label images", self.find("[name='download-frames']").text)
        self.assertIn("5 contours", self.find("[name='download-contours']").text)
        self.click("tab-report")
        self.assertTrue(self.find(".pane.report .series [name='frame']").is_displayed())
        self.screenshot("track_report")

    def test_the_third_axis_of_a_volume_may_be_time(self):
        head = b"ObjectType = Image\nNDims = 3\nDimSize = 24 24 4\nElementType = MET_SHORT\nElementDataFile = LOCAL\n"
        self.drop("movie.mha", head + b"".join(disc(t).split(b"LOCAL\n", 1)[1] for t in range(4)))
        self.until("studio.stage.slices.image")
        self.choose("command", "track")
        self.until("studio.stage.slices.frames === 4")
        self.assertIn("--slices-are-frames", self.find(".command-line").text)
        self.run_command()
        self.slide("frame", 3)
        self.until("studio.stage.slices.state.frame === 3 && studio.stage.slices.labels.values[12 * 24 + 13] === 1")
        self.choose("command", "segment")
        self.until("studio.stage.slices.frames === 1")


class Large(Studio):
    def test_a_mesh_of_a_million_triangles_is_coarse_while_it_moves(self):
        self.drop("torus.xyz", "".join("%.6g %.6g %.6g\n" % p for p in ball(200)).encode())
        self.until("studio.stage.view.picture")
        self.browser.execute_script("""
            const n = 720, positions = new Float32Array(3 * n * n), triangles = new Uint32Array(6 * n * n);
            for (let j = 0, v = 0; j < n; ++j)
              for (let i = 0; i < n; ++i, ++v) {
                const [a, b] = [(2 * Math.PI * i) / n, (2 * Math.PI * j) / n];
                positions.set([(0.6 + 0.25 * Math.cos(b)) * Math.cos(a), (0.6 + 0.25 * Math.cos(b)) * Math.sin(a), 0.25 * Math.sin(b)], 3 * v);
                const right = j * n + ((i + 1) % n), up = ((j + 1) % n) * n;
                triangles.set([v, right, up + ((i + 1) % n), v, up + ((i + 1) % n), up + i], 6 * v);
              }
            const view = studio.stage.view;
            view.show({...view.picture, points: null, scales: [], mesh: {positions, normals: null, triangles, tint: null}});
            view.draw();
            window.drawn = () => view.scene.renderer.info.render.triangles;""")
        full = self.js("drawn()")
        self.assertGreater(full, 1e6)
        canvas = self.find(".pane.space canvas")
        ActionChains(self.browser).move_to_element(canvas).click_and_hold().move_by_offset(40, 10).perform()
        self.browser.execute_script("studio.stage.view.moved(); studio.stage.view.draw();")
        moving = self.js("drawn()")
        self.assertLess(moving, 0.5 * full)
        self.assertGreater(moving, 20000)
        self.screenshot("large_moving")
        ActionChains(self.browser).release().perform()
        self.until(f"drawn() === {full}")
        self.screenshot("large")


class Stop(Studio):
    def test_a_command_is_cancelled(self):
        rows = ["x,y,v"] + ["%g,%g,%g" % (math.sin(i), math.cos(2.3 * i), math.sin(0.7 * i)) for i in range(3000)]
        self.drop("long.csv", "\n".join(rows).encode())
        self.browser.execute_script("""studio.task.values.fit.set("--method", "interpolate").set("--kernel", "thin-plate")
            .set("--loss", "student"); studio.task.update();""")
        self.click("run")
        self.until("studio.running && document.querySelector('[name=cancel]').offsetParent")
        time.sleep(0.5)
        self.click("cancel")
        self.until("!studio.running")
        self.assertIn("Cancelled", self.find(".message").text)
        self.assertTrue(self.find("[name='run']").is_displayed())
        self.until("studio.files.items.every((i) => i.name !== 'long.csrbf')")

    def test_a_command_runs_on_while_another_file_is_looked_at(self):
        rows = ["x,y,v"] + ["%g,%g,%g" % (math.sin(i), math.cos(2.3 * i), math.sin(0.7 * i)) for i in range(3000)]
        self.drop("other.xyz", "".join("%.6g %.6g %.6g\n" % p for p in ball(300)).encode())
        self.drop("slow.csv", "\n".join(rows).encode())
        self.browser.execute_script("""studio.task.values.fit.set("--method", "interpolate").set("--kernel", "thin-plate")
            .set("--loss", "student"); studio.task.update();""")
        self.click("run")
        self.until("studio.running")
        self.browser.execute_async_script("studio.select('other.xyz').then(arguments[0])")
        self.assertTrue(self.js("Boolean(studio.running)"))
        self.assertFalse(self.find("[name='run']").is_displayed())
        self.click("cancel")
        self.until("!studio.running")
        self.assertTrue(self.find("[name='run']").is_displayed())
        self.assertEqual(self.js("studio.item.name"), "other.xyz")

        # What ends meanwhile is shown with its own file, and remembered as it was started.
        self.browser.execute_async_script("studio.select('slow.csv').then(arguments[0])")
        self.click("defaults")
        line = self.find(".command-line").text
        before = self.js("studio.history.length")
        self.browser.execute_script("studio.run(); studio.select('other.xyz');")
        self.until(f"!studio.running && studio.history.length > {before} && studio.item.name === 'slow.csv'")
        self.assertEqual(self.js("studio.history.entries[studio.history.at].line"), line)
        self.assertIn("3,000 rows", self.find(".title").text)

    def test_a_file_that_changes_on_the_disk_is_shown_as_it_is(self):
        path = os.path.join(self.folder.name, "disk.xyz")

        def write(n):
            with open(path, "w") as file:
                file.writelines("%.6g %.6g %.6g\n" % p for p in ball(n))

        write(300)
        studio, address = start(path)
        try:
            self.browser.get(address)
            self.until("window.studio && studio.stage.view.picture?.points")
            self.assertIn("300 points", self.find(".title").text)
            write(200)
            self.browser.execute_script("window.dispatchEvent(new Event('focus'))")
            self.until("studio.page.title.textContent.includes('200 points')")
            self.assertIn("changed", self.find(".message").text)
            self.run_command()
            self.browser.execute_async_script("studio.refresh().then(arguments[0])")  # the result stays
            self.assertFalse(self.js("studio.page.result.hidden"))
        finally:
            studio.send_signal(signal.SIGINT)
            studio.communicate(timeout=60)
            self.browser.get("about:blank")

    def test_messages_name_files_without_the_folder(self):
        self.drop_all([("letter.ply", b"Dear reader\n")])
        self.until("studio.page.message.classList.contains('error')")
        self.assertTrue(self.find(".message").text.startswith("letter.ply:1: not a PLY file"), self.find(".message").text)
        self.find(".message").click()
        self.assertFalse(self.find(".message").is_displayed())

    def test_only_files_that_can_be_compared_are_offered(self):
        self.drop("flat.mha", disc(0))
        self.drop("near.xyz", "".join("%.6g %.6g %.6g\n" % p for p in ball(200)).encode())
        self.drop("tetrahedron.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n")
        self.choose("command", "compare")
        offered = [option.text for option in Select(self.find("[name='other']")).options]
        self.assertIn("near.xyz", offered)
        self.assertEqual([name for name in offered if not name.endswith((".xyz", ".ply"))], [])

    def test_a_file_that_cannot_be_shown_leaves_the_last_one(self):
        self.drop("shown.xyz", "".join("%.6g %.6g %.6g\n" % p for p in ball(200)).encode())
        self.drop_all([("letter.docx", b"PK" + bytes(300))])
        self.until("studio.page.message.classList.contains('error') && studio.files.items.some((i) => i.name === 'letter.docx')")
        self.until("studio.item && studio.item.name === 'shown.xyz'")
        self.assertIn("shown.xyz", self.find(".files [aria-current]").text)
        self.browser.get_log("browser")  # has the refusal

    def test_warnings_out_of_sight_are_told_beside_run(self):
        image = b"P5 40 40 255\n" + bytes(20 * ((x // 8 + y // 8) % 2) + 100 for y in range(40) for x in range(40))
        self.drop("whole.pgm", image)
        self.until("studio.task.item.name === 'whole.pgm'")
        self.choose("command", "inpaint")
        self.open(height=560, fragment="#show=whole.pgm")
        self.until("studio.item?.name === 'whole.pgm' && studio.stage.slices.image")
        self.choose("command", "inpaint")
        self.run_command()  # nothing is missing
        self.until("document.querySelector('[name=to-result]').offsetParent")
        self.assertEqual(self.find("[name='to-result']").text, "1 warning ↓")
        self.click("to-result")
        self.until("!document.querySelector('[name=to-result]').offsetParent")
        visible = self.js("""(() => { const box = document.querySelector('.warning-list').getBoundingClientRect();
            return box.top >= 0 && box.bottom <= innerHeight; })()""")
        self.assertTrue(visible)

    def test_a_file_is_removed_by_a_second_click(self):
        self.drop("gone.xyz", "".join("%.6g %.6g %.6g\n" % p for p in ball(200)).encode())
        remove = "[...document.querySelectorAll('[name=remove-file]')].find((b) => b.title === 'Remove gone.xyz')"
        self.browser.execute_script(f"{remove}.click()")
        self.assertEqual(self.js(f"{remove}.textContent"), "Remove?")
        self.assertTrue(self.js("Boolean(studio.files.find('gone.xyz'))"))
        self.browser.execute_script(f"{remove}.click()")
        self.until("!studio.files.find('gone.xyz')")

    def test_what_the_program_says_is_shown(self):
        self.drop("few.xyz", b"0 0 0\n1 0 0\n")
        self.click("run")
        self.until("studio.page.message.classList.contains('error')")
        self.assertIn("point", self.find(".message").text)


class Looks(Studio):
    def test_dark_narrow_and_touch(self):
        self.drop("small.xyz", "".join("%.6g %.6g %.6g\n" % p for p in ball(400)).encode())
        for width, dark in ((1280, True), (390, False), (390, True)):
            with self.subTest(width=width, dark=dark):
                self.open(width=width, dark=dark, fragment="#show=small.xyz")
                self.until("studio.stage.view.picture")
                self.assertLessEqual(self.js("document.documentElement.scrollWidth"), width)
                red = int(self.js("getComputedStyle(document.body).backgroundColor").split("(")[1].split(",")[0])
                self.assertEqual(red < 128, dark)
                # A finger turns the picture where the page does not scroll.
                self.assertEqual(self.js("studio.stage.view.canvas.style.touchAction"), "none" if width > 1000 else "pan-y")
                self.screenshot(f"narrow-{width}-{'dark' if dark else 'light'}")

    def test_controls_have_names_for_screen_readers(self):
        self.drop("named.xyz", "".join("%.6g %.6g %.6g\n" % p for p in ball(200)).encode())
        nameless = self.js("""[...document.querySelectorAll("button, select, input")].filter((e) => e.type !== "file" &&
            !(e.labels && e.labels.length) && !e.getAttribute("aria-label") && !e.textContent.trim()).map((e) => e.name)""")
        self.assertEqual(nameless, [])


@unittest.skipUnless(os.environ.get("CSRBF_SCREENSHOTS"), "takes the pictures of docs/studio.md")
class Pictures(Studio):
    """Work as the page on the studio shows it."""

    def test_a_scan(self):
        points = []
        for x, y, z in ball(4000, 1):
            x, y, z = x / 3, y / 3, z / 3
            radius = 1 - 0.45 * math.exp(-4 * ((x - 0.8) ** 2 + y * y + (z - 0.5) ** 2)) + 0.2 * x
            radius += 0.05 * math.sin(7 * x + 2) * math.sin(6 * y) * math.cos(5 * z)
            points.append("%.6g %.6g %.6g\n" % (40 * radius * x, 40 * radius * y, 40 * radius * z))
        self.drop("scan.xyz", "".join(points).encode())
        self.run_command()
        self.choose("color", "1")
        self.screenshot("studio")
        self.choose("color", "plain")
        self.choose("cut", "view")
        self.slide("depth", 62)
        self.screenshot("studio_cut")

    def test_frames(self):
        n, count, source = 128, 20, random.Random(7)

        def frame(t):
            beat = 1 + 0.3 * math.sin(2 * math.pi * t / count)
            head = f"ObjectType = Image\nNDims = 2\nDimSize = {n} {n}\nElementType = MET_SHORT\nElementDataFile = LOCAL\n"
            values = [int((150 if math.hypot((x - 62) / 1.2, y - 60) < 26 * beat * (1 + 0.15 * math.cos(3 * math.atan2(y - 60, x - 62)))
                           else 60) + source.gauss(0, 22)) for y in range(n) for x in range(n)]
            return head.encode() + struct.pack("<%dh" % len(values), *values)

        self.drop_all([("heart_%02d.mha" % t, frame(t)) for t in range(count)])
        self.until("studio.task.command === 'track' && studio.stage.slices.image")
        self.run_command()
        self.until("studio.stage.slices.labels")
        self.slide("frame", 5)
        self.until("studio.stage.slices.state.frame === 5 && studio.stage.slices.labels")
        self.screenshot("studio_track")

    def test_a_table_and_an_image(self):
        subprocess.run([sys.executable, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "scripts",
                                                     "quickstart_data.py"), self.folder.name], check=True)
        for name, shot in (("seabed.csv", "studio_fit"), ("cells.png", "studio_slices")):
            with open(os.path.join(self.folder.name, name), "rb") as file:
                self.drop(name, file.read())
            self.run_command()
            self.screenshot(shot)


def missing():
    """What is not here that the tests need."""
    if missing_browser():
        return missing_browser()
    studio, address = start()
    studio.send_signal(signal.SIGINT)
    said = studio.communicate(timeout=60)[1]
    return None if address else said


if __name__ == "__main__":
    PROGRAM = os.path.abspath(sys.argv.pop(1))
    lacking = missing()
    if lacking:
        print("skipped: no " + lacking)
        sys.exit(SKIPPED)
    unittest.main(verbosity=2)
