#include "app/command_line/documentation.h"

#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "app/command_line/completion.h"
#include "app/command_line/man_page.h"
#include "files/output_file.h"
#include "relumine/version.h"

namespace relumine::app {

namespace {

struct CompletionOptions {
    std::string shell;
    /// Empty: stdout
    std::string output;
};

struct ManOptions {
    std::string page = "relumine";
    /// Of all pages; empty: one page on stdout
    std::string folder;
};

std::string completion(const CommandTable& program, const std::string& shell) {
    return shell == "bash"  ? bash_completion(program)
           : shell == "zsh" ? zsh_completion(program)
                            : fish_completion(program);
}

/// A page's name on the command line: "env-convert" for relumine-env-convert, "relumine" for the
/// program's own.
std::string short_name(const ManPage& page, const std::string& program) {
    return page.name == program ? program : page.name.substr(program.size() + 1);
}

void save_pages(const std::vector<ManPage>& pages, const std::string& folder) {
    files::make_folder(folder);
    for (const ManPage& page : pages)
        files::save_text(std::filesystem::path(folder) / (page.name + ".1"), page.text);
}

} // namespace

void add_completion(CommandLine& program) {
    Command command = program.root().add_command(
        "completion", "print a shell script that completes commands, options and file names");
    auto options = std::make_shared<CompletionOptions>();
    command.add(row("SHELL", options->shell, "the shell to make it for",
                    {.required = true, .choices = {"bash", "zsh", "fish"}}));
    command.add(row("-o,--output", options->output, "write it to a file instead", {.file = true}));
    command.footer("\n\nFor this bash: source <(relumine completion bash)\n"
                   "For every fish: relumine completion fish -o "
                   "~/.config/fish/completions/relumine.fish\n"
                   "For every zsh: relumine completion zsh -o FOLDER/_relumine, in a FOLDER of "
                   "fpath\n");
    command.on_run([options, &program] {
        const std::string script = completion(program.table(), options->shell);
        if (options->output.empty())
            std::fputs(script.c_str(), stdout);
        else
            files::save_text(options->output, script);
    });
}

void add_man(CommandLine& program) {
    Command command = program.root().add_command(
        "man", "print a page of the manual: relumine man edit | man -l -");
    auto options = std::make_shared<ManOptions>();
    std::vector<std::string> names;
    const CommandTable commands = program.table();
    for (const ManPage& page : man_pages(commands, ""))
        names.push_back(short_name(page, commands.name));
    command.add(row("PAGE", options->page, "a command, or relumine", {.choices = names}));
    command.add(row("-o,--output", options->folder, "write all pages to a folder instead",
                    {.folder = true}));
    command.on_run([options, &program] {
        const CommandTable table = program.table();
        const std::vector<ManPage> pages = man_pages(table, std::string(version()));
        if (!options->folder.empty()) {
            save_pages(pages, options->folder);
            return;
        }
        for (const ManPage& page : pages)
            if (short_name(page, table.name) == options->page)
                std::fputs(page.text.c_str(), stdout);
    });
}

void add_help(CommandLine& program) {
    Command command = program.root().add_command("help", "print the options of a command");
    auto words = std::make_shared<std::vector<std::string>>();
    command.add(row("COMMAND", *words, "a command; none: the program's own help"));
    command.on_run([words, &program] { std::fputs(program.help(*words).c_str(), stdout); });
}

} // namespace relumine::app
