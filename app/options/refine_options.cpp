#include "app/options/refine_options.h"

#include <limits>
#include <span>
#include <utility>

#include <fmt/format.h>

#include "relumine/in/environment.h"

namespace relumine::app {

void report_refinement(const RefineReport& found, std::size_t num_vertices, Session& session) {
    session.add_to_report("refine", Report({{"vertices_before", num_vertices - found.num_added},
                                            {"vertices", num_vertices},
                                            {"rounds", found.num_rounds},
                                            {"points", found.num_points},
                                            {"at_limit", found.is_at_limit},
                                            {"largest_error", found.largest_error},
                                            {"seconds", found.seconds}}));
}

void RefineOptionGroup::add_to_precompute(Command& command, bool& keeps_vertices) {
    OptionTable table = options_of(options_);
    OptionRow& error = table.front();
    error.name = "--refine";
    error.help += fmt::format(", {} when no error is given; off: keep the mesh's vertices, where a "
                              "coarse mesh gets more by itself",
                              *RefineOptions{}.error);
    error.max = std::numeric_limits<double>::infinity(); // off is no number
    error.read = [read = error.read, &keeps_vertices](std::span<const std::string> texts) {
        keeps_vertices = texts.back() == "off";
        if (keeps_vertices)
            return;
        if (const auto number = parse_number(texts.back());
            !number || !(*number >= 0.0 && *number <= 1.0))
            refuse_text("off or an error from 0 to 1", texts.back());
        read(texts);
    };
    error.bare = fmt::format("{}", *RefineOptions{}.error);
    error.type = "[ERROR|off]";
    add(command, std::move(table));
}

void RefineOptionGroup::add_to_refine(Command& command) {
    is_command_ = true;
    OptionTable table = options_of(options_);
    table.front().help += fmt::format(" ({}; light is not asked where only --max-edge is given)",
                                      *RefineOptions{}.error);
    add(command, std::move(table));
}

void RefineOptionGroup::add(Command& command, OptionTable table) {
    table.push_back(
        row("--refine-for", light_,
            "the environment that matters most: more vertices at the shadows of its sun; the scene "
            "can still be lit by any other",
            {.file = true, .type = "ENV"}));
    for (const Option& option : command.add_all(std::move(table)))
        if (option.name() != "--refine" && option.name() != "--tolerance" &&
            option.name() != "--max-edge")
            limits_.push_back(option);
}

bool RefineOptionGroup::is_wanted() const {
    return is_command_ || options_.error || options_.max_edge;
}

void RefineOptionGroup::check() const {
    const std::optional<float>& max_edge = options_.max_edge;
    if (!is_wanted())
        for (const Option& option : limits_)
            if (option.is_given())
                throw UsageError(option.name(), "expected --refine or --max-edge with it");
    if (!light_.empty() && max_edge && !options_.error)
        throw UsageError("--refine-for",
                         fmt::format("expected {} with it: --max-edge alone asks for no light",
                                     is_command_ ? "--tolerance" : "--refine"));
    if (max_edge && !(*max_edge > 0.0f))
        throw UsageError("--max-edge", fmt::format("expected a length > 0, got {}", *max_edge));
}

Mesh RefineOptionGroup::refined(Mesh mesh, std::optional<float> bias, Session& session) const {
    RefineOptions options = options_;
    options.bias = bias;
    if (is_command_ && !options.error && !options.max_edge)
        options.error = RefineOptions{}.error;
    if (!light_.empty())
        options.light = relumine::load_environment(light_).map;
    const std::size_t num_before = mesh.geometry.num_vertices();
    RefineReport found;
    Mesh result = relumine::refined(std::move(mesh), options, session.work("refine"), &found);
    session.end_progress();
    const std::size_t num_after = result.geometry.num_vertices();
    if (num_after == num_before)
        session.say("refined: no edge needs to be split");
    else
        session.say(fmt::format(
            "refined: {} vertices became {} in {} rounds, {:.1f} s{}", num_before, num_after,
            found.num_rounds, found.seconds,
            found.is_at_limit
                ? fmt::format("; at the limit, with transfer off by up to {:.4f} per steradian",
                              found.largest_error)
                : ""));
    report_refinement(found, num_after, session);
    return result;
}

} // namespace relumine::app
