// SPDX-License-Identifier: Apache-2.0
// The one header that owns threading. Work is split by item and every item writes its own slot, so
// results are the same bits for any number of threads.
#pragma once

#include <cstddef>
#include <functional>

namespace ostraka {

/// Upper limit of threads used by parallel_for() from now on; 0 means all cores. Set at the edge
/// (command line, Python) only.
void set_thread_count(int count);

/// Calls body(i) once for every i in [0, count), on any thread and in any order. The body must
/// write only what belongs to item i. An exception in a body is rethrown here.
/// @param grain  items that one thread takes at a time, where single items are tiny.
void parallel_for(std::size_t count, const std::function<void(std::size_t)>& body,
                  std::size_t grain = 1);

/// A bounded assembly line: begin(i) one after another in order, work(i) on any threads at once,
/// end(i) one after another in order. At most `in_flight` items are begun and not yet ended, so
/// memory is bounded whatever the count. Exceptions are rethrown here; what was ended stays ended.
void ordered_pipeline(std::size_t count, std::size_t in_flight,
                      const std::function<void(std::size_t)>& begin,
                      const std::function<void(std::size_t)>& work,
                      const std::function<void(std::size_t)>& end);

/// Threads that parallel_for() may use now.
std::size_t thread_count();

}  // namespace ostraka
