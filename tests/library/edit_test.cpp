// SPDX-License-Identifier: Apache-2.0
#include "ostraka/library/edit.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>

#include "ostraka/base/error.hpp"
#include "ostraka/library/bags.hpp"
#include "ostraka/library/build.hpp"
#include "ostraka/library/library_file.hpp"
#include "support/simple_models.hpp"

namespace ostraka {
namespace {

// The settings of a build at once, with the sampling distance that does not depend on all models.
LibrarySettings settings() {
    LibrarySettings fixed = testing::quick_settings();
    if (fixed.sampling == 0.0) fixed.sampling = default_sampling(testing::simple_models());
    return fixed;
}

ModelLibrary of(std::vector<ModelSource> models) {
    return build_library(models, settings());
}

std::string bytes_of(const ModelLibrary& library) {
    const auto path = std::filesystem::temp_directory_path() /
                      ("ostraka_edit_test_" + std::to_string(getpid()) + ".ostraka");
    save_library(library, path);
    std::ifstream file(path, std::ios::binary);
    std::string bytes((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
    file.close();
    std::filesystem::remove(path);
    return bytes;
}

class Edit : public ::testing::Test {
  protected:
    static void SetUpTestSuite() {
        const auto models = testing::simple_models();
        first_ = new ModelLibrary(of({models[0]}));
        second_ = new ModelLibrary(of({models[1]}));
        both_ = new ModelLibrary(of({models[0], models[1]}));
    }
    static void TearDownTestSuite() {
        delete first_;
        delete second_;
        delete both_;
    }
    static ModelLibrary* first_;
    static ModelLibrary* second_;
    static ModelLibrary* both_;
};
ModelLibrary* Edit::first_ = nullptr;
ModelLibrary* Edit::second_ = nullptr;
ModelLibrary* Edit::both_ = nullptr;

TEST_F(Edit, MergingEqualsBuildingAtOnceByteForByte) {
    const std::string at_once = bytes_of(*both_);
    EXPECT_EQ(bytes_of(merge_libraries({*first_, *second_})), at_once);
    EXPECT_EQ(bytes_of(merge_libraries({*second_, *first_})), at_once);
}

TEST_F(Edit, AddingEqualsBuildingAtOnceByteForByte) {
    const auto models = testing::simple_models();
    EXPECT_EQ(bytes_of(add_models(*second_, std::span(models).first(1))), bytes_of(*both_));
    EXPECT_THROW(add_models(*both_, std::span(models).first(1)), InvalidInput);
}

TEST_F(Edit, RemovingUndoesAdding) {
    EXPECT_EQ(bytes_of(remove_model(*both_, second_->models[0].name)), bytes_of(*first_));
    EXPECT_THROW(remove_model(*both_, "no such model"), InvalidInput);
    EXPECT_THROW(remove_model(*first_, first_->models[0].name), InvalidInput);
}

TEST_F(Edit, RenamingMovesAModelToItsPlaceAndBack) {
    const std::string name = both_->models[0].name;
    const ModelLibrary renamed = rename_model(*both_, name, "zzz");
    EXPECT_EQ(renamed.models.back().name, "zzz");
    EXPECT_EQ(renamed.entries.back().model, 1U);
    EXPECT_EQ(bytes_of(rename_model(renamed, "zzz", name)), bytes_of(*both_));
    EXPECT_THROW(rename_model(*both_, name, both_->models[1].name), InvalidInput);
    EXPECT_THROW(rename_model(*both_, name, ""), InvalidInput);
    EXPECT_THROW(rename_model(*both_, "no such model", "a"), InvalidInput);
}

TEST_F(Edit, BagsOfWordsAreMadeAnewWhereTheFirstLibraryHasThem) {
    ModelLibrary at_once = *both_;
    make_bags(at_once);
    ModelLibrary first = *first_;
    make_bags(first);
    EXPECT_EQ(bytes_of(merge_libraries({first, *second_})), bytes_of(at_once));
    EXPECT_EQ(bytes_of(remove_model(at_once, second_->models[0].name)), bytes_of(first));
    EXPECT_EQ(merge_libraries({*second_, first}).codebook.size(), 0U);
}

TEST_F(Edit, MergingNamesTheSettingThatDiffers) {
    ModelLibrary other = *second_;
    other.settings.cuts.min_points += 1;
    try {
        merge_libraries({*first_, other});
        FAIL() << "merged libraries of different settings";
    } catch (const InvalidInput& error) {
        EXPECT_NE(std::string(error.what()).find("cuts.min_points"), std::string::npos)
            << error.what();
    }
    EXPECT_THROW(merge_libraries({*first_, *first_}), InvalidInput);
    EXPECT_THROW(merge_libraries({}), InvalidInput);
}

}  // namespace
}  // namespace ostraka
