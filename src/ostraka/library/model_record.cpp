// SPDX-License-Identifier: Apache-2.0
#include "ostraka/library/model_record.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "ostraka/base/error.hpp"

namespace ostraka {

ModelLibrary join_records(const LibrarySettings& settings, std::vector<ModelRecord> records) {
    std::sort(records.begin(), records.end(),
              [](const auto& a, const auto& b) { return a.model.name < b.model.name; });
    ModelLibrary library;
    library.settings = settings;
    for (const AnyDescriptor& descriptor : settings.descriptors) {
        library.tables.push_back({descriptor, {}, {}});
    }
    for (ModelRecord& record : records) {
        const std::string& name = record.model.name;
        if (!library.models.empty() && library.models.back().name == name) {
            throw InvalidInput(fmt::format("two models are named {}: names must differ", name));
        }
        for (Entry& entry : record.entries) {
            entry.model = static_cast<std::uint32_t>(library.models.size());
            library.entries.push_back(std::move(entry));
        }
        for (std::size_t t = 0; t < library.tables.size(); ++t) {
            std::vector<float>& rows = library.tables[t].rows;
            rows.insert(rows.end(), record.rows[t].begin(), record.rows[t].end());
            library.tables[t].spread.append(record.spreads[t]);
        }
        library.models.push_back(std::move(record.model));
    }
    return library;
}

std::vector<ModelRecord> split_library(ModelLibrary library) {
    std::vector<ModelRecord> records(library.models.size());
    std::size_t first = 0;
    for (std::size_t m = 0; m < records.size(); ++m) {
        ModelRecord& record = records[m];
        record.model = std::move(library.models[m]);
        std::size_t last = first;
        for (; last < library.entries.size() && library.entries[last].model == m; ++last) {
            library.entries[last].model = 0;
            record.entries.push_back(std::move(library.entries[last]));
        }
        for (const DescriptorTable& table : library.tables) {
            const std::size_t length = descriptor_length(table.descriptor);
            record.rows.emplace_back(
                table.rows.begin() + static_cast<std::ptrdiff_t>(first * length),
                table.rows.begin() + static_cast<std::ptrdiff_t>(last * length));
            record.spreads.push_back(table.spread.part(first, last, length));
        }
        first = last;
    }
    return records;
}

}  // namespace ostraka
