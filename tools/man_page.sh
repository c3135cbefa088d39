#!/usr/bin/env bash
# Writes the man page of a program to standard output, made from its --help and, if it has commands, from theirs.
#   tools/man_page.sh PROGRAM
set -euo pipefail
program=${1:?tools/man_page.sh: name the program}
name=$(basename "$program")
version=$("$(dirname "$program")/aloft" --version)
export COLUMNS=80 LC_ALL=C.UTF-8

to_roff='
function roff(text) {
  gsub(/\\/, "\\e", text)
  gsub(/-/, "\\-", text)
  return text ~ /^[.'\'']/ ? "\\&" text : text
}
function heading(text) {
  if (level == "SH") print ".SH " toupper(roff(text)); else print ".PP\n.B " roff(text)
}
NR == 1 && level == "SS" { print ".SS " roff(title) }
part == "" && NF { description = description (description == "" ? "" : " ") $0; next }
part == "" {  # the first empty line
  part = "usage"
  if (level == "SH") print ".SH NAME\n" roff(name) " \\- " roff(description) "\n.SH SYNOPSIS"; else print roff(description) "\n.PP"
  next
}
part == "usage" && NF { sub(/^(Usage:)? */, ""); print ".B " roff($0); next }
part == "usage" { part = "entries"; next }
/^Examples?:$/ { part = "examples"; heading(substr($0, 1, length($0) - 1)); print ".nf"; next }
part == "examples" { print roff($0); next }
/^[A-Z].*:$/ { heading(substr($0, 1, length($0) - 1)); next }
/^  [^ ]/ {
  explained = match(substr($0, 3), /   */)
  print ".TP\n.B " roff(explained ? substr($0, 3, RSTART - 1) : substr($0, 3))
  if (explained) print roff(substr($0, 2 + RSTART + RLENGTH))
  next
}
NF { sub(/^ */, ""); print roff($0) }
END { if (part == "examples") print ".fi" }'

# The names that the help of a command lists as further commands.
commands() {
  "$@" --help | awk '/^[A-Z].*:$/ { listed = !/^(Options|Example|Examples|One of these is needed):$/ }
                     listed && /^  [a-z]/ { print $1 }'
}

# page LEVEL COMMAND...: the help of a command, as sections (SH) or as a section (SS), and that of each command below it.
page() {
  local level=$1 command
  shift
  "$@" --help | awk -v level="$level" -v name="$name" -v title="$name ${*:2}" "$to_roff"
  [ "$level" = SS ] || [ -z "$(commands "$@")" ] || echo ".SH THE COMMANDS"
  for command in $(commands "$@"); do
    [ "$command" = help ] || page SS "$@" "$command"
  done
}

echo ".TH ${name^^} 1 \"\" \"Aloft ${version%%+*}\" \"Aloft\""
echo ".ss 12 0"  # no wide gaps after "e.g."
page SH "$program"
[ "$name" = aloft ] || printf '.SH SEE ALSO\n.BR aloft (1)\n'
