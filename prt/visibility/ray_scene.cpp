#include "prt/visibility/ray_scene.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <tuple>
#include <utility>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "prt/visibility/coplanar_faces.h"
#include "prt/visibility/embree.h"
#include "prt/visibility/half_line.h"
#include "prt/visibility/triangle_verdict.h"

namespace relumine::prt {

namespace {

constexpr float Infinity = std::numeric_limits<float>::infinity();

struct SceneDeleter {
    void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
};
using SceneHandle = std::unique_ptr<std::remove_pointer_t<RTCScene>, SceneDeleter>;

/// Whether the corners lie on one line. Exact unless coordinates differ by more than a factor of
/// 2^28.
bool has_no_area(const mesh::TriangleMesh& mesh, const mesh::Triangle& triangle) {
    const glm::dvec3 corner(mesh.positions[triangle[0]]);
    return glm::cross(glm::dvec3(mesh.positions[triangle[1]]) - corner,
                      glm::dvec3(mesh.positions[triangle[2]]) - corner) == glm::dvec3(0.0);
}

/// The triangles that rays are traced against.
///
/// A triangle without area blocks nothing. But Embree's edge functions are all zero for it, and say
/// "hit" to rays that pass beside it in a plane with it. It gets a corner that is not a number, so
/// Embree drops it. The other triangles keep their numbers.
struct TracedMesh {
    explicit TracedMesh(const mesh::TriangleMesh& mesh)
        : see_through(std::make_shared<const SeeThrough>(mesh)) {
        positions.reserve(mesh.num_vertices() + NumMore);
        positions = mesh.positions;
        positions.resize(mesh.num_vertices() + NumMore,
                         glm::vec3(std::numeric_limits<float>::quiet_NaN()));
        triangles.reserve(mesh.num_triangles() + 1); // Embree reads a number beyond the last
        triangles = mesh.triangles;
        for (std::uint32_t i = 0; i < triangles.size(); ++i)
            static_cast<void>(take(mesh, i));
    }

    /// Takes a triangle as it stands in the mesh. Returns whether it blocks rays, and did not
    /// before, or the other way round.
    bool take(const mesh::TriangleMesh& mesh, std::uint32_t i) {
        const auto nowhere = static_cast<std::uint32_t>(mesh.num_vertices());
        for (const std::uint32_t vertex : mesh.triangles[i])
            positions[vertex] = mesh.positions[vertex];
        const bool is_dropped = has_no_area(mesh, mesh.triangles[i]) || see_through->is_cut_out(i);
        const mesh::Triangle before =
            std::exchange(triangles[i], is_dropped ? mesh::Triangle{nowhere, nowhere, nowhere}
                                                   : mesh.triangles[i]);
        return before != triangles[i];
    }

    /// Behind those of the mesh: a corner that is not a number, and what Embree reads beyond it
    static constexpr std::size_t NumMore = 2;
    std::vector<glm::vec3> positions;
    std::vector<mesh::Triangle> triangles;
    std::shared_ptr<const SeeThrough> see_through;
};

/// Triangles that Embree has a tree of.
struct TracedPart {
    const TracedMesh* all = nullptr;
    /// Their numbers in the mesh, ascending; empty: they are those of the mesh.
    std::span<const std::uint32_t> numbers = {};
    /// Null: it has none.
    RTCGeometry geometry = nullptr;

