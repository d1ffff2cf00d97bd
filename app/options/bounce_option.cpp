#include "app/options/bounce_option.h"

#include <stdexcept>

#include <fmt/format.h>

namespace relumine::app {

void BounceOption::add_to(Command& command) {
    command.add(
        row("--bounces",
            [this](const std::string& text) {
                is_given_ = true;
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
            "alone, or all [all where the scene was made with --bounces, otherwise 0]",
            {.type = "N"}));
}

bool BounceOption::applies_to(const Scene& scene, const std::string& path) const {
    if (limits_.num_bounces && *limits_.num_bounces == 0)
        return false;
    if (!scene.bounces && is_given_)
        throw std::runtime_error(fmt::format(
            "{}: expected a scene made with `relumine precompute --bounces`, got one without "
            "bounces",
            path));
    return scene.bounces.has_value();
}

namespace {

/// The path belongs to messages about the scene's albedo.
template<typename Function>
auto naming(const std::string& path, const Function& function) {
    try {
        return function();
    } catch (const std::invalid_argument& error) {
        throw std::runtime_error(fmt::format("{}: {}", path, error.what()));
    }
}

} // namespace

std::optional<BounceReport> BounceOption::bounce(LitScene& lit,
                                                 const relumine::OutputOptions& output,
                                                 const std::string& path,
                                                 std::span<const glm::vec3> more) const {
    if (!applies_to(lit.scene(), path))
        return std::nullopt;
    return naming(path,
                  [&] { return lit.bounce(bounce_albedo(lit.scene(), output), limits_, more); });
}

std::optional<BounceReport> BounceOption::bounce(SharedLight& light,
                                                 const relumine::OutputOptions& output,
                                                 const std::string& path,
                                                 std::span<const glm::vec3> more) const {
    if (!set(light, output, path))
        return std::nullopt;
    return light.bounce(more);
}

bool BounceOption::set(SharedLight& light, const relumine::OutputOptions& output,
                       const std::string& path) const {
    const Scene& scene = light.lit().scene();
    if (!applies_to(scene, path))
        return false;
    naming(path,
           [&] { light.set_bounces(bounces_of(scene, bounce_albedo(scene, output), limits_)); });
    return true;
}

void BounceOption::set(relight::Relighter& relighter, const Scene& scene,
                       const relumine::OutputOptions& output, const std::string& path) const {
    if (applies_to(scene, path))
        naming(path, [&] {
            relighter.set_bounces(bounces_of(scene, bounce_albedo(scene, output), limits_));
        });
}

std::string text_of(const std::optional<BounceReport>& bounces) {
    return bounces
               ? fmt::format(", {} bounces {:.1f} ms", bounces->num_bounces, 1e3 * bounces->seconds)
               : "";
}

} // namespace relumine::app
