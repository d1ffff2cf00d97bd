# g++ searches its own memory for garbage as often as its use doubles, which takes an eighth of the time of a
# translation unit. Below 1 GB, it leaves that: the largest unit needs 0.7 instead of 0.6 GB.
if(PROJECT_IS_TOP_LEVEL)
    add_compile_options($<$<COMPILE_LANG_AND_ID:CXX,GNU>:--param=ggc-min-heapsize=1000000>)
endif()

# One library per folder:
#
#   relumine_library(NAME [INTERNAL]
#       HEADERS ...           what users of the library include: installed, each verified to compile alone
#       PRIVATE_HEADERS ...   kernels, scratch, readers of files: for this project's own sources and tests
#       SOURCES ...
#       KERNELS ...           sources that are inner loops (cmake/unity.cmake)
#       LEVEL -O1)            of optimisation; -O2 where none is given
#
# makes relumine::NAME with the warnings, the language level and the include spelling ("NAME/file.h") that all
# folders share. A public header includes public headers, GLM and std only (tests/headers checks it). The library
# is static or shared as BUILD_SHARED_LIBS says; an INTERNAL one is always static and is not installed.
#
# Users spell "relumine/NAME/file.h", and "relumine/file.h" for the door's: no header of theirs is in the way. Installed
# headers do so, too (cmake/one_root.cmake). This project's own examples and tests reach the headers in that spelling by
# links in the build folder; a project that adds this one as a folder gets copies there, which are like installed ones.

include(GNUInstallDirs)
include(${CMAKE_CURRENT_LIST_DIR}/public_header.cmake)

# relumine_link_options(TARGET OPTION...): those that the linker knows.
include(CheckLinkerFlag)
function(relumine_link_options target)
    foreach(option ${ARGN})
        string(MAKE_C_IDENTIFIER "RELUMINE_LINKS_${option}" known)
        check_linker_flag(CXX ${option} ${known})
        if(${known})
            target_link_options(${target} PRIVATE ${option})
        endif()
    endforeach()
endfunction()

add_library(relumine_warnings INTERFACE)
target_compile_options(relumine_warnings INTERFACE "$<${is_gnu_or_clang}:-Wall;-Wextra;-Wshadow;-Wconversion>")
if(RELUMINE_WARNINGS_AS_ERRORS)
    target_compile_options(relumine_warnings INTERFACE $<${is_gnu_or_clang}:-Werror>)
endif()

# Compiles each header by itself, where Relumine is the top project.
if(PROJECT_IS_TOP_LEVEL)
    add_custom_target(verify_headers)
endif()

function(relumine_verify_headers name)
    if(NOT PROJECT_IS_TOP_LEVEL)
        return()
    endif()
    set(sources "")
    foreach(header IN LISTS ARGN)
        set(source ${CMAKE_CURRENT_BINARY_DIR}/verified_headers/${header}.cpp)
        file(CONFIGURE OUTPUT ${source} CONTENT "#include \"${name}/${header}\"\n")
        list(APPEND sources ${source})
    endforeach()
    set(verify relumine_${name}_verify_headers)
    add_library(${verify} OBJECT EXCLUDE_FROM_ALL ${sources})
    target_compile_features(${verify} PRIVATE cxx_std_20)
    target_include_directories(${verify} PRIVATE $<TARGET_PROPERTY:relumine_${name},INCLUDE_DIRECTORIES>)
    target_compile_definitions(${verify} PRIVATE $<TARGET_PROPERTY:relumine_${name},COMPILE_DEFINITIONS>)
    target_link_libraries(${verify} PRIVATE relumine_warnings)
    add_dependencies(verify_headers ${verify})
endfunction()

# What users of the libraries find headers in, without an install.
set(relumine_includes ${PROJECT_SOURCE_DIR} ${PROJECT_BINARY_DIR}/include)
if(NOT PROJECT_IS_TOP_LEVEL)
    include_directories(${relumine_includes})
    set(relumine_includes ${PROJECT_BINARY_DIR}/public)
