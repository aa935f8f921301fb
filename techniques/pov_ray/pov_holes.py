"""Casters with holes and of glass for POV-Ray: each triangle of a mesh with an alpha mask or a transmission of texels is painted with
one picture of both, whose alpha is the part of the light that a texel stops. POV-Ray takes the pixel that holds a place, in double, as
Gnomon takes the texel. Needs numpy."""

import math
import struct
import zlib
from pathlib import Path

import numpy as np

LONGEST = 16384  # pixels of a side of a picture that is written for POV-Ray
# A ray from the eye goes on behind each hole, one level deeper.
SETTINGS = "global_settings { max_trace_level 256 }\n"


def bits_of(mask, words):
    """Of an alpha mask as the scene has it, height x width, True where it is solid: bit x % 32 of word x // 32 of a row."""
    height, width = mask["height"], mask["width"]
    rows = np.asarray(words, "<u4")[mask["first_word"]:][:height * -(-width // 32)].reshape(height, -1)
    return np.unpackbits(np.ascontiguousarray(rows).view(np.uint8), axis=1, bitorder="little")[:, :width].astype(bool)


def stopped_by(glass, values):
    """What part of the light the texels of a transmission of one channel stop, height x width, 0 .. 1."""
    height, width = glass["height"], glass["width"]
    return 1 - np.asarray(values, np.float32)[glass["first_value"]:][:height * width].reshape(height, width)


def textures(mesh):
    """The alpha mask and the transmission of a mesh, by these names, where it has them."""
    return {name: mesh[name] for name in ("alpha_mask", "transmission") if mesh.get(name)}


def is_painted(mesh):
    """Whether a picture says where the light goes through."""
    return any(texture["width"] * texture["height"] > 1 for texture in textures(mesh).values())


def size(texture, axis):
    """Texels along u (axis 0) or v (1)."""
    return texture[("width", "height")[axis]]


def wrap(texture, axis):
    """How it goes on beyond its borders; a single texel repeats, whatever is said of it."""
    return texture[("wrap_u", "wrap_v")[axis]] if size(texture, axis) > 1 else "repeat"


def texel(place, count, how):
    """That holds a place of an axis of `count` texels."""
    at = int(np.floor(count * place))
    if how == "clamp":
        return min(max(at, 0), count - 1)
    rest = at % (2 * count if how == "mirror" else count)
    return min(rest, 2 * count - 1 - rest) if how == "mirror" else rest


def copies(some, uv):
    """How often textures go into a picture that POV-Ray need only repeat to cover these places: along u and v from the first copy to
    before the last one, and the pixels of a copy. Copy 0 is the textures themselves."""
    for axis in (0, 1):
        wraps, places = {wrap(texture, axis) for texture in some}, uv[..., axis]
        pixels = math.lcm(*(size(texture, axis) for texture in some))
        if "clamp" in wraps:
            yield min(0, int(np.floor(places.min()))), max(1, int(np.ceil(places.max()))), pixels
        else:
            yield 0, 2 if "mirror" in wraps else 1, pixels


def continued(stopped, texture, axis, first, last, pixels):
    """Copies of what a texture stops along u or v, of so many pixels each, continued as the texture is."""
    chosen = [texel((k + 0.5) / pixels, size(texture, axis), wrap(texture, axis)) for k in range(first * pixels, last * pixels)]
    return stopped.take(chosen, 1 - axis)


def places_in_picture(some, uv):
    """Of triangles x 3 x 2 in the picture of their copies, 0 .. 1 once through it, x to the right and y up. Each triangle begins in
    0 .. 1: small numbers are sharper."""
    places = np.stack([(uv[..., axis] - first) / (last - first) for axis, (first, last, _) in enumerate(copies(some, uv))], -1)
    places[..., 1] = 1 - places[..., 1]  # the first row is the upper one, v goes down
    return places - np.floor(places[:, :1])


def png_of(stopped):
    """Gray and alpha, white: alpha is what is stopped, in 8 bits each where `stopped` is bool, else in 16."""
    height, width = stopped.shape
    kind, all_of_it = (np.dtype("u1"), 255) if stopped.dtype == bool else (np.dtype(">u2"), 65535)
    rows = np.zeros((height, 1 + 2 * width * kind.itemsize), np.uint8)
    pixels = np.full((height, width, 2), all_of_it, kind)
    pixels[..., 1] = np.rint(all_of_it * stopped)
    rows[:, 1:] = pixels.reshape(height, -1).view(np.uint8)
    chunk = lambda name, data: struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))
    header = struct.pack(">IIBBBBB", width, height, 8 * kind.itemsize, 4, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(rows.tobytes(), 1)) + chunk(b"IEND", b"")


def have_area(corners):
    """Which triangles have an area; corners are triangles x 3 x 3. POV-Ray warns of the others."""
    return np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=-1) > 0


def have_matrix(places):
    """Which triangles a matrix maps a picture to; places are triangles x 3 x 2. It maps none to places on a line, whose sides have a
    cross product of rounding: some 2^-53 of the product of their lengths, below 1e-12."""
    sides = places[:, 1:] - places[:, :1]
    cross = sides[:, 0, 0] * sides[:, 1, 1] - sides[:, 0, 1] * sides[:, 1, 0]
    return np.abs(cross) > 1e-12 * np.prod(np.linalg.norm(sides, axis=-1), axis=-1)


