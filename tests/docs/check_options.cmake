# Checks that docs/command-line.md names every command and every option that the program has.
#
#   cmake -DPROGRAM=relumine -DPAGE=docs/command-line.md -P check_options.cmake
#
# Prints one line for each that is absent and fails when there is one.
cmake_minimum_required(VERSION ${CMAKE_VERSION})

file(READ "${PAGE}" page)
string(REPLACE ";" " " page "${page}")
set(num_absent 0)
set(num_options 0)
set(names)

# The help of a command without what CMake's lists take apart.
function(help_of command result)
    separate_arguments(words UNIX_COMMAND "${command}")
    execute_process(COMMAND "${PROGRAM}" ${words} --help OUTPUT_VARIABLE help COMMAND_ERROR_IS_FATAL ANY)
    string(REGEX REPLACE "[][;]" " " help "${help}")
    set(${result} "${help}" PARENT_SCOPE)
endfunction()

help_of("" help)
string(REGEX REPLACE "^.*Subcommands:" "" commands "${help}")
string(REGEX MATCHALL "\n  [a-z]+" commands "${commands}")
list(TRANSFORM commands STRIP)
list(LENGTH commands num_commands)
if(num_commands LESS 2)
    message(FATAL_ERROR "${PROGRAM} --help: expected a list of subcommands, got\n${help}")
endif()

list(TRANSFORM commands REPLACE "^env$" "env convert")
list(TRANSFORM commands REPLACE "^mesh$" "mesh repair;mesh refine;mesh simplify")
list(TRANSFORM commands REPLACE "^export$" "export runtime;export three;export web")
foreach(command IN LISTS commands)
    if(NOT page MATCHES "\n## ${command}[ \n]")
        message("${PAGE}: no section for ${command}")
        math(EXPR num_absent "${num_absent} + 1")
    endif()
    help_of("${command}" help)
    string(REGEX MATCHALL "\n  (-[a-zA-Z],)?--[a-z0-9-]+" options "${help}")
    foreach(option IN LISTS options)
        string(REGEX REPLACE "^.*--" "--" option "${option}")
        math(EXPR num_options "${num_options} + 1")
        list(APPEND names "${option}")
        if(NOT option STREQUAL "--help" AND NOT page MATCHES "`([^`\n]* )?${option}[ `]")
            message("${PAGE}: no ${option}, which ${command} has")
            math(EXPR num_absent "${num_absent} + 1")
        endif()
    endforeach()
endforeach()

# Who learns the program learns these.
set(MOST_NAMES 85)
list(REMOVE_DUPLICATES names)
list(LENGTH names num_names)
if(num_names GREATER MOST_NAMES)
    message(FATAL_ERROR "expected at most ${MOST_NAMES} names of options, got ${num_names}: another one takes the place of an older one")
endif()

if(num_absent GREATER 0 OR num_options EQUAL 0)
    message(FATAL_ERROR "${num_absent} of ${num_options} options and ${num_commands} commands are absent")
endif()
message("${num_options} options of ${num_commands} commands by ${num_names} names, all there")
