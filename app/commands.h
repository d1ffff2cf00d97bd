// The subcommands. Each adds itself to the program; its work runs when the command line has been
// read.
#pragma once

#include "app/command_line.h"
#include "app/session.h"

namespace relumine::app {

void add_precompute(Command& program, Session& session);
void add_plan(Command& program, Session& session);
void add_join(Command& program, Session& session);
void add_relight(Command& program, Session& session);
void add_animate(Command& program, Session& session);
void add_edit(Command& program, Session& session);
void add_verify(Command& program, Session& session);
void add_lights(Command& program, Session& session);
void add_info(Command& program, Session& session);
void add_generate(Command& program, Session& session);
void add_env(Command& program, Session& session);
void add_view(Command& program, Session& session);
void add_serve(Command& program, Session& session);

} // namespace relumine::app
