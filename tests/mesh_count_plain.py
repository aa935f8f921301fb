"""Readers of OBJ, OFF, STL and PLY for mesh_count.py.

Each takes a path and its bytes and yields (positions, counts, corners) of each mesh: rows of three, the number of corners of each face,
and the vertices of all faces one after the other. What is not sound raises ValueError, LookupError or struct.error.
"""

import re
import struct

import numpy as np


def number(word):
    if b"_" in word:
        raise ValueError(f"{word!r} is not a number")
    return float(word)


def whole(word):
    value = number(word)
    if value != int(value):
        raise ValueError(f"{word!r} is not a whole number")
    return int(value)


def lines_of(data):
    """(words) of each line that has some; a word that begins with # opens a comment."""
    for line in re.split(rb"\r\n|\n|\r", data):
        if words := re.split(rb"(?:^|(?<=[ \t\v\f]))#", line, maxsplit=1)[0].split():
            yield words


# --- OBJ -------------------------------------------------------------------------------------------------------------------


def read_obj(_, data):
    if data.startswith((b"\xff\xfe", b"\xfe\xff")):
        data = data.decode("utf-16").encode()
    positions, counts, corners, seen = [], [], [], []
    for words in lines_of(re.sub(rb"\\[ \t]*(\r\n|\n|\r)", b" ", data)):
        if words[0] == b"v":
            if len(words) < 4:
                raise ValueError(f"a vertex has {len(words) - 1} coordinates")
            positions.append([number(word) for word in words[1:4]])
        elif words[0] in (b"f", b"fo", b"l", b"p"):
            indices = [int(word.split(b"/")[0]) for word in words[1:]]
            counts.append(len(indices) if words[0][:1] == b"f" else 1)
            corners += [index - 1 if index > 0 else len(positions) + index for index in indices][:counts[-1]]
            seen += [index != 0 and -index <= len(positions) for index in indices]
    if not all(seen):
        raise ValueError("a face names a vertex that is not there")
    yield np.array(positions, "f8").reshape(-1, 3), counts, corners


# --- OFF -------------------------------------------------------------------------------------------------------------------

OFF_HEAD = re.compile(rb"((?:ST|C|N|4|n)*)OFF(.*)", re.DOTALL)


def read_off(_, data):
    kind = b""
    lines = list(lines_of(data))
    head = OFF_HEAD.fullmatch(lines[0][0]) if lines else None
    if head:
        kind = head[1]
        lines[0] = ([head[2]] if head[2] else []) + lines[0][1:]
        if lines[0][:1] == [b"BINARY"]:
            yield read_binary_off(kind, data)
            return
        lines = lines if lines[0] else lines[1:]
    size = whole(lines.pop(0)[0]) if b"n" in kind else 3
    size += b"4" in kind
    head = lines.pop(0)
    while len(head) < 2:
        head += lines.pop(0)
    if len(head) == 2 and lines and len(lines[0]) == 1:
        lines.pop(0)  # the number of edges
    if len(head) > 3:
        lines.insert(0, head[3:])
    vertex_count, face_count = whole(head[0]), whole(head[1])
    if vertex_count + face_count > len(data):
        raise ValueError("it is shorter than its head says")
    try:
        yield read_off_lines(lines, kind, size, vertex_count, face_count)
    except (ValueError, IndexError):
        yield read_off_words(lines, kind, size, vertex_count, face_count)


def flat(positions, kind):
    """Three coordinates of each vertex: a fourth one of 4OFF divides, of more dimensions the first three count."""
    positions = np.array(positions, "f8").reshape(len(positions), -1)
    if b"4" in kind:
        with np.errstate(all="ignore"):
            positions = positions[:, :-1] / positions[:, -1:]
    return np.pad(positions[:, :3], ((0, 0), (0, max(0, 3 - positions.shape[1]))))


