#!/bin/sh
# Fills corpus/ with the small models of this repository and, where they are, of ../shared/models, and takes over the versions
# of the crates that are shipped.
set -eu
cd "$(dirname "$0")"
cp ../../Cargo.lock Cargo.lock
mkdir -p corpus/obj corpus/gltf corpus/glb corpus/image
models="../../models ../import_gltf/packed"
shared=../../../shared/models
[ -d "$shared" ] && models="$models $shared"

# Each file once, by its checksum, and none of more than 64 KiB: the fuzzer changes small files far more often.
copy() {
    find $models -type f -size -64k -name "*.$1" | while read -r file; do
        cp "$file" "corpus/$2/$(cksum <"$file" | tr ' ' '-').$1"
    done
}
copy obj obj
copy gltf gltf
copy glb gltf
copy glb glb
for kind in png jpg jpeg webp ktx2 tga bmp hdr; do copy "$kind" image; done

# An OBJ with the MTL file beside it, as the target takes them.
find $models -type f -size -32k -name '*.mtl' | while read -r mtl; do
    obj="${mtl%.mtl}.obj"
    if [ -f "$obj" ] && [ "$(wc -c <"$obj")" -lt 32768 ]; then
        { cat "$obj"; printf '\n#mtl\n'; cat "$mtl"; } >"corpus/obj/$(cksum <"$mtl" | tr ' ' '-')-with-mtl"
    fi
done
ls corpus | while read -r target; do echo "$target: $(ls "corpus/$target" | wc -l) files"; done
