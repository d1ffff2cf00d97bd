// A geometry and receivers of one's own, without a mesh: points on the ground under a floating
// ball. Light from an even sky is compared with the closed form. own_blockers
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <exception>

#include <glm/geometric.hpp>

#include "relumine/files/parallel.h"
#include "relumine/prt/precompute.h"
#include "relumine/relight/relighter.h"

namespace {

using namespace relumine;

/// Any ray tracer fits in here. A precompute asks for 16 directions of one point at a time, from
/// many threads.
class Ball final : public prt::Blockers {
public:
    Ball(const glm::vec3& centre, float radius) : centre_(centre), radius_(radius) {}

    [[nodiscard]] std::uint32_t occluded(const glm::vec3& origin,
                                         const prt::DirectionPacket& directions,
                                         std::uint32_t active) const override {
        const glm::vec3 to_centre = centre_ - origin;
        std::uint32_t blocked = 0;
        for (std::uint32_t lane = 0; lane < prt::PacketSize; ++lane) {
            const glm::vec3 direction = directions.direction(lane);
            const float along = glm::dot(to_centre, direction);
            if (along > 0.0f && glm::distance(to_centre, along * direction) < radius_)
                blocked |= 1u << lane;
        }
        return blocked & active;
    }

private:
    glm::vec3 centre_;
    float radius_;
};

} // namespace

int main() try {
    // Two of the machine's cores are enough; the limit counts while it lives.
    const files::ThreadLimit two(2);

    const glm::vec3 centre(0.0f, 2.0f, 0.0f);
    const float radius = 0.75f;
    prt::Receivers receivers;
    for (int z = -8; z <= 8; ++z)
        for (int x = -8; x <= 8; ++x) {
            receivers.positions.emplace_back(0.25f * static_cast<float>(x), 0.0f,
                                             0.25f * static_cast<float>(z));
            receivers.normals.emplace_back(0.0f, 1.0f, 0.0f);
        }
    const prt::Transfer transfer =
        prt::precompute(receivers, Ball(centre, radius), {.tolerance = 0.02f});

    relight::Relighter relighter(transfer);
    relighter.set_environment(cubemap::CubeMap(32, glm::vec3(1.0f)));

    // A ball above the horizon takes (radius / distance)^2 cos(angle) of an even sky.
    double error = 0.0;
    for (std::size_t i = 0; i < receivers.size(); ++i) {
        const glm::vec3 to_centre = centre - receivers.positions[i];
        const float distance = glm::length(to_centre);
        const float share = radius / distance;
        const float expected = 1.0f - share * share * to_centre.y / distance;
        error =
            std::max(error, static_cast<double>(std::abs(relighter.radiance()[i].g - expected)));
    }
    std::printf("%zu points, %zu clusters, largest error %.4f\n", receivers.size(),
                transfer.num_clusters(), error);
    return error < 0.01 ? 0 : 1;
} catch (const std::exception& error) {
    std::fprintf(stderr, "own_blockers: %s\n", error.what());
    return 1;
}
