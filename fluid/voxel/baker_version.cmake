# cmake -DROOT=... -DOUT=... -P baker_version.cmake: a hash of every source that can change a baked field. It is part of the cache's keys,
# so a program never reads a field that another version baked differently.
file(GLOB sources ${ROOT}/fluid/voxel/*.cpp ${ROOT}/fluid/voxel/*.h ${ROOT}/shaders/voxel/*)
list(SORT sources)
set(all "")
foreach(source ${sources})
    file(SHA256 ${source} hash)
    string(APPEND all ${hash})
endforeach()
string(SHA256 all "${all}")
file(WRITE ${OUT} "namespace rivulet {\nextern const char kBakerVersion[];\nconst char kBakerVersion[] = \"${all}\";\n}\n")
