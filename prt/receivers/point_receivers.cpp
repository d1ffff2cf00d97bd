#include "prt/receivers/point_receivers.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "files/parallel.h"
#include "prt/steps.h"

namespace relumine::prt {

namespace {

constexpr std::size_t NumPackets = 4;
constexpr std::size_t NumRays = NumPackets * PacketSize;

/// Directions spread evenly over the sphere: a spiral that turns by the golden angle.
std::array<DirectionPacket, NumPackets> spread_directions() {
    std::array<DirectionPacket, NumPackets> packets;
    const double golden = std::numbers::pi * (3.0 - std::sqrt(5.0));
    for (std::size_t i = 0; i < NumRays; ++i) {
        const double y = 1.0 - (2.0 * static_cast<double>(i) + 1.0) / NumRays;
        const double radius = std::sqrt(1.0 - y * y);
        const double angle = golden * static_cast<double>(i);
        DirectionPacket& packet = packets[i / PacketSize];
        packet.num_directions = PacketSize;
        packet.set(i % PacketSize, {radius * std::cos(angle), y, radius * std::sin(angle)});
    }
    return packets;
}

/// Finds the nearest of some points: a k-d tree, whose nodes are the middles of ranges.
class NearestPoints {
public:
    NearestPoints(std::span<const glm::vec3> points, std::vector<std::uint32_t> chosen)
        : points_(points), chosen_(std::move(chosen)) {
        sort(0, chosen_.size(), 0);
    }

    [[nodiscard]] std::uint32_t nearest(const glm::vec3& to) const {
        Best best;
        find(0, chosen_.size(), 0, to, best);
        return best.index;
    }

private:
    struct Best {
        std::uint32_t index = std::numeric_limits<std::uint32_t>::max();
        double distance2 = std::numeric_limits<double>::infinity();
    };

    void sort(std::size_t begin, std::size_t end, int axis) {
        if (end - begin < 2)
            return;
        const std::size_t middle = begin + (end - begin) / 2;
        const auto at = [this](std::size_t i) {
            return chosen_.begin() + static_cast<std::ptrdiff_t>(i);
        };
        std::nth_element(at(begin), at(middle), at(end), [&](std::uint32_t a, std::uint32_t b) {
            return points_[a][axis] < points_[b][axis] ||
                   (points_[a][axis] == points_[b][axis] && a < b);
        });
        sort(begin, middle, (axis + 1) % 3);
        sort(middle + 1, end, (axis + 1) % 3);
    }

    /// Finds the nearest point; of equally near ones the one with the lowest index.
    void find(std::size_t begin, std::size_t end, int axis, const glm::vec3& to, Best& best) const {
        if (begin == end)
            return;
        const std::size_t middle = begin + (end - begin) / 2;
        const std::uint32_t index = chosen_[middle];
        const glm::dvec3 away = glm::dvec3(points_[index]) - glm::dvec3(to);
        const double distance2 = glm::dot(away, away);
        if (distance2 < best.distance2 || (distance2 == best.distance2 && index < best.index))
            best = {index, distance2};
        const bool is_low = away[axis] > 0.0;
        const int next = (axis + 1) % 3;
        find(is_low ? begin : middle + 1, is_low ? middle : end, next, to, best);
        if (away[axis] * away[axis] <= best.distance2)
            find(is_low ? middle + 1 : begin, is_low ? end : middle, next, to, best);
    }

    std::span<const glm::vec3> points_;
    std::vector<std::uint32_t> chosen_;
};

void check(std::span<const glm::vec3> points) {
    if (points.empty() || points.size() > MaxPoints)
        throw std::invalid_argument(
            fmt::format("expected 1 to {} points, got {}", MaxPoints, points.size()));
    for (std::size_t i = 0; i < points.size(); ++i)
        for (int axis = 0; axis < 3; ++axis)
            if (!std::isfinite(points[i][axis]))
                throw std::invalid_argument(
                    fmt::format("expected points with finite coordinates, got ({}, {}, {}) as "
                                "point {}",
                                points[i].x, points[i].y, points[i].z, i));
}

} // namespace

std::vector<glm::vec3> grid_points(const GridLayout& grid) {
    std::vector<glm::vec3> points;
    points.reserve(std::size_t{grid.nx} * grid.ny * grid.nz);
    const glm::dvec3 low(grid.low), size = glm::dvec3(grid.high) - low;
    for (std::uint32_t z = 0; z < grid.nz; ++z)
        for (std::uint32_t y = 0; y < grid.ny; ++y)
            for (std::uint32_t x = 0; x < grid.nx; ++x)
                points.emplace_back(low + size * glm::dvec3((x + 0.5) / grid.nx,
                                                            (y + 0.5) / grid.ny,
                                                            (z + 0.5) / grid.nz));
    return points;
}

Receivers point_receivers(std::span<const glm::vec3> points, const mesh::TriangleMesh& mesh,
                          const RayScene& rays, const Work& work) {
    check(points);
    Receivers receivers;
    receivers.have_no_surface = true;
    receivers.positions.assign(points.begin(), points.end());
    receivers.normals.resize(points.size(), glm::vec3(0.0f));
    Progress progress(work);
    std::vector<std::uint8_t> is_inside(points.size());
    files::parallel_for(std::size_t{0}, points.size(), [&](std::size_t i) {
        progress.poll();
        is_inside[i] = part_of_backs(points[i], mesh, rays) > 0.5 ? 1 : 0;
    });
    std::vector<std::uint32_t> outside;
    for (std::uint32_t i = 0; i < points.size(); ++i)
        if (is_inside[i] == 0)
            outside.push_back(i);
    if (outside.empty() || outside.size() == points.size())
        return receivers;
    receivers.own_positions = receivers.positions;
    const NearestPoints nearest(points, std::move(outside));
    for (std::size_t i = 0; i < points.size(); ++i)
        if (is_inside[i] != 0)
            receivers.positions[i] = points[nearest.nearest(points[i])];
    return receivers;
}

double part_of_backs(const glm::vec3& point, const mesh::TriangleMesh& mesh, const RayScene& rays) {
    static const std::array<DirectionPacket, NumPackets> Packets = spread_directions();
    constexpr std::uint32_t All = (1u << PacketSize) - 1;
    std::size_t num_backs = 0;
    for (const DirectionPacket& packet : Packets) {
        std::array<Hit, PacketSize> hits;
        for (std::uint32_t hit = rays.closest_hits(point, packet, All, hits); hit != 0;
             hit &= hit - 1) {
            const auto i = static_cast<std::uint32_t>(std::countr_zero(hit));
            num_backs +=
                meets_front(mesh, {hits[i].triangle, hits[i].barycentric}, packet.direction(i)) ? 0
                                                                                                : 1;
        }
    }
    return static_cast<double>(num_backs) / NumRays;
}

std::size_t num_inside(const Receivers& receivers) {
    std::size_t count = 0;
    for (std::size_t i = 0; i < receivers.size(); ++i)
        count += receivers.is_inside(i) ? 1 : 0;
    return count;
}

} // namespace relumine::prt
