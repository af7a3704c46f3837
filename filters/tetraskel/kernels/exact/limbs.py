"""Signs of determinants of doubles of any size, exactly, in integers of any length: the last resort.

A number is a row of digits to the base 2**24, lowest first: all but the last in [0, 2**24), the last with the number's
sign. The lengths leave room for every sum and product; a product of two numbers of up to 2**12 digits adds up to less
than 2**61 in every place before its carries are taken. No rounding, overflow or underflow can occur.
"""

from __future__ import annotations

import math

import numpy as np

from tetraskel.kernels.compilation import inner
from tetraskel.kernels.exact.integers import rarely

BITS = 24
MANTISSA = 53
HIGH, LOW = 1100, -1200  # no exponent of a double lies beyond


@inner
def _exponents(values):
    """Largest e such that every value is a whole multiple of 2**e, and an exponent that bounds all."""
    low, high = HIGH, LOW
    for i in range(len(values)):
        if values[i] != 0.0:
            mantissa, exponent = math.frexp(values[i])
            whole = np.int64(mantissa * 2.0**MANTISSA)
            high = max(high, exponent)
            exponent -= MANTISSA
            while whole & 1 == 0:
                whole >>= 1
                exponent += 1
            low = min(low, exponent)
    return low, high


@inner
def _add_double(digits, value, unit, sign):
    """Add sign * value / 2**unit, a whole number; carries are left for later."""
    mantissa, exponent = math.frexp(value)
    whole = np.int64(mantissa * 2.0**MANTISSA)
    shift = exponent - MANTISSA - unit
    if shift < 0:
        whole >>= -shift  # loses no bit: the value is a multiple of the unit
        shift = 0
    place, left = shift // BITS, shift % BITS
    for i in range(3):  # 53 bits; the last part keeps the sign
        part = whole & ((1 << BITS) - 1) if i < 2 else whole
        digits[place + i] += sign * ((part << left) & ((1 << BITS) - 1))
        digits[place + i + 1] += sign * ((part << left) >> BITS)
        whole >>= BITS


@inner
def _carry(digits):
    for i in range(len(digits) - 1):
        over = digits[i] >> BITS
        digits[i] -= over << BITS
        digits[i + 1] += over


@inner
def _clear(digits):
    for i in range(len(digits)):
        digits[i] = 0


@inner
def _add_product(result, a, b, sign):
    """Add sign * a b to a number, for numbers in order; the result is in order too.

    The sign is a 64-bit integer, not a literal: numba would compile the loops anew for each literal.
    """
    for i in range(len(a)):
        if a[i] != 0:
            for j in range(len(b)):
                result[i + j] += sign * a[i] * b[j]
    _carry(result)


@inner
def _differences(points, dim):
    """(r, dim, digits) differences of all points (flat, `dim` coordinates each) to the last one."""
    low, high = _exponents(points)
    n_rows = len(points) // dim - 1
    rows = np.zeros((n_rows, dim, max((high - low) // BITS, 0) + 5), np.int64)
    for row in range(n_rows):
        for axis in range(dim):
            _add_double(rows[row, axis], points[row * dim + axis], low, np.int64(1))
            _add_double(rows[row, axis], points[n_rows * dim + axis], low, np.int64(-1))
            _carry(rows[row, axis])
    return rows


@inner
def _minor(rows, dim, first, result):
    """Add the determinant of two rows of the plane or three of space, from the first one on, round and round."""
    plus, minus = np.int64(1), np.int64(-1)
    i, j, k = first % len(rows), (first + 1) % len(rows), (first + 2) % len(rows)
    if dim == 2:
        _add_product(result, rows[i, 0], rows[j, 1], plus)
        _add_product(result, rows[i, 1], rows[j, 0], minus)
        return
    pair = np.zeros(2 * rows.shape[2] + 1, np.int64)
    for _ in range(3):
        _add_product(pair, rows[i, 0], rows[j, 1], plus)
        _add_product(pair, rows[i, 1], rows[j, 0], minus)
        _add_product(result, pair, rows[k, 2], plus)
        _clear(pair)
        i, j, k = j, k, i


@inner
def determinant_sign(points, dim):
    """Sign of the determinant of the differences of points (flat) to the last one.

    Of d + 2 points in d dimensions, every row has the sum of its squares for one more column.
    """
    rarely()
    rows = _differences(points, dim)
    n_rows, n = rows.shape[0], rows.shape[2]
    whole = np.zeros(6 * n + 8, np.int64)
    if n_rows == dim:
        _minor(rows, dim, np.int64(0), whole)
    else:
        minor, lift = np.zeros(3 * n + 4, np.int64), np.zeros(2 * n + 2, np.int64)
        for row in range(n_rows):
            for axis in range(dim):
                _add_product(lift, rows[row, axis], rows[row, axis], np.int64(1))
            _minor(rows, dim, row + 1, minor)
            # moving a row of four to the front is an odd permutation for every other row; of three never
            _add_product(whole, minor, lift, np.int64(1 if dim == 2 or row % 2 == 1 else -1))
            _clear(minor)
            _clear(lift)
    _carry(whole)
    if whole[len(whole) - 1] < 0:
        return -1
    for i in range(len(whole)):
        if whole[i] != 0:
            return 1
    return 0
