#include "relight/pictures/gathered_light.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <mutex>
#include <numbers>
#include <span>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>

#include "cubemap/face.h"
#include "cubemap/frame.h"
#include "cubemap/luminance.h"
#include "cubemap/r2_sequence.h"
#include "cubemap/split_mix64.h"
#include "files/parallel.h"
#include "prt/receivers/lit_position.h"

namespace relumine::relight {

namespace {

/// Records along the side of a square.
constexpr std::uint32_t SquareSize = 16;
/// Rays of a record: those that look where light is, and those whose light counts. What is found
/// must not choose its own weight, or it is too dark.
constexpr std::uint32_t NumLooks = 16, NumCosine = 48, NumGuided = 80;
static_assert(NumLooks % prt::PacketSize == 0 && NumCosine % prt::PacketSize == 0 &&
              NumGuided % prt::PacketSize == 0);
/// In steps between records. The least leaves some four of them around each point.
constexpr float LeastReach = 1.6f, MostReach = 8.0f;
/// Ward's error up to which a record holds: the way over the harmonic mean distance of surfaces.
constexpr float MostError = 0.2f;

/// The cells of the cube that guide rays.
constexpr std::uint32_t Cells = 16, NumCells = 6 * Cells * Cells;

std::uint32_t cell_of(const glm::vec3& direction) {
    const cubemap::FacePoint point = cubemap::face_point(glm::dvec3(direction));
    const auto index = [](double along) {
        return std::min(static_cast<std::uint32_t>(along * Cells), Cells - 1);
    };
    return (static_cast<std::uint32_t>(point.face) * Cells + index(point.t)) * Cells +
           index(point.s);
}

glm::vec3 direction_in(std::uint32_t cell, const glm::dvec2& place) {
    const auto face = static_cast<cubemap::Face>(cell / (Cells * Cells));
    return glm::vec3(glm::normalize(cubemap::cube_point(face, (cell % Cells + place.x) / Cells,
                                                        (cell / Cells % Cells + place.y) / Cells)));
}

/// Returns the solid angle of a small piece of the cube [-1, 1]^3 around a direction, over its
/// area.
float stretch(const glm::vec3& direction) {
    const glm::vec3 size = glm::abs(direction);
    const float outwards = std::max({size.x, size.y, size.z});
    return outwards * outwards * outwards;
}

/// The middles of all cells
const std::array<glm::vec3, NumCells>& middles() {
    static const std::array<glm::vec3, NumCells> all = [] {
        std::array<glm::vec3, NumCells> result;
        for (std::uint32_t cell = 0; cell < NumCells; ++cell)
            result[cell] = direction_in(cell, glm::dvec2(0.5));
        return result;
    }();
    return all;
}

/// Solid angle of a cell at the middle of a face
constexpr float CellSize = 4.0f / (Cells * Cells);

/// Returns the pixels between records of a picture: 4 from 1024 x 768 on, fewer in small ones.
std::uint32_t step_of(std::uint32_t width, std::uint32_t height) {
    constexpr double Records = 160.0;
    const double records = std::sqrt(static_cast<double>(width) * height) / Records;
    return std::clamp(static_cast<std::uint32_t>(std::ceil(records)), 1u, 4u);
}

} // namespace

/// The records of a square of the grid, whose rays guide each other. For one thread.
class GatheredLight::Square {
public:
    explicit Square(const GatheredLight& own) : own_(own), scene_(own.scene_), light_(own.light_) {}

