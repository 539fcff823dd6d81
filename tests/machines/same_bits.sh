#!/usr/bin/env bash
# The built-in case on other processors than this one, with other vector instructions, threads, processes and BLAS:
# a line for each, and exit 1 where one computes other bits or cannot run.
#   same_bits.sh HEARTGEN [PROCESSOR...]    of qemu-user; default: SSE4.1 alone, with AVX, and two with AVX2 and FMA
set -uo pipefail

heartgen=$(realpath "$1")
shift
processors=("$@")
[ ${#processors[@]} -gt 0 ] || processors=(Penryn SandyBridge Haswell EPYC-Rome)
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 OMPI_MCA_rmaps_base_oversubscribe=1
no_vectors=glibc.cpu.hwcaps=-AVX2,-FMA,-AVX512F,-AVX2_Usable,-FMA_Usable,-AVX512F_Usable
libraries=/usr/lib/x86_64-linux-gnu
failed=0

# try NAME COMMAND...: one line.
try() {
  local name=$1 start=$SECONDS out
  shift
  out=$("$@" 2>&1)
  case $? in
    0) verdict="the same" ;;
    *) verdict="DIFFERS: $(tail -n 2 <<<"$out" | tr '\n' ' ')"; failed=1 ;;
  esac
  printf '%-44s %-10s %4d s  %s\n' "$name" "$verdict" $((SECONDS - start)) "$(awk '/^content id/ {print $3}' <<<"$out" | cut -c1-16)"
}

try "this processor" "$heartgen" selftest
try "C library without AVX2, FMA, AVX-512" env GLIBC_TUNABLES=$no_vectors "$heartgen" selftest
for simd in plain avx2 avx512; do
  if [ $simd = plain ] || grep -qw "${simd/avx512/avx512vl}" /proc/cpuinfo; then
    try "loops: $simd" "$heartgen" selftest --simd $simd
  else
    printf '%-44s %s\n' "loops: $simd" "not tried: this processor has none"
  fi
done
for threads in 1 2 3; do try "threads: $threads" "$heartgen" selftest --threads $threads; done
for ranks in 1 2 3; do try "processes: $ranks" mpirun -n $ranks "$heartgen" selftest; done
for blas in blas openblas-pthread; do
  try "BLAS: $blas" env LD_PRELOAD="$libraries/$blas/libblas.so.3" "$heartgen" selftest
done
for processor in "${processors[@]}"; do
  try "qemu-user: $processor" qemu-x86_64 -cpu "$processor" "$heartgen" selftest --threads 1
done
exit $failed
