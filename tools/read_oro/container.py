"""The file, its sections, META and INDX."""

import hashlib
import struct

import numpy as np

from basics import U32, Cursor, crc32c, require
from sparse import Dictionary, read_sparse
from text import texts
from tile import decode_tile

NAMES = ["u8", "i8", "u16", "i16", "u32", "i32", "f32", "f64"]
TYPES = ["<u1", "<i1", "<u2", "<i2", "<u4", "<i4", "<f4", "<f8"]


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
        record = {"type": NAMES[f & 7], "texts": f >> 7}
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


def read_chunks(data, lengths, needed):
    """The segments of each chunk, of which so many are needed."""
    at = 0
    for sizes in lengths.tolist():
        segments = []
        for number, size in enumerate(sizes):
            segments.append(data[at : at + size])
            at += size
            if size:
                crc = int.from_bytes(data[at : at + 4], "little")
                require(1, number >= needed or crc32c(segments[-1]) == crc)
                at += 4
        yield segments


def read_area(data, lengths, area, level):
    """The cells of each band at a level from 0 to 6, from chunks that begin with the data."""
    width, height, side, rules = area
    shape = (-(-height >> level), -(-width >> level))
    cells = [np.zeros(shape, rule[0]) for rule in rules]
    for chunk, segments in enumerate(read_chunks(data, lengths, 4 - min(level, 3))):
        tile, band = divmod(chunk, len(rules))
        row, col = (side * i for i in divmod(tile, -(-width // side)))
        dtype, nodata, bound = rules[band]
        tile = decode_tile(segments, dtype, min(side, width - col), min(side, height - row), level, nodata, bound)
        cells[band][row >> level :, col >> level :][: tile.shape[0], : tile.shape[1]] = tile
    return cells


def read(data, level=0):
    """What the file says, and the cells of each band at a level."""
    require(3, len(data) >= 50 and data[-4:] == b"ORO\x89")
    footer = data[-38:]
    length, directory_length, version, flags, crc = struct.unpack("<Q16xHHHI", footer[:34])
    require(7, directory_length <= min(32768, len(data) - 50))
    end = len(data) - 38 - directory_length
    require(4, crc == crc32c(data[end : -38] + footer[:30]))
    require(5, version == 1 and flags == 0)
    require(6, length == len(data))
    require(2, data[:4] == b"\x89ORO" and data[4:8] == footer[26:30])
    require(2, crc32c(data[:8]) == int.from_bytes(data[8:12], "little"))
    c, entries, sections = Cursor(data[end:-38], 8), [], {}
    while c.at < directory_length:
        entries.append((c.number(1), c.varint(), c.number(4)))
    for kind, size, crc in reversed(entries):
        require(9, kind < 128 or kind & 127 in (1, 2, 3, 4))
        require(10, kind & 127 not in sections or kind & 127 > 4)
        require(11, end - size >= 12)
        end -= size
        sections[kind & 127] = (end, data[end : end + size], crc)
    require(10, 1 in sections and 2 in sections)
    require(12, all(crc32c(sections[kind][1]) == sections[kind][2] for kind in (1, 2, 4) if kind in sections))
    meta = read_meta(sections[1][1], end - 12)
    side, bands = meta["tile_side"], meta["bands"]
    require(39, 4 not in sections or (3 not in sections and [band["type"] for band in bands] == ["f32"]))
    across, down = -(-meta["width"] // side), -(-meta["height"] // side)
    c = Cursor(sections[2][1], 21)
    lengths = read_index(c, across * down * len(bands), end - 12)
    if 3 in sections:
        count = -(-across // 64) * -(-down // 64) * len(bands)
        over = read_index(c, count, len(sections[3][1]))
    require(21, c.at == len(c.data))

    rules = [(TYPES[NAMES.index(band["type"])], band["nodata"], band["max_error"] or 0.0) for band in bands]
    area = (meta["width"], meta["height"], side, rules)
    meta["overview"] = None
    if 4 in sections:
        dictionary = Dictionary(sections[4][1])
        chunks = read_chunks(data[12:], lengths, 4)
        cells = [read_sparse(chunks, dictionary, *area[:3], rules[0][1], level)]
        meta["atoms"] = dictionary.atoms
        meta["hash"] = hashlib.sha256(data[:-38]).digest()[:16] == footer[8:24]
        return meta, cells
    cells = read_area(data[12:], lengths, area, min(level, 6))
    if 3 in sections:
        area = (-(-meta["width"] >> 6), -(-meta["height"] >> 6), side, [rule[:2] + (0.0,) for rule in rules])
        meta["overview"] = "sound"
        try:
            copies = read_area(sections[3][1], over, area, 0)
            raster = (meta["width"], meta["height"], side, rules)
            tops = cells if level >= 6 else read_area(data[12:], lengths, raster, 6)
            if any(copy.tobytes() != top.tobytes() for copy, top in zip(copies, tops)):
                meta["overview"] = "another"
        except ValueError:
            meta["overview"] = "damaged"
    meta["hash"] = hashlib.sha256(data[:-38]).digest()[:16] == footer[8:24]
    return meta, [band[:: 1 << max(0, level - 6), :: 1 << max(0, level - 6)] for band in cells]
