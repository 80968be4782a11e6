// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>

namespace ostraka {

/// Wall time since construction or the last lap, in seconds.
class Stopwatch {
  public:
    double seconds() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }
    /// Seconds since the start, which is then set to now.
    double lap() {
        const double elapsed = seconds();
        start_ = Clock::now();
        return elapsed;
    }

  private:
    using Clock = std::chrono::steady_clock;
    Clock::time_point start_ = Clock::now();
};

}  // namespace ostraka