    void start(std::uint32_t column, std::uint32_t row, Record& record) {
        const mesh::TriangleMesh& mesh = scene_.mesh;
        const glm::vec3 to_point = scene_.grid.direction(own_.middle(column, row));
        const auto met = scene_.seen.rays().closest_hit(scene_.eye, to_point, prt::RayOf::Eye);
        if (!met)
            return;
        const prt::Hit seen = scene_.twins.facing(*met, to_point);
        const prt::MeshPoint at{seen.triangle, seen.barycentric};
        const glm::vec3 normal = prt::shading_normal(mesh, at);
        if (scene_.floor.has(mesh.triangles[at.triangle]) || glm::dot(normal, to_point) >= 0.0f)
            return;
        record = {
            .position = prt::value_at(mesh, mesh.positions, at), .normal = normal, .exists = true};
        Point& point = points_.emplace_back(Point{
            .record = &record,
            .origin = prt::ray_origin(prt::lit_position(mesh, scene_.rays, at, normal, light_.bias),
                                      normal, light_.bias)});
        // It touches another surface, and looks from inside of its own solid: no light gets
        // between.
        point.is_inside = glm::dot(point.origin - record.position, normal) < 0.0f;
        cubemap::SplitMix64 random(std::uint64_t{row} << 32u | column);
        for (glm::dvec2* shift : {&point.shift, &point.guided_shift})
            *shift = {cubemap::unit_interval(random.next()), cubemap::unit_interval(random.next())};
        look_around(point);
    }

    /// `guide` is that of the square: empty, or of another light.
    void finish(std::vector<float>& guide) {
        for (std::uint32_t cell = 0; cell < NumCells; ++cell)
            if (num_looks_[cell] != 0)
                found_[cell] /= static_cast<float>(num_looks_[cell]);
        if (guide.empty())
            guide.assign(found_.begin(), found_.end());
        else
            std::copy(guide.begin(), guide.end(), found_.begin());
        for (std::uint32_t cell = 0; cell < NumCells; ++cell)
            found_[cell] *= stretch(middles()[cell]);
        for (Point& point : points_)
            gather(point);
    }

private:
    struct Ray {
        glm::vec3 direction{0.0f}, radiance{0.0f};
    };
    struct Point {
        Record* record;
        glm::vec3 origin;
        glm::dvec2 shift{0.0}, guided_shift{0.0};
        bool is_inside = false;
    };

    /// Traces rays in directions(i), in order; returns the harmonic mean of the distances of
    /// surfaces.
    template<typename Directions>
    float trace(const Point& point, std::span<Ray> rays, const Directions& directions) const {
        float inverse_distances = 0.0f, num_surfaces = 0.0f;
        for (std::uint32_t first = 0; first < rays.size(); first += prt::PacketSize) {
            prt::DirectionPacket packet;
            packet.num_directions = prt::PacketSize;
            for (std::uint32_t lane = 0; lane < prt::PacketSize; ++lane)
                packet.set(lane, rays[first + lane].direction = directions(first + lane));
            std::array<prt::Hit, prt::PacketSize> hits;
            const std::uint32_t met = scene_.rays.closest_hits(point.origin, packet, 0xffff, hits);
            for (std::uint32_t lane = 0; lane < prt::PacketSize; ++lane) {
                Ray& ray = rays[first + lane];
                ray.radiance = glm::vec3(0.0f);
                if ((met >> lane & 1u) == 0) {
                    if (light_.sky != nullptr)
                        ray.radiance = light_.sky->sky(ray.direction, SolidAngle);
                    continue;
                }
                num_surfaces += 1.0f;
                inverse_distances += 1.0f / std::max(hits[lane].distance, light_.bias);
                const prt::Hit hit = scene_.twins.facing(hits[lane], ray.direction);
                const prt::MeshPoint there{hit.triangle, hit.barycentric};
                if (light_.sends_from_backs || prt::meets_front(scene_.mesh, there, ray.direction))
                    ray.radiance = prt::value_at(scene_.mesh, light_.sent, there);
            }
        }
        return num_surfaces > 0.0f ? num_surfaces / inverse_distances
                                   : std::numeric_limits<float>::infinity();
    }

    /// Traces the cosine-distributed rays of a point from a number on.
    float trace_cosine(const Point& point, std::span<Ray> rays, std::uint32_t first) const {
        const glm::dmat3 frame = cubemap::frame_of(glm::dvec3(point.record->normal));
        return trace(point, rays, [&](std::uint32_t i) {
            return glm::vec3(
                cubemap::cosine_direction(frame, cubemap::r2_place(first + i, point.shift)));
        });
    }

