# Writes OUT, a C++ file with every table under ROOT/tests/physics/data as a string (cmake -DROOT=... -DOUT=... -P embed_data.cmake).
file(GLOB files ${ROOT}/tests/physics/data/*.csv)
list(SORT files)
set(rows "")
foreach(file ${files})
    file(READ ${file} text)
    get_filename_component(name ${file} NAME_WE)
    string(APPEND rows "    {\"${name}\", R\"~~~(${text})~~~\"},\n")
endforeach()
file(WRITE ${OUT}.new "#include \"fluid/validate/reference_data.h\"\nnamespace rivulet {\nstatic const ReferenceTable kTables[] = {\n${rows}};\n"
    "std::span<const ReferenceTable> referenceTables() { return kTables; }\n}  // namespace rivulet\n")
file(RENAME ${OUT}.new ${OUT})
