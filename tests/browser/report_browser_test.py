"""Opens reports in headless Chromium: they load without errors, and the view of a surface does what its controls say.

usage: report_browser_test.py PROGRAM [unittest options]

With the variable CSRBF_SCREENSHOTS set to a folder, pictures of the pages go there. Ends with 77 (skipped) when
Chromium, its driver, selenium or three.js (when the program was built) is missing.
"""

import math
import os
import random
import re
import struct
import subprocess
import sys
import tempfile
import unittest

PROGRAM = ""
WIDTH, HEIGHT = 1280, 900

sys.dont_write_bytecode = True  # leave no files in the folder of the sources
from chromium import LOOK, SKIPPED, missing_browser, set_window, start_browser

try:
    from selenium.webdriver.common.action_chains import ActionChains
    from selenium.webdriver.common.by import By
    from selenium.webdriver.common.keys import Keys
    from selenium.webdriver.support.ui import Select, WebDriverWait
except ImportError:
    ActionChains = None

def dented_ball(n):
    """Points on a ball with a dent, whose views all differ."""
    golden = math.pi * (3 - math.sqrt(5))
    for i in range(n):
        z = 1 - (2 * i + 1) / n
        r = math.sqrt(1 - z * z)
        x, y = r * math.cos(golden * i), r * math.sin(golden * i)
        radius = 1 - 0.45 * math.exp(-4 * ((x - 0.8) ** 2 + y * y + (z - 0.5) ** 2)) + 0.2 * x
        yield radius * x, radius * y, radius * z


def run_program(*arguments):
    subprocess.run([PROGRAM, *arguments, "-q"], check=True, timeout=300)


