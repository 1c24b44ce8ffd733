"""Conventions: rejections, checksums, numbers, the range coder."""

import struct

U32 = 0xFFFFFFFF
# Names of what the files so far have shown of the codec.
SEEN = set()


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

    def varint(self, most=10):
        value = shift = 0
        while True:
            byte = self.number(1)
            value |= (byte & 127) << shift
            if byte < 128:
                require(self.requirement, value < 1 << 64 and (byte or not shift))
                return value
            shift += 7
            require(self.requirement, shift < 7 * most)

    def float(self):
        form = self.number(1)
        if form < 9:
            return struct.unpack("<d", self.take(form).rjust(8, b"\0"))[0]
        p, q = self.varint(), self.varint()
        n = (p + 1) >> 1
        require(16, form == 9 and n < 1 << 53 and 0 < q < 1 << 53)
        return -(n / q) if p & 1 else n / q


class RangeDecoder:
    """Bits that were coded with probabilities of so many bits."""

    def __init__(self, data, precision):
        self.data, self.precision = data, precision
        self.low, self.high, self.taken = 0, U32, 4
        self.value = int.from_bytes(data[:4].ljust(4, b"\0"), "big")

    def bit(self, p):
        middle = self.low + ((self.high - self.low) * p >> self.precision)
        bit = int(self.value <= middle)
        self.low, self.high = (self.low, middle) if bit else (middle + 1, self.high)
        while self.low >> 24 == self.high >> 24:
            self.low, self.high = self.low << 8 & U32, (self.high << 8 & U32) + 255
            byte = self.data[self.taken] if self.taken < len(self.data) else 0
            self.value = (self.value << 8 & U32) + byte
            self.taken += 1
        return bit

    def is_beyond(self):
        return self.taken > len(self.data) + 4

    def is_whole(self):
        """Whether an encoder would have ended the same bits with these bytes."""
        count = next(n for n in range(5) if self.first(n) >= self.low)
        return self.value == self.first(count) and len(self.data) == self.taken - 4 + count

    def first(self, count):
        return self.high & U32 << 32 - 8 * count & U32


class Chances:
    """Bits whose probabilities follow the bits before them."""

    def __init__(self, data):
        self.coder = RangeDecoder(data, 16)

    def bit(self, chances, index):
        p = chances[index]
        bit = self.coder.bit(p)
        chances[index] += (65535 - p) >> 5 if bit else -(p >> 5)
        return bit
