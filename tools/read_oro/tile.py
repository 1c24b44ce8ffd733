"""Tiles: segments, the tile header, numbers to cells, patches."""

import numpy as np

from basics import SEEN, Cursor, require
from passes import TileRule, i64, refine
from planes import Copies, Mask, Zones, join, plane_size
from symbols import Bits, Symbols

WHOLE, GRID, FIXED, ORDERED, LIST = range(5)


class Header:
    def __init__(self, side, dtype, nodata, bound, depth):
        size, is_float = 8 * dtype.itemsize, dtype.kind == "f"
        self.top = self.void = None
        if side.bits(1):
            require(36, is_float or nodata)
            self.top, own = side.bits(1), is_float and side.bits(1)
            SEEN.update({"own void"} if own else ())
            usual = {4: b"\0\0\xc0\x7f", 8: b"\0\0\0\0\0\0\xf8\x7f"}.get(dtype.itemsize)
            self.void = side.bits(size).to_bytes(size // 8, "little") if own else nodata or usual
        self.patched = side.bits(1)
        self.meaning = side.bits(3)
        require(28, self.meaning in ((GRID, FIXED, ORDERED) if is_float else (WHOLE, LIST)))
        self.least, self.factor, self.range_bits = side.signed(10), side.number(0) + 1, side.bits(7)
        self.step = 2 * side.number(2) + 1
        require(27, self.factor < 1 << 64 and self.range_bits <= 64 and self.step < 1 << 33)
        require(37, bound or (self.step == 1 and self.meaning != FIXED))
        if self.meaning == GRID:
            self.numerator, self.denominator = side.number(0) + 1, side.number(6) + 1
            require(27, max(self.numerator, self.denominator) < 1 << 32)
        if self.meaning == FIXED:
            self.shrink = side.bits(16)
        if self.meaning == LIST:
            count = side.number(4)
            require(27, 1 <= count <= 16384)
            self.values = [side.signed(10)]
            for _ in range(count - 1):
                self.values.append(self.values[-1] + side.number(1) + 1)
            require(29, self.values[-1] < 1 << 63)
        SEEN.add(("whole", "grid", "fixed", "ordered", "list")[self.meaning])
        SEEN.update(name for name, has in (("factor", self.factor > 1), ("patches", self.patched)) if has)
        self.coarseness = usual = min(15, max(0, self.step.bit_length() - 6))
        self.copies, self.zones, self.seed = 0, 1, 0
        if self.range_bits:
            if side.bits(1):
                SEEN.add("coarseness written out")
                self.coarseness = side.bits(6)
                require(27, self.coarseness != usual and self.coarseness <= (47 if self.range_bits > 31 else 15))
            self.copies = self.step == 1 and side.bits(1)
            self.zones = side.bits(2) + 1 if depth >= 8 else 1
            self.seed = side.signed(min(self.range_bits, 60))

    def value(self, x, dtype, bound):
        """The cell that a number stands for, as a number of its type."""
        n = i64(self.least + self.factor * x)
        if self.meaning == ORDERED:
            size = 8 * dtype.itemsize
            n &= (1 << size) - 1
            bits = n if n >> size - 1 == 0 else n ^ (1 << size - 1) - 1
            return np.frombuffer(bits.to_bytes(size // 8, "little"), dtype)[0]
        if self.meaning == GRID:
            return float(i64(n * self.numerator)) / float(self.denominator)
        if self.meaning == FIXED:
            return float(n) * (bound * 2.0 / 9.0 * ((65536 - self.shrink) / 65536.0))
        if self.meaning == LIST:
            n = self.values[max(0, min(n, len(self.values) - 1))]
        return max(np.iinfo(dtype).min, min(n, np.iinfo(dtype).max))

    def values_of(self, xs, dtype, bound):
        table = {}
        for x in set(xs.flat):
            table[x] = self.value(int(x), dtype, bound)
        with np.errstate(over="ignore"):
            return np.array([table[x] for x in xs.flat]).astype(dtype).reshape(xs.shape)


def read_patches(side, dtype, width, height, number):
    patches, following = [], 0
    count = side.number(2)
    require(31, count <= width * height)
    for _ in range(count):
        index = following + side.number(8)
        require(31, index < width * height)
        row, col = divmod(index, width)
        require(31, (row | col | 8) & -(row | col | 8) == 8 >> number)
        patches.append((index, side.bits(8 * dtype.itemsize).to_bytes(dtype.itemsize, "little")))
        following = index + 1
    return patches


def decode_tile(segments, dtype, width, height, level, nodata, bound):
    """The cells of a level from 0 to 6; bound is 0 where the band is lossless."""
    dtype, side = np.dtype(dtype), None
    depth = (max(width, height) - 1).bit_length()
    size = lambda level: (-(-width >> level), -(-height >> level))
    patches, zones = [], None
    for number in range(4 - min(level, 3)):
        levels = range(depth - 1, 2, -1) if number == 0 else range(3 - number, min(4 - number, depth))
        if number and not segments[number]:
            require(25, not levels or not (header.range_bits or header.patched))
        if number and not levels:
            require(25, not segments[number])
            continue
        if number and not segments[number] and voids is None:
            continue
        require(25, not number or not segments[number] or any(segments[number]))
        # An empty segment is one whose parts are all empty.
        parts = Cursor(segments[number] or b"\0\0", 25)
        part = lambda: parts.take(parts.varint(5))
        side = Bits(part())
        if number == 0:
            header = Header(side, dtype, nodata, bound, depth)
            rule = TileRule(header.step, header.range_bits, header.coarseness)
            if header.range_bits:
                SEEN.add("64-bit words" if rule.wide else "32-bit words")
                SEEN.update({"coarse errors"} if rule.coarseness else ())
                SEEN.update({"very coarse errors"} if rule.coarseness > 15 else ())
            cells = np.array([[rule.word(header.seed)]], np.int64)
            errors = np.zeros((1, 1), np.int64)
            voids = None if header.void is None else np.array([[header.top]], np.uint8)
        if header.patched:
            patches += read_patches(side, dtype, width, height, number)
        planes = []
        if voids is not None:
            mask, level_voids = Mask(part()), voids
            for l in levels:
                planes.append(mask.level(level_voids, *size(l)))
                level_voids = join(level_voids, *planes[-1])
                if l >= level:
                    voids = level_voids
            require(30, mask.coder.is_whole())
        if not header.range_bits:
            side.finish()
        else:
            if number == 2 and header.zones > 1:
                zones = Zones(part(), width, height, header.zones)
            copies = Copies(part()) if header.copies else None
            raw_bits = Bits(part())
            count = sum(w * h for l in levels for w, h in (plane_size(kind, *size(l)) for kind in range(3)))
            count -= sum(int(plane.sum()) for level_planes in planes for plane in level_planes)
            symbols = Symbols(parts.take(len(parts.data) - parts.at), count)
            for place, l in enumerate(levels):
                if l >= level:
                    holes = planes[place] if planes else None
                    told = holes, copies, zones
                    cells, errors = refine(cells, errors, *told, *size(l), l, side, rule, symbols, raw_bits)
            if not levels or levels[-1] >= level:
                side.finish()
                require(34, copies is None or copies.coder.is_whole())
                raw_bits.finish()
                symbols.finish()
        require(25, parts.at == len(parts.data))
    if not header.range_bits:
        cells = np.zeros(size(level)[::-1], np.int64)
    made = header.values_of(cells, dtype, bound)
    if voids is not None:
        made[voids == 1] = np.frombuffer(header.void, dtype)[0]
    for index, bits in patches:
        row, col = divmod(index, width)
        if row % (1 << level) == 0 and col % (1 << level) == 0:
            made.view(f"V{dtype.itemsize}")[row >> level, col >> level] = np.void(bits)
    return made
