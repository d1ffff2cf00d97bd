// Files of environments: pictures of the sphere in all layouts and conventions, sequences of them,
// and cube maps of them.
#pragma once

// IWYU pragma: begin_exports
#include "cubemap/cube_map.h"
#include "cubemap/face.h"
#include "cubemap/image/convention.h"
#include "cubemap/image/environment.h"
#include "cubemap/image/frame_pattern.h"
#include "cubemap/image/frame_sequence.h"
#include "cubemap/image/image_layout.h"
#include "cubemap/image/read_ahead.h"
#include "cubemap/luminance.h"
#include "cubemap/resample/convert.h"
#include "cubemap/resample/save_environment.h"
// IWYU pragma: end_exports
