# Functions that make the targets of engine/, fluid/, demos/ and tests/.

# rivulet_batches(TARGET SIZE): compiles the target's files up to SIZE at a time, folder by folder (the first two levels of a path), in batches
# of equal length: what headers declare and instantiate is compiled once a batch (docs/performance.md). A batch includes its files by paths
# from the root, so that ccache serves every checkout. Two files of a folder that define the same name in unnamed namespaces clash: rename one
# of them, or share it in a header of the folder. What needs to be alone has the property SKIP_UNITY_BUILD_INCLUSION. tests/checks/clang.py
# reads each file alone: no file comes to need its neighbour's includes.
function(rivulet_batches target size)
    if(NOT RIVULET_BATCHES)
        return()
    endif()
    get_target_property(sources ${target} SOURCES)
    list(FILTER sources INCLUDE REGEX "\\.cpp$")
    set(folders)
    foreach(source ${sources})
        get_source_file_property(generated ${source} GENERATED)
        get_source_file_property(alone ${source} SKIP_UNITY_BUILD_INCLUSION)
        if(NOT generated AND NOT alone)
            set_source_files_properties(${source} PROPERTIES HEADER_FILE_ONLY ON)
            cmake_path(ABSOLUTE_PATH source BASE_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR})
            cmake_path(RELATIVE_PATH source BASE_DIRECTORY ${PROJECT_SOURCE_DIR})
            get_filename_component(folder ${source} DIRECTORY)
            string(REGEX REPLACE "^([^/]+/[^/]+)/.*" "\\1" folder ${folder})
            string(MAKE_C_IDENTIFIER ${folder} folder)
            list(APPEND files_${folder} ${source})
            list(APPEND folders ${folder})
        endif()
    endforeach()
    list(REMOVE_DUPLICATES folders)
    foreach(folder ${folders})
        list(LENGTH files_${folder} count)
        math(EXPR batches "(${count} + ${size} - 1) / ${size}")
        foreach(number RANGE 1 ${batches})
            # Files [count (number - 1) / batches, count number / batches).
            math(EXPR first "${count} * (${number} - 1) / ${batches}")
            math(EXPR some "${count} * ${number} / ${batches} - ${first}")
            list(SUBLIST files_${folder} ${first} ${some} batch)
            list(TRANSFORM batch REPLACE "(.+)" "#include \"\\1\"\n")
            list(JOIN batch "" text)
            set(file ${PROJECT_BINARY_DIR}/batches/${target}/${folder}_${number}.cpp)
            file(CONFIGURE OUTPUT ${file} CONTENT "${text}")
            target_sources(${target} PRIVATE ${file})
            # Names of another file of the batch, and of a file that is included once, are no faults; false of std::optional (GCC bug 80635).
            if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
                set_source_files_properties(${file} PROPERTIES COMPILE_OPTIONS "-Wno-shadow;-Wno-subobject-linkage;-Wno-maybe-uninitialized")
            else()
                set_source_files_properties(${file} PROPERTIES COMPILE_OPTIONS "-Wno-shadow")
            endif()
        endforeach()
    endforeach()
endfunction()

# Of NAME.cpp and NAME_windows.cpp, the one that is for this system.
function(rivulet_of_this_system list)
    set(windows ${${list}})
    list(FILTER windows INCLUDE REGEX "_windows\\.cpp$")
    if(WIN32)
        list(TRANSFORM windows REPLACE "_windows\\.cpp$" ".cpp")
    endif()
    list(REMOVE_ITEM ${list} ${windows})
    set(${list} ${${list}} PARENT_SCOPE)
endfunction()

# rivulet_library(NAME FOLDERS...): a static library rivulet::NAME of every .cpp in the folders. Its symbols are hidden: a host's shared library
# that links it shows none of them.
function(rivulet_library name)
    set(sources)
    foreach(folder ${ARGN})
        file(GLOB_RECURSE found CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/${folder}/*.cpp)
        list(FILTER found EXCLUDE REGEX "/kernels/")  # compiled once an instruction set: fluid/CMakeLists.txt
        list(FILTER found EXCLUDE REGEX "/engine/scene/import/")  # rivulet_import: demos/CMakeLists.txt
        rivulet_of_this_system(found)
        list(APPEND sources ${found})
    endforeach()
    add_library(rivulet_${name} STATIC ${sources})
    add_library(rivulet::${name} ALIAS rivulet_${name})
    target_link_libraries(rivulet_${name} PRIVATE $<BUILD_INTERFACE:rivulet_settings>)
    set_target_properties(rivulet_${name} PROPERTIES EXPORT_NAME ${name} OUTPUT_NAME rivulet_${name} POSITION_INDEPENDENT_CODE ON
        CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON)
endfunction()
