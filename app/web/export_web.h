// `relumine export web`.
#pragma once

#include "app/command_line/command_line.h"
#include "app/session.h"

namespace relumine::app {

void add_export_web(Command& group, Session& session);

} // namespace relumine::app
