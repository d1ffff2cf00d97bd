#include "app/command_line/completion.h"
#include "files/joined.h"

#include <string_view>
#include <vector>

#include <fmt/format.h>

namespace relumine::app {

namespace {

/// The text with every character of `special` behind a backslash.
std::string escaped(std::string_view text, std::string_view special) {
    std::string result;
    for (const char c : text) {
        if (special.find(c) != std::string_view::npos)
            result += '\\';
        result += c == '\n' ? ' ' : c;
    }
    return result;
}

/// A word of bash or zsh.
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

/// "_env_convert", a function's name from a command's words.
std::string function_name(const std::string& words) {
    std::string name = "_";
    for (const char c : words)
        name += c == ' ' || c == '-' ? '_' : c;
    return name;
}

// bash

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

// zsh

/// What follows an option's name in a specification of `_arguments`: ":value:action".
std::string zsh_value(const OptionRow& option) {
    if (option.is_flag)
        return "";
    const std::string label = escaped(option.is_argument() ? option.name : option.type, "[]:\\");
    if (!option.choices.empty())
        return fmt::format(":{}:({})", label, files::joined(option.choices, " "));
    return fmt::format(":{}:{}", label, option.file ? "_files" : option.folder ? "_files -/" : " ");
}

void zsh_function(const CommandTable& command, const std::string& words, std::string& script) {
    for (const CommandTable& below : command.commands)
        zsh_function(below, words + " " + below.name, script);
    script += fmt::format("{}() {{\n    local curcontext=\"$curcontext\" state line\n"
                          "    _arguments -C",
                          function_name(words));
    for (const OptionRow& option : command.options) {
        const std::string description = fmt::format("[{}]", escaped(option.help, "[]:\\"));
        const std::string value = fmt::format("{}{}", option.bare ? ":" : "", zsh_value(option));
        // All names of one option exclude each other, unless it may be repeated.
        const std::string excluded =
            option.repeats ? "*" : fmt::format("({})", files::joined(option.names(), " "));
        for (const std::string& name : option.names())
            script += fmt::format(
                " \\\n        {}",
                shell_quoted(fmt::format("{}{}{}{}", excluded, name, description, value)));
    }
    if (command.commands.empty()) {
        int position = 0;
        for (const OptionRow& option : command.options)
            if (option.is_argument())
                script += fmt::format(
                    " \\\n        {}",
                    shell_quoted(option.repeats
                                     ? fmt::format("*{}", zsh_value(option))
                                     : fmt::format("{}{}{}", ++position, option.required ? "" : ":",
                                                   zsh_value(option))));
        script += "\n}\n\n";
        return;
    }
    script += " \\\n        '1: :->command' '*:: :->rest'\n    case $state in\n    command)\n"
              "        local -a commands=(\n";
    for (const CommandTable& below : command.commands)
        script += fmt::format("            {}\n",
                              shell_quoted(below.name + ":" + escaped(below.description, ":\\")));
    script += "        )\n        _describe -t commands command commands ;;\n    rest)\n"
              "        case $line[1] in\n";
    for (const CommandTable& below : command.commands)
        script +=
            fmt::format("        {}) {} ;;\n", below.name, function_name(words + " " + below.name));
    script += "        esac ;;\n    esac\n}\n\n";
}

// fish

std::string fish_quoted(std::string_view text) {
    return fmt::format("'{}'", escaped(text, "'\\"));
}

std::string fish_value(const OptionRow& option) {
    if (option.is_flag)
        return "";
    if (!option.choices.empty())
        return fmt::format(" -xa {}", fish_quoted(files::joined(option.choices, " ")));
    if (option.folder)
        return " -xa '(__fish_complete_directories)'";
    return option.file ? (option.bare ? " -F" : " -rF") : (option.bare ? "" : " -x");
}

/// Lines that hold where the command's words have been typed.
void fish_lines(const CommandTable& command, const std::string& program, const std::string& words,
                std::string& script) {
    std::string condition;
    for (std::size_t start = 0; start < words.size();) {
        const std::size_t end = std::min(words.find(' ', start), words.size());
        condition +=
            fmt::format("{}__fish_seen_subcommand_from {}", condition.empty() ? "" : "; and ",
                        words.substr(start, end - start));
        start = end + 1;
    }
    std::string no_command;
    if (!command.commands.empty())
        no_command = fmt::format("{}not __fish_seen_subcommand_from {}",
                                 condition.empty() ? "" : condition + "; and ",
                                 files::joined(names_of(command.commands), " "));
    const std::string prefix = fmt::format(
        "complete -c {} -n {}", program, fish_quoted(no_command.empty() ? condition : no_command));
    for (const CommandTable& below : command.commands)
        script +=
            fmt::format("{} -a {} -d {}\n", prefix, below.name, fish_quoted(below.description));
    for (const OptionRow& option : command.options) {
        if (option.is_argument()) {
            script += prefix + fish_value(option) + '\n';
            continue;
        }
        script += prefix;
        for (const std::string& name : option.names())
            script += name.starts_with("--") ? fmt::format(" -l {}", name.substr(2))
                                             : fmt::format(" -s {}", name.substr(1));
        script += fmt::format("{} -d {}\n", fish_value(option), fish_quoted(option.help));
    }
    for (const CommandTable& below : command.commands)
        fish_lines(below, program, words.empty() ? below.name : words + " " + below.name, script);
}

} // namespace

std::string bash_completion(const CommandTable& program) {
    std::string patterns;
    bash_commands(program, "", patterns);
    std::string branches;
    bash_branch(program, "", branches);
    const std::string function = function_name(program.name);
    return fmt::format(R"(# Completion of {0} for bash, made by `{0} completion bash`.
{1}() {{
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
        {2})
            command="${{command:+$command }}${{COMP_WORDS[i]}}" ;;
        esac
    done
    case "$command" in
{3}    esac
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
complete -F {1} {0}
)",
                       program.name, function, patterns, branches);
}

std::string zsh_completion(const CommandTable& program) {
    std::string script =
        fmt::format("#compdef {0}\n# Completion of {0} for zsh, made by `{0} completion zsh`.\n\n",
                    program.name);
    zsh_function(program, program.name, script);
    return script + fmt::format("{} \"$@\"\n", function_name(program.name));
}

std::string fish_completion(const CommandTable& program) {
    std::string script = fmt::format(
        "# Completion of {0} for fish, made by `{0} completion fish`.\ncomplete -c {0} -f\n",
        program.name);
    fish_lines(program, program.name, "", script);
    return script;
}

} // namespace relumine::app
