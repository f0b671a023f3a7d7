"""Every public name has a docstring in the style of numpy with an example that runs."""

import doctest
import inspect
import os
import tempfile
import unittest

import numpy as np

import csrbf


def public():
    """(name, thing) for all that users see."""
    things = [(name, getattr(csrbf, name)) for name in csrbf.__all__]
    try:
        from csrbf.sklearn import CSRBFRegressor

        things.append(("sklearn.CSRBFRegressor", CSRBFRegressor))
    except ImportError:
        pass
    for name, thing in things:
        yield name, thing
        if not inspect.isclass(thing) or issubclass(thing, Exception):
            continue
        for member, value in vars(thing).items():
            if not member.startswith("_") or member == "__call__":
                if callable(value) or isinstance(value, property):
                    yield f"{name}.{member}", value


class Docstrings(unittest.TestCase):
    def test_there_is_one_with_an_example_for_every_name(self):
        self.assertGreater(len(list(public())), 60)
        for name, thing in public():
            with self.subTest(name):
                text = inspect.getdoc(thing) or ""
                self.assertIn("Examples\n--------\n>>> ", text)

    def test_parameters_and_results_are_described(self):
        for name, thing in public():
            if isinstance(thing, property) or (inspect.isclass(thing) and issubclass(thing, Exception)):
                continue
            text = inspect.getdoc(thing)
            with self.subTest(name):
                if inspect.isclass(thing):
                    self.assertRegex(text, "(Parameters|Attributes)\n----------")
                    continue
                try:
                    signature = inspect.signature(thing)
                except ValueError:  # of the compiled module
                    continue
                for parameter in signature.parameters:
                    if parameter == "self" or name == "Mesh.render":  # which refers to Surface.render
                        continue
                    named = rf"(?m)^([\w*]+, )*\*{{0,2}}{parameter}(, [\w*]+)*( : |$)|``{parameter}``"
                    self.assertRegex(text, named, name)
                if signature.return_annotation not in ("None", None, inspect.Signature.empty, "Any"):
                    self.assertTrue("Returns\n-------\n" in text, name)

    def test_lines_fit(self):
        for name, thing in public():
            for line in (thing.__doc__ or "").splitlines():
                self.assertLessEqual(len(line), 120, name)

    def test_examples_run(self):
        runner = doctest.DocTestRunner(optionflags=doctest.NORMALIZE_WHITESPACE)
        finder = doctest.DocTestFinder(recurse=False)
        here = os.getcwd()
        with tempfile.TemporaryDirectory() as folder:
            os.chdir(folder)
            try:
                examples = 0
                for name, thing in public():
                    documented = thing.fget if isinstance(thing, property) else thing
                    for test in finder.find(documented, name, globs={"csrbf": csrbf, "np": np}):
                        examples += len(test.examples)
                        runner.run(test)
            finally:
                os.chdir(here)
        self.assertEqual(runner.failures, 0)
        self.assertGreater(examples, 150)


if __name__ == "__main__":
    unittest.main()
