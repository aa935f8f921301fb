"""What the program writes, read with numpy: OpenEXR files, and the folder of `gnomon export`. Arrays are height x width; row 0 is the top."""

import json
import struct
import zlib
from dataclasses import dataclass
from pathlib import Path

import numpy as np

LINES_OF_BLOCK = {0: 1, 2: 1, 3: 16}  # by compression: none, ZIPS, ZIP


def read_exr(path):
    """The channels of a scanline OpenEXR file of float32, by name."""
    data, at, header = Path(path).read_bytes(), 8, {}
    assert data[:4] == b"\x76\x2f\x31\x01", f"{path} is no OpenEXR file"
    while data[at]:
        name, kind, _ = data[at:at + 512].split(b"\0", 2)
        at += len(name) + len(kind) + 2
        (size,) = struct.unpack_from("<i", data, at)
        header[name] = data[at + 4:at + 4 + size]
        at += 4 + size
    names, channels = [], header[b"channels"]
    while channels[0]:
        name, channels = channels.split(b"\0", 1)
        assert channels[0] == 2, f"{path}: channel {name} is not float32"
        names.append(name.decode())
        channels = channels[16:]
    x0, y0, x1, y1 = struct.unpack("<4i", header[b"dataWindow"])
    width, height, lines = x1 - x0 + 1, y1 - y0 + 1, LINES_OF_BLOCK[header[b"compression"][0]]
    picture = np.empty((height, len(names), width), "<f4")
    for offset in struct.unpack_from(f"<{-(-height // lines)}Q", data, at + 1):
        y, size = struct.unpack_from("<ii", data, offset)
        block, target = data[offset + 8:offset + 8 + size], picture[y - y0:y - y0 + lines]
        if size < target.nbytes:
            block = inflated(block)
        target[:] = np.frombuffer(block, "<f4").reshape(target.shape)
    return {name: picture[:, k].astype(float) for k, name in enumerate(names)}


def inflated(block):
    """ZIP holds differences of neighboring bytes, plus 128, of all even bytes and then all odd ones."""
    differences = np.frombuffer(zlib.decompress(block), np.uint8).astype(np.int64)
    differences[1:] -= 128
    halves = np.cumsum(differences).astype(np.uint8)
    middle = -(-len(halves) // 2)
    bytes_of_block = np.empty(len(halves), np.uint8)
    bytes_of_block[0::2], bytes_of_block[1::2] = halves[:middle], halves[middle:]
    return bytes_of_block


B, F, G, S, U, T = range(6)  # the classes of pixels


@dataclass
class Evidence:
    """One mask and what it is compared with."""

    mask: np.ndarray
    reference: np.ndarray
    classes: np.ndarray
    position: np.ndarray  # height x width x 3
    normal: np.ndarray
    mesh: np.ndarray  # -1: background
    triangle: np.ndarray
    view: dict  # these three in the words of a scene file, numbers as float32
    light: dict
    scene: dict
    corners: np.ndarray  # of the scene's triangles, n x 3 x 3
    mesh_of_triangle: np.ndarray
    error: np.ndarray = None  # under a light with area: standard error of the reference
    half: np.ndarray = None  # what half of its rays say
    other: np.ndarray = None  # and the number that the technique does not estimate

    @property
    def tested(self):
        return self.classes == T

    @property
    def facing(self):
        return self.classes > F

    @property
    def has_area(self):
        return self.error is not None


def read_evidence(folder, light_name, mask, estimates=None):
    """What `gnomon export` wrote, beside a mask; `estimates` is what that stands for under a light with area, `area` or `irradiance`."""
    folder = Path(folder)
    frame, scene = (json.loads((folder / name).read_text(), parse_float=np.float32) for name in ("frame.json", "scene.json"))
    light = next(light for light in frame["lights"] if light["name"] == light_name)

    def array(entry):
        numbers = np.load(folder / entry["file"])
        return numbers.astype(float if numbers.dtype.kind == "f" else np.int32)

    reference = {name: array(entry) for name, entry in light["reference"].items()}
    position, normal, mesh, triangle = (array(frame["gbuffer"][name]) for name in ("position", "normal", "mesh", "triangle"))
    vertices, triangles, mesh_of_triangle = (array(scene["arrays"][name]) for name in ("position", "triangle", "mesh"))
    area = [reference.get(name) for name in ("visibility", "error", "half")]
    irradiance = [reference.get(name) for name in ("irradiance", "irradiance_error", "irradiance_half")]
    (right, error, half), (other, *_) = (irradiance, area) if estimates == "irradiance" else (area, irradiance)
    return Evidence(mask=mask, reference=right, error=error, half=half, other=other, classes=reference["class"],
                    position=np.moveaxis(position, 0, -1), normal=np.moveaxis(normal, 0, -1), mesh=mesh, triangle=triangle,
                    view=frame["view"], light=light, scene=scene, corners=vertices[triangles], mesh_of_triangle=mesh_of_triangle)
