// Exact integration and flicker: what the fast ways are held to.
#pragma once

// IWYU pragma: begin_exports
#include "relight/reference/exact.h"
#include "relight/reference/flicker.h"
// IWYU pragma: end_exports
