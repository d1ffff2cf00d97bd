// Lists of distant lights: how they are placed, split from a map, kept and exported, and what they
// give.
#pragma once

// IWYU pragma: begin_exports
#include "lights/frame_samples.h"
#include "lights/light_clusters.h"
#include "lights/light_export.h"
#include "lights/light_file.h"
#include "lights/light_list.h"
#include "lights/luminance.h"
#include "lights/place_lights.h"
#include "lights/sun_split.h"
#include "relight/light_fit/transfer_lights.h"
#include "relight/sharp/shadow_rays.h"
// IWYU pragma: end_exports
