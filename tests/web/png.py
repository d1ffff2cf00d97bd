"""Pixels of a PNG file, with nothing but Python: 8 bits a channel, not interlaced."""
import struct
import zlib


def paeth(a, b, c):
    p = a + b - c
    pa, pb, pc = abs(p - a), abs(p - b), abs(p - c)
    return a if pa <= pb and pa <= pc else b if pb <= pc else c


def unfiltered(kind, row, above, step):
    """Undoes a row's filter in place."""
    for i in range(len(row)):
        left = row[i - step] if i >= step else 0
        corner = above[i - step] if i >= step else 0
        guess = (0, left, above[i], (left + above[i]) // 2, paeth(left, above[i], corner))[kind]
        row[i] = (row[i] + guess) & 255
    return row


class Picture:
    def __init__(self, path):
        data = path.read_bytes()
        at, packed = 8, b""
        while at < len(data):
            length, name = struct.unpack_from(">I4s", data, at)
            body = data[at + 8:at + 8 + length]
            if name == b"IHDR":
                self.width, self.height, bits, kind = struct.unpack_from(">IIBB", body)
                assert bits == 8 and kind in (2, 6), (bits, kind)
                self.step = 3 if kind == 2 else 4
            elif name == b"IDAT":
                packed += body
            at += length + 12
        raw, size = zlib.decompress(packed), self.width * self.step
        self.rows, above = [], bytes(size)
        for y in range(self.height):
            start = y * (size + 1)
            above = unfiltered(raw[start], bytearray(raw[start + 1:start + 1 + size]), above, self.step)
            self.rows.append(above)

    def luminance(self, x, y, reach=0):
        """Of what is shown, 0 to 1: the mean of a square of pixels."""
        total = count = 0
        for row in self.rows[max(y - reach, 0):y + reach + 1]:
            for i in range(max(x - reach, 0), min(x + reach + 1, self.width)):
                r, g, b = row[self.step * i:self.step * i + 3]
                total += 0.2126 * r + 0.7152 * g + 0.0722 * b
                count += 1
        return total / count / 255

    def alpha(self, x, y):
        return self.rows[y][self.step * x + 3] / 255
