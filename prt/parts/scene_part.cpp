#include "prt/parts/scene_part.h"

#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "prt/clusters/dealt_tiles.h"
#include "prt/glossy/glossy_precompute.h"
#include "prt/parts/part_list.h"
#include "prt/scene/bounce_sections.h"
#include "prt/scene/count_sections.h"
#include "prt/scene/glossy_sections.h"
#include "prt/scene/json_members.h"
#include "prt/scene/scene_check.h"
#include "prt/scene/section_file.h"
#include "prt/scene/section_group.h"
#include "prt/scene/section_reader.h"

namespace relumine::prt {

namespace {

/// A part as its file has it.
struct StoredLight {
    PartHead head;
    std::vector<std::uint32_t> receivers;
    std::vector<glm::vec3> radiance;
};

StoredLight read_lit_part(const std::filesystem::path& path) {
    const SectionReader reader(path);
    if (!reader.has("lit"))
        throw std::runtime_error(fmt::format(
            "{}: expected a part that `relumine relight --part` wrote, got another file",
            path.string()));
    StoredLight stored{.head = read_head(reader, "lit", "light"), .receivers = {}, .radiance = {}};
    stored.receivers = reader.elements<std::uint32_t>("lit_receivers");
    stored.radiance = reader.elements<glm::vec3>("lit_radiance", stored.receivers.size());
    return stored;
}

} // namespace

ScenePart load_scene_part(const std::filesystem::path& path, const Part& part) {
    if (part.index >= part.count || part.count > MaxParts)
        throw std::invalid_argument(
            fmt::format("{}: expected a part of 1 to {}", path.string(), MaxParts));
    const SectionReader reader(path);
    if (reader.has("plan") || reader.has("part") || reader.has("lit"))
        throw std::runtime_error(
            fmt::format("{}: expected a scene, got a plan or a part", path.string()));
    ScenePart result{.scene = plan_of(reader)}; // bounces and counts come later
    const Scene& whole = result.scene;
    const std::size_t num_receivers = whole.receivers.size();
    if (has_bounces(reader)) {
        BounceRows rows = read_bounce_rows(reader, whole.receivers, part);
        check_emitters(SceneCheck(path), whole, rows.matrix);
        result.scene.bounces = std::move(rows.matrix);
        result.bounces = {.first = rows.first, .num_emitters = std::move(rows.num_emitters)};
    }
    Transfer& transfer = result.transfer;
    transfer.quadtree = whole.transfer.quadtree;
    transfer.num_points = places_of(part, whole.transfer.num_points).size();
    for (const std::uint32_t place : places_of(part, num_receivers)) {
        const std::uint32_t receiver = whole.transfer.order[place];
        result.receivers.push_back(receiver);
        result.positions.push_back(whole.receivers.positions[receiver]);
        transfer.order.push_back(static_cast<std::uint32_t>(transfer.order.size()));
        transfer.normals.push_back(whole.transfer.normals[place]);
        if (!whole.receivers.surfaces.empty())
            transfer.surfaces.push_back(whole.receivers.surfaces[receiver]);
    }
    const VisibleCounts shape{.num_receivers = num_receivers,
                              .num_leaves = transfer.quadtree.num_leaves()};
    std::vector<std::size_t> tiles;
    for (std::size_t tile = part.index; tile < shape.num_tiles(); tile += part.count)
        tiles.push_back(tile);
    transfer.counts = read_counts_of_tiles(reader, shape, tiles, result.receivers.size());
    if (whole.settings.glossy_tolerance) {
        std::vector<BlockRange> blocks;
        blocks.reserve(tiles.size());
        for (const std::size_t tile : tiles)
            blocks.push_back({shape.tile_begin(tile), shape.tile_begin(tile + 1)});
        transfer.glossy = read_glossy_part(reader, shape.num_blocks(), blocks);
        check_highlights(SceneCheck(path), *transfer.glossy);
        for (const std::uint32_t receiver : result.receivers)
            transfer.glossy->to_eye.push_back(whole.receivers.to_eye[receiver]);
    } else if (has_highlights(whole.receivers)) { // as set_surfaces() does
        for (LobeCuts& lobe : transfer.glossy.emplace().lobes)
            lobe.begin.assign(transfer.counts.num_blocks() + 1, 0);
        for (const std::uint32_t receiver : result.receivers)
            transfer.glossy->to_eye.push_back(whole.receivers.to_eye[receiver]);
    }
    return result;
}

std::uint64_t save_lit_part(const std::filesystem::path& path, const LitPart& part) {
    NewSections sections;
    sections["lit"] =
        bytes_of(json_of({part.part, part.light, part.num_receivers}, "light").text(2));
    sections["lit_receivers"] = SectionContent::view(part.receivers);
    sections["lit_radiance"] = SectionContent::view(part.radiance);
    // A scene's reader says what it is.
    sections["plan"] = bytes_of("{}");
    sections["part"] = sections["lit"];
    return write_sections(path, sections);
}

std::vector<glm::vec3> join_lit_parts(std::span<const std::filesystem::path> paths) {
    const auto parts = all_parts_of("light", paths, read_lit_part);
    const std::size_t num_receivers = parts.front()->head.num_receivers;
    std::vector<glm::vec3> radiance(num_receivers);
    std::vector<bool> is_known(num_receivers);
    std::size_t num_known = 0;
    for (const auto& part : parts)
        for (std::size_t i = 0; i < part->receivers.size(); ++i) {
            const std::uint32_t receiver = part->receivers[i];
            if (receiver >= num_receivers || is_known[receiver])
                throw std::runtime_error(
                    fmt::format("{}: expected each receiver once", paths[0].string()));
            is_known[receiver] = true;
            ++num_known;
            radiance[receiver] = part->radiance[i];
        }
    if (num_known != num_receivers)
        throw std::runtime_error(fmt::format("{}: expected parts with all {} receivers, got {}",
                                             paths[0].string(), num_receivers, num_known));
    return radiance;
}

} // namespace relumine::prt
