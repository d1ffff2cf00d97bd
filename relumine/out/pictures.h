// Pictures and arrays, and how they are framed, toned and written.
#pragma once

// IWYU pragma: begin_exports
#include "relight/pictures/array_file.h"
#include "relight/pictures/environment_picture.h"
#include "relight/pictures/framing.h"
#include "relight/pictures/ground.h"
#include "relight/pictures/mesh_picture.h"
#include "relight/pictures/picture.h"
#include "relight/pictures/picture_view.h"
#include "relight/pictures/png_file.h"
#include "relight/pictures/region_picture.h"
#include "relight/pictures/tone_curve.h"
// IWYU pragma: end_exports
