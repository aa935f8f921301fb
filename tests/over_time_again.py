"""The metrics over the frames of a row a second time: in float64, from docs/method.md, with no code of the program.

`nan` stands for what is not defined, which is `null` in a record.
"""

import math

import numpy as np
from metrics_again import root_mean_square, share


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
    """Every metric of a row that its frames have together. Pixels are compared while they show one surface point and are T."""
    mask, reference, tested = (np.array([getattr(frame, of) for frame in frames]) for of in ("mask", "reference", "tested"))
    point = np.array([np.dstack([frame.position, frame.mesh]) for frame in frames])
    linked = (point[1:] == point[:-1]).all(axis=-1) & tested[1:] & tested[:-1]
    error, throughout = mask - reference, linked.all(axis=0)
    found = {}
    for name, sixtieths in (("flicker_1_60", 1), ("flicker_1_15", 4), ("flicker_1_4", 15)):
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
