// SPDX-License-Identifier: Apache-2.0
// Private to simulation: the node of a tree of distance fields.
#pragma once

#include <cmath>
#include <memory>

#include "ostraka/simulation/solid.hpp"

namespace ostraka {

/// A field with Lipschitz constant 1.
struct Solid::Node {
    virtual ~Node() = default;
    virtual double distance(const Vec3d& point) const = 0;
    /// A node with bit-identical values inside the ball; `self` if nothing can be dropped.
    virtual std::shared_ptr<const Node> specialized(const std::shared_ptr<const Node>& self,
                                                    const Vec3d& /*center*/,
                                                    double /*radius*/) const {
        return self;
    }
};

/// @throws InvalidInput "<what> must be positive" unless `value` is positive and finite.
void require_positive(double value, const char* what);

}  // namespace ostraka
