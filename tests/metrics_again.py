"""The metrics of `gnomon list metrics` a second time: in float64, from docs/method.md and docs/glass.md, with no code of the program.

`nan` stands for what is not defined, which is `null` in a record.
"""

import itertools
import math
from dataclasses import replace

import numpy as np
from light_again import cosine, irradiance
from likeness_again import likeness
from numpy.lib.stride_tricks import sliding_window_view

STEP = float(np.float32(1 / 20))  # of fractions behind glass, in the place of 1/2; 0 is off by so much from 1/20 in a mask of float32


# --- errors -----------------------------------------------------------------------------------------------------------------


def share(part, whole):
    """part / whole; not defined where the whole is nothing."""
    return float(part / whole) if whole else math.nan


def mean(values):
    """Sum over number; not defined without values."""
    return share(values.sum(), values.size)


def middle_mean(values):
    """Mean of all but the n / 4 (rounded down) smallest and as many largest of n values."""
    cut = len(values) // 4
    return mean(np.sort(values)[cut:len(values) - cut])


def root_mean_square(values):
    """Root of the mean of the squares."""
    return math.sqrt(mean(values**2))


def is_glass(e):
    """Whether the light has no area and a caster lets a part of it through: V has fractions, and a pixel that is off by 1/20 is wrong."""
    return not e.has_area and any(mesh.get("transmission") for mesh in e.scene["meshes"])


def is_wrong(e):
    """Pixels whose |V - V_ref| is above 1/2, or is 1/2 with the reference above it; behind glass above 1/20."""
    off = np.abs(e.mask - e.reference)
    return off > STEP if is_glass(e) else (off > 0.5) | ((off == 0.5) & (e.reference > 0.5))


def error_rates(e):
    """Means over T of |V - V_ref|, of V its best constant, of V its half; shares of T, and of T + G + S + U, that are wrong, of T by sign."""
    difference = e.mask - e.reference
    wrong, tested = is_wrong(e), e.tested
    reference = e.reference[tested]
    return {
        "error": mean(np.abs(difference)[tested]),
        "constant_error": mean(np.abs(reference - np.median(reference))) if reference.size else math.nan,
        "wrong_rate": mean(wrong[tested]),
        "wrong_rate_all": mean(wrong[e.facing]),
        "false_dark_rate": mean((wrong & (difference < 0))[tested]),
        "false_lit_rate": mean((wrong & (difference > 0))[tested]),
        "error_floor": 1.1 * mean(np.abs(e.half - e.reference)[tested]) if e.half is not None else math.nan,
        "other_error_mean": mean(np.abs(e.mask - e.other)[tested]) if e.has_area else math.nan,
        "tested_share": share(tested.sum(), e.facing.sum()),
    }


def distances(marked):
    """Distance in pixels of every pixel to the nearest marked one; infinity where none is marked."""
    height, width = marked.shape
    nearest = np.full((height, width), math.inf)
    y, x = np.mgrid[:height, :width]
    for j, i in zip(*np.nonzero(marked)):
        nearest = np.minimum(nearest, (y - j) ** 2 + (x - i) ** 2)
    return np.sqrt(nearest)


def boundary(e, v):
    """Pixels on the darker and on the lighter side of the boundary of V.

    It runs between 4-neighbors that face the light and are on two sides of V = 1/2; behind glass between those that differ by more than 1/20.
    """
    dark, light = np.zeros((2, *v.shape), bool)
    for a, b in ((np.s_[:, 1:], np.s_[:, :-1]), (np.s_[1:], np.s_[:-1])):
        differ = np.abs(v[a] - v[b]) > STEP if is_glass(e) else (v[a] > 0.5) != (v[b] > 0.5)
        for one, other in ((a, b), (b, a)):
            crossed = differ & e.facing[one] & e.facing[other]
            dark[one] |= crossed & (v[one] < v[other])
            light[one] |= crossed & (v[one] > v[other])
    return dark, light


def to_boundary(e):
    """Distance of every pixel to the nearest one beside the boundary of the reference."""
    return distances(np.logical_or(*boundary(e, e.reference)))


def displacement(e):
    """Distances from the dark side of each boundary to the nearest pixel of the other's dark side: mean and 95th percentile, both ways together."""
    ours, theirs = (boundary(e, v)[0] for v in (e.mask, e.reference))
    both = np.concatenate([distances(theirs)[ours], distances(ours)[theirs]])
    both = both if both.size else np.zeros(1)  # neither has a boundary
    is_defined = np.isfinite(both).all()  # infinite where one of the two has none
    values = (mean(both), float(np.percentile(both, 95))) if is_defined else (math.nan, math.nan)
    return dict(zip(("displacement_mean", "displacement_p95"), values))


