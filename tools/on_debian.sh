#!/usr/bin/env bash
# Runs a command on another release of Debian: in a root of that release, with a network of its own that has no way out,
# in this checkout (there /checkout) with build folders of its own. Needs root. Roots and build folders are kept in
# ~/.cache/aloft, and may be deleted at any time; a root is made from the mirror of this machine's apt.
#   tools/on_debian.sh debian12 | debian13 [--for PURPOSE | --fresh] [--online] COMMAND ...
#     --for PURPOSE   first installs the packages of this purpose (tools/setup.sh) [tests]
#     --fresh         in a root of its own, as debootstrap makes it, with empty build folders; all is deleted afterwards
#     --online        in the machine's network
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
refuse() { echo "tools/on_debian.sh: $*" >&2; exit 2; }

declare -A codename_of=([debian12]=bookworm [debian13]=trixie)
name=${1:-}
codename=${codename_of[${name:-none}]:-}
[ -n "$codename" ] || refuse "'$name' is no release that Aloft supports; use debian12 or debian13"
shift
purpose=tests
fresh=""
network=(--net)
while [ $# -gt 0 ]; do
  case "$1" in
    --for)
      purpose=${2:-}
      case "$purpose" in
        flight | programs | tests | integration | packages | python) ;;
        *) refuse "--for '$purpose' is unknown; use flight, programs, tests, integration, packages or python" ;;
      esac
      shift 2
      ;;
    --fresh) fresh=yes; shift ;;
    --online) network=(); shift ;;
    *) break ;;
  esac
