#!/usr/bin/env bash
# Downloads a data set of datasets/ from its public source, checks what arrived and unpacks it.
#   scripts/download_datasets.sh NAME [DATA_ROOT]      DATA_ROOT: default $EVIGRID_DATA, else ./data
# An interrupted download is resumed by the same command. Needs curl and unzip.
set -euo pipefail

fail() { echo "download_datasets.sh: $*" >&2; exit 1; }

datasets=$(dirname "$0")/../datasets
name=${1:-}
root=${2:-${EVIGRID_DATA:-data}}
toml=$datasets/$name.toml
known=$(cd "$datasets" && echo ./*.toml)
[[ -n $name && -f $toml ]] || fail "usage: NAME [DATA_ROOT]; names: $(echo "$known" | sed 's|\./||g; s|\.toml||g')"

value() { sed -n "s/^$1 = \"\(.*\)\"$/\1/p" "$toml"; }
list() { sed -n "s/^$1 = \[\(.*\)\]$/\1/p" "$toml" | tr -d '",'; }

dir=$root/$(value dir)
unpack_into=$root/$(value unpack_into)
archives=$root/archives
mkdir -p "$unpack_into" "$archives"
echo "$name: $(value title)"
echo "licence: $(value licence); source: $(value origin)"

for url in $(value url); do
    archive=$archives/$(basename "$url")
    if [[ ! -f $archive ]]; then
        # A part that is whole already stays from a run that ended between the download and the renaming.
        unzip -tqq "$archive.part" >/dev/null 2>&1 ||
            curl --fail --location --retry 3 --continue-at - --output "$archive.part" "$url" ||
            fail "cannot download $url (if $archive.part is no part of it, delete that)"
        # Every file in the archive against its checksum.
        unzip -tqq "$archive.part" || fail "not a whole archive (delete it and try again): $archive.part"
        mv "$archive.part" "$archive"
    fi
    unzip -qo "$archive" -d "$unpack_into"
done

for path in $(list expect); do
    [[ -e $dir/$path ]] || fail "not in the archives: expected $dir/$path"
done
# KITTI's folders hold one file for each line of their time stamps.
for stamps in "$dir"/*/timestamps.txt; do
    [[ -f $stamps ]] || continue
    expected=$(grep -c . "$stamps")
    found=$(find "$(dirname "$stamps")/data" -type f | wc -l)
    [[ $found -eq $expected ]] || fail "expected $expected files, found $found: $(dirname "$stamps")/data"
done
echo "complete: $dir (the archives in $archives are no longer needed)"
echo "next: evigrid check $dir"