    void look_around(const Point& point) {
        std::array<Ray, NumLooks> rays;
        trace_cosine(point, rays, 0);
        for (const Ray& ray : rays) {
            const std::uint32_t cell = cell_of(ray.direction);
            ++num_looks_[cell];
            found_[cell] += static_cast<float>(cubemap::luminance(ray.radiance));
        }
    }

    /// Finds the light of a point.
    void gather(Point& point) {
        point.record->reach = LeastReach;
        if (point.is_inside)
            return;
        float whole = 0.0f;
        for (std::uint32_t cell = 0; cell < NumCells; ++cell) {
            whole += found_[cell] * std::max(glm::dot(middles()[cell], point.record->normal), 0.0f);
            sums_[cell] = whole;
        }
        const auto chance = [&](std::uint32_t cell) {
            return (sums_[cell] - (cell == 0 ? 0.0f : sums_[cell - 1])) / whole;
        };
        const auto add = [&](const Ray& ray) {
            const float cosine = glm::dot(ray.direction, point.record->normal);
            if (cosine <= 0.0f)
                return;
            const float of_cosine = cosine / std::numbers::pi_v<float>;
            const float of_guided =
                whole > 0.0f ? chance(cell_of(ray.direction)) / (CellSize * stretch(ray.direction))
                             : 0.0f;
            point.record->light +=
                of_cosine / (NumCosine * of_cosine + NumGuided * of_guided) * ray.radiance;
        };
        std::array<Ray, NumCosine> cosine;
        std::array<Ray, NumGuided> guided;
        const float distance = trace_cosine(point, cosine, NumLooks);
        // What a step spans there
        const float step = glm::distance(point.record->position, scene_.eye) *
                           glm::length(scene_.grid.right()) *
                           static_cast<float>(scene_.grid.samples_per_axis() * own_.step_);
        point.record->reach = std::clamp(MostError * distance / step, LeastReach, MostReach);
        const std::uint32_t rounds = rounds_of(point.record->reach);
        for (std::uint32_t round = 0; round < rounds; ++round) {
            if (round != 0)
                trace_cosine(point, cosine, NumLooks + round * NumCosine);
            for (const Ray& ray : cosine)
                add(ray);
            if (!(whole > 0.0f))
                continue;
            const glm::dvec2 start = cubemap::r2_place(round * NumGuided, point.guided_shift);
            std::uint32_t cell = 0;
            trace(point, guided, [&](std::uint32_t i) {
                const auto along = static_cast<float>((i + start.x) / NumGuided) * whole;
                while (cell + 1 < NumCells && sums_[cell] <= along)
                    ++cell;
                return direction_in(cell, cubemap::r2_place(i, start));
            });
            for (const Ray& ray : guided)
                add(ray);
        }
        point.record->light /= static_cast<float>(rounds);
    }

    /// Returns how many times its rays a record has: in corners, few share them.
    static std::uint32_t rounds_of(float reach) {
        constexpr float Few = 3.0f, Fewest = 2.0f;
        return reach < Fewest ? 4 : reach < Few ? 2 : 1;
    }

    /// What a ray sees of the sky, in sr: about its share of a cell.
    static constexpr float SolidAngle = 0.002f;

