#!/usr/bin/env python3
"""A second reader of .oro files, written from format-spec/oro.md alone.

    tools/read_oro.py FILE [LEVEL]      prints what the file says, and the SHA-256 of each band's cells

Cells are decoded as the specification's part "Tiles" says once it is there; until then segments are plain cells.
Rejections are ValueErrors that begin with the number of the requirement.
"""

import hashlib
import json
import pathlib
import struct
import sys

import numpy as np

TYPES = ["<u1", "<i1", "<u2", "<i2", "<u4", "<i4", "<f4", "<f8"]
U32 = 0xFFFFFFFF


def require(number, holds):
    if not holds:
        raise ValueError(f"R-{number:03}")


CRC = []
for i in range(256):
    for _ in range(8):
        i = i >> 1 ^ 0x82F63B78 if i & 1 else i >> 1
    CRC.append(i)


def crc32c(data):
    crc = U32
    for byte in data:
        crc = crc >> 8 ^ CRC[(crc ^ byte) & 255]
    return crc ^ U32


class Cursor:
    """Conventions: integers and floats from the front of some bytes."""

    def __init__(self, data, requirement):
        self.data, self.at, self.requirement = data, 0, requirement

    def take(self, count):
        require(self.requirement, self.at + count <= len(self.data))
        self.at += count
        return self.data[self.at - count : self.at]

    def number(self, size):
        return int.from_bytes(self.take(size), "little")

    def varint(self):
        value = shift = 0
        while True:
            byte = self.number(1)
            value |= (byte & 127) << shift
            if byte < 128:
                require(self.requirement, value < 1 << 64 and (byte or not shift))
                return value
            shift += 7
            require(self.requirement, shift < 64)

    def float(self):
        form = self.number(1)
        if form < 9:
            return struct.unpack("<d", self.take(form).rjust(8, b"\0"))[0]
        p, q = self.varint(), self.varint()
        n = (p + 1) >> 1
        require(16, form == 9 and n < 1 << 53 and 0 < q < 1 << 53)
        return -(n / q) if p & 1 else n / q


LOGISTIC = [1, 2, 4, 6, 10, 17, 27, 45, 74, 120, 194, 311, 488, 747, 1102, 1546, 2048]
LOGISTIC += [2550, 2994, 3349, 3608, 3785, 3902, 3976, 4022, 4051, 4069, 4079, 4086, 4090, 4092, 4094, 4095]
FOLD, SPREAD, STIR = 0x2F0B4C47, 0x85EBCA6B, 0x9E3779B1


def squash(x):
    x = max(-2047, min(2047, x)) + 2048
    i, f = x >> 7, x & 127
    return (LOGISTIC[i] * (128 - f) + LOGISTIC[i + 1] * f + 64) >> 7


STRETCH = []
for x in range(-2047, 2048):
    STRETCH += [x] * (squash(x) + 1 - len(STRETCH))
STRETCH += [2047] * (4096 - len(STRETCH))


def learn(slot, bit, limit):
    p, n = slot
    slot[0] = p + (65535 - p) * 2 // (2 * n + 3) if bit else p - p * 2 // (2 * n + 3)
    slot[1] = min(n + 1, limit)


class Model:
    """Texts: how likely the next bit is 1."""

    def __init__(self):
        self.slots = [{} for _ in range(4)]  # slots that were never touched are not kept
        self.bets = [[32768, 0] for _ in range(33)]
        self.weights = [[20000] * 5 for _ in range(4)]
        self.places, self.history = {}, bytearray()
        self.partial, self.matched, self.length = 1, 0, 0
        self.begin_byte()

    def fold(self, k):
        h = k
        for byte in self.history[-k:]:
            h = (h + byte + 1) * FOLD & U32
        return h

    def begin_byte(self):
        self.hashes = [self.fold(k) for k in (1, 2, 3, 4)]
        h, end = self.history, len(self.history)
        if end < 5:
            return
        place = (self.fold(5) * STIR & U32) >> 16
        if self.length:
            self.matched, self.length = self.matched + 1, min(self.length + 1, 32)
        else:
            self.matched = m = self.places.get(place, 0)
            while self.length < min(m, 32) and h[m - 1 - self.length] == h[end - 1 - self.length]:
                self.length += 1
        self.places[place] = end

    def predict(self):
        stirred = self.partial * SPREAD & U32
        found = [((h ^ stirred) * STIR & U32) >> 15 for h in self.hashes]
        self.found = [slots.setdefault(at, [32768, 0]) for slots, at in zip(self.slots, found)]
        self.input = [STRETCH[slot[0] >> 4] for slot in self.found] + [0]
        self.bet = None
        if self.length:
            byte, seen = self.history[self.matched] + 256, self.partial.bit_length() - 1
            if byte >> (8 - seen) == self.partial:
                self.bet = byte >> (7 - seen) & 1
                sure = STRETCH[self.bets[self.length][0] >> 4]
                self.input[4] = sure if self.bet else -sure
        self.set = 0 if not self.length else 1 + self.length // 16
        total = sum(w * x for w, x in zip(self.weights[self.set], self.input))
        self.p = squash(max(-2047, min(2047, total >> 16)))
        return self.p

    def update(self, bit):
        error, weights = (bit << 12) - self.p, self.weights[self.set]
        for i, x in enumerate(self.input):
            weights[i] = max(-(1 << 20), min(1 << 20, weights[i] + ((x * error * 14 + 32768) >> 16)))
        for slot in self.found:
            learn(slot, bit, 127)
        if self.bet is not None:
            learn(self.bets[self.length], self.bet == bit, 1023)
            if self.bet != bit:
                self.length = 0
        self.partial = 2 * self.partial + bit
        if self.partial >= 256:
            self.history.append(self.partial - 256)
            self.partial = 1
            self.begin_byte()