    [[nodiscard]] std::uint32_t number_of(unsigned int primitive) const {
        return numbers.empty() ? primitive : numbers[primitive];
    }
};

/// The nearest hit of a ray so far.
struct Nearest {
    Meeting meeting;
    /// The least of all candidates'
    double order = std::numeric_limits<double>::infinity();
    std::uint32_t triangle = 0;
    /// Embree looks for hits up to here.
    float reach = Infinity;
};

/// Rays that Embree traces. Starts with what Embree hands on to the filters below.
struct Query {
    embree::Context context;
    /// Rays of a packet that must be traced one by one.
    ///
    /// The other rays of a packet decide which boxes of Embree's tree are opened for a ray. So they
    /// decide whether a hit is found that is one by a rounding only.
    std::uint32_t doubtful = 0;
    bool is_packet = false;
    RayOf of = RayOf::Light;
    /// [number of rays] where the nearest hits are asked for
    Nearest* nearest = nullptr;
    /// The layer whose successor is looked for; null: the first is.
    const Nearest* behind = nullptr;
    /// Decides between surfaces in one plane; null: the nearest is taken.
    const CoplanarFaces* coplanar = nullptr;
    /// Where all that the ray crosses is asked for
    std::vector<RayScene::Crossing>* crossings = nullptr;

    explicit Query(bool packet, RayOf whose = RayOf::Light) : is_packet(packet), of(whose) {
        embree::begin(context);
    }
};

/// A ray, and a triangle that Embree says it hits.
struct Candidate {
    /// From the ray's start
    std::array<glm::dvec3, 3> corners;
    glm::dvec3 direction;
    /// Its number in the query
    std::uint32_t ray;
    std::uint32_t triangle;
    glm::vec3 origin;
    const TracedMesh& mesh;

    Candidate(const RTCFilterFunctionNArguments* hits, unsigned int i)
        : direction(RTCRayN_dir_x(hits->ray, hits->N, i), RTCRayN_dir_y(hits->ray, hits->N, i),
                    RTCRayN_dir_z(hits->ray, hits->N, i)),
          ray(RTCRayN_id(hits->ray, hits->N, i)),
          triangle(static_cast<const TracedPart*>(hits->geometryUserPtr)
                       ->number_of(RTCHitN_primID(hits->hit, hits->N, i))),
          origin(RTCRayN_org_x(hits->ray, hits->N, i), RTCRayN_org_y(hits->ray, hits->N, i),
                 RTCRayN_org_z(hits->ray, hits->N, i)),
          mesh(*static_cast<const TracedPart*>(hits->geometryUserPtr)->all) {
        for (std::size_t k = 0; k < 3; ++k)
            corners[k] =
                glm::dvec3(mesh.positions[mesh.triangles[triangle][k]]) - glm::dvec3(origin);
    }

    /// Whether the ray goes on behind the triangle.
    [[nodiscard]] bool passes(RayOf of) const {
        if (!is_eye(of))
            return mesh.see_through->light_passes(triangle, corners, origin, glm::vec3(direction),
                                                  of);
        if (!mesh.see_through->may_pass(triangle, of))
            return false;
        const glm::dvec3 normal = glm::cross(corners[1] - corners[0], corners[2] - corners[0]);
        return mesh.see_through->passes(
            {.triangle = triangle,
             .barycentric = glm::vec2(meeting_of(corners, direction).barycentric),
             .origin = origin,
             .direction = glm::vec3(direction),
             .is_back = glm::dot(normal, direction) > 0.0},
            of);
    }

    /// Whether the hit lies beside the triangle.
    ///
    /// Embree moves corners by a rounding of their distance d. Where a ray runs along a triangle's
    /// plane it compares noise with noise. It then finds hits far beside the triangle, up to the
    /// boxes of its tree. Such a hit would be a shadow that nothing casts. The remaining hits are
    /// no farther off than a ray's own rounding.
    [[nodiscard]] bool is_beside() const {
        constexpr double Roundings = 16.0 * 0x1p-24;
        if (meets(corners, direction)) // as nearly all do
            return false;
        return passes_by(corners, glm::normalize(direction), Roundings * farthest());
    }

    /// Distance of the farthest corner
    [[nodiscard]] double farthest() const {
        return std::sqrt(
            std::max({glm::dot(corners[0], corners[0]), glm::dot(corners[1], corners[1]),
                      glm::dot(corners[2], corners[2])}));
    }

