// SPDX-License-Identifier: Apache-2.0
// Casts rays against triangle meshes (Embree). No display, no OpenGL.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "ostraka/mesh/triangle_mesh.hpp"

namespace ostraka {

struct RayHit {
    double distance = -1.0;             ///< ray parameter, in lengths of the direction; < 0: no hit
    std::uint32_t mesh = kNoIndex;      ///< number of the mesh, in the order given
    std::uint32_t triangle = kNoIndex;  ///< index into that mesh's triangles
    bool hit() const { return mesh != kNoIndex; }
};

/// A mesh made ready to be placed in many scenes; copies share it.
class RayModel {
  public:
    explicit RayModel(TriangleMesh mesh);

  private:
    friend class RayScene;
    struct Implementation;
    std::shared_ptr<const Implementation> implementation_;
};

struct PlacedRayModel {
    RayModel model;
    Pose T_world_model = Pose::Identity();
};

/// Meshes placed in one world frame. Triangles are found by Embree in single precision; the
/// distance is then worked out in double precision from the triangle's plane. cast() is const and
/// safe from many threads.
class RayScene {
  public:
    explicit RayScene(std::vector<TriangleMesh> meshes);
    /// Made in microseconds: nothing is copied.
    explicit RayScene(std::vector<PlacedRayModel> models);
    ~RayScene();
    RayScene(RayScene&&) noexcept;
    RayScene& operator=(RayScene&&) noexcept;

    /// In its own frame.
    const TriangleMesh& mesh(std::uint32_t index) const;
    /// The nearest hit along each ray. @param directions  any length, not zero.
    /// @return one hit a direction, in their order.
    std::vector<RayHit> cast(const Vec3d& origin, std::span<const Vec3d> directions) const;
    /// For each point whether any mesh lies between it and `eye`. A mesh is let be within 1/5000 of
    /// the way from either end, so that a surface doesn't hide itself. @return 0 or 1 a point.
    std::vector<char> hidden(const Vec3d& eye, std::span<const Vec3d> points) const;
    /// Unit normal of the triangle that was hit, by its winding, in the world frame.
    Vec3d normal(const RayHit& hit) const;

  private:
    struct Implementation;
    std::unique_ptr<Implementation> implementation_;
};

}  // namespace ostraka
