// SPDX-License-Identifier: Apache-2.0
#include "ostraka/base/parallel.hpp"

#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>
#include <tbb/task_group.h>

#include <memory>
#include <mutex>

namespace ostraka {

void set_thread_count(int count) {
    static std::mutex mutex;
    static std::unique_ptr<tbb::global_control> control;
    const std::scoped_lock lock(mutex);
    control.reset();
    if (count > 0) {
        control = std::make_unique<tbb::global_control>(
            tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(count));
    }
}

void parallel_for(std::size_t count, const std::function<void(std::size_t)>& body,
                  std::size_t grain) {
    // Isolated: a thread that waits here for an inner loop doesn't start another item of an outer
    // one, which would pile up memory and break thread-local scratch space.
    tbb::this_task_arena::isolate([&] {
        // A context of its own: an exception in an outer loop would otherwise cancel this one,
        // which would return as if it were done, with items left out.
        tbb::task_group_context context(tbb::task_group_context::isolated);
        tbb::parallel_for(
            tbb::blocked_range<std::size_t>(0, count, grain),
            [&](const tbb::blocked_range<std::size_t>& range) {
                for (std::size_t i = range.begin(); i != range.end(); ++i) body(i);
            },
            context);
    });
}

}  // namespace ostraka
