// Files of meshes, and what is done to meshes before light is asked for.
#pragma once

// IWYU pragma: begin_exports
#include "mesh/customs.h"
#include "mesh/floor.h"
#include "mesh/half_edge/diagnosis.h"
#include "mesh/half_edge/repair.h"
#include "mesh/half_edge/winding.h"
#include "mesh/load.h"
#include "mesh/materials/brdf_table.h"
#include "mesh/normals.h"
#include "mesh/pose.h"
#include "mesh/save.h"
#include "mesh/stage_hint.h"
#include "mesh/triangle_mesh.h"
#include "prt/lamps/lamps.h"
#include "prt/visibility/twin_triangles.h"
// IWYU pragma: end_exports
