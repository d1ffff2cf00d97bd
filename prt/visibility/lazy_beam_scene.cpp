#include "prt/visibility/lazy_beam_scene.h"

#include "files/parallel.h"
#include "prt/visibility/ray_scene.h"

namespace relumine::prt {

namespace {

/// Preparing a triangle takes as long as 32 rays save (`./dev bench frames`, the sequence `sun`).
constexpr std::uint64_t RaysPerTriangle = 32;

/// Three gigabytes of prepared triangles.
constexpr std::size_t MostTriangles = 12'000'000;

} // namespace

LazyBeamScene::LazyBeamScene(const mesh::TriangleMesh& mesh, const RayScene& exact)
    : mesh_(mesh), exact_(exact) {}

LazyBeamScene::~LazyBeamScene() = default;

std::uint32_t LazyBeamScene::occluded(const glm::vec3& origin, const DirectionPacket& directions,
                                      std::uint32_t active) const {
    return exact_.occluded(origin, directions, active);
}

void LazyBeamScene::clear_blocked(const ReceiverGroup& group, const DirectionPatch& patch,
                                  std::span<std::uint64_t> rays) const {
    if (const BeamScene* beams = ready_)
        beams->clear_blocked(group, patch, rays);
    else
        exact_.clear_blocked(group, patch, rays);
}

void LazyBeamScene::prepare(std::uint64_t num_rays) const {
    if (ready_ != nullptr || mesh_.num_triangles() > MostTriangles)
        return;
    const std::scoped_lock lock(mutex_);
    num_rays_ += num_rays;
    if (beams_ || num_rays_ < RaysPerTriangle * mesh_.num_triangles())
        return;
    prepare_beams();
}

/// Under the lock. Isolated: a thread that waits inside must not take up work that asks for it.
void LazyBeamScene::prepare_beams() const {
    files::run_isolated([&] { beams_ = std::make_unique<BeamScene>(mesh_, exact_); });
    ready_ = beams_.get();
}

const BeamScene& LazyBeamScene::beams() const {
    const std::scoped_lock lock(mutex_);
    if (!beams_)
        prepare_beams();
    return *beams_;
}

void LazyBeamScene::follow(std::uint32_t group) {
    if (beams_)
        beams_->follow(mesh_, group);
}

} // namespace relumine::prt
