// SPDX-License-Identifier: Apache-2.0
#include "ostraka/views/ray_scene.hpp"

#if OSTRAKA_EMBREE_MAJOR >= 4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include <cmath>
#include <limits>

#include "ostraka/base/error.hpp"

namespace ostraka {
namespace {

constexpr std::size_t kPacket = 8;

void add_geometry(RTCDevice device, RTCScene scene, const TriangleMesh& mesh) {
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    // Embree owns the buffers: it may read 4 bytes past the last vertex and pads for that itself.
    auto* vertices = static_cast<float*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                3 * sizeof(float), mesh.vertices.size()));
    auto* indices = static_cast<unsigned*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                3 * sizeof(unsigned), mesh.triangles.size()));
    if (vertices == nullptr || indices == nullptr) throw Error("ray caster: out of memory");
    for (const Vec3f& vertex : mesh.vertices) {
        for (int axis = 0; axis < 3; ++axis) *vertices++ = vertex[axis];
    }
    for (const Triangle& triangle : mesh.triangles) {
        for (const std::uint32_t vertex : triangle) *indices++ = vertex;
    }
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene, geometry);
    rtcReleaseGeometry(geometry);
}

void intersect(RTCScene scene, const int* valid, RTCRayHit8* packet) {
#if OSTRAKA_EMBREE_MAJOR >= 4
    rtcIntersect8(valid, scene, packet, nullptr);
#else
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    rtcIntersect8(valid, scene, &context, packet);
#endif
}

}  // namespace

struct RayScene::Implementation {
    explicit Implementation(std::vector<TriangleMesh> all)
        : meshes(std::move(all)), device(rtcNewDevice(nullptr)) {
        if (device == nullptr) throw Error("ray caster: Embree can't start on this processor");
        scene = rtcNewScene(device);
        rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
        for (const TriangleMesh& mesh : meshes) add_geometry(device, scene, mesh);
        rtcCommitScene(scene);
    }
    ~Implementation() {
        rtcReleaseScene(scene);
        rtcReleaseDevice(device);
    }
    Implementation(const Implementation&) = delete;
    Implementation& operator=(const Implementation&) = delete;

    double exact_distance(const RayHit& hit, const Vec3d& origin, const Vec3d& direction,
                          double approximate) const {
        const TriangleMesh& mesh = meshes[hit.mesh];
        const Triangle& triangle = mesh.triangles[hit.triangle];
        const Vec3d normal = area_vector(mesh, triangle);
        const double along = normal.dot(direction);
        // Seen edge-on, the plane says nothing: Embree's own value is better.
        if (std::abs(along) < 1e-6 * normal.norm() * direction.norm()) return approximate;
        return normal.dot(mesh.vertices[triangle[0]].cast<double>() - origin) / along;
    }

    std::vector<TriangleMesh> meshes;
    RTCDevice device;
    RTCScene scene = nullptr;
};

RayScene::RayScene(std::vector<TriangleMesh> meshes)
    : implementation_(std::make_unique<Implementation>(std::move(meshes))) {}
RayScene::~RayScene() = default;
RayScene::RayScene(RayScene&&) noexcept = default;
RayScene& RayScene::operator=(RayScene&&) noexcept = default;

const TriangleMesh& RayScene::mesh(std::uint32_t index) const {
    return implementation_->meshes[index];
}

std::vector<RayHit> RayScene::cast(const Vec3d& origin, std::span<const Vec3d> directions) const {
    std::vector<RayHit> hits(directions.size());
    const Vec3f start = origin.cast<float>();
    for (std::size_t first = 0; first < directions.size(); first += kPacket) {
        const std::size_t count = std::min(kPacket, directions.size() - first);
        alignas(32) int valid[kPacket] = {};
        alignas(32) RTCRayHit8 packet = {};
        for (std::size_t lane = 0; lane < count; ++lane) {
            valid[lane] = -1;
            const Vec3f direction = directions[first + lane].cast<float>();
            packet.ray.org_x[lane] = start.x();
            packet.ray.org_y[lane] = start.y();
            packet.ray.org_z[lane] = start.z();
            packet.ray.dir_x[lane] = direction.x();
            packet.ray.dir_y[lane] = direction.y();
            packet.ray.dir_z[lane] = direction.z();
            packet.ray.tfar[lane] = std::numeric_limits<float>::infinity();
            packet.ray.mask[lane] = 0xffffffffU;
            packet.hit.geomID[lane] = RTC_INVALID_GEOMETRY_ID;
        }
        intersect(implementation_->scene, valid, &packet);
        for (std::size_t lane = 0; lane < count; ++lane) {
            if (packet.hit.geomID[lane] == RTC_INVALID_GEOMETRY_ID) continue;
            RayHit& hit = hits[first + lane];
            hit.mesh = packet.hit.geomID[lane];
            hit.triangle = packet.hit.primID[lane];
            hit.distance = implementation_->exact_distance(hit, origin, directions[first + lane],
                                                           double{packet.ray.tfar[lane]});
        }
    }
    return hits;
}

Vec3d RayScene::normal(const RayHit& hit) const {
    const TriangleMesh& mesh = implementation_->meshes[hit.mesh];
    return area_vector(mesh, mesh.triangles[hit.triangle]).normalized();
}

}  // namespace ostraka
