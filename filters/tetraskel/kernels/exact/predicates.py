"""On which side: signs of orientation and empty-sphere determinants, exact for every double.

Three stages, each asked only when the one before is not certain:

1. floating point with a bound on its error (Shewchuk 1997, Devillers and Pion 2003: semi-static filters);
2. integers of up to 512 bits, where the coordinate differences are whole multiples of a common power of two below
   2**61 of it (almost always: differences of doubles of like size);
3. integers of any length.

**Error bounds.** With the unit roundoff u = 2**-53, every monomial of the fully expanded determinant reaches the
result multiplied by at most k factors (1 + d), |d| <= u, so the error is at most ((1 + u)**k - 1) times the sum of the
monomials' sizes (Higham 2002, section 3.1). With X, Y, Z bounds of the sizes of the differences along each axis and
L = X**2 + Y**2 (+ Z**2):

=========  =====================================================================  =============  ==========
sign       roundings k of a monomial                                              monomials      bound
=========  =====================================================================  =============  ==========
area       2 differences, 1 product, 1 sum: 4                                     2 X Y          9 u X Y
volume     3 differences, 2 of a minor, 1 product, 2 sums: 8                      6 X Y Z        49 u X Y Z
circle     4 differences, 2 of a minor, 2 of a lift, 1 product, 2 sums: 11        6 X Y L        67 u X Y L
sphere     5 differences, 2 of a minor, 3 of a volume, 3 of a lift, 1 product,    24 X Y Z L     410 u X Y Z L
           3 sums: 17
=========  =====================================================================  =============  ==========

The constants are k times the monomials' number, and a little more for the roundings of the bound itself and of X, Y, Z.
The *static* filter takes X, Y, Z once from the whole cloud; the *semi-static* one from the differences at hand.
A bound whose X, Y or Z is below `SMALL` is not used: products could lose bits to underflow. Above it every partial
product is above 2**-900, and what underflow can do to one, 2**-1075, is nothing beside u times it.

**Ties** (Devillers and Teillaud 2011). The lifted height of each point is raised by an infinitesimal amount, infinitely
larger for the lexicographically larger of two points. The sphere determinant is linear in the heights, so where it is 0
the largest point whose cofactor is not 0 decides; the cofactor is the orientation of the other four. The coordinates
are not moved: no simplex is flat, and every triangulation is the regular one of generic heights, which is unique.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from tetraskel.kernels.compilation import inlined, inner
from tetraskel.kernels.exact import integers, limbs

Floats = NDArray[np.float64]

ROUNDOFF = 2.0**-53
AREA, VOLUME, CIRCLE, SPHERE = 9 * ROUNDOFF, 49 * ROUNDOFF, 67 * ROUNDOFF, 410 * ROUNDOFF
SMALL = 2.0**-170
HIGHEST = 61  # bits of the integers of stage 2
NEVER = np.inf  # a static bound that certifies nothing


def static_bounds(points: Floats) -> tuple[float, float]:
    """Bounds of the static filters of a cloud (n, d): of the orientation and of the empty sphere."""
    size = np.ptp(points, axis=0) * (1 + 2 * ROUNDOFF)
    if size.min() < SMALL:
        return NEVER, NEVER
    lift = float((size**2).sum())
    flat = len(size) == 2
    return float(size.prod()) * (AREA if flat else VOLUME), float(size.prod()) * lift * (CIRCLE if flat else SPHERE)


@inlined
def orient2(ax, ay, bx, by, cx, cy, bound):
    """Sign of the doubled area of a triangle: 1 counter-clockwise, 0 flat."""
    ux, uy, vx, vy = bx - ax, by - ay, cx - ax, cy - ay
    value = ux * vy - uy * vx
    if value > bound:
        return 1
    if value < -bound:
        return -1
    x, y = max(abs(ux), abs(vx)), max(abs(uy), abs(vy))
    limit = AREA * x * y
    if min(x, y) > SMALL and abs(value) > limit:
        return 1 if value > 0.0 else -1
    return _orient2_exactly(bx, by, cx, cy, ax, ay)


@inlined
def orient3(ax, ay, az, bx, by, bz, cx, cy, cz, dx, dy, dz, bound):
    """Sign of det(b - a, c - a, d - a): 1 for a positively oriented tetrahedron, 0 for a flat one."""
    ux, uy, uz = bx - ax, by - ay, bz - az
    vx, vy, vz = cx - ax, cy - ay, cz - az
    wx, wy, wz = dx - ax, dy - ay, dz - az
    value = uz * (vx * wy - vy * wx) + vz * (wx * uy - wy * ux) + wz * (ux * vy - uy * vx)
    if value > bound:
        return 1
    if value < -bound:
        return -1
    x = max(abs(ux), max(abs(vx), abs(wx)))
    y = max(abs(uy), max(abs(vy), abs(wy)))
    z = max(abs(uz), max(abs(vz), abs(wz)))
    if min(x, min(y, z)) > SMALL and abs(value) > VOLUME * x * y * z:
        return 1 if value > 0.0 else -1
    return _orient3_exactly(bx, by, bz, cx, cy, cz, dx, dy, dz, ax, ay, az)


@inlined
def in_circle(ax, ay, bx, by, cx, cy, px, py, bounds):
    """Whether p lies in the perturbed circle through a counter-clockwise triangle."""
    ux, uy, vx, vy, wx, wy = ax - px, ay - py, bx - px, by - py, cx - px, cy - py
    value = (
        (ux * ux + uy * uy) * (vx * wy - vy * wx)
        + (vx * vx + vy * vy) * (wx * uy - wy * ux)
        + (wx * wx + wy * wy) * (ux * vy - uy * vx)
    )
    if value > bounds[1]:
        return True
    if value < -bounds[1]:
        return False
    x = max(abs(ux), max(abs(vx), abs(wx)))
    y = max(abs(uy), max(abs(vy), abs(wy)))
    if min(x, y) > SMALL and abs(value) > CIRCLE * (x * y) * (x * x + y * y):
        return value > 0.0
    sign = _circle_exactly(ax, ay, bx, by, cx, cy, px, py)
    if sign != 0:
        return sign > 0
    return _in_tied_circle(ax, ay, bx, by, cx, cy, px, py, bounds[0])


@inlined
def sphere_value(ux, uy, uz, vx, vy, vz, wx, wy, wz, tx, ty, tz):
    """Floating-point determinant of the empty-sphere test, from the differences to the point asked about."""
    uv, vw, wt = ux * vy - vx * uy, vx * wy - wx * vy, wx * ty - tx * wy
    tu, uw, vt = tx * uy - ux * ty, ux * wy - wx * uy, vx * ty - tx * vy
    uvw = uz * vw - vz * uw + wz * uv
    vwt = vz * wt - wz * vt + tz * vw
    wtu = wz * tu + tz * uw + uz * wt
    tuv = tz * uv + uz * vt + vz * tu
    u, v = ux * ux + uy * uy + uz * uz, vx * vx + vy * vy + vz * vz
    w, t = wx * wx + wy * wy + wz * wz, tx * tx + ty * ty + tz * tz
    return (u * vwt - v * wtu) + (w * tuv - t * uvw)


@inlined
def in_sphere(ax, ay, az, bx, by, bz, cx, cy, cz, dx, dy, dz, px, py, pz, bounds):
    """Whether p lies in the perturbed sphere through a positively oriented tetrahedron."""
    value = sphere_value(
        ax - px, ay - py, az - pz, bx - px, by - py, bz - pz, cx - px, cy - py, cz - pz, dx - px, dy - py, dz - pz
    )
    if value > bounds[1]:
        return True
    if value < -bounds[1]:
        return False
    return _in_sphere_closely(ax, ay, az, bx, by, bz, cx, cy, cz, dx, dy, dz, px, py, pz, value, bounds[0])


@inner
def _in_sphere_closely(ax, ay, az, bx, by, bz, cx, cy, cz, dx, dy, dz, px, py, pz, value, bound):
    integers.rarely()
    x = max(max(abs(ax - px), abs(bx - px)), max(abs(cx - px), abs(dx - px)))
    y = max(max(abs(ay - py), abs(by - py)), max(abs(cy - py), abs(dy - py)))
    z = max(max(abs(az - pz), abs(bz - pz)), max(abs(cz - pz), abs(dz - pz)))
    if min(x, min(y, z)) > SMALL and abs(value) > SPHERE * (x * y * z) * (x * x + y * y + z * z):
        return value > 0.0
    sign = _sphere_exactly(ax, ay, az, bx, by, bz, cx, cy, cz, dx, dy, dz, px, py, pz)
    if sign != 0:
        return sign > 0
    return _in_tied_sphere(ax, ay, az, bx, by, bz, cx, cy, cz, dx, dy, dz, px, py, pz, bound)


@inlined
def as_integer(p, q, scale, back):
    """(p - q) * scale as an integer, and whether that is exact.

    The difference is the rounded one and what rounding took off, both exact (Knuth's two-sum; Shewchuk 1997, theorem
    7). `back` is 1 / scale: it shows bits lost to fractions and to underflow alike.
    """
    high = p - q
    shadow = p - high
    low = (p - (high + shadow)) + (shadow - q)
    first, second = np.int64(high * scale), np.int64(low * scale)
    return first + second, first * back == high and second * back == low


@inlined
def power_of_two(size):
    """The power of two that takes differences of up to `size` to below 2**60, and its inverse; 0 if there is none."""
    exponent = math.frexp(size)[1]
    if not -900 < exponent < 900:
        return 0.0, 0.0
    return math.ldexp(1.0, HIGHEST - 1 - exponent), math.ldexp(1.0, exponent - HIGHEST + 1)


@inner
def _orient2_exactly(ax, ay, bx, by, cx, cy):
    """Sign of det(a - c, b - c)."""
    integers.rarely()
    size = max(max(abs(ax - cx), abs(ay - cy)), max(abs(bx - cx), abs(by - cy)))
    scale, back = power_of_two(size)
    a, a_fits = as_integer(ax, cx, scale, back)
    b, b_fits = as_integer(ay, cy, scale, back)
    c, c_fits = as_integer(bx, cx, scale, back)
    d, d_fits = as_integer(by, cy, scale, back)
    if scale != 0.0 and a_fits and b_fits and c_fits and d_fits:
        return integers.area_sign(a, b, c, d)
    return limbs.determinant_sign(np.array([ax, ay, bx, by, cx, cy]), 2)


@inner
def _orient3_exactly(ax, ay, az, bx, by, bz, cx, cy, cz, dx, dy, dz):
    """Sign of det(a - d, b - d, c - d)."""
    integers.rarely()
    size = max(max(abs(ax - dx), max(abs(ay - dy), abs(az - dz))), max(abs(bx - dx), max(abs(by - dy), abs(bz - dz))))
    size = max(size, max(abs(cx - dx), max(abs(cy - dy), abs(cz - dz))))
    scale, back = power_of_two(size)
    a, a_fits = as_integer(ax, dx, scale, back)
    b, b_fits = as_integer(ay, dy, scale, back)
    c, c_fits = as_integer(az, dz, scale, back)
    d, d_fits = as_integer(bx, dx, scale, back)
    e, e_fits = as_integer(by, dy, scale, back)
    f, f_fits = as_integer(bz, dz, scale, back)
    g, g_fits = as_integer(cx, dx, scale, back)
    h, h_fits = as_integer(cy, dy, scale, back)
    i, i_fits = as_integer(cz, dz, scale, back)
    fits = a_fits and b_fits and c_fits and d_fits and e_fits and f_fits and g_fits and h_fits and i_fits
    if scale != 0.0 and fits:
        return integers.volume_sign(a, b, c, d, e, f, g, h, i)
    return limbs.determinant_sign(np.array([ax, ay, az, bx, by, bz, cx, cy, cz, dx, dy, dz]), 3)


@inner
def _circle_exactly(ax, ay, bx, by, cx, cy, dx, dy):
    integers.rarely()
    size = max(max(abs(ax - dx), abs(ay - dy)), max(abs(bx - dx), abs(by - dy)))
    scale, back = power_of_two(max(size, max(abs(cx - dx), abs(cy - dy))))
    a, a_fits = as_integer(ax, dx, scale, back)
    b, b_fits = as_integer(ay, dy, scale, back)
    c, c_fits = as_integer(bx, dx, scale, back)
    d, d_fits = as_integer(by, dy, scale, back)
    e, e_fits = as_integer(cx, dx, scale, back)
    f, f_fits = as_integer(cy, dy, scale, back)
    if scale != 0.0 and a_fits and b_fits and c_fits and d_fits and e_fits and f_fits:
        return integers.circle_sign(a, b, c, d, e, f)
    return limbs.determinant_sign(np.array([ax, ay, bx, by, cx, cy, dx, dy]), 2)


@inner
def _sphere_exactly(ax, ay, az, bx, by, bz, cx, cy, cz, dx, dy, dz, ex, ey, ez):
    integers.rarely()
    size = max(max(abs(ax - ex), max(abs(ay - ey), abs(az - ez))), max(abs(bx - ex), max(abs(by - ey), abs(bz - ez))))
    size = max(size, max(abs(cx - ex), max(abs(cy - ey), abs(cz - ez))))
    size = max(size, max(abs(dx - ex), max(abs(dy - ey), abs(dz - ez))))
    scale, back = power_of_two(size)
    a, a_fits = as_integer(ax, ex, scale, back)
    b, b_fits = as_integer(ay, ey, scale, back)
    c, c_fits = as_integer(az, ez, scale, back)
    d, d_fits = as_integer(bx, ex, scale, back)
    e, e_fits = as_integer(by, ey, scale, back)
    f, f_fits = as_integer(bz, ez, scale, back)
    g, g_fits = as_integer(cx, ex, scale, back)
    h, h_fits = as_integer(cy, ey, scale, back)
    i, i_fits = as_integer(cz, ez, scale, back)
    j, j_fits = as_integer(dx, ex, scale, back)
    k, k_fits = as_integer(dy, ey, scale, back)
    m, m_fits = as_integer(dz, ez, scale, back)
    fits = a_fits and b_fits and c_fits and d_fits and e_fits and f_fits
    fits = fits and g_fits and h_fits and i_fits and j_fits and k_fits and m_fits
    if scale != 0.0 and fits:
        return integers.sphere_sign(a, b, c, d, e, f, g, h, i, j, k, m)
    points = np.array([ax, ay, az, bx, by, bz, cx, cy, cz, dx, dy, dz, ex, ey, ez])
    return -limbs.determinant_sign(points, 3)


@inner
def _in_tied_circle(ax, ay, bx, by, cx, cy, px, py, bound):
    """The perturbation's answer for four points of one circle."""
    integers.rarely()
    xs, ys = (ax, bx, cx, px), (ay, by, cy, py)
    done = np.int64(0)  # not a literal, which would compile what is called once more
    for _ in range(3):
        top = _largest2(xs, ys, done)
        done |= 1 << top
        if top == 3:
            return False
        if top == 0:
            side = orient2(px, py, bx, by, cx, cy, bound)
        elif top == 1:
            side = orient2(ax, ay, px, py, cx, cy, bound)
        else:
            side = orient2(ax, ay, bx, by, px, py, bound)
        if side != 0:
            return side > 0
    return False


