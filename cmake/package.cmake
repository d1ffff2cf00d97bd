# What `cmake --install` makes beside the libraries and the program, whose targets install themselves: the CMake package
# that find_package(relumine) reads, the documents. cmake/debian.cmake makes Debian packages of the same components.
#
# Component runtime:       the program, shared libraries.
# Component engine:        librelumine_runtime (runtime/CMakeLists.txt).
# Component engine_development: what a program that embeds it is compiled with.
# Component python:        the Python package (python/CMakeLists.txt).
# Component development:   headers, static libraries, the CMake package.
# Component documentation: the documents.
# Component licence:       the licence.
include(CMakePackageConfigHelpers)
include(GNUInstallDirs)

foreach(target fmt::fmt glm::glm)
    get_target_property(is_imported ${target} IMPORTED)
    if(RELUMINE_BUILD_LIBRARY AND NOT is_imported)
        message(FATAL_ERROR "RELUMINE_INSTALL: expected an installed ${target}, got a target of this project; OFF builds without an install")
    endif()
endforeach()

# Static libraries need the libraries that they were compiled with: what CMake finds them with, how they are linked
# without CMake, and their Debian packages. A library that is headers only stands in $<BUILD_INTERFACE:...> where it is linked, and is not needed.
set(relumine_find_TBB_tbb "find_dependency(TBB)" -ltbb libtbb-dev)
set(relumine_find_fmt_fmt "find_dependency(fmt)" -lfmt libfmt-dev)
set(relumine_find_embree "find_dependency(embree ${RELUMINE_EMBREE})" -lembree${RELUMINE_EMBREE} libembree-dev)
# The level hides what Debian's Imath says (cmake/needs.cmake).
set(relumine_find_OpenEXR_OpenEXR "set(CMAKE_MESSAGE_LOG_LEVEL WARNING)\nfind_dependency(OpenEXR)\nunset(CMAKE_MESSAGE_LOG_LEVEL)" "-lOpenEXR -lIex -lImath" libopenexr-dev)
set(relumine_find_draco_draco "find_dependency(draco)" -ldraco libdraco-dev)
set(relumine_find_OpenMeshTools "find_dependency(OpenMesh)" "-lOpenMeshTools -lOpenMeshCore" libopenmesh-dev)
set(relumine_find_JPEG_JPEG "find_dependency(JPEG)" -ljpeg libjpeg-dev)
set(relumine_find_ZLIB_ZLIB "find_dependency(ZLIB)" -lz zlib1g-dev)
set(relumine_find_relumine_needs_deflate "relumine_needs_library(deflate libdeflate.h deflate)" -ldeflate libdeflate-dev)
set(relumine_find_meshoptimizer_meshoptimizer "find_dependency(meshoptimizer)" -lmeshoptimizer libmeshoptimizer-dev)
set(relumine_find_relumine_needs_webp "relumine_needs_library(webp webp/decode.h webp)" -lwebp libwebp-dev)
set(relumine_find_relumine_needs_hwy "relumine_needs_library(hwy hwy/highway.h hwy)" -lhwy libhwy-dev)
set(relumine_find_PkgConfig_OpenColorIO "find_dependency(PkgConfig)\npkg_check_modules(OpenColorIO REQUIRED IMPORTED_TARGET OpenColorIO)" -lOpenColorIO libopencolorio-dev pkg-config)
set(relumine_find_relumine_needs_avif "relumine_needs_library(avif avif/avif.h avif)" -lavif libavif-dev)
set(relumine_find_relumine_needs_jxl "relumine_needs_library(jxl jxl/decode.h jxl)" -ljxl libjxl-dev)
set(relumine_find_relumine_needs_jxl_threads "relumine_needs_library(jxl_threads jxl/thread_parallel_runner.h jxl_threads)" -ljxl_threads libjxl-dev)
set(relumine_find_relumine_needs_zstd "relumine_needs_library(zstd zstd.h zstd)" -lzstd libzstd-dev)
set(relumine_find_relumine_needs_xxhash "relumine_needs_library(xxhash xxhash.h xxhash)" -lxxhash libxxhash-dev)
set(RELUMINE_FIND_LINKED "")
set(RELUMINE_LINKED "")
set(development_depends libglm-dev)
if(NOT BUILD_SHARED_LIBS)
    set(linked "")
    get_property(libraries GLOBAL PROPERTY RELUMINE_LIBRARIES)
    foreach(library IN LISTS libraries)
        get_target_property(of_library relumine_${library} LINK_LIBRARIES)
        list(APPEND linked ${of_library})
    endforeach()
    list(FILTER linked EXCLUDE REGEX "BUILD_INTERFACE|^relumine::|^glm::glm$")
    list(REMOVE_DUPLICATES linked)
    foreach(target IN LISTS linked)
        string(REPLACE "::" "_" key ${target})
        if(NOT relumine_find_${key})
            message(FATAL_ERROR "cmake/package.cmake: expected a line relumine_find_${key} for ${target}")
        endif()
        list(POP_FRONT relumine_find_${key} find link)
        string(APPEND RELUMINE_FIND_LINKED "${find}\n")
        string(APPEND RELUMINE_LINKED " ${link}")
        list(APPEND development_depends ${relumine_find_${key}})
    endforeach()
    list(REMOVE_DUPLICATES development_depends)
