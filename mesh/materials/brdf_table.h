// Isotropic BRDFs as tables: measured ones of files, and functions.
//
// Based on: Matusik, Pfister, Brand and McMillan, "A Data-Driven Reflectance Model", 2003 (the
// table of the MERL database); Rusinkiewicz, "A New Change of Variables for Efficient BRDF
// Representation", 1998 (its angles).
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

namespace relumine::mesh {

/// A BRDF by the angle theta_h between the normal and the half vector, theta_d between the half
/// vector and the light, and phi_d of the light around the half vector.
///
/// It is reciprocal and the same from the left and from the right: phi_d has a quarter of a turn.
/// It is split into a Lambertian part and a rest that is nowhere negative.
class BrdfTable {
public:
    /// theta_h grows with the square of its index, to a quarter of a turn.
    static constexpr std::size_t NumHalf = 90, NumDifference = 90, NumAzimuth = 90;
    static constexpr std::size_t NumPlaces = NumHalf * NumDifference * NumAzimuth;

    /// Shape:   values is [3][NumHalf][NumDifference][NumAzimuth], 1/sr, at the middles of places.
    ///          Where one of both directions is below the horizon it may be anything.
    /// Cost:    some 50 ms.
    /// Throws:  std::invalid_argument for another number of values, for values that are not finite
    ///          or negative, and for a BRDF that reflects more than what arrives, by over 5 %, from
    ///          any view up to 80 degrees.
    explicit BrdfTable(std::vector<float> values);

    /// The Lambertian part, an albedo.
    [[nodiscard]] const glm::vec3& lambert() const { return lambert_; }

    /// Returns the rest, 1/sr, for cosines between the normal and the directions, and the squared
    /// sine between normal and half vector.
    [[nodiscard]] glm::vec3 rest(float n_w, float n_v, float sin2) const;

    /// Returns what the rest reflects of a white sky to an eye, 0 to 1.
    [[nodiscard]] glm::vec3 rest_albedo(float n_v) const;

    /// Returns the roughness of a GGX lobe whose half vectors spread as far, 0 to 1.
    [[nodiscard]] float roughness() const { return roughness_; }

    /// [3][NumPlaces] the rest.
    [[nodiscard]] std::span<const float> rests() const { return rest_; }
    /// The whole BRDF, as the constructor takes it.
    [[nodiscard]] std::vector<float> values() const;

private:
    void fill_horizon();
    void split();
    void measure();

    glm::vec3 lambert_{0.0f};
    std::vector<float> rest_;
    float roughness_ = 1.0f;
    /// By the square root of the cosine.
    std::array<glm::vec3, 32> albedo_{};
};

/// Unit vectors to the light and to the eye; the normal is +Z.
struct BrdfDirections {
    glm::vec3 to_light, to_eye;
};

/// Returns the directions at which brdf_of() wants to know a BRDF: of the places of the table that
/// are above the horizon, and behind them those of its checks.
[[nodiscard]] std::vector<BrdfDirections> brdf_questions();

/// Returns the table of a BRDF that is known at all brdf_questions().
///
/// Throws:  std::invalid_argument as BrdfTable, and for a BRDF that is not the same where light and
///          eye change places, where both turn about the normal, or in the mirror.
[[nodiscard]] std::shared_ptr<const BrdfTable> brdf_of(std::span<const glm::vec3> answers);

/// Returns the table of a function that gives 1/sr for directions.
[[nodiscard]] std::shared_ptr<const BrdfTable>
brdf_of(const std::function<glm::vec3(const BrdfDirections&)>& function);

/// Reads a `.binary` file of the MERL database: 90 x 90 x 180 numbers for each colour. Where its
/// left and right side differ it takes the mean.
///
/// Throws:  std::runtime_error "FILE: expected X, got Y".
[[nodiscard]] std::shared_ptr<const BrdfTable> load_brdf(const std::filesystem::path& path);

} // namespace relumine::mesh
