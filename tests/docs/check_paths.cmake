# Checks the Markdown documents of a folder: every relative link leads to a file (and to a heading in
# it), every path in backticks that begins with one of the folders exists (NAME and * stand for any
# name), and so does every #include "..." in an example.
#
#   cmake -DROOT=FOLDER [-DFOLDERS="a;b"] -P check_paths.cmake
#
# Prints one line per fault and fails when there is one.
cmake_minimum_required(VERSION ${CMAKE_VERSION})

if(NOT DEFINED FOLDERS)
    set(FOLDERS app cmake cubemap data_gen docs examples files integrations lights mesh prt python
                relight relumine tests viewer)
endif()
string(REPLACE ";" "|" folders "${FOLDERS}")
file(GLOB documents "${ROOT}/*.md" "${ROOT}/docs/*.md")
if(NOT documents)
    message(FATAL_ERROR "${ROOT}: expected Markdown documents, found none")
endif()
set(num_faults 0)

function(fault document text)
    file(RELATIVE_PATH name "${ROOT}" "${document}")
    message("${name}: ${text}")
    math(EXPR num "${num_faults} + 1")
    set(num_faults ${num} PARENT_SCOPE)
endfunction()

# The document's text without the characters that CMake's lists take apart.
function(text_of document result)
    file(READ "${document}" text)
    string(REPLACE "](" "@link(" text "${text}")
    string(REGEX REPLACE "[][;\\]" " " text "${text}")
    set(${result} "${text}" PARENT_SCOPE)
endfunction()

# The anchors that GitHub gives a document's headings: small letters, blanks as hyphens, no signs.
function(anchors_of document result)
    text_of("${document}" text)
    string(REGEX MATCHALL "\n#+ [^\n]*" headings "\n${text}")
    set(anchors)
    foreach(heading IN LISTS headings)
        string(REGEX REPLACE "^\n#+ " "" anchor "${heading}")
        string(TOLOWER "${anchor}" anchor)
        string(REGEX REPLACE "[^a-z0-9 _-]" "" anchor "${anchor}")
        string(REPLACE " " "-" anchor "${anchor}")
        list(APPEND anchors "${anchor}")
    endforeach()
    set(${result} "${anchors}" PARENT_SCOPE)
endfunction()

foreach(document IN LISTS documents)
    text_of("${document}" text)
    get_filename_component(folder "${document}" DIRECTORY)

    string(REGEX MATCHALL "@link\\([^) \n]*\\)" links "${text}")
    foreach(link IN LISTS links)
        string(REGEX REPLACE "^@link\\((.*)\\)$" "\\1" link "${link}")
        if(link MATCHES "^[a-z]+:")
            continue()
        endif()
        set(target "${link}")
        set(anchor "")
        if(link MATCHES "^([^#]*)#(.*)$")
            set(target "${CMAKE_MATCH_1}")
            set(anchor "${CMAKE_MATCH_2}")
        endif()
        set(target_file "${document}")
        if(NOT target STREQUAL "")
            set(target_file "${folder}/${target}")
        endif()
        if(NOT EXISTS "${target_file}")
            fault("${document}" "the link ${link} leads nowhere")
        elseif(NOT anchor STREQUAL "")
            anchors_of("${target_file}" anchors)
            if(NOT anchor IN_LIST anchors)
                fault("${document}" "the link ${link} names a heading that is not there")
            endif()
        endif()
    endforeach()

    string(REGEX MATCHALL "`(${folders})/[A-Za-z0-9_./*-]*`" paths "${text}")
    string(REGEX MATCHALL "#include \"[^\"\n]*\"" includes "${text}")
    foreach(path IN LISTS paths includes)
        string(REGEX REPLACE "^(`|#include \")(.*)[`\"]$" "\\2" path "${path}")
        # Words in capitals stand for any name.
        string(REGEX REPLACE "(FILE|FOLDER|NAME|ROOM|TARGET)" "*" pattern "${path}")
        file(GLOB found "${ROOT}/${pattern}")
        if(NOT found AND NOT EXISTS "${ROOT}/${path}")
            fault("${document}" "the path ${path} is not there")
        endif()
    endforeach()
endforeach()

list(LENGTH documents num_documents)
if(num_faults GREATER 0)
    message(FATAL_ERROR "${num_faults} faults in ${num_documents} documents")
endif()
message("${num_documents} documents, no faults")
