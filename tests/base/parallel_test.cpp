// SPDX-License-Identifier: Apache-2.0
#include "ostraka/base/parallel.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <mutex>
#include <set>
#include <stdexcept>
#include <thread>
#include <vector>

#include "ostraka/base/error.hpp"

namespace ostraka {
namespace {

class Parallel : public testing::Test {
  protected:
    ~Parallel() override { set_thread_count(0); }

    // Threads that took part in a loop of items long enough for all of them to join in.
    static std::size_t threads_used() {
        std::mutex mutex;
        std::set<std::thread::id> threads;
        parallel_for(200, [&](std::size_t) {
            std::this_thread::sleep_for(std::chrono::microseconds(100));
            const std::scoped_lock lock(mutex);
            threads.insert(std::this_thread::get_id());
        });
        return threads.size();
    }
};

TEST_F(Parallel, VisitsEveryIndexOnce) {
    for (const int threads : {1, 2, 5, 0}) {
        set_thread_count(threads);
        for (const std::size_t count : {0U, 1U, 2U, 7U, 10'000U}) {
            for (const std::size_t grain : {1U, 3U, 512U, 20'000U}) {
                std::vector<std::atomic<int>> visits(count);
                parallel_for(
                    count, [&](std::size_t i) { ++visits.at(i); }, grain);
                for (const auto& times : visits) ASSERT_EQ(times, 1);
            }
        }
    }
}

TEST_F(Parallel, HandsOnAnExceptionAndStaysUsable) {
    for (const int threads : {1, 4}) {
        set_thread_count(threads);
        const auto body = [](std::size_t i) {
            if (i == 77) throw InvalidInput("item 77");
        };
        try {
            parallel_for(100, body);
            FAIL() << "no exception";
        } catch (const InvalidInput& error) {
            EXPECT_STREQ(error.what(), "item 77");
        }
        std::atomic<int> visits = 0;
        parallel_for(100, [&](std::size_t) { ++visits; });
        EXPECT_EQ(visits, 100);
    }
}

TEST_F(Parallel, UsesNoMoreThreadsThanAllowed) {
    for (const std::size_t threads : {1U, 2U}) {
        set_thread_count(static_cast<int>(threads));
        EXPECT_LE(threads_used(), threads);
    }
}

TEST_F(Parallel, OneThreadIsTheCallersOwn) {
    set_thread_count(1);
    const std::thread::id caller = std::this_thread::get_id();
    std::atomic<int> elsewhere = 0;
    parallel_for(1000, [&](std::size_t) {
        if (std::this_thread::get_id() != caller) ++elsewhere;
    });
    EXPECT_EQ(elsewhere, 0);
}

TEST_F(Parallel, LoopsNest) {
    std::vector<std::vector<int>> table(50, std::vector<int>(40, 0));
    parallel_for(50, [&](std::size_t i) {
        parallel_for(40, [&, i](std::size_t j) { table[i][j] += static_cast<int>(100 * i + j); });
    });
    for (std::size_t i = 0; i < 50; ++i) {
        for (std::size_t j = 0; j < 40; ++j) {
            ASSERT_EQ(table[i][j], static_cast<int>(100 * i + j));
        }
    }
}

// An inner loop that came back early would leave slots empty that its caller then reads.
TEST_F(Parallel, AnExceptionInOneItemLeavesTheInnerLoopsOfOthersWhole) {
    set_thread_count(2);
    std::atomic<bool> inside = false;
    std::atomic<bool> thrown = false;
    std::atomic<int> visits = 0;
    std::atomic<int> visits_on_return = -1;
    const auto wait_for = [](const std::atomic<bool>& flag) {
        for (int i = 0; i < 2000 && !flag; ++i) {
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
        }
    };
    const auto body = [&](std::size_t i) {
        if (i == 0) {
            wait_for(inside);
            thrown = true;
            throw InvalidInput("item 0");
        }
        parallel_for(200, [&](std::size_t j) {
            inside = true;
            if (j < 2) wait_for(thrown);
            std::this_thread::sleep_for(std::chrono::microseconds(200));
            ++visits;
        });
        visits_on_return = visits.load();
    };
    EXPECT_THROW(parallel_for(2, body), InvalidInput);
    if (visits_on_return >= 0) {
        EXPECT_EQ(visits_on_return, 200);
    }
}

TEST_F(Parallel, ThePipelineKeepsOrderAndItsBound) {
    for (const int threads : {1, 2, 4}) {
        set_thread_count(threads);
        std::vector<int> state(200, 0);
        std::atomic<int> in_flight = 0;
        std::size_t begun = 0;
        std::size_t ended = 0;
        ordered_pipeline(
            state.size(), 3,
            [&](std::size_t i) {
                EXPECT_EQ(i, begun++);
                EXPECT_LE(++in_flight, 3);
                state[i] = 1;
            },
            [&](std::size_t i) {
                EXPECT_EQ(state[i], 1);
                parallel_for(4, [&](std::size_t) {});
                state[i] = 2;
            },
            [&](std::size_t i) {
                EXPECT_EQ(i, ended++);
                EXPECT_EQ(state[i], 2);
                --in_flight;
            });
        EXPECT_EQ(ended, state.size());
    }
}

TEST_F(Parallel, ThePipelineHandsOnExceptionsOfEveryStage) {
    const auto nothing = [](std::size_t) {};
    const auto fail = [](std::size_t i) {
        if (i == 5) throw InvalidInput("item 5");
    };
    std::size_t ended = 0;
    const auto count = [&](std::size_t) { ++ended; };
    EXPECT_THROW(ordered_pipeline(20, 2, fail, nothing, count), InvalidInput);
    EXPECT_THROW(ordered_pipeline(20, 2, nothing, fail, nothing), InvalidInput);
    EXPECT_THROW(ordered_pipeline(20, 2, nothing, nothing, fail), InvalidInput);
    EXPECT_LE(ended, 5U);
    ordered_pipeline(0, 2, fail, fail, fail);
}

}  // namespace
}  // namespace ostraka
