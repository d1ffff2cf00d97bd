#include "relight/reference/exact.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <mutex>
#include <numbers>
#include <stdexcept>

#include <glm/geometric.hpp>

#include "cubemap/image/image_layout.h"
#include "cubemap/luminance.h"
#include "cubemap/resample/pixel_parts.h"
#include "cubemap/split_mix64.h"
#include "files/parallel.h"
#include "prt/glossy/brdf.h"
#include "prt/precompute.h"

namespace relumine::relight {

namespace {

// A packet is a 4 x 4 tile of texels. The 64 receivers of one task share the work of setting it up.
constexpr std::uint32_t TileSize = 4;
constexpr std::size_t ReceiversPerTask = 64;
static_assert(std::size_t{TileSize} * TileSize == prt::PacketSize);

struct Tile {
    prt::DirectionPacket packet;
    /// L dw.
    std::array<glm::dvec3, prt::PacketSize> power{};
    /// Lanes with any light.
    std::uint32_t lit = 0;
};

Tile tile_at(const cubemap::CubeMap& environment, std::span<const double> solid_angles,
             cubemap::Face face, std::uint32_t x0, std::uint32_t y0) {
    Tile tile;
    const std::uint32_t r = environment.resolution;
    tile.packet.num_directions = prt::PacketSize;
    for (std::uint32_t i = 0; i < prt::PacketSize; ++i) {
        // Lanes outside of the face repeat its last texel, without light.
        const std::uint32_t x = x0 + i % TileSize;
        const std::uint32_t y = y0 + i / TileSize;
        const std::uint32_t inner_x = std::min(x, r - 1);
        const std::uint32_t inner_y = std::min(y, r - 1);
        tile.packet.set(i, cubemap::texel_direction(face, inner_x, inner_y, r));
        if (x >= r || y >= r)
            continue;
        tile.power[i] =
            glm::dvec3(environment.at(face, x, y)) * solid_angles[std::size_t{y} * r + x];
        tile.lit |= static_cast<std::uint32_t>(tile.power[i] != glm::dvec3(0.0)) << i;
    }
    return tile;
}

/// Computes the light that one receiver sends back. Colours are put in last.
class ExactReceiver {
public:
    ExactReceiver(const prt::Receivers& receivers, std::uint32_t index, float bias)
        : has_surface_(index >= receivers.num_points()), normal_(receivers.normals[index]),
          origin_(prt::ray_origin(receivers.positions[index], normal_, bias)) {
        if (!receivers.surfaces.empty())
            surface_ = receivers.surfaces[index];
        if (!receivers.to_eye.empty())
            to_eye_ = receivers.to_eye[index];
    }

    void add(const Tile& tile, const prt::Blockers& blockers, prt::Lobes<glm::dvec3>& sums) const {
        if (!has_surface_) {
            constexpr double Part = 0.25 * std::numbers::inv_pi; // of the sphere
            std::uint32_t reached = tile.lit & ~blockers.occluded(origin_, tile.packet, tile.lit);
            for (; reached != 0; reached &= reached - 1)
                sums.diffuse +=
                    tile.power[static_cast<std::size_t>(std::countr_zero(reached))] * Part;
            return;
        }
        const bool diffuse_only = surface_.highlight == prt::Highlight::None;
        std::uint32_t lit = prt::lit_lanes(blockers, origin_, normal_, tile.packet, tile.lit);
        for (; lit != 0; lit &= lit - 1) {
            const auto i = static_cast<std::size_t>(std::countr_zero(lit));
            const glm::vec3 w(tile.packet.x[i], tile.packet.y[i], tile.packet.z[i]);
            const float cosine = normal_.x * w.x + normal_.y * w.y + normal_.z * w.z;
            sums.diffuse += tile.power[i] * (static_cast<double>(cosine) / std::numbers::pi);
            if (diffuse_only)
                continue;
            const prt::Lobes<float> lobes = prt::evaluate_lobes(surface_, normal_, to_eye_, w);
            for (std::size_t lobe = 0; lobe < prt::NumGlossyLobes; ++lobe)
                sums.*prt::GlossyParts<glm::dvec3>[lobe] +=
                    tile.power[i] * static_cast<double>(lobes.*prt::GlossyParts<float>[lobe]);
        }
    }

