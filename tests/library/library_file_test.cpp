// SPDX-License-Identifier: Apache-2.0
#include "ostraka/library/library_file.hpp"
#include "ostraka/library/bags.hpp"

#include <gtest/gtest.h>
#include <sqlite3.h>

#include <fstream>
#include <string>

#include "ostraka/base/parallel.hpp"
#include "ostraka/base/random.hpp"
#include "support/simple_models.hpp"

namespace ostraka {
namespace {

namespace fs = std::filesystem;
using testing::quick_settings;
using testing::simple_models;

class LibraryFile : public ::testing::Test {
  protected:
    void SetUp() override {
        folder_ = fs::temp_directory_path() /
                  (std::string("ostraka_") +
                   ::testing::UnitTest::GetInstance()->current_test_info()->name());
        fs::remove_all(folder_);
        fs::create_directories(folder_);
    }
    void TearDown() override { fs::remove_all(folder_); }
    fs::path path(const char* name) const { return folder_ / name; }

    static std::string read(const fs::path& file) {
        std::ifstream stream(file, std::ios::binary);
        return {std::istreambuf_iterator<char>(stream), {}};
    }
    static void write(const fs::path& file, const std::string& bytes) {
        std::ofstream(file, std::ios::binary) << bytes;
    }
    static void change(const fs::path& file, const char* sql) {
        sqlite3* database = nullptr;
        ASSERT_EQ(sqlite3_open(file.c_str(), &database), SQLITE_OK);
        EXPECT_EQ(sqlite3_exec(database, sql, nullptr, nullptr, nullptr), SQLITE_OK);
        sqlite3_close(database);
    }
    static const ModelLibrary& library() {
        static const ModelLibrary built = [] {
            ModelLibrary library = build_library(simple_models(), quick_settings());
            make_bags(library);
            return library;
        }();
        return built;
    }

