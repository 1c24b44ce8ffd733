"""Planes of a level, their taps, the mask of voids, copies, and zones."""

import numpy as np

from basics import SEEN, Chances, require

FRAME = 4
C, H, V = 0, 1, 2

# Plane, row, column; the four nearest cells first. "O" is the pass's own plane.
TAPS = [
    "A 0 0, A 0 1, A 1 0, A 1 1, A -1 -1, A -1 0, A -1 1, A -1 2, A 0 -1, A 0 2, A 1 -1, A 1 2, A 2 -1, A 2 0, A 2 1,"
    "A 2 2, O -1 -1, O -1 0, O -1 1, O -2 0",
    "A 0 0, A 0 1, C -1 0, C 0 0, A 0 -1, A 0 2, C -2 0, C 1 0, A -1 0, A -1 1, A 1 0, A 1 1, C -1 -1, C -1 1, C 0 -1,"
    "C 0 1, O -1 -1, O -1 0, O -1 1, O -2 0",
    "A 0 0, A 1 0, C 0 -1, C 0 0, A -1 0, A 2 0, C 0 -2, C 0 1, A 0 -1, A 0 1, A 1 -1, A 1 1, C -1 -1, C -1 0, C 1 -1,"
    "C 1 0, H 0 -1, H 0 0, H 1 -1, H 1 0, O -1 -1, O -1 0, O -1 1, O -2 0",
]
GROUPS = [
    ["A 0 0, A 0 1, A 1 0, A 1 1"],
    ["A 0 0, A 0 1", "C -1 0, C 0 0", "A -1 0, A -1 1, A 1 0, A 1 1"],
    ["A 0 0, A 1 0", "C 0 -1, C 0 0", "H 0 -1, H 0 0, H 1 -1, H 1 0"],
]


def parse(taps):
    return [(plane, int(row), int(col)) for plane, row, col in (tap.split() for tap in taps.split(","))]


TAPS = [parse(taps) for taps in TAPS]
GROUPS = [[parse(group) for group in groups] for groups in GROUPS]


def framed(cells):
    """A plane with copies of its nearest cells around it."""
    return np.pad(cells, FRAME, mode="edge")


class Known:
    """What a pass can look at: framed planes A, C, H, and its own as far as it is made."""

    def __init__(self, a, c, h, width, height):
        self.planes = {"A": framed(a)}
        self.planes["C"] = framed(c) if c is not None and c.size else self.planes["A"]
        self.planes["H"] = framed(h) if h is not None and h.size else self.planes["A"]
        self.width, self.height = width, height
        own = np.zeros((height + 2 * FRAME, width + 2 * FRAME), a.dtype)
        own[:FRAME] = self.planes["A"][FRAME, : width + 2 * FRAME]
        self.planes["O"] = own

    def run(self, tap, row):
        """The tap of each cell of a row."""
        plane, down, right = tap
        return self.planes[plane][FRAME + row + down, FRAME + right :][: self.width]

    def all(self, tap):
        """The tap of all cells, of a plane that is whole."""
        plane, down, right = tap
        return self.planes[plane][FRAME + down :, FRAME + right :][: self.height, : self.width]

    def begin_row(self, row):
        """Sets the cells left of the row."""
        self.planes["O"][FRAME + row, :FRAME] = self.planes["A"][FRAME + row, FRAME]

    def end_row(self, row, cells):
        line = self.planes["O"][FRAME + row]
        line[FRAME : FRAME + self.width] = cells
        if self.width:
            line[FRAME + self.width :] = cells[-1]

    def own(self):
        return self.planes["O"][FRAME : FRAME + self.height, FRAME : FRAME + self.width]


def plane_size(kind, width, height):
    """Columns and rows of a pass's plane in a level."""
    return (width + (kind == V)) // 2, (height + (kind == H)) // 2


def join(a, c, h, v):
    """The level that four planes make."""
    level = np.zeros((a.shape[0] + v.shape[0], a.shape[1] + h.shape[1]), a.dtype)
    level[::2, ::2], level[1::2, 1::2], level[::2, 1::2], level[1::2, ::2] = a, c, h, v
    return level


