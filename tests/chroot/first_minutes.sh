#!/usr/bin/env bash
# first_minutes.sh DIST BUNDLE.tar.zst [SCRATCH]: a stranger's first five minutes with nothing but the packages, in a bare
# Debian 12 (debootstrap, as root): install, version, Python, unpack a bundle, open it, run dolfinx's deck, examples, a build.
# Prints what each step took. Needs Debian's mirrors.
set -euo pipefail
dist=$(realpath "$1") bundle=$(realpath "$2") scratch=$(realpath -m "${3:-build/chroot}")
here=$(cd "$(dirname "$0")" && pwd)
base=$scratch/base root=$scratch/root
mkdir -p "$scratch"

if [ ! -e "$base/etc/debian_version" ]; then
  echo "a bare Debian 12, once"
  rm -rf "$base"
  debootstrap --variant=minbase bookworm "$base" > "$scratch/debootstrap.log"
fi
rm -rf "$root"
cp -a "$base" "$root"
mkdir -p "$root/dist"
cp "$dist"/*.deb "$root/dist/"
cp "$dist"/*-linux-x86_64.tar.gz "$root/dist/" 2>/dev/null || true
cp "$bundle" "$root/dist/bundle.tar.zst"
cp "$here/in_chroot.sh" "$root/in_chroot.sh"
mount -t proc proc "$root/proc"
mount --bind /dev "$root/dev"
trap 'umount "$root/dev" "$root/proc"' EXIT
cp /etc/resolv.conf "$root/etc/resolv.conf"
chroot "$root" /usr/bin/env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LC_ALL=C.UTF-8 bash /in_chroot.sh
