#include "prt/glossy/thin_film.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include <glm/common.hpp>
#include <glm/exponential.hpp>
#include <glm/vec3.hpp>

#include "prt/glossy/kept_energy.h"
#include "prt/glossy/stretched_lobe.h"

namespace relumine::prt {

namespace {

/// What the eye sees of waves that went different ways: the Fourier transform of its sensitivities,
/// as sums of bells [Belcour and Barla 2017, Section 4]. White where the ways are the same.
class Interference {
public:
    Interference() {
        for (std::size_t i = 0; i < Steps; ++i)
            colors_.emplace_back(exact(Step * static_cast<double>(i)));
    }

    /// Returns the colour of waves whose ways differ by so many nanometres.
    [[nodiscard]] glm::vec3 at(float difference) const {
        const float place = difference / static_cast<float>(Step);
        if (!(place < static_cast<float>(Steps - 1)))
            return glm::vec3(0.0f);
        const auto i = static_cast<std::size_t>(place);
        return glm::mix(colors_[i], colors_[i + 1], place - static_cast<float>(i));
    }

private:
    /// In nanometres. Between two, colours turn by 0.1 of 1000 at most; behind the last all bells
    /// have less than 1e-7 left.
    static constexpr double Step = 2.0;
    static constexpr std::size_t Steps = 5001;

    static glm::dvec3 exact(double difference) {
        /// The height of a bell, its wave number times 2 pi and its squared width, in metres.
        struct Bell {
            double height, place, square;
        };
        constexpr Bell X{5.4856e-13, 1.6810e6, 4.3278e9}, Y{4.4201e-13, 1.7953e6, 9.3046e9},
            Z{5.2481e-13, 2.2084e6, 6.6121e9}, BlueOfX{9.7470e-14, 2.2399e6, 4.5282e9};
        const auto rgb = [&](double phase) {
            const auto bell = [&](const Bell& of) {
                return of.height * std::sqrt(2.0 * std::numbers::pi * of.square) *
                       std::cos(of.place * phase) * std::exp(-of.square * phase * phase);
            };
            const double x = bell(X) + bell(BlueOfX), y = bell(Y), z = bell(Z);
            return glm::dvec3(3.2404542 * x - 1.5371385 * y - 0.4985314 * z,
                              -0.9692660 * x + 1.8760108 * y + 0.0415560 * z,
                              0.0556434 * x - 0.2040259 * y + 1.0572252 * z);
        };
        return rgb(2e-9 * std::numbers::pi * difference) / rgb(0.0);
    }

    std::vector<glm::vec3> colors_;
};

float squared(float value) {
    return value * value;
}

/// Returns the roughness of a round lobe about as wide as a surface's.
float round_roughness(const Surface& surface) {
    const float roughness = surface.roughness_or_exponent;
    return is_stretched(surface)
               ? std::pow(alpha_along(roughness, surface.anisotropy) * ggx_alpha(roughness), 0.25f)
               : roughness;
}

} // namespace

ThinFilm::ThinFilm(float ior, float thickness, const glm::vec3& base_f0)
    : inverse_ior2_(1.0f / squared(ior)), way_(2.0f * ior * thickness),
      outer_f0_(squared((ior - 1.0f) / (ior + 1.0f))) {
    // A base of F0 1 has no index.
    constexpr float LargestF0 = 0.9999f;
    for (int color = 0; color < 3; ++color) {
        const float root = std::sqrt(std::clamp(base_f0[color], 0.0f, LargestF0));
        const float base_ior = (1.0f + root) / (1.0f - root);
        inner_f0_[color] = squared((base_ior - ior) / (base_ior + ior));
        // Light is turned by half a wave where it meets what is denser: outside of the film always,
        // inside where the base is.
        sign_[color] = base_ior < ior ? 1.0f : -1.0f;
    }
}

glm::vec3 ThinFilm::mirrored(float cosine) const {
    static const Interference interference;
    const float inside = std::sqrt(std::max(1.0f - inverse_ior2_ * (1.0f - squared(cosine)), 0.0f));
    const float outer = outer_f0_ + (1.0f - outer_f0_) * schlick(cosine);
    const glm::vec3 inner = inner_f0_ + (1.0f - inner_f0_) * schlick(inside);
    const glm::vec3 both = glm::min(outer * inner, 0.9999f);
    const glm::vec3 through = squared(1.0f - outer) * inner / (1.0f - both);
    glm::vec3 result = outer + through;
    glm::vec3 waves = through - (1.0f - outer);
    const glm::vec3 again = glm::sqrt(both) * sign_;
    for (int times = 1; times <= 2; ++times) {
        waves *= again;
        result += 2.0f * waves * interference.at(static_cast<float>(times) * way_ * inside);
    }
    return glm::clamp(result, 0.0f, 1.0f);
}

FilmHighlight::Part::Part(const Surface& surface, const glm::vec3& own_f0, float own_f90,
                          float lost)
    : film(surface.film_ior, surface.film_thickness, own_f0), f0(own_f0), f90(own_f90) {
    factor = 1.0f + lost * at(1.0f, surface.film);
}

glm::vec3 FilmHighlight::Part::at(float v_h, float share) const {
    const float c = schlick(v_h);
    return factor * glm::mix(f0 * (1.0f - c) + f90 * c, film.mirrored(v_h), share);
}

FilmHighlight::FilmHighlight(const Surface& surface, const EyeCosines& n_v)
    : FilmHighlight(surface, n_v, MetalAndRest(surface), ggx_albedo(surface, n_v).all) {}

FilmHighlight::FilmHighlight(const Surface& surface, const EyeCosines& n_v, const MetalAndRest& f0,
                             float whole)
    : film_(surface.film), metallic_(f0.share), roughness_(round_roughness(surface)),
      n_v_(n_v.base), whole_(whole), metal_(surface, f0.metal, 1.0f, (1.0f - whole) / whole),
      rest_(surface, f0.rest, surface.dielectric_f90, (1.0f - whole) / whole) {}

glm::vec3 FilmHighlight::at(float v_h) const {
    if (metallic_ == 0.0f)
        return rest_.at(v_h, film_);
    if (metallic_ == 1.0f)
        return metal_.at(v_h, film_);
    return glm::mix(rest_.at(v_h, film_), metal_.at(v_h, film_), metallic_);
}

FilmHighlight::Albedo FilmHighlight::albedo() const {
    Albedo albedo;
    for (const LobeFacet& facet : lobe_facets(roughness_, n_v_)) {
        albedo.all += facet.share * at(facet.v_h);
        if (metallic_ < 1.0f)
            albedo.rest += facet.share * rest_.at(facet.v_h, film_);
    }
    albedo.all *= whole_;
    albedo.rest *= whole_;
    return albedo;
}

} // namespace relumine::prt
