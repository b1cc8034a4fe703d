# Writes OUT, a C++ file with every table under ROOT/assets/reference, and the chart that budgets pick from, as strings
# (cmake -DROOT=... -DOUT=... -P embed_data.cmake).
file(GLOB files ${ROOT}/assets/reference/*.csv)
list(REMOVE_ITEM files ${ROOT}/assets/reference/speed_accuracy.csv)
list(SORT files)
set(rows "")
foreach(file ${files})
    file(READ ${file} text)
    get_filename_component(name ${file} NAME_WE)
    string(APPEND rows "    {\"${name}\", R\"~~~(${text})~~~\"},\n")
endforeach()
file(READ ${ROOT}/assets/reference/speed_accuracy.csv chart)
file(WRITE ${OUT}.new "#include \"fluid/session/chart_table.h\"\n#include \"fluid/session/reference_data.h\"\nnamespace rivulet {\n"
    "static const ReferenceTable kTables[] = {\n${rows}};\n"
    "std::span<const ReferenceTable> referenceTables() { return kTables; }\n"
    "std::string_view builtInChart() { return R\"~~~(${chart})~~~\"; }\n}  // namespace rivulet\n")
file(RENAME ${OUT}.new ${OUT})
