// What a command found out, as --json prints it.
#pragma once

#include "files/json.h"

namespace relumine::app {

using Report = files::Json;

} // namespace relumine::app
