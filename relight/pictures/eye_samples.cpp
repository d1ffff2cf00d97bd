#include "relight/pictures/eye_samples.h"

#include <algorithm>
#include <array>
#include <utility>

#include "files/parallel.h"

namespace relumine::relight {

namespace {

/// A ray costs about as much as so many triangles that are projected.
constexpr std::size_t TrianglesPerRay = 4;

} // namespace

EyeSamples::EyeSamples(const SeenMesh& mesh, const prt::RayScene& rays, const glm::vec3& eye,
                       const prt::PictureRays& grid, const PictureTiles& tiles,
                       std::size_t max_bytes, const std::stop_token& stop)
    : mesh_(mesh), eye_(eye), grid_(grid), tiles_(tiles),
      twins_(std::make_unique<const prt::TwinTriangles>(mesh.mesh())) {
    const std::size_t per_pixel = grid.samples_per_pixel();
    const std::size_t num_samples = std::size_t{tiles.width} * tiles.height * per_pixel;
    if (mesh.mesh().num_triangles() <= TrianglesPerRay * num_samples)
        raster_.emplace(mesh.mesh(), rays, *twins_, eye, grid, tiles);
    if (num_samples > max_bytes / sizeof(EyeSample))
        return;
    std::vector<EyeSample> samples(num_samples);
    files::parallel_for(std::uint32_t{0}, tiles.count(), [&](std::uint32_t tile) {
        if (stop.stop_requested())
            return;
        const PixelRectangle pixels = tiles.pixels(tile, 0);
        std::vector<EyeSample> found(pixels.size() * per_pixel);
        find(tile, pixels, found);
        const std::size_t row = pixels.width() * per_pixel;
        for (std::uint32_t y = pixels.top; y < pixels.bottom; ++y)
            std::copy_n(found.data() + (y - pixels.top) * row, row,
                        samples.data() + (std::size_t{y} * tiles.width + pixels.left) * per_pixel);
    });
    kept_ = std::move(samples);
}

SampleRectangle EyeSamples::of(std::uint32_t tile, std::uint32_t ring) const {
    const std::size_t per_pixel = grid_.samples_per_pixel();
    const PixelRectangle pixels = tiles_.pixels(tile, ring);
    if (!kept_.empty())
        return {pixels, per_pixel,
                std::span(kept_).subspan((std::size_t{pixels.top} * tiles_.width + pixels.left) *
                                         per_pixel),
                tiles_.width * per_pixel};
    std::vector<EyeSample> found(pixels.size() * per_pixel);
    find(tile, pixels, found);
    return {pixels, per_pixel, std::move(found)};
}

void EyeSamples::find(std::uint32_t tile, const PixelRectangle& pixels,
                      std::span<EyeSample> samples) const {
    if (!raster_ || !raster_->find(tile, pixels, samples))
        trace(pixels, samples);
}

void EyeSamples::trace(const PixelRectangle& pixels, std::span<EyeSample> samples) const {
    const prt::RayScene& rays = mesh_.rays();
    prt::DirectionPacket packet;
    std::array<prt::Hit, prt::PacketSize> hits;
    std::size_t done = 0;
    const auto trace_packet = [&] {
        const auto num = packet.num_directions;
        for (std::size_t lane = num; lane < prt::PacketSize; ++lane)
            packet.set(lane, {packet.x[0], packet.y[0], packet.z[0]});
        const std::uint32_t found =
            rays.closest_hits(eye_, packet, (1u << num) - 1u, hits, prt::RayOf::Eye);
        for (std::uint32_t lane = 0; lane < num; ++lane, ++done) {
            samples[done] = {};
            if ((found >> lane & 1u) == 0)
                continue;
            const prt::Hit hit =
                twins_->facing(hits[lane], {packet.x[lane], packet.y[lane], packet.z[lane]});
            samples[done] = {hit.triangle, hit.barycentric.x, hit.barycentric.y};
        }
        packet.num_directions = 0;
    };
    for (std::uint32_t y = pixels.top; y < pixels.bottom; ++y)
        for (std::uint32_t x = pixels.left; x < pixels.right; ++x)
            for (std::uint32_t i = 0; i < grid_.samples_per_pixel(); ++i) {
                packet.set(packet.num_directions++, grid_.direction(x, y, i));
                if (packet.num_directions == prt::PacketSize)
                    trace_packet();
            }
    if (packet.num_directions != 0)
        trace_packet();
}

} // namespace relumine::relight
