# relumine_public_header(VARIABLE FOLDERS): makes of the text of a header, in the variable, what users of the library read.
# Within it, "NAME/file.h" becomes "relumine/NAME/file.h" for the libraries NAME (FOLDERS: their names, separated by |), so
# that no header of theirs is in the way; and an older language is refused before anything else is read.
function(relumine_public_header variable folders)
    set(public "${${variable}}")
    string(REGEX REPLACE "#include \"(${folders})/" "#include \"relumine/\\1/" public "${public}")
    if(NOT public MATCHES "relumine/(files/cxx20.h|needs/)")
        string(REPLACE "#pragma once\n" "#pragma once\n\n#include \"relumine/files/cxx20.h\"\n" public "${public}")
    endif()
    set(${variable} "${public}" PARENT_SCOPE)
endfunction()
