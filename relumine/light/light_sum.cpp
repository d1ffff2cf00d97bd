#include "relumine/light/light_sum.h"

#include <algorithm>
#include <chrono>
#include <cstdint>

#include "files/seconds.h"
#include "relumine/light/passed_on.h"

namespace relumine {

LightSum::LightSum(const Scene& scene, const SharedReceivers& receivers,
                   const relight::Relighter* clusters)
    : receivers_(receivers), clusters_(clusters), passed_(passed_on(scene)) {
    for (relight::PassedOn& own : passed_)
        own.part /= scene.receivers.surfaces[own.other].albedo;
}

double LightSum::find() {
    is_lit_ = true;
    total_.clear();
    if (clusters_ != nullptr && passed_.empty() &&
        std::none_of(terms_.begin() + 1, terms_.end(),
                     [](const auto& term) { return term->is_lit(); }))
        return 0.0;
    total_.assign(receivers_.positions().size(), glm::vec3(0.0f));
    double seconds = 0.0;
    for (const auto& term : terms_) {
        const auto start = std::chrono::steady_clock::now();
        if (term->is_lit())
            term->add_radiance(total_);
        seconds = term->is_lit() ? files::seconds_since(start) : 0.0;
    }
    pass_on();
    return seconds;
}

void LightSum::pass_on() {
    if (passed_.empty())
        return;
    std::vector<glm::vec3> whole = receivers_.of_all(total_);
    const std::vector<glm::vec3> before = whole;
    for (const relight::PassedOn& own : passed_)
        whole[own.receiver] += own.part * before[own.other];
    with_passed_.clear();
    for (const std::uint32_t receiver : receivers_.indices(total_.size()))
        with_passed_.push_back(whole[receiver]);
}

std::span<const glm::vec3> LightSum::reflected() const {
    if (!is_lit_ || !total_.empty() || clusters_ == nullptr)
        return total_;
    return clusters_->radiance();
}

} // namespace relumine
