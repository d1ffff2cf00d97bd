#include "app/program.h"

#include "app/commands.h"

namespace relumine::app {

void add_commands(Command& program, Session& session) {
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
}

} // namespace relumine::app
