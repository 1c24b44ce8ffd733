"""Bits, the table set, and symbols."""

import functools
import pathlib

import numpy as np

from basics import SEEN, require

TABLE = pathlib.Path(__file__).parents[2] / "format-spec/tables/codec-1.bin"


class Bits:
    """Side bits and raw bits."""

    def __init__(self, data):
        self.data, self.at, self.end = data, 0, 8 * len(data)

    def bits(self, count):
        require(26, self.at + count <= self.end)
        found = int.from_bytes(self.data[self.at >> 3 : self.at + count + 7 >> 3], "little") >> (self.at & 7)
        self.at += count
        return found & (1 << count) - 1

    def number(self, order):
        zeros = 0
        while not self.bits(1):
            zeros += 1
        require(26, order + zeros <= 64)
        found = (1 << order + zeros) + self.bits(order + zeros) - (1 << order)
        require(26, found < 1 << 64)
        return found

    def signed(self, order):
        n = self.number(order)
        return n >> 1 if n & 1 == 0 else -(n + 1 >> 1)

    def finish(self):
        """Nothing but the zeros that fill the last byte may be left."""
        require(35, self.end - self.at < 8 and not self.bits(self.end - self.at))


@functools.cache
def table_set():
    return TABLE.read_bytes()


@functools.cache
def shipped_filter(serial, kind, variant):
    """Weights of taps and codes of error weights."""
    at = 576 * 128 + ((serial * 3 + kind) * 4 + variant) * 61
    found = table_set()[at : at + 61]
    return np.frombuffer(found[:52], "<i2").tolist(), list(found[52:])


@functools.cache
def alias_table(table):
    """Frequencies, and for each bucket its cutoff, its other symbol and what is added to places of that one."""
    freq = np.frombuffer(table_set()[table * 128 :][:128], "<u2").tolist()
    cutoff, other, offset = freq.copy(), list(range(64)), [0] * 64
    under = [s for s in range(64) if freq[s] < 256]
    over = [s for s in range(64) if freq[s] > 256]
    while under and over:
        giver, into = over.pop(), under.pop()
        cutoff[giver] -= 256 - cutoff[into]
        other[into], offset[into] = giver, cutoff[giver] - cutoff[into]
        if cutoff[giver] < 256:
            under.append(giver)
        elif cutoff[giver] > 256:
            over.append(giver)
    return freq, cutoff, other, offset


class Symbols:
    """The symbols of a segment."""

    def __init__(self, data, count):
        lanes = 0 if count == 0 else 1 if count < 4096 else 4 if count < 65536 else 8
        require(33, len(data) >= 4 * lanes and (lanes or not data) and len(data) % 2 == 0)
        if lanes:
            SEEN.add(f"{lanes} state{'s' if lanes > 1 else ''}")
        self.state = np.frombuffer(data[: 4 * lanes], "<u4").tolist()
        self.refills = np.frombuffer(data[4 * lanes :], "<u2").tolist()
        self.taken = self.lane = 0
        self.any = False

    def symbol(self, table):
        return self.row((table,))[0]

    def row(self, tables):
        """As many symbols as there are tables."""
        state, refills, taken, lane, lanes = self.state, self.refills, self.taken, self.lane, len(self.state)
        found = []
        for table in tables:
            freq, cutoff, other, offset = alias_table(table)
            x = state[lane]
            s, place = x >> 8 & 63, x & 255
            if place >= cutoff[s]:
                s, place = other[s], place + offset[s]
            x = freq[s] * (x >> 14) + place
            if x < 65536:
                require(33, taken < len(refills))
                x = (x << 16) + refills[taken]
                taken += 1
            state[lane] = x
            lane += 1
            if lane == lanes:
                lane = 0
            found.append(s)
        self.taken, self.lane = taken, lane
        self.any |= bool(found)
        return found

    def finish(self):
        require(33, self.taken == len(self.refills) and all(x == 65536 for x in self.state))
        SEEN.update({"no symbols"} if self.state and not self.any else ())
