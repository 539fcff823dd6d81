#!/usr/bin/env bash
# Run by first_minutes.sh inside of the bare system.
set -euo pipefail
export DEBIAN_FRONTEND=noninteractive OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
cd /root
log=/root/log
counted=0  # seconds of the first five minutes
step() {  # step COUNTS "what" command...
  local counts=$1 what=$2 start=$SECONDS
  shift 2
  "$@" > "$log" 2>&1 || { tail -40 "$log"; echo "failed: $what"; exit 1; }
  local took=$((SECONDS - start))
  [ "$counts" = yes ] && counted=$((counted + took))
  printf '%4d s  %s\n' "$took" "$what"
}

tarball_runs() {
  tar xf /dist/*-linux-x86_64.tar.gz && heartgen-*-linux-x86_64/bin/heartgen --version &&
    heartgen-*-linux-x86_64/bin/heartgen selftest
}
if ls /dist/*-linux-x86_64.tar.gz > "$log" 2>&1; then step no "the tarball, with nothing installed: its self-test" tarball_runs; fi

echo "The first five minutes:"
step yes "apt-get update" apt-get update
step yes "install heartgen and python3-heartgen" apt-get install -y --no-install-recommends \
  /dist/heartgen_*.deb /dist/libheartgen0*.deb /dist/python3-heartgen_*.deb
step yes "heartgen --version" heartgen --version
step yes "unpack the bundle" heartgen unpack /dist/bundle.tar.zst bundle
step yes "open it in Python" python3 -c '
import time
start = time.perf_counter()
import heartgen
print("import", time.perf_counter() - start)
mesh = heartgen.open("bundle").mesh("myocardium")
print(mesh, time.perf_counter() - start)
assert len(mesh.fiber) == len(mesh.points)'
step yes "export for dolfinx" heartgen export bundle --to xdmf --mesh myocardium --output export
step yes "install dolfinx" apt-get install -y --no-install-recommends python3-dolfinx python3-h5py
step yes "dolfinx: activation times" python3 export/xdmf/myocardium_activation.py
tail -1 "$log"
echo "together $counted s"

echo "And then:"
step no "heartgen selftest" heartgen selftest
step no "phantom" heartgen phantom phantom --size 90,84,72 --spacing 2.6,2.6,2.6
step no "build of the phantom" heartgen build phantom/recipe.toml --output built --quiet --accept-doubtful
step no "install libheartgen-dev and a compiler" apt-get install -y --no-install-recommends /dist/libheartgen-dev_*.deb \
  cmake ninja-build g++ openmpi-bin
examples_run() {
  cmake -S /usr/share/doc/libheartgen-dev/examples -B examples -G Ninja -DCMAKE_BUILD_TYPE=Release
  cmake --build examples
  ctest --test-dir examples --output-on-failure
}
step no "the examples" examples_run
grep "tests passed" "$log"
