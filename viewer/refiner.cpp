#include "viewer/refiner.h"

#include <algorithm>
#include <exception>
#include <mutex>
#include <stop_token>
#include <thread>
#include <utility>

#include "relumine/out/output_options.h"

namespace relumine::viewer {

namespace {

constexpr std::uint32_t FinestSamples = 3;

relight::Picture drawn(const mesh::TriangleMesh& mesh, const prt::RayScene& rays,
                       const Shading& shading, const Moment& moment, std::uint32_t samples_per_axis,
                       const std::stop_token& stop) {
    const auto shown = [&](std::vector<glm::vec3> colors) {
        const std::size_t num_colored =
            moment.open_floor ? shading.floor.first_vertex : colors.size();
        for (std::size_t i = 0; i < std::min(colors.size(), num_colored); ++i)
            colors[i] *= shading.albedo[i];
        return colors;
    };
    const std::vector<glm::vec3> colors = shown(moment.radiance);
    std::vector<prt::Lobes<glm::vec3>> lobes = moment.lobes;
    if (!lobes.empty())
        relight::add_rest(moment.radiance, shading.surfaces, shading.eye_cosines, lobes);
    const std::vector<glm::vec3> harmonics = relight::scaled(moment.harmonics, shading.albedo);
    const relight::PictureView view(mesh, rays, moment.camera,
                                    {.width = moment.width,
                                     .height = moment.height,
                                     .samples_per_axis = samples_per_axis,
                                     .work = {.stop = stop}},
                                    shading.floor, 0);
    relight::MeshLight light{.radiance = colors,
                             .lights = moment.lights,
                             .albedo = shading.albedo,
                             .emission = shading.emission,
                             .emission_gains = shading.emission_gains,
                             .surfaces = shading.surfaces,
                             .textures = &shading.textures,
                             .lobes = lobes,
                             .harmonics = harmonics,
                             .eye = shading.eye,
                             .bias = shading.bias,
                             .open_floor = moment.open_floor};
    std::optional<relight::Reflections> reflections;
    std::vector<glm::vec3> mirrored;
    if (moment.environment != nullptr) {
        reflections.emplace(rays, shading.bias, OutputOptions{}.highlight_rays, *moment.environment,
                            light.lights.first(moment.num_environment_lights));
        mirrored = shown(moment.mirrored);
        light.reflections = &*reflections;
        light.mirrored = mirrored;
        light.eye = moment.camera.eye;
    }
    return moment.backdrop ? view.draw(light, moment.backdrop) : view.cut_out(light);
}

} // namespace

/// One moment on its way.
class Refiner::Work {
public:
    Work(const Refiner& refiner, Moment moment)
        : thread_([this, &refiner, moment = std::move(moment)](const std::stop_token& stop) {
              try {
                  for (const std::uint32_t samples : {1u, FinestSamples}) {
                      relight::Picture picture = drawn(refiner.mesh_, refiner.rays_,
                                                       refiner.shading_, moment, samples, stop);
                      if (stop.stop_requested())
                          return;
                      const std::scoped_lock lock(mutex_);
                      picture_ = std::move(picture);
                  }
              } catch (const std::exception&) { // no memory: the coarser picture stays
              }
          }) {}

    [[nodiscard]] std::optional<relight::Picture> take() {
        const std::scoped_lock lock(mutex_);
        return std::exchange(picture_, std::nullopt);
    }

private:
    std::mutex mutex_;
    std::optional<relight::Picture> picture_;
    /// Destroyed first: it stops and joins.
    std::jthread thread_;
};

Refiner::Refiner(const mesh::TriangleMesh& mesh, const prt::RayScene& rays, const Shading& shading)
    : mesh_(mesh), rays_(rays), shading_(shading) {}
Refiner::~Refiner() = default;

void Refiner::start(Moment moment) {
    stop();
    work_ = std::make_unique<Work>(*this, std::move(moment));
}

void Refiner::stop() {
    work_.reset();
}

std::optional<relight::Picture> Refiner::take() {
    return work_ ? work_->take() : std::nullopt;
}

relight::Picture Refiner::draw(const Moment& moment) const {
    return drawn(mesh_, rays_, shading_, moment, FinestSamples, {});
}

} // namespace relumine::viewer
