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
constexpr float kFar = std::numeric_limits<float>::infinity();
constexpr float kNear = 2e-4F;  // of the way to a point

// One for the whole program: scenes that share meshes must share it. Embree's devices are safe from
// many threads.
RTCDevice shared_device() {
    struct Device {
        RTCDevice handle = rtcNewDevice(nullptr);
        ~Device() { rtcReleaseDevice(handle); }
    };
    static const Device device;
    if (device.handle == nullptr) throw Error("ray caster: Embree can't start on this processor");
    return device.handle;
}

RTCScene new_scene() {
    RTCScene scene = rtcNewScene(shared_device());
    if (scene == nullptr) throw Error("ray caster: out of memory");
    rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
    return scene;
}

void add_geometry(RTCScene scene, const TriangleMesh& mesh) {
    RTCGeometry geometry = rtcNewGeometry(shared_device(), RTC_GEOMETRY_TYPE_TRIANGLE);
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

void add_instance(RTCScene scene, RTCScene model, const Pose& T_world_model) {
    RTCGeometry instance = rtcNewGeometry(shared_device(), RTC_GEOMETRY_TYPE_INSTANCE);
    rtcSetGeometryInstancedScene(instance, model);
    const Eigen::Matrix<float, 3, 4> columns = T_world_model.matrix().topRows<3>().cast<float>();
    rtcSetGeometryTransform(instance, 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, columns.data());
    rtcCommitGeometry(instance);
    rtcAttachGeometry(scene, instance);
    rtcReleaseGeometry(instance);
}

#if OSTRAKA_EMBREE_MAJOR < 4
RTCIntersectContext coherent_rays() {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    return context;
}
#endif

void intersect(RTCScene scene, const int* valid, RTCRayHit8* packet) {
#if OSTRAKA_EMBREE_MAJOR >= 4
    rtcIntersect8(valid, scene, packet, nullptr);
#else
    RTCIntersectContext context = coherent_rays();
    rtcIntersect8(valid, scene, &context, packet);
#endif
}

void occluded(RTCScene scene, const int* valid, RTCRay8* packet) {
#if OSTRAKA_EMBREE_MAJOR >= 4
    rtcOccluded8(valid, scene, packet, nullptr);
#else
    RTCIntersectContext context = coherent_rays();
    rtcOccluded8(valid, scene, &context, packet);
#endif
}

void set_ray(RTCRay8& rays, std::size_t lane, const Vec3f& origin, const Vec3f& direction,
             float near, float far) {
    rays.org_x[lane] = origin.x();
    rays.org_y[lane] = origin.y();
    rays.org_z[lane] = origin.z();
    rays.dir_x[lane] = direction.x();
    rays.dir_y[lane] = direction.y();
    rays.dir_z[lane] = direction.z();
    rays.tnear[lane] = near;
    rays.tfar[lane] = far;
    rays.mask[lane] = 0xffffffffU;
}

// Where the ray meets the triangle's plane, in double precision.
double exact_distance(const TriangleMesh& mesh, std::uint32_t number, const Vec3d& origin,
                      const Vec3d& direction, double approximate) {
    const Triangle& triangle = mesh.triangles[number];
    const Vec3d normal = area_vector(mesh, triangle);
    const double along = normal.dot(direction);
    // Seen edge-on, the plane says nothing: Embree's own value is better.
    if (std::abs(along) < 1e-6 * normal.norm() * direction.norm()) return approximate;
    return normal.dot(mesh.vertices[triangle[0]].cast<double>() - origin) / along;
}

}  // namespace

struct RayModel::Implementation {
    explicit Implementation(TriangleMesh given) : mesh(std::move(given)), scene(new_scene()) {
        add_geometry(scene, mesh);
        rtcCommitScene(scene);
    }
    ~Implementation() { rtcReleaseScene(scene); }
    Implementation(const Implementation&) = delete;
    Implementation& operator=(const Implementation&) = delete;

    TriangleMesh mesh;
    RTCScene scene;
};

RayModel::RayModel(TriangleMesh mesh)
    : implementation_(std::make_shared<const Implementation>(std::move(mesh))) {}

