// The letters by which the target `sections` knows the sections of a .prt file.
#pragma once

#include <array>
#include <string_view>

namespace relumine::fuzz {

/// The first is A, the next B and so on; new ones come last, so that the corpus keeps its meaning.
inline constexpr std::array<std::string_view, 48> SectionNames = {"settings",
                                                                  "positions",
                                                                  "triangles",
                                                                  "normals",
                                                                  "colors",
                                                                  "uvs",
                                                                  "order",
                                                                  "quadtree",
                                                                  "visible",
                                                                  "mixed",
                                                                  "plan",
                                                                  "layout",
                                                                  "layout_mask",
                                                                  "r_positions",
                                                                  "r_normals",
                                                                  "r_triangles",
                                                                  "r_barycentric",
                                                                  "r_to_eye",
                                                                  "r_albedo",
                                                                  "r_specular",
                                                                  "r_highlight",
                                                                  "r_shape",
                                                                  "g_specular_b",
                                                                  "g_specular_c",
                                                                  "g_specular_s",
                                                                  "g_specular_v",
                                                                  "g_spec_grazing_b",
                                                                  "g_spec_grazing_c",
                                                                  "g_spec_grazing_s",
                                                                  "g_spec_grazing_v",
                                                                  "g_diff_grazing_b",
                                                                  "g_diff_grazing_c",
                                                                  "g_diff_grazing_s",
                                                                  "g_diff_grazing_v",
                                                                  "materials",
                                                                  "images",
                                                                  "t_materials",
                                                                  "corner_uvs",
                                                                  "block_positions",
                                                                  "block_triangles",
                                                                  "bounce_radius",
                                                                  "bounce_weights",
                                                                  "bounce_hits_size",
                                                                  "bounce_hits",
                                                                  "bounce_near_size",
                                                                  "bounce_near",
                                                                  "count_codes",
                                                                  "counts_14"};

} // namespace relumine::fuzz
