#!/usr/bin/env bash
# Fetches Embree 4.4.0 out of the PyPI wheel `embreex` into .cache/, which git ignores.
# Needs python3 with pip, on x86-64 Linux.
set -euo pipefail
cd "$(dirname "$0")"

if ! ls .cache/embreex.libs/libembree4*.so* >/dev/null 2>&1; then
  python3 -m pip download --quiet --no-deps --dest .cache/wheel \
    --only-binary :all: --python-version 3.11 --platform manylinux_2_28_x86_64 embreex==4.4.0.post1
  python3 -m zipfile -e .cache/wheel/embreex-*.whl .cache
fi
ls .cache/embreex.libs/