    [[nodiscard]] glm::dvec3 radiance(const prt::Lobes<glm::dvec3>& sums) const {
        if (surface_ == prt::Surface())
            return sums.diffuse;
        return prt::reflect(surface_, prt::converted<glm::vec3>(sums),
                            {surface_, normal_, to_eye_});
    }

private:
    bool has_surface_;
    glm::vec3 normal_;
    glm::vec3 origin_;
    /// Zero is below every horizon: no highlight.
    glm::vec3 to_eye_{0.0f};
    prt::Surface surface_;
};

void require(bool condition, const char* message) {
    if (!condition)
        throw std::invalid_argument(message);
}

void check(const prt::Receivers& receivers, std::span<const std::uint32_t> receiver_indices) {
    const std::size_t n = receivers.size();
    require(receivers.normals.size() == n, "expected one normal per receiver");
    require(receivers.surfaces.empty() || receivers.surfaces.size() == n,
            "expected one surface per receiver, or none");
    require(receivers.to_eye.empty() || receivers.to_eye.size() == n,
            "expected one direction to the eye per receiver, or none");
    require(std::all_of(receiver_indices.begin(), receiver_indices.end(),
                        [n](std::uint32_t i) { return i < n; }),
            "expected indices of receivers");
}

/// The light of all rows of tiles, over receivers.
class Integration {
public:
    Integration(const prt::Receivers& receivers, std::span<const std::uint32_t> receiver_indices,
                const prt::Blockers& blockers, const ExactOptions& options, const prt::Work& work)
        : blockers_(blockers), work_(work), sums_(receiver_indices.size()) {
        check(receivers, receiver_indices);
        receivers_.reserve(receiver_indices.size());
        for (const std::uint32_t receiver : receiver_indices)
            receivers_.emplace_back(receivers, receiver, options.bias);
    }

