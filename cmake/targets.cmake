# One library per folder: relumine_library(NAME HEADERS ... SOURCES ...) makes relumine::NAME with the warnings, the
# language level and the include spelling ("NAME/file.h") that all folders share.

add_library(relumine_warnings INTERFACE)
target_compile_options(relumine_warnings INTERFACE -Wall -Wextra -Wshadow -Wconversion)
if(RELUMINE_WARNINGS_AS_ERRORS)
    target_compile_options(relumine_warnings INTERFACE -Werror)
endif()

function(relumine_library name)
    cmake_parse_arguments(arg "" "" "HEADERS;SOURCES" ${ARGN})
    add_library(relumine_${name} STATIC ${arg_SOURCES})
    add_library(relumine::${name} ALIAS relumine_${name})
    target_sources(relumine_${name} PUBLIC FILE_SET HEADERS BASE_DIRS ${PROJECT_SOURCE_DIR} FILES ${arg_HEADERS})
    target_compile_features(relumine_${name} PUBLIC cxx_std_20)
    set_target_properties(relumine_${name} PROPERTIES EXPORT_NAME ${name} VERIFY_INTERFACE_HEADER_SETS ON)
    target_link_libraries(relumine_${name} PRIVATE $<BUILD_INTERFACE:relumine_warnings>)
    relumine_compile_together(relumine_${name})
endfunction()