class Mask(Chances):
    """The voids of the levels of a segment."""

    def __init__(self, data):
        super().__init__(data)
        self.runs = [[32768] * 2 for _ in range(3)]
        self.cells = [[32768] * 20 for _ in range(3)]

    def plane(self, kind, known):
        for row in range(known.height):
            near = [known.run(tap, row).tolist() for tap in TAPS[kind][:4]]
            above = known.run(("O", -1, 0) if row else ("A", 0, 0), row).tolist()
            around = [sum(cells) for cells in zip(*near)]
            line = []
            while len(line) < known.width:
                end = min(len(line) + 32, known.width)
                ahead = set(around[len(line) : end])
                if ahead in ({0}, {4}):
                    value = int(ahead == {4})
                    if self.bit(self.runs[kind], value):
                        SEEN.add("run of voids")
                        line += [value] * (end - len(line))
                        continue
                while len(line) < end:
                    col = len(line)
                    left = line[-1] if line else near[0][0]
                    line.append(self.bit(self.cells[kind], 4 * around[col] + 2 * above[col] + left))
            known.end_row(row, line)
        return known.own()

    def level(self, a, width, height):
        """The three planes of a level."""
        made = [None] * 3
        for kind in (C, H, V):
            made[kind] = self.plane(kind, Known(a, made[C], made[H], *plane_size(kind, width, height)))
        require(30, not self.coder.is_beyond())
        return made


class Copies(Chances):
    """The cells of a segment that repeat one of their nearest four."""

    def __init__(self, data):
        super().__init__(data)
        self.copy = [[32768] * 20 for _ in range(3)]
        self.which = [[32768] * 3 for _ in range(5)]

    def plane(self, kind, known, voids):
        """Which cells of a pass are copies, and what they hold."""
        copied = np.zeros((known.height, known.width), np.uint8)
        cells = np.zeros((known.height, known.width), np.int64)
        above = [0] * known.width
        for row in range(known.height):
            near = zip(*(known.run(tap, row).tolist() for tap in TAPS[kind][:4]))
            left = 0
            for col, four in enumerate(near):
                if voids is not None and voids[row, col]:
                    left = above[col] = 0
                    continue
                alike, values = values_of(four)
                left = self.bit(self.copy[kind], 4 * alike + 2 * above[col] + left)
                above[col] = left
                if left:
                    k = 0
                    while k < len(values) - 1 and not self.bit(self.which[alike], k):
                        k += 1
                    copied[row, col], cells[row, col] = 1, values[k]
        require(34, not self.coder.is_beyond())
        return copied, cells


class Zones(Chances):
    """The zone of each block of 32 x 32 cells."""

    def __init__(self, data, width, height, count):
        super().__init__(data)
        self.which = [[32768] * 3 for _ in range(2)]
        self.count = count
        self.blocks = np.zeros((-(-height // 32), -(-width // 32)), np.uint8)
        for row, col in np.ndindex(self.blocks.shape):
            left = int(self.blocks[row, col - 1]) if col else 0
            above = int(self.blocks[row - 1, col]) if row else 0
            order = list(dict.fromkeys([left, above, *range(count)]))
            n = 0
            while n < count - 1 and not self.bit(self.which[left == above], n):
                n += 1
            self.blocks[row, col] = order[n]
        SEEN.add(f"{count} zones")
        require(38, self.coder.is_whole())

    def plane(self, level, width, height):
        """The zone of each cell of a pass."""
        side = 16 >> level
        return np.repeat(np.repeat(self.blocks, side, 0), side, 1)[:height, :width]


def values_of(four):
    """How four cells are alike, and their values: the most frequent first, the others as they come."""
    values = list(dict.fromkeys(four))
    if len(values) == 4:
        return 0, values
    most = max(values, key=four.count)
    if len(values) == 2:
        alike = four.count(most)
    else:
        alike = 4 if len(values) == 1 else 1
    values.remove(most)
    return alike, [most, *values]
