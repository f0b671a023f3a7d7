"""The directive `python-names NAME ...`: what the module csrbf says of these names, by autodoc; without names of all
that it exports and the page has not named yet."""

import csrbf
from docutils import nodes
from docutils.parsers.rst import Directive
from docutils.statemachine import StringList


def entry(name):
    thing = getattr(csrbf, name)
    if isinstance(thing, type) and issubclass(thing, Exception):
        return f".. autoexception:: csrbf.{name}\n"
    if isinstance(thing, type):
        return f".. autoclass:: csrbf.{name}\n   :members:\n   :special-members: __call__\n"
    return f".. autofunction:: csrbf.{name}\n"


class PythonNames(Directive):
    has_content = False
    optional_arguments = 100

    def run(self):
        environment = self.state.document.settings.env
        named = environment.temp_data.setdefault("python_names", set())
        names = self.arguments or [name for name in csrbf.__all__ if name not in named]
        missing = [name for name in names if name not in csrbf.__all__]
        if missing:
            raise self.error(f"the module csrbf does not export {', '.join(missing)}")
        named.update(names)
        text = "".join(f"```{{eval-rst}}\n{entry(name)}```\n\n" for name in names)
        node = nodes.container()
        self.state.nested_parse(StringList(text.splitlines(), "csrbf"), self.content_offset, node)
        return node.children


def setup(app):
    app.add_directive("python-names", PythonNames)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
