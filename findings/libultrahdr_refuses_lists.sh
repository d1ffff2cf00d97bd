#!/usr/bin/env bash
# libultrahdr: a gain map whose header has GainMapMax for red, green and blue is refused.
#
# Expected: Adobe's specification lets GainMapMin, GainMapMax, Gamma and the offsets be one number or a list of three, and
#           Adobe's own pictures have lists.
# Found:    "xml parse error, could not find attribute hdrgm:Version", which is there. The same header with the number as an
#           attribute is read. OpenImageIO, which reads JPEG by libultrahdr, shows such a file as 8 bits without a word.
# Tried:    imagecodecs 2026.3.6 (libultrahdr 1.4.0) and OpenImageIO 3.2.2.0 of PyPI, Pillow 13.0.0, Python 3.11.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
python3.11 -m venv venv
venv/bin/pip install -q imagecodecs==2026.3.6 OpenImageIO==3.2.2.0 Pillow==13.0.0
cat >lists.py <<'PYTHON'
import io
import struct

import imagecodecs
import OpenImageIO as oiio
from PIL import Image

RDF = '<x:xmpmeta xmlns:x="adobe:ns:meta/"><rdf:RDF xmlns:rdf="http://www.w3.org/1999/02/22-rdf-syntax-ns#">{}</rdf:RDF></x:xmpmeta>'
NAMES = 'xmlns:hdrgm="http://ns.adobe.com/hdr-gain-map/1.0/" hdrgm:Version="1.0"'


def jpeg(description):
    out = io.BytesIO()
    Image.new("RGB", (64, 32), (255, 255, 255)).save(out, "JPEG", quality=95)
    data = b"http://ns.adobe.com/xap/1.0/\0" + RDF.format(description).encode()
    file = out.getvalue()
    return file[:2] + b"\xff\xe1" + struct.pack(">H", len(data) + 2) + data + file[2:]


first = jpeg(f"<rdf:Description {NAMES}/>")
rest = 'hdrgm:HDRCapacityMin="0" hdrgm:HDRCapacityMax="3"'
one = first + jpeg(f'<rdf:Description {NAMES} {rest} hdrgm:GainMapMax="3"/>')
lists = "<hdrgm:GainMapMax><rdf:Seq><rdf:li>3</rdf:li><rdf:li>3</rdf:li><rdf:li>3</rdf:li></rdf:Seq></hdrgm:GainMapMax>"
three = first + jpeg(f"<rdf:Description {NAMES} {rest}>{lists}</rdf:Description>")

light = float(imagecodecs.ultrahdr_decode(one)[16, 32, 0])
print(f"found: one number: white of {light:g}")
assert abs(light - 8.11) < 0.1
try:
    imagecodecs.ultrahdr_decode(three)
    raise SystemExit("found: a list is read")
except RuntimeError as error:
    print("found: a list of three:", error)
    assert "hdrgm:Version" in str(error)
with open("three.jpg", "wb") as file:
    file.write(three)
spec = oiio.ImageInput.open("three.jpg").spec()
print("found: OpenImageIO shows", spec.format)
assert str(spec.format) == "uint8"
PYTHON
venv/bin/python lists.py
