"""csrbf.thesis: the list of figures, the errata, and the page that the command writes."""

import html.parser
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

from csrbf import thesis
from csrbf.thesis.coverage import CHAPTERS, chapter_of, published_in
from csrbf.thesis.errata import ERRATA, errata_of

try:
    import matplotlib
except ImportError:
    matplotlib = None

ENTRIES = [entry for _, entries in CHAPTERS for entry in entries]
# How many figures each chapter of the thesis has, and how many tables.
FIGURES = {1: 2, 2: 4, 3: 18, 4: 1, 5: 3, 6: 25, 7: 3, 8: 11}
TABLES = {2: 4, 8: 2}
VOID = {"meta", "img", "br"}


def run(*arguments):
    """The command, in a process of its own: what it returned and printed."""
    environment = {**os.environ, "MPLCONFIGDIR": tempfile.gettempdir()}
    return subprocess.run(
        [sys.executable, "-m", "csrbf.thesis", *map(str, arguments)], capture_output=True, text=True, env=environment
    )


class Page(html.parser.HTMLParser):
    """Elements, identifiers and addresses of a page; `open` is not empty when a tag is not closed."""

    def __init__(self, text):
        super().__init__()
        self.open, self.wrong, self.ids, self.links, self.sources, self.tags = [], [], [], [], [], []
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        values = dict(attributes)
        self.tags.append(tag)
        self.ids += [values["id"]] if "id" in values else []
        self.links += [values["href"]] if "href" in values else []
        self.sources += [values["src"]] if "src" in values else []
        if tag not in VOID:
            self.open.append(tag)

    def handle_endtag(self, tag):
        if not self.open or self.open.pop() != tag:
            self.wrong.append(tag)


class Coverage(unittest.TestCase):
    def test_every_figure_and_table_of_the_thesis_is_listed_once(self):
        numbers = [entry.number for entry in ENTRIES]
        self.assertEqual(len(numbers), len(set(numbers)))
        expected = [f"Fig. {i}" for i in (1, 2, 3)]
        expected += [f"Fig. {chapter}.{i + 1}" for chapter, count in FIGURES.items() for i in range(count)]
        expected += [f"Table {chapter}.{i + 1}" for chapter, count in TABLES.items() for i in range(count)]
        listed = [number for number in numbers if re.fullmatch(r"(Fig\.|Table) [\d.]+", number)]
        self.assertEqual(sorted(listed), sorted(expected))

    def test_what_is_listed_is_what_can_be_computed(self):
        self.assertEqual({entry.figure for entry in ENTRIES if entry.figure}, set(thesis.names()))
        for name in thesis.names():
            self.assertIn(chapter_of(name), [title for title, _ in CHAPTERS])
            self.assertTrue(published_in(name))

    def test_what_is_not_covered_has_a_reason(self):
        for entry in ENTRIES:
            self.assertNotEqual(bool(entry.figure), bool(entry.reason), entry.number)

    def test_a_figure_stands_in_the_chapter_of_its_number(self):
        self.assertTrue(chapter_of("figure-6.1").startswith("Chapter 6"))
        self.assertTrue(chapter_of("figure-1.1").startswith("Chapter 1"))  # which covers Fig. 6.2 as well
        self.assertTrue(chapter_of("chapter-5").startswith("Chapter 5"))


class Errata(unittest.TestCase):
    def test_there_are_56_and_each_says_what_is_wrong_and_right(self):
        self.assertEqual(len(ERRATA), 56)
        for erratum in ERRATA:
            self.assertTrue(erratum.where and erratum.printed and erratum.correct, erratum)
            self.assertNotEqual(erratum.printed, erratum.correct)

    def test_they_name_figures_that_exist(self):
        for erratum in ERRATA:
            self.assertLessEqual(set(erratum.figures), set(thesis.names()), erratum.where)
        self.assertEqual([number for number, _ in errata_of("figure-6.3")], [38, 39, 40])


