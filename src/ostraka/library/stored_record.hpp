// SPDX-License-Identifier: Apache-2.0
// A model record as the library file holds it: rows of cells, with a digest over all of them.
// Private. The columns are those of docs/library_format.md, in its order.
#pragma once

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "ostraka/library/model_record.hpp"

namespace ostraka {

using Bytes = std::vector<unsigned char>;
using Cell = std::variant<std::int64_t, double, std::string, Bytes>;
using Row = std::vector<Cell>;

/// Without ids: where a row lies in the file is not part of what it says.
struct StoredRecord {
    Row model;                     ///< name, file, source_sha256, ...
    std::vector<Row> entries;      ///< in the order of their numbers
    std::vector<Row> descriptors;  ///< name, rows, ... in the order of the names
};

inline constexpr std::size_t kModelColumns = 14;
inline constexpr std::size_t kEntryColumns = 7;
inline constexpr std::size_t kDescriptorColumns = 5;

const std::string& name_of(const StoredRecord& record);

StoredRecord to_stored(const ModelRecord& record, const LibrarySettings& settings);

/// @throws InvalidInput, without the model's name, for anything damaged.
ModelRecord from_stored(const StoredRecord& record, const LibrarySettings& settings);

/// SHA-256 over all rows; each cell as the length of its bytes (u64) and the bytes.
std::string digest_of(const StoredRecord& record);

/// The same of other rows.
std::string digest_of(const std::vector<Row>& rows);

}  // namespace ostraka
