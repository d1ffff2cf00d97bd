#!/usr/bin/env python3
"""Writes a torus above a floor, each with its chart of one atlas: atlas.py OUT.obj [SEGMENTS].

The charts cover 97 % of the atlas, so --receivers texels:WxH has nearly W * H receivers.
"""
import math
import sys


def grid(write, columns, rows, point, chart, first):
    """Writes a grid of vertices with their uvs, and its triangles. Returns the number after its last vertex."""
    u0, u1, v0, v1 = chart
    for j in range(rows + 1):
        for i in range(columns + 1):
            s, t = i / columns, j / rows
            write("v {:.6f} {:.6f} {:.6f}\n".format(*point(s, t)))
            write(f"vt {u0 + s * (u1 - u0):.6f} {v0 + t * (v1 - v0):.6f}\n")
    for j in range(rows):
        for i in range(columns):
            a = first + j * (columns + 1) + i
            b, c, d = a + 1, a + columns + 2, a + columns + 1
            write(f"f {a}/{a} {b}/{b} {c}/{c}\nf {a}/{a} {c}/{c} {d}/{d}\n")
    return first + (columns + 1) * (rows + 1)


def torus(s, t):
    around, across = 2 * math.pi * s, -2 * math.pi * t
    ring = 1 + 0.4 * math.cos(across)
    return ring * math.cos(around), 0.6 + 0.4 * math.sin(across), ring * math.sin(around)


def floor(s, t):
    return 6 * s - 3, 0.0, 3 - 6 * t


def main():
    segments = int(sys.argv[2]) if len(sys.argv) > 2 else 200
    with open(sys.argv[1], "w", encoding="ascii") as file:
        after = grid(file.write, segments, segments // 2, torus, (0.005, 0.745, 0.005, 0.995), 1)
        grid(file.write, segments // 2, segments, floor, (0.755, 0.995, 0.005, 0.995), after)


main()