    /// Adds the tiles of all rows: for_each_tile(row, visit) calls visit(tile).
    template<typename ForEachTile>
    std::vector<glm::dvec3> radiance(std::size_t num_rows, const ForEachTile& for_each_tile) {
        const std::size_t num_tasks = (sums_.size() + ReceiversPerTask - 1) / ReceiversPerTask;
        std::mutex mutex;
        std::size_t rows_done = 0;
        files::parallel_for(std::size_t{0}, num_tasks, [&](std::size_t task) {
            const std::size_t begin = task * ReceiversPerTask;
            const std::size_t end = std::min(begin + ReceiversPerTask, sums_.size());
            for (std::size_t row = 0; row < num_rows; ++row) {
                for_each_tile(row, [&](const Tile& tile) {
                    if (tile.lit != 0)
                        for (std::size_t i = begin; i < end; ++i)
                            receivers_[i].add(tile, blockers_, sums_[i]);
                });
                work_.poll();
                const std::scoped_lock lock(mutex);
                ++rows_done;
                work_.tell(static_cast<double>(rows_done) /
                           static_cast<double>(num_tasks * num_rows));
            }
        });
        std::vector<glm::dvec3> radiance(sums_.size());
        for (std::size_t i = 0; i < sums_.size(); ++i)
            radiance[i] = receivers_[i].radiance(sums_[i]);
        return radiance;
    }

private:
    const prt::Blockers& blockers_;
    const prt::Work& work_;
    std::vector<ExactReceiver> receivers_;
    std::vector<prt::Lobes<glm::dvec3>> sums_;
};

/// Rays for all dim pixels of an image together, at most about. On the bunny under five maps, four
/// times as many change a relative L2 of 0.0021 by 3e-5 under grace, and others by less. A mirror
/// ball takes as many: its pixels near the rim show much of the sphere.
constexpr std::size_t max_dim_rays(cubemap::Layout layout) {
    return layout == cubemap::Layout::MirrorBall ? 1 << 19 : 1 << 17;
}
/// A ray stands for this part of the image's power at most, unless its pixel is cut as finely as
/// can be.
constexpr double LargestShare = 1e-4;
constexpr std::uint32_t FinestCut = 32;
/// Cut of the pixels at a disc's rim, whose middles are outside.
constexpr std::uint32_t RimCut = 4;

/// The rays of an image: the tiles of each panel's rows.
class ImageTiles {
public:
    ImageTiles(const cubemap::EnvironmentImage& image, const glm::dmat3& turn)
        : image_(image), turn_(turn), parts_(cubemap::shape_of(image)) {
        const std::size_t num_pixels =
            std::size_t{parts_.num_panels()} * parts_.panel_width() * parts_.panel_height();
        const double per_ray =
            static_cast<double>(num_pixels) / static_cast<double>(max_dim_rays(image.layout));
        group_ = static_cast<std::uint32_t>(std::max(1.0, std::ceil(std::sqrt(per_ray))));
        cut_ = static_cast<std::uint32_t>(
            std::clamp(std::floor(std::sqrt(1.0 / per_ray)), 1.0, double{FinestCut}));
        set_total_power();
        // Four rows of groups make rows of tiles of 4 x 4 rays.
        rows_per_panel_ = (parts_.panel_height() + TileSize * group_ - 1) / (TileSize * group_);
        rows_.resize(rows_per_panel_ * parts_.num_panels());
        files::parallel_for(std::size_t{0}, rows_.size(), [&](std::size_t row) { add_row(row); });
    }

    [[nodiscard]] const std::vector<std::vector<Tile>>& rows() const { return rows_; }

private:
    /// A direction, and L dw from there.
    struct Ray {
        glm::dvec3 direction{0.0};
        glm::dvec3 power{0.0};
    };

    void set_total_power() {
        double total = 0.0;
        cubemap::for_each_pixel(
            {image_.layout, image_.sampling, image_.width, image_.height},
            [&](std::size_t pixel, const cubemap::PixelPlace& place) {
                const glm::dvec3 radiance(image_.pixels[pixel]);
                total += cubemap::luminance(radiance.r, radiance.g, radiance.b) * place.solid_angle;
            });
        largest_power_ = total * LargestShare;
    }

    static double luminance_of(const glm::dvec3& power) {
        return cubemap::luminance(power.r, power.g, power.b);
    }

    void add_pixel(std::uint32_t panel, std::uint32_t x, std::uint32_t y, std::uint32_t cut,
                   std::vector<Ray>& rays) const {
        std::vector<cubemap::PixelPlace> parts;
        parts_.append(panel, x, y, cut, parts);
        const glm::dvec3 radiance(image_.pixels[parts_.pixel(panel, x, y)]);
        for (const cubemap::PixelPlace& part : parts)
            rays.push_back({turn_ * part.direction, radiance * part.solid_angle});
    }

