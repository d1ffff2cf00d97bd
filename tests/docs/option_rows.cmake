# The options of pictures stand in docs/command-line.md as their table in the source has them.
#
#   cmake -DROWS=option_rows -DPAGE=docs/command-line.md [-DUPDATE=ON] -P option_rows.cmake
#
# Fails where the page says otherwise; with UPDATE, writes the page anew.
cmake_minimum_required(VERSION ${CMAKE_VERSION})

set(begin "<!-- Options of pictures: `cmake --build --preset release --target update_docs` writes them. -->\n")
set(end "<!-- End of options of pictures. -->\n")
execute_process(COMMAND "${ROWS}" OUTPUT_VARIABLE rows COMMAND_ERROR_IS_FATAL ANY)
file(READ "${PAGE}" page)
string(FIND "${page}" "${begin}" from)
string(FIND "${page}" "${end}" to)
if(from EQUAL -1 OR to EQUAL -1)
    message(FATAL_ERROR "${PAGE}: expected the lines around the options of pictures")
endif()
string(SUBSTRING "${page}" 0 ${from} before)
string(SUBSTRING "${page}" ${to} -1 after)
set(made "${before}${begin}\n${rows}\n${after}")
if(UPDATE)
    file(WRITE "${PAGE}" "${made}")
elseif(NOT made STREQUAL page)
    message(FATAL_ERROR "${PAGE}: other options of pictures than the program has; `cmake --build --preset release --target update_docs` writes them")
endif()