    const GatheredLight& own_;
    const Scene& scene_;
    const MeshLight& light_;
    std::vector<Point> points_;
    /// Mean luminance that looks into each cell found, in the end times its solid angle, and the
    /// number of looks
    std::array<float, NumCells> found_{};
    std::array<std::uint32_t, NumCells> num_looks_{};
    /// Over the cells up to each, for a point
    std::array<float, NumCells> sums_{};
};

GatheredLight::GatheredLight(const Scene& scene, const MeshLight& light, const prt::Work& work)
    : scene_(scene), light_(light), step_(step_of(scene.width, scene.height)),
      columns_((scene.width + step_ - 1) / step_), rows_((scene.height + step_ - 1) / step_),
      records_(std::size_t{columns_} * rows_) {
    const auto squares = [](std::uint32_t count) {
        return (count + SquareSize - 1) / SquareSize;
    };
    const std::uint32_t across = squares(columns_);
    GatherGuide own;
    GatherGuide& guide = light.guide != nullptr ? *light.guide : own;
    guide.squares.resize(std::size_t{across} * squares(rows_));
    scene.twins.find();
    std::mutex mutex;
    std::uint32_t num_done = 0;
    files::parallel_for(std::uint32_t{0}, across * squares(rows_), [&](std::uint32_t i) {
        if (work.stop.stop_requested())
            return;
        Square square(*this);
        const std::uint32_t left = i % across * SquareSize, top = i / across * SquareSize;
        for (std::uint32_t row = top; row < std::min(top + SquareSize, rows_); ++row)
            for (std::uint32_t column = left; column < std::min(left + SquareSize, columns_);
                 ++column)
                square.start(column, row, records_[std::size_t{row} * columns_ + column]);
        square.finish(guide.squares[i]);
        const std::scoped_lock lock(mutex);
        work.tell(static_cast<double>(++num_done) / static_cast<double>(guide.squares.size()));
    });
    smooth();
}

void GatheredLight::smooth() {
    std::vector<glm::vec3> smoothed(records_.size());
    files::parallel_for(std::uint32_t{0}, rows_, [&](std::uint32_t row) {
        for (std::uint32_t column = 0; column < columns_; ++column) {
            const std::size_t i = std::size_t{row} * columns_ + column;
            const Record& own = records_[i];
            if (own.exists)
                smoothed[i] =
                    around(middle(column, row), own.position, own.normal, own.reach).light;
        }
    });
    for (std::size_t i = 0; i < records_.size(); ++i)
        records_[i].light = smoothed[i];
}

GatheredLight::Mean GatheredLight::around(const glm::vec2& pixel, const glm::vec3& position,
                                          const glm::vec3& normal, float reach) const {
    const auto step = static_cast<float>(step_);
    const float in_pixels = reach * step;
    const auto first = [&](float along) {
        return static_cast<std::uint32_t>(std::max(along - in_pixels, 0.0f) / step);
    };
    const auto end = [&](float along, std::uint32_t count) {
        return std::min(static_cast<std::uint32_t>((along + in_pixels) / step) + 1, count);
    };
    constexpr float LeastCosine = 0.9f, LargestSlope = 0.25f;
    Mean mean;
    for (std::uint32_t row = first(pixel.y); row < end(pixel.y, rows_); ++row)
        for (std::uint32_t column = first(pixel.x); column < end(pixel.x, columns_); ++column) {
            const Record& record = records_[std::size_t{row} * columns_ + column];
            if (!record.exists)
                continue;
            const glm::vec2 away = middle(column, row) - pixel;
            const float near = 1.0f - glm::dot(away, away) / (in_pixels * in_pixels);
            const float alike = glm::dot(record.normal, normal) - LeastCosine;
            const glm::vec3 way = record.position - position;
            const float flat = 1.0f - std::abs(glm::dot(way, record.normal)) /
                                          (LargestSlope * glm::length(way) + 1e-20f);
            if (near <= 0.0f || alike <= 0.0f || flat <= 0.0f)
                continue;
            const float weight = near * near * alike * flat;
            mean.weight += weight;
            mean.light += weight * record.light;
        }
    if (mean.weight > 0.0f)
        mean.light /= mean.weight;
    return mean;
}

glm::vec3 GatheredLight::change(std::uint32_t x, std::uint32_t y, const prt::MeshPoint& at) const {
    const mesh::TriangleMesh& mesh = scene_.mesh;
    if (scene_.floor.has(mesh.triangles[at.triangle]))
        return glm::vec3(0.0f);
    const Mean mean = around(glm::vec2(x, y) + 0.5f, prt::value_at(mesh, mesh.positions, at),
                             prt::shading_normal(mesh, at), LeastReach);
    // Where hardly any record holds
    constexpr float Enough = 0.02f;
    return std::min(mean.weight / Enough, 1.0f) *
           (mean.light - prt::value_at(mesh, light_.replaced, at));
}

} // namespace relumine::relight
