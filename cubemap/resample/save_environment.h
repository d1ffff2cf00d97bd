// Writes a cube map as an environment file.
#pragma once

#include <filesystem>

#include "cubemap/cube_map.h"
#include "cubemap/image/environment.h"

namespace relumine::cubemap {

/// Writes a cube map in a layout, at the layout's natural size. In .exr files, Cube and LatLong
/// have the `envmap` attribute and samples on the borders, as the attribute's specification says.
/// All other files have samples at texel centres.
///
/// Energy:  the file reads back to the same energy. For .hdr this holds to the 8 bits of RGBE, 0.2
///          % per pixel.
/// Throws:  as save_image().
void save_environment(const std::filesystem::path& path, const CubeMap& map,
                      Layout layout = Layout::Cube);

} // namespace relumine::cubemap
