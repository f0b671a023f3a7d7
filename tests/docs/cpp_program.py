"""Writes a program of the C++ blocks of pages: `program PAGE` runs those of one page.

Blocks with a main function stand alone; the others of a page follow each other in one function, as one reads them.

usage: cpp_program.py PROGRAM.cpp PAGE.md ...
"""

import pathlib
import sys

from snippets import snippets


def page_function(page, number):
    """Code, and the name of the function that runs the page; none when it has no C++."""
    blocks = [s for s in snippets(page) if s.language == "cpp" and not s.not_run]
    if not blocks:
        return "", None
    code, calls, body = "", "", ""
    for block in blocks:
        lines = "\n".join("" if line.startswith("#include <csrbf/") else line for line in block.code.splitlines())
        place = f'#line {block.line} "{page.name}"\n'
        if "int main(" in lines:
            name = f"main_{number}_{block.line}"
            ended = lines.rstrip().removesuffix("}") + "  return 0;\n}\n"  # as main does
            code += place + ended.replace("int main(", f"static int {name}(")
            calls += f"  if ({name}() != 0) return 1;\n"
        else:
            body += place + lines + "\n"
    code += f"static int page_{number}() {{\n{calls}{body}  return 0;\n}}\n"
    return code, f"page_{number}"


def main():
    output, *pages = map(pathlib.Path, sys.argv[1:])
    code = "#include <csrbf/csrbf.hpp>\n\n#include <cstdio>\n#include <string>\n\n"
    table = ""
    for number, page in enumerate(pages):
        function, name = page_function(page, number)
        code += function
        if name:
            table += f'    if (page == "{page.name}") return {name}();\n'
    code += (f'#line 1 "main"\nint main(int, char** arguments) {{\n  const std::string page = arguments[1];\n  try {{\n'
             f'{table}    std::fprintf(stderr, "no C++ in %s\\n", page.c_str());\n'
             '  } catch (const std::exception& error) {\n    std::fprintf(stderr, "%s\\n", error.what());\n  }\n'
             "  return 1;\n}\n")
    output.parent.mkdir(parents=True, exist_ok=True)
    if not output.exists() or output.read_text() != code:
        output.write_text(code)
    else:
        output.touch()


if __name__ == "__main__":
    main()