done
[ $# -gt 0 ] || refuse "name the command to run"

# A root that cannot be made is a failure: what was to be tested there has not been tested.
[ "$(id -u)" -eq 0 ] || refuse "a root of $name can be made and entered by root only: run it as root"
for program in debootstrap unshare setpriv ip chroot flock; do
  command -v "$program" > /dev/null ||
    refuse "a root of $name cannot be made or entered without '$program'; tools/setup.sh --for tests installs its package"
done
unshare --mount --net --pid --fork true 2> /dev/null ||
  refuse "a root of $name cannot be entered: this machine allows no namespaces (unshare --mount --net --pid)"

cache=${XDG_CACHE_HOME:-$HOME/.cache}/aloft
export root=$cache/roots/$name
builds=$cache/builds/$name-$(echo "$PWD at /checkout" | sha256sum | cut -c 1-12)  # a checkout has build folders of its own
export builds
export ccache=${CCACHE_DIR:-$HOME/.cache/ccache}
unfinished=$root.unfinished  # is there as long as the root must not be used

# Mounts, processes and network of a command disappear with it, also if this script is killed.
isolated() { setpriv --pdeathsig KILL unshare --mount --pid --fork --kill-child "$@"; }

# enter COMMAND ...: in namespaces of isolated(), mounts what a running system has, and runs the command in the root.
enter() {
  set -euo pipefail
  trap 'exit 130' INT
  trap 'exit 143' TERM
  cp -L /etc/resolv.conf /etc/hosts "$root/etc/"
  mount --bind "$root" "$root"  # in a root that is no mount, commands could not have mounts of their own
  mount -t proc proc "$root/proc"
  mount -t sysfs -o ro sys "$root/sys" 2> /dev/null || mount --rbind /sys "$root/sys"
  mount --rbind /dev "$root/dev"
  mount -t tmpfs -o mode=1777 shm "$root/dev/shm"
  mount -t tmpfs -o mode=1777 tmp "$root/tmp"
  mount -t tmpfs run "$root/run"
  mkdir -p "$root/checkout"
  mount --bind "$PWD" "$root/checkout"
  for folder in build build-asan build-tsan; do
    mkdir -p "$PWD/$folder" "$builds/$folder"
    mount --bind "$builds/$folder" "$root/checkout/$folder"
  done
  mount --bind "$ccache" "$root/root/.cache/ccache"
  [ ! -f ~/.npmrc ] || mount --bind -o ro ~/.npmrc "$root/root/.npmrc"
  if [ "$(readlink /proc/self/ns/net)" != "$network_of_machine" ]; then
    ip link set lo up
    ip link set lo multicast on
    ip route add 224.0.0.0/4 dev lo
  fi
  chroot "$root" /usr/bin/env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LANG=C.UTF-8 TERM="${TERM:-dumb}" \
    ${http_proxy:+http_proxy="$http_proxy"} ${https_proxy:+https_proxy="$https_proxy"} ${no_proxy:+no_proxy="$no_proxy"} \
    /bin/sh -c 'cd /checkout && exec "$@"' sh "$@"
}
export -f enter
network_of_machine=$(readlink /proc/self/ns/net)
export network_of_machine

# The addresses of Debian's mirrors in the sources of this machine's apt: "CODENAME URI" for each suite.
mirrors() { apt-get indextargets --format '$(CODENAME) $(REPO_URI)' 'Created-By: Packages' 'Origin: Debian' 'Component: main'; }

make_root() {
  local sources mirror security proxy keyring=/usr/share/keyrings/debian-archive-keyring.gpg
  [ -f "$keyring" ] || refuse "a root of $name cannot be made without $keyring (package debian-archive-keyring)"
  sources=$(mirrors)
  [ -n "$sources" ] || { apt-get -q update; sources=$(mirrors); }
  mirror=$(awk '$1 !~ /-/ {print $2; exit}' <<< "$sources")
  security=$(awk '$1 ~ /-security$/ {print $2; exit}' <<< "$sources")
  [ -n "$mirror" ] || refuse "a root of $name cannot be made: the sources of this machine's apt name no mirror of Debian"
  proxy=""
  eval "$(apt-config shell proxy Acquire::http::Proxy)"
  http_proxy=${http_proxy:-$proxy} isolated debootstrap --variant=minbase --keyring="$keyring" "$codename" "$root" "$mirror"
  {
    echo "deb $mirror $codename main"
    echo "deb $mirror $codename-updates main"
    [ -z "$security" ] || echo "deb $security $codename-security main"
  } > "$root/etc/apt/sources.list"
  # Fetches as this machine's apt does, e.g. through its proxy; trusts the certificates that were added to Debian's.
  apt-config dump | grep -E '^Acquire::(https?|Check-|Retries|ForceIP)' > "$root/etc/apt/apt.conf.d/90machine" || true
  echo 'DPkg::Post-Invoke { "rm -f /var/cache/apt/archives/*.deb"; };' >> "$root/etc/apt/apt.conf.d/90machine"
  mkdir -p "$root/usr/local/share/ca-certificates" "$root/root/.cache/ccache"
  [ ! -d /usr/local/share/ca-certificates ] || cp -rL /usr/local/share/ca-certificates "$root/usr/local/share/"
  touch "$root/root/.npmrc"
  echo force-unsafe-io > "$root/etc/dpkg/dpkg.cfg.d/unsafe-io"  # a root that loses its power is made anew
  # Services that packages bring are not started.
  printf '#!/bin/sh\nexit 101\n' > "$root/usr/sbin/policy-rc.d"
  chmod +x "$root/usr/sbin/policy-rc.d"
  printf '[safe]\n\tdirectory = *\n' > "$root/etc/gitconfig"  # the checkout may belong to another user
}

mkdir -p "$cache/roots" "$builds" "$ccache"
if [ -n "$fresh" ]; then
  folder=$(mktemp -d "$cache/roots/fresh.XXXXXX")
  trap 'rm -rf --one-file-system "$folder"' EXIT
  trap 'exit 130' INT
  trap 'exit 143' TERM
  root=$folder/root
  builds=$folder/builds
  make_root
else
  exec 9> "$root.lock"
  flock 9
  # One that was interrupted is made anew, because nothing tells how far it came.
  [ ! -e "$unfinished" ] || rm -rf --one-file-system "$root"
  touch "$unfinished"
  [ -d "$root" ] || make_root
  isolated bash -c 'enter "$@"' enter tools/setup.sh --for "$purpose" --install
  rm "$unfinished"
  exec 9>&-
fi
isolated "${network[@]}" bash -c 'enter "$@"' enter "$@"
