#include "app/scenes/info_part.h"

#include <filesystem>

#include <fmt/format.h>

#include "app/options/receiver_options.h"
#include "relumine/in/shared_work.h"

namespace relumine::app {

namespace {

/// The last line: load_plan() and part_facts() have read all of the file.
void say_file(std::uintmax_t num_bytes, const Session& session) {
    session.say(fmt::format("file                {:.1f} MB, checked: whole and sound",
                            static_cast<double>(num_bytes) * 1e-6));
}

} // namespace

void describe_plan(const std::string& path, const Session& session) {
    const prt::Plan plan = prt::load_plan(path);
    const prt::Scene& scene = plan.scene;
    const prt::SceneSettings& settings = scene.settings;
    const auto file_bytes = std::filesystem::file_size(path);
    const std::string name = fmt::format("{:016x}", plan.hash);
    session.say(fmt::format("plan                of a precompute of {}, complete; its name is {}",
                            settings.source, name));
    session.say(fmt::format("mesh                {} vertices, {} triangles (xxHash64 {:016x})",
                            scene.mesh.num_vertices(), scene.mesh.num_triangles(),
                            settings.source_hash));
    session.say(
        fmt::format("receivers           {} ({})", scene.receivers.num_own(),
                    prt::on_vertices(scene.layout) ? "vertices" : prt::description(scene.layout)));
    session.say(fmt::format("clusters            {}, chosen", scene.transfer.num_clusters()));
    session.say(settings.epsilon ? fmt::format("epsilon             {}", *settings.epsilon)
                                 : fmt::format("tolerance           {} 1/sr", settings.tolerance));
    session.say(plan.bounces ? fmt::format("bounces             within {}", plan.bounces->tolerance)
                             : "bounces             none");
    session.say(fmt::format("parts               as many as you like: `relumine precompute --plan "
                            "{} --part I/N` does one, `relumine join` makes the scene",
                            path));
    say_file(file_bytes, session);
    Report result = {{"kind", "plan"},
                     {"plan", name},
                     {"vertices", scene.mesh.num_vertices()},
                     {"triangles", scene.mesh.num_triangles()},
                     {"receivers", scene.receivers.num_own()},
                     {"clusters", scene.transfer.num_clusters()},
                     {"source", settings.source},
                     {"source_hash", fmt::format("{:016x}", settings.source_hash)},
                     {"file_bytes", file_bytes}};
    if (settings.epsilon)
        result.set("epsilon", *settings.epsilon);
    else
        result.set("tolerance", settings.tolerance);
    if (plan.bounces)
        result.set("bounces", plan.bounces->tolerance);
    if (const Report layout = layout_json(scene); layout.size() != 0)
        result.set("layout", layout);
    session.report(result);
}

void describe_part(const std::string& path, const Session& session) {
    const prt::PartFacts facts = prt::part_facts(path);
    const bool is_light = prt::scene_file_kind(path) == prt::SceneFileKind::LightPart;
    const auto file_bytes = std::filesystem::file_size(path);
    session.say(fmt::format("part                {} of {} of {}; `relumine join` with all {} makes "
                            "{}",
                            facts.part.index + 1, facts.part.count,
                            is_light ? "a scene's light" : "a planned precompute", facts.part.count,
                            is_light ? "a .npy of it" : "the scene"));
    session.say(fmt::format("receivers           {} of its own", facts.num_receivers));
    session.say(is_light ? fmt::format("scene and light     {}", facts.whole)
                         : fmt::format("plan                {}{}", facts.whole,
                                       facts.has_plan ? ", which this part carries" : ""));
    say_file(file_bytes, session);
    session.report({{"kind", is_light ? "part of light" : "part"},
                    {"part", facts.part.index + 1},
                    {"parts", facts.part.count},
                    {"receivers", facts.num_receivers},
                    {is_light ? "light" : "plan", facts.whole},
                    {"file_bytes", file_bytes}});
}

} // namespace relumine::app
