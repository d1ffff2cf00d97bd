#include "prt/parts/part_file.h"

#include <array>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "files/hash.h"
#include "files/json.h"
#include "mesh/opacity.h"
#include "prt/arithmetic.h"
#include "prt/clusters/dealt_tiles.h"
#include "prt/parts/part_list.h"
#include "prt/scene/bounce_sections.h"
#include "prt/scene/count_sections.h"
#include "prt/scene/glossy_sections.h"
#include "prt/scene/joined_counts.h"
#include "prt/scene/json_members.h"
#include "prt/scene/section_file.h"
#include "prt/scene/section_group.h"
#include "prt/scene/section_reader.h"

namespace relumine::prt {

namespace {

std::vector<std::byte> text_section(const files::Json& json) {
    return bytes_of(json.text(2));
}

/// A part, and where it lies.
struct KnownPart {
    std::filesystem::path path = {};
    PartHead head = {};
};

/// Checks the file, and reads what it says of itself.
KnownPart read_part_head(const std::filesystem::path& path) {
    const SectionReader reader(path);
    require_part(reader);
    return {.path = path, .head = read_head(reader, "part", "plan")};
}

/// Parts of other processors would make a scene that none of them makes alone.
void check_processor(const SectionReader& reader, const files::Json& json) {
    std::string planned;
    try {
        planned = json.at("processor").string();
    } catch (const std::exception&) {
        reader.fail("plan", "JSON with a plan");
    }
    if (planned != arithmetic())
        throw std::runtime_error(fmt::format(
            "{}: expected the plan of a processor and an Embree that compute as here ({}), got {}",
            reader.path().string(), arithmetic(), planned));
}

/// The JSON of a plan has the tolerance of its bounces.
std::optional<PlannedBounces> planned_bounces(const SectionReader& reader,
                                              const files::Json& json) {
    if (json.find("bounce_tolerance") == nullptr)
        return std::nullopt;
    PlannedBounces bounces;
    try {
        bounces.tolerance = real(json.at("bounce_tolerance"));
    } catch (const std::exception&) {
        reader.fail("plan", "JSON with a plan");
    }
    bounces.probes = reader.elements<ProbeRadiance>("plan_probes");
    if (!(bounces.tolerance > 0.0f))
        reader.fail("plan", "a tolerance of bounces above 0");
    for (const ProbeRadiance& probe : bounces.probes)
        for (const float value : probe)
            if (!(value >= 0.0f && std::isfinite(value)))
                reader.fail("plan_probes", "light that is not negative");
    return bounces;
}

/// `path` is for messages.
NewSections sections_of(const std::filesystem::path& path, const Plan& plan) {
    if (plan.scene.transfer.glossy || plan.scene.bounces)
        throw std::invalid_argument(
            fmt::format("{}: expected a scene without light", path.string()));
    NewSections sections = sections_without_light(path, plan.scene);
    files::Json json = files::Json::Object{};
    json.set("processor", arithmetic());
    if (plan.has_clusters)
        json.set("clusters", plan.scene.transfer.num_clusters());
    if (plan.bounces) {
        json.set("bounce_tolerance", plan.bounces->tolerance);
        sections["plan_probes"] = SectionContent::view(plan.bounces->probes);
    }
    sections["plan"] = text_section(json);
    return sections;
}

Plan plan_from(const SectionReader& reader) {
    const files::Json json = reader.json("plan");
    check_processor(reader, json);
    Plan plan{.scene = plan_of(reader),
              .bounces = planned_bounces(reader, json),
              .has_clusters = json.find("clusters") != nullptr};
    if (plan.bounces && plan.has_clusters &&
        plan.bounces->probes.size() != num_sampled_receivers(plan.scene.transfer.num_receivers()))
        reader.fail("plan_probes", "the light of a sample of the receivers");
    return plan;
}

void add_light(NewSections& sections, const PartLight& light) {
    add_counts(sections, light.counts);
    if (light.glossy)
        add_glossy_sections(sections, *light.glossy);
    if (light.bounces)
        add_bounce_samples(sections, *light.bounces);
}

PartLight light_of(const SectionReader& reader, const Part& part, const Transfer& transfer) {
    PartLight light;
    VisibleCounts& counts = light.counts;
    counts.num_receivers = places_of(part, transfer.num_receivers()).size();
    counts.num_leaves = transfer.num_clusters();
    read_counts(reader, counts);
    if (has_glossy(reader))
        light.glossy = read_glossy(reader, counts.num_blocks());
    light.bounces =
        read_bounce_samples(reader, counts.num_receivers,
                            places_of(part, transfer.num_points).size(), transfer.num_receivers());
    return light;
}

/// What concerns the colours of a mesh. They are in the receivers' surfaces already, and rays
/// ask only for what they pass.
constexpr std::array<const char*, 8> ColorSections = {"colors",          "uvs",       "second_uvs",
                                                      "corner_tangents", "materials", "images",
                                                      "t_materials",     "corner_uvs"};

} // namespace

std::uint64_t save_plan(const std::filesystem::path& path, const Plan& plan) {
    return write_sections(path, sections_of(path, plan));
}

Plan load_plan(const std::filesystem::path& path) {
    const SectionReader reader(path);
    if (!reader.has("plan") || reader.has("part"))
        throw std::runtime_error(fmt::format("{}: expected a plan, got {}", path.string(),
                                             reader.has("part") ? "a part of a scene" : "a scene"));
    Plan plan = plan_from(reader);
    if (!plan.has_clusters)
        throw std::runtime_error(fmt::format("{}: expected a plan with clusters", path.string()));
    plan.hash = files::file_hash(path);
    return plan;
}

void share_plan(Team& team, Plan& plan) {
    if (!team.has_others())
        return;
    std::vector<std::byte> bytes;
    if (team.is_first()) {
        NewSections sections = sections_of("plan", plan);
        if (!mesh::lets_light_pass(plan.scene.blocking_mesh()))
            for (const char* name : ColorSections)
                sections.erase(name);
        bytes = packed_sections(sections);
    }
    bytes = team.broadcast(std::move(bytes));
    if (!team.is_first())
        plan = plan_from(SectionReader("plan", std::move(bytes)));
}

std::uint64_t save_part(const std::filesystem::path& path, const Plan& plan, const Part& part,
                        const PartLight& light) {
    NewSections sections;
    if (part.index == 0)
        sections = sections_without_light(path, plan.scene);
    const PartHead head{part, fmt::format("{:016x}", plan.hash),
                        static_cast<std::uint32_t>(light.counts.num_receivers)};
    sections["part"] = text_section(json_of(head, "plan"));
    // A scene's reader says what it is.
    sections["plan"] = text_section(files::Json::Object{});
    add_light(sections, light);
    return write_sections(path, sections);
}

std::uint64_t join_parts(std::span<const std::filesystem::path> paths,
                         const std::filesystem::path& output) {
    const auto parts = all_parts_of("plan", paths, read_part_head);
    const std::filesystem::path& first = parts.front()->path;
    Scene scene = plan_of(SectionReader(first));
    JoinedCounts counts(scene.transfer.num_receivers(), scene.transfer.num_clusters(),
                        parts.size());
    std::vector<PartLight> light;
    try {
        for (const std::optional<KnownPart>& part : parts) {
            const SectionReader reader(part->path);
            light.push_back(light_of(reader, part->head.part, scene.transfer));
            counts.add(reader, part->head.part, std::exchange(light.back().counts, {}));
        }
        join_highlights_and_bounces(scene, light);
    } catch (const std::invalid_argument& error) {
        throw std::runtime_error(fmt::format("{}: {}", first.string(), error.what()));
    }
    NewSections sections = sections_without_light(output, scene);
    counts.add_to(sections);
    if (scene.transfer.glossy)
        add_glossy_sections(sections, *scene.transfer.glossy);
    return write_sections(output, sections);
}

std::vector<PartLight> gather_light(Team& team, const Scene& scene, PartLight&& own) {
    std::vector<PartLight> lights;
    lights.push_back(std::move(own));
    if (!team.has_others())
        return lights;
    NewSections sections;
    if (!team.is_first())
        add_light(sections, lights[0]);
    std::vector<std::vector<std::byte>> of_all =
        team.gather(team.is_first() ? std::vector<std::byte>() : packed_sections(sections));
    if (!team.is_first())
        return {};
    for (std::uint32_t i = 1; i < of_all.size(); ++i) {
        const SectionReader reader("part", std::move(of_all[i]));
        lights.push_back(light_of(reader, {i, team.part().count}, scene.transfer));
    }
    return lights;
}

} // namespace relumine::prt
