"""Casters with holes for POV-Ray: each triangle of a mesh with an alpha mask is painted with a picture of the mask's bits, whose holes
let all light through. POV-Ray takes the pixel that holds a place, in double, as Gnomon takes the texel. Needs numpy."""

import struct
import zlib
from pathlib import Path

import numpy as np

LONGEST = 16384  # pixels of a picture's side
# A ray from the eye goes on behind each hole, one level deeper.
SETTINGS = "global_settings { max_trace_level 256 }\n"


def bits_of(mask, words):
    """Of an alpha mask as the scene has it, height x width, True where it is solid: bit x % 32 of word x // 32 of a row."""
    height, width = mask["height"], mask["width"]
    rows = np.asarray(words, "<u4")[mask["first_word"]:][:height * -(-width // 32)].reshape(height, -1)
    return np.unpackbits(np.ascontiguousarray(rows).view(np.uint8), axis=1, bitorder="little")[:, :width].astype(bool)


def repeating(bits, axis, wrap, places):
    """Bits that need only be repeated along an axis to cover these places of it, and the places in them, 0 .. 1 once through."""
    size = bits.shape[axis]
    if wrap == "repeat":
        return bits, places
    first, last = (0, 2) if wrap == "mirror" else (min(0, int(np.floor(places.min()))), max(1, int(np.ceil(places.max()))))
    if (last - first) * size > LONGEST:
        raise RuntimeError(f"an alpha mask whose edge is continued needs {(last - first) * size} pixels; at most {LONGEST} are allowed")
    texel = np.arange(first * size, last * size)
    texel = np.where(texel < size, texel, 2 * size - 1 - texel) if wrap == "mirror" else np.clip(texel, 0, size - 1)
    return bits.take(texel, axis), (places - first) / (last - first)


def png_of(bits):
    """Gray and alpha of 8 bits each, white: alpha is 255 where a bit is set, else 0."""
    height, width = bits.shape
    rows = np.zeros((height, 1 + 2 * width), np.uint8)
    rows[:, 1::2], rows[:, 2::2] = 255, np.where(bits, 255, 0)
    chunk = lambda kind, data: struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    header = struct.pack(">IIBBBBB", width, height, 8, 4, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(rows.tobytes(), 1)) + chunk(b"IEND", b"")


def painted(corners, places):
    """The numbers of POV-Ray's matrix from a picture, x to the right and y up, 0 .. 1, to a triangle of these corners (3 x 3) at these
    places (3 x 2) of it; None where the places are those of no area."""
    places = places - np.floor(places[0])  # small numbers are sharper
    edges, steps = (corners[1:] - corners[0]).T, (places[1:] - places[0]).T
    if abs(np.linalg.det(steps)) <= 1e-12 * np.linalg.norm(steps[:, 0]) * np.linalg.norm(steps[:, 1]):
        return None
    across = edges @ np.linalg.inv(steps)
    normal = np.cross(edges[:, 0], edges[:, 1])
    normal /= np.linalg.norm(normal)
    return np.concatenate((across[:, 0], across[:, 1], normal, corners[0] - across @ places[0]))


class Holes:
    """The alpha masks of a scene: their words and the uv of the triangles' corners, triangles x 3 x 2. Pictures go to a folder."""

    def __init__(self, words, uv, folder):
        self.words, self.uv, self.folder, self.names = words, np.asarray(uv, float), Path(folder), {}

    def pigment(self, bits):
        """The name of a pigment, and the text that declares it where it is a new one."""
        key = bits.shape, np.packbits(bits).tobytes()
        if key in self.names:
            return self.names[key], ""
        name = self.names[key] = f"Holes{len(self.names)}"
        (self.folder / f"{name}.png").write_bytes(png_of(bits))
        return name, f'#declare {name} = pigment {{ image_map {{ png "{name}.png" }} }}\n'

    def triangles(self, mesh, corners, vector, end):
        """Text of a mesh with a mask; `corners` of its triangles in POV-Ray's units."""
        mask, first = mesh["alpha_mask"], mesh["first_triangle"]
        bits, uv = bits_of(mask, self.words), self.uv[first:first + mesh["triangles"]]
        bits, u = repeating(bits, 1, mask["wrap_u"], uv[..., 0])
        bits, v = repeating(bits, 0, mask["wrap_v"], uv[..., 1])
        name, text = self.pigment(bits)
        for points, places in zip(corners, np.stack((u, 1 - v), -1)):  # the first row is the upper one, v goes down
            if not np.linalg.norm(np.cross(points[1] - points[0], points[2] - points[0])) > 0:
                continue
            paint = ""
            matrix = painted(points, places)
            if matrix is not None:
                paint = f" pigment {{ {name} matrix {vector(matrix)} }}"
            elif np.ptp(places, axis=0).any():
                raise RuntimeError(f"uv of a triangle of mesh {mesh['name']} lie on a line; POV-Ray needs an area")
            else:
                column, up = np.floor(places[0] * bits.shape[::-1]).astype(int) % bits.shape[::-1]
                if not bits[bits.shape[0] - 1 - up, column]:
                    continue
            text += "triangle { " + ", ".join(map(vector, points)) + paint + end
        return text
