#!/usr/bin/env bash
# usd-core: UsdUtils has no ComplianceChecker any more.
#
# Expected: `UsdUtils.ComplianceChecker().CheckCompliance(path)`, what usdchecker has stood on for years.
# Found:    an AttributeError. UsdValidation, which is in the wheel with its validators, does the same work.
# Tried:    usd-core 26.11 of PyPI, Python 3.11.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
python3.11 -m venv venv
venv/bin/pip install -q usd-core==26.11
cat >check.py <<'PYTHON'
from pxr import Usd, UsdUtils, UsdValidation

assert not hasattr(UsdUtils, "ComplianceChecker")
validators = UsdValidation.ValidationRegistry().GetOrLoadAllValidators()
stage = Usd.Stage.CreateInMemory()
stage.DefinePrim("/A")
errors = UsdValidation.ValidationContext(validators).Validate(stage)
print("found: no ComplianceChecker,", len(validators), "validators:", sorted({e.GetName() for e in errors}))
assert len(validators) > 20 and errors
print("held")
PYTHON
venv/bin/python check.py
