#!/bin/sh
# SPDX-License-Identifier: MIT
#
# symbols.sh NM FILE...: nothing in these objects and archives of the LCM bridge allocates,
# starts a thread, or sleeps.
set -eu
nm=$1
shift

forbidden='malloc|calloc|realloc|reallocarray|free|strdup|strndup|asprintf|vasprintf|aligned_alloc|posix_memalign|mmap|pthread_create|thrd_create|fork|sleep|usleep|nanosleep|clock_nanosleep'
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
for file in "$@"; do
    "$nm" -u "$file" | sed -n 's/^ *U \([^@]*\).*/\1/p'
done | sort -u >"$folder/used"
grep -Eqx 'epoll_wait|poll' "$folder/used" # the objects are those of the loop, and nm was understood
grep -qx lcm_publish "$folder/used"
if grep -Ex "$forbidden" "$folder/used"; then
    echo "the bridge uses these: take the caller's memory, or poll()" >&2
    exit 1
fi
echo "$(wc -l <"$folder/used") symbols"
