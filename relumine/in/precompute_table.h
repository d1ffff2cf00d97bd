// The options of a precompute, as the command line and Python have them.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "relumine/in/material.h"
#include "relumine/in/precompute_options.h"
#include "relumine/options/option_table.h"

namespace relumine {

inline constexpr std::array<std::string_view, 2> GgxWords = {"whole", "published"};
template<>
inline constexpr std::span<const std::string_view> WordsOf<prt::GgxForm> = GgxWords;

/// By Highlights
inline constexpr std::array<std::string_view, 2> HighlightWords = {"stored", "traced"};
template<>
inline constexpr std::span<const std::string_view> WordsOf<Highlights> = HighlightWords;

/// "vertices", "pixels:WxH", "pixels:WxH:N", "texels:WxH", "points:FILE" or "grid:NXxNYxNZ"
struct ReceiversText {
    using Value = ReceiverChoice;
    static constexpr const char* Type = "TEXT";
    static Value read(const std::string& text);
    static std::string show(const Value& receivers);
};

/// "X0,Y0,Z0,X1,Y1,Z1": two corners
struct BoxText {
    static constexpr const char* Type = "TEXT";
    static PlacedBox read(const std::string& text);
    static std::string show(const PlacedBox& box);
};

/// "auto" or "EX,EY,EZ,TX,TY,TZ[,FOV]"
struct ViewText {
    static constexpr const char* Type = "TEXT";
    static View read(const std::string& text);
    static std::string show(const View& view);
};

/// "500M", "4G", "1.5GiB", "100000B": powers of 1024
struct MemoryText {
    static constexpr const char* Type = "SIZE";
    static std::uint64_t read(const std::string& text);
    static std::string show(std::uint64_t bytes) { return std::to_string(bytes) + "B"; }
};

/// "ggx:roughness=0.3,albedo=0.5,0.4,0.3,f0=0.04", "blinn:exponent=50,kd=0.3,ks=0.2" or
/// "lambert:albedo=0.8"; with "GROUP=" in front for one object of a mesh that has several.
struct MaterialText {
    static constexpr const char* Type = "TEXT";
    static SurfaceMaterial read(const std::string& text);
    static std::string show(const SurfaceMaterial& material);
};

/// All but the materials.
[[nodiscard]] OptionTable options_of(PrecomputeOptions& options);
[[nodiscard]] OptionRow material_row(std::vector<SurfaceMaterial>& materials);

/// Throws OptionError for options that contradict each other.
void check(const PrecomputeOptions& options);
/// Throws OptionError for a view with points or a grid.
void check_points(const PrecomputeOptions& options);
/// Throws std::invalid_argument for a grid of no cell or of too many.
void check(const Grid& grid);

/// Gives the mesh's surfaces and the floor's to the options. Later materials win; those of the
/// group `floor` are the floor's.
///
/// Throws:  OptionError for a group that the mesh does not have.
void set_materials(PrecomputeOptions& options, std::span<const SurfaceMaterial> materials,
                   const mesh::TriangleMesh& mesh);

} // namespace relumine
