"""Puts those functions of a WebAssembly module side by side that differ in numbers alone, as a template for one, two and
three variables does: gzip looks back 32 kB, and finds them alike only there. Names, the order, are left out afterwards.

usage: order_functions.py MODULE.wasm     in place; linked with --profiling-funcs
"""

import pathlib
import re
import sys

CUSTOM, IMPORT, FUNCTION, EXPORT, START, ELEMENT, CODE = 0, 2, 3, 7, 8, 9, 10
CALL, REF_FUNC = 0x10, 0xD2
# How many numbers follow an instruction; others are followed by none, or by what read_instruction() skips.
NUMBERS = {0x02: 1, 0x03: 1, 0x04: 1, 0x06: 1, 0x07: 1, 0x08: 1, 0x09: 1, 0x0C: 1, 0x0D: 1, CALL: 1, 0x11: 2, 0x18: 1,
           **dict.fromkeys(range(0x20, 0x27), 1), **dict.fromkeys(range(0x28, 0x3F), 2), 0x3F: 1, 0x40: 1, 0x41: 1,
           0x42: 1, 0xD0: 1, REF_FUNC: 1}
BULK_NUMBERS = {8: 2, 9: 1, 10: 2, 11: 1, 12: 2, 13: 1, 14: 2, 15: 1, 16: 1, 17: 1}


class Reader:
    def __init__(self, data):
        self.data, self.at = data, 0

    def number(self):
        result = shift = 0
        while True:
            byte = self.data[self.at]
            self.at += 1
            result |= (byte & 127) << shift
            shift += 7
            if byte < 128:
                return result

    def take(self, count):
        self.at += count
        return self.data[self.at - count : self.at]

    def skip(self, numbers):
        for _ in range(numbers):
            while self.data[self.at] >= 128:
                self.at += 1
            self.at += 1


def number(value):
    result = bytearray()
    while value >= 128:
        result.append(value & 127 | 128)
        value >>= 7
    result.append(value)
    return bytes(result)


def sized(data):
    return number(len(data)) + data


def skip_operands(reader, code):
    """Skips what follows an instruction."""
    if code == 0x0E:  # br_table
        reader.skip(reader.number() + 1)
    elif code == 0x1C:  # select with types
        reader.skip(reader.number())
    elif code == 0x43:
        reader.at += 4
    elif code == 0x44:
        reader.at += 8
    elif code == 0xFC:
        reader.skip(BULK_NUMBERS.get(reader.number(), 0))
    elif code == 0xFD:
        vector = reader.number()
        if vector in (12, 13):  # a constant, a shuffle
            reader.at += 16
        elif vector <= 11 or 92 <= vector <= 93:  # memory
            reader.skip(2)
        elif 84 <= vector <= 91:  # memory and a lane
            reader.skip(2)
            reader.at += 1
        elif 21 <= vector <= 34:
            reader.at += 1
    else:
        reader.skip(NUMBERS.get(code, 0))


def calls_of(body):
    """Where a function names others: begin, end and index."""
    reader = Reader(body)
    for _ in range(reader.number()):
        reader.skip(2)  # locals
    found = []
    while reader.at < len(body):
        code = body[reader.at]
        reader.at += 1
        if code in (CALL, REF_FUNC):
            begin = reader.at
            index = reader.number()
            found.append((begin, reader.at, index))
        else:
            skip_operands(reader, code)
    return found


def sections_of(data):
    reader = Reader(data)
    reader.at = 8
    found = []
    while reader.at < len(data):
        kind = reader.take(1)[0]
        found.append((kind, reader.take(reader.number())))
    return found


def imported_functions(section):
    reader = Reader(section)
    count = 0
    for _ in range(reader.number()):
        for _ in range(2):
            reader.take(reader.number())
        kind = reader.take(1)[0]
        count += kind == 0
        if kind == 0:
            reader.skip(1)
        elif kind == 3:
            reader.at += 2
        elif kind == 4:
            reader.skip(2)
        else:  # a table or a memory, with limits
            reader.at += kind == 1
            reader.skip(1 + reader.take(1)[0] % 2)
    return count


def names_of(section):
    """Names by index, from the section `name`."""
    reader = Reader(section)
    names = {}
    while reader.at < len(section):
        kind = reader.take(1)[0]
        part = Reader(reader.take(reader.number()))
        if kind == 1:
            for _ in range(part.number()):
                index = part.number()
                names[index] = part.take(part.number()).decode()
    return names


def with_indices(section, kind, renamed):
    """A section of exports or elements, with other indices of functions."""
    reader = Reader(section)
    count = reader.number()
    result = bytearray(number(count))
    for _ in range(count):
        if kind == EXPORT:
            result += sized(reader.take(reader.number()))
            what = reader.take(1)
            index = reader.number()
            result += what + number(renamed[index] if what == b"\0" else index)
        else:
            begin = reader.at
            if reader.number() != 0:
                raise ValueError("elements of another kind than those of table 0")
            while reader.take(1)[0] != 0x0B:  # the offset: one constant
                reader.skip(1)
            functions = reader.number()
            result += section[begin : reader.at] + b"".join(number(renamed[reader.number()]) for _ in range(functions))
    return bytes(result)


def ordered(data):
    """The module with its functions ordered by name without digits."""
    sections = sections_of(data)
    by_kind = {kind: section for kind, section in sections if kind != CUSTOM}
    names = {}
    for kind, section in sections:
        if kind == CUSTOM and section.startswith(b"\4name"):
            names = names_of(section[5:])
    imports = imported_functions(by_kind[IMPORT])
    reader, types = Reader(by_kind[CODE]), Reader(by_kind[FUNCTION])
    types.number()
    functions = [(reader.take(reader.number()), types.number()) for _ in range(reader.number())]
    calls = [calls_of(body) for body, _ in functions]

    def key(i):
        name = names.get(imports + i, "")
        return re.sub(r"\d", "", name), name

    order = sorted(range(len(functions)), key=key)
    renamed = list(range(imports)) + [0] * len(order)
    for to, i in enumerate(order):
        renamed[imports + i] = imports + to

    def body(i):
        result, at = bytearray(), 0
        for begin, end, index in calls[i]:
            result += functions[i][0][at:begin] + number(renamed[index])
            at = end
        return sized(bytes(result + functions[i][0][at:]))

    result = bytearray(data[:8])
    for kind, section in sections:
        if kind == CUSTOM and section.startswith(b"\4name"):
            continue
        if kind == FUNCTION:
            section = number(len(order)) + b"".join(number(functions[i][1]) for i in order)
        elif kind == CODE:
            section = number(len(order)) + b"".join(body(i) for i in order)
        elif kind in (EXPORT, ELEMENT):
            section = with_indices(section, kind, renamed)
        elif kind == START:
            section = number(renamed[Reader(section).number()])
        result += bytes([kind]) + sized(section)
    return bytes(result)


if __name__ == "__main__":
    module = pathlib.Path(sys.argv[1])
    module.write_bytes(ordered(module.read_bytes()))
