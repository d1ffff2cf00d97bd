// The tables of BRDFs that a scene's surfaces and materials have, and their numbers in files.
#pragma once

#include <memory>
#include <vector>

#include "mesh/materials/brdf_table.h"
#include "prt/scene/scene_file.h"

namespace relumine::prt {

using BrdfTables = std::vector<std::shared_ptr<const mesh::BrdfTable>>;

/// Returns each table once, in the order of the file.
[[nodiscard]] BrdfTables brdf_tables(const Scene& scene);

} // namespace relumine::prt