def meters_between(e):
    """The same distances in the scene: from each point of either dark side to the nearest one of the other, without pixels that cover nothing."""
    names = ("displacement_mean_m", "displacement_p95_m")
    covers = pixel_areas(e) > 0
    sides = [boundary(e, v)[0] for v in (e.mask, e.reference)]
    if not any(side.any() for side in sides):
        return dict.fromkeys(names, 0)
    ours, theirs = (e.position[side & covers].astype(float) for side in sides)
    if not (ours.size and theirs.size):
        return dict.fromkeys(names, math.nan)
    squares = ((ours[:, None] - theirs[None]) ** 2).sum(axis=-1)
    both = np.sqrt(np.concatenate([squares.min(axis=1), squares.min(axis=0)]))
    return dict(zip(names, (mean(both), float(np.percentile(both, 95)))))


def binned_rates(e):
    """Wrong rate of the pixels of T in each bin: a bin holds what is above the end of the one before it, up to its own."""
    wrong = is_wrong(e)
    edge = to_boundary(e)
    angle = np.degrees(np.arcsin(np.clip(cosine(e), -1, 1)))
    rates = {}
    for family, value, ends in (("edge", edge, [0, 1, 2, 4, 8, "up"]), ("angle", angle, [2, 10, 30, 60, 90])):
        for k, (low, high) in enumerate(zip(ends, ends[1:])):
            inside = e.tested & ((value > low) | (k == 0)) & (value <= (math.inf if high == "up" else high))
            rates[f"wrong_rate_{family}_{low}_{high}"] = mean(wrong[inside])
    return rates


def transmittance_errors(e, surfaces):
    """Behind glass, of |V - V_ref| over T: root mean square and 95th percentile, and means by place and by number of surfaces on the way.

    A way that meets something opaque has -1 surfaces, and is in none of these bins.
    """
    bins = {"0": (0, 0), "1": (1, 1), "2": (2, 2), "3_4": (3, 4), "5_up": (5, math.inf)}
    names = [f"transmittance_error_{part}" for part in ("rms", "p95", "at_jumps", "off_jumps", *bins)]
    if not is_glass(e):
        return dict.fromkeys(names, math.nan)
    off, at_jumps = np.abs(e.mask - e.reference)[e.tested], (to_boundary(e) <= 2)[e.tested]
    counts = surfaces[e.tested]
    values = [root_mean_square(off), float(np.percentile(off, 95)) if off.size else math.nan, mean(off[at_jumps]), mean(off[~at_jumps])]
    return dict(zip(names, values + [mean(off[(counts >= low) & (counts <= high)]) for low, high in bins.values()]))


def hue_error(channels):
    """Mean of the largest less the smallest V - V_ref of the three channels, over the pixels that are T in all; not defined without channels."""
    signed = np.array([e.mask - e.reference for e in channels])
    tested = np.all([e.tested for e in channels], axis=0)
    return mean(np.ptp(signed, axis=0)[tested]) if len(channels) == 3 else math.nan


def eye_rays(e, dx, dy):
    """The eye E, for every pixel r = f + u R + v U through its center moved by (dx, dy) pixels, and the side s of a pixel at distance 1."""
    eye, target, up = (np.array(e.view[name], float) for name in ("eye", "target", "up"))
    forward = (target - eye) / np.linalg.norm(target - eye)
    right = np.cross(forward, up) / np.linalg.norm(np.cross(forward, up))
    height, width = e.mesh.shape
    side = 2 * math.tan(math.radians(float(e.view["fov_y_degrees"])) / 2) / height
    u, down = (side * (np.arange(n) + 0.5 + d - n / 2) for n, d in ((width, dx), (height, dy)))
    return eye, forward + u[None, :, None] * right - down[:, None, None] * np.cross(right, forward), side


def pixel_areas(e):
    """Square meters that each pixel covers on the plane through P across N: h^2 s^2 a_0 / (a_1 a_2 a_3 a_4) with h = N.(P - E), a = N.r.

    The distance to the plane along a corner's ray is |r| h / a. Where it more than triples from corner to corner the pixel covers nothing.
    """
    eye, center, side = eye_rays(e, 0, 0)
    corners = np.array([eye_rays(e, dx, dy)[1] for dx in (-0.5, 0.5) for dy in (-0.5, 0.5)])
    h = (e.normal * (e.position - eye)).sum(axis=-1)
    a = (e.normal * corners).sum(axis=-1)
    with np.errstate(divide="ignore", invalid="ignore"):
        area = np.abs(h**2 * side**2 * (e.normal * center).sum(axis=-1) / np.prod(a, axis=0))
        distance = np.linalg.norm(corners, axis=-1) * h / a
        is_flat = (distance.min(axis=0) <= 0) | (distance.max(axis=0) > 3 * distance.min(axis=0))
    return np.where((e.mesh < 0) | is_flat, 0, area)


