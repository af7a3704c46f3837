"""Signs of determinants of 64-bit integers, exactly, in wide integers of the processor's compiler.

LLVM computes with integers of any width; numba does not show them, so each determinant is written down here in LLVM's
terms. Entries below 2**61 in size leave room: a 2 x 2 minor is below 2**123 and fits 128 bits, a 3 x 3 one below 2**186
fits 256, a sum of squares below 2**124 fits 128, and the 4 x 4 determinant of the empty-sphere test, four products of
the last two, is below 2**312 and fits 512.
"""

from __future__ import annotations

from llvmlite import ir
from numba.core import types
from numba.extending import intrinsic


class Wide:
    """Arithmetic on LLVM integers, every result in a stated number of bits."""

    def __init__(self, builder):
        self.builder = builder

    def extend(self, value, bits):
        """The same number in more bits."""
        return value if value.type.width == bits else self.builder.sext(value, ir.IntType(bits))

    def times(self, a, b, bits):
        """Product."""
        return self.builder.mul(self.extend(a, bits), self.extend(b, bits))

    def cross(self, a, b, c, d, bits):
        """The 2 x 2 determinant a d - b c."""
        return self.builder.sub(self.times(a, d, bits), self.times(b, c, bits))

    def total(self, values):
        """Sum of values of one width."""
        whole = values[0]
        for value in values[1:]:
            whole = self.builder.add(whole, value)
        return whole

    def sign(self, value):
        """-1, 0 or 1 as a 64-bit integer."""
        zero = ir.Constant(value.type, 0)
        above = self.builder.zext(self.builder.icmp_signed(">", value, zero), ir.IntType(64))
        below = self.builder.zext(self.builder.icmp_signed("<", value, zero), ir.IntType(64))
        return self.builder.sub(above, below)

    def squares(self, row, bits):
        """Sum of the squares of a row."""
        return self.total([self.times(x, x, bits) for x in row])

    def volume(self, a, b, c, bits):
        """The 3 x 3 determinant with rows a, b, c, from the minors of the first two columns."""
        minors = [self.cross(p[0], p[1], q[0], q[1], 128) for p, q in ((b, c), (c, a), (a, b))]
        return self.total([self.times(row[2], minor, bits) for row, minor in zip((a, b, c), minors, strict=True)])


def _signature(count):
    return types.int64(*[types.int64] * count)


@intrinsic
def rarely(typing_context):
    """Keep the function that calls this out of its callers: it is long and seldom needed."""

    def generate(context, builder, signature, args):
        builder.function.attributes.add("noinline")
        return context.get_dummy_value()

    return types.void(), generate


@intrinsic
def area_sign(typing_context, ax, ay, bx, by):
    """Sign of the determinant of two vectors."""

    def generate(context, builder, signature, args):
        wide = Wide(builder)
        return wide.sign(wide.cross(*args, 128))

    return _signature(4), generate


@intrinsic
def volume_sign(typing_context, ax, ay, az, bx, by, bz, cx, cy, cz):
    """Sign of the determinant of three vectors."""

    def generate(context, builder, signature, args):
        wide = Wide(builder)
        return wide.sign(wide.volume(args[0:3], args[3:6], args[6:9], 256))

    return _signature(9), generate


@intrinsic
def circle_sign(typing_context, ax, ay, bx, by, cx, cy):
    """Sign of the determinant with the rows (x, y, x**2 + y**2) of three vectors."""

    def generate(context, builder, signature, args):
        wide = Wide(builder)
        a, b, c = args[0:2], args[2:4], args[4:6]
        terms = [
            wide.times(wide.squares(p, 128), wide.cross(*q, *r, 128), 256)
            for p, q, r in ((a, b, c), (b, c, a), (c, a, b))
        ]
        return wide.sign(wide.total(terms))

    return _signature(6), generate


@intrinsic
def sphere_sign(typing_context, ax, ay, az, bx, by, bz, cx, cy, cz, dx, dy, dz):
    """Sign of the determinant with the rows (x, y, z, x**2 + y**2 + z**2) of four vectors, times -1."""

    def generate(context, builder, signature, args):
        wide = Wide(builder)
        a, b, c, d = args[0:3], args[3:6], args[6:9], args[9:12]
        # expansion along the last column; (b, d, c) is (b, c, d) with its sign turned
        terms = [
            wide.times(wide.squares(p, 128), wide.volume(*rows, 256), 512)
            for p, rows in ((a, (b, c, d)), (b, (a, d, c)), (c, (a, b, d)), (d, (a, c, b)))
        ]
        return wide.sign(wide.total(terms))

    return _signature(12), generate
