#include "app/options/bounce_option.h"

#include <stdexcept>

#include <fmt/format.h>

namespace relumine::app {

void BounceOption::add_to(Command& command, bool by_default, bool can_be_alone) {
    by_default_ = by_default;
    command.add(
        row("--bounces",
            [this, can_be_alone](const std::string& text) {
                is_given_ = true;
                are_alone_ = can_be_alone && text == "only";
                if (text == "all" || are_alone_) {
                    limits_.num_bounces.reset();
                    return;
                }
                const auto count = parse_count(text);
                if (!count)
                    throw UsageError("--bounces",
                                     fmt::format("expected a number of bounces{} or 'all', got "
                                                 "'{}'",
                                                 can_be_alone ? ", 'only'" : "", text));
                limits_.num_bounces = *count;
            },
            fmt::format("how often light goes on from surface to surface: N, 0 for direct light "
                        "alone, {}or all [{}]",
                        can_be_alone ? "only for what surfaces add to the direct light, " : "",
                        by_default ? "all where the scene has bounces, otherwise 0" : "0"),
            {.type = "N"}));
}

bool BounceOption::applies_to(const Scene& scene, const std::string& path) const {
    if ((limits_.num_bounces && *limits_.num_bounces == 0) || (!is_given_ && !by_default_))
        return false;
    if (!scene.bounces && is_given_)
        throw std::runtime_error(fmt::format(
            "{}: expected a scene made with `relumine precompute --bounces`, got one without "
            "bounces",
            path));
    return scene.bounces.has_value();
}

std::optional<BounceReport> BounceOption::bounce(LitScene& lit,
                                                 const relumine::OutputOptions& output,
                                                 const std::string& path) const {
    if (!applies_to(lit.scene(), path))
        return std::nullopt;
    try {
        return lit.bounce({.albedo = bounce_albedo(lit.scene(), output), .limits = limits_});
    } catch (const std::invalid_argument& error) { // about the scene's albedo
        throw std::runtime_error(fmt::format("{}: {}", path, error.what()));
    }
}

std::string text_of(const std::optional<BounceReport>& bounces) {
    return bounces
               ? fmt::format(", {} bounces {:.1f} ms", bounces->num_bounces, 1e3 * bounces->seconds)
               : "";
}

} // namespace relumine::app
