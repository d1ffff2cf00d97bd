#!/usr/bin/env bash
# Radiance (rtrace): a closed room is lit from outside where a ray meets the very edge of two walls.
#
# Expected: a closed cube of six polygons under a white sky is dark inside, whichever point a ray meets.
# Found:    on an edge half of the sky comes in: 0.25 with walls of albedo 0.5. A ray 1e-6 beside the edge finds 0. Rays
#           through the middles of pixels meet edges exactly where a camera stands in the middle of a symmetric room: a row
#           of bright pixels along each edge, up to ten times as bright as those around it in a room with one open side.
#           rpict jitters its rays (-pj 0.67), which hides it.
# Tried:    pyradiance 1.3.1 of PyPI (RADIANCE 6.0a), Python 3.11.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
python3.11 -m venv venv
venv/bin/pip install -q pyradiance==1.3.1 numpy==1.26.4
home=$(venv/bin/python -c 'import sysconfig; print(sysconfig.get_paths()["purelib"] + "/pyradiance")')
export RAYPATH=.:$home/lib PATH=$home/bin:$PATH
venv/bin/python - >room.rad <<'PYTHON'
print("void plastic wall 0 0 5 0.5 0.5 0.5 0 0\nvoid glow light 0 0 4 1 1 1 0\nlight source sky 0 0 4 0 0 1 360")
for axis in range(3):
    for side in (-1, 1):
        corners = []
        for u, v in ((-1, -1), (1, -1), (1, 1), (-1, 1)):
            corner = [0, 0, 0]
            corner[axis], corner[(axis + 1) % 3], corner[(axis + 2) % 3] = side, u, v
            corners += corner
        print(f"wall polygon wall{axis}{side} 0 0 12", *corners)
PYTHON
oconv room.rad >room.oct
printf '%s\n' "0 0 0 1 0 0.3" "0 0 0 1 -0.999999 0.3" "0 0 0 1 -1 0.3" "0 0 0 1 1 0" |
    rtrace -h -w -ab 1 -aa 0 -ad 4096 -as 0 -lw 1e-6 room.oct >seen.txt
venv/bin/python - <<'PYTHON'
seen = [float(line.split()[0]) for line in open("seen.txt")]
print("wall, beside an edge, on an edge, on another:", *(f"{each:.3f}" for each in seen))
assert seen[0] == 0 and seen[1] == 0, "walls are not dark"
assert all(0.2 < each < 0.3 for each in seen[2:]), "edges do not leak as told"
print("as told: half of the sky comes in on the edges of a closed room")
PYTHON