@inner
def _largest2(xs, ys, done):
    top = -1
    for i in range(4):
        if not (done >> i) & 1 and (top < 0 or xs[i] > xs[top] or (xs[i] == xs[top] and ys[i] > ys[top])):
            top = i
    return top


@inner
def _in_tied_sphere(ax, ay, az, bx, by, bz, cx, cy, cz, dx, dy, dz, px, py, pz, bound):
    """The perturbation's answer for five points of one sphere."""
    integers.rarely()
    xs, ys, zs = (ax, bx, cx, dx, px), (ay, by, cy, dy, py), (az, bz, cz, dz, pz)
    done = np.int64(0)  # not a literal, which would compile what is called once more
    for _ in range(4):
        top = _largest3(xs, ys, zs, done)
        done |= 1 << top
        if top == 4:
            return False
        if top == 0:
            side = orient3(px, py, pz, bx, by, bz, cx, cy, cz, dx, dy, dz, bound)
        elif top == 1:
            side = orient3(ax, ay, az, px, py, pz, cx, cy, cz, dx, dy, dz, bound)
        elif top == 2:
            side = orient3(ax, ay, az, bx, by, bz, px, py, pz, dx, dy, dz, bound)
        else:
            side = orient3(ax, ay, az, bx, by, bz, cx, cy, cz, px, py, pz, bound)
        if side != 0:
            return side > 0
    return False


@inner
def _largest3(xs, ys, zs, done):
    top = -1
    for i in range(5):
        if (done >> i) & 1:
            continue
        beyond = ys[i] > ys[top] or (ys[i] == ys[top] and zs[i] > zs[top])
        if top < 0 or xs[i] > xs[top] or (xs[i] == xs[top] and beyond):
            top = i
    return top