    [[nodiscard]] RayScene::Crossing crossing() const {
        const auto& [a, b, c] = mesh.triangles[triangle];
        return {.part = static_cast<float>(meeting_of(corners, direction).distance),
                .is_front = glm::dot(glm::cross(corners[1] - corners[0], corners[2] - corners[0]),
                                     direction) < 0.0,
                .corners = {mesh.positions[a], mesh.positions[b], mesh.positions[c]}};
    }

    [[nodiscard]] bool is_in_doubt(const Query& query) const {
        return query.is_packet && !hits_for_certain(corners, direction);
    }
};

/// What Embree asks of each hit of a ray that may be blocked.
void keep_blockers(const RTCFilterFunctionNArguments* hits) {
    auto& query = *reinterpret_cast<Query*>(hits->context);
    for (unsigned int i = 0; i < hits->N; ++i) {
        if (hits->valid[i] == 0)
            continue;
        const Candidate candidate(hits, i);
        if (candidate.passes(query.of)) {
            hits->valid[i] = 0;
            continue;
        }
        const bool is_in_doubt = candidate.is_in_doubt(query);
        if (query.is_packet && !is_in_doubt)
            continue;
        const bool is_beside = candidate.is_beside();
        if (is_in_doubt && !is_beside)
            query.doubtful |= 1u << candidate.ray;
        if (is_in_doubt || is_beside) // something else may block the ray for certain
            hits->valid[i] = 0;
    }
}

/// What Embree asks of each hit of a ray whose nearest hit is looked for.
///
/// Embree's distances come from the processor's approximation of a reciprocal, and the order in
/// which it looks at triangles depends on the processor, too. So what is about as near is looked
/// at, and distances in double choose. Where a ray grazes a triangle, Embree's distance may be far
/// from that in double. The larger one counts, so that the order does not matter.
void keep_nearest(const RTCFilterFunctionNArguments* hits) {
    constexpr double OfDistance = 0x1p-12, OfFarthest = 0x1p-18; // far above Embree's roundings
    auto& query = *reinterpret_cast<Query*>(hits->context);
    for (unsigned int i = 0; i < hits->N; ++i) {
        if (hits->valid[i] == 0)
            continue;
        const Candidate candidate(hits, i);
        if (candidate.is_beside() || candidate.passes(query.of)) {
            hits->valid[i] = 0;
            continue;
        }
        if (query.crossings != nullptr) {
            query.crossings->push_back(candidate.crossing());
            hits->valid[i] = 0;
            continue;
        }
        if (candidate.is_in_doubt(query))
            query.doubtful |= 1u << candidate.ray;
        const Meeting meeting = meeting_of(candidate.corners, candidate.direction);
        float& reach = RTCRayN_tfar(hits->ray, hits->N, i);
        const auto embree = static_cast<double>(reach);
        const double about = OfDistance * meeting.distance +
                             OfFarthest * candidate.farthest() / glm::length(candidate.direction);
        const double order = std::abs(embree - meeting.distance) <= about
                                 ? meeting.distance
                                 : std::max(embree, meeting.distance);
        if (query.behind != nullptr && std::tie(order, candidate.triangle) <=
                                           std::tie(query.behind->order, query.behind->triangle)) {
            hits->valid[i] = 0;
            continue;
        }
        Nearest& nearest = query.nearest[candidate.ray];
        const bool is_nearer =
            std::tie(order, candidate.triangle) < std::tie(nearest.order, nearest.triangle);
        const bool is_tie =
            query.coplanar != nullptr && std::abs(order - nearest.order) <= about &&
            query.coplanar->covers(is_nearer ? nearest.triangle : candidate.triangle,
                                   is_nearer ? candidate.triangle : nearest.triangle);
        const double least = std::min(nearest.order, order);
        if (is_nearer != is_tie)
            nearest = {meeting, order, candidate.triangle, nearest.reach};
        nearest.order = least;
        reach = nearest.reach = std::min(nearest.reach, static_cast<float>(order + about));
    }
}

constexpr std::array<float, PacketSize> AllInfinite = [] {
    std::array<float, PacketSize> distances{};
    distances.fill(Infinity);
    return distances;
}();

Hit hit_of(const Nearest& nearest) {
    return {.triangle = nearest.triangle,
            .barycentric = glm::vec2(nearest.meeting.barycentric),
            .distance = static_cast<float>(nearest.meeting.distance)};
}

/// Whether rays from one point lie so close together that tracing them as a packet is fastest.
/// Measured.
bool are_coherent(const DirectionPacket& directions) {
    constexpr float CosineOfSpread = 0.8f;
    const glm::vec3 first = directions.direction(0);
    for (std::size_t i = 1; i < PacketSize; ++i)
        if (glm::dot(first, directions.direction(i)) < CosineOfSpread)
            return false;
    return true;
}

} // namespace

std::string ray_engine() {
    return embree::version_of(embree::new_device().get());
}

struct RayScene::Impl {
    Impl(const mesh::TriangleMesh& mesh, Groups groups);

