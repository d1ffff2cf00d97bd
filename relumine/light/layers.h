// Light layers: regions of the sky and what they do to the light there.
#pragma once

// IWYU pragma: begin_exports
#include "cubemap/layers/image_pyramid.h"
#include "cubemap/layers/layer_composite.h"
#include "cubemap/layers/layer_file.h"
#include "cubemap/layers/layer_list.h"
#include "cubemap/layers/light_layer.h"
#include "cubemap/layers/presets.h"
#include "cubemap/layers/shapes/sphere_lines.h"
#include "cubemap/texel_rectangle.h"
// IWYU pragma: end_exports
