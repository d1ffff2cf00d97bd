# The Debian packages that `cpack -G DEB` makes, one of each component that is there. dpkg-shlibdeps finds what programs
# and shared libraries depend on.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME relumine)
set(CPACK_PACKAGE_CONTACT "Relumine developers <developers@relumine.invalid>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "${PROJECT_DESCRIPTION}")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_COMPONENTS_ALL "")

# What Debian asks of each package: a licence in its words, and what changed.
string(TIMESTAMP date "%a, %d %b %Y %H:%M:%S +0000" UTC)
file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/debian/changelog CONTENT
"relumine (${PROJECT_VERSION}) unstable; urgency=medium

  * CHANGELOG.md of relumine-doc says what changed.

 -- ${CPACK_PACKAGE_CONTACT}  ${date}
")
execute_process(COMMAND gzip -9nf changelog WORKING_DIRECTORY ${PROJECT_BINARY_DIR}/debian)
file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/debian/copyright CONTENT
"Format: https://www.debian.org/doc/packaging-manuals/copyright-format/1.0/
Upstream-Name: Relumine

Files: *
Copyright: 2026 the developers of Relumine
License: Apache-2.0

License: Apache-2.0
 On Debian systems, the licence is in /usr/share/common-licenses/Apache-2.0.
")

# relumine_debian(COMPONENT PACKAGE SECTION DEPENDS TEXT): TEXT stands below the project's description.
function(relumine_debian component package section depends text)
    install(FILES ${PROJECT_BINARY_DIR}/debian/copyright ${PROJECT_BINARY_DIR}/debian/changelog.gz
        DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${package} COMPONENT ${component})
    string(TOUPPER ${component} key)
    set(CPACK_COMPONENTS_ALL ${CPACK_COMPONENTS_ALL} ${component} PARENT_SCOPE)
    set(CPACK_DEBIAN_${key}_PACKAGE_NAME ${package} PARENT_SCOPE)
    set(CPACK_DEBIAN_${key}_PACKAGE_SECTION ${section} PARENT_SCOPE)
    set(CPACK_DEBIAN_${key}_PACKAGE_DEPENDS "${depends}" PARENT_SCOPE)
    set(CPACK_COMPONENT_${key}_DESCRIPTION "${text}" PARENT_SCOPE)
endfunction()

if(RELUMINE_BUILD_APP OR (RELUMINE_BUILD_LIBRARY AND BUILD_SHARED_LIBS))
    relumine_debian(runtime relumine graphics "" "A precompute finds out how much light from every direction reaches each
vertex of a mesh, blockers included. After that any HDR environment lights the
mesh in milliseconds, all shadows in place.")
endif()
if(RELUMINE_BUILD_RUNTIME AND RELUMINE_RUNTIME_SHARED)
    set(engine librelumine-runtime${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
    list(APPEND development_depends "librelumine-runtime-dev (= ${PROJECT_VERSION})")
    relumine_debian(engine ${engine} libs "" "The library that relights alone, for programs that embed it.")
    relumine_debian(engine_development librelumine-runtime-dev libdevel "${engine} (= ${PROJECT_VERSION})"
        "What programs that embed the runtime are compiled with: its header, find_package(relumine COMPONENTS runtime).")
    set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)
    file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/debian/triggers CONTENT "activate-noawait ldconfig\n")
    set(CPACK_DEBIAN_ENGINE_PACKAGE_CONTROL_EXTRA ${PROJECT_BINARY_DIR}/debian/triggers)
endif()
if(RELUMINE_BUILD_PYTHON)
    relumine_debian(python python3-relumine python
        "python3 (>= ${RELUMINE_PYTHON_VERSION}), python3 (<< ${RELUMINE_PYTHON_NEXT_VERSION}), python3-numpy"
        "The Python package: import relumine.")
    # What Python compiled goes with its sources.
    file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/debian/prerm CONTENT "#!/bin/sh\nset -e\npy3clean -p python3-relumine\n")
    file(CHMOD ${PROJECT_BINARY_DIR}/debian/prerm FILE_PERMISSIONS
        OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
    set(CPACK_DEBIAN_PYTHON_PACKAGE_CONTROL_EXTRA ${PROJECT_BINARY_DIR}/debian/prerm)
endif()
if(BUILD_SHARED_LIBS)
    list(APPEND development_depends "relumine (= ${PROJECT_VERSION})")
    set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)
    get_property(folders GLOBAL PROPERTY RELUMINE_LIBRARIES)
    list(TRANSFORM folders PREPEND ${PROJECT_BINARY_DIR}/)
    set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS ${folders})
endif()
list(JOIN development_depends ", " development_depends)
relumine_debian(development relumine-dev libdevel "${development_depends}"
    "Headers, libraries and a CMake package: find_package(relumine).")
relumine_debian(documentation relumine-doc doc "" "The documents and the examples.")
set(CPACK_DEBIAN_DOCUMENTATION_PACKAGE_ARCHITECTURE all)
include(CPack)
