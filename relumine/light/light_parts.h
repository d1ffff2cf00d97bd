// What the light of a scene is made of: its clusters, the light that bounces, harmonics.
#pragma once

// IWYU pragma: begin_exports
#include "prt/bounces/thinned_bounces.h"
#include "prt/transfer/quadtree.h"
#include "relight/bounces/bounce_light.h"
#include "relight/harmonics/harmonics.h"
#include "relight/relighter.h"
// IWYU pragma: end_exports
