// The receivers of a scene, all of them or a part, and the processes that have the others.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "cubemap/cube_map.h"
#include "prt/parts/scene_part.h"
#include "prt/team.h"
#include "relight/bounces/bounce_light.h"
#include "relumine/in/scene.h"

namespace relumine {

/// What one process has of a scene's receivers. Without a team it has no others.
class SharedReceivers {
public:
    /// The scene and the team must outlive this object. `part` is null where this process has all
    /// receivers; its own scene is not looked at. `path` is the scene's, for messages.
    SharedReceivers(const Scene& scene, std::unique_ptr<prt::ScenePart> part, prt::Team* team,
                    std::filesystem::path path);

    [[nodiscard]] bool are_in_others() const { return team_->has_others(); }
    /// Whether this process gets what all have.
    [[nodiscard]] bool is_first() const { return team_->is_first(); }
    [[nodiscard]] const prt::Transfer& transfer() const {
        return part_ ? part_->transfer : scene_->transfer;
    }
    [[nodiscard]] std::span<const glm::vec3> positions() const {
        return part_ ? part_->positions : scene_->receivers.positions;
    }
    /// The rows of bounces that this process has.
    [[nodiscard]] relight::SharedRows rows() const;
    /// Returns the indices of `count` receivers, this process's.
    [[nodiscard]] std::vector<std::uint32_t> indices(std::size_t count) const;
    /// Returns the places of this process's receivers in the order of all.
    [[nodiscard]] std::vector<std::uint32_t> places() const;

    /// Returns values of all receivers in every process, from those of each one's own.
    [[nodiscard]] std::vector<glm::vec3> of_all(std::span<const glm::vec3> own) const;
    /// Adds values of all receivers, or none, to those of this process's.
    void add_of_all(std::span<const glm::vec3> of_all, std::span<glm::vec3> own) const;
    /// Gives the first process the values of all receivers; the others get none.
    ///
    /// Shape:   `own` is [receivers of this process][width].
    [[nodiscard]] std::vector<glm::vec3> gathered(std::span<const glm::vec3> own,
                                                  std::size_t width = 1) const;

    /// Throws where the first process has other bytes.
    ///
    /// Throws:  std::runtime_error "path: expected X, got Y".
    void require_same(std::span<const std::byte> bytes) const;

private:
    const Scene* scene_;
    std::unique_ptr<prt::ScenePart> part_;
    /// Never null
    prt::Team* team_;
    std::filesystem::path path_;
};

/// Throws where processes light another scene, or by another environment, than the first. Without
/// an environment it looks at the scene alone. `path` is the scene's.
///
/// Throws:  std::runtime_error "path: expected X, got Y".
void require_same(prt::Team& team, const std::filesystem::path& path,
                  const cubemap::CubeMap* environment = nullptr);

} // namespace relumine