class Compute(unittest.TestCase):
    def test_a_figure_has_text_numbers_and_claims(self):
        figure = thesis.compute("figure-6.3")
        self.assertEqual(figure.name, "figure-6.3")
        self.assertTrue(figure.title and figure.text)
        self.assertEqual(len(figure.claims), 5)
        # The two that the errata name, 38 and 39, fail; the last one is not in the thesis.
        self.assertEqual([c.verdict for c in figure.claims], ["holds", "holds", "fails", "fails", "not comparable"])
        decay = figure.tables["decay"]
        self.assertEqual(decay.rows.shape, (121, 6))
        self.assertEqual(decay["d"][0], 0)
        self.assertEqual(list(decay.rows[0, 1:]), [1] * 5)

    def test_pictures_are_arrays_with_a_row_for_each_line(self):
        figure = thesis.compute("figure-4.1")
        self.assertEqual(figure.pictures["plane y = 0"].shape, (161, 161))
        self.assertGreater(figure.pictures["plane y = 0"][100, 80], 0)  # z = -3 mm on the axis of the heart: inside
        self.assertLess(figure.pictures["plane y = 0"][0, 80], 0)
        caption, image = figure.renders[1]
        self.assertIn("surface", caption)
        self.assertEqual(image.shape, (340, 340, 3))

    def test_other_names_are_refused_with_the_list(self):
        with self.assertRaisesRegex(ValueError, "figure-9.9: there is none of this name; there are introd.*8.1"):
            thesis.compute("figure-9.9")


class Command(unittest.TestCase):
    def test_lists_the_figures(self):
        done = run("--list")
        self.assertEqual(done.returncode, 0)
        self.assertEqual([line.split()[0] for line in done.stdout.splitlines()], thesis.names())
        self.assertIn("Fig. 2.4", done.stdout)

    def test_unknown_figures_are_refused_with_the_list(self):
        done = run("--out", "nowhere", "figure-9.9")
        self.assertEqual(done.returncode, 2)
        self.assertIn("figure figure-9.9: there is none of this name; there are introduction", done.stderr)
        self.assertFalse(pathlib.Path("nowhere").exists())

    def test_the_folder_and_existing_images_are_asked_for(self):
        self.assertIn("--out DIR: say where to write", run("figure-1.2").stderr)
        done = run("--out", "nowhere", "--bone", "no_such.nii")
        self.assertEqual(done.returncode, 2)
        self.assertIn("no_such.nii: there is no such file", done.stderr)


@unittest.skipIf(matplotlib is None, "matplotlib is not installed")
class Gallery(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.done = run("--out", cls.folder.name, "figure-6.3", "figure-1.2", "figure-4.1")
        cls.path = pathlib.Path(cls.folder.name)
        cls.text = (cls.path / "index.html").read_text() if (cls.path / "index.html").exists() else ""
        cls.page = Page(cls.text)

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def test_says_what_it_does(self):
        self.assertEqual(self.done.returncode, 0, self.done.stderr)
        lines = self.done.stdout.splitlines()
        self.assertRegex(lines[0], r"\[1/3\] figure-1.2 .* s: 1 holds, 0 fail, 0 not comparable")
        self.assertRegex(lines[-1], r"index.html: 4 hold, 2 fail, 1 not comparable, \d+ s")

    def test_writes_pictures_and_nothing_half_written(self):
        names = sorted(path.name for path in self.path.iterdir())
        self.assertEqual(
            names,
            [
                "figure-1.2.png",
                "figure-4.1-render-1.png",
                "figure-4.1-render-2.png",
                "figure-4.1.png",
                "figure-6.3.png",
                "index.html",
            ],
        )

    def test_the_page_is_well_formed(self):
        self.assertEqual(self.page.wrong, [])
        self.assertEqual(self.page.open, [])
        self.assertEqual(len(self.page.ids), len(set(self.page.ids)))
        for link in self.page.links:
            self.assertTrue(link.startswith("#") and link[1:] in self.page.ids, link)

    def test_the_page_loads_nothing(self):
        self.assertEqual(len(self.page.sources), 5)
        for source in self.page.sources:
            self.assertTrue(source.startswith("data:image/png;base64,"))
        self.assertNotIn("script", self.page.tags)
        self.assertNotIn("link", self.page.tags)
        rest = re.sub('base64,[^"]*', "", self.text)
        self.assertEqual(re.findall(r"https?:|url\(|@import", rest), [])

    def test_the_page_has_figures_claims_errata_and_coverage(self):
        for name in ("figure-1.2", "figure-4.1", "figure-6.3", "coverage", "errata", "erratum-56"):
            self.assertIn(name, self.page.ids)
        for words in (
            "figure-8.2 (not in this run)",
            "not covered: photograph",
            "<b>4</b>claims hold",
            "C¹: the second derivative jumps by 8",
        ):
            self.assertTrue(words in self.text, words)


if __name__ == "__main__":
    unittest.main()