def shadow_area_ratio(e):
    """Sum over T of area (1 - V), technique to reference."""
    area = pixel_areas(e)[e.tested]
    return {"shadow_area_ratio": share((area * (1 - e.mask[e.tested])).sum(), (area * (1 - e.reference[e.tested])).sum())}


def wrong_area(e):
    """Sum of the areas of the pixels of T that are wrong."""
    return {"wrong_area_m2": float(pixel_areas(e)[e.tested & is_wrong(e)].sum()) if e.tested.any() else math.nan}


def instability(before, now):
    """Of the pixels that are T in both of two frames, the share whose V crosses 1/2 in the technique and not in the reference."""
    ours, theirs = ((getattr(before, of) > 0.5) != (getattr(now, of) > 0.5) for of in ("mask", "reference"))
    return mean((ours & ~theirs)[before.tested & now.tested])


def received_errors(e):
    """E = irradiance V: mean of |E - E_ref| over T, and its root mean square as a share of that of E_ref."""
    light = irradiance(e)[e.tested]
    difference, right = light * (e.mask - e.reference)[e.tested], light * e.reference[e.tested]
    return {"received_error_mean": mean(np.abs(difference)), "received_error_rms": share(root_mean_square(difference), root_mean_square(right))}


# --- penumbrae --------------------------------------------------------------------------------------------------------------


