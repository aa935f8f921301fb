"""Light a second time, beside metrics_again.py: what surfaces receive without casters, and how pictures are exposed, from docs/method.md and docs/scenes.md."""

import numpy as np


def cosine(e):
    """N.l with l the unit vector to the light, of one with area to its center."""
    if e.light["kind"] == "directional":
        way = np.broadcast_to(-np.array(e.light["direction"], float), e.position.shape)
    else:
        way = np.array(e.light.get("position", e.light.get("center")), float) - e.position
    return (e.normal * way).sum(axis=-1) / np.linalg.norm(way, axis=-1)


def unit(v):
    return v / np.linalg.norm(v, axis=-1, keepdims=True)


def dot(a, b):
    return (a * b).sum(axis=-1)


def edge_integral(a, b, n):
    """Lambert's half of the angle between a and b, times the part of n across both."""
    across = np.cross(a, b)
    sine = np.linalg.norm(across, axis=-1)
    return np.where(sine > 0, np.arctan2(sine, dot(a, b)) * dot(n, across) / np.where(sine > 0, sine, 1) / 2, 0)


def disc_integral(center, axis, radius, n):
    """The same along the rim of a disc, as far as it is above the horizon, and back along the horizon; one disc for each point."""
    some = np.where(np.abs(axis[..., :1]) < 0.9, (1.0, 0, 0), (0, 1.0, 0))
    u = unit(np.cross(axis, some)) * radius[..., None]
    v = np.cross(axis, u)
    rise = np.hypot(dot(n, u), dot(n, v))
    low = np.clip(-dot(n, center) / np.where(rise > 0, rise, 1), -1, 1)
    end, turn = np.where(rise > 0, np.arccos(low), np.pi * (dot(n, center) > 0)), np.arctan2(dot(n, v), dot(n, u))
    nodes, weights = np.polynomial.legendre.leggauss(96)
    total = np.zeros(end.shape)

    def rim(angle):
        return center + np.cos(angle)[..., None] * u + np.sin(angle)[..., None] * v

    for node, weight in zip(nodes, weights):
        angle = turn + node * end
        r, onward = rim(angle), np.cos(angle)[..., None] * v - np.sin(angle)[..., None] * u
        total += weight * end * dot(n, np.cross(r, onward)) / dot(r, r) / 2
    return np.abs(total + np.where((low > -1) & (low < 1), edge_integral(rim(turn + end), rim(turn - end), n), 0))


def irradiance(e):
    """Of every pixel without casters, W/m2."""
    light, n = e.light, e.normal.astype(float)
    kind, intensity = light["kind"], float(light["intensity"])
    if kind in ("point", "spot", "directional"):
        value = intensity * np.maximum(0, cosine(e))
        if kind != "directional":
            way = e.position - np.array(light["position"], float)
            value = value / dot(way, way)
        if kind == "spot":
            along = dot(unit(way), unit(np.array(light["direction"], float)))
            inner, outer = (np.cos(np.radians(light[of])) for of in ("inner_degrees", "outer_degrees"))
            fading = (along - outer) / (inner - outer) if inner > outer else 1
            value = value * np.where(along >= inner, 1, np.where(along > outer, fading, 0)) ** 2
        return np.where(e.mesh < 0, 0, value)
    center = np.array(light["center"], float) - e.position
    if kind == "rect":
        u, v = np.array(light["half_u"], float), np.array(light["half_v"], float)
        axis, corners = np.cross(u, v), [center + s * u + t * v for s, t in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
        value, leaves, enters = np.zeros(e.mesh.shape), np.zeros(center.shape), np.zeros(center.shape)
        for a, b in zip(corners, corners[1:] + corners[:1]):
            high_a, high_b = dot(n, a), dot(n, b)
            cut = a + (high_a / np.where(high_a == high_b, 1, high_a - high_b))[..., None] * (b - a)
            first, last = np.where((high_a >= 0)[..., None], a, cut), np.where((high_b >= 0)[..., None], b, cut)
            value += np.where((high_a > 0) | (high_b > 0), edge_integral(first, last, n), 0)
            leaves += np.where(((high_a >= 0) & (high_b < 0))[..., None], cut, 0)
            enters += np.where(((high_a < 0) & (high_b >= 0))[..., None], cut, 0)
        value = np.abs(value + edge_integral(leaves, enters, n))
    elif kind == "disc":
        axis = np.array(light["normal"], float)
        value = disc_integral(center, np.broadcast_to(unit(axis), center.shape), np.full(e.mesh.shape, float(light["radius"])), n)
    else:
        square, axis = dot(center, center), None
        share = np.minimum(float(light["radius"]) ** 2 / square, 1)
        value = disc_integral(center * (1 - share)[..., None], unit(center), float(light["radius"]) * np.sqrt(1 - share), n)
        value = np.where(share < 1, value, 0)
    if axis is not None and light.get("one_sided"):
        value = np.where(dot(center, axis) < 0, value, 0)
    return np.where(e.mesh < 0, 0, intensity * value)


def exposure(e):
    """The view's own, or one over what a tenth of the lit pixels receives more than."""
    if e.view.get("exposure"):
        return float(e.view["exposure"])
    received = irradiance(e)
    lit = np.sort(received[received > 0])
    share = 1 - float(e.scene["ambient"]) if e.scene["ambient"] < 1 else 1
    return share / lit[len(lit) - 1 - len(lit) // 10] if len(lit) else 1.0
