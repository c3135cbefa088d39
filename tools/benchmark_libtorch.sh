#!/usr/bin/env bash
# Training with Aloft's kernels beside libtorch, in one run. Installs Debian's libtorch-dev and a fast BLAS for it (nothing else
# needs them), builds Aloft's kernels and bench/libtorch, runs. About a minute after the build.
set -euo pipefail
cd "$(dirname "$0")/.."
if ! dpkg -s libtorch-dev libopenblas0-serial > /dev/null 2>&1; then
  sudo=$([ "$(id -u)" = 0 ] || echo sudo)
  $sudo apt-get install -y --no-install-recommends libtorch-dev libopenblas0-serial
fi
[ -f build/build.ninja ] || cmake --preset release
cmake --build build --target aloft_learn
cmake -S bench/libtorch -B build/libtorch -G Ninja -DALOFT_BUILD="$PWD/build" -DCMAKE_RUNTIME_OUTPUT_DIRECTORY="$PWD/build/bin" > /dev/null
cmake --build build/libtorch
exec env OMP_NUM_THREADS=1 build/bin/libtorch_benchmark
