#include "app/options/refine_options.h"

#include <utility>

#include <fmt/format.h>

#include "relumine/environment.h"

namespace relumine::app {

namespace {

constexpr double LargestError = 1.0;

} // namespace

void RefineOptionGroup::add_to_precompute(Command& command) {
    command
        .add_option(
            "--refine",
            [this](const std::string& text) {
                const std::optional<double> error =
                    text.empty() ? std::optional<double>(*RefineOptions{}.error)
                                 : parse_number(text);
                if (!error || !(*error >= 0.0 && *error <= LargestError))
                    throw UsageError("--refine",
                                     fmt::format("expected an error of 0 to {}, got '{}'; the mesh "
                                                 "goes first: relumine precompute {} --refine",
                                                 LargestError, text, text));
                error_ = static_cast<float>(*error);
            },
            fmt::format("split edges while the light at their middle may differ so much from the "
                        "mean of their ends: RMS of the transfer, 1/sr, {} when no error is given",
                        *RefineOptions{}.error))
        .value_is_optional()
        .type_name("[ERROR]");
    add_limits(command);
}

void RefineOptionGroup::add_to_refine(Command& command) {
    is_command_ = true;
    command
        .add_option("--error", error_,
                    fmt::format("split edges while the light at their middle may differ so much "
                                "from the mean of their ends: RMS of the transfer, 1/sr ({}; "
                                "light is not asked where only --max-edge is given)",
                                *RefineOptions{}.error))
        .between(0.0, LargestError);
    add_limits(command);
}

void RefineOptionGroup::add_limits(Command& command) {
    command
        .add_option("--max-vertices", max_vertices_,
                    "let the mesh grow to so many vertices; the edges that matter most come first")
        .between(1, 4294967294.0)
        .type_name("N");
    command
        .add_option("--min-edge", min_edge_,
                    "leave no edges shorter than this, in the mesh's unit (1/1000 of its diagonal)")
        .between(0.0, LargestPosition)
        .type_name("LENGTH");
    command.add_option("--max-edge", max_edge_, "split all edges that are longer than this")
        .between(0.0, LargestPosition)
        .type_name("LENGTH");
    command.add_flag("--curved", curved_,
                     "put new vertices on the smooth surface that the normals pretend");
    command
        .add_option("--refine-for", light_,
                    "the environment that matters most, .exr or .hdr: more vertices at the shadows "
                    "of its sun; the scene can still be lit by any other")
        .file()
        .type_name("ENV");
}

bool RefineOptionGroup::is_wanted() const {
    return is_command_ || error_ || max_edge_;
}

void RefineOptionGroup::check() const {
    if (!is_wanted())
        for (const auto& [is_given, name] :
             {std::pair(max_vertices_ != 0, "--max-vertices"),
              std::pair(min_edge_.has_value(), "--min-edge"), std::pair(curved_, "--curved"),
              std::pair(!light_.empty(), "--refine-for")})
            if (is_given)
                throw UsageError(name, "expected --refine or --max-edge with it");
    if (!light_.empty() && max_edge_ && !error_)
        throw UsageError("--refine-for",
                         fmt::format("expected {} with it: --max-edge alone asks for no light",
                                     is_command_ ? "--error" : "--refine"));
    if (max_edge_ && !(*max_edge_ > 0.0f))
        throw UsageError("--max-edge", fmt::format("expected a length > 0, got {}", *max_edge_));
    if (max_edge_ && min_edge_ && *min_edge_ > *max_edge_)
        throw UsageError("--min-edge", fmt::format("expected at most the --max-edge of {}, got {}",
                                                   *max_edge_, *min_edge_));
}

Mesh RefineOptionGroup::refined(Mesh mesh, std::optional<float> bias, Session& session) const {
    RefineOptions options{.error = error_,
                          .max_edge = max_edge_,
                          .min_edge = min_edge_,
                          .curved = curved_,
                          .bias = bias};
    if (is_command_ && !error_ && !max_edge_)
        options.error = RefineOptions{}.error;
    if (max_vertices_ != 0)
        options.max_vertices = max_vertices_;
    if (!light_.empty())
        options.light = load_environment(light_).map;
    const std::size_t num_before = mesh.geometry.num_vertices();
    RefineReport found;
    Mesh result = relumine::refined(
        std::move(mesh), options,
        {.stop = session.stop(), .on_progress = session.progress("refine")}, &found);
    session.end_progress();
    const std::size_t num_after = result.geometry.num_vertices();
    if (num_after == num_before)
        session.say("refined: no edge needs to be split");
    else
        session.say(fmt::format(
            "refined: {} vertices became {} in {} rounds, {:.1f} s{}", num_before, num_after,
            found.num_rounds, found.seconds,
            found.is_at_limit
                ? fmt::format("; at the limit, with errors up to {:.4f}", found.largest_error)
                : ""));
    session.add_to_report("refine", Report({{"vertices_before", num_before},
                                            {"vertices", num_after},
                                            {"rounds", found.num_rounds},
                                            {"points", found.num_points},
                                            {"at_limit", found.is_at_limit},
                                            {"largest_error", found.largest_error},
                                            {"seconds", found.seconds}}));
    return result;
}

} // namespace relumine::app
