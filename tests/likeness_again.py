"""How alike two pictures look, a second time, beside metrics_again.py: SSIM and FLIP of the shaded pictures of reference and mask."""

import math

import numpy as np
from light_again import exposure, irradiance

PIXELS_PER_DEGREE = 67


def srgb(linear):
    """IEC 61966-2-1, 8 bits."""
    linear = np.clip(linear, 0, 1)
    return np.floor(255 * np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055) + 0.5)


def shaded(e, visibility):
    """The picture of shaded/: albedo (ambient + exposure E V), rounded down to a 4096th, in sRGB, with its background."""
    albedo = np.array([mesh["albedo"] for mesh in e.scene["meshes"]], float)[e.mesh]
    light = float(e.scene["ambient"]) + exposure(e) * irradiance(e) * visibility
    linear = np.floor(4096 * np.clip(albedo * light[..., None], 0, 1)) / 4096
    return np.where((e.mesh < 0)[..., None], (24, 26, 30), srgb(linear))


def along(kernel, size, pads):
    """The matrix that convolves a line of `size` values. With `pads` the rim's values are repeated outside, else only whole windows count."""
    radius = len(kernel) // 2
    matrix = np.zeros((size, size))
    for line in range(size):
        np.add.at(matrix[line], np.clip(np.arange(line - radius, line + radius + 1), 0, size - 1), kernel)
    return matrix if pads else matrix[radius:size - radius]


def filtered(picture, across, down, pads=True):
    """A picture convolved with the kernel down x across."""
    height, width = picture.shape
    return along(down, height, pads) @ picture @ along(across, width, pads).T


def ssim(reference, test):
    """Wang et al. 2004 on luma in 0 .. 1: a Gaussian window of 11 x 11 pixels and sigma 1.5, K1 = 0.01, K2 = 0.03, biased variances."""
    if min(reference.shape[:2]) < 11:
        return math.nan
    window = np.exp(-np.arange(-5, 6) ** 2 / (2 * 1.5**2))
    window /= window.sum()
    x, y = (picture / 255 @ [0.2126, 0.7152, 0.0722] for picture in (reference, test))
    mx, my, xx, yy, xy = (filtered(p, window, window, pads=False) for p in (x, y, x * x, y * y, x * y))
    c1, c2 = 0.01**2, 0.03**2
    return np.mean((2 * mx * my + c1) * (2 * (xy - mx * my) + c2) / ((mx**2 + my**2 + c1) * (xx - mx**2 + yy - my**2 + c2)))


RGB_TO_XYZ = np.array([[10135552 / 24577794, 8788810 / 24577794, 4435075 / 24577794],
                       [2613072 / 12288897, 8788810 / 12288897, 887015 / 12288897],
                       [1425312 / 73733382, 8788810 / 73733382, 70074185 / 73733382]])
WHITE = RGB_TO_XYZ.sum(axis=1)


def opponent(rgb):
    """Linear RGB to Y Cx Cz."""
    x, y, z = np.moveaxis(rgb @ RGB_TO_XYZ.T / WHITE, -1, 0)
    return np.stack([116 * y - 16, 500 * (x - y), 200 * (y - z)])


def hunt_lab(rgb):
    """Linear RGB to L*a*b*, chroma times 0.01 L* (Hunt)."""
    t = rgb @ RGB_TO_XYZ.T / WHITE
    x, y, z = np.moveaxis(np.where(t > (6 / 29) ** 3, np.cbrt(t), t / (3 * (6 / 29) ** 2) + 4 / 29), -1, 0)
    lightness = 116 * y - 16
    return np.stack([lightness, 0.01 * lightness * 500 * (x - y), 0.01 * lightness * 200 * (y - z)])


def perceived(rgb):
    """The picture that the eye sees: opponent channels through their contrast sensitivity, in L*a*b* after Hunt."""
    x = np.arange(-10, 11) / PIXELS_PER_DEGREE  # three sigma of the widest: 3 sqrt(0.04 / (2 pi^2)) degrees
    blurred = []
    for channel, terms in zip(opponent(rgb), ([(1, 0.0047)], [(1, 0.0053)], [(34.1, 0.04), (13.5, 0.025)])):
        kernels = [(a * math.sqrt(math.pi / b), np.exp(-math.pi**2 * x**2 / b)) for a, b in terms]
        whole = sum(a * k.sum() ** 2 for a, k in kernels)
        blurred.append(sum(a * filtered(channel, k, k) for a, k in kernels) / whole)
    y = (blurred[0] + 16) / 116
    xyz = np.stack([y + blurred[1] / 500, y, y - blurred[2] / 200], axis=-1) * WHITE
    return hunt_lab(np.clip(xyz @ np.linalg.inv(RGB_TO_XYZ).T, 0, 1))


def hyab(a, b):
    """Distance of colors: |dL*| + sqrt(da*^2 + db*^2)."""
    return np.abs(a[0] - b[0]) + np.hypot(a[1] - b[1], a[2] - b[2])


def features(rgb):
    """Strengths of edges and of points: first and second derivatives of a Gaussian of 0.082 degrees / 2, each side of a kernel summing to 1."""
    gray, sigma = (opponent(rgb)[0] + 16) / 116, 0.5 * 0.082 * PIXELS_PER_DEGREE
    x = np.arange(-math.ceil(3 * sigma), math.ceil(3 * sigma) + 1)
    gaussian = np.exp(-x**2 / (2 * sigma**2))
    found = []
    smooth = gaussian / gaussian.sum()
    for kernel in (-x * gaussian, (x**2 / sigma**2 - 1) * gaussian):
        kernel = np.where(kernel < 0, kernel / -kernel[kernel < 0].sum(), kernel / kernel[kernel > 0].sum())
        found.append(np.hypot(filtered(gray, kernel, smooth), filtered(gray, smooth, kernel)))
    return found


def flip(reference, test):
    """LDR-FLIP (Andersson et al. 2020), mean over the picture: color difference to the power 1 - feature difference."""
    reference, test = (np.where(p / 255 > 0.04045, ((p / 255 + 0.055) / 1.055) ** 2.4, p / 255 / 12.92) for p in (reference, test))
    difference = hyab(perceived(reference), perceived(test)) ** 0.7
    largest = hyab(hunt_lab(np.array([0.0, 1.0, 0.0])), hunt_lab(np.array([0.0, 0.0, 1.0]))) ** 0.7
    knee = 0.4 * largest
    color = np.where(difference < knee, 0.95 / knee * difference, 0.95 + (difference - knee) / (largest - knee) * 0.05)
    strongest = np.max([np.abs(r - t) for r, t in zip(features(reference), features(test))], axis=0)
    return np.mean(color ** (1 - np.sqrt(strongest / math.sqrt(2))))


def likeness(e):
    """SSIM and FLIP of the shaded pictures of reference and mask."""
    pictures = shaded(e, e.reference), shaded(e, e.mask)
    return {"ssim": ssim(*pictures), "flip": flip(*pictures)}
