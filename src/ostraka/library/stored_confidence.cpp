// SPDX-License-Identifier: Apache-2.0
// The part of a library file that holds how its models are judged. The table came after format 2;
// readers that don't know it judge by the general weights.
#include <cmath>

#include "ostraka/base/error.hpp"
#include "ostraka/library/library_store.hpp"
#include "ostraka/library/sqlite.hpp"

namespace ostraka {
namespace {

constexpr double kMostWeight = 1e6;  // larger ones are damage

// Of a row. Those of merged scans came later.
std::string row_name(Feature feature, ScanKind kind) {
    const std::string name(feature_name(feature));
    return kind == ScanKind::merged ? "merged " + name : name;
}

}  // namespace

void LibraryStore::put_confidence(const ConfidenceModel& confidence, ScanKind kind) {
    database_->run(
        "CREATE TABLE IF NOT EXISTS confidence(feature TEXT PRIMARY KEY,"
        " models_sha256 TEXT NOT NULL, weight REAL NOT NULL) WITHOUT ROWID;");
    Statement insert(*database_, "INSERT OR REPLACE INTO confidence VALUES(?,?,?)");
    for (std::size_t i = 0; i < kFeatures; ++i) {
        insert.bind(1, row_name(static_cast<Feature>(i), kind));
        insert.bind(2, models_digest());
        insert.bind(3, confidence.weights[i]);
        insert.step();
        insert.reset();
    }
}

bool LibraryStore::has_confidence() {
    return database_->number("SELECT count(*) FROM sqlite_master WHERE name='confidence'") > 0;
}

void LibraryStore::load_confidence(ModelLibrary& library) {
    if (!has_confidence()) return;
    library.confidence = stored_confidence(ScanKind::one_viewpoint);
    library.merged_confidence = stored_confidence(ScanKind::merged);
}

// None if it was fitted to other models or other features.
std::optional<ConfidenceModel> LibraryStore::stored_confidence(ScanKind kind) {
    Statement select(*database_,
                     "SELECT weight FROM confidence WHERE feature=? AND models_sha256=?");
    ConfidenceModel model;
    for (std::size_t i = 0; i < kFeatures; ++i) {
        select.bind(1, row_name(static_cast<Feature>(i), kind));
        select.bind(2, models_digest());
        if (!select.step()) return std::nullopt;
        model.weights[i] = select.real(0);
        if (!(std::abs(model.weights[i]) < kMostWeight)) {
            throw FormatError(named_, "confidence", "a weight is out of range");
        }
        select.reset();
    }
    return model;
}

}  // namespace ostraka
