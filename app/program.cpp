#include "app/program.h"

#include "app/command_line/documentation.h"
#include "app/commands.h"

namespace relumine::app {

void add_commands(CommandLine& line, Session& session) {
    Command program = line.root();
    add_precompute(program, session);
    add_plan(program, session);
    add_join(program, session);
    add_relight(program, session);
    add_animate(program, session);
    add_edit(program, session);
    add_verify(program, session);
    add_lights(program, session);
    add_info(program, session);
    add_generate(program, session);
    add_mesh(program, session);
    add_env(program, session);
    add_view(program, session);
    add_serve(program, session);
    add_help(line);
    add_completion(line);
    add_man(line);
}

} // namespace relumine::app