struct RayScene::Implementation {
    explicit Implementation(std::vector<TriangleMesh> all) : meshes(std::move(all)) {
        for (const TriangleMesh& mesh : meshes) add_geometry(scene, mesh);
        rtcCommitScene(scene);
    }
    explicit Implementation(std::vector<PlacedRayModel> all) : models(std::move(all)) {
        for (const PlacedRayModel& placed : models) {
            add_instance(scene, placed.model.implementation_->scene, placed.T_world_model);
            T_model_world.push_back(placed.T_world_model.inverse());
        }
        rtcCommitScene(scene);
    }
    ~Implementation() { rtcReleaseScene(scene); }
    Implementation(const Implementation&) = delete;
    Implementation& operator=(const Implementation&) = delete;

    bool placed() const { return !models.empty(); }
    const TriangleMesh& mesh(std::uint32_t index) const {
        return placed() ? models[index].model.implementation_->mesh : meshes[index];
    }
    double distance(const RayHit& hit, const Vec3d& origin, const Vec3d& direction,
                    double approximate) const {
        if (!placed()) {
            return exact_distance(meshes[hit.mesh], hit.triangle, origin, direction, approximate);
        }
        // A rigid motion keeps the ray's parameter.
        const Pose& T = T_model_world[hit.mesh];
        return exact_distance(mesh(hit.mesh), hit.triangle, T * origin, T.linear() * direction,
                              approximate);
    }

    std::vector<TriangleMesh> meshes;    // in the world frame, or
    std::vector<PlacedRayModel> models;  // placed in it
    std::vector<Pose> T_model_world;     // of the models
    RTCScene scene = new_scene();
};

RayScene::RayScene(std::vector<TriangleMesh> meshes)
    : implementation_(std::make_unique<Implementation>(std::move(meshes))) {}
RayScene::RayScene(std::vector<PlacedRayModel> models)
    : implementation_(std::make_unique<Implementation>(std::move(models))) {}
RayScene::~RayScene() = default;
RayScene::RayScene(RayScene&&) noexcept = default;
RayScene& RayScene::operator=(RayScene&&) noexcept = default;

const TriangleMesh& RayScene::mesh(std::uint32_t index) const {
    return implementation_->mesh(index);
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
            set_ray(packet.ray, lane, start, direction, 0.0F, kFar);
            packet.hit.geomID[lane] = RTC_INVALID_GEOMETRY_ID;
            packet.hit.instID[0][lane] = RTC_INVALID_GEOMETRY_ID;
        }
        intersect(implementation_->scene, valid, &packet);
        for (std::size_t lane = 0; lane < count; ++lane) {
            if (packet.hit.geomID[lane] == RTC_INVALID_GEOMETRY_ID) continue;
            RayHit& hit = hits[first + lane];
            hit.mesh =
                implementation_->placed() ? packet.hit.instID[0][lane] : packet.hit.geomID[lane];
            hit.triangle = packet.hit.primID[lane];
            hit.distance = implementation_->distance(hit, origin, directions[first + lane],
                                                     double{packet.ray.tfar[lane]});
        }
    }
    return hits;
}

std::vector<char> RayScene::hidden(const Vec3d& eye, std::span<const Vec3d> points) const {
    std::vector<char> hidden(points.size(), 0);
    const Vec3f start = eye.cast<float>();
    for (std::size_t first = 0; first < points.size(); first += kPacket) {
        const std::size_t count = std::min(kPacket, points.size() - first);
        alignas(32) int valid[kPacket] = {};
        alignas(32) RTCRay8 packet = {};
        for (std::size_t lane = 0; lane < count; ++lane) {
            valid[lane] = -1;
            const Vec3f direction = (points[first + lane] - eye).cast<float>();
            set_ray(packet, lane, start, direction, kNear, 1.0F - kNear);
        }
        occluded(implementation_->scene, valid, &packet);
        // Embree marks a blocked ray by a far end of minus infinity.
        for (std::size_t lane = 0; lane < count; ++lane) {
            hidden[first + lane] = packet.tfar[lane] < 0.0F ? 1 : 0;
        }
    }
    return hidden;
}

Vec3d RayScene::normal(const RayHit& hit) const {
    const TriangleMesh& mesh = implementation_->mesh(hit.mesh);
    const Vec3d normal = area_vector(mesh, mesh.triangles[hit.triangle]).normalized();
    if (!implementation_->placed()) return normal;
    return implementation_->models[hit.mesh].T_world_model.linear() * normal;
}

}  // namespace ostraka