    void add(TracedPart& part);
    /// Gives Embree the triangles of a part that has numbers.
    void fill(const TracedPart& part) const {
        auto* const buffer = static_cast<mesh::Triangle*>(
            rtcGetGeometryBufferData(part.geometry, RTC_BUFFER_TYPE_INDEX, 0));
        for (std::size_t i = 0; i < part.numbers.size(); ++i)
            buffer[i] = mesh.triangles[part.numbers[i]];
    }
    void find_coplanar() {
        coplanar.emplace(
            std::span(mesh.positions).first(mesh.positions.size() - TracedMesh::NumMore + 1),
            std::span(mesh.triangles));
    }

    /// Embree holds its address, and those of its positions and of the parts.
    TracedMesh mesh;
    /// The triangles' numbers, one group behind the other; empty where groups stay.
    std::vector<std::uint32_t> numbers;
    /// [groups], or one
    std::vector<TracedPart> parts;
    embree::DeviceHandle device;
    SceneHandle scene;
    embree::Flags packets = embree::Coherent;
    std::unique_ptr<const Blockers> settled;
    /// Which of Embree's triangles lie in one plane
    std::optional<const CoplanarFaces> coplanar;

    /// What decides for rays between surfaces in one plane.
    [[nodiscard]] const CoplanarFaces* coplanar_for(RayOf of) const {
        return is_eye(of) ? &*coplanar : nullptr;
    }
    std::uint32_t occluded(const glm::vec3& origin, const DirectionPacket& directions,
                           std::span<const float, PacketSize> distances, std::uint32_t active,
                           RayOf of) const;
    bool occluded(const glm::vec3& origin, const glm::vec3& direction, float distance,
                  RayOf of) const;
    bool trace(const glm::vec3& origin, const glm::vec3& direction, Query& query) const;
};

/// Blocks the rays of the scene that pass no surface by chance: RayOf::SettledLight.
class RayScene::Settled final : public Blockers {
public:
    explicit Settled(const Impl& impl) : impl_(impl) {}
    [[nodiscard]] std::uint32_t occluded(const glm::vec3& origin, const DirectionPacket& directions,
                                         std::uint32_t active) const override {
        return impl_.occluded(origin, directions, AllInfinite, active, RayOf::SettledLight);
    }

private:
    const Impl& impl_;
};

RayScene::Impl::Impl(const mesh::TriangleMesh& from, Groups groups)
    : mesh(from), device(embree::new_device()), scene(rtcNewScene(device.get())) {
    rtcSetSceneFlags(scene.get(), RTC_SCENE_FLAG_ROBUST);
    if (groups == Groups::Stay || from.triangle_groups.empty()) {
        parts.push_back({.all = &mesh});
    } else {
        // Of low quality are the trees over groups. Each group has one as ever, which stays as long
        // as the group does.
        rtcSetSceneBuildQuality(scene.get(), RTC_BUILD_QUALITY_LOW);
        numbers.resize(from.num_triangles());
        std::iota(numbers.begin(), numbers.end(), 0u);
        const auto group_of = [&](std::uint32_t triangle) {
            return from.triangle_groups[triangle];
        };
        std::ranges::stable_sort(numbers, {}, group_of);
        for (std::uint32_t group = 0; group < from.groups.size(); ++group)
            parts.push_back({.all = &mesh,
                             .numbers = std::span<const std::uint32_t>(
                                 std::ranges::equal_range(numbers, group, {}, group_of))});
    }
    for (TracedPart& part : parts)
        if (parts.size() == 1 || !part.numbers.empty())
            add(part);
    find_coplanar();
}

/// Lets Embree build a tree of a part.
void RayScene::Impl::add(TracedPart& part) {
    part.geometry = rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_TRIANGLE);
    rtcSetSharedGeometryBuffer(part.geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                               mesh.positions.data(), 0, sizeof(glm::vec3),
                               mesh.positions.size() - 1);
    if (part.numbers.empty())
        rtcSetSharedGeometryBuffer(part.geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                   mesh.triangles.data(), 0, sizeof(mesh::Triangle),
                                   mesh.triangles.size());
    else if (rtcSetNewGeometryBuffer(part.geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                     sizeof(mesh::Triangle), part.numbers.size()) != nullptr)
        fill(part);
    rtcSetGeometryUserData(part.geometry, &part);
    rtcSetGeometryOccludedFilterFunction(part.geometry, keep_blockers);
    rtcSetGeometryIntersectFilterFunction(part.geometry, keep_nearest);
    rtcCommitGeometry(part.geometry);
    rtcAttachGeometry(scene.get(), part.geometry);
    rtcReleaseGeometry(part.geometry); // the scene holds it
}

