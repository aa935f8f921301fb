"""Reads the pictures that the program writes, with nothing but what Python brings: pixel values, no color management."""

import struct
import zlib
from itertools import accumulate


class Picture:
    """Eight bits a channel: `pixels` holds the bytes R, G, B of each row from the top."""

    def __init__(self, width, height, pixels):
        self.width, self.height, self.pixels = width, height, pixels

    def at(self, x, y):
        k = 3 * (y * self.width + x)
        return tuple(self.pixels[k:k + 3])

    def columns(self, first, end):
        """The bytes of these columns, row by row."""
        row = 3 * self.width
        return b"".join(self.pixels[y * row + 3 * first:y * row + 3 * end] for y in range(self.height))

    def crop(self, x, y, width, height):
        row = 3 * self.width
        return Picture(width, height, b"".join(self.pixels[r * row + 3 * x:r * row + 3 * (x + width)] for r in range(y, y + height)))

    def __eq__(self, other):
        return (self.width, self.height, self.pixels) == (other.width, other.height, other.pixels)


def unfiltered(data, width, height):
    """The rows of a PNG of three bytes a pixel."""
    row, above, result, size = 3 * width, bytes(3 * width), [], 3
    for y in range(height):
        kind, line = data[y * (row + 1)], bytearray(data[y * (row + 1) + 1:(y + 1) * (row + 1)])
        if kind == 1:
            for c in range(size):
                line[c::size] = bytes(accumulate(line[c::size], lambda a, b: (a + b) & 255))
        elif kind == 2:
            line = bytearray((a + b) & 255 for a, b in zip(line, above))
        elif kind == 3:
            for k in range(row):
                left = line[k - size] if k >= size else 0
                line[k] = (line[k] + (left + above[k]) // 2) & 255
        elif kind == 4:
            for k in range(row):
                a, b, c = (line[k - size], above[k], above[k - size]) if k >= size else (0, above[k], 0)
                pa, pb, pc = abs(b - c), abs(a - c), abs(a + b - 2 * c)
                line[k] = (line[k] + (a if pa <= pb and pa <= pc else b if pb <= pc else c)) & 255
        above = bytes(line)
        result.append(above)
    return b"".join(result)


def read_png(file):
    data = file.read_bytes()
    assert data[:8] == b"\x89PNG\r\n\x1a\n", file
    at, packed, head = 8, b"", None
    while at < len(data):
        size, kind = struct.unpack(">I4s", data[at:at + 8])
        body = data[at + 8:at + 8 + size]
        if kind == b"IHDR":
            head = struct.unpack(">IIBBBBB", body)
        elif kind == b"IDAT":
            packed += body
        at += size + 12
    width, height, depth, color, _, _, interlaced = head
    assert (depth, color, interlaced) == (8, 2, 0), (file, head)
    return Picture(width, height, unfiltered(zlib.decompress(packed), width, height))


def read_mask(file):
    """Width, height and floats of an OpenEXR file with channels of floats in scan lines, plain or zipped. The floats are those of the
    channels in the order of their names, one after the other."""
    data = file.read_bytes()
    assert data[:4] == b"\x76\x2f\x31\x01", file
    at, attributes = 8, {}
    while data[at]:
        name, kind = (data[at:].split(b"\0", 2)[k].decode() for k in (0, 1))
        at += len(name) + len(kind) + 2
        size, = struct.unpack_from("<I", data, at)
        attributes[name] = data[at + 4:at + 4 + size]
        at += 4 + size
    channels = attributes["channels"]
    count_of_channels, name_at = 0, 0
    while channels[name_at]:
        name_at = channels.index(b"\0", name_at) + 1
        kind, = struct.unpack_from("<I", channels, name_at)
        assert kind == 2, (file, channels)
        count_of_channels, name_at = count_of_channels + 1, name_at + 16
    x0, y0, x1, y1 = struct.unpack("<4i", attributes["dataWindow"])
    width, height = x1 - x0 + 1, y1 - y0 + 1
    lines = {0: 1, 2: 1, 3: 16}[attributes["compression"][0]]
    rows = [[None] * height for _ in range(count_of_channels)]
    for k in range((height + lines - 1) // lines):
        offset, = struct.unpack_from("<Q", data, at + 1 + 8 * k)
        y, size = struct.unpack_from("<iI", data, offset)
        count = min(lines, y1 + 1 - y)
        body = data[offset + 8:offset + 8 + size]
        if size < 4 * width * count * count_of_channels:
            # Differences of neighbors, the bytes at even places before those at odd ones.
            mixed = bytes(accumulate(zlib.decompress(body), lambda a, b: (a + b - 128) & 255))
            half = (len(mixed) + 1) // 2
            plain = bytearray(len(mixed))
            plain[0::2], plain[1::2] = mixed[:half], mixed[half:]
            body = bytes(plain)
        for r in range(count):
            for c in range(count_of_channels):
                rows[c][y - y0 + r] = struct.unpack_from(f"<{width}f", body, 4 * width * (r * count_of_channels + c))
    return width, height, [value for channel in rows for row in channel for value in row]
