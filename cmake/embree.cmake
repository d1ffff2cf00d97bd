# Embree: version 4, or 3 where a system has only that. RELUMINE_EMBREE becomes the number; the target is `embree`.
# Of several that are installed the newest is taken; -Dembree_DIR=PREFIX/lib/cmake/embree-VERSION chooses another.
set(CMAKE_FIND_PACKAGE_SORT_ORDER NATURAL)
set(CMAKE_FIND_PACKAGE_SORT_DIRECTION DEC)
find_package(embree QUIET GLOBAL)
file(STRINGS ${PROJECT_SOURCE_DIR}/packages/versions.txt least REGEX "^library Embree ")
string(REGEX REPLACE ".* " "" least "${least}")
string(REGEX MATCH "^[0-9]+" RELUMINE_EMBREE "${embree_VERSION}")
if(NOT embree_VERSION)
    set(embree_VERSION none)
endif()
if(NOT embree_FOUND OR embree_VERSION VERSION_LESS least OR RELUMINE_EMBREE GREATER 4)
    message(FATAL_ERROR "Embree: expected version 4, or 3 from ${least} on (libembree-dev on Debian and Ubuntu, embree-devel on Fedora, embree "
        "elsewhere; -Dembree_DIR where CMake does not look), got ${embree_VERSION}")
endif()
message(STATUS "Embree ${embree_VERSION}")
