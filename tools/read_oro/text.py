"""Texts: the coded texts of META."""

import copy
import functools
import pathlib

from basics import U32, RangeDecoder, require

TABLE = pathlib.Path(__file__).parents[2] / "format-spec/tables/text-1.txt"
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

    def copy(self):
        other = copy.copy(self)
        other.slots = [{at: slot.copy() for at, slot in slots.items()} for slots in self.slots]
        other.bets, other.weights = copy.deepcopy(self.bets), copy.deepcopy(self.weights)
        other.places, other.history = self.places.copy(), self.history.copy()
        return other

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


@functools.cache
def primed():
    model = Model()
    for byte in TABLE.read_bytes():
        for place in range(7, -1, -1):
            model.predict()
            model.update((0 if byte == 10 else byte) >> place & 1)
    return model


def texts(data, count):
    """The texts that the bytes hold."""
    if not count:
        require(24, not data)
        return []
    model = primed().copy()
    start = len(model.history)
    coder = RangeDecoder(data, 12)
    while count:
        model.update(coder.bit(model.predict()))
        require(24, not coder.is_beyond())
        require(23, len(model.history) - start <= 16 << 20)
        if model.partial == 1 and model.history[-1] == 0:
            count -= 1
    require(24, coder.is_whole())
    try:
        return [text.decode() for text in bytes(model.history[start:-1]).split(b"\0")]
    except UnicodeDecodeError:
        raise ValueError("R-023") from None
