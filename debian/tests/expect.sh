# What the tests share: they begin here, in a folder of their own.
set -eu
cd "$AUTOPKGTEST_TMP"
examples=/usr/share/doc/maide/examples

# expect STATUS COMMAND...: the command must end with that exit status.
expect() {
  expected=$1
  shift
  printf '$ %s\n' "$*"
  status=0
  "$@" || status=$?
  if [ "$status" -ne "$expected" ]; then
    echo "this ended with $status, not $expected: $*" >&2
    exit 1
  fi
}
