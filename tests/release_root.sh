# Sourced by tests that install into a release of Debian of their own: a folder with its whole
# system, made by debootstrap from the archive that this machine installs from, and kept for the
# next time.

releases=${DYNCAL_RELEASES:-/var/tmp/dyncal-releases}

archive_of_this_system() {
  apt-get indextargets --format '$(ORIGIN) $(CODENAME) $(REPO_URI)' 'Created-By: Packages' |
    sed -n "s/^Debian $(. /etc/os-release && echo "$VERSION_CODENAME") //p" | head -n 1
}

# make_root FOLDER CODENAME: that release and nothing else.
make_root() {
  local root=$1 codename=$2
  [[ ! -f $root.made ]] || return 0
  mkdir -p "$releases"
  rm -rf --one-file-system "$root"
  echo "Installing $codename into $root"
  if ! debootstrap --variant=minbase "$codename" "$root" "$(archive_of_this_system)" \
    >"$root.log" 2>&1; then
    tail -n 5 "$root.log" >&2
    return 1
  fi
  apt-config dump | grep '^Acquire::' >"$root/etc/apt/apt.conf.d/90-as-outside" || true
  cp /etc/resolv.conf "$root/etc/"
  in_root "$root" apt-get update -qq
  touch "$root.made"
}

# in_root FOLDER COMMAND...: as root of that system, with this machine's network.
in_root() {
  enter_root '' "$@"
}

# The same with a loopback interface alone, so that nothing outside hears it.
in_root_alone() {
  enter_root --net "$@"
}

enter_root() {
  local network=$1 root=$2
  shift 2
  # shellcheck disable=SC2086 # no network is no word
  unshare --mount --pid $network --fork --kill-child bash -c '
    set -e
    root=$1; network=$2; shift 2
    [[ -z $network ]] || ip link set lo up multicast on
    mount --rbind "$root" "$root" # a mount, as the root of a system is
    mount -t proc proc "$root/proc"
    mount -t sysfs sysfs "$root/sys" # of the network namespace
    mount --bind /dev "$root/dev"
    mount --bind /dev/pts "$root/dev/pts" # terminals
    exec chroot "$root" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LANG=C.UTF-8 \
      DEBIAN_FRONTEND=noninteractive "$@"
  ' enter_root "$root" "$network" "$@"
}

# Ends the test with status 77 and one sentence if no such system can be made here.
skip_without_root() {
  local reason
  reason=$(why_no_root)
  if [[ $reason ]]; then
    echo "skipped: $reason"
    exit 77
  fi
}

why_no_root() {
  if [[ $EUID -ne 0 ]]; then
    echo "needs root"
  elif ! command -v debootstrap >/dev/null; then
    echo "there is no debootstrap (Debian: debootstrap)"
  elif ! unshare --mount --pid --net --fork true 2>/dev/null; then
    echo "this machine makes no such namespaces"
  fi
}
