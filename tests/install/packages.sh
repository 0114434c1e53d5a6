#!/bin/sh
# Builds the packages of Debian in a copy of the sources, lets lintian judge them, and puts them into a
# repository. From there they are installed into a root folder of their own, a fresh Debian that has
# nothing of this machine. The tests of debian/tests use them there, each after what its Depends
# names was installed.
#
#   packages.sh SOURCES FOLDER    FOLDER is made anew; it keeps the packages
#   packages.sh --in ROOT         the second half, called by mmdebstrap
#
# Exits with 77 where a tool is missing (scripts/setup --long). It reads Debian's mirror.
set -eu

say() { printf '\n== %s\n' "$*"; }

# ---- In the fresh root ----

if [ "$1" = --in ]; then
  root=$2
  # Of the machine's surroundings nothing comes in.
  inside() {
    chroot "$root" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LC_ALL=C.UTF-8 \
      DEBIAN_FRONTEND=noninteractive "$@"
  }
  install() {
    say "apt-get install $*"
    inside apt-get install -qq -y --no-install-recommends -o Dpkg::Use-Pty=0 "$@" \
      >"$root/apt.log" 2>&1 || { cat "$root/apt.log" >&2; return 1; }
    inside dpkg-query -W -f '${Package} ${Version} ${db:Status-Status}\n' '*maide*' | grep ' installed$'
  }
  echo 'deb [trusted=yes] file:/srv/packages ./' >"$root/etc/apt/sources.list.d/maide.list"
  inside apt-get update -qq
  sed -n 's/^Tests: //p; s/^Depends: //p' "$root/srv/sources/debian/tests/control" |
    while read -r test && read -r depends; do
      # shellcheck disable=SC2046  # a list of words
      install $(echo "$depends" | tr -d ,) </dev/null
      say "debian/tests/$test"
      inside sh -c "cd /srv/sources && AUTOPKGTEST_TMP=\$(mktemp -d) debian/tests/$test" </dev/null
    done
  exit
fi

# ---- On this machine ----

sources=$1
folder=$2
for tool in dpkg-buildpackage dh dh_python3 lintian mmdebstrap git; do
  if ! command -v "$tool" >/dev/null; then
    echo "skipped: $tool is missing; scripts/setup --long installs it"
    exit 77
  fi
done

# Those that git tracks or would: no build, no model that a test left behind.
rm -rf "$folder"
mkdir -p "$folder/maide" "$folder/packages"
(cd "$sources" && git ls-files -z --cached --others --exclude-standard |
  xargs -0 sh -c 'for file; do if [ -e "$file" ]; then printf "%s\0" "$file"; fi; done' sh |
  tar --create --null --files-from=-) | tar --extract --directory "$folder/maide"

say "dpkg-buildpackage -us -uc"
(cd "$folder/maide" &&
  DEB_BUILD_OPTIONS="parallel=$(nproc) nocheck" dpkg-buildpackage -us -uc >../build.log 2>&1) ||
  { tail -n 100 "$folder/build.log" >&2; exit 1; }
mv "$folder"/*.deb "$folder/packages"
ls "$folder/packages"

say "lintian"
ln "$folder"/packages/*.deb "$folder"
lintian --fail-on error,warning "$folder"/*.changes

say "A repository, and a fresh root"
(cd "$folder/packages" && dpkg-scanpackages --multiversion . >Packages 2>scan.log)
release=$(. /etc/os-release && echo "$VERSION_CODENAME")
rm -rf "$folder"/maide/obj-*
mmdebstrap --quiet --variant=apt \
  --customize-hook="copy-in $folder/packages /srv" \
  --customize-hook='mkdir "$1/srv/sources"' \
  --customize-hook="sync-in $folder/maide /srv/sources" \
  --customize-hook="$0 --in \"\$1\"" \
  "$release" /dev/null
say "All packages were built, installed and used"
