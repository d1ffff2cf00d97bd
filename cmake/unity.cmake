# How sources are compiled: few, large translation units, since most of a small file's time goes into headers that its
# neighbours include, too.
#
#   relumine_compile(TARGET -O1|-O2 [KERNELS sources] [SIZE n] [ROOMS_TOGETHER] [PRECOMPILED name | OWN_HEADERS headers])
#
# Sources of a room (a folder of sources) are compiled together, at most SIZE at a time, so names in unnamed namespaces
# must differ within a room; with ROOMS_TOGETHER within the target. A source stays alone if it holds the code of a
# header-only library or includes one that is dear (CLI11, Draco, OpenMesh), or has compile options of its own, which
# are set before.
#
# KERNELS are inner loops over all receivers or rays. They gain from -O3; code that parses, calls and writes gains nothing
# from what is costly to compile. Those whose text is compiled once for each instruction set (Highway's
# foreach_target.h) are joined room by room, the others to one unit: the headers that they read, Highway's once for each
# instruction set, took most of their time.
#
# PRECOMPILED: whose headers are parsed once for many targets, `relumine_headers` where none is named. OWN_HEADERS: besides
# the common ones, for a target whose definitions differ.
option(RELUMINE_UNITY "Compile the sources of a folder together" ON)
set(RELUMINE_UNITY_SIZE 24 CACHE STRING "How many sources are compiled together at most")
mark_as_advanced(RELUMINE_UNITY_SIZE)

# Options are given to compilers that know them.
set(is_gnu_or_clang $<COMPILE_LANG_AND_ID:CXX,GNU,Clang,AppleClang>)
set(kernel_options $<$<AND:$<CONFIG:Release>,${is_gnu_or_clang}>:-O3>)

# Release is compiled on this level.
function(relumine_optimise target level)
    target_compile_options(${target} PRIVATE $<$<AND:$<CONFIG:Release>,${is_gnu_or_clang}>:${level}>)
endfunction()

function(relumine_compile target level)
    cmake_parse_arguments(arg "ROOMS_TOGETHER" "SIZE;PRECOMPILED" "KERNELS;OWN_HEADERS" ${ARGN})
    relumine_optimise(${target} ${level})
    if(RELUMINE_UNITY)
        relumine_join_kernels(${target} ${arg_KERNELS})
        relumine_compile_together(${target} "${arg_SIZE}" ${arg_ROOMS_TOGETHER})
    else()
        set_property(SOURCE ${arg_KERNELS} APPEND PROPERTY COMPILE_OPTIONS ${kernel_options})
        set_property(SOURCE ${arg_KERNELS} PROPERTY SKIP_PRECOMPILE_HEADERS ON)
    endif()
    if(NOT arg_PRECOMPILED)
        set(arg_PRECOMPILED relumine_headers)
    endif()
    if(NOT CMAKE_CXX_COMPILER_ID STREQUAL GNU)
        return()
    endif()
    if(arg_OWN_HEADERS)
        target_precompile_headers(${target} PRIVATE ${relumine_common_headers} ${arg_OWN_HEADERS})
    else()
        # Parsed for code that may come into shared libraries, also where a program takes it.
        if(arg_PRECOMPILED STREQUAL relumine_headers)
            target_compile_options(${target} PRIVATE -fPIC)
        endif()
        # Every target links what the headers' target links, because libraries define macros.
        target_link_libraries(${target} PRIVATE $<BUILD_INTERFACE:fmt::fmt>)
        target_precompile_headers(${target} REUSE_FROM ${arg_PRECOMPILED}${level})
    endif()
endfunction()

# The kernels of a room as one source, which Highway includes once for each instruction set; each kernel's own request
# to be included so is then heard no more.
function(relumine_join_kernels target)
    set(rooms "")
    foreach(source ${ARGN})
        get_filename_component(path ${source} ABSOLUTE)
        file(STRINGS ${path} is_for_targets REGEX "hwy/foreach_target.h" LIMIT_COUNT 1)
        set(room loops)
        if(is_for_targets)
            get_filename_component(room ${path} DIRECTORY)
            get_filename_component(room ${room} NAME)
        endif()
        list(APPEND rooms ${room})
        list(APPEND kernels_of_${room} "#include \"${path}\"\n")
        set_source_files_properties(${source} PROPERTIES HEADER_FILE_ONLY ON)
    endforeach()
    list(REMOVE_DUPLICATES rooms)
    foreach(room ${rooms})
        set(joined ${CMAKE_CURRENT_BINARY_DIR}/${target}_${room}.cpp)
        list(JOIN kernels_of_${room} "" text)
        if(NOT room STREQUAL loops)
            # Kernels name themselves, so the last word is the joined source's.
            set(name "#undef HWY_TARGET_INCLUDE\n#define HWY_TARGET_INCLUDE \"${joined}\"\n")
            set(text "${name}#include <hwy/foreach_target.h>\n#include <hwy/highway.h>\n${text}${name}")
        endif()
        file(CONFIGURE OUTPUT ${joined} CONTENT "${text}")
        target_sources(${target} PRIVATE ${joined})
        # Kernels read headers between pragmas that choose an instruction set. Precompiled, inline functions would be made
        # for another one, and round otherwise.
        set_source_files_properties(${joined} PROPERTIES
            COMPILE_OPTIONS ${kernel_options} SKIP_PRECOMPILE_HEADERS ON)
    endforeach()
