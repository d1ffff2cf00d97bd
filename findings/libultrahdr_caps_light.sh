#!/usr/bin/env bash
# libultrahdr: light above 49.26 times white is cut off, whatever the gain map says.
#
# Expected: a gain map up to 16 stops (GainMapMax and HDRCapacityMax 16, as gainmap-js writes for outdoor maps) gives 65,536
#           times white back as linear half floats, which hold it.
# Found:    49.25, which is 10,000 cd/m2 over a white of 203 cd/m2, the end of PQ. A sun of a panorama loses 99.9 % of its
#           light without a word. OpenImageIO, which reads JPEG by libultrahdr, gives the same.
# Tried:    imagecodecs 2026.3.6 (libultrahdr 1.4.0) and OpenImageIO 3.2.2.0 of PyPI, Pillow 13.0.0, Python 3.11.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
python3.11 -m venv venv
venv/bin/pip install -q imagecodecs==2026.3.6 OpenImageIO==3.2.2.0 Pillow==13.0.0
cat >gain.py <<'PYTHON'
import io
import struct

import imagecodecs
import OpenImageIO as oiio
from PIL import Image

XMP = b"http://ns.adobe.com/xap/1.0/\0"
HEAD = '<x:xmpmeta xmlns:x="adobe:ns:meta/"><rdf:RDF xmlns:rdf="http://www.w3.org/1999/02/22-rdf-syntax-ns#"><rdf:Description '
NAMES = 'xmlns:hdrgm="http://ns.adobe.com/hdr-gain-map/1.0/" hdrgm:Version="1.0" '
TAIL = "</rdf:Description></rdf:RDF></x:xmpmeta>"


def jpeg(grey):
    out = io.BytesIO()
    Image.new("RGB", (64, 32), (grey,) * 3).save(out, "JPEG", quality=95)
    return out.getvalue()


def with_xmp(file, text):
    data = XMP + (HEAD + NAMES + text + TAIL).encode()
    return file[:2] + b"\xff\xe1" + struct.pack(">H", len(data) + 2) + data + file[2:]


def two(most):
    second = with_xmp(
        jpeg(255),
        f'hdrgm:GainMapMin="0" hdrgm:GainMapMax="{most}" hdrgm:Gamma="1" hdrgm:OffsetSDR="0.015625" '
        f'hdrgm:OffsetHDR="0.015625" hdrgm:HDRCapacityMin="0" hdrgm:HDRCapacityMax="{most}" hdrgm:BaseRenditionIsHDR="False">',
    )
    items = (
        'xmlns:Container="http://ns.google.com/photos/1.0/container/" xmlns:Item="http://ns.google.com/photos/1.0/container/item/">'
        '<Container:Directory><rdf:Seq><rdf:li rdf:parseType="Resource"><Container:Item Item:Semantic="Primary" '
        'Item:Mime="image/jpeg"/></rdf:li><rdf:li rdf:parseType="Resource"><Container:Item Item:Semantic="GainMap" '
        f'Item:Mime="image/jpeg" Item:Length="{len(second)}"/></rdf:li></rdf:Seq></Container:Directory>'
    )
    return with_xmp(jpeg(255), items) + second


for most in (4, 16):
    file = two(most)
    with open("gain.jpg", "wb") as out:
        out.write(file)
    light = float(imagecodecs.ultrahdr_decode(file)[16, 32, 0])
    other = float(oiio.ImageInput.open("gain.jpg").read_image("float")[16, 32, 0])
    print(f"found: white of {2**most} times white: libultrahdr {light:g}, OpenImageIO {other:g}")
    expected = min((1 + 1 / 64) * 2**most - 1 / 64, 10000 / 203)
    assert abs(light / expected - 1) < 0.01 and abs(other / expected - 1) < 0.01
PYTHON
venv/bin/python gain.py
