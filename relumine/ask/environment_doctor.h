// What is odd about an environment: its sun, seams, ground and sky.
#pragma once

// IWYU pragma: begin_exports
#include "cubemap/doctor/clipped_sun.h"
#include "cubemap/doctor/seams.h"
#include "cubemap/doctor/sky_angles.h"
#include "cubemap/doctor/statistics.h"
#include "cubemap/doctor/sun.h"
#include "cubemap/doctor/upside_down.h"
// IWYU pragma: end_exports
