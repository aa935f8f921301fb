"""The metrics over the frames of a row a second time: in float64, from docs/method.md, with no code of the program.

`nan` stands for what is not defined, which is `null` in a record.
"""

import math

import numpy as np
from metrics_again import eye_rays, root_mean_square, share

LAGS = (("flicker_1_60", 1), ("flicker_1_15", 4), ("flicker_1_4", 15))  # sixtieths of a second


def side_changes(values, linked):
    """By pair of a frame and the next one: 1 where a compared pixel becomes lit, -1 where it becomes dark, else 0."""
    return np.diff((values > 0.5).astype(int), axis=0) * linked


def late_and_false(ours, theirs, linked, window):
    """How many flips of the mask belong to a flip of the reference in another frame, and how many to none.

    Flips belong together that go the same way at a pixel at most `window` frames apart, with all frames between compared. The nearest
    pair comes first, and each flip is in one pair at most.
    """
    late, false = 0, 0
    for pixel in np.argwhere((ours != 0).any(axis=0)):
        here = (slice(None), *pixel)
        for way in (1, -1):
            a, b = (list(np.flatnonzero(flips[here] == way)) for flips in (ours, theirs))
            pairs = sorted((abs(s - t), s, t) for s in a for t in b
                           if abs(s - t) <= window and linked[here][min(s, t):max(s, t) + 1].all())
            for distance, s, t in pairs:
                if s in a and t in b:
                    a.remove(s)
                    b.remove(t)
                    late += distance > 0
            false += len(a)
    return late, false


def over_time(frames, frame_rate):
    """Every metric of a row that its frames have together, where the camera stands still.

    Pixels are compared while they show one surface point and are T.
    """
    mask, reference, tested = (np.array([getattr(frame, of) for frame in frames]) for of in ("mask", "reference", "tested"))
    point = np.array([np.dstack([frame.position, frame.mesh]) for frame in frames])
    linked = (point[1:] == point[:-1]).all(axis=-1) & tested[1:] & tested[:-1]
    error, throughout = mask - reference, linked.all(axis=0)
    found = {}
    for name, sixtieths in LAGS:
        lag = int(sixtieths * frame_rate / 60)
        changes = [(error[t + lag] - error[t])[linked[t:t + lag].all(axis=0)] for t in range(len(frames) - lag)]
        is_defined = frame_rate % 60 == 0 and sum(map(len, changes)) > 0
        found[name] = root_mean_square(np.concatenate(changes)) if is_defined else math.nan
    found["temporal_sd"] = math.sqrt(error[:, throughout].var(axis=0).mean()) if throughout.any() else math.nan
    ours, theirs = side_changes(mask, linked), side_changes(reference, linked)
    late, false = late_and_false(ours, theirs, linked, int(frame_rate / 10))
    pixel_seconds = linked.sum() / frame_rate
    return found | {"late_flips": share(late, pixel_seconds), "false_flips": share(false, pixel_seconds),
                    "steady_share": share(throughout.sum(), tested[0].sum())}


def shown_before(now, before):
    """Which pixels of a frame are compared with one of an earlier frame of another camera, and the row and column of that one.

    It is the pixel whose center is the nearest to where the point P is in the earlier picture. Both are T and show one triangle, the earlier eye is
    on the side of P's normal, and the earlier pixel's point is within the width of a pixel of the plane through P.
    """
    eye, rays, side = eye_rays(before, 0, 0)
    height, width = before.mesh.shape
    across, down = rays[0, -1] - rays[0, 0], rays[-1, 0] - rays[0, 0]
    forward = rays.mean(axis=(0, 1))
    away = now.position - eye
    depth = away @ forward
    with np.errstate(divide="ignore", invalid="ignore"):
        x = np.floor(away @ across / np.linalg.norm(across) / depth / side + width / 2)
        y = np.floor(away @ down / np.linalg.norm(down) / depth / side + height / 2)
    inside = (depth > 0) & (x >= 0) & (x < width) & (y >= 0) & (y < height)
    q = tuple(np.where(inside, at, 0).astype(int) for at in (y, x))
    to_plane = np.abs((now.normal * (before.position[q] - now.position)).sum(axis=-1))
    found = inside & now.tested & before.tested[q] & (now.mesh == before.mesh[q]) & (now.triangle == before.triangle[q])
    return found & ((now.normal * away).sum(axis=-1) < 0) & (to_plane <= side * depth), q


def over_time_of_camera(frames, frame_rate):
    """The same where the camera moves: flicker, and the share of pixels that it compares at the shortest lag."""
    found = dict.fromkeys(over_time(frames[:1], frame_rate), math.nan)
    if frame_rate % 60:
        return found
    error = [frame.mask - frame.reference for frame in frames]
    for name, sixtieths in LAGS:
        lag = int(sixtieths * frame_rate / 60)
        changes, tested = [np.empty(0)], 0
        for t in range(lag, len(frames)):
            compared, q = shown_before(frames[t], frames[t - lag])
            changes.append((error[t] - error[t - lag][q])[compared])
            tested += frames[t].tested.sum()
        every = np.concatenate(changes)
        found[name] = root_mean_square(every) if every.size else math.nan
        if sixtieths == 1:
            found["steady_share"] = share(every.size, tested)
    return found