def why_not(mesh, corners, uv):
    """Why POV-Ray cannot draw a mesh with an alpha mask or a transmission; "" where it can. `corners` (triangles x 3 x 3) and `uv`
    (triangles x 3 x 2) of its triangles."""
    some, chosen = textures(mesh), np.flatnonzero(have_area(corners))
    if not is_painted(mesh) or not len(chosen):
        return ""
    for axis, (first, last, pixels) in enumerate(copies(some.values(), uv[chosen])):
        if (last - first) * pixels > LONGEST:
            said = " and ".join(f"the {name.replace('_', ' ')} of mesh '{mesh['name']}' has {size(texture, axis)} texels along {'uv'[axis]} "
                                f"and wrap {wrap(texture, axis)}" for name, texture in some.items())
            return f"{said}; POV-Ray needs a picture of {(last - first) * pixels} pixels for its uv, and the adapter writes at most {LONGEST}"
    places = places_in_picture(some.values(), uv[chosen])
    on_a_line = chosen[~have_matrix(places) & np.ptp(places, axis=1).any(1)]
    if len(on_a_line):
        return (f"the uv of triangle {on_a_line[0]} of mesh '{mesh['name']}' lie on a line; POV-Ray cannot map a picture to a triangle "
                "whose uv have no area")
    return ""


def painted(corners, places):
    """The numbers of POV-Ray's matrix from a picture, x to the right and y up, 0 .. 1, to a triangle of these corners (3 x 3) at these
    places (3 x 2) of it."""
    edges, steps = (corners[1:] - corners[0]).T, (places[1:] - places[0]).T
    across = edges @ np.linalg.inv(steps)
    normal = np.cross(edges[:, 0], edges[:, 1])
    normal /= np.linalg.norm(normal)
    return np.concatenate((across[:, 0], across[:, 1], normal, corners[0] - across @ places[0]))


def picture_of(parts, uv):
    """Of pairs of a texture and what part of the light its texels stop (bool, or 0 .. 1): what they stop together, over their copies."""
    whole = None
    for texture, stopped in parts:
        for axis, across in enumerate(copies([texture for texture, _ in parts], uv)):
            stopped = continued(stopped, texture, axis, *across)
        whole = stopped if whole is None else whole * stopped  # glass is where the mask is solid
    return whole


def stopped_at(parts, place):
    """The same at a place (u, v)."""
    return math.prod(float(stopped[tuple(texel(place[axis], size(texture, axis), wrap(texture, axis)) for axis in (1, 0))])
                     for texture, stopped in parts)


class Holes:
    """The alpha masks and transmissions of a scene: `words` and `values`, its arrays of bits and of numbers (None where it has none),
    and the uv of the triangles' corners, triangles x 3 x 2. Pictures go to a folder."""

    def __init__(self, words, values, uv, folder):
        self.words, self.values, self.uv, self.folder, self.names = words, values, np.asarray(uv, float), Path(folder), {}

    def stopped(self, name, texture):
        return bits_of(texture, self.words) if name == "alpha_mask" else stopped_by(texture, self.values)

    def pigment(self, stopped):
        """The name of a pigment, and the text that declares it where it is a new one."""
        key = stopped.shape, stopped.dtype, stopped.tobytes()
        if key in self.names:
            return self.names[key], ""
        name = self.names[key] = f"Holes{len(self.names)}"
        (self.folder / f"{name}.png").write_bytes(png_of(stopped))
        return name, f'#declare {name} = pigment {{ image_map {{ png "{name}.png" }} }}\n'

    def triangles(self, mesh, corners, vector, end):
        """Text of a mesh with a mask or a transmission; `corners` of its triangles in POV-Ray's units. RuntimeError where there is a
        why_not."""
        some, first = textures(mesh), mesh["first_triangle"]
        uv = self.uv[first:first + mesh["triangles"]]
        why = why_not(mesh, corners, uv)
        if why:
            raise RuntimeError(why)
        chosen = have_area(corners)
        corners, uv = corners[chosen], uv[chosen]
        if not len(uv):
            return ""
        parts = [(texture, self.stopped(name, texture)) for name, texture in some.items()]
        text, every_place = "", np.zeros_like(uv)
        if is_painted(mesh):
            name, text = self.pigment(picture_of(parts, uv))
            every_place = places_in_picture(some.values(), uv)
        for points, (place, *_), places, has_matrix in zip(corners, uv, every_place, have_matrix(every_place)):
            paint, stopped = "", 1 if has_matrix else stopped_at(parts, place)  # one texel for all of it where there is no matrix
            if stopped == 0:
                continue
            if has_matrix:
                paint = f" pigment {{ {name} matrix {vector(painted(points, places))} }}"
            elif stopped < 1:
                paint = f" pigment {{ rgbt <1, 1, 1, {1 - stopped:.17g}> }}"
            text += "triangle { " + ", ".join(map(vector, points)) + paint + end
        return text
