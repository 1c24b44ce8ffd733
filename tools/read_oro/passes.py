"""Passes: parameters, prediction, residuals."""

import numpy as np

from basics import SEEN, U32, require
from planes import C, GROUPS, H, TAPS, V, Known, join, plane_size
from symbols import shipped_filter


class TileRule:
    """What is the same in all passes of a tile."""

    def __init__(self, step, range_bits, serial):
        self.step, self.serial, self.wide = step, serial, range_bits > 31
        length = step.bit_length()
        self.coarse = max(0, length - 6, min(range_bits, 55) - 24)
        self.mantissa = min((1 << 31 + length) // step, U32)
        self.down = 37 + length - self.coarse

    def word(self, a):
        """W of a number, or of an array of 64-bit numbers."""
        if not self.wide:
            return (a + (1 << 31) & U32) - (1 << 31)
        return a if isinstance(a, np.ndarray) else (a + (1 << 63) & (1 << 64) - 1) - (1 << 63)

    def cap(self, m):
        return np.minimum((np.minimum(m, 1 << 29) << 2) >> self.coarse, 1 << 20)


def magnitude(a):
    # The magnitude of -2^63 is right as an unsigned number.
    return np.minimum(np.abs(a).astype(np.uint64), U32).astype(np.int64)


class Parameters:
    def __init__(self, side, kind, serial):
        taps = len(TAPS[kind]) + 2 * serial
        self.shape, self.shift = side.bits(1), side.bits(3) - 3
        require(32, self.shift <= 3)
        if side.bits(1):
            count = side.bits(1) + 1
            SEEN.update({"own filters", "two classes"} if count == 2 else {"own filters"})
            self.filters = []
            for _ in range(count):
                self.filters.append([side.signed(5) + (256 if tap < 4 else 0) for tap in range(taps)])
                require(32, max(map(abs, self.filters[-1])) <= 8191)
        else:
            SEEN.add("filter of the set")
            self.filters = [shipped_filter(serial, kind, side.bits(2))[0][:taps]]
        if side.bits(1):
            SEEN.add("own error weights")
            codes = [side.bits(6) for _ in range(9)]
            require(32, max(codes) <= 41)
        else:
            SEEN.add("error weights of the set")
            codes = shipped_filter(serial, kind, side.bits(2))[1]
        SEEN.add(f"shape {self.shape}")
        self.errors = [0 if n == 0 else (4 + (n - 1) % 4 << (n - 1) // 4) >> 2 for n in codes]


def prepare(kind, row, cells, errors, p, rule):
    """Base, class, deviation and expected error of a row, without what serial tiles add."""
    w, near = rule.word, [cells.run(tap, row) for tap in TAPS[kind][:4]]
    a, b, c, d = near
    base = w(a + (w(b - a + c - a + d - a) >> 2))
    spread = sum(magnitude(w(x - base)) >> 2 for x in near)
    if kind == C:
        across, along = w(a + d - b - c), magnitude(w(a - d)) + magnitude(w(b - c))
    else:
        across, along = w(a + b - c - d), magnitude(w(a - b)) + magnitude(w(c - d))
    steep = np.minimum(along, U32) > min(2 * rule.step, U32)
    classes = steep.astype(int) if len(p.filters) == 2 else np.zeros(len(base), int)
    deviations = []
    for weights in p.filters:
        sums = sum(weight * w(cells.run(tap, row) - base) for tap, weight in zip(TAPS[kind], weights))
        deviations.append(w(sums))
    deviation = np.choose(classes, deviations)

    v = p.errors
    sums = v[8] * int(rule.cap(min(rule.step, U32))) + v[3] * rule.cap(spread)
    sums += v[4] * rule.cap(magnitude(across) >> 1)
    for weight, group in zip(v, GROUPS[kind]):
        sums += weight * sum(errors.run(tap, row) for tap in group)
    above = [errors.run(("O", -1, col), row) for col in (-1, 0, 1)]
    sums += v[5] * (above[0] + 2 * above[1] + above[2])
    return base.tolist(), classes.tolist(), deviation.tolist(), (sums & U32).tolist()


def residual(table_base, rest, expected, rule, symbols, raw_bits, shift):
    e = expected * rule.mantissa >> rule.down | 4
    o = e.bit_length() - 3
    bucket = 4 * o + (e >> o & 3)
    raw = max(bucket - 24, 0) // 4
    if rule.step == 1:
        kind = min(abs(rest) >> 7, 3)
    else:
        kind = 4 + min(abs(rest) // 184, 2) if rule.step == 3 else 7
    b = bucket if bucket < 28 else 24 + bucket % 4
    s = symbols.symbol((table_base + kind) * 28 + max(0, min(b + shift, 27)))
    k = s - 31
    if s == 63:
        SEEN.add("escape")
        k = raw_bits.signed(6)
    if raw:
        SEEN.add("raw bits")
        k = (k << raw) + raw_bits.bits(raw)
    return -k if rule.step <= 3 and rest < 0 else k


def i64(a):
    return (a + (1 << 63) & (1 << 64) - 1) - (1 << 63)


def run_pass(kind, cells, errors, voids, p, rule, symbols, raw_bits):
    """Makes the cells and errors of a pass; both know what there is already."""
    w, step, coarse, serial = rule.word, rule.step, rule.coarse, rule.serial
    for row in range(cells.height):
        cells.begin_row(row)
        errors.begin_row(row)
        base, classes, deviation, expected = prepare(kind, row, cells, errors, p, rule)
        nearest = errors.run(("A", 0, 0), row).tolist()
        left = left2 = int(cells.run(("A", 0, 0), row)[0])
        left_error = left2_error = nearest[0]
        line, error_line = [], []
        for col in range(cells.width):
            sums, wanted = deviation[col], expected[col]
            if serial:
                one, two = p.filters[classes[col]][-2:]
                sums = w(sums + one * (left - base[col]) + two * (left2 - base[col]))
                wanted = wanted + p.errors[6] * left_error + p.errors[7] * left2_error & U32
            rounded = w(sums + 512) >> 10
            rest = w(sums - (rounded << 10))
            cell, error = w(base[col] + rounded), nearest[col]
            if voids is None or not voids[row, col]:
                k = residual(p.shape * 8, rest, wanted, rule, symbols, raw_bits, p.shift)
                jump = w(k * step)
                cell = w(cell + jump)
                far = max(-1 << 30, min(jump, 1 << 30))
                error = min((abs((far << 10) - rest) >> 8) >> coarse, 1 << 20)
            line.append(cell)
            error_line.append(error)
            left, left2, left_error, left2_error = cell, left, error, left_error
        cells.end_row(row, line)
        errors.end_row(row, error_line)
    return cells.own(), errors.own()


def refine(cells, errors, voids, width, height, side, rule, symbols, raw_bits):
    """The cells and errors of a level of that size from the next coarser one; voids are those of its planes."""
    made, made_errors = [None] * 3, [None] * 3
    for kind in (C, H, V):
        size = plane_size(kind, width, height)
        known = Known(cells, made[C], made[H], *size)
        known_errors = Known(errors, made_errors[C], made_errors[H], *size)
        if size[0] and size[1]:
            p = Parameters(side, kind, rule.serial)
            run_pass(kind, known, known_errors, voids and voids[kind], p, rule, symbols, raw_bits)
        made[kind], made_errors[kind] = known.own(), known_errors.own()
    return join(cells, *made), join(errors, *made_errors)