def texts(data, count):
    """The texts that the bytes hold."""
    if not count:
        require(24, not data)
        return []
    model = Model()
    for byte in (pathlib.Path(__file__).parent.parent / "format-spec/tables/text-1.txt").read_bytes():
        for place in range(7, -1, -1):
            model.predict()
            model.update((0 if byte == 10 else byte) >> place & 1)
    start = len(model.history)
    low, high, taken = 0, U32, 4
    number = int.from_bytes(data[:4].ljust(4, b"\0"), "big")
    while count:
        middle = low + ((high - low) * model.predict() >> 12)
        bit = int(number <= middle)
        low, high = (low, middle) if bit else (middle + 1, high)
        while low >> 24 == high >> 24:
            low, high = low << 8 & U32, (high << 8 & U32) + 255
            number = (number << 8 & U32) + (data[taken] if taken < len(data) else 0)
            taken += 1
        model.update(bit)
        require(24, taken <= len(data) + 4)
        require(23, len(model.history) - start <= 16 << 20)
        if model.partial == 1 and model.history[-1] == 0:
            count -= 1
    require(24, taken >= len(data))
    try:
        return [text.decode() for text in bytes(model.history[start:-1]).split(b"\0")]
    except UnicodeDecodeError:
        raise ValueError("R-023") from None


