// Colour spaces that files of pictures state, and their way to linear Rec. 709.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "cubemap/image/picture.h"

namespace relumine::cubemap {

/// CIE 1931 xy of the primaries and the white of a space.
struct Primaries {
    glm::dvec2 red, green, blue, white;
};

/// How a file's numbers stand for light. Those of Pq [SMPTE ST 2084] and Hlg [ITU-R BT.2100] are
/// what a display shows: its white of 203 cd/m2 [ITU-R BT.2408] is radiance 1.
enum class Transfer { Linear, Srgb, Gamma22, Gamma18, Pq, Hlg };

struct ColorSpace {
    Primaries primaries;
    Transfer transfer = Transfer::Linear;
    /// "ACEScg", "P3-D65"; empty: a space without a name
    std::string name = {};
};

/// Returns the light of a file's number; for Hlg that of the scene, of which 1 is the most.
[[nodiscard]] float linear(float value, Transfer transfer);
/// Returns the matrix from linear colours of these primaries to those of Rec. 709. White stays
/// white: Bradford's adaptation [Lindbloom, "Chromatic Adaptation"].
///
/// Throws:  std::invalid_argument for primaries that lie on a line, or a white of no luminance.
[[nodiscard]] glm::dmat3 to_rec709(const Primaries& primaries);
/// Returns the matrix from CIE XYZ with the white of D65.
[[nodiscard]] glm::dmat3 rec709_from_xyz();

/// Returns the space of these primaries, with a name where one has them within 0.001. Empty for
/// those of linear Rec. 709, which need no conversion.
[[nodiscard]] std::optional<ColorSpace> space_of(const Primaries& primaries,
                                                 Transfer transfer = Transfer::Linear);
/// Returns the space that a `colorInteropID` names ("lin_ap1_scene", "srgb_rec709_display").
/// Empty for linear Rec. 709, and for names that say nothing of colours or are not known.
[[nodiscard]] std::optional<ColorSpace> space_of_id(std::string_view id);

/// The way of a file's colours to linear Rec. 709. What Rec. 709 cannot show, a negative number,
/// becomes 0 where it was not negative before.
class ColorConversion {
public:
    /// Primaries that span no colours leave pixels as they are, which the remark says.
    explicit ColorConversion(const ColorSpace& from);
    /// From CIE XYZ.
    ColorConversion();

    /// Returns in how many of the pixels Rec. 709 could not show the colour.
    std::size_t convert(std::span<glm::vec3> pixels) const;
    /// Says what was done, and to how many pixels that happened.
    [[nodiscard]] std::string remark(std::size_t num_outside) const;

private:
    /// Empty: pixels stay as they are
    std::optional<glm::mat3> matrix_;
    /// The luminance of each primary
    glm::vec3 luminances_{0.0f};
    Transfer transfer_ = Transfer::Linear;
    std::string from_;
};

/// Converts a picture, and returns the remark.
std::string convert(const ColorConversion& conversion, Picture& picture);

} // namespace relumine::cubemap
