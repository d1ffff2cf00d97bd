// Light that a thin film mirrors: the colours of soap, oil and tempered steel.
//
// Based on: Belcour and Barla, "A Practical Extension to Microfacet Theory for the Modeling of
// Varying Iridescence", SIGGRAPH 2017, in the form of glTF's KHR_materials_iridescence.
#pragma once

#include <glm/vec3.hpp>

#include "prt/receivers/surface.h"

namespace relumine::prt {

struct MetalAndRest;

/// Whether a surface has a film. GGX as published has none.
[[nodiscard]] inline bool has_film(const Surface& surface) {
    return surface.highlight == Highlight::GgxWhole && surface.film > 0.0f &&
           surface.film_thickness > 0.0f;
}

/// A film over a base that mirrors F0.
class ThinFilm {
public:
    /// `thickness` is in nanometres, above 0.
    ThinFilm(float ior, float thickness, const glm::vec3& base_f0);

    /// Returns what the film and its base mirror of white light, 0 to 1 for red, green and blue,
    /// for a cosine between the light and the normal of a facet.
    ///
    /// Error:   against the sum of all waves over the CIE's curves. Up to 37 degrees it is 0.015
    ///          over glass and 0.035 over metals, at 60 degrees 0.04 over glass. As in glTF,
    ///          Schlick's formula stands for each side of the film, and waves that were mirrored
    ///          there more than twice are left out.
    /// Differs from glTF: a film that mirrors all wavelengths alike is white. There it is reddish.
    /// Cost:    some 30 ns; the first call makes a table.
    /// Threads: any.
    [[nodiscard]] glm::vec3 mirrored(float cosine) const;

private:
    /// Over the film's index, squared
    float inverse_ior2_;
    /// The way through the film and back, straight on
    float way_;
    /// What its outer and its inner side mirror, straight on
    float outer_f0_;
    glm::vec3 inner_f0_{0.0f};
    /// -1 where waves of the inner side come back as those of the outer side, 1 where they do not
    glm::vec3 sign_{-1.0f};
};

/// All that Fresnel gives the highlight of a surface with a film, by colour. It has the factors
/// that keep its energy: times the lobe S it is the highlight.
class FilmHighlight {
public:
    /// For an eye above the normal.
    FilmHighlight(const Surface& surface, const EyeCosines& n_v);

    /// Returns the factor on S for a cosine between the eye and the half vector.
    [[nodiscard]] glm::vec3 at(float v_h) const;

    /// What the surface sends of a white sky: the whole highlight, and that of the part that is not
    /// metal alone.
    struct Albedo {
        glm::vec3 all{0.0f}, rest{0.0f};
    };
    /// Error:   0.01, of 12 facets.
    [[nodiscard]] Albedo albedo() const;

private:
    FilmHighlight(const Surface& surface, const EyeCosines& n_v, const MetalAndRest& f0,
                  float whole);

    /// A metal, or what is not.
    struct Part {
        Part(const Surface& surface, const glm::vec3& own_f0, float own_f90, float lost);
        [[nodiscard]] glm::vec3 at(float v_h, float share) const;
        ThinFilm film;
        glm::vec3 f0;
        float f90;
        /// Turquin's
        glm::vec3 factor{1.0f};
    };
    float film_, metallic_, roughness_, n_v_;
    /// The integral of S
    float whole_;
    Part metal_, rest_;
};

} // namespace relumine::prt