def windows(values, size):
    """The size x size neighborhoods of every pixel in the last axis; pixels outside the picture are nan."""
    padded = np.pad(values.astype(float), size // 2, constant_values=math.nan)
    return sliding_window_view(padded, (size, size)).reshape(*values.shape, size * size)


def is_on_one_object(e, size):
    """Whether all of a pixel's size x size neighborhood lies in the picture, faces the light and shows one mesh."""
    mesh = np.where(e.facing, e.mesh, -1)
    return (windows(mesh, size) == mesh[..., None]).all(axis=-1) & e.facing


def gradient(visibility):
    """d/dx and d/dy per pixel of the plane that fits a pixel's 3 x 3 neighborhood best; nan at the rim of the picture."""
    y, x = (k.ravel() for k in np.mgrid[-1:2, -1:2])
    around = windows(visibility, 3)
    return np.stack([(around * x).sum(axis=-1), (around * y).sum(axis=-1)], axis=-1) / 6


def samples(e, points, mesh):
    """V and V_ref at points (x, y), bilinear, and whether they count: all four pixels in the picture, those with weight of T and on the mesh."""
    low = np.floor(points).astype(int)
    counts = ((low >= 0) & (low < np.array(e.mesh.shape)[::-1] - 1)).all(axis=-1)
    low = np.where(counts[:, None], low, 0)
    values = np.zeros((2, len(points)))
    for corner in ((0, 0), (1, 0), (0, 1), (1, 1)):
        weight = np.prod(np.where(corner, points - low, 1 - (points - low)), axis=-1)
        pixel = tuple((low + corner).T[::-1])
        counts &= (weight == 0) | (e.tested[pixel] & (e.mesh[pixel] == mesh))
        values += weight * np.array([e.mask[pixel], e.reference[pixel]])
    return values, counts


def line_beginnings(e):
    """Points (x, y) where V_ref, linear between 4-neighbors on one object, crosses 1/2, the unit gradient at the nearest pixel, and the mesh.

    Left out are points whose nearest pixel has a 3 x 3 neighborhood that is not on one object, or no gradient.
    """
    v, points, meshes = e.reference, [], []
    for dy, dx in ((0, 1), (1, 0)):
        a, b = np.s_[:v.shape[0] - dy, :v.shape[1] - dx], np.s_[dy:, dx:]
        crossed = ((v[a] > 0.5) != (v[b] > 0.5)) & e.facing[a] & e.facing[b] & (e.mesh[a] == e.mesh[b])
        part = (0.5 - v[a][crossed]) / (v[b][crossed] - v[a][crossed])
        points.append(np.argwhere(crossed)[:, ::-1] + part[:, None] * [dx, dy])
        meshes.append(e.mesh[a][crossed])
    points, meshes = np.concatenate(points), np.concatenate(meshes)
    nearest = tuple(np.floor(points + 0.5).astype(int).T[::-1])
    slope = gradient(v)[nearest]
    length = np.linalg.norm(slope, axis=-1)
    good = is_on_one_object(e, 3)[nearest] & (length > 0)
    return points[good], slope[good] / length[good, None], meshes[good]


def penumbra_lines(e):
    """Width of V, width of V_ref and shift of every line across a penumbra whose width_ref is 2 px or more."""
    start, way, mesh = line_beginnings(e)
    values, good = samples(e, start, mesh)
    everything = [values]
    for step, is_far in ((way / 2, lambda v: v >= 0.98), (-way / 2, lambda v: v <= 0.02)):
        going, was_far, last = good.copy(), np.zeros(len(start), bool), np.full(len(start), math.inf)
        good = np.zeros(len(start), bool)
        for k in itertools.count(1):
            values, counts = samples(e, start + k * step, mesh)
            going &= counts & (k <= last)
            if not going.any():
                break
            everything.append(np.where(going, values, 0))  # V = V_ref = 0 adds nothing
            far = is_far(values)
            last[far[1] & np.isinf(last)] = 4 * k + 8  # 4 d + 4 px in steps of half a pixel
            good |= going & was_far & far.all(axis=0)
            going &= ~good
            was_far = far.all(axis=0)
    ours, theirs = np.moveaxis(everything, 1, 0)
    width, width_ref, shift = (values.sum(axis=0)[good] / 2 for values in (6 * ours * (1 - ours), 6 * theirs * (1 - theirs), theirs - ours))
    wide = width_ref >= 2
    return width[wide], width_ref[wide], shift[wide]


def width_and_shift(e):
    """Of width / width_ref and of the shift, over the lines; not defined with fewer than ten lines."""
    width, width_ref, shift = penumbra_lines(e)
    values = (middle_mean(width / width_ref), middle_mean(shift)) if len(shift) >= 10 else (math.nan, math.nan)
    return dict(zip(("penumbra_width_ratio", "penumbra_shift"), map(float, values)))


def penumbra_metrics(e):
    """What is defined where the reference of a light with area has penumbra, 0.02 < V < 0.98, at a pixel of T.

    The band is all within 2 px of a pixel that faces the light and has penumbra. Errors are |V - V_ref| over T in the band and outside it,
    areas are counts of pixels of T, and noise is V less its 5 x 5 median, over T in the band where the neighborhood is on one object.
    """
    ours, theirs, tested = e.mask, e.reference, e.tested
    penumbra, ours_penumbra = ((v > 0.02) & (v < 0.98) & e.facing for v in (theirs, ours))
    band = distances(penumbra) <= 2
    inside, outside = ((ours - theirs)[tested & part] for part in (band, ~band))
    smooth = tested & band & is_on_one_object(e, 5)
    found = {
        "penumbra_error_mean": mean(np.abs(inside)),
        "penumbra_error_rms": root_mean_square(inside),
        "outside_error_mean": mean(np.abs(outside)),
        "outside_error_rms": root_mean_square(outside),
        "umbra_area_ratio": share((tested & (ours <= 0.02)).sum(), (tested & (theirs <= 0.02)).sum()),
        "penumbra_area_ratio": share((tested & ours_penumbra).sum(), (tested & penumbra).sum()),
        "penumbra_noise": root_mean_square((ours - np.median(windows(ours, 5), axis=-1))[smooth]),
    } | width_and_shift(e)
    return found if e.has_area and (penumbra & tested).any() else dict.fromkeys(found, math.nan)


def penumbra_floors(e):
    """1.1 times how far the metrics of V_half, as if it were the mask, are from the best: 1 of ratios, 0 of errors and of the shift."""
    best = dict.fromkeys(("penumbra_error_mean", "penumbra_error_rms", "outside_error_mean", "outside_error_rms", "penumbra_shift"), 0)
    best |= dict.fromkeys(("umbra_area_ratio", "penumbra_area_ratio", "penumbra_width_ratio"), 1)
    found = penumbra_metrics(replace(e, mask=e.half)) if e.half is not None else dict.fromkeys(best, math.nan)
    return {f"{name}_floor": 1.1 * abs(found[name] - value) for name, value in best.items()}


def measure(e, surfaces=None):
    """Every metric that a mask alone decides, by name; behind glass a mask and the number of surfaces on the way of each pixel."""
    of_light = shadow_area_ratio(e) | received_errors(e) | transmittance_errors(e, surfaces)
    in_scene = meters_between(e) | wrong_area(e)
    return error_rates(e) | displacement(e) | in_scene | binned_rates(e) | of_light | penumbra_metrics(e) | penumbra_floors(e) | likeness(e)


def measure_row(found, channels):
    """Of what is measured of each channel of a row the means, and the hue error of the channels. A gray row has one channel."""
    return {name: sum(of[name] for of in found) / len(found) for name in found[0]} | {"hue_error": hue_error(channels)}
