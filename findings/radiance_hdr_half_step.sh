#!/usr/bin/env bash
# Radiance (pvalue, and whatever reads .hdr): 1 is written and 1.004 comes back.
#
# Expected: powers of two survive a picture, whose pixels are mantissas of 8 bits with a common exponent.
# Found:    1 is stored as mantissa 128 of 256, and read as (128 + 0.5) / 128: 0.4 % brighter. A white furnace that is
#           an .hdr shows 1.004 in rtrace. Most other readers take mantissa / 256 and get 1.
# Tried:    pyradiance 1.3.1 of PyPI (Radiance 6.0a), Python 3.11.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
python3.11 -m venv venv
venv/bin/pip install -q pyradiance==1.3.1
radiance=$(venv/bin/python -c "import os, pyradiance; print(os.path.dirname(pyradiance.__file__))")
export RAYPATH=.:$radiance/lib PATH=$radiance/bin:$PATH
printf '1 1 1\n0.5 0.5 0.5\n' | pvalue -r -h -d -y 1 +x 2 >white.hdr
found=$(pvalue -h -H -d white.hdr | awk '{ printf "%s ", $1 }')
echo "found: $found"
[ "$found" = "1.004e+00 5.020e-01 " ]
cat >sky.rad <<'RAD'
void colorpict dome 7 red green blue white.hdr . frac(Px) 0 0 0
dome glow sky 0 0 4 1 1 1 0
sky source all 0 0 4 0 1 0 360
RAD
oconv sky.rad >sky.oct
rtraced=$(echo "0 0 0 0 1 0" | rtrace -h -ov sky.oct | awk '{ printf "%.3f", $1 }')
echo "found: rtrace sees $rtraced"
[ "$rtraced" = 1.004 ]
