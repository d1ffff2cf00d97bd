# Fewer, larger translation units: the sources of a room (a folder of sources) are compiled together, at most
# RELUMINE_UNITY_SIZE (or the size given) at a time, because most of a small file's time goes into headers that its neighbours include, too.
# So names in unnamed namespaces must differ within a room.
#
# A source stays alone if its text is compiled several times (Highway's foreach_target.h), if it holds the code of a
# header-only library or includes one that is dear (CLI11, Draco, OpenMesh), or if it has compile options of its own.
option(RELUMINE_UNITY "Compile the sources of a folder together" ON)
set(RELUMINE_UNITY_SIZE 12 CACHE STRING "How many sources are compiled together at most")
mark_as_advanced(RELUMINE_UNITY_SIZE)

function(relumine_compile_together target)
    set(most ${RELUMINE_UNITY_SIZE})
    if(ARGC GREATER 1)
        set(most ${ARGV1})
    endif()
    if(NOT RELUMINE_UNITY)
        return()
    endif()
    set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
    # g++ warns of types in unnamed namespaces that a class holds, as if the class stood in a header.
    target_compile_options(${target} PRIVATE -Wno-subobject-linkage)
    get_target_property(sources ${target} SOURCES)
    list(FILTER sources INCLUDE REGEX "\\.cpp$")
    set(rooms "")
    foreach(source ${sources})
        get_filename_component(path ${source} ABSOLUTE)
        file(STRINGS ${path} alone REGEX "hwy/foreach_target.h|^#define STB_.*_IMPLEMENTATION|CLI/CLI.hpp|RELUMINE_VIEWER_MISSING|RELUMINE_OCIO|<draco/|<OpenMesh/" LIMIT_COUNT 1)
        if(alone)
            continue()
        endif()
        get_filename_component(room ${source} DIRECTORY)
        string(MAKE_C_IDENTIFIER "sources_${room}" room)
        list(APPEND rooms ${room})
        list(APPEND ${room} ${source})
    endforeach()
    list(REMOVE_DUPLICATES rooms)
    foreach(room ${rooms})
        # Groups of equal size, so that no processor waits for a large one at the end.
        list(LENGTH ${room} size)
        math(EXPR num_groups "(${size} + ${most} - 1) / ${most}")
        set(index 0)
        foreach(source ${${room}})
            math(EXPR group "${index} * ${num_groups} / ${size}")
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

# relumine_precompile(NAME HEADERS ...): makes a target whose precompiled headers others take.
function(relumine_precompile name)
    set(source ${CMAKE_CURRENT_BINARY_DIR}/${name}.cpp)
    file(CONFIGURE OUTPUT ${source} CONTENT "// Something to compile besides the headers.\n")
    add_library(${name} OBJECT EXCLUDE_FROM_ALL ${source})
    target_compile_features(${name} PRIVATE cxx_std_20)
    target_link_libraries(${name} PRIVATE fmt::fmt glm::glm)
    target_precompile_headers(${name} PRIVATE ${relumine_common_headers} ${ARGN})
endfunction()

# relumine_use_precompiled(TARGET NAME): every target links what NAME links, because libraries define macros.
function(relumine_use_precompiled target name)
    if(NOT CMAKE_CXX_COMPILER_ID STREQUAL GNU)
        return()
    endif()
    target_link_libraries(${target} PRIVATE $<BUILD_INTERFACE:fmt::fmt>)
    target_precompile_headers(${target} REUSE_FROM ${name})
    # Kernels read headers between pragmas that choose an instruction set. Precompiled, inline functions would be made
    # for another one, and round otherwise.
    get_target_property(sources ${target} SOURCES)
    list(FILTER sources INCLUDE REGEX "\\.cpp$")
    foreach(source ${sources})
        get_filename_component(path ${source} ABSOLUTE)
        file(STRINGS ${path} is_kernel REGEX "hwy/(foreach_target|highway).h" LIMIT_COUNT 1)
        if(is_kernel)
            set_source_files_properties(${source} PROPERTIES SKIP_PRECOMPILE_HEADERS ON)
        endif()
    endforeach()
endfunction()

relumine_precompile(relumine_headers)
set_target_properties(relumine_headers PROPERTIES POSITION_INDEPENDENT_CODE ON)
