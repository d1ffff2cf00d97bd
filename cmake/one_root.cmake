# Run when headers are installed: within them, "NAME/file.h" becomes "relumine/NAME/file.h".
#
# relumine_folders:  names of the libraries, separated by |
# relumine_headers:  the folder that the headers were installed into, from the prefix
file(GLOB_RECURSE headers "$ENV{DESTDIR}${CMAKE_INSTALL_PREFIX}/${relumine_headers}/*.h")
foreach(header IN LISTS headers)
    file(READ "${header}" text)
    string(REGEX REPLACE "#include \"(${relumine_folders})/" "#include \"relumine/\\1/" text "${text}")
    file(WRITE "${header}" "${text}")
endforeach()
