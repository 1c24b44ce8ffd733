"""Passes: parameters, prediction, residuals."""

import numpy as np

from basics import SEEN, U32, require
from planes import C, GROUPS, H, TAPS, V, Known, join, plane_size
from symbols import shipped_filter

BINS, RAW_FROM, SERIAL_UP_TO = 36, 32, 2
LIMIT = 65535
# When it is a list: what became of the first cell of each row.
TRACE = None


class TileRule:
    """What is the same in all passes of a tile."""

    def __init__(self, step, range_bits, coarseness):
        self.step, self.coarseness, self.wide = step, coarseness, range_bits > 31
        self.most = 1 << (60 if self.wide else 28)
        # How a residual is stored, for each eighth of an octave of the expected error.
        bins = []
        for eighth in range(224):
            middle = (17 + 2 * (eighth % 8)) << eighth // 8
            e = max((middle << coarseness) // (8 * step), 16)
            o = e.bit_length() - 1
            bins.append(4 * (o - 4) + (e >> o - 2 & 3))
        self.raw = np.array([max(b - RAW_FROM, 0) // 4 for b in bins])
        self.bins = np.array([b if b < BINS else RAW_FROM + b % 4 for b in bins])

    def word(self, a):
        """W of a number, or of an array of 64-bit numbers."""
        if not self.wide:
            return (a + (1 << 31) & U32) - (1 << 31)
        return a if isinstance(a, np.ndarray) else i64(a)

    def part(self, a, shift):
        return np.minimum(magnitude(a) >> np.uint64(shift), self.most).astype(np.int64)

    def error(self, m):
        """Magnitudes as errors."""
        m = np.minimum(m, 1 << 61).astype(np.uint64)
        return np.minimum((m << np.uint64(2)) >> np.uint64(self.coarseness), LIMIT).astype(np.int64)

    def error_of(self, jump, rest):
        """The error of a cell."""
        if self.coarseness:
            return min((abs(jump) << 2) >> self.coarseness, LIMIT)
        return min(abs((jump << 10) - rest) >> 8, LIMIT)

    def errors_of(self, jumps, rests):
        """The same of many."""
        if self.coarseness:
            return self.error(magnitude(jumps))
        jumps = np.clip(jumps, -1 << 30, 1 << 30)
        return np.minimum(np.abs((jumps << 10) - rests) >> 8, LIMIT)

    def kinds(self, rests):
        """The kind of table for what was rounded off; step 1 and 3 have several."""
        rests = np.abs(rests)
        if self.step == 1:
            return np.minimum(rests >> 7, 3)
        return np.minimum(rests // 184, 2) + 4 if self.step == 3 else np.full_like(rests, 7)


def magnitude(a):
    # The magnitude of -2^63 is right as an unsigned number.
    return np.abs(a).astype(np.uint64)


def i64(a):
    return (a + (1 << 63) & (1 << 64) - 1) - (1 << 63)


class Parameters:
    """The parameters of a pass in one zone."""

    def __init__(self, side, kind, serial):
        self.serial = serial
        SEEN.add("serial" if self.serial else "not serial")
        taps = len(TAPS[kind]) + 2 * self.serial
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
            self.filters = [shipped_filter(self.serial, kind, side.bits(2))[0][:taps]]
        if side.bits(1):
            SEEN.add("own error weights")
            codes = [side.bits(6) for _ in range(9)]
            require(32, max(codes) <= 41)
        else:
            SEEN.add("error weights of the set")
            codes = shipped_filter(self.serial, kind, side.bits(2))[1]
        SEEN.add(f"shape {self.shape}")
        self.errors = [0 if n == 0 else (4 + (n - 1) % 4 << (n - 1) // 4) >> 2 for n in codes]

    def tables(self, rule):
        """The table for each eighth of an octave, of kind 0."""
        return self.shape * 8 * BINS + np.clip(rule.bins + self.shift, 0, BINS - 1)


class Zoned:
    """A pass's cells prepared for each of its zones: every cell with what its own zone says."""

    def __init__(self, kind, cells, errors, parameters, zones, rule):
        self.parameters, self.zones = parameters, zones
        self.prepared = [Prepared(kind, cells, errors, p, rule) for p in parameters]
        self.tables = np.array([p.tables(rule) for p in parameters])

    def row(self, row, cells, errors, rule):
        """Zone, base, class, deviation and expected error of each cell."""
        zone = self.zones[row]
        rows = [prepared.row(row, cells, errors, rule) for prepared in self.prepared]
        return zone, *(np.choose(zone, lanes) for lanes in zip(*rows))


class Prepared:
    """Base, class, deviation and expected error of all cells, without what serial passes add."""

    def __init__(self, kind, cells, errors, p, rule):
        w, near = rule.word, [cells.all(tap) for tap in TAPS[kind][:4]]
        a, b, c, d = near
        self.base = base = w(a + (w(b - a + c - a + d - a) >> 2))
        spread = sum(rule.part(w(x - base), 2) for x in near)
        pairs = (a, d, b, c) if kind == C else near
        across = w(pairs[0] + pairs[1] - pairs[2] - pairs[3])
        self.classes = None
        if len(p.filters) == 2:
            along = sum(np.minimum(magnitude(w(x - y)), U32).astype(np.int64) for x, y in (pairs[:2], pairs[2:]))
            self.classes = (np.minimum(along, U32) > min(2 * rule.step, U32)).astype(int)
        # Taps of the pass's own plane are added row by row.
        weighted = [(tap, self.choose(weights)) for tap, *weights in zip(TAPS[kind], *p.filters)]
        self.deviation = sum(weight * (cells.all(tap) - base) for tap, weight in weighted if tap[0] != "O")
        self.own = [(tap, weight) for tap, weight in weighted if tap[0] == "O"]

        v = p.errors
        self.expected = v[3] * rule.error(spread) + v[4] * rule.error(rule.part(across, 1))
        self.expected += v[8] * min((rule.step << 2) >> rule.coarseness, LIMIT)
        for weight, group in zip(v, GROUPS[kind]):
            self.expected += weight * sum(errors.all(tap) for tap in group)
        self.above = v[5]

    def choose(self, weights):
        """A tap's weight, or that of each cell's class."""
        return weights[0] if self.classes is None else np.where(self.classes, weights[1], weights[0])

    def row(self, row, cells, errors, rule):
        base, deviation = self.base[row], self.deviation[row]
        for tap, weight in self.own:
            weight = weight if self.classes is None else weight[row]
            deviation = deviation + weight * (cells.run(tap, row) - base)
        one, two, three = (errors.run(("O", -1, col), row) for col in (-1, 0, 1))
        classes = np.zeros(len(base), int) if self.classes is None else self.classes[row]
        return base, classes, rule.word(deviation), self.expected[row] + self.above * (one + 2 * two + three)


def eighths(expected):
    """The eighth of an octave of each number below 2^31."""
    expected = np.maximum(expected, 8)
    octave = np.frexp(expected)[1] - 4
    return octave * 8 + (expected >> octave & 7)


def residual(s, raw, raw_bits):
    """What a symbol and the raw bits after it say."""
    k = s - 31
    if s == 63:
        SEEN.add("escape")
        k = raw_bits.signed(6)
    if raw:
        SEEN.add("raw bits")
        k = i64((k << raw) + raw_bits.bits(raw))
    return k


def plain_row(zone, base, deviation, expected, held, tables, rule, symbols, raw_bits):
    """The cells of a row and their errors, where nothing depends on the cell to the left."""
    w = rule.word
    rounded = w(deviation + 512) >> 10
    rests = w(deviation - (rounded << 10))
    places = eighths(expected)
    asked = tables[zone, places] + BINS * rule.kinds(rests)
    raws = rule.raw[places]
    if held is not None:
        asked, raws = asked[held], raws[held]
    found = np.array(symbols.row(asked.tolist()), np.int64)
    k = found - 31
    for place in np.flatnonzero((found == 63) | (raws > 0)):
        k[place] = residual(int(found[place]), int(raws[place]), raw_bits)
    if held is not None:
        every = np.zeros(len(base), np.int64)
        every[held] = k
        k = every
    if rule.step <= 3:
        k = np.where(rests < 0, -k, k)
    jumps = w(w(k) * rule.step)
    cells, errors = w(base + rounded + jumps), rule.errors_of(jumps, rests)
    if TRACE is not None:
        shown = (base, rests, base + rounded, expected, rule.bins[places], asked, found, k, cells, errors)
        TRACE.append([int(values[0]) for values in shown] + symbols.state[:1])
    return cells, errors


def serial_row(first, first_error, zone, base, classes, deviation, expected, still, zoned, rule, symbols, raw_bits):
    """The cells of a row and their errors, one after the other; still says what cells without residual are."""
    w, step = rule.word, rule.step
    tables, raws = zoned.tables.tolist(), rule.raw.tolist()
    kinds = rule.kinds(np.arange(-512, 513)).tolist()
    tails = [[weights[-2:] for weights in p.filters] for p in zoned.parameters]
    lefts = [p.errors[6:8] for p in zoned.parameters]
    left = left2 = first
    left_error = left2_error = first_error
    line, error_line = [], []
    rows = (zone.tolist(), base.tolist(), classes.tolist(), deviation.tolist(), expected.tolist(), still)
    for z, b, c, sums, wanted, at in zip(*rows):
        (one, two), (left_weight, left2_weight) = tails[z][c], lefts[z]
        sums = w(sums + one * (left - b) + two * (left2 - b))
        rounded = w(sums + 512) >> 10
        cell = w(b + rounded)
        if at is None:
            rest = w(sums - (rounded << 10))
            v = max(wanted + left_weight * left_error + left2_weight * left2_error, 8)
            o = v.bit_length() - 4
            eighth = 8 * o + (v >> o & 7)
            table = tables[z][eighth] + BINS * kinds[rest + 512]
            s = symbols.symbol(table)
            k = residual(s, raws[eighth], raw_bits)
            k = -k if step <= 3 and rest < 0 else k
            jump = w(k * step)
            cell, error, prediction = w(cell + jump), rule.error_of(jump, rest), cell
            if TRACE is not None and not line:
                shown = [b, rest, prediction, v, int(rule.bins[eighth]), table, s, k, cell, error]
                TRACE.append(shown + symbols.state[:1])
        else:
            copy, error = at
            cell = cell if copy is None else copy
        line.append(cell)
        error_line.append(error)
        left2, left, left2_error, left_error = left, cell, left_error, error
    return line, error_line


def run_pass(kind, cells, errors, voids, copies, parameters, zones, rule, symbols, raw_bits):
    """Makes the cells and errors of a pass; both know what there is already. Copies are a mask and their cells."""
    zoned = Zoned(kind, cells, errors, parameters, zones, rule)
    for row in range(cells.height):
        cells.begin_row(row)
        errors.begin_row(row)
        zone, base, classes, deviation, expected = zoned.row(row, cells, errors, rule)
        nearest = errors.run(("A", 0, 0), row)
        empty = None if voids is None else voids[row] == 1
        copied = None if copies is None else copies[0][row] == 1
        if parameters[0].serial:
            still = [None] * cells.width
            if empty is not None:
                still = [(None, error) if void else None for void, error in zip(empty, nearest.tolist())]
            if copied is not None:
                for col in np.flatnonzero(copied):
                    still[col] = (int(copies[1][row, col]), 0)
            first = int(cells.run(("A", 0, 0), row)[0])
            lanes = zone, base, classes, deviation, expected, still
            line, error_line = serial_row(first, int(nearest[0]), *lanes, zoned, rule, symbols, raw_bits)
        else:
            held = None
            if empty is not None or copied is not None:
                held = ~((False if empty is None else empty) | (False if copied is None else copied))
            line, error_line = plain_row(zone, base, deviation, expected, held, zoned.tables, rule, symbols, raw_bits)
            if empty is not None:
                error_line = np.where(empty, nearest, error_line)
            if copied is not None:
                line, error_line = np.where(copied, copies[1][row], line), np.where(copied, 0, error_line)
        cells.end_row(row, line)
        errors.end_row(row, error_line)


def refine(cells, errors, voids, copies, zones, width, height, level, side, rule, symbols, raw_bits):
    """The cells and errors of a level of that size from the next coarser one; voids are those of its planes."""
    made, made_errors = [None] * 3, [None] * 3
    serial = set()
    for kind in (C, H, V):
        size = plane_size(kind, width, height)
        known = Known(cells, made[C], made[H], *size)
        known_errors = Known(errors, made_errors[C], made_errors[H], *size)
        if size[0] and size[1]:
            holes = voids and voids[kind]
            told = copies and copies.plane(kind, known, holes)
            own = level <= SERIAL_UP_TO and side.bits(1)
            serial.add(own)
            zoned = zones is not None and level < 2
            parameters = [Parameters(side, kind, own) for _ in range(zones.count if zoned else 1)]
            parcels = zones.plane(level, *size) if zoned else np.zeros(size[::-1], np.uint8)
            SEEN.update({"zones in a serial pass" if own else "zones in a pass that is not serial"} if zoned else ())
            SEEN.update({"zones beside voids"} if zoned and holes is not None and holes.any() else ())
            SEEN.update({"serial beside not serial"} if len(serial) == 2 else ())
            if told and told[0].any():
                SEEN.update({"copies", "copies in a serial pass"} if own else {"copies"})
                SEEN.update({"copies in 64-bit words"} if rule.wide else ())
                SEEN.update({"copies beside voids"} if holes is not None and holes.any() else ())
            run_pass(kind, known, known_errors, holes, told, parameters, parcels, rule, symbols, raw_bits)
        made[kind], made_errors[kind] = known.own(), known_errors.own()
    return join(cells, *made), join(errors, *made_errors)
