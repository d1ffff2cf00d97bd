#include "relight/bright_clusters.h"

#include <algorithm>
#include <numbers>
#include <utility>

#include <glm/geometric.hpp>

#include "cubemap/luminance.h"
#include "files/parallel.h"

namespace relumine::relight {

namespace {

constexpr std::size_t MostClusters = 64;
/// Pictures have some nine samples a pixel, each of which sees other places of a cell: the edge of
/// a shadow has 288 shades.
constexpr std::size_t MostCells = 32;

/// Of the light of a surface in the open: what one cluster has, and all of them.
constexpr double LeastOfCluster = 1.0 / 200.0, LeastOfAll = 1.0 / 20.0;

/// Cells of this level are 0.7 degrees wide.
constexpr std::uint32_t FinestLevel = 7;

double strength(const VectorIrradiance& light, const glm::vec3& normal) {
    return cubemap::luminance(light.on(normal)) / std::numbers::pi;
}

/// Whether a cell lies in another one, or is the same.
bool is_in(const prt::Cell& cell, const prt::Cell& other) {
    return cell.level >= other.level && cell.above(other.level) == other;
}

class Cutting {
public:
    explicit Cutting(const Relighter& relighter) : relighter_(relighter) {}

    void add(std::uint32_t cluster) {
        const prt::Cell& cell = relighter_.transfer().quadtree.leaves()[cluster];
        append({.cluster = cluster, .cell = cell, .irradiance = {}},
               relighter_.cluster_light(cluster), pieces_);
    }

    /// Quarters the piece whose power times width is largest, until there are enough.
    std::vector<SharpLight> cut() {
        while (pieces_.size() + 3 <= MostCells) {
            const auto worst =
                std::max_element(pieces_.begin(), pieces_.end(),
                                 [](const Piece& a, const Piece& b) { return a.harm < b.harm; });
            if (worst == pieces_.end() || worst->harm == 0.0)
                break;
            std::vector<Piece> quarters;
            for (std::uint32_t i = 0; i < 4; ++i) {
                const SharpLight part{.cluster = worst->light.cluster,
                                      .cell = worst->light.cell.child(i),
                                      .irradiance = {}};
                append(part, without_sharp(part), quarters);
            }
            pieces_.insert(pieces_.erase(worst), quarters.begin(), quarters.end());
        }
        std::vector<SharpLight> result;
        for (const Piece& piece : pieces_)
            result.push_back(piece.light);
        return result;
    }

private:
    struct Piece {
        SharpLight light;
        double harm = 0.0;
    };

    [[nodiscard]] VectorIrradiance without_sharp(const SharpLight& part) const {
        VectorIrradiance sum = relighter_.binning()->sum(relighter_.environment(), part.cell);
        for (const SharpLight& light : relighter_.sharp_lights()) {
            if (light.cluster != part.cluster)
                continue;
            if (is_in(light.cell, part.cell))
                sum -= light.irradiance;
            else if (is_in(part.cell, light.cell))
                return {};
        }
        return sum;
    }

    static void append(SharpLight light, const VectorIrradiance& irradiance,
                       std::vector<Piece>& pieces) {
        const glm::dvec3 luminance = irradiance.luminance();
        const double power = glm::length(luminance);
        if (!(power > 0.0))
            return;
        light.direction = luminance / power;
        light.irradiance = irradiance;
        const double harm = light.cell.level < FinestLevel ? power * light.cell.size() : 0.0;
        pieces.push_back({std::move(light), harm});
    }

    const Relighter& relighter_;
    std::vector<Piece> pieces_;
};

} // namespace

BrightClusters bright_clusters(const Relighter& relighter, const glm::vec3& normal) {
    BrightClusters result;
    if (relighter.binning() == nullptr || relighter.environment().resolution == 0)
        return result;
    const double all = cubemap::luminance(relighter.open_radiance(normal));
    std::vector<std::pair<double, std::uint32_t>> found;
    for (std::uint32_t i = 0; i < relighter.transfer().num_clusters(); ++i)
        if (const double own = strength(relighter.cluster_light(i), normal);
            own > 0.0 && own >= LeastOfCluster * all)
            found.emplace_back(-own, i);
    std::sort(found.begin(), found.end());
    found.resize(std::min(found.size(), MostClusters));
    double sum = 0.0;
    for (const auto& [less, cluster] : found) {
        sum -= less;
        result.clusters.push_back(cluster);
    }
    if (sum < LeastOfAll * all)
        return {};
    std::sort(result.clusters.begin(), result.clusters.end());
    Cutting cutting(relighter);
    for (const std::uint32_t cluster : result.clusters)
        cutting.add(cluster);
    result.lights = cutting.cut();
    return result;
}

std::vector<glm::vec3> radiance_from(std::span<const std::uint32_t> clusters,
                                     const Relighter& relighter, std::size_t first) {
    const prt::Transfer& transfer = relighter.transfer();
    std::vector<VectorIrradiance> lights;
    for (const std::uint32_t cluster : clusters)
        lights.push_back(relighter.cluster_light(cluster));
    std::vector<glm::vec3> result(transfer.num_receivers() - first);
    files::parallel_for(std::size_t{0}, transfer.num_receivers(), [&](std::size_t place) {
        const std::size_t receiver = transfer.order[place];
        if (receiver < first)
            return;
        glm::dvec3 sum(0.0);
        for (std::size_t i = 0; i < clusters.size(); ++i)
            if (const int count = transfer.counts.count(place, clusters[i]); count != 0)
                sum += count / 16.0 * lights[i].on(transfer.normals[place]);
        result[receiver - first] = sum / std::numbers::pi;
    });
    return result;
}

} // namespace relumine::relight