endif()

# find_package() works with the runtime's package alone.
set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/relumine)
set(config development)
if(RELUMINE_BUILD_RUNTIME AND RELUMINE_RUNTIME_SHARED)
    set(config engine_development)
endif()
configure_package_config_file(cmake/relumineConfig.cmake.in ${PROJECT_BINARY_DIR}/relumineConfig.cmake
    INSTALL_DESTINATION ${package_dir} NO_SET_AND_CHECK_MACRO)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/relumineConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/relumineConfig.cmake ${PROJECT_BINARY_DIR}/relumineConfigVersion.cmake
    ${CMAKE_CURRENT_LIST_DIR}/find_library.cmake DESTINATION ${package_dir} COMPONENT ${config})
if(NOT RELUMINE_BUILD_LIBRARY)
    return()
endif()
install(EXPORT relumine NAMESPACE relumine:: FILE relumineTargets.cmake DESTINATION ${package_dir} COMPONENT development)

get_property(folders GLOBAL PROPERTY RELUMINE_LIBRARIES)
list(REMOVE_ITEM folders relumine)
list(JOIN folders "|" folders)
# For builds without CMake: pkg-config --cflags --libs relumine.
get_property(libraries GLOBAL PROPERTY RELUMINE_LIBRARIES)
list(REVERSE libraries)
list(TRANSFORM libraries PREPEND "-lrelumine_")
list(JOIN libraries " " RELUMINE_LIBRARIES_LINKED)
file(RELATIVE_PATH RELUMINE_PREFIX_FROM_PC /${CMAKE_INSTALL_LIBDIR}/pkgconfig /)
configure_file(cmake/relumine.pc.in ${PROJECT_BINARY_DIR}/relumine.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/relumine.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT development)

install(CODE "set(relumine_folders \"${folders}\")\nset(relumine_headers \"${CMAKE_INSTALL_INCLUDEDIR}/relumine\")"
    COMPONENT development)
install(SCRIPT ${CMAKE_CURRENT_LIST_DIR}/one_root.cmake COMPONENT development)

install(DIRECTORY docs examples DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT documentation
    PATTERN "site" EXCLUDE PATTERN "*.sh" EXCLUDE PATTERN "CMakeLists.txt" EXCLUDE)
install(FILES README.md CHANGELOG.md DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT documentation)
# Debian's packages name the licence in a file of their own.
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT licence)
if(PROJECT_IS_TOP_LEVEL)
    include(cmake/debian.cmake)
endif()
