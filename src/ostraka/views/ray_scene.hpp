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

/// Meshes placed in one world frame. Triangles are found by Embree in single precision; the
/// distance is then worked out in double precision from the triangle's plane. cast() is const and
/// safe from many threads.
class RayScene {
  public:
    explicit RayScene(std::vector<TriangleMesh> meshes);
    ~RayScene();
    RayScene(RayScene&&) noexcept;
    RayScene& operator=(RayScene&&) noexcept;

    const TriangleMesh& mesh(std::uint32_t index) const;
    /// The nearest hit along each ray. @param directions  any length, not zero.
    /// @return one hit a direction, in their order.
    std::vector<RayHit> cast(const Vec3d& origin, std::span<const Vec3d> directions) const;
    /// Unit normal of the triangle that was hit, by its winding, in the world frame.
    Vec3d normal(const RayHit& hit) const;

  private:
    struct Implementation;
    std::unique_ptr<Implementation> implementation_;
};

}  // namespace ostraka