def read_off_lines(lines, kind, size, vertex_count, face_count):
    """A line for each vertex and face; what follows is colors and the like."""
    positions = [[number(word) for word in (*words[:size], *[b"x"] * (size - len(words)))] for words in lines[:vertex_count]]
    counts, corners = [], []
    for place in range(face_count):
        words = lines[vertex_count + place]
        counts.append(whole(words[0]))
        corners += [whole(word) for word in words[1:counts[-1] + 1]]
        if len(words) <= counts[-1]:
            raise ValueError("a face has fewer corners than it says")
    return flat(positions, kind), counts, corners


def read_off_words(lines, kind, size, vertex_count, face_count):
    """Words that run on over lines; the colors of a face end with its line."""
    words = [(word, place) for place, line in enumerate(lines) for word in line]
    step = size + 3 * (b"N" in kind) + 4 * (b"C" in kind) + 2 * (b"ST" in kind)
    positions = [[number(word) for word, _ in words[at:at + size]] for at in range(0, step * vertex_count, step)]
    at = step * vertex_count
    counts, corners = [], []
    for _ in range(face_count):
        counts.append(whole(words[at][0]))
        corners += [whole(words[at + k][0]) for k in range(1, counts[-1] + 1)]
        at += counts[-1] + 1
        while at < len(words) and words[at][1] == words[at - 1][1]:
            at += 1
    return flat(positions, kind), counts, corners


def read_binary_off(kind, data):
    at = re.search(rb"BINARY[^\n]*\n", data).end()

    def take(type_name, count):
        nonlocal at
        values = np.frombuffer(data, type_name, count, at)
        at += 4 * count
        return values

    size = int(take(">i4", 1)[0]) if b"n" in kind else 3
    size += b"4" in kind
    vertex_count, face_count, _ = (int(value) for value in take(">i4", 3))
    step = size + 3 * (b"N" in kind) + 4 * (b"C" in kind) + 2 * (b"ST" in kind)
    positions = take(">f4", vertex_count * step).reshape(vertex_count, step)[:, :size]
    counts, corners = [], []
    for _ in range(face_count):
        counts.append(int(take(">i4", 1)[0]))
        corners += take(">i4", counts[-1]).tolist()
        take(">f4", int(take(">i4", 1)[0]))
    return flat(positions, kind), counts, corners


# --- STL -------------------------------------------------------------------------------------------------------------------


