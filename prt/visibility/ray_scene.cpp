#include "prt/visibility/ray_scene.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

#include <embree3/rtcore.h>
#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "prt/visibility/half_line.h"

namespace relumine::prt {

namespace {

constexpr float Infinity = std::numeric_limits<float>::infinity();

struct DeviceDeleter {
    void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
};
struct SceneDeleter {
    void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
};
using DeviceHandle = std::unique_ptr<std::remove_pointer_t<RTCDevice>, DeviceDeleter>;
using SceneHandle = std::unique_ptr<std::remove_pointer_t<RTCScene>, SceneDeleter>;

void throw_on_error(RTCDevice device, const char* action) {
    const RTCError error = rtcGetDeviceError(device);
    if (error != RTC_ERROR_NONE)
        throw std::runtime_error(
            fmt::format("Embree could not {} (error {})", action, static_cast<int>(error)));
}

/// Whether the corners lie on one line. Exact unless coordinates differ by more than a factor of
/// 2^28.
bool has_no_area(const mesh::TriangleMesh& mesh, const mesh::Triangle& triangle) {
    const glm::dvec3 corner(mesh.positions[triangle[0]]);
    return glm::cross(glm::dvec3(mesh.positions[triangle[1]]) - corner,
                      glm::dvec3(mesh.positions[triangle[2]]) - corner) == glm::dvec3(0.0);
}

/// Copies an array into a geometry buffer, padded as Embree's kernels need it. Returns the buffer.
template<typename Element>
const Element* fill_buffer(RTCGeometry geometry, RTCBufferType type, RTCFormat format,
                           const std::vector<Element>& elements) {
    void* buffer =
        rtcSetNewGeometryBuffer(geometry, type, 0, format, sizeof(Element), elements.size());
    if (buffer != nullptr && !elements.empty())
        std::memcpy(buffer, elements.data(), elements.size() * sizeof(Element));
    return static_cast<const Element*>(buffer);
}

/// Embree's copy of a mesh.
struct Buffers {
    const glm::vec3* positions = nullptr;
    const mesh::Triangle* triangles = nullptr;
};

/// Drops hits that lie beside their triangle.
///
/// Embree moves corners by a rounding of their distance d. Where a ray runs along a triangle's
/// plane it compares noise with noise. It then finds hits far beside the triangle, up to the boxes
/// of its tree. Such a hit would be a shadow that nothing casts. The remaining hits are no farther
/// off than a ray's own rounding.
void drop_hits_beside(const RTCFilterFunctionNArguments* hits) {
    constexpr double Roundings = 16.0 * 0x1p-24;
    const auto& buffers = *static_cast<const Buffers*>(hits->geometryUserPtr);
    for (unsigned int i = 0; i < hits->N; ++i) {
        if (hits->valid[i] == 0)
            continue;
        const glm::dvec3 origin(RTCRayN_org_x(hits->ray, hits->N, i),
                                RTCRayN_org_y(hits->ray, hits->N, i),
                                RTCRayN_org_z(hits->ray, hits->N, i));
        const glm::dvec3 direction(RTCRayN_dir_x(hits->ray, hits->N, i),
                                   RTCRayN_dir_y(hits->ray, hits->N, i),
                                   RTCRayN_dir_z(hits->ray, hits->N, i));
        const mesh::Triangle& triangle = buffers.triangles[RTCHitN_primID(hits->hit, hits->N, i)];
        std::array<glm::dvec3, 3> corners;
        for (std::size_t k = 0; k < 3; ++k)
            corners[k] = glm::dvec3(buffers.positions[triangle[k]]) - origin;
        if (meets(corners, direction)) // as nearly all do
            continue;
        double squared_distance = 0.0;
        for (const glm::dvec3& corner : corners)
            squared_distance = std::max(squared_distance, glm::dot(corner, corner));
        if (passes_by(corners, glm::normalize(direction), Roundings * std::sqrt(squared_distance)))
            hits->valid[i] = 0;
    }
}

} // namespace

struct RayScene::Impl {
    /// Embree holds its address.
    Buffers buffers;
    DeviceHandle device;
    SceneHandle scene;
    RTCIntersectContextFlags packets = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
};

RayScene::RayScene(const mesh::TriangleMesh& mesh, Packets packets)
    : impl_(std::make_unique<Impl>()) {
    if (packets == Packets::Wide)
        impl_->packets = RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
    for (const mesh::Triangle& triangle : mesh.triangles)
        for (const std::uint32_t vertex : triangle)
            for (int axis = 0; axis < 3; ++axis)
                if (const float x = mesh.positions[vertex][axis];
                    !(std::abs(x) < LargestCoordinate))
                    throw std::runtime_error(fmt::format("expected coordinates within {}, got {}",
                                                         LargestCoordinate, x));
    impl_->device.reset(rtcNewDevice(nullptr));
    if (!impl_->device)
        throw std::runtime_error("Embree could not start on this processor");
    RTCDevice device = impl_->device.get();
    impl_->scene.reset(rtcNewScene(device));
    rtcSetSceneFlags(impl_->scene.get(), RTC_SCENE_FLAG_ROBUST);

    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    // A triangle without area blocks nothing. But Embree's edge functions are all zero for it, and
    // say "hit" to rays that pass beside it in a plane with it. It gets a corner that is not a
    // number, so Embree drops it. The other triangles keep their numbers.
    std::vector<glm::vec3> positions = mesh.positions;
    std::vector<mesh::Triangle> triangles = mesh.triangles;
    const auto nowhere = static_cast<std::uint32_t>(positions.size());
    positions.emplace_back(std::numeric_limits<float>::quiet_NaN());
    for (mesh::Triangle& triangle : triangles)
        if (has_no_area(mesh, triangle))
            triangle = {nowhere, nowhere, nowhere};
    impl_->buffers = {
        .positions = fill_buffer(geometry, RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT3, positions),
        .triangles = fill_buffer(geometry, RTC_BUFFER_TYPE_INDEX, RTC_FORMAT_UINT3, triangles)};
    rtcSetGeometryUserData(geometry, &impl_->buffers);
    rtcSetGeometryOccludedFilterFunction(geometry, drop_hits_beside);
    rtcSetGeometryIntersectFilterFunction(geometry, drop_hits_beside);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(impl_->scene.get(), geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(impl_->scene.get());
    throw_on_error(device, "build the ray accelerator");
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
        rays.flags[i] = 0;
    }
    std::memcpy(rays.dir_x, directions.x.data(), sizeof rays.dir_x);
    std::memcpy(rays.dir_y, directions.y.data(), sizeof rays.dir_y);
    std::memcpy(rays.dir_z, directions.z.data(), sizeof rays.dir_z);
}

} // namespace

