// Factors on the light that a scene gives of its own: --emission.
#pragma once

#include <span>
#include <string>
#include <vector>

#include <glm/vec3.hpp>

#include "relumine/in/scene.h"

namespace relumine {

/// Dims and colours lamps.
struct EmissionGain {
    /// A group of the mesh that glows, or a light of its file. Empty: all that gives light or is
    /// unlit.
    std::string name = {};
    glm::vec3 gain{1.0f};
    /// A file of LM-63 (.ies) with the shape and the candela that a light without a surface gets.
    std::string profile_file = {};
    /// What the file has, after load_profiles().
    mesh::LightProfile profile = {};

    bool operator==(const EmissionGain&) const = default;
};

/// NUMBER or R,G,B for all, or NAME=GAIN[,R,G,B] for one, or NAME=PROFILE.ies.
struct EmissionText {
    static constexpr const char* Type = "TEXT";
    static EmissionGain read(const std::string& text);
    static std::string show(const EmissionGain& gain);
};

/// Returns the factor on a lamp: those on all times those with its name.
[[nodiscard]] glm::vec3 gain_of(std::span<const EmissionGain> gains, const std::string& name);

/// Returns the profile that a light gets: the last one with its name; empty: none.
[[nodiscard]] mesh::LightProfile profile_of(std::span<const EmissionGain> gains,
                                            const std::string& name);

/// Reads the files of profiles.
/// Throws:  as mesh::load_light_profile().
void load_profiles(std::vector<EmissionGain>& gains);

/// Throws:  std::invalid_argument for a name that no lamp of the scene has, and for the profile of
///          a lamp that has a surface or no place.
void require_lamps(const Scene& scene, std::span<const EmissionGain> gains);

/// Gives a light the profile that its name has, in its own colour.
void shape(mesh::PunctualLight& light, std::span<const EmissionGain> gains);

/// Returns the lamps as the factors make them.
[[nodiscard]] prt::Lamps dimmed(prt::Lamps lamps, std::span<const EmissionGain> gains);

/// Returns the factor on the emission of each triangle, [num_triangles].
[[nodiscard]] std::vector<glm::vec3> triangle_gains(const Scene& scene,
                                                    std::span<const EmissionGain> gains);

/// Returns what each receiver's surface gives of its own, [num_receivers], times the factors;
/// empty: nothing.
[[nodiscard]] std::vector<glm::vec3> emission_of(const Scene& scene,
                                                 std::span<const EmissionGain> gains = {});

} // namespace relumine