endif()

# Copies the public headers as users read them, and again where one has changed.
function(relumine_copy_public_headers)
    get_property(headers GLOBAL PROPERTY RELUMINE_PUBLIC_HEADERS)
    get_property(folders GLOBAL PROPERTY RELUMINE_LIBRARIES)
    list(REMOVE_ITEM folders relumine)
    list(JOIN folders "|" folders)
    foreach(header IN LISTS headers)
        file(READ ${PROJECT_SOURCE_DIR}/${header} text)
        relumine_public_header(text "${folders}")
        string(REGEX REPLACE "^relumine/" "" path ${header})
        file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/public/relumine/${path} CONTENT "${text}" @ONLY)
    endforeach()
    list(TRANSFORM headers PREPEND ${PROJECT_SOURCE_DIR}/)
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${headers})
endfunction()

function(relumine_library name)
    cmake_parse_arguments(arg "INTERNAL" "LEVEL" "HEADERS;PRIVATE_HEADERS;SOURCES;KERNELS" ${ARGN})
    set(kind "")
    if(arg_INTERNAL)
        set(kind STATIC)
    endif()
    add_library(relumine_${name} ${kind} ${arg_SOURCES} ${arg_KERNELS} ${arg_PRIVATE_HEADERS})
    add_library(relumine::${name} ALIAS relumine_${name})
    target_include_directories(relumine_${name} PUBLIC
        "$<BUILD_INTERFACE:${relumine_includes}>" $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
    target_compile_features(relumine_${name} PUBLIC cxx_std_20)
    set_target_properties(relumine_${name} PROPERTIES
        EXPORT_NAME ${name}
        VERSION ${PROJECT_VERSION}
        SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR}
        INSTALL_RPATH "$ORIGIN"
        # Python's module is a shared object that holds the static libraries.
        POSITION_INDEPENDENT_CODE ON)
    # Nobody replaces their functions, so calls are as direct, and as often inlined, as in a program.
    target_compile_options(relumine_${name} PRIVATE $<${is_gnu_or_clang}:-fno-semantic-interposition>)
    target_link_libraries(relumine_${name} PRIVATE $<BUILD_INTERFACE:relumine_warnings>)
    # A shared library depends on no more than it uses.
    relumine_link_options(relumine_${name} LINKER:--as-needed)

    relumine_verify_headers(${name} ${arg_HEADERS} ${arg_PRIVATE_HEADERS})
    if(NOT arg_INTERNAL)
        set(root ${CMAKE_INSTALL_INCLUDEDIR}/relumine)
        if(NOT name STREQUAL relumine)
            string(APPEND root /${name})
            file(MAKE_DIRECTORY ${PROJECT_BINARY_DIR}/include/relumine)
            file(CREATE_LINK ${CMAKE_CURRENT_SOURCE_DIR} ${PROJECT_BINARY_DIR}/include/relumine/${name} SYMBOLIC)
        endif()
        if(RELUMINE_INSTALL)
            foreach(header IN LISTS arg_HEADERS)
                cmake_path(GET header PARENT_PATH room)
                install(FILES ${header} DESTINATION ${root}/${room} COMPONENT development)
            endforeach()
            install(TARGETS relumine_${name} EXPORT relumine
                RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT runtime
                LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT runtime NAMELINK_COMPONENT development
                ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT development)
        endif()
        list(TRANSFORM arg_HEADERS PREPEND ${name}/)
        set_property(GLOBAL APPEND PROPERTY RELUMINE_PUBLIC_HEADERS ${arg_HEADERS})
        set_property(GLOBAL APPEND PROPERTY RELUMINE_LIBRARIES ${name})
    endif()
    if(NOT arg_LEVEL)
        set(arg_LEVEL -O2)
    endif()
    relumine_compile(relumine_${name} ${arg_LEVEL} KERNELS ${arg_KERNELS})
endfunction()
