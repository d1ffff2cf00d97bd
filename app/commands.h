// The subcommands. Each adds itself to the program; its work runs when the command line has been
// read.
#pragma once

#include <cstdint>

#include "app/command_line/command_line.h"
#include "app/session.h"
#include "relumine/in/mesh.h"

namespace relumine::app {

void add_precompute(Command& program, Session& session);
void add_plan(Command& program, Session& session);
void add_join(Command& program, Session& session);
void add_relight(Command& program, Session& session);
void add_animate(Command& program, Session& session);
void add_edit(Command& program, Session& session);
void add_verify(Command& program, Session& session);
void add_fit(Command& program, Session& session);
void add_lights(Command& program, Session& session);
void add_info(Command& program, Session& session);
void add_generate(Command& program, Session& session);
void add_mesh(Command& program, Session& session);
void add_env(Command& program, Session& session);
void add_coarsen(Command& program, Session& session);
void add_move(Command& program, Session& session);
void add_export(Command& program, Session& session);
void add_export_web(Command& program, Session& session);
void add_view(Command& program, Session& session);

/// Keeps so many vertices of a mesh, its floor not counted, and says how many it became.
[[nodiscard]] Mesh simplified_to(Mesh mesh, std::uint32_t num_vertices, const Session& session);

} // namespace relumine::app