class Browser(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        start_browser(cls, 120)
        cls.write_pages()

    @classmethod
    def path(cls, name):
        return os.path.join(cls.folder.name, name)

    @classmethod
    def write(cls, name, text):
        with open(cls.path(name), "w") as file:
            file.write(text)
        return cls.path(name)

    @classmethod
    def write_pages(cls):
        cloud = cls.write("ball.xyz", "".join("%.9g %.9g %.9g\n" % p for p in dented_ball(1500)))
        run_program("reconstruct", cloud, "-o", cls.path("ball.ply"), "--resolution", "48", "--report",
                    cls.path("ball.html"))
        source = random.Random(1)
        places = [(source.random(), source.random()) for _ in range(300)]
        samples = cls.write("plane.csv", "x,y,height\n" + "".join(
            "%g,%g,%g\n" % (x, y, math.sin(5 * x) * math.cos(4 * y)) for x, y in places))
        run_program("fit", samples, "-o", cls.path("plane.csrbf"), "--report", cls.path("plane.html"))
        n = 24
        voxels = [(x, y, z) for z in range(n) for y in range(n) for x in range(n)]
        values = [100 if math.dist(p, (11, 12, 12)) < 7 else 20 for p in voxels]
        head = f"ObjectType = Image\nNDims = 3\nDimSize = {n} {n} {n}\n"
        head += "ElementType = MET_SHORT\nElementDataFile = LOCAL\n"
        with open(cls.path("volume.mha"), "wb") as file:
            file.write(head.encode() + struct.pack("<%dh" % len(values), *values))
        run_program("segment", cls.path("volume.mha"), "-o", cls.path("labels.mha"), "--report",
                    cls.path("volume.html"))
        values = [100 if math.dist((x, y), (7 + z, 12)) < 5 else 20 for x, y, z in voxels if z < 10]
        with open(cls.path("movie.mha"), "wb") as file:
            file.write(head.replace(f"{n} {n} {n}", f"{n} {n} 10").encode() + struct.pack("<%dh" % len(values), *values))
        run_program("track", cls.path("movie.mha"), "-o", cls.path("frames"), "--slices-are-frames", "--report",
                    cls.path("frames.html"))

    def open(self, name, dark=False, width=WIDTH, fragment=""):
        set_window(self.browser, width, HEIGHT, dark)
        self.browser.get("about:blank")
        self.browser.get_log("browser")
        self.browser.get("file://" + self.path(name) + fragment)
        WebDriverWait(self.browser, 60).until(
            lambda browser: browser.execute_script("return document.readyState") == "complete")

    def tearDown(self):
        self.assertEqual([entry["message"] for entry in self.browser.get_log("browser")], [])
        loaded = self.browser.execute_script("return performance.getEntriesByType('resource').map((e) => e.name)")
        self.assertEqual([name for name in loaded if not name.startswith("data:")], [])

    def look(self):
        return self.browser.execute_script(LOOK)

    def control(self, name):
        return self.browser.find_element(By.NAME, name)

    def choose(self, name, value):
        """In its menu, which is opened for it."""
        control = self.control(name)
        for menu in control.find_elements(By.XPATH, "ancestor::details[not(@open)]/summary"):
            menu.click()
        Select(control).select_by_value(value)

    def slide(self, value):
        self.browser.execute_script(
            "arguments[0].value = arguments[1]; arguments[0].dispatchEvent(new Event('input'))", self.control("depth"),
            value)

    def canvas(self):
        return self.browser.find_element(By.CSS_SELECTOR, "figure.surface canvas")


class Pages(Browser):
    def test_pages_load_fit_their_window_and_show_a_surface(self):
        for name in ("ball.html", "plane.html", "volume.html"):
            for dark in (False, True):
                for width in (WIDTH, 390):
                    with self.subTest(page=name, dark=dark, width=width):
                        self.open(name, dark, width)
                        self.assertLessEqual(
                            self.browser.execute_script("return document.documentElement.scrollWidth"), width)
                        seen = self.look()
                        self.assertGreater(seen["share"], 0.04)
                        self.assertLess(seen["share"], 0.9)
                        self.save_screenshot(name, dark, width)

    def save_screenshot(self, name, dark, width):
        folder = os.environ.get("CSRBF_SCREENSHOTS")
        if not folder:
            return
        os.makedirs(folder, exist_ok=True)
        file = "%s-%s-%d.png" % (name[:-5], "dark" if dark else "light", width)
        self.browser.save_screenshot(os.path.join(folder, file))

    def test_dark_pages_are_dark(self):
        for dark in (False, True):
            self.open("ball.html", dark)
            color = self.browser.execute_script("return getComputedStyle(document.body).backgroundColor")
            red = int(color[color.index("(") + 1:].split(",")[0])
            self.assertEqual(red < 128, dark, color)


class Series(Browser):
    def shown(self):
        figures = self.browser.find_elements(By.CSS_SELECTOR, ".series figure")
        return [f.get_attribute("data-frame") for f in figures if f.is_displayed()]

    def test_frames_are_shown_one_at_a_time(self):
        for width, dark in ((WIDTH, False), (390, True)):
            self.open("frames.html", dark, width)
            self.assertLessEqual(self.browser.execute_script("return document.documentElement.scrollWidth"), width)
            self.assertEqual(self.shown(), ["0"])
            self.browser.execute_script(
                "arguments[0].value = 7; arguments[0].dispatchEvent(new Event('input'))", self.control("frame"))
            self.assertEqual(self.shown(), ["7"])
            Pages.save_screenshot(self, "frames.html", dark, width)
        self.control("play").click()
        WebDriverWait(self.browser, 60).until(lambda browser: self.shown() not in ([], ["7"]))

    def test_plots_tell_their_values_without_a_picture_in_space(self):
        self.open("frames.html")
        plot = self.browser.find_element(By.CSS_SELECTOR, ".plot svg")
        self.browser.execute_script("arguments[0].scrollIntoView({block: 'center'})", plot)
        ActionChains(self.browser).move_to_element(plot).perform()
        self.assertTrue(self.browser.find_element(By.CSS_SELECTOR, ".plot-tip").is_displayed())


class View(Browser):
    def setUp(self):
        self.open("ball.html")
        self.first = self.look()

    def assert_changed(self):
        now = self.look()
        self.assertNotEqual(now["hash"], self.first["hash"])
        return now

    def assert_as_first(self):
        self.assertEqual(self.look()["hash"], self.first["hash"])

    def test_the_first_picture_is_the_same_every_time(self):
        self.open("ball.html")
        self.assert_as_first()

    def test_dragging_turns_the_surface(self):
        ActionChains(self.browser).drag_and_drop_by_offset(self.canvas(), 150, 60).perform()
        turned = self.assert_changed()
        self.assertAlmostEqual(turned["share"], self.first["share"], delta=0.1)

    def test_keys_turn_move_and_zoom(self):
        canvas = self.canvas()
        for keys in (Keys.ARROW_LEFT, Keys.ARROW_UP, "+", "-"):
            canvas.send_keys(keys)
            self.assert_changed()
            canvas.send_keys("0")
            self.assert_as_first()
        ActionChains(self.browser).key_down(Keys.SHIFT).send_keys(Keys.ARROW_RIGHT).key_up(Keys.SHIFT).perform()
        self.assert_changed()

    def test_zooming_in_covers_more(self):
        self.canvas().send_keys("++")
        self.assertGreater(self.assert_changed()["share"], 1.2 * self.first["share"])

    def view(self, expression):
        return self.browser.execute_script("const view = document.querySelector('figure.surface').view; return " +
                                           expression)

    def test_colours_follow_the_choice_and_have_a_scale(self):
        self.assertEqual(self.view("view.legends"), [])
        hashes = {self.first["hash"]}
        for choice in ("0", "1"):
            self.choose("color", choice)
            [legend] = self.view("view.legends")
            self.assertLess(legend["lo"], legend["hi"])
            seen = self.look()
            self.assertAlmostEqual(seen["share"], self.first["share"], delta=1e-6)
            hashes.add(seen["hash"])
        self.assertEqual(len(hashes), 3)
        self.choose("color", "plain")
        self.assert_as_first()

    def test_a_click_shows_the_points(self):
        self.control("points").click()
        self.assert_changed()
        self.control("points").click()
        self.assert_as_first()

    def test_the_cut_takes_away_what_lies_beyond_it(self):
        for axis in ("x", "y", "z", "view"):
            self.choose("cut", axis)
            self.slide(100)
            self.assertAlmostEqual(self.look()["share"], self.first["share"], delta=1e-3)
            self.slide(0)
            self.assertLess(self.look()["share"], 0.02)  # the box
            self.slide(30)
            self.assertLess(self.assert_changed()["share"], self.first["share"])

    def test_what_is_cut_is_closed_by_a_cap_with_the_area_of_the_section(self):
        self.choose("cut", "z")
        self.slide(50)
        self.assertTrue(self.view("view.scene.cap.visible"))
        area = self.view("view.cutArea()")
        radius = 1  # of the ball, with its dent and bump
        self.assertAlmostEqual(area, math.pi * radius ** 2, delta=0.8)
        self.assertEqual(self.view("view.legends.map((l) => l.title)"), ["On the cut: f, zero on the surface"])
        middle = self.view("(() => { const p = view.scene.project([0, 0, 0]); view.clicked(p.x, p.y); return view.readout.textContent; })()")
        # The scale ends before f is constant; what is told is f all the same.
        told = re.search(r"f, zero on the surface (\S+)", middle)
        self.assertGreater(float(told[1]), 1.2 * self.view("view.legends[0].hi"))

    def test_distances_are_measured_in_the_unit_of_the_data(self):
        self.choose("measure", "distance")
        self.view("(() => { view.clicked(...Object.values(view.scene.project([0, 0, 0])).slice(0, 2)); view.lookFrom('x'); "
                  "view.draw(); view.clicked(...Object.values(view.scene.project([0, 0, 0])).slice(0, 2)); })()")
        places = self.view("view.measure.places.map((p) => view.toData(p))")
        self.assertEqual(len(places), 2)
        shown = float(self.view("view.measure.text"))
        self.assertAlmostEqual(shown, math.dist(*places), delta=0.001 * shown)

    def test_the_place_under_the_mouse_is_told(self):
        self.choose("color", "1")
        ActionChains(self.browser).move_to_element(self.canvas()).perform()
        WebDriverWait(self.browser, 60).until(lambda browser: self.view("view.readout.textContent.includes('curvature')"))
        told = self.browser.find_element(By.CSS_SELECTOR, ".readout").text
        self.assertRegex(told, r"^x \S+ .* y \S+ .* z \S+ .* normal \S+, \S+, \S+ .* mean curvature \S+$")
        ActionChains(self.browser).move_to_element_with_offset(self.canvas(), -500, -200).perform()
        WebDriverWait(self.browser, 60).until(lambda browser: self.view("view.readout.hidden"))

    def test_a_ruler_and_an_angle_are_made_of_clicks(self):
        self.browser.execute_script("arguments[0].scrollIntoView({block: 'center'})", self.canvas())
        click = lambda x, y: ActionChains(self.browser).move_to_element_with_offset(self.canvas(), x, y).click().perform()
        self.choose("measure", "distance")
        click(-40, 0)
        self.assertEqual(self.view("view.measure.text"), "")
        click(40, 10)
        p, q = self.view("view.measure.places.map((p) => view.toData(p))")
        self.assertAlmostEqual(float(self.view("view.measure.text")), math.dist(p, q), delta=0.001)
        self.choose("measure", "angle")
        for place in ((-60, 0), (0, 0), (0, 50)):
            click(*place)
        self.assertRegex(self.view("view.measure.text"), r"^\d+\.\d°$")
        self.canvas().send_keys(Keys.ESCAPE)
        self.assertEqual(self.view("view.state.measure"), "none")

    def test_pictures_have_the_size_asked_for(self):
        size = self.browser.execute_async_script(
            "const done = arguments[0]; document.querySelector('figure.surface').view.takePicture(777).then(async (blob) => "
            "{ const image = await createImageBitmap(blob); done([image.width, image.height, blob.type]); })")
        canvas = self.view("view.canvas.clientHeight / view.canvas.clientWidth")
        self.assertEqual((size[0], size[2]), (777, "image/png"))
        self.assertAlmostEqual(size[1], 777 * canvas, delta=1)
        self.assert_as_first()

    def test_a_link_opens_the_same_view(self):
        self.choose("color", "0")
        self.choose("cut", "y")
        self.slide(60)
        ActionChains(self.browser).drag_and_drop_by_offset(self.canvas(), 70, 40).perform()
        there, link = self.look()["hash"], self.view("view.link()")
        self.open("ball.html", fragment="#" + link.split("#")[1])
        self.assertAlmostEqual(self.view("view.state.depth"), 0.6)
        self.assertEqual(self.view("view.state.color"), "0")
        self.assertLess(abs(self.look()["share"] - self.first["share"]), 0.5)
        self.assertEqual(self.view("view.link()"), link)
        self.assertIsNotNone(there)

    def test_one_finger_scrolls_the_page_until_the_picture_is_tapped(self):
        touch = lambda: self.browser.execute_script("return arguments[0].style.touchAction", self.canvas())
        self.assertEqual(touch(), "pan-y")
        self.browser.execute_script("""
            const canvas = arguments[0], box = canvas.getBoundingClientRect();
            const at = {clientX: box.left + 20, clientY: box.top + 20, pointerId: 1, pointerType: "touch", bubbles: true};
            canvas.setPointerCapture = () => {};
            canvas.dispatchEvent(new PointerEvent("pointerdown", at));
            canvas.dispatchEvent(new PointerEvent("pointerup", at));""", self.canvas())
        self.assertEqual(touch(), "none")
        self.browser.execute_script("document.body.dispatchEvent(new PointerEvent('pointerdown', {bubbles: true}))")
        self.assertEqual(touch(), "pan-y")

    def test_plots_tell_their_values(self):
        plot = self.browser.find_element(By.CSS_SELECTOR, ".plot svg")
        self.browser.execute_script("arguments[0].scrollIntoView({block: 'center'})", plot)
        ActionChains(self.browser).move_to_element(plot).perform()
        tip = self.browser.find_element(By.CSS_SELECTOR, ".plot-tip")
        self.assertTrue(tip.is_displayed())
        self.assertRegex(tip.text, r"to .*: [\d,]+ points")

    def test_reset_takes_everything_back(self):
        self.choose("cut", "x")
        self.control("points").click()
        self.choose("color", "1")
        ActionChains(self.browser).drag_and_drop_by_offset(self.canvas(), -80, 30).perform()
        self.assert_changed()
        self.control("reset").click()
        self.assert_as_first()

    def test_any_axis_can_point_upwards(self):
        hashes = set()
        for axis in "xyz":
            self.choose("up", axis)
            hashes.add(self.look()["hash"])
        self.assertEqual(len(hashes), 3)
        self.choose("up", "y")
        upright = self.look()["hash"]
        self.open("ball.html", fragment="#up=y")
        self.assertEqual(self.look()["hash"], upright)


def missing():
    """What is not here that the tests need."""
    if missing_browser():
        return missing_browser()
    with tempfile.TemporaryDirectory() as folder:
        cloud, page = os.path.join(folder, "ball.xyz"), os.path.join(folder, "ball.html")
        with open(cloud, "w") as file:
            file.writelines("%g %g %g\n" % p for p in dented_ball(100))
        run_program("reconstruct", cloud, "-o", os.path.join(folder, "ball.ply"), "--resolution", "12", "--report",
                    page)
        with open(page, encoding="utf-8") as file:
            if "surface-data" not in file.read():
                return "three.js and esbuild when csrbf was built (libjs-three, esbuild)"
    return None


if __name__ == "__main__":
    PROGRAM = os.path.abspath(sys.argv.pop(1))
    lacking = missing()
    if lacking:
        print("skipped: no " + lacking)
        sys.exit(SKIPPED)
    unittest.main(verbosity=2)