    fs::path folder_;
};

TEST_F(LibraryFile, ReadsBackWhatWasBuilt) {
    save_library(library(), path("a.ostraka"));
    const ModelLibrary back = load_library(path("a.ostraka"));
    ASSERT_EQ(back.models.size(), library().models.size());
    for (std::size_t m = 0; m < back.models.size(); ++m) {
        const Model& a = library().models[m];
        const Model& b = back.models[m];
        EXPECT_EQ(a.name, b.name);
        EXPECT_EQ(a.mesh.vertices, b.mesh.vertices);
        EXPECT_EQ(a.mesh.triangles, b.mesh.triangles);
        EXPECT_EQ(a.surface.points, b.surface.points);
        EXPECT_EQ(a.surface.normals, b.surface.normals);
        EXPECT_EQ(a.keypoints.points, b.keypoints.points);
        EXPECT_EQ(a.keypoints.rows, b.keypoints.rows);
        EXPECT_EQ(a.shape.axes, b.shape.axes);
        EXPECT_EQ(a.counts.kept, b.counts.kept);
    }
    ASSERT_EQ(back.entries.size(), library().entries.size());
    for (std::size_t i = 0; i < back.entries.size(); ++i) {
        EXPECT_EQ(back.entries[i].cloud.points, library().entries[i].cloud.points);
        EXPECT_EQ(back.entries[i].frame.T_cloud_frame.matrix(),
                  library().entries[i].frame.T_cloud_frame.matrix());
        EXPECT_EQ(back.entries[i].view, library().entries[i].view);
    }
    for (std::size_t t = 0; t < back.tables.size(); ++t) {
        EXPECT_EQ(back.tables[t].rows, library().tables[t].rows);
    }
    EXPECT_GT(back.codebook.size(), 0U);
    EXPECT_EQ(back.codebook.words, library().codebook.words);
    EXPECT_EQ(back.bags, library().bags);
}

TEST_F(LibraryFile, ALibraryWithoutACodebookIsReadBack) {
    ModelLibrary bare = library();
    bare.codebook = {};
    bare.bags.clear();
    save_library(bare, path("a.ostraka"));
    const ModelLibrary back = load_library(path("a.ostraka"));
    EXPECT_EQ(back.codebook.size(), 0U);
    EXPECT_TRUE(back.bags.empty());
}

// Damage that keeps the database whole: only the checksums tell.
TEST_F(LibraryFile, ContentThatWasChangedIsRefusedAndNamed) {
    const std::string first = library().models.front().name;
    const std::pair<const char*, std::string> changes[] = {
        {"DELETE FROM codebook WHERE word=3", "codebook"},
        {"UPDATE codebook SET row=zeroblob(1408) WHERE word=2", "codebook"},
        {"DELETE FROM bag WHERE model=0", "bags"},
        {"UPDATE model SET coverage=coverage+1e-9 WHERE id=0", first},
        {"UPDATE entry SET view=view+1 WHERE model=0 AND number=1", first},
        {"DELETE FROM entry WHERE model=0 AND number=2", first},
        {"UPDATE descriptor SET rows=zeroblob(length(rows)) WHERE model=0 AND name='esf'", first},
        {"DELETE FROM descriptor WHERE model=0 AND name='vfh'", first},
        {"UPDATE setting SET value='99' WHERE key='cuts.min_points'", "settings"},
        {"DELETE FROM model WHERE id=0", "models"},
        {"DELETE FROM checksum WHERE part='models'", "models"}};
    for (const auto& [sql, named] : changes) {
        save_library(library(), path("a.ostraka"));
        change(path("a.ostraka"), sql);
        try {
            load_library(path("a.ostraka"));
            ADD_FAILURE() << "loaded after " << sql;
        } catch (const FormatError& error) {
            EXPECT_NE(std::string(error.what()).find(named), std::string::npos)
                << sql << ": " << error.what();
        }
        EXPECT_FALSE(verify_library(path("a.ostraka")).problems.empty()) << sql;
    }
}

TEST_F(LibraryFile, VerifyFindsEveryDamagedModel) {
    save_library(library(), path("a.ostraka"));
    const LibraryCheck whole = verify_library(path("a.ostraka"));
    EXPECT_TRUE(whole.problems.empty());
    EXPECT_EQ(whole.models, library().models.size());
    EXPECT_EQ(whole.entries, library().entries.size());
    change(path("a.ostraka"), "UPDATE model SET file='x'");
    EXPECT_EQ(verify_library(path("a.ostraka")).problems.size(), library().models.size());
    EXPECT_THROW(verify_library(path("missing.ostraka")), FileError);
}

// The fixture was written by the last version that wrote format 1.
TEST_F(LibraryFile, Format1IsRead) {
    const ModelLibrary old = load_library(fs::path(OSTRAKA_TEST_DATA) / "format1.ostraka");
    ASSERT_EQ(old.models.size(), 2U);
    EXPECT_EQ(old.models[0].name, "l_bracket");
    EXPECT_EQ(old.models[1].name, "tee");
    EXPECT_EQ(old.entries.size(), 12U);
    EXPECT_NEAR(old.models[1].shape.diameter, 110.2, 0.1);
    EXPECT_EQ(old.models[1].keypoints.size(), 44U);
    EXPECT_EQ(old.settings.sampling, 8.0);
    EXPECT_GT(old.codebook.size(), 0U);
    for (const DescriptorTable& table : old.tables) {
        EXPECT_EQ(table.rows.size(), 12 * descriptor_length(table.descriptor));
    }
    EXPECT_TRUE(verify_library(fs::path(OSTRAKA_TEST_DATA) / "format1.ostraka").problems.empty());
}

TEST_F(LibraryFile, DamagedFormat1NeverCrashes) {
    const std::string bytes = read(fs::path(OSTRAKA_TEST_DATA) / "format1.ostraka");
    Random random(7);
    for (int trial = 0; trial < 40; ++trial) {
        std::string damaged = bytes;
        for (int i = 0; i < 40; ++i) {
            damaged[random.below(static_cast<std::uint32_t>(trial < 20 ? 8192 : bytes.size()))] =
                static_cast<char>(random.bits());
        }
        write(path("damaged.ostraka"), damaged);
        try {
            EXPECT_FALSE(load_library(path("damaged.ostraka")).models.empty());
        } catch (const Error&) {
            // One clear exception is what damage should give.
        }
    }
}

TEST_F(LibraryFile, SavingWhatWasLoadedGivesTheSameBytes) {
    save_library(library(), path("a.ostraka"));
    save_library(load_library(path("a.ostraka")), path("b.ostraka"));
    EXPECT_EQ(read(path("a.ostraka")), read(path("b.ostraka")));
}

TEST_F(LibraryFile, OneThreadAndManyGiveTheSameBytes) {
    set_thread_count(1);
    save_library(build_library(simple_models(), quick_settings()), path("one.ostraka"));
    set_thread_count(4);
    save_library(build_library(simple_models(), quick_settings()), path("four.ostraka"));
    set_thread_count(0);
    EXPECT_EQ(read(path("one.ostraka")), read(path("four.ostraka")));
}

TEST_F(LibraryFile, TruncatedFilesAreRefused) {
    save_library(library(), path("a.ostraka"));
    const std::string bytes = read(path("a.ostraka"));
    for (const double share : {0.0, 0.001, 0.01, 0.3, 0.7, 0.99}) {
        write(path("cut.ostraka"),
              bytes.substr(0, static_cast<std::size_t>(share * double(bytes.size()))));
        EXPECT_THROW(load_library(path("cut.ostraka")), Error) << share;
    }
}

TEST_F(LibraryFile, DamageNeverCrashes) {
    save_library(library(), path("a.ostraka"));
    const std::string bytes = read(path("a.ostraka"));
    Random random(3);
    for (int trial = 0; trial < 60; ++trial) {
        std::string damaged = bytes;
        for (int i = 0; i < 40; ++i) {
            damaged[random.below(static_cast<std::uint32_t>(trial < 30 ? 8192 : bytes.size()))] =
                static_cast<char>(random.bits());
        }
        write(path("damaged.ostraka"), damaged);
        try {
            const ModelLibrary loaded = load_library(path("damaged.ostraka"));
            EXPECT_EQ(loaded.tables.size(), loaded.settings.descriptors.size());
        } catch (const Error&) {
            // One clear exception is what damage should give.
        }
    }
}

TEST_F(LibraryFile, SaysWhatIsWrong) {
    EXPECT_THROW(load_library(path("missing.ostraka")), FileError);
    EXPECT_THROW(load_library(folder_), FileError);
    write(path("text.ostraka"),
          "this is no library, but a long enough text to look at" + std::string(2000, '.'));
    EXPECT_THROW(load_library(path("text.ostraka")), FormatError);
    write(path("empty.ostraka"), "");
    EXPECT_THROW(load_library(path("empty.ostraka")), FormatError);
}

TEST_F(LibraryFile, ALaterFormatIsNamed) {
    save_library(library(), path("a.ostraka"));
    std::string bytes = read(path("a.ostraka"));
    bytes[63] = 99;  // user_version is the big-endian number at bytes 60 to 63 of an SQLite file
    write(path("later.ostraka"), bytes);
    try {
        load_library(path("later.ostraka"));
        FAIL() << "loaded";
    } catch (const FormatError& error) {
        EXPECT_NE(std::string(error.what()).find("format 99"), std::string::npos) << error.what();
    }
}

TEST_F(LibraryFile, FailingToSaveKeepsTheEarlierLibrary) {
    save_library(library(), path("a.ostraka"));
    const std::string before = read(path("a.ostraka"));
    EXPECT_THROW(save_library(library(), path("no/such/folder/a.ostraka")), FileError);
    EXPECT_THROW(save_library(library(), folder_), FileError);
    EXPECT_EQ(read(path("a.ostraka")), before);
    EXPECT_EQ(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()), 1);
}

}  // namespace
}  // namespace ostraka
