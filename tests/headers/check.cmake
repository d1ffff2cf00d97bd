# Checks which headers the public headers and the programs include:
#   cmake -DROOT=FOLDER -DPUBLIC_HEADERS=LIST_FILE -DUSERS=FOLDERS -DDOOR=FOLDERS [-DINSIDE=FOLDERS] -P check.cmake
# ROOT:           the folder that include paths start at.
# PUBLIC_HEADERS: a file that names one public header per line, from ROOT.
# USERS:          folders under ROOT, separated by commas, whose sources are users of the library.
# DOOR:           the library's folders that users include headers of.
# INSIDE:         users that include public headers of all folders.
# A public header includes public headers, GLM and the standard library. A user includes public headers of the
# library's door, and whatever else it likes.
cmake_minimum_required(VERSION ${CMAKE_VERSION})

file(REAL_PATH "${ROOT}" ROOT)
file(STRINGS "${PUBLIC_HEADERS}" public)
list(LENGTH public num_public)
if(num_public EQUAL 0)
    message(FATAL_ERROR "${PUBLIC_HEADERS}: expected the names of public headers")
endif()
set(folders ${public})
list(TRANSFORM folders REPLACE "/.*" "")
list(REMOVE_DUPLICATES folders)
set(num_wrong 0)

# wrong(TEXT): says what is wrong with a file, and goes on with the next.
macro(wrong text)
    message("${text}")
    math(EXPR num_wrong "${num_wrong} + 1")
endmacro()

# includes_of(FILE): sets `includes` to what the file includes, each with its quotes or angle brackets.
macro(includes_of file)
    file(STRINGS "${ROOT}/${file}" includes REGEX "^[ \t]*#[ \t]*include[ \t]*[<\"]")
    list(TRANSFORM includes REPLACE "^[ \t]*#[ \t]*include[ \t]*([<\"][^>\"]*[>\"]).*" "\\1")
endmacro()

foreach(header IN LISTS public)
    includes_of(${header})
    foreach(include IN LISTS includes)
        if(include MATCHES "^\"(.*)\"$")
            if(NOT CMAKE_MATCH_1 IN_LIST public)
                wrong("${header} is public and includes the private ${CMAKE_MATCH_1}")
            endif()
        elseif(NOT include MATCHES "^<(glm/.*|[a-z_]+)>$")
            wrong("${header} is public and shows ${include}")
        endif()
    endforeach()
endforeach()

string(REPLACE "," ";" users "${USERS}")
string(REPLACE "," ";" door "${DOOR}")
string(REPLACE "," ";" inside "${INSIDE}")
foreach(user IN LISTS users)
    file(GLOB_RECURSE sources RELATIVE "${ROOT}" "${ROOT}/${user}/*.h" "${ROOT}/${user}/*.cpp")
    if(NOT sources)
        wrong("${user}: expected sources")
    endif()
    foreach(source IN LISTS sources)
        includes_of(${source})
        foreach(include IN LISTS includes)
            string(REGEX REPLACE "[<>\"]" "" path "${include}")
            # Users of the installed library spell relumine/FOLDER/FILE.
            if(path MATCHES "^relumine/(([^/]+)/.*)" AND CMAKE_MATCH_2 IN_LIST folders)
                set(path "${CMAKE_MATCH_1}")
            endif()
            string(REGEX REPLACE "/.*" "" folder "${path}")
            if(NOT include MATCHES "^\"" OR NOT folder IN_LIST folders)
                continue()
            endif()
            if(NOT path IN_LIST public)
                wrong("${source} includes the private ${path}")
            elseif(NOT folder IN_LIST door AND NOT user IN_LIST inside)
                wrong("${source} passes the door by: ${path}")
            endif()
        endforeach()
    endforeach()
endforeach()

if(num_wrong GREATER 0)
    message(FATAL_ERROR "${num_wrong} includes are not allowed")
endif()
message("${num_public} public headers")
