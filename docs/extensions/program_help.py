"""The directive `program-help COMMAND`: what `csrbf COMMAND --help` prints, asked of the program while the site is built."""

import os
import subprocess

from docutils import nodes
from docutils.parsers.rst import Directive


class ProgramHelp(Directive):
    optional_arguments = 1

    def run(self):
        command = [os.environ["CSRBF_PROGRAM"], *self.arguments, "--help"]
        text = subprocess.run(command, check=True, capture_output=True, text=True).stdout
        return [nodes.literal_block(text, text, language="none")]


def setup(app):
    app.add_directive("program-help", ProgramHelp)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
