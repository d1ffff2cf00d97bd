#include "app/program.h"

#include <string>

#include "app/commands.h"

namespace relumine::app {

namespace {

/// A script's unset variable must not read as 0 or as the current folder.
void refuse_empty(CLI::App& app, const CLI::Validator& not_empty) {
    for (CLI::App* command : app.get_subcommands({})) {
        for (CLI::Option* option : command->get_options())
            if (option->get_expected_min() > 0)
                option->check(not_empty);
        refuse_empty(*command, not_empty);
    }
}

} // namespace

void add_commands(CLI::App& program, Session& session) {
    program.require_subcommand(1);
    add_precompute(program, session);
    add_relight(program, session);
    add_animate(program, session);
    add_edit(program, session);
    add_verify(program, session);
    add_lights(program, session);
    add_info(program, session);
    add_generate(program, session);
    add_env(program, session);
    add_view(program, session);
    refuse_empty(program, CLI::Validator(
                              [](const std::string& text) {
                                  return text.empty() ? std::string("expected a value, got ''")
                                                      : std::string();
                              },
                              ""));
}

} // namespace relumine::app
