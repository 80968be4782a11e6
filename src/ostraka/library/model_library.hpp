// SPDX-License-Identifier: Apache-2.0
// The library: all entries of all models, plus the settings that made them.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "ostraka/base/unit.hpp"
#include "ostraka/cloud/principal_frame.hpp"
#include "ostraka/descriptors/bag_of_words.hpp"
#include "ostraka/library/confidence_model.hpp"
#include "ostraka/library/library_settings.hpp"
#include "ostraka/library/neighbor_graph.hpp"
#include "ostraka/library/spread.hpp"
#include "ostraka/mesh/shape.hpp"
#include "ostraka/mesh/symmetry.hpp"

namespace ostraka {

/// How many candidates a model gave, and what became of them.
struct BuildCounts {
    int views = 0;          ///< views made
    int cuts = 0;           ///< cuts made of them
    int too_small = 0;      ///< dropped: the largest cluster has too few points
    int redundant = 0;      ///< dropped: shows what another candidate shows
    int beyond_budget = 0;  ///< dropped: others cover more
    int kept = 0;           ///< entries in the library
    double coverage = 0.0;  ///< mean overlap of a likely observation with its best entry, 0 to 1
    std::array<double, 5> covered{};  ///< share of likely observations that some entry overlaps by
                                      ///< at least kCoveredOverlaps
};

/// Local rows are stored and compared in 8 bits: round(512 value), at most 255. SHOT's values are
/// mostly below 0.25; the rounding adds about 0.01 to a distance of typically 0.4 to 0.9.
std::vector<std::uint8_t> quantize_row(std::span<const float> row);

/// Local descriptors of points on a model's surface, each described as some view shows it.
struct Keypoints {
    std::vector<Vec3f> points;  ///< model frame, library unit
    std::vector<Mat3f> frames;  ///< R_model_keypoint: the local reference frame's axes as columns
    std::vector<std::uint8_t> rows;  ///< size() rows of kShotLength: quantize_row() of SHOT
    std::size_t size() const { return points.size(); }
};

struct Model {
    std::string name;    ///< the file's stem; unique in a library
    std::string file;    ///< provenance: the file's name without its folder
    std::string sha256;  ///< provenance: digest of the file
    TriangleMesh mesh;   ///< repaired; model frame, library unit
    MeshShape shape;     ///< measure() of the mesh
    Symmetry symmetry;   ///< of what can be seen of it; model frame, library unit
    PointCloud
        surface;  ///< what can be seen from outside: points about `sampling` apart, normals outward
    Keypoints keypoints;
    BuildCounts counts;
};

/// A view or subpart kept in the library.
struct Entry {
    std::uint32_t model = 0;  ///< index into ModelLibrary::models
    int view = 0;             ///< number of the viewpoint
    int direction = -1;       ///< cut direction, or -1 for a whole view
    int fraction = -1;        ///< index into CutSettings::fractions, or -1 for a whole view
    PointCloud cloud;      ///< model frame, library unit; points to 1/32000 of the model's radius,
                           ///< no normals; viewpoint is the virtual sensor
    PrincipalFrame frame;  ///< of the cloud: T_cloud_frame is T_model_entry
};

/// The rows of one descriptor, one for each entry.
struct DescriptorTable {
    AnyDescriptor descriptor;
    std::vector<float>
        rows;       ///< entries x descriptor_length(), row-major, as described (no transform)
    Spread spread;  ///< how the observations that each entry stands for vary; may be empty
};

struct ModelLibrary {
    LibrarySettings settings;             ///< as used: sampling is never 0 here
    std::vector<Model> models;            ///< in the order of their names
    std::vector<Entry> entries;           ///< grouped by model, in the order of `models`
    std::vector<DescriptorTable> tables;  ///< one for each of settings.descriptors
    Codebook codebook;             ///< of the models' keypoint rows (bags.hpp); may have no words
    NeighborGraph keypoint_graph;  ///< of all_keypoint_rows(); empty: exact search
    std::vector<float> bags;       ///< entries x codebook.size(): its words in each entry, sum 1
    std::optional<ConfidenceModel> confidence;  ///< fitted to these models; none: the general one
    std::optional<ConfidenceModel> merged_confidence;  ///< the same for merged scans
};

/// The keypoint rows of all models, one after another in their order.
std::vector<std::uint8_t> all_keypoint_rows(const ModelLibrary& library);

/// The table of the descriptor with that name; nullptr if the library has none.
const DescriptorTable* find_table(const ModelLibrary& library, std::string_view descriptor);

}  // namespace ostraka