def read_stl(_, data):
    count = struct.unpack_from("<I", data, 80)[0] if len(data) >= 84 else 0
    if len(data) >= 84 and (len(data) == 84 + 50 * count or not data.lstrip().lower().startswith(b"solid")):
        if len(data) < 84 + 50 * count:
            raise ValueError("it is shorter than its head says")
        facets = np.frombuffer(data, np.dtype([("normal", "<f4", 3), ("corners", "<f4", 9), ("attribute", "<u2")]), count, 84)
        yield facets["corners"].reshape(-1, 3), [3] * count, range(3 * count)
        return
    positions, has_ended, in_facet = [], False, 0
    for words in (line.split() for line in re.split(rb"\r\n|\n|\r", data)):
        key = words[0].lower() if words else b""
        if key == b"facet":
            if len(words) != 5:
                raise ValueError("a facet has no normal")
            in_facet = len(positions)
        elif key == b"vertex":
            positions.append([number(word) for word in (*words[1:4], *[b"x"] * (4 - len(words)))])
        elif key == b"endfacet" and len(positions) != in_facet + 3:
            raise ValueError(f"a facet has {len(positions) - in_facet} vertices")
        has_ended = has_ended or key == b"endsolid"
    if not has_ended or len(positions) % 3:
        raise ValueError("it has no endsolid")
    yield np.array(positions, "f8").reshape(-1, 3), [3] * (len(positions) // 3), range(len(positions))


# --- PLY -------------------------------------------------------------------------------------------------------------------

PLY_TYPES = {"char": "i1", "int8": "i1", "uchar": "u1", "uint8": "u1", "short": "i2", "int16": "i2", "ushort": "u2", "uint16": "u2",
             "int": "i4", "int32": "i4", "uint": "u4", "uint32": "u4", "float": "f4", "float32": "f4", "double": "f8", "float64": "f8"}


class PlyWords:
    """The body of an ascii file."""

    def __init__(self, data, at):
        self.words, self.at = data[at:].split(), 0

    def take(self, type_name, count):
        if self.at + count > len(self.words):
            raise ValueError("it is shorter than its head says")
        self.at += count
        return [number(word) for word in self.words[self.at - count:self.at]]

    def rows(self, names, types, count):
        return np.array(self.take("", len(names) * count), "f8").reshape(count, len(names))


class PlyBytes:
    """The body of a binary file; `order` is < or >."""

    def __init__(self, data, at, order):
        self.data, self.at, self.order = data, at, order

    def take(self, type_name, count):
        type_name = np.dtype(self.order + type_name)
        values = np.frombuffer(self.data, type_name, int(count), self.at).tolist()
        self.at += int(count) * type_name.itemsize
        return values

    def rows(self, names, types, count):
        row = np.dtype([(str(place), self.order + type_name) for place, type_name in enumerate(types)])
        values = np.frombuffer(self.data, row, count, self.at)
        self.at += count * row.itemsize
        return np.stack([values[name].astype("f8") for name in row.names], -1)


def ply_head(data):
    """The format, the elements as [name, count, properties (name, type, type of the count)], and where the body begins."""
    first = re.search(rb"\r\n|\n|\r", data)
    end = re.search(rb"(?m)^end_header[^\n]*\n", data.replace(b"\r", b"\n") if first and first[0] == b"\r" else data)
    if not data.startswith(b"ply") or not end:
        raise ValueError("it has no PLY header")
    form, elements = "", []
    for words in (line.decode("latin-1").split() for line in re.split(rb"\r\n|\n|\r", data[:end.start()])):
        if words[:1] == ["format"]:
            form = words[1]
        if words[:1] == ["element"]:
            elements.append((words[1], int(words[2]), []))
        if words[:2] == ["property", "list"]:
            elements[-1][2].append((words[4], PLY_TYPES[words[3]], PLY_TYPES[words[2]]))
        elif words[:1] == ["property"]:
            elements[-1][2].append((words[2], PLY_TYPES[words[1]], None))
    return form, elements, end.end()


def strip_triangles(strip):
    """Corners of a strip, in which a negative one ends a part."""
    return [strip[k:k + 3] for k in range(len(strip) - 2) if min(strip[k:k + 3]) >= 0]


def read_ply(_, data):
    form, elements, at = ply_head(data)
    body = PlyWords(data, at) if form == "ascii" else PlyBytes(data, at, {"binary_little_endian": "<", "binary_big_endian": ">"}[form])
    positions, counts, corners = np.zeros((0, 3)), [], []
    for element, count, properties in elements:
        names = [name for name, _, _ in properties]
        if count > len(data):
            raise ValueError("it is shorter than its head says")
        if all(count_type is None for _, _, count_type in properties):
            rows = body.rows(names, [type_name for _, type_name, _ in properties], count) if names else []
            if element == "vertex":
                positions = rows[:, [names.index(axis) for axis in "xyz"]]
            continue
        rows = []
        for _ in range(count):
            row = {}
            for name, type_name, count_type in properties:
                length = 1 if count_type is None else int(body.take(count_type, 1)[0])
                if length < 0:
                    raise ValueError("a list has a negative length")
                row[name] = body.take(type_name, length)
            if element == "vertex":
                rows.append([row[axis][0] for axis in "xyz"])
            for name in {"face": ("vertex_indices", "vertex_index"), "tristrips": ("vertex_indices",)}.get(element, ()):
                for face in [] if name not in row else [row[name]] if element == "face" else strip_triangles(row[name]):
                    counts.append(len(face))
                    corners += face
        if element == "vertex":
            positions = np.array(rows, "f8").reshape(-1, 3)
    if any(corner != int(corner) for corner in corners):
        raise ValueError("a face names a vertex that is not a whole number")
    yield positions, counts, [int(corner) for corner in corners]
