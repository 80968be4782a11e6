// SPDX-License-Identifier: Apache-2.0
#include "ostraka/evaluation/run.hpp"

#include <gtest/gtest.h>

#include "evaluation/evaluation_testing.hpp"
#include "io/io_testing.hpp"
#include "ostraka/base/error.hpp"
#include "ostraka/base/parallel.hpp"
#include "ostraka/evaluation/record_text.hpp"

namespace ostraka {
namespace {

using namespace evaluation_testing;
using namespace io_testing;

constexpr std::size_t kScenes = 4;

TestSet random_views() {
    RandomViewSettings recipe;
    recipe.camera = small_camera(160);
    recipe.sensor.ranging.noise = 0.2;
    recipe.seed = 3;
    return simulated_set(small_library(), recipe, kScenes);
}

TestSet tabletops() {
    TabletopScenes recipe{{.objects = 2, .camera = small_camera(160), .seed = 4},
                          ModelChoice::in_turns};
    return simulated_set(small_library(), recipe, kScenes);
}

std::string trials_text(Journal& journal, const TestSet& set) {
    const EntryIndex index(small_library());
    const std::vector<const EntryIndex*> indices = {&index, &index};
    const auto trials = run_segments(indices, set, {.ks = {1, 3}}, journal);
    EXPECT_EQ(trials.size(), 2U);
    EXPECT_GT(trials.at(0).size(), 2U);
    EXPECT_EQ(to_text({trials.at(0)}), to_text({trials.at(1)}));
    return to_text(trials);
}

std::string records_text(Journal& journal, const TestSet& set) {
    const Recognizer recognizer(small_library());
    SceneSettings settings;
    settings.vsd = true;
    settings.recognition.min_confidence = 0.05;
    std::string text;
    std::size_t reports = 0;
    for (SceneRecord& record : run_scenes(recognizer, small_library(), set, settings, journal)) {
        EXPECT_FALSE(record.seconds.empty());
        record.seconds.clear();  // all that may differ
        reports += record.reports.size();
        text += to_text(record) + "\n";
    }
    EXPECT_GT(reports, 0U);
    return text;
}

template <class Run>
void expect_same_for_one_and_two_threads(const Run& run, const TestSet& set) {
    Journal none("", "");
    set_thread_count(1);
    const std::string one = run(none, set);
    set_thread_count(2);
    const std::string two = run(none, set);
    set_thread_count(0);
    EXPECT_EQ(one, two);
}

// Stops in the middle, as a power cut would: half of the lines, the last of them cut.
template <class Run>
void expect_resumes(const Run& run, const TestSet& set) {
    const TestFolder folder;
    std::string first;
    {
        Journal journal(folder / "journal", "key");
        first = run(journal, set);
    }
    const std::string whole = load_text(folder / "journal");
    ASSERT_EQ(std::count(whole.begin(), whole.end(), '\n'), kScenes);
    const std::size_t second_line = whole.find('\n', whole.find('\n') + 1) + 1;
    save(folder / "journal", whole.substr(0, second_line + 20));
    // Scenes that are known already are not even loaded.
    TestSet counting = set;
    std::size_t loads = 0;
    counting.load = [&](std::size_t i) {
        ++loads;
        return set.load(i);
    };
    set_thread_count(1);
    {
        Journal journal(folder / "journal", "key");
        EXPECT_EQ(journal.size(), 2U);
        EXPECT_EQ(run(journal, counting), first);
    }
    EXPECT_EQ(loads, kScenes - 2);
    Journal complete(folder / "journal", "key");
    EXPECT_EQ(run(complete, counting), first);
    EXPECT_EQ(loads, kScenes - 2);
    set_thread_count(0);
}

TEST(RunSegments, IsTheSameForAnyNumberOfThreads) {
    expect_same_for_one_and_two_threads(trials_text, random_views());
}

TEST(RunSegments, GoesOnFromAJournal) {
    expect_resumes(trials_text, random_views());
}

TEST(RunScenes, IsTheSameForAnyNumberOfThreads) {
    expect_same_for_one_and_two_threads(records_text, tabletops());
}

TEST(RunScenes, GoesOnFromAJournal) {
    expect_resumes(records_text, tabletops());
}

TEST(RunScenes, ReportsProgress) {
    const Recognizer recognizer(small_library());
    Journal none("", "");
    TestSet set = tabletops();
    set.count = 2;
    std::vector<std::size_t> done;
    run_scenes(recognizer, small_library(), set, {}, none,
               [&](std::string_view, std::size_t number, std::size_t of) {
                   EXPECT_EQ(of, 2U);
                   done.push_back(number);
                   return true;
               });
    EXPECT_EQ(done, (std::vector<std::size_t>{1, 2}));
}

TEST(RunSegments, RefusesLibrariesOfOtherModels) {
    ModelLibrary other = small_library();
    other.models[1].name = "something else";
    ModelLibrary fewer = small_library();
    fewer.settings.unit = Unit::meter;
    const EntryIndex index(small_library());
    const EntryIndex of_other(other);
    const EntryIndex of_meters(fewer);
    Journal none("", "");
    EXPECT_THROW(run_segments(std::vector{&index, &of_other}, random_views(), {}, none),
                 InvalidInput);
    EXPECT_THROW(run_segments(std::vector{&index, &of_meters}, random_views(), {}, none),
                 InvalidInput);
}

TEST(RunSegments, RefusesAJournalOfOtherLibraries) {
    const TestFolder folder;
    const EntryIndex index(small_library());
    {
        Journal journal(folder / "journal", "key");
        run_segments(std::vector{&index}, random_views(), {}, journal);
    }
    Journal journal(folder / "journal", "key");
    EXPECT_THROW(run_segments(std::vector{&index, &index}, random_views(), {}, journal),
                 InvalidInput);
}

}  // namespace
}  // namespace ostraka