RayScene::RayScene(const mesh::TriangleMesh& mesh, Packets packets, Groups groups) {
    for (const mesh::Triangle& triangle : mesh.triangles)
        for (const std::uint32_t vertex : triangle)
            for (int axis = 0; axis < 3; ++axis)
                if (const float x = mesh.positions[vertex][axis];
                    !(std::abs(x) < LargestCoordinate))
                    throw std::runtime_error(fmt::format("expected coordinates within {}, got {}",
                                                         LargestCoordinate, x));
    impl_ = std::make_unique<Impl>(mesh, groups);
    if (packets == Packets::Wide)
        impl_->packets = embree::Incoherent;
    rtcCommitScene(impl_->scene.get());
    embree::throw_on_error(impl_->device.get(), "build the ray accelerator");
    if (impl_->mesh.see_through->has_thin())
        impl_->settled = std::make_unique<const Settled>(*impl_);
}

std::vector<std::span<const std::uint32_t>> RayScene::groups() const {
    std::vector<std::span<const std::uint32_t>> result;
    for (const TracedPart& part : impl_->parts)
        if (!impl_->numbers.empty())
            result.push_back(part.numbers);
    return result;
}

void RayScene::follow(const mesh::TriangleMesh& mesh, std::uint32_t group) {
    const TracedPart& part = impl_->parts[group];
    if (part.geometry == nullptr)
        return;
    bool is_other = false;
    for (const std::uint32_t triangle : part.numbers)
        is_other = impl_->mesh.take(mesh, triangle) || is_other;
    if (is_other)
        impl_->find_coplanar();
    impl_->fill(part);
    rtcUpdateGeometryBuffer(part.geometry, RTC_BUFFER_TYPE_INDEX, 0);
    rtcUpdateGeometryBuffer(part.geometry, RTC_BUFFER_TYPE_VERTEX, 0);
    rtcCommitGeometry(part.geometry);
    rtcCommitScene(impl_->scene.get());
    embree::throw_on_error(impl_->device.get(), "build the ray accelerator anew");
}

