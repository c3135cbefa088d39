#!/usr/bin/env bash
# Makes the Debian packages and tries them in a fresh root of a release of Debian: installs them, flies the quick experiment
# as an ordinary user, builds the example of aloft-dev and flies it, removes all of it, and compares the files before and
# after. Needs root, debootstrap and apt's mirror. The packages are left in build-packages/.
#   tools/package_check.sh [debian12 | debian13]    [this machine's]
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
fail() { echo "tools/package_check.sh: $*" >&2; exit 1; }

own=debian$(. /etc/os-release && echo "$VERSION_ID")
name=${1:-$own}
case "$name" in
  debian12) codename=bookworm ;;
  debian13) codename=trixie ;;
  *) echo "tools/package_check.sh: '$name' is no release that Aloft supports; use debian12 or debian13" >&2; exit 2 ;;
esac
[ "$(id -u)" -eq 0 ] || fail "a root of $name can be made by root only: run it as root"
for program in debootstrap unshare chroot; do
  command -v "$program" > /dev/null || fail "a root of $name cannot be made without '$program'; tools/setup.sh --for tests installs its package"
done

packages=$PWD/build-packages/$name
rm -rf "$packages"
mkdir -p "$packages"
make_packages='tools/setup.sh && cpack --config build/CPackConfig.cmake -B "build-packages/$0" > "build-packages/$0/cpack.log"'
if [ "$name" = "$own" ]; then
  bash -c "$make_packages" "$name"
else
  tools/on_debian.sh "$name" --for programs bash -c "$make_packages" "$name"
fi || fail "the packages cannot be made; see $packages/cpack.log"
rm -rf "$packages/_CPack_Packages"
[ "$(ls "$packages"/*.deb | wc -l)" -eq 2 ] || fail "there should be two packages: $(ls "$packages"/*.deb)"

folder=$(mktemp -d)
trap 'rm -rf --one-file-system "$folder"' EXIT
export root=$folder/root packages
mirror=$(apt-get indextargets --format '$(REPO_URI)' 'Created-By: Packages' 'Origin: Debian' 'Component: main' | head -1)
[ -n "$mirror" ] || fail "a root of $name cannot be made: the sources of this machine's apt name no mirror of Debian"
debootstrap --variant=minbase "$codename" "$root" "$mirror" > "$folder/debootstrap.log" 2>&1 ||
  fail "a root of $name cannot be made from $mirror: $(tail -3 "$folder/debootstrap.log")"
apt-config dump | grep -E '^Acquire::(https?|Check-|Retries|ForceIP)' > "$root/etc/apt/apt.conf.d/90machine" || true
cp -L /etc/resolv.conf /etc/hosts "$root/etc/"
mkdir "$root/packages"
cp "$packages"/*.deb "$root/packages/"

cat > "$root/try.sh" << 'END'
set -euo pipefail
export DEBIAN_FRONTEND=noninteractive LANG=C.UTF-8
quietly() { "$@" > /packages/log 2>&1 || { cat /packages/log; echo "failed: $*"; exit 1; }; }
# What dpkg and apt keep about packages that they have removed is theirs.
files() { find / -xdev -path /packages -prune -o -path /tmp -prune -o -path /var/lib/dpkg -prune -o -path /var/lib/apt -prune -o \
  -path /var/cache -prune -o -path /var/log -prune -o -path /home -prune -o -name '*.pyc' -prune -o ! -type d -print | sort; }
quietly apt-get -q update
quietly apt-get -q install -y --no-install-recommends g++ cmake make  # what builds the example, in the root before and after
quietly useradd --create-home flyer
ldconfig
files > /packages/before
as_flyer() { setpriv --reuid flyer --regid flyer --init-groups env -i HOME=/home/flyer PATH=/usr/bin:/bin LANG=C.UTF-8 bash -c "cd; $1"; }

quietly apt-get -q install -y --no-install-recommends /packages/aloft_*.deb
as_flyer 'aloft --version && aloft run quick --out quick && aloft digest quick'
as_flyer 'aloft run quick --in-process --out again > /dev/null && aloft compare quick again --exact' | tail -1
quietly apt-get -q install -y --no-install-recommends /packages/aloft-dev_*.deb
as_flyer 'cp -r /usr/share/doc/aloft/examples/agent . && cmake -S agent -B built > log && cmake --build built >> log || { cat log; exit 1; }
  aloft agents --plugin built/libpatient_climber.so --check patient-climber
  aloft run quick --plugin built/libpatient_climber.so --agents min-height,patient-climber --trials 2 --out mine'
quietly apt-get -q purge -y --autoremove aloft aloft-dev
files > /packages/after
diff /packages/before /packages/after && echo "the packages are removed without a trace"
END
# A network of its own has no mirror in it, so the root shares the machine's.
enter() {
  set -euo pipefail
  mount -t proc proc "$root/proc"
  mount -t tmpfs -o mode=755 dev "$root/dev"
  for device in null zero full random urandom tty; do touch "$root/dev/$device"; mount --bind "/dev/$device" "$root/dev/$device"; done
  mkdir "$root/dev/shm"
  mount -t tmpfs -o mode=1777 shm "$root/dev/shm"
  ln -s /proc/self/fd "$root/dev/fd"
  chroot "$root" bash /try.sh
}
export -f enter
unshare --mount --pid --fork --kill-child bash -c enter || fail "the packages of $name do not pass"
echo "The packages of $name pass: $(cd "$packages" && ls ./*.deb | tr '\n' ' ')"