    /// Adds the rays of a group of pixels: one for all of it where it is dim, its pixels and their
    /// parts where it is bright.
    void add_group(std::uint32_t panel, std::uint32_t x0, std::uint32_t y0, std::vector<Ray>& dim,
                   std::vector<Ray>& bright) const {
        std::vector<Ray> pixels;
        std::vector<std::pair<std::uint32_t, std::uint32_t>> places;
        double power = 0.0;
        for (std::uint32_t y = y0; y < std::min(y0 + group_, parts_.panel_height()); ++y)
            for (std::uint32_t x = x0; x < std::min(x0 + group_, parts_.panel_width()); ++x) {
                const std::size_t before = pixels.size();
                add_pixel(panel, x, y, 1, pixels);
                if (pixels.size() == before && group_ == 1 && cut_ == 1)
                    add_pixel(panel, x, y, RimCut, pixels);
                for (std::size_t i = before; i < pixels.size(); ++i)
                    power += luminance_of(pixels[i].power);
                places.emplace_back(x, y);
            }
        if (power > largest_power_) {
            for (const auto& [x, y] : places) {
                std::vector<Ray> pixel;
                add_pixel(panel, x, y, 1, pixel);
                const double share =
                    pixel.empty() ? 0.0 : luminance_of(pixel.front().power) / largest_power_;
                const auto cut = static_cast<std::uint32_t>(
                    std::min(std::ceil(std::sqrt(share)), double{FinestCut}));
                add_pixel(panel, x, y, std::max(cut, cut_), bright);
            }
        } else if (group_ == 1 && cut_ > 1) {
            add_pixel(panel, x0, y0, cut_, bright);
        } else if (power > 0.0) {
            Ray ray;
            for (const Ray& pixel : pixels) {
                ray.power += pixel.power;
                ray.direction += pixel.direction * luminance_of(pixel.power);
            }
            ray.direction = glm::normalize(ray.direction);
            dim.push_back(ray);
        }
    }

    void add_row(std::size_t row) {
        const auto panel = static_cast<std::uint32_t>(row / rows_per_panel_);
        const auto y0 = static_cast<std::uint32_t>(row % rows_per_panel_) * TileSize * group_;
        std::vector<Ray> bright;
        for (std::uint32_t x0 = 0; x0 < parts_.panel_width(); x0 += TileSize * group_) {
            std::vector<Ray> dim;
            for (std::uint32_t i = 0; i < prt::PacketSize; ++i) {
                const std::uint32_t x = x0 + i % TileSize * group_;
                const std::uint32_t y = y0 + i / TileSize * group_;
                if (x < parts_.panel_width() && y < parts_.panel_height())
                    add_group(panel, x, y, dim, bright);
            }
            add_tiles(dim, rows_[row]);
        }
        add_tiles(bright, rows_[row]);
    }

    static void add_tiles(std::span<const Ray> rays, std::vector<Tile>& tiles) {
        for (; !rays.empty(); rays = rays.subspan(std::min(rays.size(), prt::PacketSize))) {
            Tile& tile = tiles.emplace_back();
            tile.packet.num_directions = prt::PacketSize;
            for (std::size_t i = 0; i < prt::PacketSize; ++i) {
                const Ray& ray = rays[i < rays.size() ? i : 0];
                tile.packet.set(i, ray.direction);
                if (i >= rays.size())
                    continue;
                tile.power[i] = ray.power;
                tile.lit |= static_cast<std::uint32_t>(ray.power != glm::dvec3(0.0)) << i;
            }
        }
    }

