#include <algorithm>
#include <cstring>

#include "prt/scene/section_group.h"

namespace relumine::prt {

namespace {

const std::string Order = "order", Tree = "quadtree";

/// Split flags have their number in front.
void add_clusters(NewSections& sections, const Scene& scene) {
    const std::vector<bool> flags = scene.transfer.quadtree.split_flags();
    std::vector<std::byte> bytes = bytes_of(std::vector{static_cast<std::uint32_t>(flags.size())});
    const std::vector<std::byte> bits = packed(flags);
    bytes.insert(bytes.end(), bits.begin(), bits.end());
    sections[Tree] = std::move(bytes);
    sections[Order] = SectionContent::view(scene.transfer.order);
}

Quadtree read_tree(const SectionReader& reader) {
    const std::vector<std::byte> bytes = reader.bytes(Tree);
    std::uint32_t num_flags = 0;
    if (bytes.size() < sizeof num_flags)
        reader.fail(Tree, "split flags");
    std::memcpy(&num_flags, bytes.data(), sizeof num_flags);
    try {
        return Quadtree(unpacked(std::span(bytes).subspan(sizeof num_flags), num_flags));
    } catch (const std::length_error&) {
        reader.fail(Tree, "split flags");
    } catch (const std::invalid_argument&) {
        reader.fail(Tree, "split flags of six trees");
    }
}

void read_clusters(const SectionReader& reader, Scene& scene) {
    Transfer& transfer = scene.transfer;
    const std::size_t num_receivers = scene.receivers.size();
    transfer.quadtree = read_tree(reader);
    transfer.num_points = scene.receivers.num_points();
    transfer.order = reader.elements<std::uint32_t>(Order, num_receivers);
    std::vector<bool> seen(num_receivers);
    for (const std::uint32_t receiver : transfer.order) {
        if (receiver >= num_receivers || seen[receiver])
            reader.fail(Order, "every receiver once");
        seen[receiver] = true;
        transfer.normals.push_back(scene.receivers.normals[receiver]);
    }
}

/// The tree is as deep as the settings say.
void check_clusters(const SceneCheck& check, const Scene& scene) {
    const std::uint32_t deepest = texel_level(scene.settings.face_resolution);
    const std::uint32_t first = std::min(scene.settings.min_level, deepest);
    for (const Cell& cell : scene.transfer.quadtree.leaves())
        if (cell.level < first || cell.level > deepest)
            check.fail(fmt::format("clusters of levels {} to {}", first, deepest),
                       fmt::format("one of level {}", cell.level));
}

} // namespace

const SectionGroup ClusterSections = {
    .add = add_clusters, .read = read_clusters, .check = check_clusters};

} // namespace relumine::prt
