"""The directive `cpp-header PATH`: what a header of the library declares, in its order, with its comments.

Doxygen has read the headers into XML before; here the declarations become those of Sphinx's domain for C++, which
links the types in them and puts the names into the index.
"""

import os
import pathlib
import re
import xml.etree.ElementTree as ElementTree
from functools import lru_cache

from docutils import nodes
from docutils.parsers.rst import Directive
from docutils.statemachine import StringList

ENUM = {"yes": "cpp:enum-class", "no": "cpp:enum"}
FIRST_FENCE = 6  # backticks around a struct; what is inside has fewer


def xml_folder():
    return pathlib.Path(os.environ["CSRBF_DOXYGEN"])


@lru_cache(maxsize=None)
def compound(name):
    return ElementTree.parse(xml_folder() / f"{name}.xml").getroot().find("compounddef")


@lru_cache(maxsize=None)
def declarations():
    """All that the namespace csrbf declares: {file: [(line, element)]}."""
    found = {}
    namespace = compound("namespacecsrbf")
    elements = list(namespace.iter("memberdef"))
    elements += [compound(inner.get("refid")) for inner in namespace.iter("innerclass")]
    for element in elements:
        place = element.find("location")
        name = element.findtext("compoundname") or ""
        if name.count("::") > 1:
            continue  # belongs to the class around it
        file = place.get("declfile") or place.get("file")
        line = int(place.get("declline") or place.get("line"))
        found.setdefault(re.sub(r"^.*?csrbf/", "csrbf/", file), []).append((line, element))
    return found


def plain(element):
    return re.sub(r"\s+", " ", "".join(element.itertext())).strip() if element is not None else ""


def tight(code):
    """C++ without the blanks that doxygen puts into it."""
    return re.sub(r"\s+>", ">", re.sub(r"<\s+", "<", code))


def markdown(element):
    """A comment, as doxygen understood it."""
    text = element.text or ""
    if element.tag not in ("computeroutput", "verbatim"):
        text = escaped(text)
    for child in element:
        text += markdown(child) + escaped(child.tail or "")
    if element.tag == "computeroutput":
        return f"`{text}`" if text else ""
    if element.tag == "bold":
        return f"**{text.strip()}**"
    if element.tag == "listitem":
        return "\n- " + re.sub(r"\s+", " ", text).strip()
    if element.tag in ("itemizedlist", "orderedlist"):
        return "\n" + text.strip("\n") + "\n\n"
    if element.tag == "para":
        return text.strip(" ") + "\n\n"
    return text


def escaped(text):
    return re.sub(r"([\\*_<\[|`])", r"\\\1", text)


def comment(element):
    parts = [markdown(element.find(tag)) for tag in ("briefdescription", "detaileddescription")]
    return re.sub(r"\n{3,}", "\n\n", "\n\n".join(part.strip() for part in parts if part.strip()))


def template(element):
    parameters = element.find("templateparamlist")
    if parameters is None:
        return ""
    names = []
    for parameter in parameters.iter("param"):
        kind, name = plain(parameter.find("type")), plain(parameter.find("declname"))
        default = plain(parameter.find("defval"))
        names.append(f"{kind} {name}".strip() + (f" = {default}" if default else ""))
    return f"template <{', '.join(names)}> "


def fenced(directive, signature, body, depth):
    fence = "`" * (FIRST_FENCE - depth)
    return f"{fence}{{{directive}}} {signature}\n\n{body}\n{fence}\n\n"


def function(member, depth):
    specifiers = " ".join(word for word in ("static", "explicit") if member.get(word) == "yes")
    kind = re.sub(r"\[\[nodiscard\]\]|\bvirtual\b|\bstatic\b|\bconstexpr\b|\bfriend\b|\binline\b", "",
                  plain(member.find("type")))
    end = re.sub(r"\s*(=\s*(0|default)|override)$", "", member.findtext("argsstring"))
    signature = f"{template(member)}{specifiers} {kind} {member.findtext('name')}{end}"
    return fenced("cpp:function", tight(re.sub(r"\s+", " ", signature).strip()), comment(member), depth)


def variable(member, depth):
    value = plain(member.find("initializer")).removeprefix("=").strip()
    value = f" = {value}" if value and len(value) < 40 else ""
    kind = plain(member.find("type"))
    signature = f"{template(member)}{kind} {member.findtext('name')}{member.findtext('argsstring') or ''}{value}"
    return fenced("cpp:member", tight(signature), comment(member), depth)


def enumeration(member, depth):
    values = "".join(fenced("cpp:enumerator", value.findtext("name"), comment(value), depth + 1)
                     for value in member.iter("enumvalue"))
    return fenced(ENUM[member.get("strong", "no")], member.findtext("name"), comment(member) + "\n\n" + values, depth)


def alias(member, depth):
    kind = plain(member.find("type"))
    return fenced("cpp:type", tight(f"{template(member)}{member.findtext('name')} = {kind}"), comment(member), depth)


def structure(element, depth):
    members = []
    for section in element.findall("sectiondef"):
        if section.get("kind").startswith(("public", "user")):
            members += [(int(m.find("location").get("line")), m) for m in section.findall("memberdef")]
    for inner in element.findall("innerclass"):
        if inner.get("prot") == "public" and (xml_folder() / f"{inner.get('refid')}.xml").exists():
            members.append((int(compound(inner.get("refid")).find("location").get("line")),
                            compound(inner.get("refid"))))
    members.sort(key=lambda pair: pair[0])
    body = comment(element) + "\n\n" + "".join(declaration(m, depth + 1) for _, m in members)
    name = element.findtext("compoundname").split("::")[-1]
    bases = [f"public {base.text.removeprefix('csrbf::')}" for base in element.findall("basecompoundref")]
    signature = template(element) + name + (" : " + ", ".join(bases) if bases else "")
    return fenced("cpp:" + element.get("kind"), tight(signature), body, depth)


def declaration(element, depth=0):
    if element.tag == "compounddef":
        return structure(element, depth)
    kind, name = element.get("kind"), element.findtext("name")
    if "CSRBF_" in plain(element.find("type")) or (kind == "function" and is_of_every_class(element, name)):
        return ""
    make = {"function": function, "variable": variable, "enum": enumeration, "typedef": alias}.get(kind)
    return make(element, depth) if make else ""


def is_of_every_class(member, name):
    """Copies, destructors and the like, which need no page."""
    end = member.findtext("argsstring") or ""
    return name.startswith("~") or name == "operator=" or (end.endswith(("=default", "= default", "=delete")))


class CppHeader(Directive):
    required_arguments = 1

    def in_order(self, path):
        """The function that the header is named after, then all else as in the header."""
        front = path.split("/")[-1].removesuffix(".hpp")
        return sorted(declarations()[path], key=lambda pair: (pair[1].findtext("name") != front, pair[0]))

    def run(self):
        path = f"csrbf/{self.arguments[0]}.hpp"
        if path not in declarations():
            raise self.error(f"{path} declares nothing that doxygen knows of")
        text = f"`#include <{path}>`\n\n```{{cpp:namespace}} csrbf\n```\n\n"
        text += "".join(declaration(element) for _, element in self.in_order(path))
        node = nodes.container()
        self.state.nested_parse(StringList(text.splitlines(), path), self.content_offset, node)
        return node.children


def setup(app):
    app.add_directive("cpp-header", CppHeader)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
