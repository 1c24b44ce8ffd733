"""The sparse profile: a dictionary, patches, and their blend."""

import numpy as np

from basics import U32, Cursor, RangeDecoder, require
from tile import decode_tile


def i32(a):
    return (a + (1 << 31) & U32) - (1 << 31)


class Coder:
    """Chances, magnitudes and trees on one string of the range coder."""

    def __init__(self, data):
        self.coder = RangeDecoder(data, 16)

    def bit(self, chances, place):
        p = chances[place]
        bit = self.coder.bit(p)
        chances[place] += (65535 - p >> 5) if bit else -(p >> 5)
        return bit

    def magnitude(self, chances):
        longer, second = chances
        length = 0
        while length < 32 and self.bit(longer, length):
            length += 1
        if length < 2:
            return length
        n = 2 + self.bit(second, length)
        for _ in range(length - 2):
            n = 2 * n + self.coder.bit(32768)
        return n

    def tree(self, nodes):
        n = 1
        while n < len(nodes):
            n = 2 * n + self.bit(nodes, n)
        return n - len(nodes)


def magnitudes(count):
    return [([32768] * 32, [32768] * 33) for _ in range(count)]


def tree(width):
    return [32768] * (1 << width)


class Dictionary:
    def __init__(self, data):
        c = Cursor(data, 39)
        self.side, self.step, self.atoms, self.sparsity = (c.varint() for _ in range(4))
        require(39, 3 <= self.side <= 4096 and 1 <= self.step and self.atoms >= 1 and self.sparsity <= 255)
        require(39, self.atoms * self.side**2 <= 1 << 28)
        require(39, 2 * (self.step + (self.step + self.side) % 2) ** 2 < self.side**2)
        self.steps, self.found = [c.float() for _ in range(3)], [c.float() for _ in range(3)]
        require(39, all(0 < step < float("inf") for step in self.steps))
        self.values = self.read_values(data[c.at :])
        radius = self.side / 2.0
        d = np.arange(self.side) + 0.5 - radius
        u = 1.0 - (d * d + (d * d)[:, None]) / (radius * radius)
        self.weights = np.where(u > 0.0, u * u * u, 0.0)

    def read_values(self, data):
        coder, rest = Coder(data), magnitudes(12)
        values = np.zeros((self.atoms, self.side, self.side), np.int64)
        for atom in range(self.atoms):
            v = [[0] * self.side for _ in range(self.side)]
            require(40, coder.coder.taken <= len(data) + 4)
            for row in range(self.side):
                for col in range(self.side):
                    rough = 0
                    if row and col:
                        corner = v[row - 1][col - 1]
                        down, right = i32(v[row][col - 1] - corner), i32(v[row - 1][col] - corner)
                        expected = i32(v[row][col - 1] + right)
                        rough = min(11, min(U32, abs(down) + abs(right)).bit_length())
                    else:
                        expected = v[row][col - 1] if col else v[row - 1][col] if row else 0
                    n = coder.magnitude(rest[rough])
                    v[row][col] = i32(expected + (-(n + 1 >> 1) if n & 1 else n >> 1))
            values[atom] = v
        require(40, coder.coder.is_whole())
        return values

    def lattice(self, width, height):
        """Upper left cell of the first place, columns and rows of places."""
        across, down = -(-width // self.step), -(-height // self.step)
        reach = (self.step - self.side) // 2
        return (
            reach - (down * self.step - height) // 2,
            reach - (across * self.step - width) // 2,
            across,
            down,
        )

    def read_terms(self, data, present):
        """For each place that has a patch its terms, row by row."""
        coder, across = Coder(data), present.shape[1]
        count, atom = tree(self.sparsity.bit_length()), [tree((self.atoms - 1).bit_length()) for _ in range(2)]
        first, fall = magnitudes(33), [magnitudes(4) for _ in range(33)]
        f, found = [0] * across, {}
        for i, j in zip(*map(list, np.nonzero(present))):
            i, j = int(i), int(j)
            require(42, coder.coder.taken <= len(data) + 4)
            n = coder.tree(count)
            require(42, n <= self.sparsity)
            around = ((f[j - 1] if j else f[j]) + f[j] >> 1).bit_length()
            terms, order = [], (0, -1)
            for t in range(n):
                a = coder.tree(atom[t > 0])
                if t == 0:
                    m = coder.magnitude(first[around]) + 1
                else:
                    before = -order[0]
                    m = before - coder.magnitude(fall[before.bit_length()][min(t, 4) - 1])
                require(42, a < self.atoms and 0 < m < 1 << 31 and (t == 0 or (-m, a) > order))
                require(42, all(a != other for other, _ in terms))
                order = (-m, a)
                terms.append((a, -m if coder.coder.bit(32768) else m))
            f[j] = abs(terms[0][1]) if terms else 0
            found[i, j] = terms
        require(42, coder.coder.is_whole())
        return found


def unpack(data, dtype, width, height, nodata):
    parts = Cursor(data, 41)
    segments = [parts.take(parts.varint(5)) for _ in range(4)]
    require(41, parts.at == len(data))
    if not width * height:
        require(41, not any(segments))
        return np.zeros((height, width), dtype)
    return decode_tile(segments, dtype, width, height, 0, nodata, 0.0)


def read_sparse(chunks, dictionary, width, height, side, nodata, level):
    """The cells of a level; chunks are lists of segments, row-major."""
    top, left, across, _ = dictionary.lattice(width, height)
    step, size = dictionary.step, dictionary.side
    patches, void = {}, np.zeros((height, width), bool)
    for tile, segments in enumerate(chunks):
        row, col = (side * i for i in divmod(tile, -(-width // side)))
        right, bottom = min(width, col + side), min(height, row + side)
        require(41, not segments[3])
        i0, i1, j0, j1 = (-(-cell // step) for cell in (row, bottom, col, right))
        means = unpack(segments[0], "<i4", j1 - j0, i1 - i0, b"\0\0\0\x80").astype(np.int64)
        terms = dictionary.read_terms(segments[1], means != -(1 << 31))
        patches.update({(i0 + i, j0 + j): (means[i, j], found) for (i, j), found in terms.items()})
        if segments[2]:
            mask = unpack(segments[2], "u1", right - col, bottom - row, b"\1")
            require(43, mask.max() == 1)
            void[row:bottom, col:right] = mask == 1
    sums, weights = np.zeros((height, width)), np.zeros((height, width))
    mean_step, coefficient_step, atom_step = dictionary.steps
    for (i, j), (mean, terms) in sorted(patches.items()):
        row, col = top + i * step, left + j * step
        y0, y1, x0, x1 = max(0, row), min(height, row + size), max(0, col), min(width, col + size)
        part = np.s_[y0 - row : y1 - row, x0 - col : x1 - col]
        z = np.full((y1 - y0, x1 - x0), float(mean) * mean_step)
        for a, c in terms:
            z = z + (c * coefficient_step) * (dictionary.values[a][part].astype(float) * atom_step)
        sums[y0:y1, x0:x1] += dictionary.weights[part] * z
        weights[y0:y1, x0:x1] += dictionary.weights[part]
    void |= weights == 0.0
    with np.errstate(invalid="ignore", over="ignore"):
        cells = (sums / np.where(void, 1.0, weights)).astype("<f4")
    bits = cells.view("<u4")
    if nodata is not None:
        bits[bits == int.from_bytes(nodata, "little")] ^= 1
    bits[void] = 0x7FC00000 if nodata is None else int.from_bytes(nodata, "little")
    return cells[:: 1 << level, :: 1 << level]
