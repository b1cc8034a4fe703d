# Writes OUT, a C++ file with every table under ROOT/assets/reference and ROOT/assets/gpus, and the chart that budgets pick from, as strings
# (cmake -DROOT=... -DOUT=... -P embed_data.cmake).
function(rows_of folder out)
    file(GLOB files ${ROOT}/assets/${folder}/*.csv)
    list(REMOVE_ITEM files ${ROOT}/assets/reference/speed_accuracy.csv)
    list(SORT files)
    set(rows "")
    foreach(file ${files})
        file(READ ${file} text)
        get_filename_component(name ${file} NAME_WE)
        string(LENGTH "${text}" left)
        set(at 0)
        set(pieces "")  # a literal has at most 65,536 bytes
        while(left GREATER 0)
            string(SUBSTRING "${text}" ${at} 30000 piece)
            string(APPEND pieces " R\"~~~(${piece})~~~\"")
            math(EXPR at "${at} + 30000")
            math(EXPR left "${left} - 30000")
        endwhile()
        string(APPEND rows "    {\"${name}\",${pieces}},\n")
    endforeach()
    set(${out} "${rows}" PARENT_SCOPE)
endfunction()
rows_of(reference references)
rows_of(gpus gpus)
file(READ ${ROOT}/assets/reference/speed_accuracy.csv chart)
file(WRITE ${OUT}.new "#include \"fluid/session/chart_table.h\"\n#include \"fluid/session/reference_data.h\"\nnamespace rivulet {\n"
    "static const ReferenceTable kTables[] = {\n${references}};\nstatic const ReferenceTable kGpus[] = {\n${gpus}};\n"
    "std::span<const ReferenceTable> referenceTables() { return kTables; }\n"
    "std::span<const ReferenceTable> gpuTables() { return kGpus; }\n"
    "std::string_view builtInChart() { return R\"~~~(${chart})~~~\"; }\n}  // namespace rivulet\n")
file(RENAME ${OUT}.new ${OUT})