std::uint32_t RayScene::occluded(const glm::vec3& origin, const DirectionPacket& directions,
                                 std::uint32_t active) const {
    alignas(64) Valid valid;
    RTCRay16 rays;
    fill_rays(origin, directions, active, valid, rays);
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = impl_->packets;
    rtcOccluded16(valid.data(), impl_->scene.get(), &context, &rays);

    // Embree marks a blocked ray by tfar = -infinity.
    std::uint32_t blocked = 0;
    for (std::size_t i = 0; i < PacketSize; ++i)
        blocked |= static_cast<std::uint32_t>(rays.tfar[i] < 0.0f) << i;
    return blocked & active;
}

bool RayScene::occluded(const glm::vec3& origin, const glm::vec3& direction) const {
    RTCRay ray{};
    ray.org_x = origin.x;
    ray.org_y = origin.y;
    ray.org_z = origin.z;
    ray.dir_x = direction.x;
    ray.dir_y = direction.y;
    ray.dir_z = direction.z;
    ray.tfar = Infinity;
    ray.mask = ~0u;
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcOccluded1(impl_->scene.get(), &context, &ray);
    return ray.tfar < 0.0f;
}

std::optional<Hit> RayScene::closest_hit(const glm::vec3& origin,
                                         const glm::vec3& direction) const {
    RTCRayHit query{};
    query.ray.org_x = origin.x;
    query.ray.org_y = origin.y;
    query.ray.org_z = origin.z;
    query.ray.dir_x = direction.x;
    query.ray.dir_y = direction.y;
    query.ray.dir_z = direction.z;
    query.ray.tfar = Infinity;
    query.ray.mask = ~0u;
    query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcIntersect1(impl_->scene.get(), &context, &query);
    if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID)
        return std::nullopt;
    return Hit{.triangle = query.hit.primID,
               .barycentric = {query.hit.u, query.hit.v},
               .distance = query.ray.tfar};
}

std::uint32_t RayScene::closest_hits(const glm::vec3& origin, const DirectionPacket& directions,
                                     std::uint32_t active, std::span<Hit, PacketSize> hits) const {
    alignas(64) Valid valid;
    RTCRayHit16 query;
    fill_rays(origin, directions, active, valid, query.ray);
    std::fill(std::begin(query.hit.geomID), std::end(query.hit.geomID), RTC_INVALID_GEOMETRY_ID);
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    rtcIntersect16(valid.data(), impl_->scene.get(), &context, &query);
    std::uint32_t found = 0;
    for (std::size_t i = 0; i < PacketSize; ++i) {
        if ((active >> i & 1u) == 0 || query.hit.geomID[i] == RTC_INVALID_GEOMETRY_ID)
            continue;
        found |= 1u << i;
        hits[i] = {.triangle = query.hit.primID[i],
                   .barycentric = {query.hit.u[i], query.hit.v[i]},
                   .distance = query.ray.tfar[i]};
    }
    return found;
}

float automatic_bias(const mesh::TriangleMesh& blockers) {
    const mesh::Bounds bounds = mesh::bounds(blockers);
    float largest = 0.0f;
    for (int axis = 0; axis < 3; ++axis)
        largest = std::max({largest, std::abs(bounds.min[axis]), std::abs(bounds.max[axis])});
    // A sum is rounded by up to half a spacing on each axis. The other half of the four is for the
    // triangles' own rounding.
    return std::max(1e-4f * bounds.diagonal(),
                    4.0f * std::numeric_limits<float>::epsilon() * largest);
}

} // namespace relumine::prt
