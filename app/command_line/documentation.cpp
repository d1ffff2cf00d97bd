#include "app/command_line/documentation.h"

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "app/command_line/printed.h"
#include "app/command_table.h"
#include "files/joined.h"
#include "files/output_file.h"

namespace relumine::app {

namespace {

/// The text as one word of bash.
std::string shell_quoted(std::string_view text) {
    std::string result = "'";
    for (const char c : text)
        if (c == '\'')
            result += "'\\''";
        else
            result += c == '\n' ? ' ' : c;
    return result + "'";
}

std::vector<std::string> names_of(const std::vector<CommandTable>& commands) {
    std::vector<std::string> names;
    names.reserve(commands.size());
    for (const CommandTable& command : commands)
        names.push_back(command.name);
    return names;
}

/// What bash offers for a value: an assignment to `kind` and `words`.
std::string bash_value(const OptionRow& option) {
    if (!option.choices.empty())
        return fmt::format("kind=words words={}", shell_quoted(files::joined(option.choices, " ")));
    return option.file ? "kind=files" : option.folder ? "kind=folders" : "kind=none";
}

/// The patterns of `case` that stand for commands below this one, "env convert".
void bash_commands(const CommandTable& command, const std::string& words, std::string& patterns) {
    for (const CommandTable& below : command.commands) {
        patterns += fmt::format("{}{}", patterns.empty() ? "" : " | ",
                                shell_quoted(fmt::format("{} {}", words, below.name)));
        bash_commands(below, words.empty() ? below.name : words + " " + below.name, patterns);
    }
}

/// The branch of `case` that says what may follow the words of a command.
void bash_branch(const CommandTable& command, const std::string& words, std::string& script) {
    std::vector<std::string> options;
    std::string values;
    std::string argument = "kind=none";
    for (const OptionRow& option : command.options) {
        const std::vector<std::string> names = option.names();
        options.insert(options.end(), names.begin(), names.end());
        if (option.is_argument()) {
            if (argument == "kind=none")
                argument = bash_value(option);
        } else if (!option.is_flag && !option.bare) {
            values += fmt::format("        {}) {} ;;\n", files::joined(option.names(), " | "),
                                  bash_value(option));
        }
    }
    if (!command.commands.empty())
        argument = fmt::format("kind=words words={}",
                               shell_quoted(files::joined(names_of(command.commands), " ")));
    script += fmt::format("    {})\n        options={}\n", shell_quoted(words),
                          shell_quoted(files::joined(options, " ")));
    script += fmt::format("        case $before in\n{}        *) {} ;;\n        esac ;;\n", values,
                          argument);
    for (const CommandTable& below : command.commands)
        bash_branch(below, words.empty() ? below.name : words + " " + below.name, script);
}

/// Returns it. It needs bash alone, not the package bash-completion.
std::string bash_completion(const CommandTable& program) {
    std::string patterns;
    bash_commands(program, "", patterns);
    std::string branches;
    bash_branch(program, "", branches);
    return fmt::format(R"(# Completion of {0} for bash, made by `{0} completion`.
_{0}() {{
    local word=${{COMP_WORDS[COMP_CWORD]}} before=${{COMP_WORDS[COMP_CWORD-1]}}
    local command= options= words= kind=none i
    # The words of --name=value are three: --name, = and value.
    if [[ $word == "=" ]]; then
        word=
    elif [[ $before == "=" ]]; then
        before=${{COMP_WORDS[COMP_CWORD-2]}}
    fi
    for ((i = 1; i < COMP_CWORD; ++i)); do
        case "$command ${{COMP_WORDS[i]}}" in
        {1})
            command="${{command:+$command }}${{COMP_WORDS[i]}}" ;;
        esac
    done
    case "$command" in
{2}    esac
    COMPREPLY=()
    if [[ $word == -* ]]; then
        kind=words words=$options
    fi
    case $kind in
    words) mapfile -t COMPREPLY < <(compgen -W "$words" -- "$word") ;;
    files) compopt -o filenames 2>/dev/null; mapfile -t COMPREPLY < <(compgen -f -- "$word") ;;
    folders) compopt -o filenames 2>/dev/null; mapfile -t COMPREPLY < <(compgen -d -- "$word") ;;
    esac
}}
complete -F _{0} {0}
)",
                       program.name, patterns, branches);
}

} // namespace

void add_completion(CommandLine& program) {
    Command command = program.root().add_command(
        "completion", "print a script for bash that completes commands, options and file names");
    auto output = std::make_shared<std::string>();
    command.add(row("-o,--output", *output, "write it to a file instead", {.file = true}));
    command.footer("\n\nFor this bash: source <(relumine completion)\n");
    command.on_run([output, &program] {
        const std::string script = bash_completion(program.table());
        if (output->empty())
            print(script);
        else
            files::save_text(*output, script);
    });
}

void add_help(CommandLine& program) {
    Command command = program.root().add_command("help", "print the options of a command");
    auto words = std::make_shared<std::vector<std::string>>();
    command.add(row("COMMAND", *words, "a command; none: the program's own help"));
    command.on_run([words, &program] { print(program.help(*words)); });
}

} // namespace relumine::app
