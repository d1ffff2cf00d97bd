#include "prt/parts/part_file.h"

#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "files/hash.h"
#include "files/json.h"
#include "prt/arithmetic.h"
#include "prt/parts/part_list.h"
#include "prt/scene/bounce_sections.h"
#include "prt/scene/count_sections.h"
#include "prt/scene/glossy_sections.h"
#include "prt/scene/json_members.h"
#include "prt/scene/section_file.h"
#include "prt/scene/section_group.h"
#include "prt/scene/section_reader.h"

namespace relumine::prt {

namespace {

std::vector<std::byte> text_section(const files::Json& json) {
    return bytes_of(json.text(2));
}

/// A part as its file has it.
struct StoredPart {
    SectionReader reader;
    Part part = {};
    /// The hash of the plan
    std::string whole = {};
    std::uint32_t num_receivers = 0;
};

StoredPart read_part(const std::filesystem::path& path) {
    StoredPart stored{.reader = SectionReader(path, read_sections(path))};
    if (!stored.reader.has("part"))
        throw std::runtime_error(fmt::format("{}: expected a part, got {}", path.string(),
                                             stored.reader.has("plan") ? "a plan" : "a scene"));
    const files::Json json = stored.reader.json("part");
    try {
        stored.part = {.index = natural(json.at("index")), .count = natural(json.at("count"))};
        stored.whole = json.at("plan").string();
        stored.num_receivers = natural(json.at("receivers"));
        if (stored.part.index >= stored.part.count || stored.part.count > MaxParts)
            throw std::out_of_range("expected an index below the count");
    } catch (const std::exception&) {
        stored.reader.fail("part", "JSON with the place of the part");
    }
    return stored;
}

/// Parts of other processors would make a scene that none of them makes alone.
void check_processor(const SectionReader& reader) {
    const files::Json json = reader.json("plan");
    std::string planned;
    try {
        planned = json.at("processor").string();
    } catch (const std::exception&) {
        reader.fail("plan", "JSON with a plan");
    }
    if (planned != arithmetic())
        throw std::runtime_error(fmt::format(
            "{}: expected the plan of a processor that computes as this one ({}), got {}",
            reader.path().string(), arithmetic(), planned));
}

/// Of a plan: the JSON has the tolerance.
std::optional<PlannedBounces> planned_bounces(const SectionReader& reader) {
    const files::Json json = reader.json("plan");
    if (!json.find("bounce_tolerance"))
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

PartLight light_of(const StoredPart& stored, std::size_t num_leaves, std::size_t num_receivers) {
    const SectionReader& reader = stored.reader;
    PartLight light;
    VisibleCounts& counts = light.counts;
    counts.num_receivers = stored.num_receivers;
    counts.num_leaves = num_leaves;
    read_counts(reader, counts);
    if (has_glossy(reader))
        light.glossy = read_glossy(reader, counts.num_blocks());
    light.bounces = read_bounce_samples(reader, counts.num_receivers, num_receivers);
    return light;
}

} // namespace

std::uint64_t save_plan(const std::filesystem::path& path, const Scene& scene,
                        const std::optional<PlannedBounces>& bounces) {
    if (scene.transfer.glossy || scene.bounces)
        throw std::invalid_argument(
            fmt::format("{}: expected a scene without light", path.string()));
    NewSections sections = sections_without_light(path, scene);
    files::Json json = {{"clusters", scene.transfer.num_clusters()}, {"processor", arithmetic()}};
    if (bounces) {
        json.set("bounce_tolerance", bounces->tolerance);
        sections["plan_probes"] = SectionContent::view(bounces->probes);
    }
    sections["plan"] = text_section(json);
    return write_sections(path, sections);
}

Plan load_plan(const std::filesystem::path& path) {
    Sections sections = read_sections(path);
    if (!sections.contains("plan") || sections.contains("part"))
        throw std::runtime_error(
            fmt::format("{}: expected a plan, got {}", path.string(),
                        sections.contains("part") ? "a part of a scene" : "a scene"));
    Sections own = {{"plan", sections["plan"]}};
    if (const auto probes = sections.find("plan_probes"); probes != sections.end())
        own.insert(sections.extract(probes));
    const SectionReader reader(path, std::move(own));
    check_processor(reader);
    std::optional<PlannedBounces> bounces = planned_bounces(reader);
    Plan plan{.scene = plan_of(path, std::move(sections)),
              .bounces = std::move(bounces),
              .hash = files::file_hash(path)};
    if (plan.bounces &&
        plan.bounces->probes.size() != num_sampled_receivers(plan.scene.transfer.num_receivers()))
        reader.fail("plan_probes", "the light of a sample of the receivers");
    return plan;
}

std::uint64_t save_part(const std::filesystem::path& path, const Plan& plan, const Part& part,
                        const PartLight& light) {
    NewSections sections;
    if (part.index == 0)
        sections = sections_without_light(path, plan.scene);
    sections["part"] = text_section({{"index", part.index},
                                     {"count", part.count},
                                     {"plan", fmt::format("{:016x}", plan.hash)},
                                     {"receivers", light.counts.num_receivers}});
    // A scene's reader says what it is.
    sections["plan"] = text_section(files::Json::Object{});
    add_counts(sections, light.counts);
    if (light.glossy)
        add_glossy_sections(sections, *light.glossy);
    if (light.bounces)
        add_bounce_samples(sections, *light.bounces);
    return write_sections(path, sections);
}

Scene join_parts(std::span<const std::filesystem::path> paths) {
    auto parts = all_parts_of("plan", paths, read_part);
    const std::filesystem::path first = parts.front()->reader.path();
    Scene scene = plan_of(first, read_sections(first));
    std::vector<PartLight> light;
    for (std::optional<StoredPart>& part : parts) {
        light.push_back(
            light_of(*part, scene.transfer.num_clusters(), scene.transfer.num_receivers()));
        part.reset();
    }
    try {
        join_light(scene.transfer, light);
        scene.bounces = join_bounces_of(scene.receivers, scene.transfer, light);
    } catch (const std::invalid_argument& error) {
        throw std::runtime_error(fmt::format("{}: {}", first.string(), error.what()));
    }
    set_surfaces(scene.transfer, scene.receivers);
    return scene;
}

} // namespace relumine::prt
