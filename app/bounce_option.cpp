#include "app/bounce_option.h"

#include <stdexcept>

#include <fmt/format.h>

namespace relumine::app {

void BounceOption::add_to(Command& command) {
    given_ =
        command
            .add_option(
                "--bounces",
                [this](const std::string& text) {
                    if (text == "all") {
                        limits_.num_bounces.reset();
                        return;
                    }
                    const auto count = parse_count(text);
                    if (!count)
                        throw UsageError(
                            "--bounces",
                            fmt::format("expected a number of bounces or 'all', got '{}'", text));
                    limits_.num_bounces = *count;
                },
                "how often light goes on from surface to surface: N, 0 for direct light "
                "alone, or all [all where the scene was made with --bounces, otherwise 0]")
            .type_name("N");
}

std::optional<BounceReport> BounceOption::bounce(LitScene& lit,
                                                 const relumine::OutputOptions& output,
                                                 const std::string& path) const {
    const bool wants_none = limits_.num_bounces && *limits_.num_bounces == 0;
    if (wants_none)
        return std::nullopt;
    if (!lit.scene().bounces) {
        if (given_.is_given())
            throw std::runtime_error(fmt::format(
                "{}: expected a scene made with `relumine precompute --bounces`, got one without "
                "bounces",
                path));
        return std::nullopt;
    }
    try {
        return lit.bounce(picture_albedo(lit.scene(), output), limits_);
    } catch (const std::invalid_argument& error) {
        throw std::runtime_error(fmt::format("{}: {}", path, error.what()));
    }
}

std::string text_of(const std::optional<BounceReport>& bounces) {
    return bounces
               ? fmt::format(", {} bounces {:.1f} ms", bounces->num_bounces, 1e3 * bounces->seconds)
               : "";
}

} // namespace relumine::app
