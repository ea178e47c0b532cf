#!/bin/sh
# SPDX-License-Identifier: MIT
#
# man_page.sh PROGRAM PAGE: the options that the program's --help names are those of its manual
# page.
set -eu
LC_ALL=C
export LC_ALL
program=$1
page=$2

folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
options() {
    grep -o -e '--[a-z][a-z-]*' | sort -u
}
"$program" --help | options >"$folder/help"
sed 's/\\-/-/g' "$page" | options >"$folder/page"
test -s "$folder/help"
diff -u "$folder/help" "$folder/page"
echo "$(wc -l <"$folder/help") options"
