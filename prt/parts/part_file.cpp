#include "prt/parts/part_file.h"

#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "files/json.h"
#include "prt/scene/scene_sections.h"
#include "prt/scene/section_file.h"
#include "prt/scene/section_reader.h"

namespace relumine::prt {

namespace {

std::vector<std::byte> text_section(const files::Json& json) {
    const std::string text = json.text(2);
    return bytes_of(std::vector<char>(text.begin(), text.end()));
}

/// A part as its file has it.
struct StoredPart {
    SectionReader reader;
    Part part = {};
    std::string plan = {};
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
        stored.plan = json.at("plan").string();
        stored.num_receivers = natural(json.at("receivers"));
        if (stored.part.index >= stored.part.count || stored.part.count > MaxParts)
            throw std::out_of_range("expected an index below the count");
    } catch (const std::exception&) {
        stored.reader.fail("part", "JSON with the place of the part");
    }
    return stored;
}

VisibleCounts counts_of(const StoredPart& stored, std::size_t num_leaves) {
    const SectionReader& reader = stored.reader;
    VisibleCounts counts{.num_receivers = stored.num_receivers, .num_leaves = num_leaves};
    counts.visible = reader.elements<std::uint64_t>("visible");
    counts.mixed = reader.elements<std::uint64_t>("mixed");
    counts.counts = reader.elements<std::uint8_t>("counts");
    try {
        counts.index();
    } catch (const std::invalid_argument&) {
        reader.fail("counts", "counts that fit the receivers and the tree");
    }
    return counts;
}

} // namespace

std::uint64_t save_plan(const std::filesystem::path& path, const Scene& scene) {
    if (scene.transfer.glossy || scene.bounces)
        throw std::invalid_argument(
            fmt::format("{}: expected a scene without highlights and bounces", path.string()));
    Sections sections = sections_without_light(path, scene);
    sections["plan"] = text_section({{"clusters", scene.transfer.num_clusters()}});
    return write_sections(path, sections);
}

Plan load_plan(const std::filesystem::path& path) {
    Sections sections = read_sections(path);
    if (!sections.contains("plan") || sections.contains("part"))
        throw std::runtime_error(
            fmt::format("{}: expected a plan, got {}", path.string(),
                        sections.contains("part") ? "a part of a scene" : "a scene"));
    return {.scene = plan_of(path, std::move(sections)), .hash = file_hash(path)};
}

std::uint64_t save_part(const std::filesystem::path& path, const Plan& plan, const Part& part,
                        const VisibleCounts& counts) {
    Sections sections;
    if (part.index == 0)
        sections = sections_without_light(path, plan.scene);
    sections["part"] = text_section({{"index", part.index},
                                     {"count", part.count},
                                     {"plan", fmt::format("{:016x}", plan.hash)},
                                     {"receivers", counts.num_receivers}});
    // A scene's reader says what it is.
    sections["plan"] = text_section(files::Json::object());
    add_counts(sections, counts);
    return write_sections(path, sections);
}

Scene join_parts(std::span<const std::filesystem::path> paths) {
    std::vector<std::optional<StoredPart>> parts;
    std::string plan;
    const auto refuse = [](const std::filesystem::path& path, const std::string& expected,
                           const std::string& got) {
        throw std::runtime_error(
            fmt::format("{}: expected {}, got {}", path.string(), expected, got));
    };
    for (const std::filesystem::path& path : paths) {
        StoredPart stored = read_part(path);
        const Part& part = stored.part;
        if (parts.empty()) {
            parts.resize(part.count);
            plan = stored.plan;
        }
        if (stored.plan != plan)
            refuse(path, fmt::format("a part of the same plan as {}", paths[0].string()),
                   "another plan's");
        if (part.count != parts.size())
            refuse(path, fmt::format("one of {} parts as {}", parts.size(), paths[0].string()),
                   fmt::format("one of {}", part.count));
        if (const auto& other = parts[part.index])
            refuse(path, "every part once",
                   fmt::format("part {} of {} again, after {}", part.index + 1, part.count,
                               other->reader.path().string()));
        parts[part.index] = std::move(stored);
    }
    for (std::size_t i = 0; i < parts.size(); ++i)
        if (!parts[i])
            throw std::runtime_error(fmt::format("expected all {0} parts, got none that is part "
                                                 "{1} of {0}",
                                                 parts.size(), i + 1));
    if (parts.empty())
        throw std::runtime_error("expected parts, got none");
    const std::filesystem::path first = parts.front()->reader.path();
    Scene scene = plan_of(first, read_sections(first));
    std::vector<VisibleCounts> counts;
    for (std::optional<StoredPart>& part : parts) {
        counts.push_back(counts_of(*part, scene.transfer.num_clusters()));
        part.reset();
    }
    try {
        scene.transfer.counts = joined_counts(scene.transfer, counts);
    } catch (const std::invalid_argument& error) {
        throw std::runtime_error(fmt::format("{}: {}", first.string(), error.what()));
    }
    set_surfaces(scene.transfer, scene.receivers);
    return scene;
}

} // namespace relumine::prt