RayScene::~RayScene() = default;
RayScene::RayScene(RayScene&&) noexcept = default;
RayScene& RayScene::operator=(RayScene&&) noexcept = default;

namespace {

using Valid = std::array<int, PacketSize>;

void fill_rays(const glm::vec3& origin, const DirectionPacket& directions, std::uint32_t active,
               Valid& valid, RTCRay16& rays) {
    for (std::size_t i = 0; i < PacketSize; ++i) {
        valid[i] = (active >> i & 1u) != 0 ? -1 : 0;
        rays.org_x[i] = origin.x;
        rays.org_y[i] = origin.y;
        rays.org_z[i] = origin.z;
        rays.tnear[i] = 0.0f;
        rays.tfar[i] = Infinity;
        rays.time[i] = 0.0f;
        rays.mask[i] = ~0u;
        rays.id[i] = static_cast<unsigned int>(i);
        rays.flags[i] = 0;
    }
    std::memcpy(rays.dir_x, directions.x.data(), sizeof rays.dir_x);
    std::memcpy(rays.dir_y, directions.y.data(), sizeof rays.dir_y);
    std::memcpy(rays.dir_z, directions.z.data(), sizeof rays.dir_z);
}

RTCRay ray_of(const glm::vec3& origin, const glm::vec3& direction) {
    RTCRay ray{};
    ray.org_x = origin.x;
    ray.org_y = origin.y;
    ray.org_z = origin.z;
    ray.dir_x = direction.x;
    ray.dir_y = direction.y;
    ray.dir_z = direction.z;
    ray.tfar = Infinity;
    ray.mask = ~0u;
    return ray;
}

} // namespace

std::uint32_t RayScene::Impl::occluded(const glm::vec3& origin, const DirectionPacket& directions,
                                       std::span<const float, PacketSize> distances,
                                       std::uint32_t active, RayOf of) const {
    alignas(64) Valid valid;
    RTCRay16 rays;
    fill_rays(origin, directions, active, valid, rays);
    std::copy(distances.begin(), distances.end(), rays.tfar);
    Query query(true, of);
    embree::occluded(scene.get(), query.context, packets, valid.data(), rays);

    // Embree marks a blocked ray by tfar = -infinity.
    std::uint32_t blocked = 0;
    for (std::size_t i = 0; i < PacketSize; ++i)
        blocked |= static_cast<std::uint32_t>(rays.tfar[i] < 0.0f) << i;
    for (std::uint32_t rest = query.doubtful & active & ~blocked; rest != 0; rest &= rest - 1) {
        const auto i = static_cast<std::size_t>(std::countr_zero(rest));
        blocked |=
            static_cast<std::uint32_t>(occluded(origin, directions.direction(i), distances[i], of))
            << i;
    }
    return blocked & active;
}

bool RayScene::Impl::occluded(const glm::vec3& origin, const glm::vec3& direction, float distance,
                              RayOf of) const {
    RTCRay ray = ray_of(origin, direction);
    ray.tfar = distance;
    Query query(false, of);
    embree::occluded(scene.get(), query.context, ray);
    return ray.tfar < 0.0f;
}

/// Finds the nearest hit that the query asks for. Returns whether there is one.
bool RayScene::Impl::trace(const glm::vec3& origin, const glm::vec3& direction,
                           Query& query) const {
    RTCRayHit ray{};
    ray.ray = ray_of(origin, direction);
    ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    embree::intersect(scene.get(), query.context, ray);
    return ray.hit.geomID != RTC_INVALID_GEOMETRY_ID;
}

std::uint32_t RayScene::occluded(const glm::vec3& origin, const DirectionPacket& directions,
                                 std::uint32_t active) const {
    return occluded(origin, directions, AllInfinite, active);
}

std::uint32_t RayScene::occluded(const glm::vec3& origin, const DirectionPacket& directions,
                                 std::span<const float, PacketSize> distances,
                                 std::uint32_t active) const {
    return impl_->occluded(origin, directions, distances, active, RayOf::Light);
}

