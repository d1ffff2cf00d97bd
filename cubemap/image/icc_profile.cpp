// Based on: International Color Consortium, Specification ICC.1:2022.
#include "cubemap/image/icc_profile.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <string_view>

#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

namespace relumine::cubemap {

namespace {

/// The bytes of a profile. What lies beyond its end is 0.
class Profile {
public:
    explicit Profile(std::span<const std::byte> bytes) : bytes_(bytes) {}

    [[nodiscard]] std::uint32_t u32(std::size_t at) const {
        std::uint32_t result = 0;
        for (std::size_t i = 0; i < 4; ++i)
            result = result << 8 |
                     (at + i < bytes_.size() ? std::to_integer<std::uint32_t>(bytes_[at + i]) : 0);
        return result;
    }
    [[nodiscard]] double u16(std::size_t at) const { return u32(at) >> 16; }
    [[nodiscard]] double fixed(std::size_t at) const {
        return static_cast<std::int32_t>(u32(at)) / 65536.0;
    }
    [[nodiscard]] std::string_view name(std::size_t at) const {
        return at + 4 <= bytes_.size()
                   ? std::string_view(reinterpret_cast<const char*>(bytes_.data()) + at, 4)
                   : std::string_view();
    }
    /// Returns where a tag's data begins; 0 where there is none.
    [[nodiscard]] std::size_t tag(std::string_view wanted) const {
        constexpr std::size_t Count = 128, First = 132, Size = 12, Most = 100;
        for (std::size_t i = 0; i < std::min<std::size_t>(u32(Count), Most); ++i)
            if (name(First + i * Size) == wanted)
                return u32(First + i * Size + 4);
        return 0;
    }

private:
    std::span<const std::byte> bytes_;
};

/// Returns what a curve makes of 1/2.
std::optional<double> middle_of_curve(const Profile& profile, std::size_t at) {
    constexpr double Half = 0.5;
    if (profile.name(at) == "curv") {
        const std::uint32_t count = profile.u32(at + 8);
        if (count == 0)
            return Half;
        if (count == 1)
            return std::pow(Half, profile.u16(at + 12) / 256.0);
        const double place = (count - 1.0) * Half;
        const auto below = static_cast<std::size_t>(place);
        const double share = place - static_cast<double>(below);
        return ((1.0 - share) * profile.u16(at + 12 + 2 * below) +
                share * profile.u16(at + 14 + 2 * below)) /
               65535.0;
    }
    if (profile.name(at) != "para")
        return std::nullopt;
    const auto parameter = [&](std::size_t index) {
        return profile.fixed(at + 12 + 4 * index);
    };
    const double gamma = parameter(0);
    switch (static_cast<unsigned>(profile.u16(at + 8))) {
    case 0:
        return std::pow(Half, gamma);
    case 1:
    case 3:
        return std::pow(parameter(1) * Half + parameter(2), gamma);
    case 2:
        return std::pow(parameter(1) * Half + parameter(2), gamma) + parameter(3);
    case 4:
        return std::pow(parameter(1) * Half + parameter(2), gamma) + parameter(5);
    default:
        return std::nullopt;
    }
}

std::optional<Transfer> transfer_of(const Profile& profile) {
    const std::size_t at = profile.tag("gTRC");
    const std::optional<double> middle = at != 0 ? middle_of_curve(profile, at) : std::nullopt;
    if (!middle)
        return std::nullopt;
    struct Known {
        Transfer transfer;
        double middle;
    };
    constexpr std::array<Known, 4> All = {{{Transfer::Linear, 0.5},
                                           {Transfer::Srgb, 0.21404},
                                           {Transfer::Gamma22, 0.21764},
                                           {Transfer::Gamma18, 0.28717}}};
    constexpr double Near = 0.0015;
    for (const Known& each : All)
        if (std::abs(*middle - each.middle) < Near)
            return each.transfer;
    return std::nullopt;
}

glm::dvec2 xy_of(const glm::dvec3& xyz) {
    return glm::dvec2(xyz) / (xyz.x + xyz.y + xyz.z);
}

} // namespace

std::optional<ColorSpace> space_of_icc(std::span<const std::byte> bytes,
                                       std::vector<std::string>& remarks) {
    const Profile profile(bytes);
    const std::optional<Transfer> transfer = transfer_of(profile);
    std::array<glm::dvec2, 3> colors;
    bool is_known = profile.name(36) == "acsp" && profile.name(16) == "RGB " && transfer;
    constexpr std::array<std::string_view, 3> Names = {"rXYZ", "gXYZ", "bXYZ"};
    for (std::size_t i = 0; i < colors.size(); ++i) {
        const std::size_t at = profile.tag(Names[i]);
        is_known = is_known && at != 0;
        colors[i] = xy_of({profile.fixed(at + 8), profile.fixed(at + 12), profile.fixed(at + 16)});
    }
    try {
        // Profiles have their colours as seen under D50. As Bradford has it, they are those of a
        // space whose white is D65, which may have a name.
        constexpr glm::dvec2 D50{0.34570, 0.35854}, White{0.3127, 0.3290};
        const glm::dmat3 seen =
            glm::inverse(rec709_from_xyz()) * to_rec709({colors[0], colors[1], colors[2], D50});
        if (is_known) {
            const std::optional<ColorSpace> space =
                space_of({xy_of(seen[0]), xy_of(seen[1]), xy_of(seen[2]), White});
            if (!space && *transfer == Transfer::Linear)
                return std::nullopt;
            ColorSpace result = space ? *space : *space_of_id("srgb_rec709_display");
            result.transfer = *transfer;
            if (!space)
                result.name = *transfer == Transfer::Srgb ? "sRGB" : "Rec. 709 with a gamma";
            return result;
        }
    } catch (const std::invalid_argument&) { // said by the remark
    }
    remarks.emplace_back("an ICC profile without a matrix and a usual curve is passed over");
    return std::nullopt;
}

} // namespace relumine::cubemap
