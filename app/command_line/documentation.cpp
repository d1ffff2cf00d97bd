#include "app/command_line/documentation.h"

#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "app/command_line/completion.h"
#include "files/output_file.h"

namespace relumine::app {

void add_completion(CommandLine& program) {
    Command command = program.root().add_command(
        "completion", "print a script for bash that completes commands, options and file names");
    auto output = std::make_shared<std::string>();
    command.add(row("-o,--output", *output, "write it to a file instead", {.file = true}));
    command.footer("\n\nFor this bash: source <(relumine completion)\n");
    command.on_run([output, &program] {
        const std::string script = bash_completion(program.table());
        if (output->empty())
            std::fputs(script.c_str(), stdout);
        else
            files::save_text(*output, script);
    });
}

void add_help(CommandLine& program) {
    Command command = program.root().add_command("help", "print the options of a command");
    auto words = std::make_shared<std::vector<std::string>>();
    command.add(row("COMMAND", *words, "a command; none: the program's own help"));
    command.on_run([words, &program] { std::fputs(program.help(*words).c_str(), stdout); });
}

} // namespace relumine::app
