#include "relight/pictures/picture_view.h"

#include <mutex>
#include <stdexcept>

#include "files/parallel.h"
#include "relight/harmonics/harmonics.h"
#include "relight/pictures/eye_samples.h"
#include "relight/pictures/floor_shadows.h"
#include "relight/pictures/gathered_light.h"
#include "relight/pictures/picture_tile.h"
#include "relight/pictures/pixel_lights.h"
#include "relight/pictures/seen_mesh.h"
#include "relight/sharp/light_packets.h"

namespace relumine::relight {

PictureView::PictureView(const mesh::TriangleMesh& mesh, const prt::RayScene& rays,
                         const Camera& camera, const PictureOptions& options,
                         const FadingFloor& floor, std::size_t max_bytes)
    : mesh_(mesh), rays_(rays), eye_(camera.eye), options_(options), floor_(floor),
      grid_(camera, options.width, options.height, options.samples_per_axis),
      seen_(std::make_unique<const SeenMesh>(mesh, rays, floor, camera.eye)),
      samples_(std::make_unique<const EyeSamples>(*seen_, rays, camera.eye, grid_,
                                                  PictureTiles{options.width, options.height},
                                                  max_bytes, options.work.stop)) {}
PictureView::~PictureView() = default;
PictureView::PictureView(PictureView&&) noexcept = default;

Picture PictureView::drawn(const MeshLight& light, const Backdrop* backdrop) const {
    const auto fits = [&](std::size_t size) {
        return size == 0 || size == mesh_.num_vertices();
    };
    if (light.radiance.size() != mesh_.num_vertices() || !fits(light.albedo.size()) ||
        !fits(light.surfaces.size()) || !fits(light.lobes.size()) || !fits(light.emission.size()) ||
        (light.reflections != nullptr && light.mirrored.size() != mesh_.num_vertices()) ||
        !fits(light.sent.size()) || light.replaced.size() != light.sent.size() ||
        light.harmonics.size() % mesh_.num_vertices() != 0 ||
        light.harmonics.size() / mesh_.num_vertices() > MaxHarmonics)
        throw std::invalid_argument("expected one radiance, albedo and surface per vertex");
    const LightPackets packets(light.lights);
    Picture picture{.width = options_.width, .height = options_.height};
    picture.pixels.resize(std::size_t{options_.width} * options_.height);
    if (backdrop == nullptr)
        picture.alpha.resize(picture.pixels.size());
    const LightBeams beams(light.lights);
    const FloorLights floor_lights(light.floor_lights, grid_.samples_per_pixel());
    if (light.blockers != nullptr)
        light.blockers->prepare(picture.pixels.size() *
                                (light.lights.size() + light.floor_lights.size()));
    const PictureTiles tiles{options_.width, options_.height};
    // About the share of the time
    const double of_gathered = light.sent.empty() ? 0.0 : 0.3;
    std::optional<GatheredLight> gathered;
    if (!light.sent.empty())
        gathered.emplace(GatheredLight::Scene{mesh_, rays_, *seen_, samples_->twins(), floor_, eye_,
                                              grid_, options_.width, options_.height},
                         light,
                         prt::Work{.stop = options_.work.stop, .on_progress = [&](double part) {
                                       options_.work.tell(of_gathered * part);
                                   }});
    const TileScene scene{
        mesh_, rays_, *seen_,  eye_,  grid_,        floor_,   *samples_,
        tiles, light, packets, beams, floor_lights, backdrop, gathered ? &*gathered : nullptr};
    std::mutex mutex;
    std::uint32_t num_drawn = 0;
    files::parallel_for(std::uint32_t{0}, tiles.count(), [&](std::uint32_t tile) {
        if (options_.work.stop.stop_requested())
            return;
        PictureTile(scene).draw(tile, picture);
        const std::scoped_lock lock(mutex);
        options_.work.tell(of_gathered +
                           (1.0 - of_gathered) * static_cast<double>(++num_drawn) / tiles.count());
    });
    return picture;
}

Picture PictureView::cut_out(const MeshLight& light) const {
    return drawn(light, nullptr);
}

Picture PictureView::draw(const MeshLight& light, const Backdrop& backdrop) const {
    return drawn(light, &backdrop);
}

} // namespace relumine::relight
