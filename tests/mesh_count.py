#!/usr/bin/python3 -I
"""What a mesh file holds, counted by readers of its own: nothing here is shared with the program.

usage: tests/mesh_count.py FILE...

Reads glTF 2.0, GLB, PLY, STL, OFF and OBJ. Prints one JSON object a line:
  triangles         with an area; a face of n corners is split into n - 2, equal corners in a row taken as one
  degenerate        how many of these n - 2 have no area, or fewer than three positions
  polygons          faces of more than three corners; where such a one has corners in a line, how it is split decides how many
                    of its triangles are degenerate, but not the sum of both
  points_and_lines  what has fewer than three corners
  bounds            min and max of the vertices that faces use: float32, after the transforms of the nodes in double
  all_bounds        the same of all vertices of the meshes that have a face
  refused           the reason, and then nothing else
"""

import json
import struct
import sys
from fractions import Fraction
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent))
sys.dont_write_bytecode = True
import mesh_count_gltf
import mesh_count_plain as plain

LARGEST = 1e17  # of a coordinate

READERS = {".obj": plain.read_obj, ".off": plain.read_off, ".ply": plain.read_ply, ".stl": plain.read_stl,
           ".gltf": mesh_count_gltf.read, ".glb": mesh_count_gltf.read}


def has_no_area(corners):
    """Whether each of (n, 3, 3) corners lies in a line. Where double does not tell, fractions do."""
    a, b, c = (corners[:, k].astype("f8") for k in range(3))
    u, v = b - a, c - a
    left, right = u[:, [1, 2, 0]] * v[:, [2, 0, 1]], u[:, [2, 0, 1]] * v[:, [1, 2, 0]]
    flat_ones = (np.abs(left - right) <= 1e-14 * (np.abs(left) + np.abs(right)) + 1e-290).all(1)
    for place in np.flatnonzero(flat_ones):
        p, q, r = ([Fraction(float(x)) for x in corner] for corner in corners[place])
        u, v = [y - x for x, y in zip(p, q)], [y - x for x, y in zip(p, r)]
        flat_ones[place] = all(u[k] * v[(k + 1) % 3] == u[(k + 1) % 3] * v[k] for k in range(3))
    return flat_ones


def split(positions, block):
    """Triangles of faces of as many corners each, (n, corners), whose equal corners in a row are one."""
    points = positions[block]
    kept = (points != np.roll(points, 1, axis=1)).any(2)
    whole = block[kept.all(1)]
    fans = [whole[:, [0, k, k + 1]] for k in range(1, block.shape[1] - 1)]
    for place in np.flatnonzero(~kept.all(1)):
        face = block[place][kept[place]]
        fans += [np.array([[face[0], face[k], face[k + 1]]]) for k in range(1, len(face) - 1)]
    return np.concatenate(fans)


def count_mesh(mesh, tally):
    positions, counts, corners = mesh
    with np.errstate(over="ignore", invalid="ignore"):
        positions = np.asarray(positions).astype("f4")
    counts, corners = np.asarray(counts, "i8").reshape(-1), np.asarray(corners, "i8").reshape(-1)
    if len(corners) and not 0 <= corners.min() <= corners.max() < len(positions):
        raise ValueError("a face names a vertex that is not there")
    if (counts < 0).any():
        raise ValueError("a face has a negative number of corners")
    tally["points_and_lines"] += int((counts < 3).sum())
    tally["polygons"] += int((counts > 3).sum())
    starts = np.cumsum(counts) - counts
    used = []
    for size in np.unique(counts[counts >= 3]):
        block = corners[starts[counts == size][:, None] + np.arange(size)]
        used.append(np.unique(block))
        if not (np.abs(positions[used[-1]]) <= LARGEST).all():
            raise ValueError("a coordinate is not finite or too large")
        triangles = split(positions, block)
        sound = int((~has_no_area(positions[triangles])).sum())
        tally["triangles"] += sound
        tally["degenerate"] += len(block) * (int(size) - 2) - sound
    if used:
        tally["points"].append(positions[np.concatenate(used)])
        tally["all_points"].append(positions)


def bounds_of(parts):
    points = np.concatenate(parts)
    return {side: [float(x) for x in getattr(points, side)(0)] for side in ("min", "max")}


def count(file):
    """What a file holds, as said above."""
    file = Path(file)
    reader = READERS.get(file.suffix.lower())
    tally = {"file": str(file), "format": file.suffix.lower()[1:], "triangles": 0, "degenerate": 0, "polygons": 0, "points_and_lines": 0,
             "points": [], "all_points": []}
    try:
        if not reader:
            raise ValueError("its format is not one of these")
        for mesh in reader(file, file.read_bytes().removeprefix(b"\xef\xbb\xbf")):  # a mark that text is UTF-8
            count_mesh(mesh, tally)
        if tally["triangles"] == 0:
            raise ValueError("it has no triangle" + (f" but {tally['degenerate']} without area" if tally["degenerate"] else ""))
    except (ValueError, LookupError, TypeError, AttributeError, OSError, OverflowError, struct.error) as problem:
        text = str(problem) if type(problem) is ValueError else f"{type(problem).__name__}: {problem}"
        return {"file": tally["file"], "format": tally["format"], "refused": text}
    tally["bounds"], tally["all_bounds"] = bounds_of(tally.pop("points")), bounds_of(tally.pop("all_points"))
    return tally


def main(words):
    if not words or words[0].startswith("-"):
        print(__doc__.strip())
        return 0 if words[:1] in (["--help"], ["-h"]) else 2
    for word in words:
        print(json.dumps(count(word)), flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
