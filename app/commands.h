// The subcommands. Each adds itself to the program; its work runs when the command line has been
// read.
#pragma once

#include <CLI/CLI.hpp>

#include "app/session.h"

namespace relumine::app {

void add_precompute(CLI::App& program, Session& session);
void add_relight(CLI::App& program, Session& session);
void add_animate(CLI::App& program, Session& session);
void add_edit(CLI::App& program, Session& session);
void add_verify(CLI::App& program, Session& session);
void add_lights(CLI::App& program, Session& session);
void add_info(CLI::App& program, Session& session);
void add_generate(CLI::App& program, Session& session);
void add_env(CLI::App& program, Session& session);
void add_view(CLI::App& program, Session& session);

} // namespace relumine::app