    const cubemap::EnvironmentImage& image_;
    glm::dmat3 turn_;
    cubemap::PixelParts parts_;
    /// Pixels along the side of a group.
    std::uint32_t group_;
    /// Parts along the side of every pixel, of small images.
    std::uint32_t cut_;
    double largest_power_ = 0.0;
    std::size_t rows_per_panel_;
    std::vector<std::vector<Tile>> rows_;
};

} // namespace

std::vector<glm::dvec3> exact_radiance(const prt::Receivers& receivers,
                                       std::span<const std::uint32_t> receiver_indices,
                                       const prt::Blockers& blockers,
                                       const cubemap::CubeMap& environment,
                                       const ExactOptions& options, const prt::Work& work) {
    const std::uint32_t r = environment.resolution;
    require(r > 0 && environment.texels.size() == std::size_t{cubemap::NumFaces} * r * r,
            "expected an environment of 6 x R x R texels");
    const std::vector<double> solid_angles = cubemap::texel_solid_angles(r);
    const std::size_t rows_per_face = (r + TileSize - 1) / TileSize;
    return Integration(receivers, receiver_indices, blockers, options, work)
        .radiance(cubemap::NumFaces * rows_per_face, [&](std::size_t row, const auto& visit) {
            const cubemap::Face face = cubemap::AllFaces[row / rows_per_face];
            const auto y = static_cast<std::uint32_t>(row % rows_per_face) * TileSize;
            for (std::uint32_t x = 0; x < r; x += TileSize)
                visit(tile_at(environment, solid_angles, face, x, y));
        });
}

std::vector<glm::dvec3> exact_radiance(const prt::Receivers& receivers,
                                       std::span<const std::uint32_t> receiver_indices,
                                       const prt::Blockers& blockers,
                                       const cubemap::EnvironmentFile& environment,
                                       const ExactOptions& options, const prt::Work& work) {
    require(environment.image != nullptr &&
                environment.image->pixels.size() ==
                    std::size_t{environment.image->width} * environment.image->height,
            "expected an environment of width x height pixels");
    const ImageTiles tiles(*environment.image, environment.turn);
    return Integration(receivers, receiver_indices, blockers, options, work)
        .radiance(tiles.rows().size(), [&](std::size_t row, const auto& visit) {
            for (const Tile& tile : tiles.rows()[row])
                visit(tile);
        });
}

std::vector<std::uint32_t> random_receivers(const prt::Transfer& transfer, std::size_t count,
                                            std::uint64_t seed, std::size_t end) {
    std::vector<std::uint32_t> places;
    for (std::uint32_t place = 0; place < transfer.num_receivers(); ++place)
        if (transfer.order[place] < end)
            places.push_back(place);
    const std::size_t num_receivers = places.size();
    if (count == 0 || count > num_receivers)
        count = num_receivers;
    // Fisher and Yates' shuffle of the first `count` places.
    cubemap::SplitMix64 random(seed);
    for (std::size_t i = 0; i < count; ++i)
        std::swap(places[i], places[i + random.below(num_receivers - i)]);
    places.resize(count);
    std::sort(places.begin(), places.end());
    std::transform(places.begin(), places.end(), places.begin(),
                   [&](std::uint32_t p) { return transfer.order[p]; });
    return places;
}

ErrorReport compare(std::span<const std::uint32_t> receiver_indices,
                    std::span<const glm::dvec3> exact, std::span<const glm::vec3> relit) {
    require(exact.size() == receiver_indices.size(), "expected one exact radiance per index");
    require(std::all_of(receiver_indices.begin(), receiver_indices.end(),
                        [&](std::uint32_t i) { return i < relit.size(); }),
            "expected indices of relit receivers");
    ErrorReport report;
    double error_squares = 0.0;
    double exact_squares = 0.0;
    double error_sum = 0.0;
    double difference_sum = 0.0;
    double exact_sum = 0.0;
    double largest = -1.0;
    for (std::size_t i = 0; i < receiver_indices.size(); ++i) {
        const glm::dvec3 difference = glm::dvec3(relit[receiver_indices[i]]) - exact[i];
        const glm::dvec3 error = glm::abs(difference);
        difference_sum += difference.r + difference.g + difference.b;
        error_squares += glm::dot(error, error);
        exact_squares += glm::dot(exact[i], exact[i]);
        error_sum += error.r + error.g + error.b;
        exact_sum += exact[i].r + exact[i].g + exact[i].b;
        if (const double worst = std::max({error.r, error.g, error.b}); worst > largest) {
            largest = worst;
            report.worst_receiver = receiver_indices[i];
        }
    }
    if (receiver_indices.empty())
        return report;
    const double num_values = 3.0 * static_cast<double>(receiver_indices.size());
    report.mean_radiance = exact_sum / num_values;
    if (error_sum == 0.0)
        return report;
    report.relative_l2 = std::sqrt(error_squares / exact_squares);
    report.mean_abs = error_sum / exact_sum;
    report.bias = difference_sum / exact_sum;
    report.max_abs = largest / report.mean_radiance;
    return report;
}

} // namespace relumine::relight