def read_meta(data, chunk_bytes):
    c = Cursor(data, 17)
    width, height, side, bands = (c.varint() for _ in range(4))
    require(13, 1 <= min(width, height) and max(width, height) < 1 << 31 and 1 <= side <= 64 and 1 <= bands <= 65535)
    meta = {"width": width, "height": height, "tile_side": side * 64}
    require(13, -(-width // (side * 64)) * -(-height // (side * 64)) * bands <= min(1 << 40, chunk_bytes // 5))
    require(14, c.varint() == 1)
    flags = c.number(1)
    require(15, flags & 1 or not flags & 6)
    if flags & 1:
        t0, t1, t3 = c.float(), c.float(), c.float()
        t2, t4 = (c.float(), c.float()) if flags & 2 else (0.0, 0.0)
        meta["geotransform"] = [t0, t1, t2, t3, t4, c.float() if flags & 4 else -t1]
    if flags & 16:
        meta["epoch"] = c.float()
    meta["cells_are"] = "point" if flags & 32 else "area"
    records = []
    for _ in range(1 if flags & 128 else bands):
        f = c.number(1)
        record = {"type": TYPES[f & 7], "texts": f >> 7}
        record["nodata"] = c.take(int(TYPES[f & 7][2])) if f & 8 else None
        for bit, name in ((4, "max_error"), (5, "scale"), (6, "offset")):
            record[name] = c.float() if f >> bit & 1 else None
        require(16, record["max_error"] is None or 0 < record["max_error"] < float("inf"))
        records.append(record)
    meta["bands"] = [dict(record) for record in (records * bands if flags & 128 else records)]
    counts = [c.varint() if band["texts"] else 0 for band in meta["bands"]]
    count = c.varint() if flags & 64 else 0
    require(13, max(counts + [count]) <= (16 << 20) // 3 and (count or not flags & 64))
    total = (flags >> 3 & 1) + sum(2 for band in meta["bands"] if band["texts"]) + 3 * (sum(counts) + count)
    found = iter(texts(data[c.at :], total))
    if flags & 8:
        meta["crs"] = next(found)
    for band, items in zip(meta["bands"], counts):
        band["unit"], band["description"] = (next(found), next(found)) if band.pop("texts") else ("", "")
        band["metadata"] = [[next(found), next(found), next(found)] for _ in range(items)]
    meta["metadata"] = [[next(found), next(found), next(found)] for _ in range(count)]
    return meta


def read_index(c, chunks, total):
    """Lengths of the segments of each chunk; segments are the second axis."""
    columns = []
    for _ in range(4):
        least, width = c.varint(), c.number(1) if chunks > 1 else 0
        require(18, least <= U32 and width <= 32)
        packed = int.from_bytes(c.take((chunks * width + 7) // 8), "little")
        require(18, packed >> chunks * width == 0)
        columns.append([least + (packed >> i * width & ((1 << width) - 1)) for i in range(chunks)])
        require(18, max(columns[-1]) <= U32)
    lengths = np.array(columns, dtype=np.int64).T
    require(19, (lengths[:, 0] > 0).all())
    require(20, int((lengths + 4 * (lengths > 0)).sum()) == total)
    return lengths


def decode_tile(segments, dtype, width, height, level):
    """Tiles: for now every segment holds a level's cells as they are."""
    stored = min(level, 3)
    cells = np.frombuffer(segments[3 - stored], dtype).reshape(-(-height >> stored), -(-width >> stored))
    return cells[:: 1 << (level - stored), :: 1 << (level - stored)]


def read(data, level=0):
    """What the file says, and the cells of each band at a level from 0 to 6."""
    require(3, len(data) >= 50 and data[-4:] == b"ORO\x89")
    footer = data[-38:]
    length, directory_length, version, flags, crc = struct.unpack("<Q16xHHHI", footer[:34])
    require(7, directory_length <= min(32768, len(data) - 50))
    end = len(data) - 38 - directory_length
    require(4, crc == crc32c(data[end : -38] + footer[:30]))
    require(5, version == 1 and flags == 0)
    require(6, length == len(data))
    require(2, data[:4] == b"\x89ORO" and data[4:8] == footer[26:30] and crc32c(data[:8]) == int.from_bytes(data[8:12], "little"))
    c, entries, sections = Cursor(data[end:-38], 8), [], {}
    while c.at < directory_length:
        entries.append((c.number(1), c.varint(), c.number(4)))
    for kind, size, crc in reversed(entries):
        require(9, kind < 128 or kind & 127 in (1, 2, 3))
        require(10, kind & 127 not in sections or kind & 127 > 3)
        require(11, end - size >= 12)
        end -= size
        sections[kind & 127] = (end, data[end : end + size], crc)
    require(10, 1 in sections and 2 in sections)
    require(12, all(crc32c(sections[kind][1]) == sections[kind][2] for kind in (1, 2)))
    meta = read_meta(sections[1][1], end - 12)
    side, bands = meta["tile_side"], meta["bands"]
    across, down = -(-meta["width"] // side), -(-meta["height"] // side)
    c = Cursor(sections[2][1], 21)
    lengths = read_index(c, across * down * len(bands), end - 12)
    if 3 in sections:
        over = -(-across // 64) * -(-down // 64) * len(bands)
        read_index(c, over, len(sections[3][1]))
    require(21, c.at == len(c.data))

    shape = (-(-meta["height"] >> level), -(-meta["width"] >> level))
    cells = [np.zeros(shape, band["type"]) for band in bands]
    at = 12
    for chunk, sizes in enumerate(lengths.tolist()):
        tile, band = divmod(chunk, len(bands))
        row, col = (side * i for i in divmod(tile, across))
        segments = []
        for number, size in enumerate(sizes):
            segments.append(data[at : at + size])
            at += size
            if size:
                needed = number < 4 - min(level, 3)
                require(1, not needed or crc32c(segments[-1]) == int.from_bytes(data[at : at + 4], "little"))
                at += 4
        w, h = min(side, meta["width"] - col), min(side, meta["height"] - row)
        tile = decode_tile(segments, bands[band]["type"], w, h, level)
        cells[band][row >> level :, col >> level :][: tile.shape[0], : tile.shape[1]] = tile
    meta["hash"] = hashlib.sha256(data[:-38]).digest()[:16] == footer[8:24]
    return meta, cells


if __name__ == "__main__":
    try:
        meta, cells = read(pathlib.Path(sys.argv[1]).read_bytes(), *map(int, sys.argv[2:]))
    except ValueError as error:
        sys.exit(f"{sys.argv[1]}: rejected: {error}")
    meta["sha256"] = [hashlib.sha256(band.tobytes()).hexdigest() for band in cells]
    print(json.dumps(meta, indent=1, ensure_ascii=False, default=bytes.hex))
