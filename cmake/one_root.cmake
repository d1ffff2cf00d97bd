# Run when headers are installed: makes them what users read (public_header.cmake).
#
# relumine_folders:  names of the libraries, separated by |
# relumine_headers:  the folder that the headers were installed into, from the prefix
include(${CMAKE_CURRENT_LIST_DIR}/public_header.cmake)
file(GLOB_RECURSE headers "$ENV{DESTDIR}${CMAKE_INSTALL_PREFIX}/${relumine_headers}/*.h")
foreach(header IN LISTS headers)
    file(READ "${header}" text)
    relumine_public_header(text "${relumine_folders}")
    file(WRITE "${header}" "${text}")
endforeach()