endfunction()

function(relumine_compile_together target size rooms_together)
    if(NOT size)
        set(size ${RELUMINE_UNITY_SIZE})
    endif()
    set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
    # g++ warns of types in unnamed namespaces that a class holds, as if the class stood in a header.
    target_compile_options(${target} PRIVATE $<$<COMPILE_LANG_AND_ID:CXX,GNU>:-Wno-subobject-linkage>)
    get_target_property(sources ${target} SOURCES)
    list(FILTER sources INCLUDE REGEX "\\.cpp$")
    set(rooms "")
    foreach(source ${sources})
        get_filename_component(path ${source} ABSOLUTE)
        get_source_file_property(options ${source} COMPILE_OPTIONS)
        get_source_file_property(is_joined ${source} HEADER_FILE_ONLY)
        file(STRINGS ${path} alone REGEX "^#define STB_.*_IMPLEMENTATION|CLI/CLI.hpp|RELUMINE_VIEWER_MISSING|RELUMINE_OCIO|RELUMINE_HDR_PHOTOS|<draco/|<OpenMesh/" LIMIT_COUNT 1)
        if(alone OR options OR is_joined)
            continue()
        endif()
        set(room sources)
        if(NOT rooms_together)
            get_filename_component(room ${source} DIRECTORY)
            string(MAKE_C_IDENTIFIER "sources_${room}" room)
        endif()
        list(APPEND rooms ${room})
        list(APPEND ${room} ${source})
    endforeach()
    list(REMOVE_DUPLICATES rooms)
    foreach(room ${rooms})
        # Groups of equal size, so that no processor waits for a large one at the end.
        list(LENGTH ${room} count)
        math(EXPR num_groups "(${count} + ${size} - 1) / ${size}")
        set(index 0)
        foreach(source ${${room}})
            math(EXPR group "${index} * ${num_groups} / ${count}")
            set_source_files_properties(${source} PROPERTIES UNITY_GROUP "${room}_${group}")
            math(EXPR index "${index} + 1")
        endforeach()
    endforeach()
endfunction()

# What most sources include is parsed once for all libraries and the program (g++; CMAKE_DISABLE_PRECOMPILE_HEADERS
# turns it off). Sources still include all they use: `./dev lint` reads headers alone, without these.
set(relumine_common_headers
    <algorithm> <array> <atomic> <cmath> <cstdint> <filesystem> <functional> <map> <memory> <mutex> <numeric> <optional>
    <span> <sstream> <stdexcept> <stop_token> <string> <utility> <variant> <vector> <fmt/format.h> <glm/geometric.hpp>
    <glm/mat3x3.hpp> <glm/vec2.hpp> <glm/vec3.hpp>)

# relumine_precompile(NAME LEVEL HEADERS ...): makes a target NAME-LEVEL whose precompiled headers others take that are
# compiled on the same level.
function(relumine_precompile name level)
    set(source ${CMAKE_CURRENT_BINARY_DIR}/${name}${level}.cpp)
    file(CONFIGURE OUTPUT ${source} CONTENT "// Something to compile besides the headers.\n")
    add_library(${name}${level} OBJECT EXCLUDE_FROM_ALL ${source})
    target_compile_features(${name}${level} PRIVATE cxx_std_20)
    relumine_optimise(${name}${level} ${level})
    target_link_libraries(${name}${level} PRIVATE fmt::fmt glm::glm)
    target_precompile_headers(${name}${level} PRIVATE ${relumine_common_headers} ${ARGN})
endfunction()

foreach(level -O1 -O2)
    relumine_precompile(relumine_headers ${level})
    set_target_properties(relumine_headers${level} PROPERTIES POSITION_INDEPENDENT_CODE ON)
endforeach()
