#include "relumine/light/shared_receivers.h"

#include <cstring>
#include <numeric>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "files/hash.h"
#include "prt/clusters/dealt_tiles.h"

namespace relumine {

namespace {

void require_same_hash(prt::Team& team, const std::filesystem::path& path, std::uint64_t own) {
    const std::vector<std::byte> bytes = prt::to_send(std::span(&own, 1));
    if (team.broadcast(bytes) != bytes)
        throw std::runtime_error(
            fmt::format("{}: expected the scene and the light of the first process, got others",
                        path.string()));
}

} // namespace

SharedReceivers::SharedReceivers(const Scene& scene, std::unique_ptr<prt::ScenePart> part,
                                 prt::Team* team, std::filesystem::path path)
    : scene_(&scene), part_(std::move(part)),
      team_(part_ && team != nullptr ? team : &prt::alone()), path_(std::move(path)) {
    if (!part_)
        return;
    relumine::require_same(*team_, path_);
    // The scene's surfaces may have got other colours.
    part_->transfer.surfaces.clear();
    if (!scene.receivers.surfaces.empty())
        for (const std::uint32_t receiver : part_->receivers)
            part_->transfer.surfaces.push_back(scene.receivers.surfaces[receiver]);
}

relight::SharedRows SharedReceivers::rows() const {
    if (!part_ || !part_->bounces)
        return {};
    return {.team = team_,
            .first = part_->bounces->first,
            .num_emitters = part_->bounces->num_emitters};
}

std::vector<std::uint32_t> SharedReceivers::indices(std::size_t count) const {
    if (part_)
        return part_->receivers;
    std::vector<std::uint32_t> all(count);
    std::iota(all.begin(), all.end(), 0u);
    return all;
}

std::vector<std::uint32_t> SharedReceivers::places() const {
    return prt::places_of(team_->part(), scene_->transfer.num_receivers());
}

std::vector<glm::vec3> SharedReceivers::of_all(std::span<const glm::vec3> own) const {
    if (!are_in_others())
        return {own.begin(), own.end()};
    const std::vector<std::uint32_t>& order = scene_->transfer.order;
    const std::vector<std::uint32_t> own_places = places();
    std::vector<glm::vec3> by_place(order.size());
    for (std::size_t i = 0; i < own_places.size(); ++i)
        by_place[own_places[i]] = own[i];
    prt::share_by_place(*team_, std::span(by_place));
    std::vector<glm::vec3> result(order.size());
    for (std::size_t place = 0; place < order.size(); ++place)
        result[order[place]] = by_place[place];
    return result;
}

void SharedReceivers::add_of_all(std::span<const glm::vec3> of_all,
                                 std::span<glm::vec3> own) const {
    for (std::size_t i = 0; !of_all.empty() && i < own.size(); ++i)
        own[i] += of_all[part_ ? part_->receivers[i] : i];
}

std::vector<glm::vec3> SharedReceivers::gathered(std::span<const glm::vec3> own,
                                                 std::size_t width) const {
    const std::vector<std::uint32_t>& order = scene_->transfer.order;
    const std::vector<std::vector<std::byte>> of_all = team_->gather(prt::to_send(own));
    const std::size_t bytes = width * sizeof(glm::vec3);
    std::vector<glm::vec3> values(of_all.empty() ? 0 : order.size() * width);
    for (std::uint32_t process = 0; process < of_all.size(); ++process) {
        const std::vector<std::uint32_t> places =
            prt::places_of({process, team_->part().count}, order.size());
        if (of_all[process].size() != places.size() * bytes)
            throw std::runtime_error("expected the light of all receivers");
        for (std::size_t i = 0; i < places.size(); ++i)
            std::memcpy(&values[order[places[i]] * width], of_all[process].data() + i * bytes,
                        bytes);
    }
    return values;
}

void SharedReceivers::require_same(std::span<const std::byte> bytes) const {
    if (are_in_others())
        require_same_hash(*team_, path_, files::hash_of(bytes));
}

void require_same(prt::Team& team, const std::filesystem::path& path,
                  const cubemap::CubeMap* environment) {
    if (team.has_others())
        require_same_hash(team, path,
                          environment == nullptr
                              ? files::file_hash(path)
                              : files::hash_of(std::as_bytes(std::span(environment->texels))));
}

} // namespace relumine
