#include "relight/surfaces/ray_fan.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>
#include <vector>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/vector_relational.hpp>
#include <gtest/gtest.h>

#include "cubemap/frame.h"
#include "relight/surfaces/visible_normals.h"
#include "tests/prt/every_target.h"

namespace relumine::relight {
namespace {

struct PlainRay {
    glm::vec3 direction;
    float density;
    bool is_above;
};

/// Point i of n of Hammersley's, shifted around its column and around the square's height.
glm::vec2 hammersley(std::uint32_t i, std::uint32_t n, const glm::vec2& shift) {
    std::uint32_t bits = i;
    float inverse = 0.0f;
    for (float digit = 0.5f; bits != 0; bits >>= 1, digit *= 0.5f)
        inverse += (bits & 1u) != 0 ? digit : 0.0f;
    const auto columns = static_cast<float>(fan_columns(n));
    const float x = (static_cast<float>(i) + 0.5f) / static_cast<float>(n) * columns;
    return {(std::floor(x) + glm::fract(x + shift.x)) / columns, glm::fract(inverse + shift.y)};
}

/// Ray i, as the papers write it.
PlainRay plain_ray(const RayFan& fan, std::uint32_t i) {
    const glm::mat3 frame = cubemap::frame_of(fan.normal);
    const glm::vec2 u = hammersley(i, fan.num_rays, fan.shift);
    const float turn = 2.0f * std::numbers::pi_v<float>;
    if (fan.alpha == 0.0f) {
        const float across = std::sqrt(std::max(1.0f - u.x * u.x, 0.0f));
        const glm::vec3 local(across * std::cos(turn * u.y), across * std::sin(turn * u.y), u.x);
        return {frame * local, 1.0f / turn, local.z > 0.0f};
    }
    const glm::vec3 to_eye = fan.to_eye * frame;
    const glm::vec3 half = visible_half(to_eye, fan.alpha, u);
    const glm::vec3 local = 2.0f * glm::dot(to_eye, half) * half - to_eye;
    return {glm::normalize(frame * local), mirrored_density(half, to_eye.z, fan.alpha),
            local.z > 0.0f};
}

/// Returns how many rays are below the surface.
std::uint32_t expect_plain_rays(const RayFan& fan) {
    // Of directions: the root of what is nearly 0 keeps half of the digits. Of densities as a part
    // of them, which grow with 1 / alpha^2 where the half vector turns.
    constexpr float OfDirections = 2e-4f;
    const float of_densities = 1e-5f / std::max(fan.alpha * fan.alpha, 1e-3f);
    std::uint32_t num_below = 0;
    for (std::uint32_t first = 0; first < fan.num_rays; first += prt::PacketSize) {
        const FanRays rays = fan_rays(fan, FanFrame(fan), first);
        const std::uint32_t count = std::min<std::uint32_t>(fan.num_rays - first, prt::PacketSize);
        EXPECT_EQ(rays.directions.num_directions, count);
        EXPECT_EQ(rays.above >> count, 0u);
        for (std::uint32_t lane = 0; lane < prt::PacketSize; ++lane) {
            const PlainRay expected = plain_ray(fan, first + std::min(lane, count - 1));
            EXPECT_LT(glm::distance(rays.directions.direction(lane), expected.direction),
                      OfDirections);
            EXPECT_NEAR(rays.densities[lane], expected.density, of_densities * expected.density);
            if (lane >= count)
                continue;
            const float height = glm::dot(expected.direction, fan.normal);
            if (std::abs(height) > 1e-6f) {
                EXPECT_EQ((rays.above >> lane & 1u) != 0, expected.is_above) << height;
            }
            num_below += expected.is_above ? 0 : 1;
        }
    }
    return num_below;
}

TEST(RayFan, IsThePlainOneOnEveryTarget) {
    scenes::on_every_target([] {
        const glm::vec3 normal = glm::normalize(glm::vec3(0.3f, -0.8f, 0.5f));
        const glm::vec3 across = glm::normalize(glm::cross(normal, glm::vec3(0.0f, 0.0f, 1.0f)));
        std::uint32_t num_below = 0;
        for (const float alpha : {0.0f, 1e-3f, 0.04f, 0.25f, 0.5f, 1.0f})
            for (const float cosine : {1.0f, 0.7f, 0.1f, 0.01f})
                for (const std::uint32_t num_rays : {1u, 5u, 16u, 33u, 128u})
                    num_below += expect_plain_rays(
                        {.normal = normal,
                         .to_eye = cosine * normal + std::sqrt(1.0f - cosine * cosine) * across,
                         .alpha = alpha,
                         .num_rays = num_rays,
                         .shift = {0.3f, 0.9f}});
        EXPECT_GT(num_below, 100u) << "of a few thousand";
    });
}

/// Where a ray that is as dense everywhere lies in the square, less the shift of its height.
glm::vec2 place_of(const glm::vec3& direction, const RayFan& fan) {
    const glm::vec3 local = direction * cubemap::frame_of(fan.normal);
    const float turn = std::atan2(local.y, local.x) / (2.0f * std::numbers::pi_v<float>);
    return {local.z, glm::fract(turn - fan.shift.y)};
}

/// The looks of all rays are a grid over the lobe, and each ray is where its looks are.
TEST(RayFan, PartsAreTheWholeLobe) {
    for (const std::uint32_t num_rays : {2u, 16u, 32u, 128u}) {
        const RayFan fan{.normal = {0.0f, 0.0f, 1.0f},
                         .to_eye = {0.0f, 0.0f, 1.0f},
                         .alpha = 0.0f,
                         .num_rays = num_rays,
                         .shift = {0.3f, 0.85f}};
        const FanFrame frame(fan);
        const std::uint32_t columns = 4 * fan_columns(num_rays);
        const std::uint32_t rows = 16 * num_rays / columns;
        const glm::vec2 size(columns, rows);
        std::vector<int> seen(std::size_t{columns} * rows, 0);
        for (std::uint32_t ray = 0; ray < num_rays; ++ray) {
            const FanRays looks = fan_part(fan, frame, ray);
            ASSERT_EQ(looks.above, 0xffffu);
            glm::vec2 least(1.0f), most(0.0f);
            for (std::size_t lane = 0; lane < prt::PacketSize; ++lane) {
                const glm::vec2 place = place_of(looks.directions.direction(lane), fan);
                least = glm::min(least, place);
                most = glm::max(most, place);
                const auto column = static_cast<std::uint32_t>(place.x * size.x);
                const auto row = static_cast<std::uint32_t>(place.y * size.y);
                ++seen[std::size_t{row} * columns + column];
            }
            const FanRays own = fan_rays(fan, frame, ray & ~15u);
            const glm::vec2 place = place_of(own.directions.direction(ray & 15u), fan);
            const glm::vec2 step = 0.51f / size;
            EXPECT_TRUE(glm::all(glm::greaterThan(place, least - step)) &&
                        glm::all(glm::lessThan(place, most + step)))
                << num_rays << " " << ray;
        }
        EXPECT_TRUE(std::all_of(seen.begin(), seen.end(), [](int n) { return n == 1; }))
            << num_rays;
    }
}

} // namespace
} // namespace relumine::relight
