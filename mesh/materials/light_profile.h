// The light of a lamp by direction: what goniophotometers measure and LM-63 files (.ies) hold.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace relumine::mesh {

/// Angles in degrees and intensities in candela, Type C of LM-63: vertical 0 is where the lamp is
/// aimed at, and 180 behind it. Horizontal angles go round that axis, counter-clockwise for one who
/// is behind the lamp.
struct LightProfileTable {
    /// [num_vertical] ascending, within 0 to 180, two or more. There is no light outside.
    std::vector<float> vertical = {};
    /// [num_horizontal] ascending: one angle (all are alike), 0 to 90 (four quarters are alike),
    /// 0 to 180 or 90 to 270 (two halves mirror each other), or 0 to 360.
    std::vector<float> horizontal = {};
    /// [num_horizontal x num_vertical], 0 to MaxCandela.
    std::vector<float> candela = {};

    bool operator==(const LightProfileTable&) const = default;
};

/// Pictures of such lights, with room for exposure, stay within what a float holds.
inline constexpr float MaxCandela = 1e9f;

/// A table that cannot change. Copies share it.
class LightProfile {
public:
    /// No table: no light.
    LightProfile() = default;
    /// Throws:  std::invalid_argument "expected X, got Y" for a table of other angles, shape or
    ///          values.
    explicit LightProfile(LightProfileTable table);

    [[nodiscard]] bool empty() const { return !table_; }
    /// Not for an empty one.
    [[nodiscard]] const LightProfileTable& table() const { return *table_; }

    /// Returns the intensity in candela, bilinear between the angles.
    [[nodiscard]] double at(double vertical_degrees, double horizontal_degrees) const;
    /// Returns the integral of at() over all directions: lumen.
    [[nodiscard]] double flux() const;
    [[nodiscard]] float largest() const;

    /// Whether the tables are equal.
    bool operator==(const LightProfile& other) const;

private:
    std::shared_ptr<const LightProfileTable> table_;
};

/// A profile of a file.
struct ReadLightProfile {
    LightProfile profile;
    /// What the file holds and the profile does not: "factors of tilted lamps", for sentences.
    std::vector<std::string> left_out;
};

/// Reads LM-63 of 1986, 1991, 1995, 2002 or 2019, photometry of Type C. The intensities are those
/// of the file times its multiplier and its ballast's factors.
///
/// Throws:  std::runtime_error "expected X, got Y" for a file of another kind or a broken one.
[[nodiscard]] ReadLightProfile read_light_profile(std::span<const std::byte> file);

/// Does the same for a file of this path, which errors name.
[[nodiscard]] ReadLightProfile load_light_profile(const std::filesystem::path& path);

} // namespace relumine::mesh
