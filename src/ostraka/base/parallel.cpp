// SPDX-License-Identifier: Apache-2.0
#include "ostraka/base/parallel.hpp"

#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_pipeline.h>
#include <tbb/task_arena.h>
#include <tbb/task_group.h>

#include <algorithm>
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

void ordered_pipeline(std::size_t count, std::size_t in_flight,
                      const std::function<void(std::size_t)>& begin,
                      const std::function<void(std::size_t)>& work,
                      const std::function<void(std::size_t)>& end) {
    std::size_t next = 0;
    const auto first = tbb::make_filter<void, std::size_t>(
        tbb::filter_mode::serial_in_order, [&](tbb::flow_control& control) -> std::size_t {
            if (next == count) {
                control.stop();
                return 0;
            }
            begin(next);
            return next++;
        });
    const auto middle =
        tbb::make_filter<std::size_t, std::size_t>(tbb::filter_mode::parallel, [&](std::size_t i) {
            work(i);
            return i;
        });
    const auto last = tbb::make_filter<std::size_t, void>(tbb::filter_mode::serial_in_order,
                                                          [&](std::size_t i) { end(i); });
    tbb::task_group_context context(tbb::task_group_context::isolated);
    tbb::parallel_pipeline(in_flight, first & middle & last, context);
}

std::size_t thread_count() {
    const std::size_t allowed =
        tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism);
    return std::min(allowed, static_cast<std::size_t>(tbb::this_task_arena::max_concurrency()));
}

}  // namespace ostraka
