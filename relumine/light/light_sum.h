// The sum of the terms of a scene's light.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "relight/bounces/bounce_light.h"
#include "relumine/light/terms.h"

namespace relumine {

/// Sums terms, and adds what surfaces pass on from behind them.
class LightSum {
public:
    /// They must outlive this object. Where there are clusters, their term is the first. Without
    /// them `clusters` is null.
    LightSum(const Scene& scene, const SharedReceivers& receivers,
             const relight::Relighter* clusters);

    /// Adds a term, which counts from the next find() on.
    void add(std::unique_ptr<const LightTerm> term) { terms_.push_back(std::move(term)); }
    /// In the order in which they are added
    [[nodiscard]] std::span<const std::unique_ptr<const LightTerm>> terms() const { return terms_; }

    /// Sums the terms. Returns the seconds that the last one took, where it is lit.
    double find();
    /// Whether find() was called
    [[nodiscard]] bool is_lit() const { return is_lit_; }
    [[nodiscard]] bool passes_on() const { return !passed_.empty(); }
    /// [receivers of this process], and the same without what surfaces pass on. Empty before
    /// find().
    [[nodiscard]] std::span<const glm::vec3> radiance() const {
        return with_passed_.empty() ? reflected() : with_passed_;
    }
    [[nodiscard]] std::span<const glm::vec3> reflected() const;

private:
    void pass_on();

    const SharedReceivers& receivers_;
    const relight::Relighter* clusters_;
    std::vector<std::unique_ptr<const LightTerm>> terms_;
    bool is_lit_ = false;
    /// Empty where the clusters' term is all
    std::vector<glm::vec3> total_;
    /// What surfaces pass on, as a part of the other receiver's radiance, and the sum with it
    std::vector<relight::PassedOn> passed_;
    std::vector<glm::vec3> with_passed_;
};

} // namespace relumine