bool RayScene::occluded(const glm::vec3& origin, const glm::vec3& direction, float distance) const {
    return impl_->occluded(origin, direction, distance, RayOf::Light);
}

const Blockers* RayScene::settled() const {
    return impl_->settled.get();
}

bool RayScene::is_thin(std::uint32_t triangle) const {
    return impl_->mesh.see_through->is_thin(triangle);
}

const std::shared_ptr<const SeeThrough>& RayScene::see_through() const {
    return impl_->mesh.see_through;
}

RayScene::Stops RayScene::stops(std::uint32_t triangle) const {
    const SeeThrough& see_through = *impl_->mesh.see_through;
    if (see_through.may_pass(triangle, RayOf::Light))
        return Stops::Somewhere;
    return see_through.is_one_sided(triangle) ? Stops::Front : Stops::BothSides;
}

std::optional<Hit> RayScene::closest_hit(const glm::vec3& origin, const glm::vec3& direction,
                                         RayOf of) const {
    Query query(false, of);
    query.coplanar = impl_->coplanar_for(of);
    Nearest nearest;
    query.nearest = &nearest;
    if (!impl_->trace(origin, direction, query))
        return std::nullopt;
    return hit_of(nearest);
}

void RayScene::crossings(const glm::vec3& from, const glm::vec3& to,
                         std::vector<Crossing>& crossings) const {
    crossings.clear();
    Query query(false, RayOf::SettledLight);
    query.crossings = &crossings;
    RTCRayHit ray{};
    ray.ray = ray_of(from, to - from);
    ray.ray.tfar = 1.0f;
    ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    embree::intersect(impl_->scene.get(), query.context, ray);
}

void RayScene::layers(const glm::vec3& origin, const glm::vec3& direction,
                      std::vector<Layer>& layers) const {
    layers.clear();
    Nearest last;
    while (layers.size() < MostLayers) {
        Query query(false, RayOf::Eye);
        Nearest nearest;
        query.nearest = &nearest;
        query.behind = layers.empty() ? nullptr : &last;
        if (!impl_->trace(origin, direction, query))
            return;
        const Hit hit = hit_of(nearest);
        layers.push_back({hit, impl_->mesh.see_through->veil(hit.triangle, hit.barycentric)});
        if (layers.back().veil.through == glm::vec3(0.0f))
            return;
        last = nearest;
    }
}

std::uint32_t RayScene::closest_hits(const glm::vec3& origin, const DirectionPacket& directions,
                                     std::uint32_t active, std::span<Hit, PacketSize> hits,
                                     RayOf of) const {
    alignas(64) Valid valid;
    RTCRayHit16 rays;
    fill_rays(origin, directions, active, valid, rays.ray);
    std::fill(std::begin(rays.hit.geomID), std::end(rays.hit.geomID), RTC_INVALID_GEOMETRY_ID);
    Query query(true, of);
    query.coplanar = impl_->coplanar_for(of);
    std::array<Nearest, PacketSize> nearest;
    query.nearest = nearest.data();
    embree::intersect(impl_->scene.get(), query.context,
                      are_coherent(directions) ? embree::Coherent : embree::Incoherent,
                      valid.data(), rays);
    std::uint32_t found = 0;
    for (std::size_t i = 0; i < PacketSize; ++i) {
        if ((active >> i & 1u) == 0)
            continue;
        std::optional<Hit> hit;
        if ((query.doubtful >> i & 1u) != 0)
            hit = closest_hit(origin, directions.direction(i), of);
        else if (rays.hit.geomID[i] != RTC_INVALID_GEOMETRY_ID)
            hit = hit_of(nearest[i]);
        if (!hit)
            continue;
        found |= 1u << i;
        hits[i] = *hit;
    }
    return found;
}

} // namespace relumine::prt
