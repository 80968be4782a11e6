// SPDX-License-Identifier: Apache-2.0
#include "ostraka/library/edit.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>

#include "ostraka/base/error.hpp"
#include "ostraka/base/parallel.hpp"
#include "ostraka/io/file_lock.hpp"
#include "ostraka/library/bags.hpp"
#include "ostraka/library/build.hpp"
#include "ostraka/library/build_file.hpp"
#include "ostraka/library/library_file.hpp"
#include "support/simple_models.hpp"

namespace ostraka {
namespace {

namespace fs = std::filesystem;

std::string bytes_of(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

std::string dump_of(const fs::path& path) {
    std::ostringstream out;
    dump_library(path, out);
    return out.str();
}

class Edit : public ::testing::Test {
  protected:
    Edit() : folder_(fs::temp_directory_path() / ("ostraka_edit_" + std::to_string(getpid()))) {
        fs::create_directories(folder_);
        models_ = testing::simple_models();
        settings_ = testing::quick_settings();
        if (settings_.sampling == 0.0) settings_.sampling = default_sampling(inputs({0, 1}));
        settings_ = complete_settings(settings_);
    }
    ~Edit() override { fs::remove_all(folder_); }

    std::vector<ModelInput> inputs(std::initializer_list<std::size_t> numbers) const {
        std::vector<ModelInput> chosen;
        for (const std::size_t m : numbers) chosen.push_back(model_input(models_[m]));
        return chosen;
    }
    fs::path build(const char* name, std::initializer_list<std::size_t> numbers,
                   bool bags = false) const {
        build_library_file(inputs(numbers), settings_, folder_ / name, bags);
        return folder_ / name;
    }
    std::string name(std::size_t model) const { return models_[model].name; }

    fs::path folder_;
    std::vector<ModelSource> models_;
    LibrarySettings settings_;
};

TEST_F(Edit, MergingGivesTheBytesOfBuildingAtOnce) {
    const fs::path both = build("both", {0, 1});
    const std::vector<fs::path> parts = {build("second", {1}), build("first", {0})};
    merge_libraries(parts, folder_ / "merged");
    EXPECT_EQ(bytes_of(folder_ / "merged"), bytes_of(both));
    save_library(build_library(models_, settings_), folder_ / "in_memory");
    EXPECT_EQ(bytes_of(folder_ / "in_memory"), bytes_of(both));
}

TEST_F(Edit, AddingGivesTheContentOfBuildingAtOnce) {
    const fs::path both = build("both", {0, 1});
    const fs::path grown = build("grown", {1});
    EXPECT_NE(dump_of(grown), dump_of(both));
    const AddOutcome outcome = add_models(grown, inputs({0}));
    EXPECT_EQ(outcome.added, 1U);
    EXPECT_EQ(dump_of(grown), dump_of(both));
    EXPECT_EQ(verify_library(grown).sha256, verify_library(both).sha256);
    // These models come from memory, so that nobody can tell that they are the same.
    EXPECT_THROW(add_models(grown, inputs({0})), InvalidInput);
}

TEST_F(Edit, RemovingUndoesAdding) {
    const fs::path first = build("first", {0});
    const fs::path both = build("both", {0, 1});
    remove_models(both, std::vector{name(1)});
    EXPECT_EQ(dump_of(both), dump_of(first));
    EXPECT_THROW(remove_models(both, std::vector<std::string>{"no such model"}), InvalidInput);
    EXPECT_THROW(remove_models(both, std::vector{name(0)}), InvalidInput);
    EXPECT_EQ(dump_of(both), dump_of(first));
}

TEST_F(Edit, RenamingMovesAModelToItsPlaceAndBack) {
    const fs::path both = build("both", {0, 1});
    const std::string before = dump_of(both);
    rename_model(both, name(0), "zzz");
    const ModelLibrary renamed = load_library(both);
    EXPECT_EQ(renamed.models.back().name, "zzz");
    EXPECT_EQ(renamed.entries.back().model, 1U);
    rename_model(both, "zzz", name(0));
    EXPECT_EQ(dump_of(both), before);
    EXPECT_THROW(rename_model(both, name(0), name(1)), InvalidInput);
    EXPECT_THROW(rename_model(both, name(0), ""), InvalidInput);
    EXPECT_THROW(rename_model(both, "no such model", "a"), InvalidInput);
    EXPECT_EQ(dump_of(both), before);
}

TEST_F(Edit, BagsOfWordsAreMadeAnewWhereTheFirstLibraryHasThem) {
    const ModelLibrary at_once = load_library(build("both", {0, 1}, true));
    const fs::path first = build("first", {0}, true);
    const fs::path second = build("second", {1});
    merge_libraries(std::vector{first, second}, folder_ / "merged");
    EXPECT_EQ(bytes_of(folder_ / "merged"), bytes_of(folder_ / "both"));
    merge_libraries(std::vector{second, first}, folder_ / "without");
    EXPECT_EQ(load_library(folder_ / "without").codebook.size(), 0U);

    const ModelLibrary alone = load_library(first);
    add_models(first, inputs({1}));
    EXPECT_EQ(load_library(first).bags, at_once.bags);
    EXPECT_EQ(load_library(first).codebook.words, at_once.codebook.words);
    remove_models(first, std::vector{name(1)});
    EXPECT_EQ(load_library(first).bags, alone.bags);
    EXPECT_TRUE(verify_library(first).problems.empty());
}

TEST_F(Edit, MergingNamesTheSettingThatDiffers) {
    const fs::path first = build("first", {0});
    settings_.cuts.min_points += 1;
    const fs::path other = build("other", {1});
    try {
        merge_libraries(std::vector{first, other}, folder_ / "merged");
        FAIL() << "merged libraries of different settings";
    } catch (const InvalidInput& error) {
        EXPECT_NE(std::string(error.what()).find("cuts.min_points"), std::string::npos)
            << error.what();
    }
    EXPECT_FALSE(fs::exists(folder_ / "merged"));
    EXPECT_THROW(merge_libraries(std::vector{first, first}, folder_ / "merged"), InvalidInput);
    EXPECT_THROW(merge_libraries({}, folder_ / "merged"), InvalidInput);
}

TEST_F(Edit, AnUnfinishedBuildIsContinuedAndThenGone) {
    // The second model can't be read: the build fails when the first may be done.
    for (ModelSource& model : models_) {
        model.file = model.name + ".ply";
        model.sha256 = std::string(64, 'a');
    }
    const fs::path target = folder_ / "both";
    std::vector<ModelInput> broken = inputs({0, 1});
    broken[1].load = []() -> ModelSource { throw InvalidInput("unreadable"); };
    set_thread_count(1);
    EXPECT_THROW(build_library_file(broken, settings_, target), InvalidInput);
    set_thread_count(0);
    EXPECT_FALSE(fs::exists(target));
    EXPECT_TRUE(fs::exists(unfinished_build(target)));
    const BuildOutcome outcome = build_library_file(inputs({0, 1}), settings_, target);
    EXPECT_EQ(outcome.resumed, 1U);
    EXPECT_FALSE(fs::exists(unfinished_build(target)));
    save_library(build_library(models_, settings_), folder_ / "in_memory");
    EXPECT_EQ(bytes_of(target), bytes_of(folder_ / "in_memory"));
}

// The other may have only made its file: an empty one is no reason to begin anew.
TEST_F(Edit, AnotherProcessesUnfinishedBuildIsLeftAlone) {
    const fs::path target = folder_ / "a";
    const FileLock other(unfinished_build(target));
    EXPECT_THROW(build_library_file(inputs({0}), settings_, target), FileError);
    EXPECT_TRUE(fs::exists(unfinished_build(target)));
    EXPECT_FALSE(fs::exists(target));
}

TEST_F(Edit, AKeypointGraphIsStoredAndVoidAfterAChange) {
    const fs::path both = build("both", {0, 1});
    const std::string before = verify_library(both).sha256;
    const std::size_t rows = index_keypoints(both);
    const ModelLibrary library = load_library(both);
    EXPECT_EQ(all_keypoint_rows(library).size(), rows * kShotLength);
    EXPECT_EQ(library.keypoint_graph.links.size(), rows * library.keypoint_graph.degree);
    EXPECT_TRUE(verify_library(both).problems.empty());
    EXPECT_EQ(verify_library(both).sha256,
              before);  // it is derived from the content, not part of it
    rename_model(both, name(0), "zzz");
    EXPECT_TRUE(load_library(both).keypoint_graph.links.empty());
    EXPECT_TRUE(verify_library(both).problems.empty());
    rename_model(both, "zzz", name(0));
    EXPECT_FALSE(load_library(both).keypoint_graph.links.empty());
}

TEST_F(Edit, ConfidenceIsStoredAndVoidAfterAChange) {
    const fs::path both = build("both", {0, 1});
    const std::string before = verify_library(both).sha256;
    EXPECT_FALSE(load_library(both).confidence.has_value());
    ConfidenceModel model;
    for (std::size_t i = 0; i < kFeatures; ++i)
        model.weights[i] = 1.0 / (1.0 + static_cast<double>(i));
    set_confidence(both, model);
    ASSERT_TRUE(load_library(both).confidence.has_value());
    EXPECT_EQ(load_library(both).confidence->weights, model.weights);
    EXPECT_EQ(verify_library(both).sha256, before);
    rename_model(both, name(0), "zzz");
    EXPECT_FALSE(load_library(both).confidence.has_value());
    rename_model(both, "zzz", name(0));
    EXPECT_TRUE(load_library(both).confidence.has_value());
    EXPECT_FALSE(load_library(both).merged_confidence.has_value());
    const ConfidenceModel single = model;
    model.weights[1] = -7.0;
    set_confidence(both, model, ScanKind::merged);
    EXPECT_EQ(load_library(both).confidence->weights, single.weights);
    EXPECT_EQ(load_library(both).merged_confidence->weights, model.weights);
    model.weights[2] = 1e9;  // damage
    set_confidence(both, model);
    EXPECT_THROW(load_library(both), FormatError);
    EXPECT_FALSE(verify_library(both).problems.empty());
}

TEST_F(Edit, LibrariesOfFormat1AreConvertedByEditing) {
    const fs::path old = fs::path(OSTRAKA_TEST_DATA) / "format1.ostraka";
    const ModelLibrary before = load_library(old);
    const fs::path copy = folder_ / "copy";
    fs::copy_file(old, copy);
    rename_model(copy, "tee", "a tee");
    const ModelLibrary after = load_library(copy);
    EXPECT_EQ(verify_library(copy).format, kLibraryFormat);
    ASSERT_EQ(after.models.size(), before.models.size());
    EXPECT_EQ(after.models[0].name, "a tee");
    EXPECT_EQ(after.models[0].mesh.vertices, before.models[1].mesh.vertices);
    merge_libraries(std::vector{old}, folder_ / "merged");
    EXPECT_EQ(load_library(folder_ / "merged").tables[1].rows, before.tables[1].rows);
}

}  // namespace
}  // namespace ostraka
